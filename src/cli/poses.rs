//! The checks of poses for verbs that compute on their own.

use super::Exit;
use super::output::session::Session;
use crate::machine::{Machine, Pose};

pub(super) fn pose_at(machine: &Machine, text: &str) -> Result<Pose, String> {
    crate::api::poses::pose_at(machine, text).map_err(|refusal| refusal.message)
}

pub(super) fn check(session: &mut Session, machine: &Machine, poses: &[Pose]) -> Result<(), Exit> {
    session.within(|call| crate::api::poses::check(call, machine, poses))
}
