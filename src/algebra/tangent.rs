//! Tangents over any algebra: `value + slope t` with t^2 = 0. A function evaluated at `x + t` yields
//! its derivative as the slope, itself an element of the algebra.

use super::Algebra;
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// `value + slope t`.
#[derive(Debug, Clone, PartialEq)]
pub struct Tangent<S> {
    /// The value at t = 0.
    pub value: S,
    /// The derivative.
    pub slope: S,
}

impl<S: Algebra> Tangent<S> {
    /// Returns a quantity that does not depend on t.
    pub fn fixed(value: S) -> Self {
        Self { value, slope: S::zero() }
    }

    fn zip(self, other: Self, f: impl Fn(S, S) -> S) -> Self {
        Self { value: f(self.value, other.value), slope: f(self.slope, other.slope) }
    }
}

impl<S: Algebra> Algebra for Tangent<S> {
    fn from_real(value: f64) -> Self {
        Self::fixed(S::from_real(value))
    }
    fn real(&self) -> f64 {
        self.value.real()
    }
    fn nilpotent_sum(&self) -> f64 {
        self.value.nilpotent_sum() + self.slope.real() + self.slope.nilpotent_sum()
    }
    fn order(&self) -> usize {
        self.value.order().max(self.slope.order()) + 1
    }
    fn nilpotent(&self) -> Self {
        Self { value: self.value.nilpotent(), slope: self.slope.clone() }
    }
    fn scaled(&self, factor: f64) -> Self {
        Self { value: self.value.scaled(factor), slope: self.slope.scaled(factor) }
    }
}

impl<S: Algebra> Add for Tangent<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<S: Algebra> Sub for Tangent<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<S: Algebra> Neg for Tangent<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<S: Algebra> Mul for Tangent<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let slope = self.value.clone() * other.slope + self.slope * other.value.clone();
        Self { value: self.value * other.value, slope }
    }
}

impl<S: Algebra> AddAssign for Tangent<S> {
    fn add_assign(&mut self, other: Self) {
        *self = self.clone() + other;
    }
}

impl<S: Algebra> SubAssign for Tangent<S> {
    fn sub_assign(&mut self, other: Self) {
        *self = self.clone() - other;
    }
}

impl<S: Algebra> MulAssign for Tangent<S> {
    fn mul_assign(&mut self, other: Self) {
        *self = self.clone() * other;
    }
}

impl<S: Algebra> Zero for Tangent<S> {
    fn zero() -> Self {
        Self::fixed(S::zero())
    }
    fn is_zero(&self) -> bool {
        self.value.is_zero() && self.slope.is_zero()
    }
}

impl<S: Algebra> One for Tangent<S> {
    fn one() -> Self {
        Self::fixed(S::one())
    }
}
