//! The names of errors that a file may use: those of its axes and its spindle.

use super::axes::AxisDraft;
use super::context::Context;
use super::names::{Spelling, error_name_in_capitals, readings};
use crate::diagnostic::{Diagnostic, Place, codes, did_you_mean, shown};
use crate::machine::AxisName;
use crate::syntax::{Keys, keys};

/// The axes and the spindle whose errors may be named.
pub struct JointNames<'a> {
    pub declared: &'a [AxisDraft],
    pub spindle: Option<&'a AxisName>,
}

impl<'a> JointNames<'a> {
    /// The axis of this name, if it is declared.
    pub fn axis(&self, name: &AxisName) -> Option<&AxisDraft> {
        self.declared.iter().find(|d| d.name == *name)
    }

    pub(super) fn names(&self) -> Vec<&'a str> {
        self.declared.iter().map(|d| &d.name).chain(self.spindle).map(AxisName::as_str).collect()
    }

    pub(super) fn error(&self, context: &mut Context, name: &str, at: &Keys) {
        let place = context.document.places.value(at);
        let _ = find_error(context, name, self, place);
    }
}

/// The error that a name means, if its axis (or spindle) is there.
pub fn find_error(context: &mut Context, name: &str, known: &JointNames<'_>, place: Option<Place>) -> Option<Spelling> {
    let readings = readings(name);
    let there = |axis: &AxisName| known.axis(axis).is_some() || known.spindle == Some(axis);
    if let Some(reading) = readings.iter().find(|r| there(&r.error.axis)) {
        return Some(reading.clone());
    }
    let spindle = known.spindle.map(AxisName::as_str);
    let axes: Vec<&str> = known.declared.iter().map(|d| d.name.as_str()).chain(spindle).collect();
    let refusal = match readings.first() {
        Some(reading) => {
            let axis = &reading.error.axis;
            if known.spindle != Some(axis) && context.document.places.is_lost(&keys(["axes"])) {
                return None;
            }
            let help = format!("declare the axis, or correct the name; {}", did_you_mean(axis.as_str(), &axes));
            Diagnostic::new(
                codes::E0406,
                format!("`{}` is an error of axis `{axis}`, which is not declared", shown(name)),
            )
            .help(help)
        }
        None => {
            let nearly = error_name_in_capitals(name).map(|near| format!("did you mean `{near}`?"));
            let help = match name.trim() {
                "X-Y" | "Y-X" => "as an error it is `EC0Y`, with its sign; `X-Y` is a bound, under `tolerances`",
                "X-Z" | "Z-X" => "as an error it is `EB0Z`, with its sign; `X-Z` is a bound, under `tolerances`",
                "Y-Z" | "Z-Y" => "as an error it is `EA0Z`, with its sign; `Y-Z` is a bound, under `tolerances`",
                "XY" | "XZ" | "YZ" => "a squareness has a dash, `X-Y`, and is a bound, under `tolerances`",
                _ => "E, direction (X Y Z A B C), axis: `EXX`; location errors with a zero: `EC0Y`",
            };
            let help = nearly.as_deref().unwrap_or(help);
            Diagnostic::new(codes::E0405, format!("`{}` is not the name of an error", shown(name))).help(help)
        }
    };
    context.diagnostics.push(refusal.at(place, ""));
    None
}
