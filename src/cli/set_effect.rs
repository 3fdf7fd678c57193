//! What the files that `compile` would write do to a machine, for verbs that map it.

use super::Exit;
use super::how::CompensationArgs;
use super::output::session::Session;
use crate::api::compensation::effect::compiled_effect;
use crate::api::run::Call;
use crate::controller::{Certificate, ControllerTarget, Depth, Effect};
use crate::machine::Machine;

/// Returns a target, what its files do to a machine, and their certificate; nothing is written.
pub(super) fn compiled(
    session: &mut Session,
    machine: &Machine,
    name: &str,
    how: &CompensationArgs,
    depth: Depth,
) -> Result<(ControllerTarget, Effect, Certificate), Exit> {
    let options = how.options();
    let answer = Call::answer(session.run(), &session.diagnostics.sources, |call| {
        let target = options.target(call, name, None)?;
        let (effect, certificate) = compiled_effect(call, machine, &target, &options, depth)?;
        Ok((target, effect, certificate))
    });
    session.take(answer)
}
