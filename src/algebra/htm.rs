//! Homogeneous transformation matrices and small rotations over an algebra.

use super::{Algebra, lift};
use nalgebra::{Matrix3, Matrix4, Vector3};

/// A homogeneous transformation: `p -> linear p + translation`. The linear part of a linearised
/// joint is not orthogonal, so nothing here assumes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Htm<S: Algebra> {
    /// The 3x3 block.
    pub linear: Matrix3<S>,
    /// The fourth column, mm.
    pub translation: Vector3<S>,
}

impl<S: Algebra> Htm<S> {
    /// Returns the identity.
    pub fn identity() -> Self {
        Self { linear: Matrix3::from_fn(|i, j| if i == j { S::one() } else { S::zero() }), translation: zero_vector() }
    }

    /// Returns a translation.
    pub fn translation(by: Vector3<S>) -> Self {
        Self { translation: by, ..Self::identity() }
    }

    /// A linear part about a point that stays where it is: `T(point) linear T(-point)`.
    pub fn about(point: &[f64; 3], inner: Self) -> Self {
        let moved = apply(&inner.linear, point);
        let translation =
            Vector3::from_fn(|i, _| inner.translation[i].clone() + S::from_real(point[i]) - moved[i].clone());
        Self { linear: inner.linear, translation }
    }

    /// Returns the motion `self` after `inner`.
    pub fn compose(&self, inner: &Self) -> Self {
        Self {
            linear: product(&self.linear, &inner.linear),
            translation: transform(&self.linear, &inner.translation) + &self.translation,
        }
    }

    /// Returns the exact inverse, also of a linear part that is not orthogonal. Every lowered joint is near a rotation,
    /// so the determinant's real part is near 1; `None` only for matrices that are no joints.
    pub fn inverse(&self) -> Option<Self> {
        let linear = inverse3(&self.linear)?;
        let translation = transform(&linear, &self.translation).map(|x| -x);
        Some(Self { linear, translation })
    }

    /// Image of a point with real coordinates.
    pub fn apply(&self, point: &[f64; 3]) -> Vector3<S> {
        apply(&self.linear, point) + &self.translation
    }

    /// Returns the 4x4 matrix.
    pub fn to_matrix(&self) -> Matrix4<S> {
        Matrix4::from_fn(|i, j| match (i, j) {
            (3, 3) => S::one(),
            (3, _) => S::zero(),
            (_, 3) => self.translation[i].clone(),
            _ => self.linear[(i, j)].clone(),
        })
    }
}

fn zero_vector<S: Algebra>() -> Vector3<S> {
    Vector3::from_fn(|_, _| S::zero())
}

/// `linear * point` for real coordinates.
fn apply<S: Algebra>(linear: &Matrix3<S>, point: &[f64; 3]) -> Vector3<S> {
    Vector3::from_fn(|i, _| (0..3).map(|j| linear[(i, j)].scaled(point[j])).fold(S::zero(), |a, b| a + b))
}

/// `linear * vector`, written out as [`product`] is.
pub fn transform<S: Algebra>(linear: &Matrix3<S>, vector: &Vector3<S>) -> Vector3<S> {
    Vector3::from_fn(|i, _| row_by_column(linear, i, [&vector[0], &vector[1], &vector[2]]))
}

/// `a * b`, written out: nalgebra's loops for such small matrices move numbers about more than they multiply.
pub fn product<S: Algebra>(a: &Matrix3<S>, b: &Matrix3<S>) -> Matrix3<S> {
    Matrix3::from_fn(|i, j| row_by_column(a, i, [&b[(0, j)], &b[(1, j)], &b[(2, j)]]))
}

#[inline]
fn row_by_column<S: Algebra>(a: &Matrix3<S>, i: usize, [x, y, z]: [&S; 3]) -> S {
    let by = |j: usize, factor: &S| a[(i, j)].clone() * factor.clone();
    by(0, x) + by(1, y) + by(2, z)
}

/// Inverse by the adjugate: the only division is by the determinant.
fn inverse3<S: Algebra>(m: &Matrix3<S>) -> Option<Matrix3<S>> {
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[(a, c)].clone() * m[(b, d)].clone() - m[(a, d)].clone() * m[(b, c)].clone()
    };
    let determinant = (0..3).map(|j| m[(0, j)].clone() * minor(0, j)).fold(S::zero(), |a, b| a + b);
    let scale = determinant.recip()?;
    Some(Matrix3::from_fn(|i, j| minor(j, i) * scale.clone()))
}

/// The skew matrix of a vector: `hat(w) p = w x p`.
pub fn hat<S: Algebra>(w: &[S; 3]) -> Matrix3<S> {
    let [x, y, z] = w.clone();
    let zero = S::zero;
    Matrix3::new(zero(), -z.clone(), y.clone(), z, zero(), -x.clone(), -y, x, zero())
}

/// `exp(hat(w))`: the rotation by the vector w.
pub fn exp_hat<S: Algebra>(w: &[S; 3]) -> Matrix3<S> {
    in_hat(w, lift::sinc, lift::cosc)
}

/// The derivative J of a rotation by its vector: exp(hat(w + dw)) = (1 + hat(J dw)) exp(hat(w)) + O(dw^2),
/// J = 1 + (1 - cos t)/t^2 hat(w) + (t - sin t)/t^3 hat(w)^2 with t = |w|.
pub fn left_jacobian<S: Algebra>(w: &[S; 3]) -> Matrix3<S> {
    in_hat(w, lift::cosc, lift::sincc)
}

/// `1 + first(t^2) hat(w) + second(t^2) hat(w)^2` with t = |w|.
fn in_hat<S: Algebra>(w: &[S; 3], first: fn(f64, &mut [f64]), second: fn(f64, &mut [f64])) -> Matrix3<S> {
    let square = w.iter().map(|x| x.clone() * x.clone()).fold(S::zero(), |a, b| a + b);
    let hat = hat(w);
    let twice = product(&hat, &hat);
    let (first, second) = (square.lift(first), square.lift(second));
    let mut sum = hat.map(|x| x * first.clone()) + twice.map(|x| x * second.clone());
    (0..3).for_each(|i| sum[(i, i)] += S::one());
    sum
}

/// Rotation about a unit vector, sine and cosine given: `c 1 + s hat(u) + (1 - c) u u^T`.
pub fn rotation_about<S: Algebra>(u: &[f64; 3], (sine, cosine): (S, S)) -> Matrix3<S> {
    let skew = hat(&u.map(S::from_real));
    let versine = S::one() - cosine.clone();
    Matrix3::from_fn(|i, j| {
        let diagonal = if i == j { cosine.clone() } else { S::zero() };
        diagonal + skew[(i, j)].clone() * sine.clone() + versine.scaled(u[i] * u[j])
    })
}

/// Vector of the skew part of a matrix.
pub fn skew_vector<S: Algebra>(m: &Matrix3<S>) -> Vector3<S> {
    let half = |a: (usize, usize), b: (usize, usize)| (m[a].clone() - m[b].clone()).scaled(0.5);
    Vector3::new(half((2, 1), (1, 2)), half((0, 2), (2, 0)), half((1, 0), (0, 1)))
}

/// Vector of the logarithm of a rotation by less than a quarter turn.
pub fn rotation_vector<S: Algebra>(m: &Matrix3<S>) -> Vector3<S> {
    let skew = skew_vector(m);
    let square = skew.iter().map(|x| x.clone() * x.clone()).fold(S::zero(), |a, b| a + b);
    let factor = square.lift(lift::asinc);
    skew.map(|x| x * factor.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::Dual;

    #[test]
    fn the_exponential_is_the_rotation_about_its_own_axis() {
        let angle = 0.3_f64;
        let u = [0.6, 0.0, 0.8];
        let e = exp_hat(&u.map(|x| x * angle));
        let r = rotation_about(&u, libm::sincos(angle));
        assert!((e - r).amax() < 1e-16);
        assert!((rotation_vector(&e) - Vector3::from(u) * angle).amax() < 1e-16);
    }

    #[test]
    fn orthogonal_joints_stay_orthogonal_to_the_last_order() {
        let w = [0.3, -0.2, 0.5].map(Dual::<4>::first_order);
        let e = exp_hat(&w);
        let square = e.transpose() * e;
        for ((i, j), value) in (0..9).map(|k| ((k / 3, k % 3), square[(k / 3, k % 3)])) {
            let expected = Dual::<4>::from_real(f64::from(u8::from(i == j)));
            assert!(value.0.iter().zip(expected.0).all(|(a, b)| (a - b).abs() < 1e-16), "{value:?}");
        }
    }

    #[test]
    fn the_inverse_of_a_linearised_matrix_is_exact() {
        let linear = hat(&[0.1, 0.2, -0.3]) + Matrix3::identity();
        let joint = Htm { linear, translation: Vector3::new(1.0, 2.0, 3.0) };
        let round = joint.compose(&joint.inverse().unwrap());
        assert!((round.to_matrix() - nalgebra::Matrix4::identity()).amax() < 1e-15);
    }
}
