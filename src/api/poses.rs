//! Checks of poses.

use super::run::{Call, Refused};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{Machine, Pose};

/// Largest magnitude of a position, mm or deg.
const FARTHEST: f64 = 1e6;

/// Refuses poses where an error curve is not defined; warns about those beyond the travel.
pub(crate) fn check(call: &mut Call<'_>, machine: &Machine, poses: &[Pose]) -> Result<(), Refused> {
    for pose in poses {
        known(machine, pose).or_else(|refusal| call.refuse(refusal))?;
    }
    let mut beyond: Vec<&str> =
        poses.iter().flat_map(|pose| machine.beyond_travel(pose)).map(|axis| axis.name.as_str()).collect();
    beyond.sort_unstable();
    beyond.dedup();
    for name in beyond {
        call.warn(Diagnostic::new(codes::W0801, format!("poses beyond the travel of `{name}` were evaluated")));
    }
    call.checked()
}

/// Refuses a pose where an error curve is not defined.
pub(crate) fn known(machine: &Machine, pose: &[f64]) -> Result<(), Diagnostic> {
    if pose.iter().any(|q| q.is_nan() || q.abs() > FARTHEST) {
        let message = "a position is beyond 1000000 mm or deg: no machine goes there";
        return Err(Diagnostic::new(codes::E0802, message).help("positions are in mm and deg"));
    }
    let Some(outside) = machine.outside(pose) else { return Ok(()) };
    let message = format!("{} is not known at {} = {}", outside.error, outside.error.axis, outside.position);
    let (from, to) = outside.domain;
    let help = format!("its table covers {from} to {to}; a table is never extrapolated");
    Err(Diagnostic::new(codes::E0803, message).help(help))
}
