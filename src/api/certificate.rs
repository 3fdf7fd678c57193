//! A certificate with the machine, the target and the files that it holds for.

use super::uncertainty::CertificateBands;
use crate::controller::{
    Certificate, ControllerTarget, Depth, Figures, ProgrammingFigures, RaisedFigure, SingleErrorResidual, Strongest,
    ZeroShift, micro,
};
use crate::evaluate::{Field, Summary};
use crate::file_set::verdict;
use crate::machine::{Approach, AxisKind, AxisPositions, Machine};
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Serialize;

/// Residual of a machine after a controller has applied a set of files.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct CertificateReport {
    /// Displacement of the reference that the controller does not see; none for most.
    pub reference_shift: Option<ReferenceShift>,
    /// Figures that the files raise.
    pub raised: Vec<RaisedFigure>,
    /// Name of the target.
    pub target: String,
    /// Names of the files.
    pub files: Vec<String>,
    /// Number of poses.
    pub poses: usize,
    /// The side of approach that is worse.
    pub direction: Approach,
    /// Name of the tool; may be empty.
    pub tool: String,
    /// Without the files.
    pub uncompensated: Figures,
    /// With the files.
    pub compensated: Figures,
    /// The errors by name.
    pub errors: IndexMap<String, SingleErrorResidual>,
    /// Number of poses for single errors.
    pub single_error_poses: usize,
    /// Motions that the files add with all axes at 0.
    pub at_reference: AtReference,
    /// Errors that the controller cannot correct, in words.
    pub cannot: Vec<String>,
    /// Figures for each form of the tool direction, where the controller transforms.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub programming: Vec<ProgrammingFigures>,
    /// Figures after each step of a composed set, the last for all of it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<CertificateStep>,
    /// Intervals of the figures, where the machine file states uncertainties of errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<CertificateBands>,
    /// The machine, with the tool that the set holds for.
    #[serde(skip)]
    pub machine: Machine,
    /// The controller.
    #[serde(skip)]
    pub controller: ControllerTarget,
    /// The entry by which the sign is best tested; none if nothing is corrected.
    #[serde(skip)]
    pub strongest: Option<Strongest>,
}

/// Motions that files add with all axes at 0, by axis, mm and deg.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct AtReference {
    /// Approached forward.
    pub forward: AxisPositions,
    /// Approached in reverse.
    pub reverse: AxisPositions,
}

/// Displacement of the reference.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ReferenceShift {
    /// Shifts of the linear axes, um.
    pub shift_um: AxisPositions,
    /// Shifts of the rotary axes, urad.
    pub shift_urad: AxisPositions,
    /// Position deviation with it, um.
    pub position_um: Summary,
    /// Position deviation by it alone, um.
    pub without_tables_um: Summary,
}

/// Figures after a step of a composed set.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CertificateStep {
    /// Names of the targets so far.
    pub target: String,
    /// With their files.
    pub compensated: Figures,
}

impl CertificateReport {
    pub(crate) fn new(
        machine: &Machine,
        target: &ControllerTarget,
        certificate: Certificate,
        field: &dyn Field,
        depth: Depth,
        files: Vec<String>,
    ) -> Self {
        let uncertainty = CertificateBands::of(machine, &certificate, field, depth);
        let [forward, reverse] = certificate.at_reference.map(|added| by_name(machine, &added));
        Self {
            reference_shift: certificate.shifted.map(|shift| ReferenceShift::new(machine, shift)),
            raised: certificate.raised,
            target: target.manifest.target.clone(),
            files,
            poses: certificate.poses,
            direction: certificate.approach,
            tool: machine.tool().name.clone(),
            uncompensated: certificate.uncompensated,
            compensated: certificate.compensated,
            errors: certificate.errors.into_iter().map(|error| (error.error.to_string(), error)).collect(),
            single_error_poses: certificate.single_error_poses,
            at_reference: AtReference { forward, reverse },
            cannot: target.manifest.cannot.clone(),
            programming: certificate.programming,
            steps: Vec::new(),
            uncertainty,
            machine: machine.clone(),
            controller: target.clone(),
            strongest: certificate.strongest,
        }
    }

    /// Returns in words which figures of the position deviation the files raise; `None` if they raise none.
    pub fn raised(&self) -> Option<String> {
        verdict::raise_remark(&self.raised)
    }
}

impl ReferenceShift {
    fn new(machine: &Machine, ZeroShift { shift, position_um, alone_um }: ZeroShift) -> Self {
        let of = |kind: AxisKind| -> AxisPositions {
            let axes = machine.axes().iter().zip(&shift).filter(|(axis, _)| axis.kind == kind);
            axes.map(|(axis, shift)| (axis.name.to_string(), shift * micro(kind).0)).collect()
        };
        let (shift_um, shift_urad) = (of(AxisKind::Linear), of(AxisKind::Rotary));
        Self { shift_um, shift_urad, position_um, without_tables_um: alone_um }
    }
}

fn by_name(machine: &Machine, values: &[f64]) -> AxisPositions {
    machine.axes().iter().map(|axis| axis.name.to_string()).zip(values.iter().copied()).collect()
}
