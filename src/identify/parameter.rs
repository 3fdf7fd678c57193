//! What is fitted: each parameter moves one or more error sources, each by a basis function of the axis position.

use crate::lower::{Place, Source};
use crate::machine::{AxisKind, Curve, Machine, sin_cos_degrees};

/// Lever (mm) by which a rotation counts as a displacement where sizes of unlike parameters are compared.
const LEVER: f64 = 300.0;

/// A function of the programmed position of an axis (mm or deg).
#[derive(Debug, Clone, PartialEq)]
pub enum Basis {
    /// 1.
    Constant,
    /// `q^k`.
    Power(u8),
    /// `cos k q`, q an angle.
    Cosine(u8),
    /// `sin k q`, q an angle.
    Sine(u8),
    /// A spline that is 1 at one knot and 0 at the others.
    Spline(Curve),
}

impl Basis {
    /// Value at a position (mm or deg).
    pub fn value(&self, q: f64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Power(k) => (0..*k).fold(1.0, |power, _| power * q),
            Self::Cosine(k) => sin_cos_degrees(f64::from(*k) * q).1,
            Self::Sine(k) => sin_cos_degrees(f64::from(*k) * q).0,
            Self::Spline(curve) => curve.value(q),
        }
    }
}

/// One error source that a parameter moves: by `factor * basis(q)` per unit (mm or rad) of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// The error.
    pub source: Source,
    /// As a function of its axis's position.
    pub basis: Basis,
    /// Times this.
    pub factor: f64,
}

/// A fitted parameter. Its value is kept in mm, rad and degrees of position: mm, rad/mm, mm/deg^2 ...
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// `EX0C`, `tool.X`, `workpiece.A`, `EXX:x^2`, `ECC:cos1`, `EYX:125mm`, `EBX:slope`.
    pub name: String,
    /// Its unit for people.
    pub unit: String,
    /// Multiplies the kept value to give one in `unit`.
    pub factor: f64,
    /// What it moves.
    pub terms: Vec<Term>,
    /// Where the fit starts.
    pub start: f64,
    /// Displacement (mm) that a unit of it makes over a usual lever: for comparing unlike parameters.
    pub size: f64,
}

impl Parameter {
    /// A parameter of one term.
    pub(super) fn single(machine: &Machine, name: String, source: Source, basis: Basis, start: f64) -> Self {
        let power = if let Basis::Power(k) = basis { k } else { 0 };
        let term = Term { source, basis, factor: 1.0 };
        Self::of_terms(machine, name, source, power, vec![term], start)
    }

    /// A parameter of several terms, in the unit of its main source over the position to a power.
    pub(super) fn of_terms(
        machine: &Machine,
        name: String,
        main: Source,
        power: u8,
        terms: Vec<Term>,
        start: f64,
    ) -> Self {
        let rotation = main.direction.is_rotation();
        let (unit, mut factor) = if rotation { ("urad", 1e6) } else { ("um", 1e3) };
        let mut size = if rotation { LEVER } else { 1.0 };
        let mut per = "";
        if let (Place::Component(i), 1..) = (main.place, power) {
            let axis = &machine.axes()[i];
            let (min, max) = axis.travel.interval();
            let reach = min.abs().max(max.abs()).max(1.0);
            let metre = if axis.kind == AxisKind::Linear { 1e3 } else { 1.0 };
            per = if axis.kind == AxisKind::Linear { "/m" } else { "/deg" };
            (0..power).for_each(|_| {
                factor *= metre;
                size *= reach;
            });
        }
        let exponent = if power > 1 { format!("^{power}") } else { String::new() };
        Self { name, unit: format!("{unit}{per}{exponent}"), factor, terms, start, size }
    }

    /// The value in `unit`.
    pub fn shown(&self, value: f64) -> f64 {
        value * self.factor
    }
}
