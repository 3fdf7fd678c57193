//! Linear systems by elimination with pivots chosen by their real part, and Newton's iteration.
//!
//! The algebras are local rings: an element divides exactly where its real part is not zero, so a
//! matrix has an inverse exactly if its real part has one, and elimination finds it. Newton's
//! iteration doubles the degree up to which it is right at every step, so over a nilpotent algebra
//! it is exact after finitely many: no Groebner basis is needed for the inverse problem.

use super::{Algebra, Tangent};

/// The real part of the matrix has no inverse: no pivot for this column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Singular {
    /// The column, from 0.
    pub column: usize,
}

/// Real parts below this fraction of the largest one of the matrix are rounding, not pivots.
const RANK: f64 = 1e-12;

/// Solves `matrix x = right`; the matrix is square, given by rows.
pub fn solve<S: Algebra>(mut matrix: Vec<Vec<S>>, mut right: Vec<S>) -> Result<Vec<S>, Singular> {
    let n = right.len();
    let largest = matrix.iter().flatten().map(|x| x.real().abs()).fold(0.0, f64::max);
    for column in 0..n {
        let size = |row: &usize| matrix[*row][column].real().abs();
        let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b))).filter(|row| size(row) > RANK * largest);
        let pivot = pivot.ok_or(Singular { column })?;
        let inverse = matrix[pivot][column].recip().ok_or(Singular { column })?;
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        for row in column + 1..n {
            let factor = matrix[row][column].clone() * inverse.clone();
            let pivots = matrix[column].clone();
            for (entry, pivot) in matrix[row].iter_mut().zip(pivots).skip(column) {
                *entry -= factor.clone() * pivot;
            }
            let step = factor * right[column].clone();
            right[row] -= step;
        }
    }
    back_substitute(&matrix, right)
}

/// Solves an upper triangular system.
fn back_substitute<S: Algebra>(matrix: &[Vec<S>], mut x: Vec<S>) -> Result<Vec<S>, Singular> {
    for row in (0..x.len()).rev() {
        let known = (row + 1..x.len()).map(|k| matrix[row][k].clone() * x[k].clone()).fold(S::zero(), |a, b| a + b);
        let inverse = matrix[row][row].recip().ok_or(Singular { column: row })?;
        x[row] = (x[row].clone() - known) * inverse;
    }
    Ok(x)
}

/// Steps after which Newton's iteration over an algebra of this order is exact: `ceil(log2(order + 1))`.
pub fn newton_steps(order: usize) -> usize {
    (0..usize::BITS as usize).find(|steps| (1_usize << steps) > order).unwrap_or(0)
}

/// Returns one step of Newton's iteration on `residual(x) = 0`, as many equations as unknowns. The residual is
/// evaluated on tangents, one unknown after the other: their slopes are the columns of the Jacobian.
pub fn newton_step<S: Algebra>(
    x: &[S],
    residual: impl Fn(&[Tangent<S>]) -> Vec<Tangent<S>>,
) -> Result<Vec<S>, Singular> {
    let along = |k: usize| {
        let slope = |i: usize| if i == k { S::one() } else { S::zero() };
        let at = x.iter().enumerate().map(|(i, x)| Tangent { value: x.clone(), slope: slope(i) });
        residual(&at.collect::<Vec<_>>())
    };
    let columns: Vec<Vec<Tangent<S>>> = (0..x.len()).map(along).collect();
    let row = |i: usize| columns.iter().map(|column| column[i].slope.clone()).collect();
    let right = columns.first().map_or_else(Vec::new, |c| c.iter().map(|r| r.value.clone()).collect());
    let step = solve((0..x.len()).map(row).collect(), right)?;
    Ok(x.iter().cloned().zip(step).map(|(x, step)| x - step).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::Dual;
    use num_traits::Zero;
    use proptest::prelude::*;

    type D4 = Dual<5>;

    fn element() -> impl Strategy<Value = D4> {
        prop::array::uniform5(-1.0..1.0_f64).prop_map(Dual)
    }

    #[test]
    fn steps_double_the_order() {
        assert_eq!([1, 2, 3, 4, 6, 7, 8].map(newton_steps), [1, 2, 2, 3, 3, 3, 4]);
    }

    #[test]
    fn a_matrix_whose_real_part_is_singular_is_refused() {
        let i = D4::first_order(1.0);
        let one = D4::from_real(1.0);
        let matrix = vec![vec![one, one], vec![one, one + i]];
        assert_eq!(solve(matrix, vec![one, one]), Err(Singular { column: 1 }));
    }

    #[test]
    fn newton_takes_exactly_as_many_steps_as_the_order_asks_for() {
        // x^2 = 2 + i, from the real root.
        let target = D4::from_real(2.0) + D4::first_order(1.0);
        let residual = |x: &[Tangent<D4>]| vec![x[0].clone() * x[0].clone() - Tangent::fixed(target)];
        let mut x = vec![D4::from_real(libm::sqrt(2.0))];
        for _ in 0..newton_steps(4) {
            x = newton_step(&x, residual).unwrap();
        }
        let root = target.sqrt().unwrap();
        assert!((x[0] - root).0.iter().all(|d| d.abs() < 1e-15), "{x:?} {root:?}");
    }

    proptest! {
        #[test]
        fn solutions_solve(entries in prop::collection::vec(element(), 9),
                           right in prop::collection::vec(element(), 3)) {
            let matrix: Vec<Vec<D4>> = entries.chunks(3).map(<[D4]>::to_vec).collect();
            let real = nalgebra::Matrix3::from_fn(|i, j| matrix[i][j].real());
            // The fourth order of the inverse of a pivot is its fifth power: rounding that is none of the solver's.
            prop_assume!(real.determinant().abs() > 0.5);
            let x = solve(matrix.clone(), right.clone()).map_err(|_| TestCaseError::fail("singular"))?;
            for (row, right) in matrix.iter().zip(&right) {
                let left = row.iter().zip(&x).map(|(a, x)| *a * *x).fold(D4::zero(), |a, b| a + b);
                let size = x.iter().flat_map(|x| x.0).fold(1.0_f64, |a, b| a.max(b.abs()));
                prop_assert!((left - *right).0.iter().all(|d| d.abs() < 1e-12 * size));
            }
        }
    }
}
