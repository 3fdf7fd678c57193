//! The joint covariance of errors: independent parts, each written like the errors themselves.

use super::axes::AxisDraft;
use super::context::{Context, dotted_path};
use super::errors::{once, term};
use super::found_errors::Errors;
use super::joint_names::{JointNames, find_error};
use super::parts::{SIX, amounts, setup_at};
use crate::diagnostic::{codes, did_you_mean, shown};
use crate::machine::{Axis, AxisName, Direction, JointUncertainty, ResidualForm, UnheldMotion};
use crate::syntax::{CovarianceEntry, FormEntry, Keys, Scalar, below, keys};
use crate::units::significant;
use std::collections::BTreeMap;

/// The section `covariance`.
#[derive(Default)]
pub struct Covariance {
    /// Independent parts.
    pub joint: Vec<JointUncertainty>,
    /// Forms of axes.
    pub forms: Vec<ResidualForm>,
    /// Rigid motions that the data do not hold.
    pub unheld: Vec<UnheldMotion>,
    /// Ranges (mm, deg) in which fitted curves were measured.
    pub measured: BTreeMap<AxisName, (f64, f64)>,
}

/// Reads the section `covariance`.
pub fn covariance(context: &mut Context, known: &JointNames<'_>) -> Covariance {
    let document = context.document;
    let section = keys(["covariance"]);
    let (count, most) = (document.covariance.len(), JointUncertainty::MOST);
    if count > most {
        let message = format!("`covariance` has {count} parts; {most} are read at most");
        context.at_key(codes::E0202, &section, message, "leave out the parts that change no printed digit");
        return Covariance::default();
    }
    let Covariance { mut joint, mut forms, mut unheld, mut measured } = Covariance::default();
    for (i, entry) in document.covariance.iter().enumerate() {
        let here = below(&section, i);
        refuse_company(context, entry, &here);
        unheld.extend(unheld_motion(context, entry, &unheld, &here));
        for (axis, range) in measured_ranges(context, known, entry, &here) {
            if measured.insert(axis.clone(), range).is_some() {
                let message = format!("`covariance` has two measured ranges of `{axis}`");
                context.at_key(codes::E0209, &below(&here, "measured"), message, "keep one");
            }
        }
        let Some(written) = &entry.form else {
            if entry.unheld.is_empty() && entry.measured.is_empty() {
                joint.push(part(context, known, i, entry));
            }
            continue;
        };
        let at = below(&here, "form");
        let Some(form) = form(context, known, written, &at) else { continue };
        if forms.iter().any(|other| other.axis == form.axis) {
            let message = format!("`covariance` has two forms of `{}`", form.axis);
            context.at_key(codes::E0209, &at, message, "one form is that of all its directions");
        }
        forms.push(form);
    }
    Covariance { joint, forms, unheld, measured }
}

/// Refuses an entry that is no part by itself and stands beside another.
fn refuse_company(context: &mut Context, entry: &CovarianceEntry, here: &Keys) {
    let alone = [
        ("form", entry.form.is_some()),
        ("unheld", !entry.unheld.is_empty()),
        ("measured", !entry.measured.is_empty()),
    ];
    let mut stated = alone.into_iter().filter(|(_, is)| *is).map(|(key, _)| key);
    let Some(first) = stated.next() else { return };
    let part = !entry.errors.is_empty() || entry.setup.is_some();
    let beside =
        if part { Some("`errors` or `setup`".to_owned()) } else { stated.next().map(|key| format!("`{key}`")) };
    if let Some(beside) = beside {
        let at = below(here, first);
        let message = format!("`{}` stands beside {beside}", dotted_path(&at));
        context.at_key(codes::E0209, &at, message, "write it as an entry of its own");
    }
}

/// Reads a motion; refuses none at all, and one that those before it already make: both were meant to be another.
fn unheld_motion(
    context: &mut Context,
    entry: &CovarianceEntry,
    before: &[UnheldMotion],
    here: &Keys,
) -> Option<UnheldMotion> {
    if entry.unheld.is_empty() {
        return None;
    }
    let at = below(here, "unheld");
    let motion = UnheldMotion::of(amounts(context, &entry.unheld, &SIX, &at));
    let refusal = if motion.amounts().iter().all(|amount| *amount == 0.0) {
        Some((codes::E0202, "is no motion", "give an amount of any size but 0, such as `X: 1 um`; or leave it out"))
    } else if motion.is_made_by(before) {
        Some((codes::E0209, "is a motion that those before it make", "leave it out, or mend its amounts"))
    } else {
        None
    };
    let Some((code, what, help)) = refusal else { return Some(motion) };
    if !context.document.places.is_marred(&at) {
        context.at_key(code, &at, format!("`{}` {what}", dotted_path(&at)), help);
    }
    None
}

/// Returns the ranges of axes in which their curves were measured.
fn measured_ranges(
    context: &mut Context,
    known: &JointNames<'_>,
    entry: &CovarianceEntry,
    here: &Keys,
) -> Vec<(AxisName, (f64, f64))> {
    let section = below(here, "measured");
    let one = |(name, ends): (&String, &Vec<Scalar>)| {
        let at = below(&section, name);
        let axis = declared_axis(context, known, name, &at)?;
        let (min, max) = context.interval(ends, axis.kind?, &at)?;
        if let Some((from, to)) =
            axis.travel.map(|travel| travel.interval()).filter(|(from, to)| min < *from || max > *to)
        {
            let unit = axis.kind?.unit();
            let message = format!("`{}` goes beyond the travel from {from} to {to} {unit}", dotted_path(&at));
            context.at_value(codes::E0403, &at, message, "write where the curves were measured, within the travel");
        }
        Some((axis.name.clone(), (min, max)))
    };
    entry.measured.iter().filter_map(one).collect()
}

/// Returns an axis by name; refuses one that the machine does not have.
fn declared_axis<'a>(context: &mut Context, known: &JointNames<'a>, name: &str, at: &Keys) -> Option<&'a AxisDraft> {
    let declared = known.declared.iter().find(|declared| declared.name.as_str() == name);
    if declared.is_none() {
        let names: Vec<&str> = known.declared.iter().map(|declared| declared.name.as_str()).collect();
        let message = format!("`{}` is not an axis of the machine", shown(name));
        context.at_value(codes::E0406, at, message, did_you_mean(name, &names));
    }
    declared
}

fn part(context: &mut Context, known: &JointNames<'_>, index: usize, entry: &CovarianceEntry) -> JointUncertainty {
    let here = below(&keys(["covariance"]), index);
    let mut errors = Errors::default();
    for (name, entry) in &entry.errors {
        let at = below(&below(&here, "errors"), name);
        let place = context.document.places.key(&at);
        let Some(spelling) = find_error(context, name, known, place.clone()) else { continue };
        if entry.tolerance.is_some() || entry.uncertainty.is_some() {
            let message = format!("`{}` is itself an uncertainty", dotted_path(&at));
            context.at_key(codes::E0209, &at, message, "write one standard uncertainty as a value or a curve");
            continue;
        }
        if once(context, &mut errors, &spelling.error, place) {
            let term = term(context, &spelling, entry, known, &at);
            errors.put(&spelling.error, term);
        }
    }
    let setup = entry.setup.as_ref().map(|setup| setup_at(context, setup, &below(&here, "setup")));
    JointUncertainty { errors: errors.joints, setup: setup.unwrap_or_default() }
}

fn form(context: &mut Context, known: &JointNames<'_>, entry: &FormEntry, here: &Keys) -> Option<ResidualForm> {
    let sized = entry.size.is_some() || entry.rotation.is_some() || !entry.errors.is_empty();
    let (Some(axis), true, Some(length)) = (&entry.axis, sized, &entry.length) else {
        if !context.document.places.is_marred(here) {
            let path = dotted_path(here);
            let message = format!("`{path}` has not all of `axis`, `size` or `rotation` or `errors`, and `length`");
            let remedy = "such as { axis: X, size: 0.8 um, rotation: 3 urad, length: 60 mm }";
            context.at_key(codes::E0203, here, message, remedy);
        }
        return None;
    };
    let declared = declared_axis(context, known, axis, &below(here, "axis"))?;
    let at_length = below(here, "length");
    let mut sizes = Some([0.0; 6]);
    for (written, directions, key) in
        [(&entry.size, &Direction::ALL[..3], "size"), (&entry.rotation, &Direction::ALL[3..], "rotation")]
    {
        let Some(written) = written else { continue };
        let size = scatter(context, written, directions[0], &below(here, key));
        directions.iter().for_each(|direction| put(&mut sizes, *direction, size));
    }
    for (name, written) in &entry.errors {
        let at = below(&below(here, "errors"), name);
        let place = context.document.places.key(&at);
        let Some(spelling) = find_error(context, name, known, place) else { continue };
        let error = &spelling.error;
        if error.is_location() || error.axis.as_str() != axis.as_str() {
            let message = format!("`{error}` is no error of the axis `{}` over its position", shown(axis));
            context.at_key(codes::E0209, &at, message, "write the errors of one axis, such as EXX to ECX");
        } else if entry.size.is_some() && !error.direction.is_rotation()
            || entry.rotation.is_some() && error.direction.is_rotation()
        {
            let message = format!("`{}` has the size of `{error}` twice", dotted_path(here));
            context.at_key(codes::E0209, &at, message, "leave out `size` and `rotation`, or `errors`");
        } else {
            let size = scatter(context, written, error.direction, &at);
            put(&mut sizes, error.direction, size);
        }
    }
    let length = context.position(length, declared.kind?, &at_length)?;
    let is_long = above_zero(context, length, &at_length);
    sizes.filter(|sizes| is_long && *sizes != [0.0; 6]).map(|sizes| ResidualForm {
        axis: declared.name.clone(),
        sizes,
        length,
    })
}

/// Puts the size of an error, if it is one, to the others, if these are all sizes.
fn put(sizes: &mut Option<[f64; 6]>, direction: Direction, size: Option<f64>) {
    match (sizes.as_mut(), size) {
        (Some(sizes), Some(size)) => sizes[direction.index()] = size,
        _ => *sizes = None,
    }
}

fn scatter(context: &mut Context, written: &Scalar, direction: Direction, at: &Keys) -> Option<f64> {
    let value = context.error_value(written, direction, at)?;
    context.plausible(value, direction, at);
    above_zero(context, value, at).then_some(value)
}

/// Refuses forms whose length is too small a part of the travel for independent waves to be written out.
pub fn refuse_fine_forms(context: &mut Context, forms: &[ResidualForm], axes: &[Axis]) {
    for form in forms {
        let Some(axis) = axes.iter().find(|axis| axis.name == form.axis) else { continue };
        let (min, max) = axis.travel.interval();
        let least = (max - min) / ResidualForm::MAX_TRAVEL_OVER_LENGTH;
        if form.length >= least {
            continue;
        }
        let (unit, name) = (axis.unit(), &form.axis);
        let length = significant(form.length, 4);
        let message = format!("the form of `{name}` has a length of {length} {unit}, below 1/200 of the travel");
        let help = format!("write {} {unit} or more: a form so fine is noise to all figures", significant(least, 4));
        context.at_key(codes::E0213, &keys(["covariance"]), message, help);
    }
}

fn above_zero(context: &mut Context, value: f64, at: &Keys) -> bool {
    if value <= 0.0 {
        context.at_value(codes::E0213, at, format!("`{}` is not above zero", dotted_path(at)), "write a size");
    }
    value > 0.0
}
