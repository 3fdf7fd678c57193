//! `locate`: location errors from the lines of the rotary axes that a control's own calibration, or a probe, found.

mod lines;

use super::compensation::found_set;
use super::compensation::module_set::{self, ModuleRequest};
use super::compensation::options::CompensationOptions;
use super::import::columns_left_out;
use super::machine_file::MachineFile;
use super::run::{Answer, Call, Refused, Run};
use crate::controller::{Parameters, Transformation};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::machine::{ErrorFamily, ErrorId, ErrorTerm, Machine, machine_file};
use crate::syntax::sheet::read_sheet;
use lines::{FoundLine, found_lines};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options of [`locate`].
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct LocateOptions {
    /// Name of the controller whose kinematic parameters the folder holds; by default the one that its files name.
    pub target: Option<String>,
    /// A folder with targets of one's own, each a folder with a `target.yaml`.
    pub templates: Option<PathBuf>,
    /// Folder with the kinematic parameters before the calibration; by default those of the nominal machine.
    pub installed: Option<PathBuf>,
}

/// Location errors that were found.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct LocateResult {
    /// Name of the machine.
    pub machine: String,
    /// The controller whose parameters were read; none of a table.
    pub target: Option<String>,
    /// The errors, axis by axis.
    pub errors: Vec<LocatedError>,
    /// The machine with the errors found, as a machine file.
    #[serde(skip)]
    pub machine_file: String,
}

/// A location error.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct LocatedError {
    /// Its name.
    pub name: String,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// Value by the lines that were found.
    pub found: f64,
    /// Expanded uncertainty (k = 2) that the table states.
    pub uncertainty: Option<f64>,
    /// Value in the machine file, 0 if it gives none.
    pub in_file: f64,
    /// Expanded uncertainty (k = 2) in the machine file.
    pub in_file_uncertainty: Option<f64>,
    /// Found minus in the file.
    pub difference: f64,
    /// True if the difference is within both uncertainties, as the root of the sum of their squares; none if neither
    /// is stated.
    pub agrees: Option<bool>,
}

/// An error found (mm, rad), with its expanded uncertainty.
type Found = (ErrorId, f64, Option<f64>);

/// Returns the location errors of the rotary axes, and of the spindle, that a control's own calibration or a probe
/// found, beside those of the machine file: from a folder with kinematic parameters of a target, or from a table of
/// lines.
///
/// Fails for a machine that has no kinematic parameters, for files that cannot be read, and for lines to which no
/// location errors lead.
pub fn locate(
    file: &MachineFile,
    path: impl AsRef<Path>,
    options: &LocateOptions,
    run: Run<'_>,
) -> Result<Answer<LocateResult>, Diagnostics> {
    let path = path.as_ref();
    Call::answer(run, file.sources(), |call| {
        let is_folder = !call.run.files.entries(path).is_empty();
        let (target, found) = if is_folder {
            from_parameters(call, file, path, options)?
        } else {
            if options.target.is_some() || options.installed.is_some() {
                return call.usage("`--target` and `--installed` are for a folder with kinematic parameters");
            }
            (None, from_table(call, file, path)?)
        };
        Ok(LocateResult {
            machine: file.name().to_owned(),
            target,
            errors: found.iter().map(|found| LocatedError::of(file, found)).collect(),
            machine_file: with_errors(file, path, &found),
        })
    })
}

/// The errors that the parameters in a folder tell.
fn from_parameters(
    call: &mut Call<'_>,
    file: &MachineFile,
    path: &Path,
    options: &LocateOptions,
) -> Result<(Option<String>, Vec<Found>), Refused> {
    let how = CompensationOptions { templates: options.templates.clone(), ..CompensationOptions::default() };
    let set = found_set::found_set(call, file, path, options.target.as_deref(), &how)?;
    let name = &set.target.manifest.target;
    if set.target.manifest.kinematics().is_none_or(|mechanism| mechanism.machines.is_empty()) {
        return call.usage(format!("`{}` holds files of `{name}`, which has no kinematic parameters", path.display()));
    }
    let before = module_set::installed(call, file, &set.target, &how, options.installed.as_deref())?;
    let request = ModuleRequest { before, ..ModuleRequest::plain(true) };
    let (module, _) = module_set::found(call, file, &set.target, path, request, &set.files)?;
    let Some(parameters) = module.parameters() else { return Err(Refused) };
    let found = told(file, parameters).or_else(|refusal| call.refuse(refusal))?;
    Ok((Some(name.clone()), found))
}

fn told(machine: &Machine, parameters: &Parameters) -> Result<Vec<Found>, Diagnostic> {
    let mut found = Vec::new();
    for (id, value) in parameters.transformation().location_errors(machine)? {
        if parameters.tells(machine, &id)? {
            found.push((id, value, None));
        }
    }
    Ok(found)
}

/// The errors that a table of lines tells.
fn from_table(call: &mut Call<'_>, file: &MachineFile, path: &Path) -> Result<Vec<Found>, Refused> {
    let Some(sheet) = read_sheet(path, call.run.files, &mut call.diagnostics) else { return Err(Refused) };
    let nominal = Transformation::nominal(file).or_else(|refusal| call.refuse(refusal))?;
    let (lines, left_out) = found_lines(&sheet, file, &nominal).or_else(|refusal| call.refuse(refusal))?;
    let titles: Vec<&str> = left_out.iter().map(String::as_str).collect();
    call.extend(columns_left_out(&titles, "see docs/kinematic-parameters.md for the titles that are understood"));
    let mut placed = nominal;
    for found in &lines {
        let own = placed.table.iter_mut().chain(&mut placed.head).filter(|line| line.axis == found.line.axis);
        own.for_each(|line| *line = found.line.clone());
    }
    let errors = placed.location_errors(file).or_else(|refusal| call.refuse(refusal))?;
    let stated = |(id, value): (ErrorId, f64)| {
        let line = lines.iter().find(|found| file.axes()[found.line.axis].name == id.axis)?;
        line.tells(&id).then(|| (line.uncertainty(&id), id, value)).map(|(u, id, value)| (id, value, u))
    };
    let found: Vec<Found> = errors.into_iter().filter_map(stated).collect();
    if found.is_empty() {
        let message = "the table states no coordinate across an axis, and no direction";
        let help = "a point may lie anywhere along its axis: state those across it";
        return call.refuse(Diagnostic::new(codes::E0519, message).help(help));
    }
    Ok(found)
}

impl FoundLine {
    /// True if the line states the error.
    fn tells(&self, id: &ErrorId) -> bool {
        if id.direction.is_rotation() { self.directed } else { self.stated[id.direction.index()] }
    }

    fn uncertainty(&self, id: &ErrorId) -> Option<f64> {
        if id.direction.is_rotation() { self.angle_uncertainty } else { self.point_uncertainty }
    }
}

impl LocatedError {
    fn of(file: &MachineFile, (id, value, uncertainty): &Found) -> Self {
        let (factor, unit) = id.direction.micro();
        let joint = file.axis_index(id.axis.as_str()).map(|axis| file.axis_errors(axis)).or(file.spindle_errors());
        let in_file = joint.map_or(0.0, |errors| errors.location_values()[id.direction.index()]);
        let of_file = file.to_parts().uncertainty.get(id).copied();
        let difference = value - in_file;
        let both = [*uncertainty, of_file];
        let joined = libm::sqrt(both.iter().flatten().map(|u| u * u).sum());
        Self {
            name: id.to_string(),
            unit,
            found: value * factor + 0.0,
            uncertainty: uncertainty.map(|u| u * factor),
            in_file: in_file * factor + 0.0,
            in_file_uncertainty: of_file.map(|u| u * factor),
            difference: difference * factor + 0.0,
            agrees: both.iter().any(Option::is_some).then_some(difference.abs() <= joined),
        }
    }
}

/// The machine with the errors that were found in place of its own.
fn with_errors(file: &MachineFile, source: &Path, found: &[Found]) -> String {
    let mut parts = file.to_parts();
    for (id, value, uncertainty) in found {
        let axis = file.axis_index(id.axis.as_str()).unwrap_or(file.axes().len());
        let Some(errors) = parts.errors.get_mut(axis) else { continue };
        let slot = &mut errors.six_mut(ErrorFamily::Location)[id.direction.index()];
        *slot = Some(ErrorTerm::Constant(*value));
        let _ = match uncertainty {
            Some(u) => parts.uncertainty.insert(id.clone(), *u),
            None => parts.uncertainty.remove(id),
        };
        parts.covariance.iter_mut().for_each(|part| part.remove(id));
    }
    parts.covariance.retain(|part| !part.is_empty());
    for (i, axis) in file.axes().iter().enumerate() {
        parts.geometry.follow(&axis.name, file.axis_errors(i), &parts.errors[i]);
    }
    let names: Vec<String> = found.iter().map(|(id, ..)| id.to_string()).collect();
    let source = source.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let entry = ("rotary axes located".to_owned(), format!("{} from {source}", names.join(" ")));
    machine_file(&parts, &[entry])
}
