//! The basis of a Weil algebra: its surviving monomials and their products.

use super::monomials::{Ideal, MAX_BYTES, Monomial, Size};
use super::table::ProductTable;
use crate::algebra::MAX_ORDER;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The reason for which an algebra cannot be built.
#[derive(Debug, Clone, PartialEq)]
pub enum BasisFailure {
    /// The ideal contains 1: no algebra remains.
    KillsOne,
    /// The degree is 0 or above [`MAX_ORDER`].
    Degree(u8),
    /// A vanishing monomial names a generator that is not there.
    Generator(u16),
    /// It would need more than 1 GB; an upper bound of its size.
    Size(Size),
}

/// R[x_0, ...] modulo a monomial ideal.
#[derive(Debug, PartialEq)]
pub struct Basis {
    generators: u16,
    ideal: Ideal,
    /// Lowest degree first; 1 is the first.
    monomials: Vec<Monomial>,
    index: BTreeMap<Monomial, u32>,
    /// The products that make each monomial.
    table: ProductTable,
}

impl Basis {
    /// Builds the basis and the table of products.
    pub fn new(generators: u16, ideal: Ideal) -> Result<Arc<Self>, BasisFailure> {
        if !(1..=MAX_ORDER).contains(&usize::from(ideal.degree)) {
            return Err(BasisFailure::Degree(ideal.degree));
        }
        if ideal.vanish.iter().any(|v| v.degree() == 0) {
            return Err(BasisFailure::KillsOne);
        }
        let named = ideal.vanish.iter().flat_map(|v| v.factors()).map(|(generator, _)| *generator);
        if let Some(unknown) = named.into_iter().find(|g| *g >= generators) {
            return Err(BasisFailure::Generator(unknown));
        }
        let size = ideal.size(generators);
        if size.bytes() > MAX_BYTES {
            return Err(BasisFailure::Size(size));
        }
        Ok(Arc::new(Self::within_limits(generators, ideal)))
    }

    fn within_limits(generators: u16, ideal: Ideal) -> Self {
        let monomials = ideal.survivors(generators);
        let index: BTreeMap<Monomial, u32> = monomials.iter().cloned().zip(0..).collect();
        let at = |monomial: &Monomial| index.get(monomial).copied().unwrap_or_default();
        let row = |monomial: &Monomial| {
            let mut row: Vec<[u32; 2]> = monomial.divisors().iter().map(|(a, b)| [at(a), at(b)]).collect();
            row.sort_unstable();
            row
        };
        let packed = ideal.degree == 2 && monomials.len() == packed_length(generators);
        let table = if packed {
            ProductTable::Quadratic(usize::from(generators))
        } else {
            ProductTable::new(monomials.iter().map(row), generators)
        };
        Self { generators, ideal, monomials, index, table }
    }

    /// Returns the surviving monomials, 1 first, lowest degree first.
    pub fn monomials(&self) -> &[Monomial] {
        &self.monomials
    }

    /// Returns the index of a monomial in [`Self::monomials`]; `None` if it vanishes.
    pub fn position(&self, monomial: &Monomial) -> Option<usize> {
        self.index.get(monomial).map(|i| *i as usize)
    }

    /// Highest degree of a surviving monomial.
    pub fn order(&self) -> usize {
        self.monomials.last().map_or(0, Monomial::degree)
    }

    #[cfg(test)]
    pub(super) fn table(&self) -> &ProductTable {
        &self.table
    }

    /// Multiplications in one product.
    pub fn products(&self) -> usize {
        self.table.products()
    }

    /// The product of two lists of coefficients, all three as long as [`Self::monomials`]. With one generator each sum
    /// runs by rising index of the left factor: it agrees with the dedicated dual numbers to the last bit.
    pub fn multiply(&self, a: &[f64], b: &[f64], out: &mut [f64]) {
        self.table.multiply(a, b, out);
    }
}

/// Monomials to degree 2 if none vanishes.
fn packed_length(generators: u16) -> usize {
    let k = usize::from(generators);
    (k + 1) * (k + 2) / 2
}
