//! Error values at a pose, and how they enter an algebra.

use crate::algebra::{Algebra, Dual};
use crate::machine::{Direction, ErrorFamily, ErrorId, LocationOrder, Machine, OperatingPoint};
use nalgebra::Vector3;

/// The part of the machine to which an error belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ErrorSite {
    /// Location error of the joint with this index (the spindle comes after the axes).
    Location(usize),
    /// Component error of the axis with this index.
    Component(usize),
    /// Clamping of the tool.
    Tool,
    /// Clamping of the workpiece.
    Workpiece,
}

/// One error source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Source {
    /// The part of the machine.
    pub place: ErrorSite,
    /// The direction of the error.
    pub direction: Direction,
}

impl Source {
    /// Returns the error at this place of a machine; `None` for set-up errors.
    pub fn error(&self, machine: &Machine) -> Option<ErrorId> {
        let (joint, family) = match self.place {
            ErrorSite::Location(joint) => (joint, ErrorFamily::Location),
            ErrorSite::Component(joint) => (joint, ErrorFamily::Component),
            ErrorSite::Tool | ErrorSite::Workpiece => return None,
        };
        let axis = machine.axes().get(joint).map(|axis| &axis.name).or_else(|| machine.chain().spindle()).cloned()?;
        Some(ErrorId { axis, family, direction: self.direction })
    }
}

/// The conversion of an error of a given size (mm or rad) to an element of the algebra.
pub trait ErrorLift<S: Algebra> {
    /// Returns the element of an error, mm or rad.
    fn lift(&self, source: Source, value: f64) -> S;

    /// Returns the element of an error that counts in the real part (`location_order: real`).
    fn real(&self, _: Source, value: f64) -> S {
        S::from_real(value)
    }
}

/// The exact model: errors are real numbers.
#[derive(Debug, Clone, Copy)]
pub struct Exact;

impl ErrorLift<f64> for Exact {
    fn lift(&self, _: Source, value: f64) -> f64 {
        value
    }
}

/// Order n: every error is of first order, `value * i`.
#[derive(Debug, Clone, Copy)]
pub struct OrderN;

impl<const M: usize> ErrorLift<Dual<M>> for OrderN {
    fn lift(&self, _: Source, value: f64) -> Dual<M> {
        Dual::first_order(value)
    }
}

/// The errors of one axis at a pose, in mm and rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisErrorValues {
    /// Its location errors.
    pub location: [f64; 6],
    /// Its component errors.
    pub component: [f64; 6],
}

/// The errors of a machine at a pose, in mm and rad.
#[derive(Debug, Clone)]
pub struct ErrorValues {
    /// Location and component errors of each axis, in the order of [`Machine::axes`].
    pub axes: Vec<AxisErrorValues>,
    /// Location errors of the spindle.
    pub spindle: Option<[f64; 6]>,
    /// Displacement of the tip.
    pub tool: [f64; 3],
    /// Displacement of the workpiece.
    pub workpiece: [f64; 6],
}

/// Looks up every error at an operating point.
pub fn values(machine: &Machine, at: &OperatingPoint<'_>) -> ErrorValues {
    let axis = |i: usize| {
        let errors = machine.axis_errors(i);
        AxisErrorValues { location: errors.location_values(), component: errors.component_values(&at.argument(i)) }
    };
    ErrorValues {
        axes: (0..at.axes.len()).map(axis).collect(),
        spindle: machine.spindle_errors().map(crate::machine::JointErrors::location_values),
        tool: machine.setup().tool,
        workpiece: machine.setup().workpiece,
    }
}

impl ErrorValues {
    /// Returns the value of one error, mm or rad.
    pub fn of(&self, source: Source) -> f64 {
        let direction = source.direction.index();
        match source.place {
            ErrorSite::Location(i) => match self.axes.get(i) {
                Some(axis) => axis.location[direction],
                None => self.spindle.map_or(0.0, |six| six[direction]),
            },
            ErrorSite::Component(i) => self.axes.get(i).map_or(0.0, |axis| axis.component[direction]),
            ErrorSite::Tool => self.tool.get(direction).copied().unwrap_or(0.0),
            ErrorSite::Workpiece => self.workpiece[direction],
        }
    }
}

impl ErrorValues {
    /// Puts the value of one error, mm or rad.
    pub(crate) fn set(&mut self, source: Source, value: f64) {
        let direction = source.direction.index();
        match source.place {
            ErrorSite::Location(i) => match self.axes.get_mut(i) {
                Some(axis) => axis.location[direction] = value,
                None => self.spindle.get_or_insert([0.0; 6])[direction] = value,
            },
            ErrorSite::Component(i) => {
                self.axes.iter_mut().skip(i).take(1).for_each(|a| a.component[direction] = value)
            }
            ErrorSite::Tool => self.tool.iter_mut().skip(direction).take(1).for_each(|x| *x = value),
            ErrorSite::Workpiece => self.workpiece[direction] = value,
        }
    }
}

/// Errors as elements, location errors as the conventions count them.
pub(super) struct Elements<'a, L> {
    lift: &'a L,
    real_locations: bool,
}

impl<'a, L> Elements<'a, L> {
    pub(super) fn new(machine: &Machine, lift: &'a L) -> Self {
        Self { lift, real_locations: machine.conventions().location_order == LocationOrder::Real }
    }

    /// Returns `None` where all six are zero: the identity then costs nothing.
    pub(super) fn six<S: Algebra>(&self, place: ErrorSite, six: &[f64; 6]) -> Option<[S; 6]>
    where
        L: ErrorLift<S>,
    {
        let element = |direction: Direction| self.one(Source { place, direction }, six[direction.index()]);
        six.iter().any(|value| *value != 0.0).then(|| Direction::ALL.map(element))
    }

    pub(super) fn one<S: Algebra>(&self, source: Source, value: f64) -> S
    where
        L: ErrorLift<S>,
    {
        match source.place {
            ErrorSite::Location(_) if self.real_locations => self.lift.real(source, value),
            _ => self.lift.lift(source, value),
        }
    }

    pub(super) fn tip<S: Algebra>(&self, tip: [f64; 3], setup_error: [f64; 3]) -> Vector3<S>
    where
        L: ErrorLift<S>,
    {
        Vector3::from_fn(|i, _| {
            let displacement = if setup_error[i] == 0.0 {
                S::zero()
            } else {
                self.one(Source { place: ErrorSite::Tool, direction: Direction::ALL[i] }, setup_error[i])
            };
            S::from_real(tip[i]) + displacement
        })
    }
}
