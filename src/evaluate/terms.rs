//! Results of an evaluation: deviation, rotation and E_VE as elements of an algebra, their sums, and their parts by
//! monomial and by degree.

use crate::algebra::weil::{Coefficients, Monomial};
use crate::algebra::{Algebra, difference};
use nalgebra::{Matrix3, Matrix4, Vector3};
use std::collections::BTreeMap;

/// Actual minus nominal, of the tool relative to the workpiece. Not a correction: a correction has the opposite sign,
/// and only `compensation` makes one from the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Displacement of the functional point, mm.
    pub position: Vector3<f64>,
    /// Rotation vector of the tool, rad.
    pub rotation: Vector3<f64>,
}

impl Deviation {
    /// Returns the deviation with its vectors rotated.
    pub fn rotated(&self, r: &Matrix3<f64>) -> Self {
        Self { position: r * self.position, rotation: r * self.rotation }
    }
}

/// The result of an evaluation at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Nominal position of the functional point from the workpiece origin, mm.
    pub nominal: Vector3<f64>,
    /// Actual minus nominal.
    pub deviation: Deviation,
    /// (T_tool^-1 T_work) actual minus nominal, between workpiece frame and tool frame; the same in every frame.
    pub e_ve: Matrix4<f64>,
}

/// A part of an evaluation, with the errors as large as they are; the parts of all monomials add up to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// The product of generators.
    pub monomial: Monomial,
    /// Part of the deviation, mm and rad.
    pub deviation: Deviation,
    /// Part of E_VE.
    pub e_ve: Matrix4<f64>,
}

/// An evaluation as elements of an algebra, vectors in the frame of the workpiece at zero rotation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Elements<S: Algebra> {
    /// Nominal position of the functional point from the workpiece origin, mm.
    pub nominal: Vector3<f64>,
    /// Displacement of the functional point, mm.
    pub position: Vector3<S>,
    /// Rotation vector of the tool, rad.
    pub rotation: Vector3<S>,
    /// (T_tool^-1 T_work) actual minus nominal.
    pub e_ve: Matrix4<S>,
}

impl<S: Algebra> Elements<S> {
    /// Returns the sum of all degrees.
    pub fn sum(&self) -> Evaluation {
        let value = |x: &S| difference(x, 0.0);
        let deviation =
            Deviation { position: self.position.map(|x| value(&x)), rotation: self.rotation.map(|x| value(&x)) };
        Evaluation { nominal: self.nominal, deviation, e_ve: self.e_ve.map(|x| value(&x)) }
    }
}

impl<S: Coefficients> Elements<S> {
    /// Returns the parts that are not 0, lowest degree first; without the real part, which is rounding, unless
    /// `is_real`: location errors act there.
    pub fn terms(&self, is_real: bool) -> Vec<Term> {
        let mut parts: BTreeMap<(usize, Monomial), Term> = BTreeMap::new();
        let mut put = |element: &S, at: &dyn Fn(&mut Term) -> &mut f64| {
            let counts = |(monomial, value): &(Monomial, f64)| *value != 0.0 && (is_real || monomial.degree() > 0);
            for (monomial, value) in element.terms().into_iter().filter(counts) {
                let key = (monomial.degree(), monomial.clone());
                *at(parts.entry(key).or_insert_with(|| Term::zero(monomial))) = value;
            }
        };
        for k in 0..3 {
            put(&self.position[k], &|term| &mut term.deviation.position[k]);
            put(&self.rotation[k], &|term| &mut term.deviation.rotation[k]);
        }
        for k in 0..16 {
            put(&self.e_ve[k], &|term| &mut term.e_ve[k]);
        }
        parts.into_values().collect()
    }
}

impl Term {
    fn zero(monomial: Monomial) -> Self {
        let deviation = Deviation { position: Vector3::zeros(), rotation: Vector3::zeros() };
        Self { monomial, deviation, e_ve: Matrix4::zeros() }
    }

    /// Returns the sums of the parts of one degree, lowest first: monomials are the powers of one generator.
    pub fn by_degree(terms: &[Self]) -> Vec<Self> {
        let mut degrees: Vec<Self> = Vec::new();
        for term in terms {
            let degree = term.monomial.degree();
            if degrees.last().is_none_or(|last| last.monomial.degree() < degree) {
                degrees.push(Self::zero(Monomial::new([(0, u8::try_from(degree).unwrap_or(u8::MAX))])));
            }
            let Some(sum) = degrees.last_mut() else { continue };
            sum.deviation.position += term.deviation.position;
            sum.deviation.rotation += term.deviation.rotation;
            sum.e_ve += term.e_ve;
        }
        degrees
    }
}
