//! The same machine under other conventions, proved by comparing both.

use crate::convert::{Change, Conversion, ConversionRequest, Misfit, Proof, ROUNDING, changes, prove};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::job::machine_file::{MachineFile, read_back};
use crate::machine::{Axis, AxisName, Conventions, Machine, MachineParts, machine_file};
use crate::run::{Call, Refused, Reply, Run};
use crate::units::{angle, length, significant};
use serde::Serialize;

/// Options of [`convert`].
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct ConvertOptions {
    /// The new conventions: a preset, words such as `carried_body`, or `linear: before, rotary: rotating`; others stay
    /// as they are.
    pub to: Option<String>,
    /// The axis from whose actual line location errors count (`axis_only`), instead of the machine frame.
    pub datum: Option<String>,
    /// Difference of the machines that is accepted, mm; for rotations this over a metre. By default only rounding is.
    pub within_mm: Option<f64>,
}

/// A converted machine with its proof.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct ConvertResult {
    /// The new conventions.
    pub conventions: Conventions,
    /// The conventions that changed, in words.
    pub changed: Vec<String>,
    /// The errors that changed.
    pub errors: Vec<ConvertedError>,
    /// Errors that no curve of the language holds exactly.
    pub misfits: Vec<MisfitSize>,
    /// The comparison of both machines.
    pub proof: ConversionProof,
    /// The converted machine.
    #[serde(skip)]
    pub machine: MachineFile,
    /// Text of its file.
    #[serde(skip)]
    pub machine_file: String,
    /// The comparison in words.
    #[serde(skip)]
    pub proved: String,
}

/// An error with another value, or another curve.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ConvertedError {
    /// Name such as `EC0Y`, `EXX`, `workpiece.A`.
    pub name: String,
    /// Constant before, in `unit`; none for a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<f64>,
    /// Constant after, in `unit`; none for a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<f64>,
    /// `um` or `urad`; none for a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
    /// True for a curve.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub curve: bool,
    /// Constants before and after with their unit; none for a curve.
    #[serde(skip)]
    pub words: Option<[String; 2]>,
}

impl ConvertedError {
    fn of(change: &Change) -> Self {
        let rotation = change.direction.is_rotation();
        let (factor, unit) = change.direction.micro();
        let print = if rotation { angle } else { length };
        let values = change.values.map(|values| values.map(|value| value * factor + 0.0));
        Self {
            name: change.name.clone(),
            before: values.map(|[before, _]| before),
            after: values.map(|[_, after]| after),
            unit: values.map(|_| unit),
            curve: values.is_none(),
            words: change.values.map(|values| values.map(print)),
        }
    }
}

/// An error that no curve of the language holds exactly.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MisfitSize {
    /// Name of the error.
    pub name: String,
    /// Largest difference of the curve written, mm or rad.
    pub off: f64,
}

/// The comparison of both machines by the exact model, from every direction of approach.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ConversionProof {
    /// Poses on a grid over the volume.
    pub grid_poses: usize,
    /// Random poses over the travels.
    pub random_poses: usize,
    /// Largest difference of the functional point, mm.
    pub position_mm: f64,
    /// Largest difference of the orientation, rad.
    pub rotation_rad: f64,
    /// Difference of the functional point that was accepted, mm.
    pub bound_mm: f64,
    /// Difference of the orientation that was accepted, rad.
    pub bound_rad: f64,
}

/// Rewrites a machine for other conventions, and proves that it is the same machine.
///
/// Fails for unknown conventions or axes, and where the machines differ by more than is accepted.
pub fn convert(file: &MachineFile, options: &ConvertOptions, run: Run) -> Reply<ConvertResult> {
    Call::answer(run, file.sources(), |call| {
        let request = request(file, options).or_else(|refusal| call.refuse(refusal))?;
        let conversion = crate::convert::convert(file, &request).or_else(|refusal| call.refuse(refusal))?;
        let machine = reload(call, &machine_file(&conversion.parts, &[]))?;
        let proof = prove(file, &machine);
        if !proof.holds(request.within_mm) {
            return call.refuse(inexact(file, &request, &conversion, &proof));
        }
        Ok(result(file, machine, &request, &conversion, &proof))
    })
}

fn result(
    file: &MachineFile,
    machine: MachineFile,
    request: &ConversionRequest,
    conversion: &Conversion,
    proof: &Proof,
) -> ConvertResult {
    let (changed, proved) = (list_changes(file, request), proof_text(proof));
    let Proof { poses: [grid_poses, random_poses], position, rotation, .. } = *proof;
    let misfit = |m: &Misfit| MisfitSize { name: m.error.to_string(), off: m.size };
    ConvertResult {
        conventions: request.conventions,
        errors: changes(file, &conversion.parts).iter().map(ConvertedError::of).collect(),
        misfits: conversion.misfits.iter().map(misfit).collect(),
        proof: ConversionProof {
            grid_poses,
            random_poses,
            position_mm: position,
            rotation_rad: rotation,
            bound_mm: request.within_mm,
            bound_rad: request.within_mm * 1e-3,
        },
        machine,
        machine_file: with_provenance(&conversion.parts, &provenance(file, &changed, &proved)),
        changed,
        proved,
    }
}

fn request(file: &MachineFile, options: &ConvertOptions) -> Result<ConversionRequest, Diagnostic> {
    let now = *file.conventions();
    let conventions = options.to.as_deref().map_or(Ok(now), |text| {
        now.amend(text).map_err(|why| {
            let message = format!("`{}`: {}", shown(text), shown(&why.to_string()));
            let help = format!("write one of {}, or keys as in a machine file", Conventions::words().join(", "));
            Diagnostic::new(codes::E0528, message).help(help)
        })
    })?;
    let datum = options.datum.as_deref().map(|name| datum(file, name)).transpose()?;
    Ok(ConversionRequest { conventions, datum, within_mm: options.within_mm.unwrap_or(ROUNDING).max(ROUNDING) })
}

fn datum(file: &MachineFile, name: &str) -> Result<AxisName, Diagnostic> {
    let named = |axis: &&Axis| axis.name.as_str() == name;
    file.axes().iter().find(named).map(|axis| axis.name.clone()).ok_or_else(|| {
        let axes: Vec<&str> = file.axes().iter().map(|axis| axis.name.as_str()).collect();
        let message = format!("the machine has no axis `{}`", shown(name));
        Diagnostic::new(codes::E0528, message).help(format!("its axes are {}", axes.join(", ")))
    })
}

/// Returns the machine of the text: the proof is about the written file.
fn reload(call: &mut Call, text: &str) -> Result<MachineFile, Refused> {
    read_back(text).or_else(|why| {
        let message = format!("the converted machine is refused: {}", shown(&why.to_string()));
        let help = "an error that is plausible in one convention need not be in another: check the large ones; and all \
                    tables are in the new file, which has its limits: thin long ones out";
        call.refuse(Diagnostic::new(codes::E0529, message).help(help))
    })
}

fn list_changes(file: &MachineFile, request: &ConversionRequest) -> Vec<String> {
    let mut all = file.conventions().changes(&request.conventions);
    all.extend(request.datum.iter().map(|axis| format!("datum machine frame -> {axis}")));
    if all.is_empty() { vec!["nothing to convert".to_owned()] } else { all }
}

/// The source of the numbers in the file. No date: the same input gives the same bytes.
fn provenance(file: &MachineFile, changed: &[String], proved: &str) -> Vec<(String, String)> {
    let name = file.path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let tame = |text: &str| shown(text).chars().take(180).collect::<String>();
    vec![
        ("converted-by".to_owned(), format!("abbe {}", env!("CARGO_PKG_VERSION"))),
        ("converted-from".to_owned(), tame(&name)),
        ("converted-conventions".to_owned(), tame(&changed.join("; "))),
        ("converted-proof".to_owned(), proved.to_owned()),
    ]
}

fn proof_text(proof: &Proof) -> String {
    let Proof { poses: [grid, random], position, rotation, .. } = proof;
    format!(
        "largest difference {position:.1e} mm and {rotation:.1e} rad over {grid} poses of a grid and {random} random \
         ones"
    )
}

/// The refusal of a conversion: its reasons, the difference, and the bound that would accept it.
fn inexact(old: &Machine, request: &ConversionRequest, conversion: &Conversion, proof: &Proof) -> Diagnostic {
    let message = format!(
        "the machine cannot be converted {}: the two differ by up to {} and {}",
        if request.within_mm > ROUNDING { "as exactly as that" } else { "exactly" },
        small(proof.position, "m"),
        small(proof.rotation * 1e3, "rad"),
    );
    let mut why = Vec::new();
    if old.conventions().joints != request.conventions.joints {
        why.push("a linearised joint with an angular error stretches, an orthogonal one does not".to_owned());
    }
    let mut list: Vec<&Misfit> = conversion.misfits.iter().collect();
    list.sort_by(|a, b| b.size.total_cmp(&a.size));
    let one = |m: &&Misfit| {
        let unit = if m.error.direction.is_rotation() { small(m.size * 1e3, "rad") } else { small(m.size, "m") };
        format!("{} ({}, {unit} off)", m.error, m.nature)
    };
    if !list.is_empty() {
        let names: Vec<String> = list.iter().take(3).map(one).collect();
        let more = if list.len() > 3 { format!(" and {} more", list.len() - 3) } else { String::new() };
        why.push(format!("no curve of the language can hold these: {}{more}", names.join(", ")));
    }
    if why.is_empty() && proof.one_sided[0] <= request.within_mm && proof.one_sided[1] <= request.within_mm * 1e-3 {
        why.push(
            "each direction of approach comes out the same, but the mean of two products is not the product of \
         the means"
                .to_owned(),
        );
    } else if why.is_empty() {
        why.push("the location errors of linearised joints have no product that is one".to_owned());
    }
    let enough = round_up(proof.position.max(proof.rotation * 1e3));
    let help = format!("{}; `--within \"{}\"` would accept it", why.join("; "), small(enough, "m"));
    Diagnostic::new(codes::E0526, message).help(help)
}

/// A small length (mm) or angle (mrad) in nano-units or larger.
fn small(milli: f64, unit: &str) -> String {
    let nano = milli * 1e6;
    match nano {
        n if n >= 1e6 => format!("{} m{unit}", significant(n * 1e-6, 3)),
        n if n >= 1e3 => format!("{} u{unit}", significant(n * 1e-3, 3)),
        n if n >= 1e-3 => format!("{} n{unit}", significant(n, 3)),
        n => format!("{n:.1e} n{unit}"),
    }
}

/// The next of 1, 2, 5 with zeros.
fn round_up(value: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(value)));
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * decade).find(|step| *step >= value * 1.05).unwrap_or(20.0 * decade)
}

/// The text of the file; entries of an earlier conversion are replaced.
fn with_provenance(parts: &MachineParts, entries: &[(String, String)]) -> String {
    let mut parts = parts.clone();
    parts.provenance.entries.retain(|(key, _)| !entries.iter().any(|(own, _)| own == key));
    machine_file(&parts, entries)
}
