//! Effects of errors: to first order one by one, to second order two by two. Both are read off the algebra with a
//! generator for every error.

use crate::algebra::Weil;
use crate::algebra::weil::Monomial;
use crate::diagnostic::Diagnostic;
use crate::evaluate::response;
use crate::lower::{DeclaredAlgebra, ErrorLift, ErrorValues, Source, WeilLift, named_sources, unit_values, values};
use crate::machine::{AlgebraChoice, Approach, LocationOrder, Machine, OperatingPoint};
use nalgebra::Vector3;

/// The effect of a product of errors: the coefficient of its monomial, in mm and rad.
#[derive(Debug, Clone, PartialEq)]
pub struct ProductEffect {
    /// The errors, one or two; twice the same one for a square.
    pub errors: Vec<String>,
    /// Displacement of the functional point with each of them 1 mm or 1 rad, workpiece frame.
    pub deviation: Vector3<f64>,
    /// Rotation of the tool.
    pub rotation: Vector3<f64>,
    /// Product of the errors' values at the pose.
    pub value: f64,
}

/// All effects at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Interactions {
    /// First degree: the derivatives by the errors.
    pub first: Vec<ProductEffect>,
    /// Second degree: mixed derivatives, and half the second ones. Those that are not zero.
    pub second: Vec<ProductEffect>,
}

impl Interactions {
    /// Returns a bound of the second-degree terms that order 1 neglects, position (mm) and rotation (rad): all
    /// interactions with one sign.
    pub fn neglected_bound(&self) -> (f64, f64) {
        let length = |v: &Vector3<f64>, effect: &ProductEffect| v.norm() * effect.value.abs();
        let sum = |(position, rotation): (f64, f64), e: &ProductEffect| {
            (position + length(&e.deviation, e), rotation + length(&e.rotation, e))
        };
        self.second.iter().fold((0.0, 0.0), sum)
    }
}

/// The effects of errors at poses.
#[derive(Debug)]
pub struct Calculation<'a> {
    machine: &'a Machine,
    lift: WeilLift,
    units: ErrorValues,
}

/// Returns the calculation for a machine, with a generator for every error, to degree 1 or 2. Fails if the algebra has
/// too many elements.
pub fn interactions(machine: &Machine, degree: u8) -> Result<Calculation<'_>, Diagnostic> {
    let lift = DeclaredAlgebra::new(machine, &AlgebraChoice::per_error(degree))?.build()?;
    let mut units = unit_values(machine);
    if machine.conventions().location_order == LocationOrder::Real {
        // These are no generators: they are in the real part as they are.
        let actual = values(machine, &Approach::Mean.at_pose(&vec![0.0; machine.axes().len()]));
        units.axes.iter_mut().zip(&actual.axes).for_each(|(unit, actual)| unit.location = actual.location);
        units.spindle = actual.spindle;
    }
    Ok(Calculation { machine, lift, units })
}

impl Calculation<'_> {
    /// Returns the effects at an operating point.
    pub fn at(&self, at: &OperatingPoint<'_>) -> Interactions {
        let response = response(self.machine, at.axes, &self.units, &UnitErrors(&self.lift));
        let errors = values(self.machine, at);
        let sizes = self.sizes(&errors);
        let names = self.lift.declared().names();
        let effect = |monomial: &Monomial| {
            let read = |v: &Vector3<Weil>| v.map(|x| x.coefficient(monomial));
            let each =
                || monomial.factors().iter().flat_map(|(g, p)| std::iter::repeat_n(usize::from(*g), usize::from(*p)));
            ProductEffect {
                errors: each().map(|g| names[g].clone()).collect(),
                deviation: read(&response.position),
                rotation: read(&response.rotation),
                value: each().map(|g| sizes[g]).product(),
            }
        };
        let of_degree = |degree| self.lift.basis().monomials().iter().filter(move |m| m.degree() == degree).map(effect);
        let acts = |e: &ProductEffect| e.deviation != Vector3::zeros() || e.rotation != Vector3::zeros();
        Interactions { first: of_degree(1).collect(), second: of_degree(2).filter(acts).collect() }
    }

    /// Returns the values of the errors in the order of the generators.
    fn sizes(&self, errors: &ErrorValues) -> Vec<f64> {
        let mut sizes = vec![0.0; self.lift.declared().names().len()];
        for given in named_sources(self.machine) {
            if let Some(generator) = self.lift.declared().of(given.source) {
                sizes[usize::from(generator)] = errors.of(given.source);
            }
        }
        sizes
    }
}

/// Errors as large as their generators.
struct UnitErrors<'a>(&'a WeilLift);

impl ErrorLift<Weil> for UnitErrors<'_> {
    fn lift(&self, source: Source, value: f64) -> Weil {
        if value == 0.0 { Weil::Constant(0.0) } else { self.0.lift(source, 1.0) }
    }
}
