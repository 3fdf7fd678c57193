//! Least squares: rows streamed into a triangle (blockwise TSQR), its singular values and vectors by
//! one-sided Jacobi rotations, rank, null space and covariance.
//!
//! Error parameters that the data do not separate make the matrices here short of rank as a rule, not as an exception.
//! nalgebra's singular vectors are wrong there (nalgebra#1172): only its QR is used.

mod householder;

use nalgebra::{DMatrix, DVector};

/// Rows that are collected before they are folded into the triangle: few enough for the cache.
const BLOCK: usize = 256;

/// Sweeps of Jacobi rotations; quadratic convergence needs about ten.
const SWEEPS: usize = 60;

/// The triangle R and the transformed right side of a least-squares problem `min |J x - r|`. Rows go in,
/// nothing but `(n + 1)^2` numbers stay: memory does not grow with the rows.
#[derive(Debug, Clone)]
pub struct Triangle {
    unknowns: usize,
    rows: usize,
    buffer: Vec<f64>,
    folded: DMatrix<f64>,
}

/// Returns what is left of a vector once orthonormal ones have been taken off it.
pub fn beside(mut vector: DVector<f64>, orthonormal: &[DVector<f64>]) -> DVector<f64> {
    // Twice is enough (Kahan).
    for _ in 0..2 {
        for known in orthonormal {
            let share = known.dot(&vector);
            vector.axpy(-share, known, 1.0);
        }
    }
    vector
}

/// Returns a matrix with each column divided by its scale.
pub fn over_columns(matrix: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] / scale[j])
}

impl Triangle {
    /// No rows yet.
    pub fn new(unknowns: usize) -> Self {
        let width = unknowns + 1;
        Self { unknowns, rows: 0, buffer: Vec::new(), folded: DMatrix::zeros(width, width) }
    }

    /// Adds one row: coefficients, then the right side.
    pub fn push(&mut self, coefficients: impl IntoIterator<Item = f64>, right: f64) {
        let unknowns = self.unknowns;
        let row = self.extend(1);
        row.iter_mut().zip(coefficients).for_each(|(place, coefficient)| *place = coefficient);
        row[unknowns] = right;
    }

    /// Adds room for `rows` more rows, each of coefficients and right side, to be written by the caller.
    pub fn extend(&mut self, rows: usize) -> &mut [f64] {
        let width = self.unknowns + 1;
        if self.buffer.len() + rows * width > BLOCK * width {
            self.fold();
        }
        let start = self.buffer.len();
        self.buffer.resize(start + rows * width, 0.0);
        self.rows += rows;
        &mut self.buffer[start..]
    }

    /// Adds the rows of another triangle of as many unknowns.
    pub fn merge(&mut self, mut other: Self) {
        other.fold();
        self.fold();
        self.rows += other.rows;
        householder::fold(&mut self.folded, &mut other.folded);
    }

    /// The rows collected since the last time go into the triangle.
    fn fold(&mut self) {
        let width = self.unknowns + 1;
        let mut fresh = DMatrix::from_row_slice(self.buffer.len() / width, width, &self.buffer);
        self.buffer.clear();
        householder::fold(&mut self.folded, &mut fresh);
    }

    /// R (square, as many rows as unknowns) and Q^T r.
    pub fn finish(mut self) -> ReducedSystem {
        self.fold();
        let n = self.unknowns;
        ReducedSystem {
            r: self.folded.view((0, 0), (n, n)).into_owned(),
            right: self.folded.view((0, n), (n, 1)).column(0).into_owned(),
            rest: self.folded[(n, n)].abs(),
            rows: self.rows,
        }
    }
}

/// A least-squares problem reduced to a triangle.
#[derive(Debug, Clone)]
pub struct ReducedSystem {
    /// Upper triangle, one column per unknown.
    pub r: DMatrix<f64>,
    /// Right side in the rows of `r`.
    pub right: DVector<f64>,
    /// Norm of the right side below the triangle: out of reach for every x. (Where `r` is short of rank, parts
    /// of `right` are out of reach too.)
    pub rest: f64,
    /// Rows before the reduction.
    pub rows: usize,
}

impl ReducedSystem {
    /// Reduces all rows of a matrix with their right sides.
    pub fn of(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Self {
        let mut triangle = Triangle::new(matrix.ncols());
        matrix.row_iter().zip(right.iter()).for_each(|(row, right)| triangle.push(row.iter().copied(), *right));
        triangle.finish()
    }

    /// Euclidean length of the right side, all rows together.
    pub fn right_norm(&self) -> f64 {
        libm::hypot(self.rest, self.right.norm())
    }

    /// Euclidean length of each column.
    pub fn column_norms(&self) -> DVector<f64> {
        DVector::from_fn(self.r.ncols(), |j, _| self.r.column(j).norm())
    }

    /// Singular values and vectors of R with each column divided by its `scale` (0: the column counts as zero).
    pub fn scaled(&self, scale: &DVector<f64>) -> Svd {
        let column = |i: usize, j: usize| if scale[j] > 0.0 { self.r[(i, j)] / scale[j] } else { 0.0 };
        Svd::new(&DMatrix::from_fn(self.r.nrows(), self.r.ncols(), column))
    }

    /// Returns the same problem with a few more rows, which do not count as readings.
    pub fn with_rows(&self, rows: &DMatrix<f64>, right: &DVector<f64>) -> Self {
        let mut triangle = Triangle::new(self.r.ncols());
        for i in 0..self.r.nrows() {
            triangle.push(self.r.row(i).iter().copied(), self.right[i]);
        }
        for i in 0..rows.nrows() {
            triangle.push(rows.row(i).iter().copied(), right[i]);
        }
        let reduced = triangle.finish();
        Self { rest: libm::hypot(reduced.rest, self.rest), rows: self.rows, ..reduced }
    }

    /// About the ratio of largest to smallest singular value, columns scaled to unit length: from below, by a few
    /// steps of inverse iteration.
    pub fn condition(&self) -> f64 {
        let norms = self.column_norms();
        let n = norms.len();
        let r = over_columns(&self.r, &norms);
        let mut x = DVector::from_fn(n, |i, _| if i % 2 == 0 { 1.0 } else { -0.7 } / libm::sqrt(n.max(1) as f64));
        let mut grown = 0.0;
        for _ in 0..12 {
            let Some(half) = r.tr_solve_upper_triangular(&x) else { return f64::INFINITY };
            let Some(whole) = r.solve_upper_triangular(&half) else { return f64::INFINITY };
            grown = whole.norm();
            if !(grown > 0.0 && grown.is_finite()) {
                return f64::INFINITY;
            }
            x = whole / grown;
        }
        // The largest singular value of n columns of unit length is at most the root of n.
        libm::sqrt(grown * n as f64)
    }

    /// Rank: singular values above `relative` of the largest, columns scaled to unit length. A column
    /// below `relative` of the longest one, in the units of the caller, counts as zero.
    pub fn rank(&self, relative: f64) -> usize {
        self.scaled(&self.column_norms()).rank(relative)
    }
}

/// `A = U diag(values) V^T` with values in falling order; right vectors are complete, also for values of 0.
#[derive(Debug, Clone)]
pub struct Svd {
    /// Singular values, falling.
    pub values: DVector<f64>,
    /// Left vectors; zero if the value is zero.
    pub u: DMatrix<f64>,
    /// Right vectors, orthonormal.
    pub v: DMatrix<f64>,
}

impl Svd {
    /// Computes the decomposition by one-sided Jacobi rotations. Works on any rank; meant for triangles of up to some
    /// hundred columns.
    pub fn new(matrix: &DMatrix<f64>) -> Self {
        let n = matrix.ncols();
        let (mut a, mut v) = (matrix.clone(), DMatrix::identity(n, n));
        let floor = matrix.norm() * f64::EPSILON * f64::EPSILON;
        for _ in 0..SWEEPS {
            let mut turned = false;
            for p in 0..n {
                for q in p + 1..n {
                    turned |= orthogonalise(&mut a, &mut v, p, q, floor);
                }
            }
            if !turned {
                break;
            }
        }
        Self::in_falling_order(&a, &v)
    }

    fn in_falling_order(a: &DMatrix<f64>, v: &DMatrix<f64>) -> Self {
        let norms: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
        let mut order: Vec<usize> = (0..norms.len()).collect();
        order.sort_by(|i, j| norms[*j].total_cmp(&norms[*i]).then(i.cmp(j)));
        let unit = |i: usize, j: usize| if norms[order[j]] > 0.0 { a[(i, order[j])] / norms[order[j]] } else { 0.0 };
        Self {
            values: DVector::from_fn(norms.len(), |j, _| norms[order[j]]),
            u: DMatrix::from_fn(a.nrows(), a.ncols(), unit),
            v: DMatrix::from_fn(v.nrows(), v.ncols(), |i, j| v[(i, order[j])]),
        }
    }

    /// Returns the number of singular values above `relative` of the largest.
    pub fn rank(&self, relative: f64) -> usize {
        let largest = self.values.iter().copied().fold(0.0, f64::max);
        self.values.iter().filter(|value| **value > relative * largest && **value > 0.0).count()
    }

    /// Returns the shortest x that minimises `|A x - right|`, the `rank` largest values in use.
    pub fn solve(&self, right: &DVector<f64>, rank: usize) -> DVector<f64> {
        let mut x = DVector::zeros(self.v.nrows());
        for k in 0..rank {
            x.axpy(self.u.column(k).dot(right) / self.values[k], &self.v.column(k), 1.0);
        }
        x
    }

    /// Returns the x that minimises `|A x - right|^2 + pull |x + away|^2 + damping |x|^2`: a damped step from the
    /// distance `away` to a home position that attracts it; the `rank` largest values are in use.
    pub fn step(
        &self,
        right: &DVector<f64>,
        rank: usize,
        away: &DVector<f64>,
        pull: f64,
        damping: f64,
    ) -> DVector<f64> {
        let mut x = DVector::zeros(self.v.nrows());
        for k in 0..rank {
            let stiffness = self.values[k] * self.values[k] + pull + damping;
            let force = self.values[k] * self.u.column(k).dot(right) - pull * self.v.column(k).dot(away);
            x.axpy(force / stiffness, &self.v.column(k), 1.0);
        }
        x
    }

    /// Orthonormal basis of the null space of A, the columns of the result.
    pub fn null_space(&self, rank: usize) -> DMatrix<f64> {
        self.v.columns(rank, self.v.ncols() - rank).into_owned()
    }

    /// Root of the covariance of the shortest solution for right sides of unit variance: `R = V S^-1` over the rank,
    /// the covariance is `R R^T`.
    pub fn root_covariance(&self, rank: usize) -> DMatrix<f64> {
        DMatrix::from_fn(self.v.nrows(), rank, |i, k| self.v[(i, k)] / self.values[k])
    }
}

/// Makes two columns orthogonal; false if they are already.
fn orthogonalise(a: &mut DMatrix<f64>, v: &mut DMatrix<f64>, p: usize, q: usize, floor: f64) -> bool {
    let (alpha, beta) = (a.column(p).norm_squared(), a.column(q).norm_squared());
    let gamma = a.column(p).dot(&a.column(q));
    // Columns of rounding noise are skipped: they have no direction to be made orthogonal.
    if gamma.abs() <= 3e-15 * (alpha * beta).sqrt() || alpha.min(beta).sqrt() <= floor {
        return false;
    }
    let zeta = (beta - alpha) / (2.0 * gamma);
    let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let c = 1.0 / (1.0 + t * t).sqrt();
    rotate(a, p, q, c, c * t);
    rotate(v, p, q, c, c * t);
    true
}

fn rotate(m: &mut DMatrix<f64>, p: usize, q: usize, c: f64, s: f64) {
    for i in 0..m.nrows() {
        let (x, y) = (m[(i, p)], m[(i, q)]);
        m[(i, p)] = c * x - s * y;
        m[(i, q)] = s * x + c * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// `rows x columns` of the given rank: a product of two random factors.
    fn deficient() -> impl Strategy<Value = (DMatrix<f64>, usize, DVector<f64>)> {
        (1_usize..9, 0_usize..30).prop_flat_map(|(columns, more)| {
            let rows = columns + more;
            (0..=columns).prop_flat_map(move |rank| {
                let left = prop::collection::vec(-1.0..1.0_f64, rows * rank);
                let right = prop::collection::vec(-1.0..1.0_f64, rank * columns);
                let b = prop::collection::vec(-1.0..1.0_f64, rows);
                (left, right, b).prop_map(move |(l, r, b)| {
                    let product = DMatrix::from_vec(rows, rank, l) * DMatrix::from_vec(rank, columns, r);
                    (product, rank, DVector::from_vec(b))
                })
            })
        })
    }

    proptest! {
        #[test]
        fn singular_values_and_vectors_make_up_the_matrix((a, rank, b) in deficient()) {
            let reduced = ReducedSystem::of(&a, &b);
            let svd = Svd::new(&reduced.r);
            prop_assert!((&reduced.r.transpose() * &reduced.r - a.transpose() * &a).amax() < 1e-12);
            let again = &svd.u * DMatrix::from_diagonal(&svd.values) * svd.v.transpose();
            prop_assert!((again - &reduced.r).amax() < 1e-13);
            let n = a.ncols();
            prop_assert!((svd.v.transpose() * &svd.v - DMatrix::identity(n, n)).amax() < 1e-13);
            prop_assert!(svd.rank(1e-10) <= rank);
        }

        #[test]
        fn the_solution_is_the_shortest_of_the_best((a, _, b) in deficient()) {
            let reduced = ReducedSystem::of(&a, &b);
            let svd = Svd::new(&reduced.r);
            let rank = svd.rank(1e-7);
            // Between rank and noise there must be a gap, or the question has no answer.
            prop_assume!(rank == svd.rank(1e-12));
            let x = svd.solve(&reduced.right, rank);
            // Best: the rest is orthogonal to every column. Shortest: x has no part in the null space.
            let rest = &b - &a * &x;
            prop_assert!((a.transpose() * &rest).amax() < 1e-7, "{}", (a.transpose() * &rest).amax());
            prop_assert!((rest.norm() - reduced.rest.hypot((&reduced.right - &reduced.r * &x).norm())).abs() < 1e-9);
            let null = svd.null_space(rank);
            prop_assert!((&a * &null).amax() < 1e-10);
            prop_assert!((null.transpose() * &x).iter().all(|part| part.abs() < 1e-9 * x.norm().max(1.0)));
        }

        #[test]
        fn blocks_and_merging_change_nothing((a, _, b) in deficient(), cut in 0.0..1.0_f64) {
            let cut = (cut * a.nrows() as f64) as usize;
            let mut parts = [Triangle::new(a.ncols()), Triangle::new(a.ncols())];
            for i in 0..a.nrows() {
                parts[usize::from(i >= cut)].push(a.row(i).iter().copied().collect::<Vec<_>>(), b[i]);
            }
            let [mut first, second] = parts;
            first.merge(second);
            prop_assert_eq!(first.rows, a.nrows());
            let (merged, whole) = (first.finish(), ReducedSystem::of(&a, &b));
            prop_assert!((merged.r.transpose() * &merged.r - whole.r.transpose() * &whole.r).amax() < 1e-12);
            prop_assert!((merged.right_norm() - b.norm()).abs() < 1e-12);
            prop_assert!((whole.right_norm() - b.norm()).abs() < 1e-12);
        }
    }

    #[test]
    fn many_rows_are_folded_on_the_way() {
        let mut triangle = Triangle::new(2);
        for i in 0..5000 {
            let x = f64::from(i) / 1000.0;
            triangle.push([1.0, x], 3.0 - 2.0 * x);
        }
        let reduced = triangle.finish();
        let svd = Svd::new(&reduced.r);
        let x = svd.solve(&reduced.right, 2);
        assert!((x[0] - 3.0).abs() < 1e-12 && (x[1] + 2.0).abs() < 1e-12, "{x}");
        assert!(reduced.rest < 1e-10 && reduced.rows == 5000);
    }

    /// nalgebra's own decomposition gives 4.541 here.
    #[test]
    fn a_matrix_of_ones_has_one_value() {
        let svd = Svd::new(&DMatrix::from_element(3, 5, 1.0));
        assert!((svd.values[0] - 15.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(svd.rank(1e-10), 1);
    }
}
