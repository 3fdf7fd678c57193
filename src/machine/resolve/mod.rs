//! What the file says to a valid machine. Every pass reports all it finds and goes on; the machine
//! is made only if none has refused anything.

mod axes;
mod chain;
mod context;
mod conventions;
mod curves;
mod errors;
mod names;
mod parts;
mod quantities;
mod volume;

pub use names::parse_error_name;

use super::{Axis, Conventions, KinematicChain, Machine, MachineParts};
use crate::diagnostic::Diagnostics;
use crate::syntax::{Document, Files};
use axes::Declared;
use context::Context;

/// Resolves a document; tables are read through `files`. `None` if anything at all was refused,
/// by this stage or before.
pub fn resolve(document: &Document, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Machine> {
    let machine = parts(&mut Context::new(document, files, diagnostics)).map(Machine::new);
    machine.filter(|_| !diagnostics.refused())
}

fn parts(context: &mut Context<'_>) -> Option<MachineParts> {
    parts::version(context);
    let name = parts::name(context);
    let conventions = conventions::conventions(context);
    let declared = axes::axes(context);
    let chain = chain::chain(context);
    let axes = chain.as_ref().and_then(|chain| in_chain(chain, &declared, &conventions));
    let tools = parts::tools(context);
    let workpiece = parts::workpiece(context);
    let setup = parts::setup(context);
    let provenance = parts::provenance(context);
    let errors = errors::errors(context, &declared, chain.as_ref().and_then(|c| c.spindle()));
    let volume = axes.as_ref().and_then(|axes| volume::volume(context, axes, &declared));
    let chain = chain?;
    Some(MachineParts {
        name: name?,
        axes: axes?,
        errors: errors::in_order(errors, &chain),
        tools: tools?,
        workpiece: workpiece?,
        conventions,
        setup,
        volume: volume?,
        provenance,
        chain,
    })
}

/// The chain's axes on the walk, if all of them could be understood.
fn in_chain(chain: &KinematicChain, declared: &[Declared], conventions: &Conventions) -> Option<Vec<Axis>> {
    let walk = chain.walk().into_iter().map(|(name, branch)| {
        let d = declared.iter().find(|d| d.name == *name)?;
        Some(Axis {
            name: name.clone(),
            kind: d.kind?,
            direction: d.direction?,
            origin: d.origin?,
            travel: d.travel?,
            branch,
            sense: d.sense.unwrap_or(conventions.workpiece_axes),
        })
    });
    walk.collect()
}
