//! Fitted parameters: each moves one or more error sources, each by a basis function of the axis position.

use crate::identify::data::{InstrumentUnknown, Measurement, MeasurementSet, Reading, lever};
use crate::identify::thresholds::SLOPE_SITES;
use crate::lower::{ErrorSite, Source};
use crate::machine::{Approach, AxisKind, Curve, Direction, ErrorId, Knots, Machine, sin_cos_degrees};
use nalgebra::DVector;

/// A function of the programmed position of an axis (mm or deg).
#[derive(Debug, Clone, PartialEq)]
pub enum BasisFunction {
    /// 1.
    Constant,
    /// `q^k`.
    Power(u8),
    /// `cos k q`, q an angle.
    Cosine(u8),
    /// `sin k q`, q an angle.
    Sine(u8),
    /// A spline, or straight lines between knots, that is 1 at one knot and 0 at the others; or a B-spline.
    Spline(Curve),
}

impl BasisFunction {
    /// Returns the positions at which its pieces meet; `None` if it has no pieces.
    pub(crate) fn knots(&self) -> Option<&[f64]> {
        if let Self::Spline(curve) = self { curve.knots().map(Knots::positions) } else { None }
    }

    /// Returns the value at a position (mm or deg).
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
pub struct ParameterTerm {
    /// The error.
    pub source: Source,
    /// As a function of its axis's position.
    pub basis: BasisFunction,
    /// Times this.
    pub factor: f64,
    /// Acts in this direction of approach only; half in their mean. `Mean`: always.
    pub approach: Approach,
    /// Acts on readings with this tool, or of this run, only.
    pub only: Option<Clamping>,
}

/// A tool, or the workpiece, as it was clamped: for all readings, or for those of one run (or without a run).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Clamping {
    /// Index in [`Machine::tools`]; none for the workpiece.
    pub tool: Option<usize>,
    /// Its run, where each run has a clamping of its own.
    pub run: Option<Option<String>>,
}

impl Clamping {
    /// True if a measurement was taken with it.
    pub(crate) fn holds(&self, m: &Measurement) -> bool {
        self.tool.is_none_or(|tool| tool == m.tool) && self.run.as_ref().is_none_or(|run| *run == m.run)
    }
}

impl ParameterTerm {
    /// True if both are of one curve: of the same error, approached alike, of the same clamping.
    pub(crate) fn is_of_curve(&self, other: &Self) -> bool {
        (self.source, self.approach, &self.only) == (other.source, other.approach, &other.only)
    }

    /// Returns a term that acts in both directions.
    pub(crate) fn new(source: Source, basis: BasisFunction, factor: f64) -> Self {
        Self { source, basis, factor, approach: Approach::Mean, only: None }
    }
}

/// Returns the weight of a term of one direction of approach for a reading of another: 1, 1/2 in the mean, or 0.
pub(crate) fn approach_weight(own: Approach, met: Approach) -> f64 {
    match (own, met) {
        (Approach::Mean, _) => 1.0,
        (_, Approach::Mean) => 0.5,
        (own, met) => f64::from(u8::from(own == met)),
    }
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
    /// Terms that it moves; empty if it belongs to an instrument or a set-up.
    pub terms: Vec<ParameterTerm>,
    /// Start of the fit.
    pub start: f64,
    /// Displacement (mm) that a unit of it makes over a usual lever: for comparing unlike parameters.
    pub size: f64,
}

impl Parameter {
    pub(crate) fn single(machine: &Machine, name: String, source: Source, basis: BasisFunction, start: f64) -> Self {
        let power = if let BasisFunction::Power(k) = basis { k } else { 0 };
        let term = ParameterTerm::new(source, basis, 1.0);
        Self::of_terms(machine, name, source, power, vec![term], start)
    }

    /// Returns a parameter of several terms, in the unit of its main source over the position to a power.
    pub(crate) fn of_terms(
        machine: &Machine,
        name: String,
        main: Source,
        power: u8,
        terms: Vec<ParameterTerm>,
        start: f64,
    ) -> Self {
        let rotation = main.direction.is_rotation();
        let (unit, mut factor) = if rotation { ("urad", 1e6) } else { ("um", 1e3) };
        let mut size = lever(main.direction);
        let mut per = "";
        if let (ErrorSite::Component(i), 1..) = (main.place, power) {
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

    /// True if it is of a tool or workpiece as it was clamped: fitted and reported, and no part of the fitted machine.
    pub fn is_clamping(&self) -> bool {
        self.terms.iter().any(|term| term.only.is_some())
    }

    /// True if it is of the workpiece as it was clamped for one run.
    pub(crate) fn is_workpiece_clamping(&self) -> bool {
        self.terms.iter().any(|term| term.only.as_ref().is_some_and(|of| of.tool.is_none()))
    }

    /// True if it belongs to an instrument or a set-up.
    pub fn is_nuisance(&self) -> bool {
        self.terms.is_empty()
    }

    /// Returns the curve that it is a knot of, and where: `EYX` and `125mm`. Otherwise its name.
    pub(crate) fn curve(&self) -> (&str, Option<&str>) {
        let knot = matches!(&self.terms[..], [ParameterTerm { basis: BasisFunction::Spline(_), .. }]);
        match self.name.split_once(':') {
            Some((curve, place)) if knot => (curve, Some(place)),
            _ => (&self.name, None),
        }
    }

    /// Returns the value in `unit`.
    pub fn in_unit(&self, value: f64) -> f64 {
        value * self.factor
    }
}

impl From<InstrumentUnknown> for Parameter {
    /// Returns the parameter of an unknown length (mm) or angle that is no error of the machine.
    fn from(InstrumentUnknown { name, is_angle, start, .. }: InstrumentUnknown) -> Self {
        let (unit, factor, size) = if is_angle { ("urad", 1e6, lever(Direction::A)) } else { ("mm", 1.0, 1.0) };
        Self { name, unit: unit.to_owned(), factor, terms: Vec::new(), start, size }
    }
}

/// Returns the sizes of parameters: the displacements (mm) that their units make.
pub(crate) fn sizes(parameters: &[Parameter]) -> DVector<f64> {
    DVector::from_iterator(parameters.len(), parameters.iter().map(|p| p.size))
}

/// Returns the site of an error. Its axis is one of the chain, or the spindle.
pub(crate) fn source(machine: &Machine, error: &ErrorId) -> Source {
    let joint = machine.axis_index(error.axis.as_str()).unwrap_or(machine.axes().len());
    let place = if error.is_location() { ErrorSite::Location(joint) } else { ErrorSite::Component(joint) };
    Source { place, direction: error.direction }
}

/// A soft bound on the slope of a fitted curve, for where nothing was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct SlopeBound {
    /// The error.
    pub source: Source,
    /// Interval of the axis (mm or deg).
    pub interval: (f64, f64),
    /// Standard deviation of the slope (mm or rad, per mm or deg).
    pub slope: f64,
}

impl SlopeBound {
    /// Returns the slope at even positions over the bound, as coefficients of the parameters. All of them together
    /// count as one reading of the slope.
    pub(crate) fn rows(&self, parameters: &[Parameter]) -> Vec<Vec<f64>> {
        let step = (self.interval.1 - self.interval.0) / SLOPE_SITES as f64;
        let row = |i: usize| {
            let (low, high) = (self.interval.0 + step * i as f64, self.interval.0 + step * (i + 1) as f64);
            let rise = |term: &ParameterTerm| term.factor * (term.basis.value(high) - term.basis.value(low));
            let slope = |p: &Parameter| p.terms.iter().filter(|t| t.source == self.source).map(rise).sum::<f64>();
            let scale = step * self.slope * libm::sqrt(SLOPE_SITES as f64);
            parameters.iter().map(|p| slope(p) / scale).collect()
        };
        (0..SLOPE_SITES).map(row).collect()
    }
}

impl MeasurementSet {
    /// Removes readings of single errors that no fitted parameter moves. Returns the number removed of each error.
    pub fn leave_out(&mut self, fitted: &[Parameter]) -> Vec<(Source, usize)> {
        let mut list: Vec<(Source, usize)> = Vec::new();
        self.rows.retain(|m| {
            let Reading::Error { source, .. } = m.reading else { return true };
            let is_fitted = fitted.iter().any(|p| p.terms.iter().any(|t| t.source == source));
            match list.iter_mut().find(|(known, _)| *known == source) {
                _ if is_fitted => {}
                Some((_, count)) => *count += 1,
                None => list.push((source, 1)),
            }
            is_fitted
        });
        list
    }
}
