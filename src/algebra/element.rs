//! What an algebra is.

use super::lift;
use num_traits::{One, Zero};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// Highest order any algebra may have; errors of 1 mrad to the 16th power are long below a double.
pub const MAX_ORDER: usize = 15;

/// A commutative local algebra over the reals, of finite dimension.
pub trait Algebra:
    Clone
    + Debug
    + PartialEq
    + Zero
    + One
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + 'static
{
    fn from_real(value: f64) -> Self;

    /// The real part: the value at which functions are expanded.
    fn real(&self) -> f64;

    /// Sum of all coefficients of degree 1 and higher: the value of the nilpotent part when every generator has the
    /// value of its error.
    fn nilpotent_sum(&self) -> f64;

    /// Highest total degree that can be other than zero; 0 for a constant.
    fn order(&self) -> usize;

    /// The element without its real part.
    fn nilpotent(&self) -> Self;

    /// Product with a real number.
    fn scaled(&self, factor: f64) -> Self;

    /// `sum taylor[k] * nilpotent^k`: the lift of a function with these Taylor coefficients at the real part.
    fn lift(&self, taylor: impl Fn(f64, &mut [f64])) -> Self {
        let mut buffer = [0.0; MAX_ORDER + 1];
        let coefficients = &mut buffer[..=self.order().min(MAX_ORDER)];
        taylor(self.real(), coefficients);
        let nilpotent = self.nilpotent();
        let fold = |sum: Self, c: &f64| sum * nilpotent.clone() + Self::from_real(*c);
        coefficients.iter().rev().fold(Self::zero(), fold)
    }

    fn sin_cos(&self) -> (Self, Self) {
        let (s, c) = libm::sincos(self.real());
        (self.lift(|_, t| lift::cycle([s, c, -s, -c], t)), self.lift(|_, t| lift::cycle([c, -s, -c, s], t)))
    }

    fn sin(&self) -> Self {
        self.lift(lift::sin)
    }

    fn exp(&self) -> Self {
        self.lift(lift::exp)
    }

    /// Square root; defined where the real part is positive.
    fn sqrt(&self) -> Option<Self> {
        (self.real() > 0.0).then(|| self.lift(lift::sqrt))
    }

    /// Reciprocal; defined exactly where the real part is not zero.
    fn recip(&self) -> Option<Self> {
        (self.real() != 0.0).then(|| self.lift(lift::recip))
    }
}

impl Algebra for f64 {
    fn from_real(value: f64) -> Self {
        value
    }
    fn real(&self) -> f64 {
        *self
    }
    fn nilpotent_sum(&self) -> f64 {
        0.0
    }
    fn order(&self) -> usize {
        0
    }
    fn nilpotent(&self) -> Self {
        0.0
    }
    fn scaled(&self, factor: f64) -> Self {
        self * factor
    }
    fn lift(&self, taylor: impl Fn(f64, &mut [f64])) -> Self {
        let mut value = [0.0];
        taylor(*self, &mut value);
        value[0]
    }
    fn sin_cos(&self) -> (Self, Self) {
        libm::sincos(*self)
    }
}

/// Value of an element minus a real number, without cancelling the nilpotent part against it.
pub fn difference<S: Algebra>(element: &S, real: f64) -> f64 {
    (element.real() - real) + element.nilpotent_sum()
}
