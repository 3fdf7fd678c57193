//! Products of two tables over one axis each, for controllers that multiply tables.
//!
//! A table over two axes is written as a sum of products f(a) g(b), the largest singular parts of its values first: an
//! angle that depends on one position times a lever that is another one is such a product. Each product is written as
//! two halves, f g and (-f) (-g). No manual states whether the controller also adds the factor tables themselves; if it
//! does, their contributions cancel.

use super::increment::Increment;
use super::tables::{CorrectionTable, Factors};
use crate::machine::AxisKind;

/// Tables that a product takes: f, g, -f and -g.
pub const TABLES_OF_A_PRODUCT: usize = 4;

/// Steps of the power iteration. Where two parts are nearly equal it may stop between them; the residual of the first
/// goes into the second.
const STEPS: usize = 60;

/// Returns at most `max_parts` of the largest singular parts of values (row by row, `columns` in a row), largest first,
/// without those that are nowhere above `threshold`.
pub(super) fn parts(values: &[f64], columns: usize, max_parts: usize, threshold: f64) -> Vec<Factors> {
    let mut rest = values.to_vec();
    let mut found = Vec::new();
    while found.len() < max_parts.min(columns).min(values.len() / columns.max(1)) {
        let [u, v] = largest(&rest, columns);
        if peak(&u) * peak(&v) <= threshold {
            break;
        }
        for (row, a) in rest.chunks_mut(columns).zip(&u) {
            row.iter_mut().zip(&v).for_each(|(x, b)| *x -= a * b);
        }
        found.push([u, v]);
    }
    found
}

pub(super) fn sum(parts: &[Factors], nodes: usize) -> Vec<f64> {
    let mut values = vec![0.0; nodes];
    for part in parts {
        values.iter_mut().zip(outer(part)).for_each(|(value, x)| *value += x);
    }
    values
}

/// The root of the mean square of a part.
pub(super) fn strength([u, v]: &Factors) -> f64 {
    libm::sqrt(dot(u, u) * dot(v, v) / (u.len() * v.len()).max(1) as f64)
}

pub(super) fn largest_value([u, v]: &Factors) -> f64 {
    peak(u) * peak(v)
}

fn largest(values: &[f64], columns: usize) -> Factors {
    let rows: Vec<&[f64]> = values.chunks(columns).collect();
    let strongest = rows.iter().max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
    let mut v = strongest.map_or_else(Vec::new, |row| row.to_vec());
    let mut u = vec![0.0; rows.len()];
    for _ in 0..STEPS {
        let square = dot(&v, &v);
        if square == 0.0 {
            break;
        }
        u = rows.iter().map(|row| dot(row, &v) / square).collect();
        let square = dot(&u, &u);
        if square == 0.0 {
            break;
        }
        v = (0..columns).map(|j| rows.iter().zip(&u).map(|(row, a)| row[j] * a).sum::<f64>() / square).collect();
    }
    equalise([u, v])
}

/// Both factors equally large: neither would move the machine far if it were added alone.
fn equalise([mut u, mut v]: Factors) -> Factors {
    let (a, b) = (peak(&u), peak(&v));
    if a > 0.0 && b > 0.0 {
        let scale = libm::sqrt(b / a);
        u.iter_mut().for_each(|x| *x *= scale);
        v.iter_mut().for_each(|x| *x /= scale);
    }
    [u, v]
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |max, x| f64::max(max, x.abs()))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// f times g, node by node (the second axis fastest).
fn outer([f, g]: &Factors) -> impl Iterator<Item = f64> {
    f.iter().flat_map(move |a| g.iter().map(move |b| a * b))
}

impl CorrectionTable {
    /// Returns the number of the controller's tables that this table takes; `apart` if each direction has its own.
    pub fn count(&self, apart: bool) -> usize {
        match (self.factors.len(), &self.reverse) {
            (0, Some(reverse)) if apart && *reverse != self.values => 2,
            (0, _) => 1,
            (products, _) => TABLES_OF_A_PRODUCT * products,
        }
    }

    /// Replaces the values by what the table's number of products can hold of them, the factors rounded. `closed` marks
    /// the axes over which the table begins again where it ends.
    pub(super) fn factorise(&mut self, increment: Increment, kind: AxisKind, closed: [bool; 2]) {
        let columns = self.nodes[1].len();
        let stored = |mut factor: Vec<f64>, closed: bool| {
            factor.iter_mut().for_each(|x| *x = increment.correction(*x * libm::sqrt(0.5), kind));
            if let ([first, .., last], true) = (&mut factor[..], closed) {
                *last = *first;
            }
            factor
        };
        let parts = parts(&self.values, columns, self.factors.len(), increment.half_correction(kind));
        self.factors = parts.into_iter().map(|[u, v]| [stored(u, closed[0]), stored(v, closed[1])]).collect();
        self.factors.retain(|factors| largest_value(factors) > 0.0);
        self.values = vec![0.0; self.len()];
        for factors in &self.factors {
            for _ in 0..2 {
                self.values.iter_mut().zip(outer(factors)).for_each(|(value, x)| *value += x);
            }
        }
    }

    /// Returns the table of a product over two axes that corrects what both factors correct.
    pub fn product(first: &Self, second: &Self, factors: Factors) -> Self {
        Self {
            axes: [&first.axes[..], &second.axes].concat(),
            nodes: [&first.nodes[..], &second.nodes].concat(),
            corrected: first.corrected.clone(),
            values: outer(&factors).collect(),
            reverse: None,
            factors: vec![factors],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let at = |i: usize| i as f64 / 10.0;
        (0..11).flat_map(|i| (0..7).map(move |j| (at(i), at(j)))).map(|(x, y)| f(x, y)).collect()
    }

    #[test]
    fn an_angle_times_a_lever_is_one_product() {
        let values = matrix(|x, y| (libm::sin(5.0 * x) + 0.3) * (y - 0.35));
        let found = parts(&values, 7, 5, 1e-12);
        assert_eq!(found.len(), 1);
        let gap = sum(&found, values.len()).iter().zip(&values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gap < 1e-14, "{gap}");
        // Both factors are equally large.
        assert!((peak(&found[0][0]) - peak(&found[0][1])).abs() < 1e-14);
    }

    /// x y + x^2 y^2 on a grid: the residual of two parts is rounding, that of one is the second singular value.
    #[test]
    fn parts_come_largest_first() {
        let values = matrix(|x, y| x * y + x * x * y * y);
        let found = parts(&values, 7, 5, 1e-12);
        assert_eq!(found.len(), 2);
        assert!(strength(&found[0]) > 10.0 * strength(&found[1]));
        assert!(dot(&found[0][0], &found[1][0]).abs() < 1e-9 && dot(&found[0][1], &found[1][1]).abs() < 1e-9);
        assert!(parts(&[0.0; 77], 7, 5, 0.0).is_empty());
    }
}
