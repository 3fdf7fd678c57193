//! Polynomials in symbols: errors (nilpotent), positions of axes, sines and cosines of angles. The
//! same lowering over them yields the closed forms.
//!
//! Squares of sines are written by cosines, so that equal polynomials look alike; monomials that vanish in the chosen
//! Weil algebra are dropped. Only polynomials can be lifted: functions are expanded at a real part that must be a
//! number.

mod rules;
#[cfg(test)]
mod tests;

pub use rules::{MAX_PRODUCTS, Rules, SymbolKind};

use super::Algebra;
use super::weil::Monomial;
use num_traits::{One, Zero};
use rules::Sum;
use std::collections::BTreeMap;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use std::sync::Arc;

/// Functions are lifted of determinants and of squared angles only, numbers without a unit: what
/// the rounding residue of sines and cosines in their real part is far below this.
const NEGLIGIBLE: f64 = 1e-9;

/// A polynomial in symbols.
#[derive(Debug, Clone)]
pub struct Symbolic {
    /// `None` as long as it is a number.
    rules: Option<Arc<Rules>>,
    terms: BTreeMap<Monomial, f64>,
}

impl Symbolic {
    /// Returns a symbol by its index in the rules.
    pub fn symbol(rules: &Arc<Rules>, symbol: u16) -> Self {
        let mut sum = Sum::default();
        sum.add(rules, Monomial::new([(symbol, 1)]), 1.0);
        Self { rules: Some(Arc::clone(rules)), terms: sum.terms() }
    }

    /// Monomials in symbols with their coefficients.
    pub fn terms(&self) -> impl Iterator<Item = (&Monomial, f64)> {
        self.terms.iter().map(|(monomial, value)| (monomial, *value))
    }

    /// True if it is the polynomial 0.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// Returns the coefficient of a monomial.
    pub fn coefficient(&self, monomial: &Monomial) -> f64 {
        self.terms.get(monomial).copied().unwrap_or(0.0)
    }

    /// Returns the terms of one degree in the nilpotent symbols.
    pub fn part(&self, degree: usize) -> Self {
        self.filtered(|d| d == degree)
    }

    fn filtered(&self, keep: impl Fn(usize) -> bool) -> Self {
        let degree = |monomial: &Monomial| self.rules.as_ref().map_or(0, |r| r.degree(monomial));
        let terms = self.terms.iter().filter(|(m, _)| keep(degree(m))).map(|(m, c)| (m.clone(), *c));
        Self { rules: self.rules.clone(), terms: terms.collect() }
    }

    /// Returns its value when every symbol is an element of some algebra, which may be symbolic again.
    pub fn evaluate<S: Algebra>(&self, value: impl Fn(u16) -> S) -> S {
        let power = |(symbol, power): &(u16, u8)| {
            let base = value(*symbol);
            (0..*power).fold(S::one(), |product, _| product * base.clone())
        };
        let term = |(monomial, c): (&Monomial, &f64)| {
            monomial.factors().iter().map(power).fold(S::from_real(*c), |product, factor| product * factor)
        };
        self.terms.iter().map(term).fold(S::zero(), |sum, term| sum + term)
    }

    /// Every number in it is finite: no function was lifted that is no polynomial.
    pub fn is_polynomial(&self) -> bool {
        self.terms.values().all(|c| c.is_finite())
    }

    fn rules_with(&self, other: &Self) -> Option<Arc<Rules>> {
        self.rules.clone().or_else(|| other.rules.clone())
    }

    fn number(value: f64) -> Self {
        let terms = (value != 0.0).then(|| (Monomial::default(), value));
        Self { rules: None, terms: terms.into_iter().collect() }
    }

    fn combine(mut self, other: Self, sign: f64) -> Self {
        self.rules = self.rules_with(&other);
        for (monomial, value) in other.terms {
            let before = self.terms.get(&monomial).copied().unwrap_or(0.0);
            match rules::round(before + sign * value, before.abs() + value.abs()) {
                Some(sum) => drop(self.terms.insert(monomial, sum)),
                None => drop(self.terms.remove(&monomial)),
            }
        }
        self
    }
}

impl PartialEq for Symbolic {
    fn eq(&self, other: &Self) -> bool {
        self.terms == other.terms
    }
}

impl Algebra for Symbolic {
    fn from_real(value: f64) -> Self {
        Self::number(value)
    }

    /// NaN if the part without nilpotent symbols is not a number: nothing can be expanded there.
    fn real(&self) -> f64 {
        let Some(rules) = &self.rules else { return self.coefficient(&Monomial::default()) };
        let symbol =
            |(m, c): (&Monomial, &f64)| m.degree() > 0 && rules.degree(m) == 0 && (c.is_nan() || c.abs() > NEGLIGIBLE);
        if self.terms.iter().any(symbol) { f64::NAN } else { self.coefficient(&Monomial::default()) }
    }

    fn nilpotent_sum(&self) -> f64 {
        self.terms.iter().filter(|(m, _)| m.degree() > 0).map(|(_, c)| c).sum()
    }

    fn order(&self) -> usize {
        self.rules.as_ref().map_or(0, |rules| usize::from(rules.ideal().degree))
    }

    fn nilpotent(&self) -> Self {
        self.filtered(|degree| degree > 0)
    }

    fn scaled(&self, factor: f64) -> Self {
        if factor == 0.0 {
            return Self::number(0.0);
        }
        let terms = self.terms.iter().map(|(m, c)| (m.clone(), c * factor)).collect();
        Self { rules: self.rules.clone(), terms }
    }

    fn recip(&self) -> Option<Self> {
        let real = self.real();
        (real != 0.0 && real.is_finite()).then(|| self.lift(super::lift::recip))
    }
}

impl Add for Symbolic {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, 1.0)
    }
}

impl Sub for Symbolic {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(other, -1.0)
    }
}

impl Neg for Symbolic {
    type Output = Self;
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl Mul for Symbolic {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let rules = self.rules_with(&other);
        let terms = match &rules {
            Some(rules) => rules.product(&self.terms, &other.terms),
            None => return Self::number(self.real() * other.real()),
        };
        Self { rules, terms }
    }
}

impl AddAssign for Symbolic {
    fn add_assign(&mut self, other: Self) {
        *self = std::mem::replace(self, Self::number(0.0)) + other;
    }
}

impl SubAssign for Symbolic {
    fn sub_assign(&mut self, other: Self) {
        *self = std::mem::replace(self, Self::number(0.0)) - other;
    }
}

impl MulAssign for Symbolic {
    fn mul_assign(&mut self, other: Self) {
        *self = std::mem::replace(self, Self::number(0.0)) * other;
    }
}

impl Zero for Symbolic {
    fn zero() -> Self {
        Self::number(0.0)
    }
    fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }
}

impl One for Symbolic {
    fn one() -> Self {
        Self::number(1.0)
    }
}
