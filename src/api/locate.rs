//! `locate`: location errors from the lines of the rotary axes that a control's own calibration, or a probe, found,
//! and the lines that it should find.

use super::import::columns_left_out;
use crate::controller::{FoundLine, Parameters, RotaryLine, Transformation, found_lines};
use crate::diagnostic::{Diagnostic, codes};
use crate::file_set::found_set;
use crate::file_set::module_set::{self, InForce, ModuleRequest};
use crate::file_set::options::CompensationOptions;
use crate::job::machine_file::MachineFile;
use crate::machine::{ErrorFamily, ErrorId, ErrorTerm, Machine, machine_file};
use crate::run::{Call, Refused, Reply, Run};
use crate::syntax::sheet::read_sheet;
use nalgebra::Vector3;
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
    /// Largest distance of an axis in force from that of the machine file, mm; 1 mm if none is stated.
    #[serde(rename = "max_change")]
    pub max_change_mm: Option<f64>,
}

impl LocateOptions {
    fn in_force(&self) -> InForce<'_> {
        InForce { folder: self.installed.as_deref(), max_change_mm: self.max_change_mm }
    }
}

/// Location errors that were found.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct LocateResult {
    /// Name of the machine.
    pub machine: String,
    /// The controller whose parameters were read; none of a table.
    pub target: Option<String>,
    /// The errors, axis by axis; none if nothing was found.
    pub errors: Vec<LocatedError>,
    /// The rotary axes in the order of the walk.
    pub lines: Vec<LocatedAxis>,
    /// The machine with the errors found, as a machine file.
    #[serde(skip)]
    pub machine_file: String,
}

/// A rotary axis as a line.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct LocatedAxis {
    /// Name of the axis.
    pub axis: String,
    /// The line that was found; none if nothing was.
    pub found: Option<AxisLine>,
    /// The line where the machine file displaces it.
    pub in_file: AxisLine,
    /// The largest expanded uncertainty (k = 2) of its shifts in the machine file.
    pub uncertainty_um: Option<f64>,
    /// The largest expanded uncertainty (k = 2) of its tilts in the machine file.
    pub uncertainty_urad: Option<f64>,
}

/// A line in machine directions, all axes at 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct AxisLine {
    /// The point next to the nominal origin of the axis, in the coordinates of the machine file.
    pub point_mm: [f64; 3],
    /// The unit vector about which a positive command turns the tool right-handed relative to the workpiece.
    pub direction: [f64; 3],
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

/// The lines that were found, the errors that they tell, and the controller whose parameters they were.
struct Finding {
    target: Option<String>,
    placed: Option<Transformation>,
    errors: Vec<Found>,
}

/// Returns the location errors of the rotary axes, and of the spindle, that a control's own calibration or a probe
/// found, beside those of the machine file: from a folder with kinematic parameters of a target, or from a table of
/// lines. Without a path the result has the lines of the machine file alone: what a calibration should find.
///
/// Fails for a machine that has no kinematic parameters, for files that cannot be read, and for lines to which no
/// location errors lead.
pub fn locate(file: &MachineFile, path: Option<&Path>, options: &LocateOptions, run: Run) -> Reply<LocateResult> {
    Call::answer(run, file.sources(), |call| {
        let is_folder = path.is_some_and(|path| !call.run.files.entries(path).is_empty());
        if !is_folder && (options.target.is_some() || options.installed.is_some()) {
            return call.usage("`--target` and `--installed` are for a folder with kinematic parameters");
        }
        let finding = match path {
            Some(path) if is_folder => from_parameters(call, file, path, options)?,
            Some(path) => from_table(call, file, path)?,
            None => Finding { target: None, placed: None, errors: Vec::new() },
        };
        let lines = LocatedAxis::all(file, finding.placed.as_ref()).or_else(|refusal| call.refuse(refusal))?;
        Ok(LocateResult {
            machine: file.name().to_owned(),
            target: finding.target,
            errors: finding.errors.iter().map(|found| LocatedError::of(file, found)).collect(),
            lines,
            machine_file: with_errors(file, path, &finding.errors),
        })
    })
}

/// The errors that the parameters in a folder tell.
fn from_parameters(
    call: &mut Call,
    file: &MachineFile,
    path: &Path,
    options: &LocateOptions,
) -> Result<Finding, Refused> {
    let how = CompensationOptions { templates: options.templates.clone(), ..CompensationOptions::default() };
    let set = found_set::find_set(call, file, path, options.target.as_deref(), &how)?;
    let name = &set.target.manifest.target;
    if set.target.manifest.kinematics().is_none_or(|mechanism| mechanism.machines.is_empty()) {
        return call.usage(format!("`{}` holds files of `{name}`, which has no kinematic parameters", path.display()));
    }
    let before = module_set::load_installed(call, file, &set.target, &how, options.in_force())?;
    let request = ModuleRequest { before, ..ModuleRequest::plain(true) };
    let (module, _) = module_set::find(call, file, &set.target, path, request, &set.files)?;
    let Some(parameters) = module.parameters() else { return Err(Refused) };
    let errors = list_found(file, parameters).or_else(|refusal| call.refuse(refusal))?;
    Ok(Finding { target: Some(name.clone()), placed: Some(parameters.transformation().clone()), errors })
}

fn list_found(machine: &Machine, parameters: &Parameters) -> Result<Vec<Found>, Diagnostic> {
    let mut found = Vec::new();
    for (id, value) in parameters.transformation().location_errors(machine)? {
        if parameters.tells(machine, &id)? {
            found.push((id, value, None));
        }
    }
    Ok(found)
}

/// The errors that a table of lines tells.
fn from_table(call: &mut Call, file: &MachineFile, path: &Path) -> Result<Finding, Refused> {
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
    Ok(Finding { target: None, placed: Some(placed), errors: found })
}

impl LocatedAxis {
    /// The rotary axes of a machine file, and where they were found.
    fn all(file: &MachineFile, placed: Option<&Transformation>) -> Result<Vec<Self>, Diagnostic> {
        let (nominal, actual) = (Transformation::nominal(file)?, Transformation::actual(file)?);
        let gauge = Vector3::from(file.tool().gauge);
        let lines = |of: &Transformation| of.table.iter().chain(&of.head).cloned().collect::<Vec<_>>();
        let found = placed.map(lines);
        let all = lines(&nominal).into_iter().zip(lines(&actual)).enumerate();
        let axis = |(i, (nominal, actual)): (usize, (RotaryLine, RotaryLine))| Self {
            axis: file.axes()[nominal.axis].name.to_string(),
            found: found.as_ref().and_then(|lines| lines.get(i)).map(|line| AxisLine::of(line, &nominal, gauge)),
            in_file: AxisLine::of(&actual, &nominal, gauge),
            uncertainty_um: largest(file, nominal.axis, false),
            uncertainty_urad: largest(file, nominal.axis, true),
        };
        Ok(all.map(axis).collect())
    }
}

/// The largest uncertainty (um, urad) that the file states of the shifts or tilts of an axis.
fn largest(file: &MachineFile, axis: usize, tilts: bool) -> Option<f64> {
    let parts = file.to_parts();
    let own = |id: &ErrorId| {
        id.axis == file.axes()[axis].name && id.family == ErrorFamily::Location && id.direction.is_rotation() == tilts
    };
    let all = parts.uncertainty.iter().filter(|(id, _)| own(id));
    all.map(|(id, u)| u * id.direction.micro().0).max_by(f64::total_cmp)
}

impl AxisLine {
    fn of(line: &RotaryLine, nominal: &RotaryLine, gauge: Vector3<f64>) -> Self {
        let along = line.direction * line.direction.dot(&(nominal.point - line.point));
        Self { point_mm: (line.point + along + gauge).into(), direction: line.direction.into() }
    }
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
fn with_errors(file: &MachineFile, source: Option<&Path>, found: &[Found]) -> String {
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
    let source = source.and_then(Path::file_name).unwrap_or_default().to_string_lossy();
    let entry = ("rotary axes located".to_owned(), format!("{} from {source}", names.join(" ")));
    machine_file(&parts, &[entry])
}
