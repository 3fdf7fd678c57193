//! Motions over D, the dual numbers: the error class of a matrix decides whether it is one.

use nalgebra::{Matrix3, Matrix4, Vector3};

/// A motion over D: nominal motion and six errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// Rotation of the nominal motion.
    pub rotation: Matrix3<f64>,
    /// Its translation, mm.
    pub translation: Vector3<f64>,
    /// The errors about fixed axes, E N: dx, dy, dz (mm), ex, ey, ez (rad).
    pub before: [f64; 6],
    /// The errors in the moved frame, N E.
    pub after: [f64; 6],
}

/// The reason for which a 4x4 matrix over D is no motion with small errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AdmissibilityFailure {
    /// The last row is not 0 0 0 1; largest difference.
    LastRow(f64),
    /// The real 3x3 block is not orthogonal; largest entry of A^T A - 1.
    NotOrthogonal(f64),
    /// The real 3x3 block is a reflection.
    Reflection,
    /// The i-part of the 3x3 block is not in the error class: largest entry of A^T B + B^T A, and its
    /// row and column from 0. On the diagonal it is a stretch, elsewhere a shear.
    NotInClass(f64, usize, usize),
}

/// Splits `real + i dual` into nominal motion and six errors. `tolerance` is for entries without a
/// unit; the i-part is compared with its own size.
pub fn split(real: &Matrix4<f64>, dual: &Matrix4<f64>, tolerance: f64) -> Result<Split, AdmissibilityFailure> {
    let wanted = nalgebra::RowVector4::new(0.0, 0.0, 0.0, 1.0);
    let last = (real.row(3) - wanted).amax().max(dual.row(3).amax());
    if last > tolerance {
        return Err(AdmissibilityFailure::LastRow(last));
    }
    let block = |m: &Matrix4<f64>| m.fixed_view::<3, 3>(0, 0).into_owned();
    let (a, b) = (block(real), block(dual));
    let defect = (a.transpose() * a - Matrix3::identity()).amax();
    if defect > tolerance {
        return Err(AdmissibilityFailure::NotOrthogonal(defect));
    }
    if a.determinant() < 0.0 {
        return Err(AdmissibilityFailure::Reflection);
    }
    in_class(&a, &b, tolerance)?;
    let column = |m: &Matrix4<f64>| m.fixed_view::<3, 1>(0, 3).into_owned();
    let (translation, displaced) = (column(real), column(dual));
    let w = super::skew_vector(&(b * a.transpose()));
    let six = |d: Vector3<f64>, w: Vector3<f64>| [d.x, d.y, d.z, w.x, w.y, w.z];
    Ok(Split {
        rotation: a,
        translation,
        before: six(displaced - w.cross(&translation), w),
        after: six(a.transpose() * displaced, a.transpose() * w),
    })
}

fn in_class(a: &Matrix3<f64>, b: &Matrix3<f64>, tolerance: f64) -> Result<(), AdmissibilityFailure> {
    let product = a.transpose() * b;
    let symmetric = product + product.transpose();
    let (row, column) = symmetric.map(f64::abs).iamax_full();
    let largest = symmetric[(row, column)].abs();
    if largest > tolerance * b.amax() { Err(AdmissibilityFailure::NotInClass(largest, row, column)) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{hat, rotation_about};

    fn motion() -> (Matrix4<f64>, Matrix4<f64>) {
        let a: Matrix3<f64> = rotation_about(&[0.6, 0.0, 0.8], libm::sincos(0.7));
        let w = Vector3::new(1e-5, -2e-5, 3e-5);
        let b = hat(&[w.x, w.y, w.z]) * a;
        let (place, delta) = (Vector3::new(100.0, -50.0, 20.0), Vector3::new(0.01, 0.02, -0.03));
        let mut real = Matrix4::identity();
        let mut dual = Matrix4::zeros();
        real.fixed_view_mut::<3, 3>(0, 0).copy_from(&a);
        dual.fixed_view_mut::<3, 3>(0, 0).copy_from(&b);
        real.fixed_view_mut::<3, 1>(0, 3).copy_from(&place);
        dual.fixed_view_mut::<3, 1>(0, 3).copy_from(&(delta + w.cross(&place)));
        (real, dual)
    }

    #[test]
    fn a_motion_is_split_into_what_it_was_made_of() {
        let (real, dual) = motion();
        let split = split(&real, &dual, 1e-9).unwrap();
        let expected = [0.01, 0.02, -0.03, 1e-5, -2e-5, 3e-5];
        assert!(split.before.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{:?}", split.before);
        assert_eq!(split.translation, Vector3::new(100.0, -50.0, 20.0));
    }

    #[test]
    fn the_same_errors_after_the_motion() {
        let (real, dual) = motion();
        let found = split(&real, &dual, 1e-9).unwrap();
        let [dx, dy, dz, ex, ey, ez] = found.after;
        let mut e = Matrix4::zeros();
        e.fixed_view_mut::<3, 3>(0, 0).copy_from(&hat(&[ex, ey, ez]));
        e.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::new(dx, dy, dz));
        assert!((real * e - dual).amax() < 1e-15);
    }

    #[test]
    fn what_is_no_motion_is_named() {
        let (real, dual) = motion();
        let with = |at: (usize, usize), by: f64| {
            let mut other = real;
            other[at] += by;
            split(&other, &dual, 1e-9)
        };
        assert!(matches!(with((3, 0), 0.1), Err(AdmissibilityFailure::LastRow(_))));
        assert!(matches!(with((0, 0), 0.1), Err(AdmissibilityFailure::NotOrthogonal(_))));
        let mut mirrored = real;
        mirrored.column_mut(1).neg_mut();
        assert_eq!(split(&mirrored, &dual, 1e-9), Err(AdmissibilityFailure::Reflection));
        let stretch = dual + real * Matrix4::from_diagonal(&nalgebra::Vector4::new(0.0, 1e-5, 0.0, 0.0));
        let Err(AdmissibilityFailure::NotInClass(size, 1, 1)) = split(&real, &stretch, 1e-9) else {
            panic!("{stretch}")
        };
        assert!((size - 2e-5).abs() < 1e-15);
    }
}
