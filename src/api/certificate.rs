//! A certificate with the machine, the target and the files that it holds for.

use super::uncertainty::CertificateBands;
use crate::controller::{
    BallCheck, Certificate, ControllerTarget, Depth, DriveDemand, Figures, Judgement, KinematicsModule,
    ProgrammingFigures, RaisedFigure, SignTrials, SingleErrorResidual, Strongest, TablesUnderTest, ZeroShift,
    ball_checks, drive_demands, figures, judge_by, micro,
};
use crate::evaluate::{Bare, Field, Order, Summary};
use crate::file_set::restore::Restored;
use crate::file_set::verdict;
use crate::identify::second::SecondMeasurement;
use crate::job::job_file::{Job, JobPaths};
use crate::job::machine_file::MachineFile;
use crate::job::over::{Over, OverKind};
use crate::job::reference::{Reference, ReferenceKind, SetUp};
use crate::job::reference_text::ReferenceOption;
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::{Approach, Axis, AxisKind, AxisPositions, Machine, OperatingConditions, Pose};
use crate::run::{Call, Refused};
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A job over which a certificate has figures besides those over the volume.
#[derive(Debug, Clone, Default, PartialEq, Serialize, serde::Deserialize, JsonSchema)]
#[serde(default)]
pub struct CertifiedWork {
    /// A file of tool poses: CSV or APT CL data.
    pub tool_poses: Option<PathBuf>,
    /// A job file instead of the tool poses.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out; by default the zero at the part's origin.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
}

/// The poses of a job and its set-up.
struct WorkOfCertificate {
    reached: ReachedToolPoses,
    set_up: SetUp,
}

/// The poses by which a certificate judges.
pub(crate) struct CertificateScope {
    /// Those over the volume.
    pub depth: Depth,
    /// Those of a job besides.
    job: Option<WorkOfCertificate>,
    /// True if the figures over the volume are in machine coordinates, whatever the data behind the errors hold.
    in_machine: bool,
}

impl CertificateScope {
    /// Returns what a machine with files is judged over, and the figures without and with them: over the job, if there
    /// is one, or else over the volume.
    pub(crate) fn judge(&self, machine: &Machine, field: &dyn Field) -> (Over, Judgement) {
        if let Some(work) = &self.job {
            return work.judge(machine, field);
        }
        let poses = self.depth.poses(machine);
        let set_up = match self.in_machine {
            true => SetUp::machine(),
            false => SetUp::less_unheld(machine, machine.unheld(), &poses),
        };
        let over = Over::new(OverKind::Volume, machine, &set_up.reference, [poses.len(); 2]);
        (over, judge(field, &set_up, &poses))
    }
}

impl WorkOfCertificate {
    fn judge(&self, machine: &Machine, field: &dyn Field) -> (Over, Judgement) {
        let over = Over::work(machine, &self.set_up.reference, Some(&self.reached), 0);
        (over, judge(field, &self.set_up, &self.reached.poses))
    }
}

impl CertifiedWork {
    /// Returns the files of the job.
    pub(crate) fn job_paths(&self) -> JobPaths<'_> {
        JobPaths { job: self.job.as_deref(), tool_poses: self.tool_poses.as_deref(), axis_poses: None, path: self.path }
    }

    /// Returns the scope with the job, if there is one.
    pub(crate) fn scope(
        &self,
        call: &mut Call<'_>,
        machine: &MachineFile,
        depth: Depth,
    ) -> Result<CertificateScope, Refused> {
        let job = self.read(call, machine)?;
        let is_machine = |of: &Reference| of.kind == ReferenceKind::Machine;
        let in_machine = job.is_none() && self.reference.as_ref().is_some_and(is_machine);
        Ok(CertificateScope { depth, job, in_machine })
    }

    fn read(&self, call: &mut Call<'_>, machine: &MachineFile) -> Result<Option<WorkOfCertificate>, Refused> {
        let paths = self.job_paths();
        let Some(job) = paths.read(call, machine)? else {
            let of_volume = [ReferenceKind::Machine, ReferenceKind::MachineLessUnheld];
            if self.reference.as_ref().is_some_and(|of| !of_volume.contains(&of.kind)) {
                return call.usage("the certificate over the volume is in machine coordinates: give a job too");
            }
            return Ok(None);
        };
        let reached = job.poses.reached(call, machine)?;
        let set_up = Job::set_up(Some(&job), call, machine, self.reference.as_ref(), &reached.poses)?;
        Ok(Some(WorkOfCertificate { reached, set_up }))
    }
}

/// Figures of a certificate over a job, without what the set-up of the part takes out.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct JobCertificate {
    /// Poses and reference that they are over.
    pub over: Over,
    /// The side of approach that is worse.
    pub direction: Approach,
    /// Without the files.
    pub uncompensated: Figures,
    /// With the files: the part is set up on the machine as it runs.
    pub compensated: Figures,
    /// Figures that the files raise.
    pub raised: Vec<RaisedFigure>,
}

impl JobCertificate {
    fn new(machine: &Machine, field: &dyn Field, work: &WorkOfCertificate) -> Self {
        let (over, judged) = work.judge(machine, field);
        let Judgement { approach: direction, uncompensated, compensated, raised } = judged;
        Self { over, direction, uncompensated, compensated, raised }
    }

    /// Returns in words which figures of the position deviation the files raise; `None` if they raise none.
    pub fn raised(&self) -> Option<String> {
        verdict::raise_remark(&self.raised)
    }
}

/// Figures of a certificate where curves were not measured: beyond their points they go on as the machine file says.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CertificateBeyond {
    /// The measured ranges, by axis, mm and deg.
    pub measured: BTreeMap<String, [f64; 2]>,
    /// Number of poses beyond one of them.
    pub poses: usize,
    /// The side of approach that is worse.
    pub direction: Approach,
    /// Without the files.
    pub uncompensated: Figures,
    /// With the files.
    pub compensated: Figures,
}

impl CertificateBeyond {
    /// Returns the figures; `None` if the volume is measured everywhere.
    fn of(field: &dyn Field, set_up: &SetUp, depth: Depth) -> Option<Self> {
        let machine = field.machine();
        let poses = depth.poses_beyond(machine);
        let range = |axis: &Axis| Some((axis.name.to_string(), machine.measured_range(&axis.name)?.into()));
        let measured = machine.axes().iter().filter_map(range).collect();
        (!poses.is_empty()).then(|| {
            let Judgement { approach: direction, uncompensated, compensated, .. } = judge(field, set_up, &poses);
            Self { measured, poses: poses.len(), direction, uncompensated, compensated }
        })
    }
}

/// Returns the figures without and with files at poses (mm, deg), without what a set-up takes out; `field` is the
/// machine with the files.
fn judge(field: &dyn Field, set_up: &SetUp, poses: &[Pose]) -> Judgement {
    let bare = Bare { machine: field.machine(), order: Order::Exact };
    let of = |field: &dyn Field, conditions: OperatingConditions| {
        let set_up = set_up.field(field, Order::Exact, conditions);
        figures(set_up.as_ref().map_or(field, |of| of as &dyn Field), poses, conditions)
    };
    judge_by(field.machine(), &|approach: Approach| {
        [&bare as &dyn Field, field].map(|field| of(field, approach.into()))
    })
}

/// Returns a certificate with the figures over the volume without the motions that the data behind the errors do not
/// hold, and the set-up that takes them out.
pub(crate) fn without_unheld(
    machine: &Machine,
    certificate: Certificate,
    field: &dyn Field,
    depth: Depth,
) -> (Certificate, SetUp) {
    if machine.unheld().is_empty() {
        return (certificate, SetUp::machine());
    }
    let poses = depth.poses(machine);
    let set_up = SetUp::less_unheld(machine, machine.unheld(), &poses);
    let Judgement { approach, uncompensated, compensated, raised } = judge(field, &set_up, &poses);
    (Certificate { approach, uncompensated, compensated, raised, straight: None, ..certificate }, set_up)
}

/// Returns the figures of a certificate over the volume without the motions that the data behind the errors do not
/// hold, for a field of the machine with files; `None` if the data hold them all.
pub(crate) fn figures_without_unheld(
    machine: &Machine,
    field: &dyn Field,
    scope: &CertificateScope,
) -> Option<Figures> {
    let poses = scope.depth.poses(machine);
    if scope.in_machine {
        return None;
    }
    let set_up = SetUp::less_unheld(machine, machine.unheld(), &poses);
    set_up.removed().map(|_| judge(field, &set_up, &poses).compensated)
}

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
    /// Poses and reference of the figures: the volume.
    pub over: Over,
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
    /// Motions that the files add at home, or with all axes at 0 where the machine file does not state `home` for each.
    pub at_reference: AtReference,
    /// Errors that the controller cannot correct, in words.
    pub cannot: Vec<String>,
    /// Figures with straight lines between points, where the control has them as an option; `compensated` is then with
    /// steps, in the worst place of each section.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub straight: Option<Figures>,
    /// Figures for each form of the tool direction, where the controller transforms.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub programming: Vec<ProgrammingFigures>,
    /// Demands of a kinematics module on the drives while a rotary axis turns and the tip stands on the part.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<DriveDemand>,
    /// Angle from a pole within which a kinematics module bounds rotary corrections, deg.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pole_zone_deg: Option<f64>,
    /// Touches of a ball by which loaded kinematic parameters are checked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ball_checks: Vec<BallCheck>,
    /// Figures after each step of a composed set, the last for all of it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<CertificateStep>,
    /// Content of the set that takes these files back, in the folder `restore` beside them; none where files are judged
    /// that are there already.
    #[serde(skip)]
    pub restore: Option<Restored>,
    /// The figures beyond the measured ranges, over which the others are, where these are less than the volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond_measured: Option<CertificateBeyond>,
    /// The figures over a job, if one was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub job: Option<JobCertificate>,
    /// Intervals of the figures, where the machine file states uncertainties of errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<CertificateBands>,
    /// The verdict of a second measurement, with the set in force, if there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second: Option<Box<SecondMeasurement>>,
    /// The machine, with the tool that the set holds for.
    #[serde(skip)]
    pub machine: Machine,
    /// The controller.
    #[serde(skip)]
    pub controller: ControllerTarget,
    /// The entry by which the sign is best tested; none if nothing is corrected.
    #[serde(skip)]
    pub strongest: Option<Strongest>,
    /// Sign tests of kinematic parameters; none of other mechanisms.
    #[serde(skip)]
    pub sign_trials: Option<SignTrials>,
}

/// Motions that files add at home, or with all axes at 0, by axis, mm and deg.
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
    /// Returns the report; `field` is the machine with the files.
    pub(crate) fn new(
        machine: &Machine,
        target: &ControllerTarget,
        certificate: Certificate,
        field: &dyn Field,
        scope: &CertificateScope,
        files: Vec<String>,
    ) -> Self {
        let (certificate, set_up) = match scope.in_machine {
            true => (certificate, SetUp::machine()),
            false => without_unheld(machine, certificate, field, scope.depth),
        };
        let uncertainty = CertificateBands::of(machine, &certificate, field, scope.depth, &set_up);
        let [forward, reverse] = certificate.at_reference.map(|added| by_name(machine, &added));
        Self {
            reference_shift: certificate.shifted.map(|shift| ReferenceShift::new(machine, shift)),
            raised: certificate.raised,
            target: target.manifest.target.clone(),
            files,
            over: Over::new(OverKind::Volume, machine, &set_up.reference, [certificate.poses; 2]),
            poses: certificate.poses,
            direction: certificate.approach,
            tool: machine.tool().name.clone(),
            uncompensated: certificate.uncompensated,
            compensated: certificate.compensated,
            errors: certificate.errors.into_iter().map(|error| (error.error.to_string(), error)).collect(),
            single_error_poses: certificate.single_error_poses,
            at_reference: AtReference { forward, reverse },
            cannot: target.manifest.cannot.clone(),
            straight: certificate.straight,
            programming: certificate.programming,
            steps: Vec::new(),
            restore: None,
            drives: Vec::new(),
            pole_zone_deg: None,
            ball_checks: Vec::new(),
            beyond_measured: CertificateBeyond::of(field, &set_up, scope.depth),
            job: scope.job.as_ref().map(|work| JobCertificate::new(machine, field, work)),
            uncertainty,
            second: None,
            machine: machine.clone(),
            controller: target.clone(),
            strongest: certificate.strongest,
            sign_trials: certificate.sign_trials,
        }
    }

    /// Adds what a kinematics module asks of the drives, and the check of its parameters by a ball.
    pub(crate) fn with_module(mut self, machine: &Machine, module: &KinematicsModule, beside: TablesUnderTest) -> Self {
        self.drives = drive_demands(machine, module);
        self.pole_zone_deg = module.pole_zone_deg().filter(|_| self.drives.iter().any(|of| of.acceleration > 0.0));
        if let Some(parameters) = module.parameters() {
            self.ball_checks = ball_checks(machine, parameters, beside, Approach::Mean.into());
        }
        self
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
