//! The check of poses for verbs that compute on their own.

use super::Exit;
use super::output::session::Session;
use crate::machine::{Machine, Pose};

/// Refuses poses where an error curve is not defined; warns about those beyond the travel.
pub(super) fn check(session: &mut Session, machine: &Machine, poses: &[Pose]) -> Result<(), Exit> {
    session.within(|call| crate::api::poses::check(call, machine, poses))
}
