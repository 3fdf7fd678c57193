//! Weil algebras: polynomials in nilpotent generators, one for each error or group of errors, modulo an ideal of
//! monomials and homogeneous binomials. The ideal determines the interferences of errors that are kept, and those that
//! others replace.
//!
//! The basis is chosen at run time, so an element is a plain constant or carries its basis.

mod basis;
mod groebner;
mod monomials;
mod table;
#[cfg(test)]
mod tests;

pub use basis::{Basis, BasisFailure};
pub use groebner::{Binomial, Fraction, GroebnerBasis, IdealFailure, MAX_ELEMENTS};
pub use monomials::{Ideal, Monomial, Size};

use super::{Algebra, Dual};
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use std::sync::Arc;

/// An element of a Weil algebra. Elements of two different algebras have no sum and no product: the
/// result is the constant NaN.
#[derive(Debug, Clone)]
pub enum Weil {
    /// A real number: an element of every algebra.
    Constant(f64),
    /// Coefficients of the monomials of a basis.
    Element(Arc<Basis>, Vec<f64>),
}

impl Weil {
    /// `value` times a generator; zero if the generator itself vanishes.
    pub fn generator(basis: &Arc<Basis>, generator: u16, value: f64) -> Self {
        Self::monomial(basis, &Monomial::new([(generator, 1)]), value)
    }

    /// `value` times a monomial; zero if it vanishes.
    pub fn monomial(basis: &Arc<Basis>, monomial: &Monomial, value: f64) -> Self {
        let Some((factor, position)) = basis.normal_form(monomial) else { return Self::Constant(0.0) };
        let mut list = vec![0.0; basis.monomials().len()];
        list[position] = factor * value;
        Self::Element(Arc::clone(basis), list)
    }

    /// Returns the coefficient of a monomial of the basis; 0 of others.
    pub fn coefficient(&self, monomial: &Monomial) -> f64 {
        match self {
            Self::Constant(value) if monomial.degree() == 0 => *value,
            Self::Constant(_) => 0.0,
            Self::Element(basis, list) => basis.position(monomial).map_or(0.0, |i| list[i]),
        }
    }

    /// Passes every coefficient through a function that leaves 0 alone.
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(f(value)),
            Self::Element(basis, list) => Self::Element(basis, list.into_iter().map(f).collect()),
        }
    }

    /// Passes the real part through a function.
    fn map_real(mut self, f: impl Fn(f64) -> f64) -> Self {
        match &mut self {
            Self::Constant(value) => *value = f(*value),
            Self::Element(_, list) => list.iter_mut().take(1).for_each(|x| *x = f(*x)),
        }
        self
    }

    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => Self::Constant(f(a, b)),
            (element, Self::Constant(b)) => element.map_real(|a| f(a, b)),
            (Self::Constant(a), element) => element.map(|b| f(0.0, b)).map_real(|b| a + b),
            (Self::Element(basis, a), Self::Element(other, b)) if same(&basis, &other) => {
                Self::Element(basis, a.into_iter().zip(b).map(|(a, b)| f(a, b)).collect())
            }
            _ => Self::Constant(f64::NAN),
        }
    }
}

/// An algebra whose elements are polynomials in generators.
pub trait Coefficients: Algebra {
    /// Returns monomials with their coefficients, lowest degree first; none but 1 of a constant.
    fn terms(&self) -> Vec<(Monomial, f64)>;
}

impl Coefficients for Weil {
    fn terms(&self) -> Vec<(Monomial, f64)> {
        match self {
            Self::Constant(value) => vec![(Monomial::default(), *value)],
            Self::Element(basis, list) => basis.monomials().iter().cloned().zip(list.iter().copied()).collect(),
        }
    }
}

/// Powers of its one generator.
impl<const M: usize> Coefficients for Dual<M> {
    fn terms(&self) -> Vec<(Monomial, f64)> {
        (0..).zip(self.0).map(|(k, value)| (Monomial::new([(0, k)]), value)).collect()
    }
}

fn same(a: &Arc<Basis>, b: &Arc<Basis>) -> bool {
    Arc::ptr_eq(a, b) || a == b
}

impl PartialEq for Weil {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a == b,
            (Self::Constant(a), Self::Element(_, list)) | (Self::Element(_, list), Self::Constant(a)) => {
                list.iter().enumerate().all(|(i, x)| *x == if i == 0 { *a } else { 0.0 })
            }
            (Self::Element(basis, a), Self::Element(other, b)) => same(basis, other) && a == b,
        }
    }
}

impl Algebra for Weil {
    fn from_real(value: f64) -> Self {
        Self::Constant(value)
    }
    fn real(&self) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Element(_, list) => list.first().copied().unwrap_or(0.0),
        }
    }
    fn nilpotent_sum(&self) -> f64 {
        match self {
            Self::Constant(_) => 0.0,
            // Highest degree first, as in the dual numbers.
            Self::Element(_, list) => list.iter().skip(1).rev().sum(),
        }
    }
    fn order(&self) -> usize {
        match self {
            Self::Constant(_) => 0,
            Self::Element(basis, _) => basis.order(),
        }
    }
    fn nilpotent(&self) -> Self {
        self.clone().map_real(|_| 0.0)
    }
    fn scaled(&self, factor: f64) -> Self {
        self.clone().map(|x| x * factor)
    }
}

impl Add for Weil {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Weil {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Neg for Weil {
    type Output = Self;
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl Mul for Weil {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        match (self, other) {
            (Self::Constant(a), b) => b.map(|x| a * x),
            (a, Self::Constant(b)) => a.map(|x| x * b),
            (Self::Element(basis, a), Self::Element(other, b)) if same(&basis, &other) => {
                let mut product = vec![0.0; a.len()];
                basis.multiply(&a, &b, &mut product);
                Self::Element(basis, product)
            }
            _ => Self::Constant(f64::NAN),
        }
    }
}

impl AddAssign for Weil {
    fn add_assign(&mut self, other: Self) {
        *self = std::mem::replace(self, Self::Constant(0.0)) + other;
    }
}

impl SubAssign for Weil {
    fn sub_assign(&mut self, other: Self) {
        *self = std::mem::replace(self, Self::Constant(0.0)) - other;
    }
}

impl MulAssign for Weil {
    fn mul_assign(&mut self, other: Self) {
        *self = std::mem::replace(self, Self::Constant(0.0)) * other;
    }
}

impl Zero for Weil {
    fn zero() -> Self {
        Self::Constant(0.0)
    }
    fn is_zero(&self) -> bool {
        *self == Self::Constant(0.0)
    }
}

impl One for Weil {
    fn one() -> Self {
        Self::Constant(1.0)
    }
}
