//! Deviations by monomial and by degree.

use super::effects::MAX_EFFECTS;
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Order, Term};
use crate::lower::WeilLift;
use nalgebra::{Matrix4, Vector3};

/// The part of a deviation that one monomial in the generators makes, with the errors as large as they are.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct MonomialPart {
    /// `EXX*EC0Y^2`; `i^2` of an order; `1` of location errors in the real part.
    pub monomial: String,
    /// Displacement of the functional point, mm.
    pub deviation: [f64; 3],
    /// Rotation of the tool, rad.
    pub rotation: [f64; 3],
    /// `T_tool^-1 T_work`, row by row.
    pub e_ve: [[f64; 4]; 4],
}

/// The part of a deviation that all monomials of one degree make.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct DegreePart {
    /// Total degree; 0 of location errors in the real part.
    pub degree: usize,
    /// Displacement of the functional point, mm.
    pub deviation: [f64; 3],
    /// Rotation of the tool, rad.
    pub rotation: [f64; 3],
    /// `T_tool^-1 T_work`, row by row.
    pub e_ve: [[f64; 4]; 4],
}

/// The parts that a result has.
pub(crate) struct Parts<'a> {
    lift: Option<&'a WeilLift>,
    /// False of the exact model, and of deviations less a motion: parts are of machine coordinates.
    has_degrees: bool,
    /// Parts of monomials of all poses, at most.
    count: usize,
}

impl<'a> Parts<'a> {
    pub fn new(order: Order, lift: Option<&'a WeilLift>, poses: usize, is_of_machine: bool) -> Self {
        let monomials = match (lift, order) {
            (Some(lift), _) => lift.basis().monomials().len(),
            (None, Order::Degree(degree)) => usize::from(degree),
            (None, Order::Exact) => 0,
        };
        Self { lift, has_degrees: is_of_machine && monomials > 0, count: monomials.saturating_mul(poses) }
    }

    /// Warns of parts that are too many to be listed.
    pub fn left_out(&self) -> Option<Diagnostic> {
        let message = format!("the {} parts of monomials are left out: {MAX_EFFECTS} are listed", self.count);
        let help = "ask at fewer poses, or for fewer generators or a lower degree";
        (self.has_degrees && self.count > MAX_EFFECTS).then(|| Diagnostic::new(codes::W0803, message).help(help))
    }

    /// Returns the parts of a pose, by monomial and by degree.
    pub fn of(&self, terms: &[Term]) -> (Option<Vec<MonomialPart>>, Option<Vec<DegreePart>>) {
        let coefficients = || terms.iter().map(|term| self.monomial(term)).collect();
        let degrees = || Term::by_degree(terms).iter().map(degree).collect();
        ((self.has_degrees && self.count <= MAX_EFFECTS).then(coefficients), self.has_degrees.then(degrees))
    }

    fn monomial(&self, term: &Term) -> MonomialPart {
        let name = match (self.lift, term.monomial.degree()) {
            (_, 0) => "1".to_owned(),
            (Some(lift), _) => lift.declared().monomial_name(&term.monomial),
            (None, 1) => "i".to_owned(),
            (None, degree) => format!("i^{degree}"),
        };
        let (deviation, rotation, e_ve) = rows(term);
        MonomialPart { monomial: name, deviation, rotation, e_ve }
    }
}

fn degree(term: &Term) -> DegreePart {
    let (deviation, rotation, e_ve) = rows(term);
    DegreePart { degree: term.monomial.degree(), deviation, rotation, e_ve }
}

fn rows(term: &Term) -> ([f64; 3], [f64; 3], [[f64; 4]; 4]) {
    (row(&term.deviation.position), row(&term.deviation.rotation), matrix(&term.e_ve))
}

/// Returns a vector as results state it: adding zero turns -0 into 0.
pub(crate) fn row(v: &Vector3<f64>) -> [f64; 3] {
    [v.x + 0.0, v.y + 0.0, v.z + 0.0]
}

/// Returns the same of a matrix, row by row.
pub(crate) fn matrix(m: &Matrix4<f64>) -> [[f64; 4]; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)] + 0.0))
}
