//! Kinematics modules, for targets that replace the controller's kinematics: rendered and read back, or found in a
//! folder.

use super::options::CompensationOptions;
use super::pole_zone::{DriveLimits, fit_pole_zone};
use super::{found_set, misread};
use crate::compensation::CorrectionTables;
use crate::controller::{ControllerTarget, KinematicsModule, Limits, ReadBack, RenderedFile};
use crate::machine::Machine;
use crate::run::{Call, Refused, finite};
use std::path::Path;
use std::sync::Arc;

/// The files of a module, and the numbers that the controller reads from them.
pub(crate) struct ModuleFiles {
    pub(crate) rendered: Vec<RenderedFile>,
    pub(crate) module: KinematicsModule,
    pub(crate) beside: CorrectionTables,
}

/// The purpose of a module, and what it stands on.
#[derive(Debug, Clone)]
pub(crate) struct ModuleRequest {
    /// True if the direction of the tool is corrected too.
    pub(crate) orientation: bool,
    pub(crate) limits: Limits,
    /// Kinematic parameters with which the machine was measured, mm and components of unit vectors; the nominal
    /// machine's if there are none.
    pub(crate) before: Option<Vec<f64>>,
    /// Text of the controller's INI file, by whose limits the pole zone of a generated module is chosen.
    pub(crate) ini: Option<Arc<str>>,
}

impl ModuleRequest {
    /// Returns the request of a module on its own that nobody is to load.
    pub(crate) fn plain(orientation: bool) -> Self {
        Self { orientation, limits: Limits::LARGEST, before: None, ini: None }
    }
}

pub(crate) fn render(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    request: ModuleRequest,
) -> Result<ModuleFiles, Refused> {
    let (limits, ini) = (request.limits, request.ini.clone());
    let carried = carry(call, machine, target, request)?;
    let meant = match ini {
        Some(text) => fit_zone(call, machine, carried, &text)?,
        None => carried,
    };
    call.extend(finite::refusal(&meant));
    call.check()?;
    let reversal = Arc::new(target.reversal_tables(machine));
    call.extend(limits.excesses(machine, &reversal));
    call.check()?;
    let render = || target.render_kinematics(machine, &meant, &reversal, &mut call.diagnostics);
    let rendered = target.watch.during(render).ok_or(Refused)?;
    call.check()?;
    let (module, beside) = read_back(call, machine, target, &rendered, &meant, &reversal)?;
    Ok(ModuleFiles { rendered, module, beside })
}

/// Chooses the pole zone by the limits of an INI file.
fn fit_zone(
    call: &mut Call,
    machine: &Machine,
    carried: KinematicsModule,
    text: &str,
) -> Result<KinematicsModule, Refused> {
    if !carried.keeps_the_tip() {
        return call.usage("--ini: words of this machine's programs are not the tip of the tool, so no zone is fitted");
    }
    match DriveLimits::read(machine, &carried, text) {
        Ok(limits) => {
            let (fitted, warnings) = fit_pole_zone(machine, carried, &limits);
            call.extend(warnings);
            Ok(fitted)
        }
        Err(refusal) => call.refuse(refusal),
    }
}

/// The files in force when the machine was measured, and the limit by which they are judged.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct InForce<'a> {
    /// Their folder.
    pub(crate) folder: Option<&'a Path>,
    /// Largest distance of a line in force from that of the machine file, mm; [`MAX_CHANGE_MM`] if there is none.
    pub(crate) max_change_mm: Option<f64>,
}

/// A line in force farther than this from the machine file's is refused unless the caller takes it, mm: castings are
/// made to a few tenths.
const MAX_CHANGE_MM: f64 = 1.0;

/// Reads the kinematic parameters that were in force when the machine was measured. Other modules take the place of
/// what was there, and nothing adds up.
pub(crate) fn load_installed(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    options: &CompensationOptions,
    in_force: InForce<'_>,
) -> Result<Option<Vec<f64>>, Refused> {
    let Some(folder) = in_force.folder else { return Ok(None) };
    if target.manifest.kinematics().is_none_or(|mechanism| mechanism.machines.is_empty()) {
        return call.usage(
            "--installed: a kinematics module takes the place of the one before and adds nothing to it: measure \
             without it, and compile without --installed",
        );
    }
    let meant = carry(call, machine, target, ModuleRequest::plain(options.orientation()))?;
    let named = Some(target.manifest.target.as_str());
    let set =
        call.about(&folder.display().to_string(), |call| found_set::find_set(call, machine, folder, named, options))?;
    let Some(file) = set.files.first() else { return call.refuse(found_set::nothing_found(folder)) };
    let values = target.read_parameters(machine, &meant, file, &mut call.diagnostics);
    let Some(values) = values else { return Err(Refused) };
    judge(call, machine, target, &meant, &values, in_force)?;
    Ok(Some(values))
}

/// Refuses numbers in force that are not of this machine, and warns of those beside it.
pub(super) fn judge(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    meant: &KinematicsModule,
    values: &[f64],
    in_force: InForce<'_>,
) -> Result<(), Refused> {
    let Some(parameters) = meant.parameters() else { return Ok(()) };
    let limit = in_force.max_change_mm.unwrap_or(MAX_CHANGE_MM);
    match parameters.judge_in_force(machine, target, values, limit) {
        Ok(warnings) => call.extend(warnings),
        Err(refusal) => return call.refuse(refusal),
    }
    Ok(())
}

/// A module's numbers and the tables beside it, read from the files of a folder.
pub(crate) fn find(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    folder: &Path,
    request: ModuleRequest,
    texts: &[ReadBack],
) -> Result<(KinematicsModule, CorrectionTables), Refused> {
    if texts.is_empty() {
        return call.refuse(found_set::nothing_found(folder));
    }
    let meant = carry(call, machine, target, request)?;
    let Some(read) = target.read_kinematics(machine, &meant, texts, &mut call.diagnostics) else {
        return Err(Refused);
    };
    let beside = beside(call, machine, target, texts)?;
    Ok((read.with_tool_of(machine), beside))
}

fn carry(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    request: ModuleRequest,
) -> Result<KinematicsModule, Refused> {
    match KinematicsModule::of(machine, target, request.orientation) {
        Ok(carried) => {
            call.extend(carried.warnings(machine));
            Ok(request.before.into_iter().fold(carried, KinematicsModule::on_top_of))
        }
        Err(refusal) => call.refuse(refusal),
    }
}

/// The tables of the files beside a module; none if there are no such files.
fn beside(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    texts: &[ReadBack],
) -> Result<CorrectionTables, Refused> {
    let tables = target.read_beside(machine, texts, &mut call.diagnostics);
    call.check()?;
    Ok(tables)
}

/// Reads the rendered bytes back as `verify` would, and refuses any difference from the intended module.
pub(super) fn read_back(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    files: &[RenderedFile],
    meant: &KinematicsModule,
    reversal: &CorrectionTables,
) -> Result<(KinematicsModule, CorrectionTables), Refused> {
    let text = |file: &RenderedFile| ReadBack::new(&*file.name, String::from_utf8_lossy(&file.bytes));
    let texts: Vec<_> = files.iter().map(text).collect();
    let read = target.read_kinematics(machine, meant, &texts, &mut call.diagnostics);
    call.check()?;
    let beside = beside(call, machine, target, &texts)?;
    match read {
        Some(read) if read == *meant && beside.same_effect(reversal) => Ok((read, beside)),
        _ => call.refuse(misread(target)),
    }
}
