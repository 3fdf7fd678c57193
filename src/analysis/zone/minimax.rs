//! Linear minimax (Chebyshev) fits with few unknowns and many rows: the least largest residual, exactly.
//!
//! The fit is the linear program `min h, |e_i - b_i x| <= h`. Its dual has r + 1 equations for r unknowns: a basis is
//! r + 1 rows with signs and weights. The simplex method on the dual takes, as the exchange algorithm does, the row
//! with the largest residual into the basis, until none exceeds h. The least h of a basis and the largest residual
//! enclose the answer, so a fit proves itself. The weights are the derivatives of h by the values.

use nalgebra::{SMatrix, SVector};

/// Maximum number of unknowns.
pub const MAX_UNKNOWNS: usize = 6;

const SIZE: usize = MAX_UNKNOWNS + 1;

/// Below this part of its length a column, or a row, is a combination of others.
const RANK: f64 = 1e-9;

/// The largest residual may exceed h by this part of the largest value: rounding.
const TOLERANCE: f64 = 1e-12;

/// Number of exchanges without a gain after which the first row that exceeds h is taken, not the largest (Bland's rule,
/// which ends).
const STALLED: usize = 12;

/// Maximum number of exchanges.
const MAX_EXCHANGES: usize = 5000;

/// Coefficients of the unknowns in one row.
pub type FitRow = [f64; MAX_UNKNOWNS];

/// The rows of a fit, their columns made orthonormal.
#[derive(Debug, Clone, PartialEq)]
pub struct MinimaxFit {
    rows: Vec<FitRow>,
    rank: usize,
    /// Rows and signs of a basis: as many rows as there are unknowns, and the first again with the other sign.
    first: Vec<SignedRow>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct SignedRow {
    row: usize,
    sign: f64,
}

/// The least largest residual.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimax {
    /// The largest residual of the fit.
    pub half_width: f64,
    /// Lower bound of the least largest residual.
    pub lower: f64,
    /// The derivatives of the half width by the values that hold it: rows with their weights, whose sum of sizes is 1.
    pub weights: Vec<(usize, f64)>,
}

impl MinimaxFit {
    /// Returns the fit of columns of equal length, at most [`MAX_UNKNOWNS`]; columns that depend on others count for
    /// nothing. There is one row at least.
    pub fn new(count: usize, columns: &[Vec<f64>]) -> Self {
        let columns = orthonormal(&columns[..columns.len().min(MAX_UNKNOWNS)]);
        let row = |i: usize| std::array::from_fn(|k| columns.get(k).map_or(0.0, |column| column[i]));
        let rows: Vec<FitRow> = (0..count).map(row).collect();
        let rank = columns.len();
        let mut first: Vec<SignedRow> =
            independent(&rows, rank).into_iter().map(|row| SignedRow { row, sign: 1.0 }).collect();
        let opposite = first.first().map_or(SignedRow { row: 0, sign: 1.0 }, |of| SignedRow { sign: -1.0, ..*of });
        first.push(opposite);
        Self { rows, rank, first }
    }

    /// Returns the number of independent unknowns.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Returns the residuals of the least-squares fit of values, one a row.
    pub fn least_squares(&self, values: &[f64]) -> Vec<f64> {
        let mut solution = [0.0; MAX_UNKNOWNS];
        for (row, value) in self.rows.iter().zip(values) {
            solution.iter_mut().zip(row).for_each(|(x, b)| *x += b * value);
        }
        self.rows.iter().zip(values).map(|(row, value)| value - dot(row, &solution)).collect()
    }

    /// Returns the minimax fit of values, one a row.
    pub fn fit(&self, values: &[f64]) -> Minimax {
        let scale = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let mut basis = self.first.clone();
        let mut best = Minimax { half_width: f64::INFINITY, lower: 0.0, weights: Vec::new() };
        let mut stalled = 0;
        for _ in 0..MAX_EXCHANGES {
            let Some(vertex) = Vertex::new(self, &basis, values) else { break };
            let (entering, largest) = self.violated(values, &vertex, scale * TOLERANCE, stalled >= STALLED);
            stalled = if vertex.level > best.lower { 0 } else { stalled + 1 };
            best.lower = best.lower.max(vertex.level.min(largest));
            if largest < best.half_width {
                best.half_width = largest;
                best.weights = vertex.weights(&basis);
            }
            let Some(entering) = entering else {
                best.weights = vertex.weights(&basis);
                break;
            };
            let Some(leaving) = vertex.leaving(&basis, &self.column(entering)) else { break };
            basis[leaving] = entering;
        }
        best
    }

    /// Returns a row that exceeds the level, and the largest residual.
    fn violated(&self, values: &[f64], vertex: &Vertex, slack: f64, first: bool) -> (Option<SignedRow>, f64) {
        let (mut largest, mut found) = (vertex.level, None);
        let mut taken = vertex.level + slack;
        for (row, (coefficients, value)) in self.rows.iter().zip(values).enumerate() {
            let residual = value - dot(coefficients, &vertex.solution);
            largest = largest.max(residual.abs());
            if residual.abs() > taken && !(first && found.is_some()) {
                taken = residual.abs();
                found = Some(SignedRow { row, sign: residual.signum() });
            }
        }
        (found, largest)
    }

    /// Returns the column of the dual program: the signed row, and 1.
    fn column(&self, of: SignedRow) -> SVector<f64, SIZE> {
        let row = &self.rows[of.row];
        SVector::from_fn(|k, _| match k {
            k if k < self.rank => of.sign * row[k],
            k if k == self.rank => 1.0,
            _ => 0.0,
        })
    }
}

/// A basis solved: the fit in which its residuals are equal, and the weights of its rows.
struct Vertex {
    solution: FitRow,
    /// The residual of the rows of the basis, h.
    level: f64,
    weights: SVector<f64, SIZE>,
    /// Inverse of the matrix whose columns are those of the basis.
    inverse: SMatrix<f64, SIZE, SIZE>,
}

impl Vertex {
    fn new(fit: &MinimaxFit, basis: &[SignedRow], values: &[f64]) -> Option<Self> {
        let mut matrix = SMatrix::<f64, SIZE, SIZE>::identity();
        basis.iter().enumerate().for_each(|(k, of)| matrix.set_column(k, &fit.column(*of)));
        let inverse = matrix.full_piv_lu().try_inverse()?;
        let signed = SVector::from_fn(|k, _| basis.get(k).map_or(0.0, |of| of.sign * values[of.row]));
        let dual = inverse.tr_mul(&signed);
        let solution = std::array::from_fn(|k| if k < fit.rank { dual[k] } else { 0.0 });
        Some(Self { solution, level: dual[fit.rank], weights: inverse.column(fit.rank).into_owned(), inverse })
    }

    /// Returns the place in the basis that a column takes; of equal ones that with the first row.
    fn leaving(&self, basis: &[SignedRow], column: &SVector<f64, SIZE>) -> Option<usize> {
        let step = self.inverse * column;
        let pivots = (0..basis.len()).filter(|k| step[*k] > RANK * step.amax());
        let ratio = |k: usize| (self.weights[k].max(0.0) / step[k], basis[k].row);
        let order = |a: &usize, b: &usize| ratio(*a).0.total_cmp(&ratio(*b).0).then(ratio(*a).1.cmp(&ratio(*b).1));
        pivots.min_by(order)
    }

    fn weights(&self, basis: &[SignedRow]) -> Vec<(usize, f64)> {
        let weights = basis.iter().enumerate().map(|(k, of)| (of.row, of.sign * self.weights[k].max(0.0)));
        weights.filter(|(_, weight)| *weight != 0.0).collect()
    }
}

fn dot(a: &FitRow, b: &FitRow) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns orthonormal columns that span the same, those that depend on others left out.
fn orthonormal(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        let length = norm(column);
        let mut rest = column.clone();
        // Twice is enough (Kahan).
        for _ in 0..2 {
            for known in &found {
                let share: f64 = known.iter().zip(&rest).map(|(a, b)| a * b).sum();
                rest.iter_mut().zip(known).for_each(|(x, k)| *x -= share * k);
            }
        }
        let left = norm(&rest);
        if left > RANK * length {
            found.push(rest.iter().map(|x| x / left).collect());
        }
    }
    found
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns `rank` rows that are independent, the longest first.
fn independent(rows: &[FitRow], rank: usize) -> Vec<usize> {
    let mut rest: Vec<FitRow> = rows.to_vec();
    let square = |row: &FitRow| dot(row, row);
    (0..rank)
        .map(|_| {
            // Of equal ones the first.
            let longest = (0..rest.len()).rev().max_by(|a, b| square(&rest[*a]).total_cmp(&square(&rest[*b])));
            let longest = longest.unwrap_or(0);
            let pivot = rest[longest];
            let length = square(&pivot).max(f64::MIN_POSITIVE);
            for row in &mut rest {
                let share = dot(row, &pivot) / length;
                row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= share * p);
            }
            longest
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// Solves a small system by Gauss; `None` if it is singular.
    fn solve(mut matrix: Vec<Vec<f64>>) -> Option<Vec<f64>> {
        let n = matrix.len();
        for k in 0..n {
            let pivot = (k..n).max_by(|a, b| matrix[*a][k].abs().total_cmp(&matrix[*b][k].abs()))?;
            matrix.swap(k, pivot);
            if matrix[k][k].abs() < 1e-10 {
                return None;
            }
            for i in 0..n {
                let factor = matrix[i][k] / matrix[k][k];
                let row = matrix[k].clone();
                if i != k {
                    matrix[i].iter_mut().zip(&row).for_each(|(x, r)| *x -= factor * r);
                }
            }
        }
        Some((0..n).map(|k| matrix[k][n] / matrix[k][k]).collect())
    }

    /// The least largest residual over all sets of k + 1 rows with all signs: one of them is the optimal vertex.
    fn by_subsets(columns: &[Vec<f64>], values: &[f64]) -> f64 {
        let (n, k) = (values.len(), columns.len());
        let mut best = f64::INFINITY;
        for set in 0_u32..1 << n {
            if set.count_ones() as usize != k + 1 {
                continue;
            }
            let rows: Vec<usize> = (0..n).filter(|i| set >> i & 1 == 1).collect();
            for signs in 0_u32..1 << (k + 1) {
                let row = |(j, i): (usize, &usize)| {
                    let sign = if signs >> j & 1 == 1 { 1.0 } else { -1.0 };
                    columns.iter().map(|c| c[*i]).chain([sign, values[*i]]).collect()
                };
                let Some(x) = solve(rows.iter().enumerate().map(row).collect()) else { continue };
                let residual = |i: usize| values[i] - (0..k).map(|j| columns[j][i] * x[j]).sum::<f64>();
                best = best.min((0..n).map(|i| residual(i).abs()).fold(0.0, f64::max));
            }
        }
        best
    }

    fn columns_of(numbers: &mut Numbers, n: usize, k: usize, grid: bool) -> Vec<Vec<f64>> {
        let value = |numbers: &mut Numbers| {
            let x = numbers.next();
            if grid { (x * 2.0).round() } else { x }
        };
        let one = vec![1.0; n];
        std::iter::once(one).chain((1..k).map(|_| (0..n).map(|_| value(numbers)).collect())).collect()
    }

    #[test]
    fn it_is_the_best_of_all_vertices() {
        let mut numbers = Numbers(7);
        for (n, k) in [(4, 1), (6, 2), (8, 3), (9, 3), (9, 4), (10, 5), (10, 6)] {
            for round in 0..6 {
                // Every second set lies on a grid: rows are equal, and vertices degenerate.
                let columns = columns_of(&mut numbers, n, k, round % 2 == 1);
                let values: Vec<f64> = (0..n).map(|_| numbers.next()).collect();
                let fit = MinimaxFit::new(n, &columns);
                if fit.rank() < k {
                    continue;
                }
                let found = fit.fit(&values);
                let truth = by_subsets(&columns, &values);
                assert!((found.half_width - truth).abs() < 1e-9, "{n} {k} {round}: {found:?} {truth}");
                assert!(found.half_width - found.lower < 1e-9);
                // The weights give the width back (strong duality), and are orthogonal to every column.
                let sum: f64 = found.weights.iter().map(|(i, weight)| weight * values[*i]).sum();
                assert!((sum - found.half_width).abs() < 1e-9);
                for column in &columns {
                    assert!(found.weights.iter().map(|(i, weight)| weight * column[*i]).sum::<f64>().abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn the_line_of_a_parabola_is_that_of_chebyshev() {
        // The best line of x^2 on -1..1 is 1/2, with a largest residual of 1/2; of x^3 it is 3/4 x, with 1/4.
        let n = 2001;
        let x: Vec<f64> = (0..n).map(|i| f64::from(i - 1000) / 1000.0).collect();
        let fit = MinimaxFit::new(x.len(), &[vec![1.0; x.len()], x.clone()]);
        let power = |x: &f64, n: usize| std::iter::repeat_n(x, n).product::<f64>();
        let of = |n: usize| fit.fit(&x.iter().map(|x| power(x, n)).collect::<Vec<_>>()).half_width;
        assert!((of(2) - 0.5).abs() < 1e-12 && (of(3) - 0.25).abs() < 1e-6, "{} {}", of(2), of(3));
        assert!(of(1) < 1e-15);
    }

    #[test]
    fn large_and_degenerate_fits_prove_themselves() {
        let mut numbers = Numbers(3);
        for k in [1, 3, 5, 6] {
            let columns = columns_of(&mut numbers, 20_000, k, k == 3);
            let values: Vec<f64> = (0..20_000).map(|_| numbers.next()).collect();
            let found = MinimaxFit::new(values.len(), &columns).fit(&values);
            assert!(found.half_width - found.lower <= 1e-10, "{k}: {} {}", found.half_width, found.lower);
        }
        // Nothing to fit, nothing to fit it to, and columns that say the same.
        let none = MinimaxFit::new(3, &[]).fit(&[1.0, -2.0, 0.5]);
        assert_eq!((none.half_width, none.weights.as_slice()), (2.0, &[(1, -1.0)][..]));
        assert_eq!(MinimaxFit::new(1, &[vec![1.0]]).fit(&[5.0]).half_width, 0.0);
        let twice = MinimaxFit::new(3, &[vec![1.0; 3], vec![2.0; 3]]);
        assert_eq!((twice.rank(), twice.fit(&[0.0, 3.0, 1.0]).half_width), (1, 1.5));
        assert_eq!(twice.fit(&[0.0; 3]).half_width, 0.0);
    }
}
