//! Rotations and motions over D_n, the dual numbers of order n: which matrices they are, and their error classes.
//!
//! A matrix is a list of coefficients, its powers of i. C is in O(n, D_k) exactly if C^T C = 1 in every degree.
//! Then C = exp(W) A with A = C_0 and W = i W_1 + ... + i^k W_k skew: the W_j are its errors.

use nalgebra::{DMatrix, DVector};

/// A matrix over D_n, its coefficients by degree.
pub type DualMatrix = Vec<DMatrix<f64>>;

/// A rotation or motion over D_n: the nominal one and its errors of each degree.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// Rotation A of the nominal motion.
    pub rotation: DMatrix<f64>,
    /// Its translation, mm; zero of a rotation.
    pub translation: DVector<f64>,
    /// Errors about fixed axes, E N, from degree 1 on.
    pub before: Vec<ErrorOfDegree>,
    /// Errors in the moved frame, N E.
    pub after: Vec<ErrorOfDegree>,
}

/// The errors of one degree: E = [exp(W), d].
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorOfDegree {
    /// Coefficient of d, mm.
    pub displacement: DVector<f64>,
    /// Coefficient of W: a skew matrix, rad.
    pub rotation: DMatrix<f64>,
}

/// The reason for which a matrix over D_n is no rotation or motion with small errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AdmissibilityFailure {
    /// The last row is not 0 ... 0 1; largest difference.
    LastRow(f64),
    /// The real block is not orthogonal; largest entry of A^T A - 1.
    NotOrthogonal(f64),
    /// The real block is a reflection.
    Reflection,
    /// C^T C has an entry in a degree above 0. On the diagonal it is a stretch, elsewhere a shear.
    Degree {
        /// The lowest such degree.
        degree: usize,
        /// Largest entry.
        size: f64,
        /// Its row and column from 0.
        at: (usize, usize),
    },
}

/// Splits a rotation, or with `affine` a motion whose last row is 0 ... 0 1, into its nominal part and its errors.
/// `tolerance` is for entries without a unit; higher degrees are compared with their own size.
pub fn split(matrix: &[DMatrix<f64>], affine: bool, tolerance: f64) -> Result<Split, AdmissibilityFailure> {
    let size = matrix.first().map_or(0, DMatrix::ncols);
    let n = size - usize::from(affine && size > 0);
    if affine {
        last_row(matrix, n, tolerance)?;
    }
    let block: DualMatrix = matrix.iter().map(|m| m.view((0, 0), (n, n)).into_owned()).collect();
    orthogonal(&block, tolerance)?;
    let Some(a) = block.first().filter(|a| a.determinant() > 0.0) else {
        return Err(AdmissibilityFailure::Reflection);
    };
    let column = |m: &DMatrix<f64>| match affine {
        true => m.view((0, n), (n, 1)).column(0).into_owned(),
        false => DVector::zeros(n),
    };
    let columns: Vec<DVector<f64>> = matrix.iter().map(column).collect();
    let turned: DualMatrix = block.iter().map(|m| m * a.transpose()).collect();
    let logarithm = logarithm(&turned);
    let translation = columns.first().cloned().unwrap_or_else(|| DVector::zeros(n));
    let degrees = 1..block.len();
    let before = degrees.clone().map(|k| ErrorOfDegree {
        displacement: &columns[k] - &turned[k] * &translation,
        rotation: logarithm[k].clone(),
    });
    let after = degrees.map(|k| ErrorOfDegree {
        displacement: a.transpose() * &columns[k],
        rotation: a.transpose() * &logarithm[k] * a,
    });
    let (before, after) = (before.collect(), after.collect());
    Ok(Split { rotation: a.clone(), translation, before, after })
}

fn last_row(matrix: &[DMatrix<f64>], n: usize, tolerance: f64) -> Result<(), AdmissibilityFailure> {
    let gap = |(degree, m): (usize, &DMatrix<f64>)| {
        let wanted = |j: usize| if degree == 0 && j == n { 1.0 } else { 0.0 };
        (0..=n).map(|j| (m[(n, j)] - wanted(j)).abs()).fold(0.0, f64::max)
    };
    let last = matrix.iter().enumerate().map(gap).fold(0.0, f64::max);
    if last > tolerance { Err(AdmissibilityFailure::LastRow(last)) } else { Ok(()) }
}

/// C^T C = 1, degree by degree.
fn orthogonal(block: &[DMatrix<f64>], tolerance: f64) -> Result<(), AdmissibilityFailure> {
    for degree in 0..block.len() {
        let products = || (0..=degree).map(|j| (&block[j], &block[degree - j]));
        let sum = products().map(|(a, b)| a.transpose() * b).reduce(|sum, next| sum + next);
        let Some(mut defect) = sum else { continue };
        if degree == 0 {
            defect -= DMatrix::identity(defect.nrows(), defect.ncols());
            let largest = defect.amax();
            if largest > tolerance {
                return Err(AdmissibilityFailure::NotOrthogonal(largest));
            }
            continue;
        }
        let scale = products().map(|(a, b)| a.amax() * b.amax()).fold(block[degree].amax(), f64::max);
        let at = defect.map(f64::abs).iamax_full();
        let size = defect[at].abs();
        if size > tolerance * scale {
            return Err(AdmissibilityFailure::Degree { degree, size, at });
        }
    }
    Ok(())
}

/// Returns the logarithm of a matrix whose real part is 1: a finite series.
fn logarithm(matrix: &[DMatrix<f64>]) -> DualMatrix {
    let n = matrix.first().map_or(0, DMatrix::nrows);
    let zero = || vec![DMatrix::zeros(n, n); matrix.len()];
    let mut nilpotent = matrix.to_vec();
    nilpotent.iter_mut().take(1).for_each(|real| real.fill(0.0));
    let (mut sum, mut power) = (zero(), zero());
    power.iter_mut().take(1).for_each(|real| real.fill_with_identity());
    for m in 1..matrix.len() {
        let mut next = zero();
        for (i, j) in (0..matrix.len()).flat_map(|i| (0..matrix.len() - i).map(move |j| (i, j))) {
            next[i + j] += &power[i] * &nilpotent[j];
        }
        power = next;
        let factor = if m % 2 == 1 { 1.0 } else { -1.0 } / m as f64;
        sum.iter_mut().zip(&power).for_each(|(sum, power)| *sum += power * factor);
    }
    // Skew up to rounding, and here exactly.
    sum.iter().map(|w| (w - w.transpose()) * 0.5).collect()
}

/// Returns a basis of the error class I^A of an orthogonal matrix: A times each elementary skew matrix, so that
/// A^T B is skew.
pub fn error_class(a: &DMatrix<f64>) -> Vec<DMatrix<f64>> {
    let n = a.nrows();
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    let skew = |(i, j): (usize, usize)| {
        let mut w = DMatrix::zeros(n, n);
        (w[(i, j)], w[(j, i)]) = (-1.0, 1.0);
        w
    };
    pairs.map(|pair| a * skew(pair)).collect()
}

/// Returns the largest entry of A^T [F, G] + [F, G]^T A over all pairs of a basis of I^A: 0 exactly if I^A is closed
/// under the commutator, and so a Lie algebra.
pub fn commutator_defect(a: &DMatrix<f64>) -> f64 {
    let basis = error_class(a);
    let pairs = basis.iter().enumerate().flat_map(|(i, f)| basis.iter().skip(i + 1).map(move |g| (f, g)));
    let defect = |(f, g): (&DMatrix<f64>, &DMatrix<f64>)| {
        let product = a.transpose() * (f * g - g * f);
        (&product + product.transpose()).amax()
    };
    pairs.map(defect).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    type M = DMatrix<f64>;

    fn turn(angle: f64) -> M {
        let (s, c) = libm::sincos(angle);
        M::from_row_slice(3, 3, &[c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0])
    }

    /// `[A, t; 0, 1]`, or without the 1.
    fn affine(a: &M, t: [f64; 3], one: f64) -> M {
        let mut m = M::zeros(4, 4);
        m.view_mut((0, 0), (3, 3)).copy_from(a);
        (0..3).for_each(|i| m[(i, 3)] = t[i]);
        m[(3, 3)] = one;
        m
    }

    /// The angle 0.7 + 1e-5 i - 2e-6 i^2 about z by the derivatives of sine and cosine, with a translation.
    fn motion() -> DualMatrix {
        let (s, c) = libm::sincos(0.7);
        let (k, m) = (1e-5, -2e-6);
        let first = [-s * k, -c * k, c * k, -s * k];
        let half = k * k / 2.0;
        let second = [-s * m - c * half, -c * m + s * half, c * m - s * half, -s * m - c * half];
        let block = |f: [f64; 4]| M::from_row_slice(3, 3, &[f[0], f[1], 0.0, f[2], f[3], 0.0, 0.0, 0.0, 0.0]);
        vec![
            affine(&turn(0.7), [100.0, -50.0, 20.0], 1.0),
            affine(&block(first), [0.01, 0.02, -0.03], 0.0),
            affine(&block(second), [0.0, 1e-6, 0.0], 0.0),
        ]
    }

    #[test]
    fn a_motion_is_split_into_what_it_was_made_of() {
        let found = split(&motion(), true, 1e-9).unwrap();
        let w = |k: usize| found.before[k].rotation[(1, 0)];
        assert!((w(0) - 1e-5).abs() < 1e-15 && (w(1) + 2e-6).abs() < 1e-15, "{:?}", found.before);
        // The first degree of t - exp(W) t_0: (0.01, 0.02, -0.03) - 1e-5 (50, 100, 0).
        let d = &found.before[0].displacement;
        assert!((d - DVector::from_row_slice(&[0.0095, 0.019, -0.03])).amax() < 1e-15, "{d}");
        // N E: A d' is the coefficient itself.
        let again = turn(0.7) * &found.after[0].displacement;
        assert!((again - DVector::from_row_slice(&[0.01, 0.02, -0.03])).amax() < 1e-15);
    }

    #[test]
    fn what_is_no_motion_is_named() {
        let with = |degree: usize, at: (usize, usize), by: f64| {
            let mut other = motion();
            other[degree][at] += by;
            split(&other, true, 1e-9).unwrap_err()
        };
        assert!(matches!(with(0, (3, 0), 0.1), AdmissibilityFailure::LastRow(_)));
        assert!(matches!(with(0, (0, 0), 0.1), AdmissibilityFailure::NotOrthogonal(_)));
        let AdmissibilityFailure::Degree { degree: 2, size, at: (2, 2) } = with(2, (2, 2), 1e-6) else {
            panic!("the stretch")
        };
        assert!((size - 2e-6).abs() < 1e-18);
        let mut mirrored = motion();
        mirrored.iter_mut().for_each(|m| m.column_mut(2).neg_mut());
        mirrored.iter_mut().for_each(|m| m.column_mut(3).neg_mut());
        mirrored.iter_mut().for_each(|m| m.column_mut(3).neg_mut());
        assert_eq!(split(&mirrored, true, 1e-9), Err(AdmissibilityFailure::Reflection));
    }

    #[test]
    fn error_classes_are_closed_for_symmetric_matrices() {
        assert!(commutator_defect(&M::identity(4, 4)) < 1e-15);
        assert!(commutator_defect(&turn(0.7)) > 0.5);
        assert!(commutator_defect(&M::from_row_slice(2, 2, &[0.6, -0.8, 0.8, 0.6])) < 1e-15);
    }
}
