//! The joint covariance of errors: independent parts, each written like the errors themselves.

use super::context::{Context, dotted_path};
use super::errors::{once, term};
use super::found_errors::Errors;
use super::joint_names::{JointNames, find_error};
use super::parts::setup_at;
use crate::diagnostic::{codes, did_you_mean, shown};
use crate::machine::{Axis, Direction, JointUncertainty, ResidualForm};
use crate::syntax::{CovarianceEntry, FormEntry, Keys, Scalar, below, keys};
use crate::units::significant;

/// Reads the section `covariance`.
pub fn covariance(context: &mut Context, known: &JointNames<'_>) -> (Vec<JointUncertainty>, Vec<ResidualForm>) {
    let document = context.document;
    let section = keys(["covariance"]);
    let (count, most) = (document.covariance.len(), JointUncertainty::MOST);
    if count > most {
        let message = format!("`covariance` has {count} parts; {most} are read at most");
        context.at_key(codes::E0202, &section, message, "leave out the parts that change no printed digit");
        return (Vec::new(), Vec::new());
    }
    let (mut joint, mut forms) = (Vec::new(), Vec::<ResidualForm>::new());
    for (i, entry) in document.covariance.iter().enumerate() {
        let Some(written) = &entry.form else {
            joint.push(part(context, known, i, entry));
            continue;
        };
        let at = below(&below(&section, i), "form");
        let alone = entry.errors.is_empty() && entry.setup.is_none();
        if !alone {
            let message = format!("`{}` stands beside `errors` or `setup`", dotted_path(&at));
            context.at_key(codes::E0209, &at, message, "write it as an entry of its own");
        }
        let Some(form) = form(context, known, written, &at) else { continue };
        if forms.iter().any(|other| other.axis == form.axis) {
            let message = format!("`covariance` has two forms of `{}`", form.axis);
            context.at_key(codes::E0209, &at, message, "one form is that of all its directions");
        }
        forms.push(form);
    }
    (joint, forms)
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
    let declared = known.declared.iter().find(|declared| declared.name.as_str() == axis.as_str());
    let Some(declared) = declared else {
        let names: Vec<&str> = known.declared.iter().map(|declared| declared.name.as_str()).collect();
        let message = format!("`{}` is not an axis of the machine", shown(axis));
        context.at_value(codes::E0406, &below(here, "axis"), message, did_you_mean(axis, &names));
        return None;
    };
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
