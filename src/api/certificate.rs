//! A certificate with the machine, the target and the files that it holds for.

use super::uncertainty::CertificateBands;
use crate::controller::{Certificate, ControllerTarget, Depth, Figures, RaisedFigure, ZeroShift, micro};
use crate::evaluate::Field;
use crate::file_set::verdict;
use crate::machine::{AxisKind, Machine};
use serde_json::{Map, Value, json};

/// Residual of a machine after a controller has applied a set of files.
#[derive(Debug, Clone)]
pub struct CertificateReport {
    /// The machine, with the tool that the set holds for.
    pub machine: Machine,
    /// The controller.
    pub target: ControllerTarget,
    /// The figures.
    pub certificate: Certificate,
    /// Names of the files.
    pub files: Vec<String>,
    /// Figures after each step of a composed set, the last for all of it; empty for other sets.
    pub steps: Vec<CertificateStep>,
    /// Intervals of the figures, where the machine file states uncertainties of errors.
    pub uncertainty: Option<CertificateBands>,
}

/// Figures after a step of a composed set.
#[derive(Debug, Clone)]
pub struct CertificateStep {
    /// Names of the targets so far.
    pub target: String,
    /// Figures with them.
    pub compensated: Figures,
}

impl CertificateReport {
    pub(crate) fn new(
        machine: &Machine,
        target: &ControllerTarget,
        certificate: &Certificate,
        (field, depth): (&dyn Field, Depth),
        files: Vec<String>,
    ) -> Self {
        let uncertainty = CertificateBands::of(machine, certificate, field, depth);
        let (machine, target, certificate) = (machine.clone(), target.clone(), certificate.clone());
        Self { machine, target, certificate, files, steps: Vec::new(), uncertainty }
    }

    /// Returns in words which figures of the position deviation the files raise; `None` if they raise none.
    pub fn raised(&self) -> Option<String> {
        verdict::raised(&self.certificate)
    }

    /// The contract of `compile` and `verify` in docs/formats.md.
    fn json(&self) -> serde_json::Value {
        let Self { machine, target, certificate, files, steps, uncertainty } = self;
        let summary = |f: &Figures| {
            json!({"position_um": f.all.position_um, "rotation_urad": f.all.rotation_urad,
            "tool_axis_urad": f.tool_axis})
        };
        let errors: serde_json::Map<_, _> = certificate
            .errors
            .iter()
            .map(|e| {
                (e.error.to_string(), json!({"handled": e.degree, "left_um": e.residual_um, "alone_um": e.alone_um}))
            })
            .collect();
        let shifted = certificate.shifted.as_ref();
        let shift = |s: &ZeroShift| {
            let of = |kind: AxisKind| -> serde_json::Map<_, _> {
                let axes = machine.axes().iter().zip(&s.shift).filter(|(axis, _)| axis.kind == kind);
                axes.map(|(axis, shift)| (axis.name.to_string(), json!(shift * micro(kind).0))).collect()
            };
            json!({"shift_um": of(AxisKind::Linear), "shift_urad": of(AxisKind::Rotary),
                "position_um": s.position_um, "without_tables_um": s.alone_um})
        };
        let raised = |r: &RaisedFigure| {
            json!({"direction": r.approach, "figure": r.figure, "before_um": r.before,
            "after_um": r.after})
        };
        let mut contract = json!({
            "reference_shift": shifted.map(shift), "raised": certificate.raised.iter().map(raised).collect::<Vec<_>>(),
            "target": target.manifest.target, "files": files, "poses": certificate.poses,
            "direction": certificate.approach, "tool": machine.tool().name,
            "uncompensated": summary(&certificate.uncompensated), "compensated": summary(&certificate.compensated),
            "errors": errors, "single_error_poses": certificate.single_error_poses,
            "at_reference": {"forward": named(machine, &certificate.at_reference[0]), "reverse": named(machine,
                &certificate.at_reference[1])},
            "cannot": target.manifest.cannot,
        });
        let programming: Vec<Value> = certificate
            .programming
            .iter()
            .map(|way| {
                json!({"tool_direction": if way.vectors { "vector" } else { "rotary axes" }, "tool": way.tool,
                    "longer_mm": way.longer_mm,
                    "uncompensated": summary(&way.uncompensated), "compensated": summary(&way.compensated),
                    "at_poles": way.at_poles, "away_from_poles": way.away_from_poles.as_ref().map(&summary)})
            })
            .collect();
        if let (false, Some(contract)) = (programming.is_empty(), contract.as_object_mut()) {
            let _ = contract.insert("programming".to_owned(), json!(programming));
        }
        let steps: Vec<Value> = steps
            .iter()
            .map(|step| json!({"target": step.target, "compensated": summary(&step.compensated)}))
            .collect();
        if let (false, Some(contract)) = (steps.is_empty(), contract.as_object_mut()) {
            let _ = contract.insert("steps".to_owned(), json!(steps));
        }
        if let (Some(bands), Some(contract)) = (uncertainty, contract.as_object_mut()) {
            let _ = contract.insert("uncertainty".to_owned(), json!(bands));
        }
        contract
    }
}

impl serde::Serialize for CertificateReport {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.json().serialize(serializer)
    }
}

/// Values by the names of the axes.
fn named(machine: &Machine, values: &[f64]) -> Map<String, Value> {
    let names = machine.axes().iter().map(|axis| axis.name.to_string());
    names.zip(values).map(|(name, value)| (name, json!(value))).collect()
}
