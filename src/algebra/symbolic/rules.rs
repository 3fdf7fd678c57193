//! The kinds of symbols, and the reduction of their products.

use crate::algebra::weil::{Ideal, Monomial};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// Maximum number of products of terms of one calculation: half a minute and up to 1 GB. Above it all products are NaN.
pub const MAX_PRODUCTS: u64 = 10_000_000;

/// The meaning of a symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SymbolKind {
    /// A number that is not small: a position, a cosine.
    Real,
    /// The sine of an angle whose cosine is another symbol.
    Sine {
        /// The cosine's index.
        cosine: u16,
    },
    /// An error, as large as a generator of the Weil algebra.
    Nilpotent {
        /// Index of the generator.
        generator: u16,
    },
}

/// The symbols of a calculation, and which products of them vanish.
#[derive(Debug)]
pub struct Rules {
    symbols: Vec<SymbolKind>,
    ideal: Ideal,
    products: AtomicU64,
    max_products: u64,
}

impl Rules {
    /// Symbols in their order; the ideal is one of the generators.
    pub fn new(symbols: Vec<SymbolKind>, ideal: Ideal) -> Self {
        Self { symbols, ideal, products: AtomicU64::new(0), max_products: MAX_PRODUCTS }
    }

    /// Returns the rules with another limit.
    #[cfg(test)]
    pub(super) fn within(self, max_products: u64) -> Self {
        Self { max_products, ..self }
    }

    /// True if the products exceeded the limit.
    pub fn is_exhausted(&self) -> bool {
        self.products.load(Ordering::Relaxed) > self.max_products
    }

    /// Counts products of terms; true if they are within the limit.
    fn spend(&self, products: usize) -> bool {
        let before = self.products.fetch_add(products as u64, Ordering::Relaxed);
        before.saturating_add(products as u64) <= self.max_products
    }

    /// Returns the products of generators that vanish.
    pub fn ideal(&self) -> &Ideal {
        &self.ideal
    }

    /// Returns the kinds of the symbols.
    pub fn kinds(&self) -> &[SymbolKind] {
        &self.symbols
    }

    fn kind(&self, symbol: u16) -> SymbolKind {
        self.symbols.get(usize::from(symbol)).copied().unwrap_or(SymbolKind::Real)
    }

    /// Degree in the nilpotent symbols.
    pub fn degree(&self, monomial: &Monomial) -> usize {
        let nilpotent = |(symbol, _): &&(u16, u8)| matches!(self.kind(*symbol), SymbolKind::Nilpotent { .. });
        monomial.factors().iter().filter(nilpotent).map(|(_, power)| usize::from(*power)).sum()
    }

    /// True if the monomial is other than zero.
    fn keeps(&self, monomial: &Monomial) -> bool {
        if self.ideal.vanish.is_empty() {
            return self.degree(monomial) <= usize::from(self.ideal.degree);
        }
        let generator = |(symbol, power): &(u16, u8)| match self.kind(*symbol) {
            SymbolKind::Nilpotent { generator } => Some((generator, *power)),
            _ => None,
        };
        self.ideal.keeps(&Monomial::new(monomial.factors().iter().filter_map(generator)))
    }

    /// Returns a monomial with the square of a sine as the same without it and the cosine that belongs to it.
    fn sine_square(&self, monomial: &Monomial) -> Option<(Monomial, Monomial)> {
        let square = |(symbol, power): &(u16, u8)| match self.kind(*symbol) {
            SymbolKind::Sine { cosine } if *power > 1 => Some((*symbol, cosine)),
            _ => None,
        };
        let (sine, cosine) = monomial.factors().iter().find_map(square)?;
        let lowered = |(symbol, power): &(u16, u8)| (*symbol, if *symbol == sine { power - 2 } else { *power });
        let without = Monomial::new(monomial.factors().iter().map(lowered));
        let with_cosine = without.times(&Monomial::new([(cosine, 2)]));
        Some((without, with_cosine))
    }

    pub(super) fn product(&self, a: &BTreeMap<Monomial, f64>, b: &BTreeMap<Monomial, f64>) -> BTreeMap<Monomial, f64> {
        let highest = usize::from(self.ideal.degree);
        let right: Vec<(usize, &Monomial, f64)> = b.iter().map(|(m, c)| (self.degree(m), m, *c)).collect();
        let fits = |left: &Monomial| {
            let room = highest.checked_sub(self.degree(left));
            right.iter().filter(move |(degree, ..)| room.is_some_and(|room| *degree <= room))
        };
        let mut sum = Sum::default();
        for (left, value) in a {
            if !self.spend(fits(left).count()) {
                return BTreeMap::from([(Monomial::default(), f64::NAN)]);
            }
            for (_, monomial, c) in fits(left) {
                sum.add(self, left.times(monomial), value * c);
            }
        }
        sum.terms()
    }
}

/// A sum of monomials, each with the sum of the sizes of its contributions.
#[derive(Default)]
pub(super) struct Sum(BTreeMap<Monomial, (f64, f64)>);

impl Sum {
    pub(super) fn add(&mut self, rules: &Rules, monomial: Monomial, value: f64) {
        if let Some((without, with_cosine)) = rules.sine_square(&monomial) {
            self.add(rules, without, value);
            self.add(rules, with_cosine, -value);
        } else if rules.keeps(&monomial) {
            let (sum, size) = self.0.entry(monomial).or_default();
            *sum += value;
            *size += value.abs();
        }
    }

    /// Returns the terms that are not rounding residues of others.
    pub(super) fn terms(self) -> BTreeMap<Monomial, f64> {
        self.0.into_iter().filter_map(|(m, (sum, size))| Some((m, round(sum, size)?))).collect()
    }
}

/// Sums below this fraction of their parts are rounding: coefficients of long products of rotations
/// about skew axes have lost some digits before they cancel.
const ROUNDING: f64 = 1e-12;

/// `None` if a sum is no more than the rounding of its parts. NaN stays, to be noticed.
pub(super) fn round(sum: f64, size: f64) -> Option<f64> {
    (sum.is_nan() || sum.abs() > ROUNDING * size).then_some(sum)
}
