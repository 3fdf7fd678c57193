//! The triangle of a tall matrix by Householder reflections, block by block (TSQR): fresh rows are folded into the
//! triangle of all rows before. Reflection k meets row k of the triangle and the fresh rows only, so that a block costs
//! what its rows cost, however low it is; some reflections at a time, whose product is `1 - V T V^T` (Schreiber and Van
//! Loan 1989), are three matrix products for the other columns.

use nalgebra::DMatrix;

/// Reflections taken together.
const PANEL: usize = 8;

/// Folds rows into an upper triangle of as many columns: `r^T r` grows by `fresh^T fresh`. The rows are used up; signs
/// of the rows of `r` are arbitrary.
pub fn fold(r: &mut DMatrix<f64>, fresh: &mut DMatrix<f64>) {
    let n = r.ncols();
    for first in (0..n).step_by(PANEL) {
        let width = PANEL.min(n - first);
        let t = panel(r, fresh, first, width);
        update(r, fresh, first, width, &t);
    }
}

/// Reflects `width` columns from `first` on. Their residues in `fresh` are the lower parts of the vectors V (the
/// upper are unit vectors); gives the triangle T.
fn panel(r: &mut DMatrix<f64>, fresh: &mut DMatrix<f64>, first: usize, width: usize) -> DMatrix<f64> {
    let mut t = DMatrix::zeros(width, width);
    for k in 0..width {
        let at = first + k;
        let Some(tau) = reflection(r, fresh, at) else {
            fresh.column_mut(at).fill(0.0);
            continue;
        };
        let (done, mut behind) = fresh.columns_range_pair_mut(0..=at, at + 1..);
        let v = done.column(at);
        for (j, mut column) in behind.column_iter_mut().take(width - k - 1).enumerate() {
            let along = tau * (r[(at, at + 1 + j)] + v.dot(&column));
            r[(at, at + 1 + j)] -= along;
            column.axpy(-along, &v, 1.0);
        }
        // T grows by a column: -tau T (V^T v). The upper parts of different vectors are orthogonal.
        let above: Vec<f64> = (0..k).map(|j| done.column(first + j).dot(&v)).collect();
        for i in 0..k {
            t[(i, k)] = -tau * (i..k).map(|j| t[(i, j)] * above[j]).sum::<f64>();
        }
        t[(k, k)] = tau;
    }
    t
}

/// Returns the reflection `1 - tau v v^T` that clears a column below the triangle; v (1 on top) takes the column's
/// place. `None` for a column that is clear.
fn reflection(r: &mut DMatrix<f64>, fresh: &mut DMatrix<f64>, at: usize) -> Option<f64> {
    let (top, below) = (r[(at, at)], fresh.column(at).norm());
    let norm = libm::hypot(top, below);
    if below == 0.0 || !norm.is_finite() {
        return None;
    }
    let image = -norm.copysign(top);
    fresh.column_mut(at).unscale_mut(top - image);
    r[(at, at)] = image;
    Some((image - top) / image)
}

/// The columns behind the panel: `C - V (T^T (V^T C))`.
fn update(r: &mut DMatrix<f64>, fresh: &mut DMatrix<f64>, first: usize, width: usize, t: &DMatrix<f64>) {
    let behind = r.ncols() - first - width;
    if behind == 0 {
        return;
    }
    let (v, mut rest) = fresh.columns_range_pair_mut(first..first + width, first + width..);
    let mut rows = r.view_mut((first, first + width), (width, behind));
    let mut along = rows.clone_owned();
    along.gemm(1.0, &v.transpose(), &rest, 1.0);
    let turned = t.tr_mul(&along);
    rows -= &turned;
    rest.gemm(-1.0, &v, &turned, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_has_the_columns_lengths_and_angles(
            rows in 1_usize..60, columns in 1_usize..45, rank in 1_usize..45, cut in 0_usize..60, seed in 0_u64..1000,
        ) {
            let number =
                |i: usize, j: usize| libm::sin((seed + 1) as f64 * 0.37 + i as f64 * 12.9898 + j as f64 * 78.233) * 3.0;
            let left = DMatrix::from_fn(rows, rank, number);
            let a = left * DMatrix::from_fn(rank, columns, |i, j| number(j + 7, i + 3));
            let mut r = DMatrix::zeros(columns, columns);
            let cut = cut.min(rows);
            fold(&mut r, &mut a.rows(0, cut).into_owned());
            fold(&mut r, &mut a.rows(cut, rows - cut).into_owned());
            prop_assert!((r.transpose() * &r - a.transpose() * &a).amax() < 1e-12 * (1.0 + a.norm_squared()));
            prop_assert!((0..columns).all(|i| (0..i).all(|j| r[(i, j)] == 0.0)));
        }
    }

    #[test]
    fn nothing_stays_nothing() {
        let mut r = DMatrix::zeros(3, 3);
        fold(&mut r, &mut DMatrix::zeros(5, 3));
        assert_eq!(r, DMatrix::zeros(3, 3));
    }

    /// Singular values down to the last digits: columns of the Läuchli matrix, whose normal equations are singular.
    #[test]
    fn it_keeps_what_normal_equations_lose() {
        let small = 1e-10;
        let row = |i: usize, j: usize| if i == 0 { 1.0 } else { f64::from(u8::from(i == j + 1)) * small };
        let mut r = DMatrix::zeros(3, 3);
        fold(&mut r, &mut DMatrix::from_fn(4, 3, row));
        let values = crate::algebra::linear::Svd::new(&r).values;
        assert!((values[0] - libm::sqrt(3.0)).abs() < 1e-15 && (values[2] / small - 1.0).abs() < 1e-4, "{values}");
    }
}
