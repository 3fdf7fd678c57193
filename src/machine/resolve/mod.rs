//! From the document to a valid machine. Every pass reports all it finds and goes on; the machine
//! is made only if none has refused anything.

mod axes;
mod beyond;
mod chain;
mod circles;
mod context;
mod conventions;
mod covariance;
mod curve_of;
mod curves;
mod doubles;
mod errors;
mod found_errors;
mod joint_names;
mod look;
mod names;
mod parts;
mod positions;
mod quantities;
mod questions;
mod short;
mod side_errors;
mod sides;
mod tolerances;
mod uses;
mod volume;

pub use errors::{largest, largest_stated, plausible_size};
pub use look::look;
pub use names::{error_name_in_capitals, parse_error_name};
pub use questions::questions;
pub use sides::{CLASS_ANGLES, no_origin};
pub use uses::FITTED_GROUPS;

use super::{Axis, Branch, Conventions, Geometry, KinematicChain, Machine, MachineParts, Origins};
use crate::diagnostic::{Diagnostics, codes};
use crate::syntax::{Document, Files, keys};
use axes::AxisDraft;
use context::Context;
use covariance::Covariance;
use found_errors::Errors;
use joint_names::JointNames;

/// Resolves a document; tables are read through `files`. `None` if anything at all was refused,
/// by this stage or before.
pub fn resolve(document: &Document, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Machine> {
    let context = &mut Context::new(document, files, diagnostics);
    let machine = parts(context).map(Machine::new);
    if let Some(machine) = &machine {
        tolerances::squareness(context, machine);
        sides::warn(context, machine);
        chain::warn_parallel(context, machine);
        chain::warn_many_linear(context, machine);
        parts::warn_direction(context, machine);
    }
    machine.filter(|_| !diagnostics.is_refused())
}

fn parts(context: &mut Context) -> Option<MachineParts> {
    parts::version(context);
    let name = parts::name(context);
    let conventions = conventions::conventions(context);
    axes::refuse_many(context)?;
    let declared = axes::axes(context);
    let chain = chain::chain(context);
    let walk = chain.as_ref().map(|chain| sides::sides(&chain.walk())).unwrap_or_default();
    let side = |axis: &AxisDraft| walk.get(&axis.name).copied().unwrap_or(Branch::Workpiece);
    let declared: Vec<AxisDraft> = declared.iter().map(|axis| axis.standing_on(side(axis))).collect();
    let tools = parts::tools(context);
    let workpiece = parts::workpiece(context);
    let workpiece_rotation = parts::workpiece_rotation(context);
    circles::circles(context, &declared, workpiece.as_ref());
    let setup = parts::setup(context);
    let provenance = parts::provenance(context);
    let known = JointNames { declared: &declared, spindle: chain.as_ref().and_then(|c| c.spindle()) };
    let mut errors = side_errors::errors(context, &known, &walk);
    let tolerances = tolerances::frames(context, &known, &errors);
    let class = tolerances::class(context);
    let Covariance { joint: covariance, forms, unheld, mut measured } = covariance::covariance(context, &known);
    short::report(context, &mut measured);
    let algebra = uses::algebra(context, &known);
    uses::identify(context, &known);
    let tool = tools.as_ref().and_then(|tools| tools.first());
    let geometry = tool.map(|tool| sides::geometry(context, &declared, &mut errors, tool, workpiece.as_ref()));
    let placed = chain.as_ref().zip(geometry.as_ref());
    let origins = geometry.as_ref().map(|geometry| geometry.origins(&walk));
    let axes = placed
        .zip(origins.as_ref())
        .and_then(|((chain, geometry), origins)| in_chain(chain, geometry, origins, &declared, &conventions));
    let volume = axes.as_ref().and_then(|axes| volume::volume(context, axes, &declared));
    covariance::refuse_fine_forms(context, &forms, axes.as_deref().unwrap_or_default());
    let chain = chain?;
    left_out(context, &declared, &chain, &errors);
    let geometry = geometry?;
    let parts = MachineParts {
        name: name?,
        axes: axes?,
        errors: errors.in_order(&chain),
        tools: tools?,
        workpiece: origins?.workpiece(),
        workpiece_rotation,
        conventions,
        setup,
        volume: volume?,
        provenance,
        uncertainty: std::mem::take(&mut errors.uncertainty),
        covariance,
        forms,
        unheld,
        measured,
        algebra,
        tolerances,
        class,
        geometry,
        chain,
    };
    doubles::warn(context, &parts, &errors);
    sides::warn_carried(context, &parts, &errors);
    Some(parts)
}

/// Axes that are declared but not in the chain: variants drop axes, so this is no mistake.
fn left_out(context: &mut Context, declared: &[AxisDraft], chain: &KinematicChain, errors: &Errors) {
    if context.document.places.is_marred(&keys(["branches"])) {
        return;
    }
    let walk = chain.walk();
    for axis in declared.iter().filter(|d| !walk.iter().any(|(name, _)| **name == d.name)) {
        let message = match errors.places.keys().filter(|e| e.axis == axis.name).count() {
            0 => format!("axis `{}` is declared but not in the chain", axis.name),
            1 => format!("axis `{}` is declared but not in the chain; its error is left out", axis.name),
            n => format!("axis `{}` is declared but not in the chain; its {n} errors are left out", axis.name),
        };
        let at = keys(["axes", axis.name.as_str()]);
        context.at_key(
            codes::W0401,
            &at,
            message,
            format!("add it to the chain, or remove it: `{}: null` in a variant", axis.name),
        );
    }
}

/// Returns the chain's axes on the walk, if all of them could be understood.
fn in_chain(
    chain: &KinematicChain,
    geometry: &Geometry,
    origins: &Origins,
    declared: &[AxisDraft],
    conventions: &Conventions,
) -> Option<Vec<Axis>> {
    let walk = chain.walk().into_iter().map(|(name, branch)| {
        let draft = declared.iter().find(|d| d.name == *name)?;
        let side = geometry.axes.get(name)?.on(branch);
        Some(Axis {
            name: name.clone(),
            kind: draft.kind?,
            direction: side.direction,
            origin: origins.axis(name),
            travel: side.travel,
            branch,
            sense: draft.sense.unwrap_or(conventions.workpiece_axes),
            controller: draft.controller,
            home: draft.home,
        })
    });
    walk.collect()
}
