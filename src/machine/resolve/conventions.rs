//! Conventions: the defaults or a preset, then the single keys.

use super::context::Context;
use crate::diagnostic::{codes, did_you_mean, shown};
use crate::machine::Conventions;
use crate::syntax::{Keys, below, keys};

/// Returns the conventions in force.
pub fn conventions(context: &mut Context) -> Conventions {
    let document = context.document;
    let Some(entry) = &document.conventions else { return Conventions::default() };
    let at = keys(["conventions"]);
    let mut chosen = match &entry.preset {
        Some(name) => preset(context, name, &at),
        None => Conventions::default(),
    };
    /// Overwrites one field of `chosen` if the file says so.
    macro_rules! amend {
        ($($field:ident: [$($word:literal),*]),*) => {$(
            if let Some(word) = &entry.$field {
                if let Some(choice) = context.choice(word, &below(&at, stringify!($field)), &[$($word),*]) {
                    chosen.$field = choice;
                }
            }
        )*};
    }
    amend!(
        location: ["axis_only", "carried_body"],
        linear: ["after", "before"],
        rotary: ["stationary", "rotating"],
        workpiece_axes: ["iso841", "direct"],
        errors_are: ["tool_relative", "body"],
        location_order: ["nilpotent", "real"],
        joints: ["orthogonal", "linearised"]
    );
    chosen
}

fn preset(context: &mut Context, name: &str, at: &Keys) -> Conventions {
    Conventions::preset(name).unwrap_or_else(|| {
        let help = did_you_mean(name, &Conventions::PRESETS);
        context.at_value(codes::E0210, &below(at, "preset"), format!("there is no preset `{}`", shown(name)), help);
        Conventions::default()
    })
}
