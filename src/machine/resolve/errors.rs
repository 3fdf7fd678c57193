//! Error terms: names, their axes, one place each, plausible size.

use super::context::{Context, dotted_path};
use super::curve_of::CurveOf;
use super::curves::{Between, component, from_table, one_way, refuse_without_points};
use super::found_errors::{Errors, bounded};
use super::joint_names::{JointNames, find_error};
use super::names::Spelling;
use super::tolerances::{Named, letter, meaning, warn_oblique};
use crate::diagnostic::{Diagnostic, Place, codes};
use crate::machine::{AxisName, ComponentError, Direction, ErrorFamily, ErrorId, ErrorTerm};
use crate::syntax::{ColumnDirection, CurveEntry, FigureEntry, IdentifyEntry, Keys, TermEntry, below, keys};
use crate::units::{self, Dimension};
use std::collections::BTreeSet;

/// Errors above these are mistakes of unit (mm, rad).
const MAX_TRANSLATION: f64 = 10.0;
const MAX_ROTATION: f64 = 0.1;
/// The same, whatever the file says.
const LARGEST_TRANSLATION: f64 = 500.0;
const LARGEST_ROTATION: f64 = 0.5;

/// The errors to read.
pub struct ErrorScope<'a> {
    /// Those that the block of a side replaces.
    pub replaced: &'a BTreeSet<ErrorId>,
    /// The axes to read errors of; all of them by default.
    pub axes: Option<&'a BTreeSet<AxisName>>,
}

impl ErrorScope<'_> {
    fn skips(&self, error: &ErrorId) -> bool {
        self.replaced.contains(error) || self.axes.is_some_and(|axes| !axes.contains(&error.axis))
    }
}

/// Returns all error terms under `errors` and in tables that are in scope.
pub fn plain(context: &mut Context, known: &JointNames<'_>, scope: &ErrorScope<'_>) -> Errors {
    let document = context.document;
    let mut errors = Errors::default();
    for (name, entry) in &document.errors {
        let at = keys(["errors", name]);
        let place = document.places.key(&at);
        let Some(spelling) = find_error(context, name, known, place.clone()) else { continue };
        if !once(context, &mut errors, &spelling.error, place) || scope.skips(&spelling.error) {
            continue;
        }
        if let Some(entry) = entry {
            put_term(context, &mut errors, &spelling, entry, known, &at);
        }
    }
    for (name, entry) in &document.tolerances {
        let Named::Error = meaning(name, known) else { continue };
        let at = keys(["tolerances", name]);
        let place = document.places.key(&at);
        let Some(spelling) = find_error(context, name, known, place.clone()) else { continue };
        if !once(context, &mut errors, &spelling.error, place) || scope.skips(&spelling.error) {
            continue;
        }
        if let Some(entry) = entry {
            let term = letter(context, &spelling.error, entry, known, &at);
            errors.put(&spelling.error, term);
        }
    }
    for (i, path) in document.measured.iter().enumerate() {
        read_columns(context, &mut errors, &below(&keys(["measured"]), i), path, known, scope);
    }
    errors
}

/// Puts a term and its uncertainty.
pub fn put_term(
    context: &mut Context,
    errors: &mut Errors,
    spelling: &Spelling,
    entry: &TermEntry,
    known: &JointNames<'_>,
    at: &Keys,
) {
    let term = term(context, spelling, entry, known, at);
    errors.put(&spelling.error, term);
    if let Some(value) = uncertainty(context, &spelling.error, entry, at) {
        let _ = errors.uncertainty.insert(spelling.error.clone(), value);
    }
}

/// True if the error has not been given elsewhere.
pub fn once(context: &mut Context, errors: &mut Errors, error: &ErrorId, place: Option<Place>) -> bool {
    if let Some(first) = errors.places.get(error) {
        let refusal = Diagnostic::new(codes::E0407, format!("`{error}` is given twice"))
            .at(place, "again here")
            .at(first.clone(), "first here")
            .help("remove one of the two: an error stands once, under `errors`, in `tolerances` or in one table");
        context.diagnostics.push(refusal);
        return false;
    }
    errors.places.insert(error.clone(), place);
    true
}

/// Forms that exclude each other, as (key, is it there).
fn forms(entry: &TermEntry) -> Vec<&'static str> {
    let curve = curve_forms(&entry.curve());
    let ways =
        [("forward", entry.forward.is_some() || entry.reverse.is_some()), ("tolerance", entry.tolerance.is_some())];
    curve.into_iter().chain(ways.into_iter().filter(|f| f.1).map(|f| f.0)).collect()
}

fn curve_forms(entry: &CurveEntry) -> Vec<&'static str> {
    let all = [
        ("value", entry.value.is_some()),
        ("table", entry.table.is_some()),
        ("points", entry.points.is_some()),
        ("polynomial", entry.polynomial.is_some()),
        ("harmonics", entry.harmonics.is_some()),
        ("bspline", entry.bspline.is_some()),
    ];
    all.into_iter().filter(|f| f.1).map(|f| f.0).collect()
}

/// Exactly one form.
fn one_form(context: &mut Context, forms: &[&str], at: &Keys) -> bool {
    match forms {
        [_] => true,
        [] => {
            if !context.document.places.is_marred(at) {
                let help =
                    "write a value such as `12 um`, or one of table, points, polynomial, harmonics, bspline, tolerance";
                context.at_key(codes::E0203, at, format!("`{}` has no value", dotted_path(at)), help);
            }
            false
        }
        [first, second, ..] => {
            let message = format!("`{first}` and `{second}` of `{}` exclude each other", dotted_path(at));
            context.at_key(codes::E0209, &below(at, second), message, "keep one of them");
            false
        }
    }
}

fn uncertainty(context: &mut Context, error: &ErrorId, entry: &TermEntry, at: &Keys) -> Option<f64> {
    let here = below(at, "uncertainty");
    let value = context.error_value(entry.uncertainty.as_ref()?, error.direction, &here)?;
    if entry.tolerance.is_some() {
        let message = format!("`tolerance` and `uncertainty` of `{}` exclude each other", dotted_path(at));
        context.at_key(codes::E0209, &here, message, "an uncertainty belongs to a known value");
        return None;
    }
    if value < 0.0 {
        let help = "an uncertainty is a half-width: `0.6 um` means ±0.6 um (k = 2)";
        context.at_value(codes::E0411, &here, "a negative uncertainty", help);
        return None;
    }
    context.plausible(value, error.direction, &here).then_some(value)
}

/// Returns the term that an entry writes.
pub fn term(
    context: &mut Context,
    spelling: &Spelling,
    entry: &TermEntry,
    known: &JointNames<'_>,
    at: &Keys,
) -> Option<ErrorTerm> {
    let forms = forms(entry);
    if !one_form(context, &forms, at) {
        return None;
    }
    let error = &spelling.error;
    if let Some(scalar) = &entry.tolerance {
        refuse_without_points(context, &entry.curve(), at);
        let figure = FigureEntry { value: Some(scalar.clone()), words: Vec::new() };
        warn_oblique(context, error, known, &figure, at);
        return bounded(context, scalar, error.direction, &below(at, "tolerance")).map(ErrorTerm::Tolerance);
    }
    if error.is_location() {
        return constant(context, spelling, entry, &forms, at);
    }
    let axis = known.axis(&error.axis);
    let Some(axis) = axis else {
        let help = "a spindle does not move here; it has location errors such as `EA0S`";
        context.at_key(codes::E0408, at, format!("`{error}` is a component error of the spindle"), help);
        return None;
    };
    // Faults of the axis have been reported there.
    let of = CurveOf { error, axis, kind: axis.kind?, negated: spelling.negated };
    let component = if forms == ["forward"] {
        refuse_without_points(context, &entry.curve(), at);
        both_ways(context, &of, entry, at)
    } else {
        component(context, &of, &entry.curve(), at)
    };
    let component = component?;
    plausible_curve(context, &of, &component, at).then_some(ErrorTerm::Component(component))
}

fn constant(
    context: &mut Context,
    spelling: &Spelling,
    entry: &TermEntry,
    forms: &[&str],
    at: &Keys,
) -> Option<ErrorTerm> {
    let error = &spelling.error;
    let joined = [("interpolation", &entry.interpolation), ("beyond", &entry.beyond)];
    let joined = joined.into_iter().find(|(_, word)| word.is_some()).map(|(key, _)| key);
    let Some(scalar) = entry.value.as_ref().filter(|_| joined.is_none()) else {
        let form = joined.or(forms.first().copied()).unwrap_or("");
        let help = format!("write one value: `{error}: 12 urad`; what varies with the position is a component error");
        context.at_key(codes::E0408, &below(at, form), format!("`{error}` is a location error, a constant"), help);
        return None;
    };
    let here = context.value_of(at);
    let value = context.error_value(scalar, error.direction, &here)?;
    let sign = if spelling.negated { -1.0 } else { 1.0 };
    context.plausible(value, error.direction, &here).then_some(ErrorTerm::Constant(sign * value))
}

fn both_ways(context: &mut Context, of: &CurveOf<'_>, entry: &TermEntry, at: &Keys) -> Option<ComponentError> {
    let mut one_sided = |key: &str, curve: &Option<CurveEntry>, direction| {
        let here = below(at, key);
        match curve {
            Some(curve) => one_form(context, &curve_forms(curve), &here)
                .then(|| one_way(context, of, curve, &here, direction))
                .flatten(),
            None => {
                if !context.document.places.is_marred(&here) {
                    let help = "give both directions, or one curve without direction";
                    context.at_key(codes::E0203, at, format!("`{}` has no `{key}`", dotted_path(at)), help);
                }
                None
            }
        }
    };
    let forward = one_sided("forward", &entry.forward, ColumnDirection::Forward);
    let reverse = one_sided("reverse", &entry.reverse, ColumnDirection::Reverse);
    Some(ComponentError::Bidirectional { forward: forward?, reverse: reverse? })
}

fn read_columns(
    context: &mut Context,
    errors: &mut Errors,
    at: &Keys,
    path: &str,
    known: &JointNames<'_>,
    scope: &ErrorScope<'_>,
) {
    let Some(table) = context.table(at, path) else { return };
    if table.columns.len() < 2 {
        let refusal = Diagnostic::new(codes::E0114, "the table has no column of errors")
            .at(table.columns.first().map(|c| c.place.clone()), "");
        context.diagnostics.push(refusal.help("add columns such as `EXX [um]`"));
    }
    for (i, column) in table.columns.iter().enumerate().skip(1) {
        let place = Some(column.place.clone());
        let Some(spelling) = find_error(context, &column.name, known, place.clone()) else { continue };
        let error = &spelling.error;
        // Columns of one name but different directions are one error.
        if table.columns[1..i].iter().any(|c| c.name == column.name) {
            continue;
        }
        if !once(context, errors, error, place) || scope.skips(error) {
            continue;
        }
        let axis = known.axis(&error.axis);
        let Some((axis, ErrorFamily::Component)) = axis.map(|a| (a, error.family)) else {
            let help = "a table holds component errors; write location errors under `errors`";
            let refusal = Diagnostic::new(codes::E0408, format!("`{error}` does not vary with the position"));
            context.diagnostics.push(refusal.at(Some(column.place.clone()), "").help(help));
            continue;
        };
        let Some(kind) = axis.kind else { continue };
        let of = CurveOf { error, axis, kind, negated: spelling.negated };
        let named = context.document.places.value(at);
        let component = from_table(context, &of, &table, Between::default(), named);
        let is_plausible = |c: &ComponentError| {
            let stated = StatedAt { name: column.name.clone(), place: Some(column.place.clone()) };
            context.is_plausible(peak_of(&of, c), of.error.direction, stated)
        };
        let component = component.filter(is_plausible);
        errors.put(error, component.map(ErrorTerm::Component));
    }
}

fn plausible_curve(context: &mut Context, of: &CurveOf<'_>, component: &ComponentError, at: &Keys) -> bool {
    context.plausible(peak_of(of, component), of.error.direction, at)
}

/// Largest size of an error over the travel.
fn peak_of(of: &CurveOf<'_>, component: &ComponentError) -> f64 {
    component.curves().map(|curve| peak(of, curve)).fold(0.0, f64::max)
}

/// Largest size of a curve over the travel.
fn peak(of: &CurveOf<'_>, curve: &crate::machine::Curve) -> f64 {
    let (min, max) = of.axis.travel.map_or((0.0, 360.0), crate::machine::Travel::interval);
    let at = (0..=256).map(|i| curve.value(min + (max - min) * f64::from(i) / 256.0));
    let knots = curve.knots().map(|k| k.values().to_vec()).unwrap_or_default();
    // NaN and infinity (overflow of a polynomial) count as implausible.
    let size = |v: f64| if v.is_finite() { v.abs() } else { f64::INFINITY };
    at.chain(knots).map(size).fold(0.0, f64::max)
}

/// Returns the size (mm or rad) beyond which an error can only be a mistake of unit.
pub fn largest(direction: Direction) -> f64 {
    if direction.is_rotation() { MAX_ROTATION } else { MAX_TRANSLATION }
}

/// Returns the size (mm or rad) up to which a file may state that errors are plausible.
pub fn largest_stated(direction: Direction) -> f64 {
    if direction.is_rotation() { LARGEST_ROTATION } else { LARGEST_TRANSLATION }
}

/// Returns the size (mm or rad) beyond which an error is a mistake: larger where the file says that its machine has
/// such errors.
pub fn plausible_size(request: Option<&IdentifyEntry>, direction: Direction) -> f64 {
    let given = request.and_then(|request| request.plausible.as_ref()).and_then(|plausible| {
        let scalar = if direction.is_rotation() { &plausible.angle } else { &plausible.length };
        units::quantity(&scalar.as_ref()?.to_string()).ok()
    });
    let wanted = if direction.is_rotation() { Dimension::ANGLE } else { Dimension::LENGTH };
    let given = given.filter(|given| given.dimension == wanted).map_or(0.0, |given| given.value);
    largest(direction).max(given.min(largest_stated(direction)))
}

/// A name, and where it is given a value.
struct StatedAt {
    name: String,
    place: Option<Place>,
}

impl Context<'_> {
    fn largest_plausible(&self, direction: Direction) -> f64 {
        plausible_size(self.document.identify.as_ref(), direction)
    }

    /// Refuses what can only be a mistake of unit.
    pub fn plausible(&mut self, value: f64, direction: Direction, at: &Keys) -> bool {
        let stated = StatedAt { name: dotted_path(at), place: self.document.places.value(at) };
        self.is_plausible(value, direction, stated)
    }

    fn is_plausible(&mut self, value: f64, direction: Direction, at: StatedAt) -> bool {
        if value.abs() <= self.largest_plausible(direction) {
            return true;
        }
        let shown = if direction.is_rotation() {
            format!("{} mrad", crate::units::significant(value * 1e3, 4))
        } else {
            format!("{} mm", crate::units::significant(value, 4))
        };
        let limit = self.largest_plausible(direction);
        let limit = if direction.is_rotation() { format!("{} mrad", limit * 1e3) } else { format!("{limit} mm") };
        let message = format!("`{}` reaches {shown}, which no machine has", at.name);
        let help = format!("check the unit; the limit of plausibility is {limit}");
        self.diagnostics.push(Diagnostic::new(codes::E0412, message).at(at.place, "").help(help));
        false
    }
}
