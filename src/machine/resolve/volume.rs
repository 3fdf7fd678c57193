//! Intervals and steps of maps and tables.

use super::axes::AxisDraft;
use super::context::Context;
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::machine::{Axis, AxisKind, Grid, Travel};
use crate::syntax::{Keys, Scalar, VolumeAxis, below, keys};
use crate::units::{self, Dimension};

const NODES: f64 = 1e6;

struct Steps {
    linear: f64,
    rotary: f64,
}

/// Returns a grid for every axis, in their order.
pub fn volume(context: &mut Context, axes: &[Axis], declared: &[AxisDraft]) -> Option<Vec<Grid>> {
    let document = context.document;
    let steps = global(context);
    let names: Vec<&str> = declared.iter().map(|d| d.name.as_str()).chain(["step"]).collect();
    for name in document.volume.keys().filter(|n| !names.contains(&n.as_str())) {
        let help = did_you_mean(name, &names);
        let message = format!("`volume` names the axis `{}`, which is not declared", shown(name));
        context.at_key(codes::E0214, &keys(["volume", name]), message, help);
    }
    let travel = |axis: &Axis| declared.iter().find(|d| d.name == axis.name).map(AxisDraft::travel_entry);
    let grids: Vec<Option<Grid>> =
        axes.iter().map(|axis| grid(context, axis, &travel(axis).unwrap_or_default(), &steps)).collect();
    grids.into_iter().collect()
}

/// `step: 25 mm` is for the linear axes, `step: 15 deg` for the rotary ones.
fn global(context: &mut Context) -> Steps {
    let mut steps = Steps { linear: AxisKind::Linear.default_step(), rotary: AxisKind::Rotary.default_step() };
    if let Some(VolumeAxis::Step(scalar)) = context.document.volume.get("step") {
        let at = keys(["volume", "step"]);
        let is_angle = |text: &str| units::quantity(text).is_ok_and(|q| q.dimension == Dimension::ANGLE);
        let angle = matches!(scalar, Scalar::Text(text) if is_angle(text));
        let kind = if angle { AxisKind::Rotary } else { AxisKind::Linear };
        let step = step(context, scalar, kind, &at);
        let slot = if angle { &mut steps.rotary } else { &mut steps.linear };
        *slot = step.unwrap_or(*slot);
    }
    steps
}

fn step(context: &mut Context, scalar: &Scalar, kind: AxisKind, at: &Keys) -> Option<f64> {
    let step = context.position(scalar, kind, at)?;
    if step <= 0.0 {
        context.at_value(codes::E0214, at, format!("a step of {step} {}", kind.unit()), "a step is above zero");
        return None;
    }
    Some(step)
}

fn grid(context: &mut Context, axis: &Axis, travel: &Keys, steps: &Steps) -> Option<Grid> {
    let document = context.document;
    let at = keys(["volume", axis.name.as_str()]);
    let (range, own) = match document.volume.get(axis.name.as_str()) {
        Some(VolumeAxis::Axis { range, step }) => (range.as_ref(), step.as_ref()),
        _ => (None, None),
    };
    let long = below(&at, "range");
    let range_at = if document.places.has(&long) { long } else { at.clone() };
    let interval = match range {
        Some(list) => {
            let asked = context.interval(list, axis.kind, &range_at);
            asked.filter(|(min, max)| is_within(context, axis, travel, [*min, *max], &range_at))
        }
        None => Some(axis.travel.interval()),
    };
    let default = if axis.kind == AxisKind::Linear { steps.linear } else { steps.rotary };
    let step = match own {
        Some(scalar) => step(context, scalar, axis.kind, &below(&at, "step")),
        None => Some(default),
    };
    let ((min, max), step) = (interval?, step?);
    if (max - min) / step > NODES {
        let message = format!("a step of {step} {} makes more than a million nodes", axis.unit());
        context.at_value(codes::E0214, &at, message, "take a larger step");
        return None;
    }
    Some(Grid { min, max, step })
}

/// Refuses a range (mm, deg) beyond the travel, where no error is known; true if it is within.
fn is_within(context: &mut Context, axis: &Axis, travel: &Keys, range: [f64; 2], at: &Keys) -> bool {
    let Travel::Range(min, max) = axis.travel else { return true };
    if range.iter().all(|end| axis.travel.contains(*end)) {
        return true;
    }
    let message =
        format!("the volume of axis `{}` goes beyond its travel from {min} to {max} {}", axis.name, axis.unit());
    let places = &context.document.places;
    let travel = places.value(travel);
    let refusal = Diagnostic::new(codes::E0214, message).at(places.value(at), "").at(travel, "the travel");
    context.diagnostics.push(refusal.help("keep the volume within the travel"));
    false
}
