//! Warnings of a certificate.

use crate::controller::{Certificate, Figures, ROUNDING_UM, RaisedFigure, raised_figures};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::Summary;
use crate::machine::Approach;
use crate::run::finite;
use crate::units::significant;

/// Returns in words which figures of the position deviation the files raise; `None` if they raise none.
pub(crate) fn raise_remark(figures: &[RaisedFigure]) -> Option<String> {
    let travel = |approach| match approach {
        Approach::Mean => "",
        Approach::Forward => " forward",
        Approach::Reverse => " in reverse",
    };
    let one = |r: &RaisedFigure| {
        format!(
            "{}{} to {} um from {}",
            r.figure,
            travel(r.approach),
            significant(r.after_um, 4),
            significant(r.before_um, 4)
        )
    };
    let all: Vec<String> = figures.iter().map(one).collect();
    (!all.is_empty()).then(|| format!("the position deviation: {}", all.join(", ")))
}

/// Returns the warnings to be read before anybody loads such files.
pub(crate) fn warnings(certificate: &Certificate) -> Vec<Diagnostic> {
    let (before, after) = (&certificate.uncompensated, &certificate.compensated);
    let mut found: Vec<Diagnostic> = finite::refusal(&[before, after]).into_iter().collect();
    let lessened = |b: &Summary, a: &Summary| a.rms < 0.999 * b.rms || a.p95 < 0.999 * b.p95;
    let lessens =
        lessened(&before.position_um, &after.position_um) || lessened(&before.tool_axis_urad, &after.tool_axis_urad);
    if certificate.strongest.is_none() && !lessens {
        let help = match before.position_um.max == 0.0 && before.rotation_urad.max == 0.0 {
            true => {
                "no error of the machine has a value: loaded, these zeros take away what is in force. Give values, \
                 measured or by `abbe identify`; bounds are no values"
            }
            false => {
                "no error of this machine is within the target's reach, or the files hold nothing: a target with a \
                 lattice, such as grid-csv, corrects errors that depend on several axes"
            }
        };
        found.push(Diagnostic::new(codes::W0602, "the tables correct nothing").help(help));
    } else if let Some(words) = raise_remark(&certificate.raised) {
        found.push(Diagnostic::new(codes::W0602, format!("the tables raise {words}")).help(why_raised(certificate)));
    }
    // An increase by a twentieth is within the local changes of any table of angles.
    let turned = |b: &Summary, a: &Summary| a.p95 > b.p95 * 1.05 + ROUNDING_UM;
    if turned(&before.tool_axis_urad, &after.tool_axis_urad) || turned(&before.rotation_urad, &after.rotation_urad) {
        let message = format!(
            "the orientation gets worse: 95 % {} urad instead of {} (tool axis {} instead of {})",
            significant(after.rotation_urad.p95, 4),
            significant(before.rotation_urad.p95, 4),
            significant(after.tool_axis_urad.p95, 4),
            significant(before.tool_axis_urad.p95, 4)
        );
        found.push(Diagnostic::new(codes::W0603, message).help(
            "rotation about the tool axis matters to tools that \
         do not turn; `--correct position` does not move the rotary axes",
        ));
    }
    found
}

/// Returns the warning of tables that leave more than the kinematic parameters before them: W0602.
pub(crate) fn worse_together(parameters: &Figures, both: &Figures) -> Option<Diagnostic> {
    let words = raise_remark(&raised_figures(Approach::Mean, parameters, both))?;
    let help = "load the parameters alone; what they leave is of several axes, or the tables hold the mean of two \
                directions: a lattice, or no tables";
    Some(Diagnostic::new(codes::W0602, format!("beside the parameters the tables raise {words}")).help(help))
}

/// Returns the reason why tables can make it worse, and the remedy.
fn why_raised(certificate: &Certificate) -> &'static str {
    match &certificate.shifted {
        Some(shifted) if shifted.is_better() => {
            "the tables vanish at the reference position and leave a constant: move the machine zero as the \
             certificate says, or do not load them"
        }
        _ => {
            "they take away an error that cancelled another one, which this target cannot correct, or hold the mean of \
             two directions, or lack points of installed tables (W0704): do not load them for volumetric accuracy"
        }
    }
}
