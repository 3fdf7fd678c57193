//! Sets of tables: filled, rendered and read back, or found in a folder.

use super::detect::{self, Set};
use super::how::Options;
use super::output::session::Session;
use super::store::file_set;
use super::{Exit, Outcome};
use crate::compensation::{CorrectionTables, Fit, LatticeRequest, Scope, resampled};
use crate::controller::{ControllerTarget, Limits, ReadBack, RenderedFile};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{AxisKind, Machine};
use std::path::Path;
use std::sync::Arc;

/// A set of files before it is written, and the tables that the controller reads from it.
pub(super) struct RenderedTables {
    pub rendered: Vec<RenderedFile>,
    pub tables: CorrectionTables,
}

/// Fills the tables of a target, renders its files and reads them back as `verify` would. A lattice is
/// given by the names of its axes (none: all) and the largest number of its nodes; what is filled goes on top
/// of what is installed.
pub(super) fn made(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    (lattice, max_nodes): (&[String], usize),
    scope: Scope,
    limits: Limits,
    installed: Option<&CorrectionTables>,
) -> Result<RenderedTables, Exit> {
    if let Some(refusal) = target.refusal(machine) {
        return session.refuse(refusal);
    }
    let axes = lattice_axes(session, machine, lattice)?;
    let request = LatticeRequest { axes, max_nodes, scope };
    refuse_impossible_lattice(session, machine, target, &request)?;
    let tables = Arc::new(match installed {
        Some(installed) => target.tables_over(machine, &request, installed),
        None => target.tables(machine, &request),
    });
    warn_left_out(session, machine, target, &tables);
    let losses = installed.map(|old| target.resampling_losses(machine, &tables, old)).unwrap_or_default();
    losses.into_iter().for_each(|warning| session.diagnostics.push(warning));
    limits.exceeded(machine, &tables).into_iter().for_each(|refusal| session.diagnostics.push(refusal));
    target.violations(machine, &tables).into_iter().for_each(|refusal| session.diagnostics.push(refusal));
    session.checked()?;
    let rendered = target.render(machine, &tables, &mut session.diagnostics).ok_or(Exit::Refused)?;
    session.checked()?;
    let tables = read_back(session, machine, target, &rendered, &tables)?;
    Ok(RenderedTables { rendered, tables })
}

/// Indices of the axes that span a lattice: those named, in the order of the chain, or all.
fn lattice_axes(session: &Session, machine: &Machine, named: &[String]) -> Result<Vec<usize>, Exit> {
    let all = 0..machine.axes().len();
    if let Some(unknown) = named.iter().find(|name| machine.axis_index(name).is_none()) {
        return session.usage(&format!("--lattice: the chain has no axis `{}`", unknown.escape_debug()));
    }
    if let Some((_, twice)) = named.iter().enumerate().find(|(i, name)| named[..*i].contains(name)) {
        return session.usage(&format!("--lattice: `{}` is there twice", twice.escape_debug()));
    }
    let wanted = |axis: &usize| named.is_empty() || named.iter().any(|name| machine.axis_index(name) == Some(*axis));
    Ok(all.filter(wanted).collect())
}

/// A lattice has two nodes on every axis at the least, and something to correct.
fn refuse_impossible_lattice(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    request: &LatticeRequest,
) -> Outcome {
    let free = target.manifest.mechanism.lattice.as_ref().filter(|rules| rules.inputs.is_empty());
    let Some(rules) = free else { return Ok(()) };
    let most = request.max_nodes.min(rules.max_points);
    let least = 2_usize.checked_pow(u32::try_from(request.axes.len()).unwrap_or(u32::MAX)).unwrap_or(usize::MAX);
    if least > most {
        let message = format!("a lattice over {} axes has more than {most} nodes at the least", request.axes.len());
        let help = "span it over fewer axes with --lattice X,Y,Z, or allow more with --nodes";
        return session.refuse(Diagnostic::new(codes::E0603, message).help(help));
    }
    let linear = machine.axes().iter().any(|axis| axis.kind == AxisKind::Linear);
    let able = linear || (request.scope.rotary && rules.corrects_rotary);
    if !able {
        let message = "the machine has no linear axis to correct the position with";
        let help = "let the rotary axes correct: --with all, or --correct pose";
        return session.refuse(Diagnostic::new(codes::E0603, message).help(help));
    }
    Ok(())
}

/// What does not go into the tables: points beyond the format's limit, travel beyond the volume.
fn warn_left_out(session: &mut Session, machine: &Machine, target: &ControllerTarget, tables: &CorrectionTables) {
    if let Some(rules) = target.manifest.mechanism.own_axis.as_ref().filter(|rules| rules.fit == Fit::Axis) {
        for (axis, points) in resampled(machine, rules) {
            let (name, most) = (&machine.axes()[axis].name, rules.max_points);
            let message =
                format!("the curves of `{name}` have {points} points, the format holds {most}: they were resampled");
            let help = "thin the curve out yourself if certain points matter";
            session.diagnostics.push(Diagnostic::new(codes::W0604, message).help(help));
        }
    }
    let free = target.manifest.mechanism.lattice.as_ref().is_some_and(|rules| rules.inputs.is_empty());
    let Some(lattice) = tables.tables.first().filter(|_| free) else { return };
    for axis in &lattice.axes {
        let (this, grid) = (&machine.axes()[*axis], machine.volume()[*axis]);
        let (min, max) = this.travel.interval();
        let within = grid.max - grid.min < (max - min) * (1.0 - 1e-9);
        if within {
            let message = format!(
                "the lattice covers `{}` from {} to {} {}, its travel is larger: outside the value at the end is held",
                this.name,
                grid.min,
                grid.max,
                this.unit()
            );
            let help = "leave the bounds out of `volume:` to cover the whole travel";
            session.diagnostics.push(Diagnostic::new(codes::W0605, message).help(help));
        }
    }
}

/// Reads the rendered bytes back as `verify` would, and insists that they are the tables we meant.
fn read_back(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    files: &[RenderedFile],
    meant: &CorrectionTables,
) -> Result<CorrectionTables, Exit> {
    let text = |file: &RenderedFile| ReadBack::new(&*file.name, String::from_utf8_lossy(&file.bytes));
    let wanted = [target.table_files(machine), target.index_files()].concat();
    let texts: Vec<_> = files.iter().filter(|file| wanted.contains(&file.name)).map(text).collect();
    let read = target.read(machine, &texts, &mut session.diagnostics);
    session.checked()?;
    // Nothing to compensate may mean no files of tables.
    let tables = target.table_files(machine);
    let none = !files.iter().any(|file| tables.contains(&file.name));
    match read.or_else(|| none.then(CorrectionTables::default)) {
        Some(read) if read.same_effect(meant) => Ok(read),
        _ => session.refuse(file_set::misread(target)),
    }
}

/// A set found in a folder.
pub(super) struct FoundTables {
    pub target: ControllerTarget,
    pub tables: CorrectionTables,
    pub files: Vec<String>,
}

/// The tables in a folder, of whatever target they are.
pub(super) fn found(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    options: &Options,
) -> Result<FoundTables, Exit> {
    let set = detect::any_set(session, machine, folder, &options.how)?;
    tables_of(session, machine, folder, set)
}

/// The tables of a set.
pub(super) fn tables_of(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    set: Set,
) -> Result<FoundTables, Exit> {
    let Set { target, files } = set;
    if target.manifest.kinematics().is_some() {
        let message = format!("`{}` holds a kinematics module, which has no tables", folder.display());
        let help = "a module is written anew from the machine file, not on top of another one";
        return session.refuse(Diagnostic::new(codes::E0711, message).help(help));
    }
    let read = target.read(machine, &files, &mut session.diagnostics);
    session.checked()?;
    let read = read.or_else(|| files.is_empty().then(CorrectionTables::default));
    let indices = target.index_files();
    let names = files.into_iter().filter(|file| !indices.contains(&file.name)).map(|file| file.found).collect();
    match read {
        Some(tables) => {
            target.uncovered(machine, &tables).into_iter().for_each(|warning| session.diagnostics.push(warning));
            Ok(FoundTables { target, tables, files: names })
        }
        None => session.refuse(detect::nothing_found(folder)),
    }
}

/// The tables that were in force when the machine was measured.
pub(super) fn installed(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    options: &Options,
    folder: Option<&Path>,
) -> Result<Option<CorrectionTables>, Exit> {
    let Some(folder) = folder else { return Ok(None) };
    let set = found(session, machine, folder, options)?;
    session.checked()?;
    if set.target.manifest.target == target.manifest.target {
        return Ok(Some(set.tables));
    }
    let (old, new) = (&set.target.manifest.target, &target.manifest.target);
    let message = format!("the files in `{}` are of target `{old}`, not of `{new}`", folder.display());
    let help = "only tables of the same target can be written on top of each other";
    session.refuse(Diagnostic::new(codes::E0711, message).help(help))
}
