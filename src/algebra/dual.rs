//! Dual numbers of order n: `R[i]/<i^(n+1)>`.

use super::Algebra;
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// `a0 + a1 i + ... + an i^n` with `M = n + 1` coefficients; they are Taylor coefficients, not derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const M: usize>(pub [f64; M]);

impl<const M: usize> Dual<M> {
    /// `value * i`.
    pub fn first_order(value: f64) -> Self {
        Self(std::array::from_fn(|k| if k == 1 { value } else { 0.0 }))
    }

    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }
}

impl<const M: usize> Algebra for Dual<M> {
    fn from_real(value: f64) -> Self {
        Self(std::array::from_fn(|k| if k == 0 { value } else { 0.0 }))
    }
    fn real(&self) -> f64 {
        self.0[0]
    }
    fn nilpotent_sum(&self) -> f64 {
        // Smallest terms first: the sum is then good to the last bit.
        self.0[1..].iter().rev().sum()
    }
    fn order(&self) -> usize {
        M - 1
    }
    fn nilpotent(&self) -> Self {
        Self(std::array::from_fn(|k| if k == 0 { 0.0 } else { self.0[k] }))
    }
    fn scaled(&self, factor: f64) -> Self {
        Self(self.0.map(|a| a * factor))
    }
    /// Returns the general one without the products that are 0, and without degrees that later steps push out.
    #[inline]
    fn lift(&self, taylor: impl Fn(f64, &mut [f64])) -> Self {
        let mut c = [0.0; M];
        taylor(self.0[0], &mut c);
        let mut sum = [0.0; M];
        sum[0] = c[M - 1];
        for m in (0..M - 1).rev() {
            for k in (1..M - m).rev() {
                let product = |j: usize| sum[j] * self.0[k - j];
                sum[k] = (1..k).fold(product(0), |x, j| x + product(j));
            }
            sum[0] = c[m];
        }
        Self(sum)
    }
}

impl<const M: usize> Add for Dual<M> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const M: usize> Sub for Dual<M> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const M: usize> Neg for Dual<M> {
    type Output = Self;
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl<const M: usize> Mul for Dual<M> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let product = |k: usize, j: usize| self.0[j] * other.0[k - j];
        Self(std::array::from_fn(|k| (1..=k).fold(product(k, 0), |sum, j| sum + product(k, j))))
    }
}

impl<const M: usize> AddAssign for Dual<M> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const M: usize> SubAssign for Dual<M> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<const M: usize> MulAssign for Dual<M> {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<const M: usize> Zero for Dual<M> {
    fn zero() -> Self {
        Self([0.0; M])
    }
    fn is_zero(&self) -> bool {
        self.0.iter().all(|a| *a == 0.0)
    }
}

impl<const M: usize> One for Dual<M> {
    fn one() -> Self {
        Self::from_real(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn element() -> impl Strategy<Value = Dual<4>> {
        prop::array::uniform4(-2.0..2.0_f64).prop_map(Dual)
    }

    fn near(a: Dual<4>, b: Dual<4>) -> bool {
        a.0.iter().zip(b.0).all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs().max(1.0))
    }

    #[test]
    fn the_generator_is_nilpotent() {
        let i = Dual::<3>::first_order(1.0);
        assert_eq!(i * i, Dual([0.0, 0.0, 1.0]));
        assert!((i * i * i).is_zero());
        assert!(i.recip().is_none());
    }

    proptest! {
        #[test]
        fn products_are_commutative_and_associative(a in element(), b in element(), c in element()) {
            prop_assert!(near(a * b, b * a));
            prop_assert!(near((a * b) * c, a * (b * c)));
        }

        #[test]
        fn sine_and_cosine_lie_on_the_circle(a in element()) {
            let (s, c) = a.sin_cos();
            prop_assert!(near(s * s + c * c, Dual::one()));
        }

        #[test]
        fn a_reciprocal_undoes_the_product(a in element()) {
            prop_assume!(a.real().abs() > 0.5);
            let inverse = a.recip().ok_or_else(|| TestCaseError::fail("no inverse"))?;
            prop_assert!(near(a * inverse, Dual::one()));
        }

        #[test]
        fn a_square_root_squares_back(a in element()) {
            prop_assume!(a.real() > 0.5);
            let root = a.sqrt().ok_or_else(|| TestCaseError::fail("no root"))?;
            prop_assert!(near(root * root, a));
        }
    }
}
