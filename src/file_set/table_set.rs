//! Sets of tables: filled, rendered and read back, or found in a folder.

use super::folder::Folder;
use super::found_set::{self, FoundSet};
use super::misread;
use super::options::CompensationOptions;
use crate::compensation::{CorrectionTables, Fit, LatticeRequest, Scope, thinned_axes};
use crate::controller::{ControllerTarget, Limits, ReadBack, RenderedFile, axis_letters};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::machine::{AxisKind, Machine};
use crate::run::finite::not_finite;
use crate::run::{Call, Refused};
use crate::units::significant;
use std::path::Path;
use std::sync::Arc;

/// A set of files before it is written, and the tables that the controller reads from it.
pub(crate) struct RenderedTables {
    pub rendered: Vec<RenderedFile>,
    pub tables: CorrectionTables,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct TableRequest<'a> {
    /// Names of the axes that span a lattice; all if empty.
    pub lattice: &'a [String],
    /// Maximum number of lattice nodes.
    pub max_nodes: usize,
    pub scope: Scope,
    pub limits: Limits,
}

impl TableRequest<'_> {
    /// Everything by default, for a scope; nobody is to load the tables.
    pub fn plain(scope: Scope) -> Self {
        Self { lattice: &[], max_nodes: usize::MAX, scope, limits: Limits::LARGEST }
    }
}

/// Fills the tables of a target on top of those installed, renders its files and reads them back as `verify` would.
/// With installed tables goes the target with all of its mechanisms: they may be of a kind that no new table is to be
/// of.
pub(crate) fn render(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    request: &TableRequest,
    installed: Option<(&CorrectionTables, &ControllerTarget)>,
) -> Result<RenderedTables, Refused> {
    if let Some(refusal) = target.refusal(machine) {
        return call.refuse(refusal);
    }
    refuse_no_letter(call, machine, target)?;
    found_set::refuse_assumed_axes(call, machine, target)?;
    refuse_short_travel(call, machine, target)?;
    let scales = target.manifest.mechanism.own_axis.iter().flat_map(|own| &own.in_force);
    let strange = |(name, _): &&(String, f64)| {
        machine.axis_index(name).is_none_or(|axis| machine.axes()[axis].kind == AxisKind::Rotary)
    };
    if let Some((name, _)) = scales.clone().find(strange) {
        return call.usage(format!("--scale: the chain has no linear axis `{name}`"));
    }
    // What the control's own settings say is right.
    if installed.is_none() {
        warn_unusual_scales(call, target);
    }
    let TableRequest { scope, limits, .. } = *request;
    let axes = lattice_axes(call, machine, request.lattice)?;
    let request = LatticeRequest { axes, max_nodes: request.max_nodes, scope };
    refuse_impossible_lattice(call, machine, target, &request)?;
    let (planner, target) = (target, installed.map_or(target, |(_, target)| target));
    let (tables, left_out) = match installed {
        Some((installed, target)) => target.tables_over(planner, machine, &request, installed),
        None => (target.tables(machine, &request), Vec::new()),
    };
    let tables = Arc::new(tables);
    call.extend(left_out);
    call.extend(target.name_warning(machine));
    if !tables.is_finite() {
        return call.refuse(not_finite("correction"));
    }
    warn_left_out(call, machine, target, &tables);
    warn_unknown_scales(call, machine, planner);
    let losses = installed.map(|(old, _)| target.resampling_losses(machine, &tables, old)).unwrap_or_default();
    call.extend(losses);
    call.extend(limits.excesses(machine, &tables));
    call.extend(target.violations(machine, &tables));
    call.check()?;
    let rendered = target.watch.during(|| target.render(machine, &tables, &mut call.diagnostics)).ok_or(Refused)?;
    call.check()?;
    let tables = read_back(call, machine, target, &rendered, &tables)?;
    Ok(RenderedTables { rendered, tables })
}

/// Refuses axes for which the controller has no letter, before tables are filled.
fn refuse_no_letter(call: &mut Call, machine: &Machine, target: &ControllerTarget) -> Result<(), Refused> {
    let mut found = Diagnostics::default();
    if axis_letters(machine, target.manifest.axis_letters.as_ref(), Some(&mut found)).is_none() {
        call.extend(found.iter().cloned());
    }
    call.check()
}

/// Refuses a travel that the target's tables cannot hold: two positions of it would be written as one.
fn refuse_short_travel(call: &mut Call, machine: &Machine, target: &ControllerTarget) -> Result<(), Refused> {
    for axis in machine.axes() {
        let (min, max) = axis.travel.interval();
        let steps = target.manifest.mechanism.iter().map(|(_, rules)| rules.increment.min_position(axis.kind));
        let coarsest = steps.fold(0.0, f64::max);
        if max - min < coarsest {
            let (unit, name) = (axis.unit(), &target.manifest.target);
            let message = format!(
                "the travel of `{}`, {} {unit}, is below the increment of positions of `{name}`, {coarsest} {unit}",
                axis.name,
                max - min
            );
            call.extend([Diagnostic::new(codes::E0708, message).help("check the unit of the travel")]);
        }
    }
    call.check()
}

/// Indices of the axes that span a lattice: those named, in the order of the chain, or all.
fn lattice_axes(call: &mut Call, machine: &Machine, named: &[String]) -> Result<Vec<usize>, Refused> {
    let all = 0..machine.axes().len();
    if let Some(unknown) = named.iter().find(|name| machine.axis_index(name).is_none()) {
        return call.usage(format!("--lattice: the chain has no axis `{}`", unknown.escape_debug()));
    }
    if let Some((_, twice)) = named.iter().enumerate().find(|(i, name)| named[..*i].contains(name)) {
        return call.usage(format!("--lattice: `{}` is there twice", twice.escape_debug()));
    }
    let wanted = |axis: &usize| named.is_empty() || named.iter().any(|name| machine.axis_index(name) == Some(*axis));
    Ok(all.filter(wanted).collect())
}

/// Refuses a lattice with fewer than two nodes on an axis, or with nothing to correct.
fn refuse_impossible_lattice(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    request: &LatticeRequest,
) -> Result<(), Refused> {
    let free = target.manifest.mechanism.lattice.as_ref().filter(|rules| rules.inputs.is_empty());
    let Some(rules) = free else { return Ok(()) };
    let max = request.max_nodes.min(rules.table.max_points);
    let min = 2_usize.checked_pow(u32::try_from(request.axes.len()).unwrap_or(u32::MAX)).unwrap_or(usize::MAX);
    if min > max {
        let message =
            format!("a lattice over {} axes has {min} nodes or more, above the limit of {max}", request.axes.len());
        let help = "span it over fewer axes with --lattice X,Y,Z, or allow more with --nodes";
        return call.refuse(Diagnostic::new(codes::E0603, message).help(help));
    }
    let linear = machine.axes().iter().any(|axis| axis.kind == AxisKind::Linear);
    let able = linear || (request.scope.rotary && rules.corrects_rotary);
    if !able {
        let message = "the machine has no linear axis to correct the position with";
        let help = "let the rotary axes correct: --with all, or --correct pose";
        return call.refuse(Diagnostic::new(codes::E0603, message).help(help));
    }
    Ok(())
}

/// Warns of points beyond the format's limit, and of travel beyond the volume.
fn warn_left_out(call: &mut Call, machine: &Machine, target: &ControllerTarget, tables: &CorrectionTables) {
    let own = target.manifest.mechanism.own_axis.as_ref().map(|own| &own.table);
    if let Some(rules) = own.filter(|rules| rules.fit == Fit::Axis) {
        for (axis, points) in thinned_axes(machine, rules) {
            let (name, max) = (&machine.axes()[axis].name, rules.max_points);
            let message =
                format!("the curves of `{name}` have {points} points, the format holds {max}: they were thinned_axes");
            let help = "thin the curve out yourself if certain points matter";
            call.warn(Diagnostic::new(codes::W0604, message).help(help));
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
            call.warn(Diagnostic::new(codes::W0605, message).help(help));
        }
    }
}

/// A scale in force that is farther than this from the one that the option states is another machine's: a part in a
/// thousand. Controls print two or three decimals.
const SAME_SCALE: f64 = 1e-3;

/// Takes the scales of drives that files in force say, where the option says none. New scales replace them.
pub(crate) fn take_scales(
    call: &mut Call,
    machine: &Machine,
    target: &mut ControllerTarget,
    installed: Option<&CorrectionTables>,
) -> Result<(), Refused> {
    let Some(own) = target.manifest.mechanism.own_axis.as_mut().filter(|own| own.scale.is_some()) else {
        return Ok(());
    };
    for (axis, value) in installed.iter().flat_map(|tables| &tables.scales) {
        let name = machine.axes()[*axis].name.to_string();
        match own.in_force.iter().find(|(known, _)| *known == name) {
            None => own.in_force.push((name, *value)),
            Some((_, stated)) if (stated / value - 1.0).abs() <= SAME_SCALE => {}
            Some((_, stated)) => {
                let message = format!("--scale says {stated} for `{name}`, and the files in force say {value}");
                let help = "give the number with which the machine was measured";
                return call.refuse(Diagnostic::new(codes::E0711, message).help(help));
            }
        }
    }
    Ok(())
}

/// Asks about stated scales that look like those of another control: steps in a mm for mm in a turn.
fn warn_unusual_scales(call: &mut Call, target: &ControllerTarget) {
    let Some(own) = &target.manifest.mechanism.own_axis else { return };
    let Some(scale) = own.scale else { return };
    let [low, high] = scale.usual();
    let unusual = own.in_force.iter().filter(|(_, value)| !(low..=high).contains(value));
    let list: Vec<String> = unusual.map(|(name, value)| format!("{name}={value}")).collect();
    if !list.is_empty() {
        let message = format!("{} is seldom: this control counts {}", list.join(", "), scale.words());
        let help = "a wrong number would make the axis move by a multiple: compare it with that in the control";
        call.warn(Diagnostic::new(codes::W0718, message).help(help));
    }
}

/// A scale that changes less than this over its travel is none, mm.
const NO_SCALE_MM: f64 = 1e-3;

/// Warns of scales that would be corrected if those in force were known.
fn warn_unknown_scales(call: &mut Call, machine: &Machine, target: &ControllerTarget) {
    let unknown = target.manifest.mechanism.unknown_scales(machine);
    let said = |(axis, over): &(usize, f64)| {
        let name = &machine.axes()[*axis].name;
        (over.abs() > NO_SCALE_MM).then(|| (name.to_string(), format!("{} um of `{name}`", significant(over * 1e3, 3))))
    };
    let (names, said): (Vec<String>, Vec<String>) = unknown.iter().filter_map(said).unzip();
    if !names.is_empty() {
        let message = format!("no scale is written for {}: the scale in force is not known", said.join(", "));
        let example: Vec<String> = names.iter().map(|name| format!("{name}=...")).collect();
        let help = format!(
            "give the numbers with which the machine was measured: --scale {}, or --installed DIR with the control's \
             own settings (docs/controls/printers.md)",
            example.join(",")
        );
        call.warn(Diagnostic::new(codes::W0718, message).help(help));
    }
}

/// Reads the rendered bytes back as `verify` would, and insists that they are the tables we meant.
pub(super) fn read_back(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    files: &[RenderedFile],
    meant: &CorrectionTables,
) -> Result<CorrectionTables, Refused> {
    let text = |file: &RenderedFile| ReadBack::new(&*file.name, String::from_utf8_lossy(&file.bytes));
    let wanted = [target.table_files(machine), target.index_files()].concat();
    let texts: Vec<_> = files.iter().filter(|file| wanted.contains(&file.name)).map(text).collect();
    let read = target.read(machine, &texts, &mut call.diagnostics);
    call.check()?;
    // Nothing to compensate may mean no files of tables.
    let tables = target.table_files(machine);
    let none = !files.iter().any(|file| tables.contains(&file.name));
    match read.or_else(|| none.then(CorrectionTables::default)) {
        Some(read) if read.same_effect(meant) => Ok(read),
        _ => call.refuse(misread(target)),
    }
}

pub(crate) struct FoundTables {
    pub target: ControllerTarget,
    pub tables: CorrectionTables,
    pub files: Vec<String>,
}

/// Reads the tables of a set.
pub(crate) fn tables_of(
    call: &mut Call,
    machine: &Machine,
    folder: &Path,
    set: FoundSet,
) -> Result<FoundTables, Refused> {
    let FoundSet { target, files, .. } = set;
    if target.manifest.kinematics().is_some() {
        let message = format!("`{}` holds a kinematics module, which has no tables", folder.display());
        let help = "a module is written anew from the machine file, not on top of another one";
        return call.refuse(Diagnostic::new(codes::E0711, message).help(help));
    }
    let read = target.read(machine, &files, &mut call.diagnostics);
    call.check()?;
    let read = read.or_else(|| files.is_empty().then(CorrectionTables::default));
    let indices = target.index_files();
    let names = files.into_iter().filter(|file| !indices.contains(&file.name)).map(|file| file.found).collect();
    match read {
        Some(tables) => {
            call.extend(target.coverage_warnings(machine, &tables));
            Ok(FoundTables { target, tables, files: names })
        }
        None => call.refuse(found_set::nothing_found(folder)),
    }
}

/// The tables that were in force when the machine was measured.
pub(crate) fn load_installed(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    options: &CompensationOptions,
    folder: Option<&Path>,
) -> Result<Option<CorrectionTables>, Refused> {
    let Some(folder) = folder else { return Ok(None) };
    // What is installed is there, whatever new tables are to be without.
    let options = CompensationOptions { without: Vec::new(), ..options.clone() };
    // Settings as a control prints them have any name, perhaps that of another target's file.
    let settings = target.manifest.mechanism.scale().is_some() && Folder::new(folder, call.run.files).lock().is_none();
    let named = settings.then(|| target.manifest.target.clone());
    let found = found_set::find_set(call, machine, folder, named.as_deref(), &options)?;
    let mut set = tables_of(call, machine, folder, found)?;
    call.check()?;
    if set.target.manifest.mechanism.scale().is_some() {
        set.tables = set.target.with_scales_in_force(set.tables);
    }
    if set.target.manifest.target == target.manifest.target {
        if set.tables.senses.is_empty() {
            return Ok(Some(set.tables));
        }
        let message = format!("`{}` turns corrections round, or leaves axes out", folder.display());
        let help = "new curves on top of such a set would be turned too: measure without it";
        return call.refuse(Diagnostic::new(codes::E0711, message).help(help));
    }
    let (old, new) = (&set.target.manifest.target, &target.manifest.target);
    let message = format!("the files in `{}` are of target `{old}`, not of `{new}`", folder.display());
    let help = "only tables of the same target can be written on top of each other";
    call.refuse(Diagnostic::new(codes::E0711, message).help(help))
}
