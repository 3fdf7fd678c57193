//! The basis of a Weil algebra: its surviving monomials and their products.

use super::groebner::{Binomial, GroebnerBasis, IdealFailure};
use super::monomials::{Ideal, MAX_BYTES, Monomial, Size};
use super::table::{ProductTable, ScaledProduct};
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
    /// Its relations have no basis.
    Ideal(IdealFailure),
}

/// R[x_0, ...] modulo an ideal of monomials and homogeneous binomials.
#[derive(Debug, PartialEq)]
pub struct Basis {
    generators: u16,
    ideal: Ideal,
    /// Relations between monomials; none of a monomial ideal.
    relations: Option<GroebnerBasis>,
    /// Lowest degree first; 1 is the first.
    monomials: Vec<Monomial>,
    index: BTreeMap<Monomial, u32>,
    /// The products that make each monomial.
    table: ProductTable,
}

impl Basis {
    /// Builds the basis and the table of products of a monomial ideal.
    pub fn new(generators: u16, ideal: Ideal) -> Result<Arc<Self>, BasisFailure> {
        Self::with_relations(generators, ideal, &[])
    }

    /// Builds them of an ideal of monomials and homogeneous binomials.
    pub fn with_relations(generators: u16, ideal: Ideal, relations: &[Binomial]) -> Result<Arc<Self>, BasisFailure> {
        if !(1..=MAX_ORDER).contains(&usize::from(ideal.degree)) {
            return Err(BasisFailure::Degree(ideal.degree));
        }
        if ideal.vanish.iter().any(|v| v.degree() == 0) {
            return Err(BasisFailure::KillsOne);
        }
        let related = relations.iter().flat_map(|r| [&r.left, &r.right]);
        let named = ideal.vanish.iter().chain(related).flat_map(|v| v.factors()).map(|(generator, _)| *generator);
        if let Some(unknown) = named.into_iter().find(|g| *g >= generators) {
            return Err(BasisFailure::Generator(unknown));
        }
        let found = (!relations.is_empty()).then(|| GroebnerBasis::new(&ideal, relations)).transpose();
        let relations = found.map_err(BasisFailure::Ideal)?;
        let ideal = relations.as_ref().map_or(ideal, GroebnerBasis::initial);
        let size = ideal.size(generators);
        let size = if relations.is_some() { size.with_relations() } else { size };
        if size.bytes() > MAX_BYTES {
            return Err(BasisFailure::Size(size));
        }
        Ok(Arc::new(Self::within_limits(generators, ideal, relations)))
    }

    fn within_limits(generators: u16, ideal: Ideal, relations: Option<GroebnerBasis>) -> Self {
        let monomials = ideal.survivors(generators);
        let index: BTreeMap<Monomial, u32> = monomials.iter().cloned().zip(0..).collect();
        let at = |monomial: &Monomial| index.get(monomial).copied().unwrap_or_default();
        let row = |monomial: &Monomial| {
            let mut row: Vec<[u32; 2]> = monomial.divisors().iter().map(|(a, b)| [at(a), at(b)]).collect();
            row.sort_unstable();
            row
        };
        let packed = ideal.degree == 2 && monomials.len() == packed_length(generators);
        let table = match &relations {
            Some(relations) => ProductTable::Scaled(scaled_products(&monomials, &index, relations)),
            None if packed => ProductTable::Quadratic(usize::from(generators)),
            None => ProductTable::new(monomials.iter().map(row), generators),
        };
        Self { generators, ideal, relations, monomials, index, table }
    }

    /// Returns the relations between its monomials; none of a monomial ideal.
    pub fn relations(&self) -> Option<&GroebnerBasis> {
        self.relations.as_ref()
    }

    /// Returns any monomial as a factor and the index of a surviving one; `None` if it vanishes.
    pub fn normal_form(&self, monomial: &Monomial) -> Option<(f64, usize)> {
        match &self.relations {
            None => self.position(monomial).map(|k| (1.0, k)),
            Some(relations) => {
                let (factor, monomial) = relations.normal_form(monomial)?;
                self.position(&monomial).map(|k| (factor, k))
            }
        }
    }

    /// Returns the surviving monomials, 1 first, lowest degree first.
    pub fn monomials(&self) -> &[Monomial] {
        &self.monomials
    }

    /// Returns the index of a monomial in [`Self::monomials`]; `None` if it vanishes or stands for others.
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

/// Returns all products of two surviving monomials that do not vanish, each as a factor and a surviving monomial.
fn scaled_products(
    monomials: &[Monomial],
    index: &BTreeMap<Monomial, u32>,
    relations: &GroebnerBasis,
) -> Vec<ScaledProduct> {
    let mut products = Vec::new();
    for (i, left) in (0..).zip(monomials) {
        for (j, right) in (0..).zip(monomials) {
            let form = relations.normal_form(&left.times(right));
            let Some((factor, into)) = form.and_then(|(factor, m)| Some((factor, *index.get(&m)?))) else { continue };
            products.push(ScaledProduct { factors: [i, j], into, factor });
        }
    }
    products
}

/// Monomials to degree 2 if none vanishes.
fn packed_length(generators: u16) -> usize {
    let k = usize::from(generators);
    (k + 1) * (k + 2) / 2
}
