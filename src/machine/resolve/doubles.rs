//! Warnings about errors that cannot act, and about component errors that repeat what a location
//! error says: data that carries both is counted twice.

use super::context::Context;
use super::found_errors::Errors;
use crate::algebra::rotation_about;
use crate::diagnostic::{Diagnostic, Place, codes};
use crate::machine::{
    Axis, AxisKind, Branch, Direction, ErrorFamily, ErrorId, ErrorTerm, JointConvention, LocationAction, MachineParts,
    MotionSide, Travel, sin_cos_degrees,
};
use crate::syntax::{DatumEntry, DatumLine, Document, SquarenessSite};
use crate::units;
use nalgebra::Vector3;

/// Repeated parts up to this (mm, rad) are noise.
const NOISE: f64 = 1e-3;
const NOISE_ANGLE: f64 = 1e-6;
/// A location error up to this part of the noise is the rounding of a fit: a nanometre, a nanoradian.
const ROUNDING: f64 = 1e-3;
/// Above so many times the noise they are reported even if no location error is given.
const LARGE: f64 = 50.0;
/// Slope of a straightness (rad) from which on it is reported whatever else is given: 10 um/m.
const STEEP: f64 = 1e-5;
/// They must also be this part of the curve's peak.
const MIN_FRACTION: f64 = 0.25;
const NODES: u32 = 360;

/// Both kinds of warning.
pub fn warn(context: &mut Context, parts: &MachineParts, places: &Errors) {
    inert(context, parts, places);
    let fitted = fitted_curves(context);
    for (index, axis) in parts.axes.iter().enumerate() {
        let doubles = Doubles { parts, places, axis, index, fitted: &fitted };
        Direction::ALL.into_iter().for_each(|direction| doubles.constant(context, direction));
        match axis.kind {
            AxisKind::Linear => Direction::ALL.into_iter().take(3).for_each(|d| doubles.slope(context, d)),
            AxisKind::Rotary => [false, true].into_iter().for_each(|tilts| doubles.first_harmonic(context, tilts)),
        }
    }
}

/// True for a location error that a fit was asked for, by its own request in the file that it wrote.
pub(super) fn is_fitted_location(document: &Document, error: &ErrorId) -> bool {
    let is_of = |entry: &String| ["location", "needed"].contains(&entry.as_str()) || *entry == error.to_string();
    error.family == ErrorFamily::Location && fitted(document).any(is_of)
}

/// True if a fit wrote the curve.
pub(super) fn is_fitted_curve(document: &Document, error: &ErrorId) -> bool {
    fitted(document).any(|entry| entry.split(':').next().is_some_and(|name| name.trim() == error.to_string()))
}

/// Returns what a fit was asked for, by its own request in the file that it wrote.
fn fitted(document: &Document) -> impl Iterator<Item = &String> {
    let request = document.identify.iter().filter(|_| document.provenance.contains_key("identified-by"));
    request.flat_map(|request| &request.fit)
}

/// Names of the curves that a fit wrote.
fn fitted_curves(context: &Context) -> Vec<String> {
    let names = fitted(context.document).filter_map(|entry| entry.split_once(':'));
    names.map(|(name, _)| name.trim().to_owned()).collect()
}

/// Location errors that change nothing when the axis of motion is displaced.
fn inert(context: &mut Context, parts: &MachineParts, places: &Errors) {
    let displaced = |(axis, _): &(&Axis, _)| axis.convention(&parts.conventions).location == LocationAction::Displaces;
    for (axis, errors) in parts.axes.iter().zip(&parts.errors).filter(displaced) {
        for (_, direction, term) in errors.iter().filter(|(family, ..)| *family == ErrorFamily::Location) {
            let given = is_stated(term, direction) && !matches!(term, ErrorTerm::Tolerance(0.0));
            let error = ErrorId { axis: axis.name.clone(), family: ErrorFamily::Location, direction };
            // What acts by products only is no mistake of who fitted it.
            if given && cannot_act(axis, direction) && !is_fitted_location(context.document, &error) {
                let why = match axis.kind {
                    AxisKind::Linear => "a straight line displaced, or turned about itself, is the same line of motion",
                    AxisKind::Rotary => "an axis of rotation moved along, or turned about, itself is the same axis",
                };
                let place = places.places.get(&error).cloned().flatten();
                let warning = Diagnostic::new(codes::W0402, format!("`{error}` cannot act: {why}"));
                let help = "remove it, or set `conventions: { location: carried_body }` if the body was measured";
                context.diagnostics.push(warning.at(place, "").help(help));
            }
        }
    }
}

/// False for a constant that is zero, or the rounding of a fit.
fn is_stated(term: &ErrorTerm, direction: Direction) -> bool {
    !matches!(term, ErrorTerm::Constant(value) if value.abs() <= ROUNDING * noise(direction))
}

/// Returns the noise of an error, mm or rad.
fn noise(direction: Direction) -> f64 {
    if direction.is_rotation() { NOISE_ANGLE } else { NOISE }
}

fn cannot_act(axis: &Axis, direction: Direction) -> bool {
    let along = axis.direction[direction.index() % 3].abs() > 1.0 - 1e-9;
    along || (axis.kind == AxisKind::Linear && !direction.is_rotation())
}

/// One axis's component errors, looked through for what repeats a location error.
struct Doubles<'a> {
    parts: &'a MachineParts,
    places: &'a Errors,
    axis: &'a Axis,
    index: usize,
    /// Names of the curves that a fit wrote.
    fitted: &'a [String],
}

/// A repeated part of a curve: amount, peak and kind.
struct DoubledEntry {
    amount: f64,
    peak: f64,
    direction: Direction,
    what: &'static str,
    /// The slope, of a straight line.
    slope: Option<f64>,
}

impl Doubles<'_> {
    fn id(&self, direction: Direction) -> ErrorId {
        ErrorId { axis: self.axis.name.clone(), family: ErrorFamily::Component, direction }
    }

    /// True if there is a curve that no fit made. Of those that one made the sum with the location errors is what the
    /// data say; the covariance states their parts, or else the request of the fit names them.
    fn is_given(&self, direction: Direction) -> bool {
        let term = &self.parts.errors[self.index].component[direction.index()];
        let id = self.id(direction);
        let is_fitted =
            || self.parts.covariance.iter().any(|part| part.moves(&id)) || self.fitted.contains(&id.to_string());
        matches!(term, Some(ErrorTerm::Component(_))) && !is_fitted()
    }

    fn value(&self, direction: Direction, position: f64) -> f64 {
        let term = &self.parts.errors[self.index].component[direction.index()];
        term.as_ref().map_or(0.0, |term| term.value(&position.into()))
    }

    /// (position, value) over the travel.
    fn samples(&self, direction: Direction) -> Vec<(f64, f64)> {
        let (min, max) = self.axis.travel.interval();
        let at = |i: u32| min + (max - min) * (f64::from(i) + 0.5) / f64::from(NODES);
        (0..NODES).map(|i| (at(i), self.value(direction, at(i)))).collect()
    }

    /// A constant counts only if it is zero neither at the zero pose nor on average nor where the datum of a fit has
    /// its zero: curves are brought to zero either way. In its own direction an axis has a datum instead.
    fn constant(&self, context: &mut Context, direction: Direction) {
        let own = direction.is_rotation() == (self.axis.kind == AxisKind::Rotary)
            && self.axis.direction[direction.index() % 3].abs() > 0.999;
        if own || !self.is_given(direction) {
            return;
        }
        let samples = self.samples(direction);
        let mean = mean(samples.iter().map(|s| s.1));
        let home = if self.axis.travel.contains(0.0) { self.value(direction, 0.0) } else { mean };
        let travel = self.axis.travel.interval().into();
        let at_datum =
            self.axis.datum_zero(datum(context).zero, travel).map_or(mean, |zero| self.value(direction, zero));
        let amount = common(common(mean, home) * mean.signum(), at_datum);
        let peak = samples.iter().fold(0.0, |m: f64, s| m.max(s.1.abs()));
        let rivals = self.location_errors(|axis, d| {
            d == direction && (d.is_rotation() || axis.kind == AxisKind::Rotary) && self.moves(axis)
        });
        self.report(context, &DoubledEntry { amount, peak, direction, what: "a constant", slope: None }, &rivals);
    }

    /// The straight line in a straightness error is squareness. Like a constant it counts only if it
    /// has been taken out neither over the travel nor (as the tangent) at the zero pose.
    fn slope(&self, context: &mut Context, direction: Direction) {
        let across = Vector3::from(self.axis.direction).cross(&Vector3::ith(direction.index(), 1.0));
        if !self.is_given(direction) || across.norm() < 1e-6 {
            return;
        }
        let samples = self.samples(direction);
        let (min, max) = self.axis.travel.interval();
        // The position from -1 to 1 over the travel, and the polynomials orthogonal on it.
        let t = |q: f64| (2.0 * q - min - max) / (max - min);
        let third = mean(samples.iter().map(|s| t(s.0) * t(s.0)));
        let fit = |p: &dyn Fn(f64) -> f64| {
            let square = samples.iter().map(|s| p(t(s.0)) * p(t(s.0))).sum::<f64>();
            samples.iter().map(|s| p(t(s.0)) * s.1).sum::<f64>() / square
        };
        let line = fit(&|t| t);
        let at_home = line + 2.0 * fit(&|t| t * t - third) * t(0.0_f64.clamp(min, max));
        let ends = 0.5 * (self.value(direction, max) - self.value(direction, min));
        let (line, at_home) = if datum(context).line == DatumLine::EndPoints { (ends, ends) } else { (line, at_home) };
        let v0 = mean(samples.iter().map(|s| s.1));
        let peak = samples.iter().fold(0.0, |m: f64, s| m.max((s.1 - v0).abs()));
        let amount = common(line, at_home);
        let rotation = largest(&across);
        let rivals = self.location_errors(|axis, d| d.index() == 3 + rotation && axis.kind == AxisKind::Linear);
        let slope = Some(line.signum() * 2.0 * amount / (max - min));
        self.report(context, &DoubledEntry { amount, peak, direction, what: "a straight line", slope }, &rivals);
    }

    /// Run-out or tilt that turns with the axis is its own displacement or inclination.
    fn first_harmonic(&self, context: &mut Context, tilts: bool) {
        let (min, max) = self.axis.travel.interval();
        let of = |i: usize| Direction::ALL[if tilts { 3 + i } else { i }];
        if (max - min < 350.0 && self.axis.travel != Travel::Continuous) || !(0..3).any(|i| self.is_given(of(i))) {
            return;
        }
        let samples: [Vec<(f64, f64)>; 3] = std::array::from_fn(|i| self.samples(of(i)));
        let means = Vector3::from_fn(|i, _| mean(samples[i].iter().map(|s| s.1)));
        let u = Vector3::from(self.axis.direction);
        let sense = turning(&self.axis.convention(&self.parts.conventions));
        let (mut turned, mut peak) = (Vector3::zeros(), 0.0_f64);
        for ((x, y), z) in samples[0].iter().zip(&samples[1]).zip(&samples[2]) {
            let v = Vector3::new(x.1, y.1, z.1) - means;
            let v = v - u * v.dot(&u);
            peak = peak.max(v.norm());
            let back: Vector3<f64> = rotation_about(&self.axis.direction, sin_cos_degrees(-sense * x.0)) * v;
            turned += back / f64::from(NODES);
        }
        let direction = of(largest(&turned));
        let rivals = self.location_errors(|axis, d| {
            axis.name == self.axis.name && d.is_rotation() == tilts && u[d.index() % 3].abs() < 0.999
        });
        let what = "a part that turns with the axis";
        self.report(context, &DoubledEntry { amount: turned.norm(), peak, direction, what, slope: None }, &rivals);
    }

    /// True if it is this axis, or one that it carries.
    fn moves(&self, other: &Axis) -> bool {
        let Some(index) = self.parts.axes.iter().position(|axis| axis.name == other.name) else { return false };
        let outward = match self.axis.branch {
            Branch::Tool => index >= self.index,
            Branch::Workpiece => index <= self.index,
        };
        outward && other.branch == self.axis.branch
    }

    /// Location errors that are given, not zero, and chosen.
    fn location_errors(&self, choose: impl Fn(&Axis, Direction) -> bool) -> Vec<ErrorId> {
        let mut list = Vec::new();
        for (axis, errors) in self.parts.axes.iter().zip(&self.parts.errors) {
            for (_, direction, term) in errors.iter().filter(|(family, ..)| *family == ErrorFamily::Location) {
                let constant = matches!(term, ErrorTerm::Constant(_)) && is_stated(term, direction);
                let acts = constant && !cannot_act(axis, direction);
                if acts && choose(axis, direction) {
                    list.push(ErrorId { axis: axis.name.clone(), family: ErrorFamily::Location, direction });
                }
            }
        }
        list
    }

    fn report(&self, context: &mut Context, found: &DoubledEntry, rivals: &[ErrorId]) {
        let noise = noise(found.direction);
        let large = found.amount > LARGE * noise;
        // NaN compares as false and stays quiet.
        let counts = found.amount > noise && found.amount > MIN_FRACTION * found.peak;
        let in_straightness = found.slope.is_some() && datum(context).squareness == SquarenessSite::Straightness;
        let steep = found.slope.is_some_and(|slope| slope.abs() > STEEP);
        if !counts || (rivals.is_empty() && (in_straightness || !(large || steep))) {
            return;
        }
        let error = self.id(found.direction);
        let amount =
            if found.direction.is_rotation() { units::angle(found.amount) } else { units::length(found.amount) };
        let shown = match found.slope {
            Some(slope) => {
                let over = units::length(2.0 * found.amount);
                format!("{} um/m, {over} over the travel", units::significant(slope * 1e6, 3))
            }
            None => amount,
        };
        let place = |id: &ErrorId| -> Option<Place> { self.places.places.get(id).cloned().flatten() };
        let message = format!("`{error}` holds {} of {shown}, which location errors describe as well", found.what);
        let warning = Diagnostic::new(codes::W0403, message).at(place(&error), "");
        let rival = rivals.first();
        let warning = warning.at(rival.and_then(place), "the location error given");
        let help = match found.slope.filter(|_| rivals.is_empty()) {
            Some(slope) => self.line_help(&error, slope),
            None => "take it out of the curve, or out of the location error: data that carries both is counted twice"
                .to_owned(),
        };
        context.diagnostics.push(warning.help(help));
    }

    /// Remedy for a straight line: the set-up of the instrument, or a squareness with its sign.
    fn line_help(&self, error: &ErrorId, slope: f64) -> String {
        let convention = self.axis.convention(&self.parts.conventions);
        let usual = convention.motion_sign * convention.component.sign() > 0.0;
        let squareness = error.squareness().filter(|_| usual);
        let value = squareness.map_or_else(
            || "write it as squareness".to_owned(),
            |(name, sign)| format!("write it as `{name}: {}`", units::angle(sign * slope)),
        );
        format!(
            "take the line off (`abbe import` does): it shows how the instrument stood. If its reference was an \
             artefact of the machine, {value}, or say `identify: {{ datum: {{ squareness: in straightness }} }}`. A \
             line through the end points is another: `datum: {{ line: end-points }}`"
        )
    }
}

/// +1 if the errors of a displaced axis turn with the programmed position, else -1.
fn turning(convention: &JointConvention) -> f64 {
    match convention.component.side {
        MotionSide::Outer => convention.motion_sign,
        MotionSide::Inner => -convention.motion_sign,
    }
}

fn datum(context: &Context) -> DatumEntry {
    context.document.identify.as_ref().and_then(|identify| identify.datum).unwrap_or_default()
}

/// Returns the smaller of two numbers of the same sign.
fn common(a: f64, b: f64) -> f64 {
    if a * b > 0.0 { a.abs().min(b.abs()) } else { 0.0 }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / count
}

fn largest(v: &Vector3<f64>) -> usize {
    (0..3).max_by(|i, j| v[*i].abs().total_cmp(&v[*j].abs())).unwrap_or(0)
}
