//! The façade: one function for each job, from a machine file to certified tables.
//!
//! Every function takes a [`MachineFile`] (or several), a plain struct of options with defaults, and a [`Run`], which
//! says where files are read and who hears of progress. It returns an [`Answer`]: the value, which serde can write in
//! the shape that docs/formats.md describes, and the warnings; or the [`Diagnostics`] that refuse the input.
//!
//! Nothing here prints, writes a file, reads the clock or the environment. What a job writes, it hands over as bytes or
//! into the sinks that the caller gave it.

mod certificate;
mod check;
mod classify;
pub(crate) mod compensation;
mod compile;
mod convert;
mod diff;
mod explain;
mod identify;
mod import;
mod machine_file;
pub(crate) mod poses;
pub(crate) mod run;
mod starter;
mod summary;
mod targets;
mod verify;

pub use certificate::CertificateReport;
pub use check::{CheckedFile, annotations, check};
pub use classify::{Classification, ClassifyOptions, MotionWithErrors, NoMotion, SixErrors, classify};
pub use compensation::options::{CompensationOptions, CorrectingAxes};
pub use compile::{CompileOptions, CompiledSet, compile};
pub use convert::{ConversionProof, ConvertOptions, ConvertResult, ConvertedError, MisfitSize, convert};
pub use diff::{AxisDifference, DiffOptions, SetDifference, diff};
pub use explain::{Explanation, explain};
pub use identify::{
    ExpectedParameter, FittedParameter, IdentifyOptions, IdentifyResult, KindResidual, MeasurementPlan,
    MonomialCoefficient, MonomialComponent, MonomialFit, NamedSvg, OrderShares, OutlierPlace, PlanOptions, PlannedPose,
    RepeatedReadings, ResidualTest, Rms, RmsBeforeAfter, ScatterOfKind, fit_monomials, identify, plan_measurements,
};
pub use import::{ImportOptions, ImportResult, ImportedError, LeftOutRow, import};
pub use machine_file::{LoadOptions, MachineFile, load, loads};
pub use run::{Answer, Monitor, Run};
pub use starter::{Starter, schema, starter};
pub use summary::{AxisSummary, ErrorCounts, MachineSummary, summary};
pub use targets::{TargetCertainty, TargetSummary, targets};
pub use verify::{ReplayPosition, VerifyOptions, replay, set_manifest, verify};

pub use crate::compensation::{Fit, Goal, Stored};
pub use crate::controller::{
    Certificate, ControllerTarget, ErrorLeft, Figures, Handled, Hashed, Limits, Lock, ROUNDING_UM, RenderedFile, micro,
};
pub use crate::diagnostic::{Diagnostic, Diagnostics, Severity, codes};
pub use crate::evaluate::{Frame, Order, Statistics, Summary};
pub use crate::machine::{Approach, Axis, AxisKind, Machine};
pub use crate::syntax::{Disk, Files, MemoryFiles};
pub use crate::units::{number, significant};
