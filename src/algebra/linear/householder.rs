//! Triangle of a tall matrix by Householder reflections, some columns at a time: their product is `1 - V T V^T`
//! (Schreiber and Van Loan 1989), which the other columns meet as three matrix products.

use nalgebra::{DMatrix, DVector};

/// Columns taken together.
const PANEL: usize = 16;

/// R of the QR decomposition: as many rows as the smaller dimension. Signs of its rows are arbitrary.
pub fn triangle(mut a: DMatrix<f64>) -> DMatrix<f64> {
    let (m, n) = a.shape();
    let size = m.min(n);
    let mut first = 0;
    while first < size {
        let width = PANEL.min(size - first);
        let (v, t) = panel(&mut a, first, width);
        update(&mut a, first, width, &v, &t);
        first += width;
    }
    DMatrix::from_fn(size, n, |i, j| if i <= j { a[(i, j)] } else { 0.0 })
}

/// Reflects the columns from `first` on, below the rows done; gives the vectors V and the triangle T.
fn panel(a: &mut DMatrix<f64>, first: usize, width: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let rows = a.nrows() - first;
    let mut v = DMatrix::zeros(rows, width);
    let mut t = DMatrix::zeros(width, width);
    for k in 0..width {
        let Some((vector, tau)) = reflection(&a.view((first + k, first + k), (rows - k, 1)).column(0).into_owned())
        else {
            continue;
        };
        for j in k..width {
            let mut column = a.view_mut((first + k, first + j), (rows - k, 1));
            let along = vector.dot(&column.column(0)) * tau;
            column.column_mut(0).axpy(-along, &vector, 1.0);
        }
        v.view_mut((k, k), (rows - k, 1)).copy_from(&vector);
        // T grows by a column: -tau T (V^T v).
        let above: Vec<f64> = (0..k).map(|j| v.view((k, j), (rows - k, 1)).column(0).dot(&vector)).collect();
        for i in 0..k {
            t[(i, k)] = -tau * (i..k).map(|j| t[(i, j)] * above[j]).sum::<f64>();
        }
        t[(k, k)] = tau;
    }
    (v, t)
}

/// The reflection that leaves a multiple of the first unit vector: `1 - tau v v^T`; none of what is zero there already.
fn reflection(x: &DVector<f64>) -> Option<(DVector<f64>, f64)> {
    let norm = x.norm();
    if norm == 0.0 || !norm.is_finite() {
        return None;
    }
    let head = x[0] + norm.copysign(x[0]);
    let mut v = x / head;
    v[0] = 1.0;
    Some((v, head / norm.copysign(x[0])))
}

/// The columns behind the panel: `C - V (T^T (V^T C))`.
fn update(a: &mut DMatrix<f64>, first: usize, width: usize, v: &DMatrix<f64>, t: &DMatrix<f64>) {
    let (rows, behind) = (a.nrows() - first, a.ncols() - first - width);
    if behind == 0 {
        return;
    }
    let mut rest = a.view_mut((first, first + width), (rows, behind));
    let mut along = DMatrix::zeros(width, behind);
    along.gemm(1.0, &v.transpose(), &rest, 0.0);
    let turned = t.transpose() * along;
    rest.gemm(-1.0, v, &turned, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_has_the_columns_lengths_and_angles(rows in 1_usize..60, columns in 1_usize..45, rank in 1_usize..45, seed in 0_u64..1000) {
            let number = |i: usize, j: usize| libm::sin((seed + 1) as f64 * 0.37 + i as f64 * 12.9898 + j as f64 * 78.233) * 3.0;
            let left = DMatrix::from_fn(rows, rank, number);
            let a = left * DMatrix::from_fn(rank, columns, |i, j| number(j + 7, i + 3));
            let r = triangle(a.clone());
            prop_assert_eq!(r.nrows(), rows.min(columns));
            prop_assert!((r.transpose() * &r - a.transpose() * &a).amax() < 1e-12 * (1.0 + a.norm_squared()));
            prop_assert!((0..r.nrows()).all(|i| (0..i.min(columns)).all(|j| r[(i, j)] == 0.0)));
        }
    }

    #[test]
    fn nothing_stays_nothing() {
        assert_eq!(triangle(DMatrix::zeros(5, 3)), DMatrix::zeros(3, 3));
    }
}
