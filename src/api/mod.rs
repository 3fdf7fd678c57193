//! The façade: one function for each job, from a machine file to certified tables.
//!
//! Every function takes a [`MachineFile`] (or several), a plain struct of options with defaults, and a [`Run`], which
//! says where files are read and who hears of progress. It returns an [`Answer`]: the value, which serde can write in
//! the shape that docs/formats.md describes, and the warnings; or the [`Diagnostics`] that refuse the input.
//!
//! Nothing here prints, writes a file, reads the clock or the environment. What a job writes, it hands over as bytes or
//! into the sinks that the caller gave it.

mod algebra;
mod budget;
mod budgets;
mod certificate;
mod check;
mod classify;
mod compare;
pub(crate) mod compensation;
mod compile;
mod compiled_model;
mod convert;
mod diff;
mod effects;
mod enumerate;
mod equations;
mod eval;
mod explain;
mod identify;
mod import;
mod instrument;
mod machine_file;
mod map;
mod map_tables;
mod plane_picture;
pub(crate) mod poses;
pub(crate) mod run;
mod show;
mod starter;
mod study;
mod summary;
mod targets;
pub(crate) mod tolerances;
mod tool_poses;
mod verify;

pub use budget::{BudgetOptions, BudgetResult, budget};
pub use budgets::ComparedBudgets;
#[cfg(feature = "cli")]
pub(crate) use budgets::{DrawnMachines, budgets};
pub use certificate::CertificateReport;
pub use check::{CheckedFile, annotations, check};
pub use classify::{Classification, ClassifyOptions, MotionWithErrors, NoMotion, SixErrors, classify};
pub use compare::{CompareOptions, CompareResult, ComparedMachine, ComparedPose, ErrorContribution, compare};
pub use compensation::options::{CompensationOptions, CorrectingAxes};
pub use compile::{CompileOptions, CompiledSet, compile};
pub use compiled_model::{CompiledModel, DeviationColumns, PoseDeviation, compile_model};
pub use convert::{ConversionProof, ConvertOptions, ConvertResult, ConvertedError, MisfitSize, convert};
pub use diff::{AxisDifference, DiffOptions, SetDifference, diff};
pub use effects::{ErrorEffect, Neglected};
pub use enumerate::{EnumerateOptions, EnumerateResult, JudgedBy, RankedArrangements, StudyProgress, enumerate};
pub use equations::{EquationsOptions, EquationsResult, equations};
pub use eval::{EvalOptions, EvalResult, EvalUnits, PoseResult, eval};
pub use explain::{Explanation, explain};
pub use identify::{
    ExpectedParameter, FittedParameter, IdentifyOptions, IdentifyResult, KindResidual, MeasurementPlan,
    MonomialCoefficient, MonomialComponent, MonomialFit, NamedSvg, OrderShares, OutlierPlace, PlanOptions, PlannedPose,
    RepeatedReadings, ResidualTest, Rms, RmsBeforeAfter, ScatterOfKind, fit_monomials, identify, plan_measurements,
};
pub use import::{ImportOptions, ImportResult, ImportedError, LeftOutRow, import};
pub use instrument::{Instrument, InstrumentOptions, InstrumentResult, Readings, instrument};
#[cfg(feature = "cli")]
pub(crate) use machine_file::bounded_only;
pub use machine_file::{LoadOptions, MachineFile, load, loads};
pub use map::{BodyDiagonal, MapOptions, MapPoses, MapResult, Uncompensated, WorstPose, map, map_tables};
pub use map_tables::MapTable;
pub use plane_picture::{PlaneComponent, PlaneDrawing, PlaneOptions};
pub use poses::{AxisPositions, axes_text};
pub use run::{Answer, Monitor, Run};
pub use show::{
    Arm, ChainAxis, ChainResult, ChainTool, LocationError, LocationErrors, chain_dot, chain_picture, error_curves, show,
};
pub use starter::{Starter, schema, starter};
pub use study::StudyFile;
pub use summary::{AxisSummary, ErrorCounts, MachineSummary, summary};
pub use targets::{TargetCertainty, TargetSummary, targets};
pub use tolerances::ToleranceOptions;
pub use tool_poses::{MissedToolPose, ReachedToolPoses};
pub use verify::{ReplayPosition, VerifyOptions, replay, set_manifest, verify};

pub use crate::analysis::budget::{
    Bound, Budget, BudgetPart, Contribution, Distribution, PERCENTS, Percentile, Statistic, Totals,
};
pub use crate::analysis::enumerate::{Ranking, Row as ArrangementRow};
pub use crate::analysis::instrument::{BallBar, CirclePlane, Diagonal, RTest};
pub use crate::analysis::{Naming, Status as LocationStatus};
pub use crate::compensation::{Fit, Goal, Stored};
pub use crate::controller::{
    Certificate, ControllerTarget, ErrorLeft, Figures, Handled, Hashed, Limits, Lock, ROUNDING_UM, RenderedFile, micro,
};
pub use crate::diagnostic::{Diagnostic, Diagnostics, Severity, codes, shown};
pub use crate::evaluate::{Frame, Order, Statistics, Summary, UnknownOrder};
pub use crate::machine::{Approach, Axis, AxisKind, Branch, Machine, Sense};
pub use crate::report::{Picture, PictureFailure, RowFormat as TableForm, Sink, tolerance, tolerance_unit};
pub use crate::syntax::{Disk, Files, MemoryFiles};
pub use crate::units::{angle, length, number, significant};

/// The order asked for, or the one that the conventions of the machine name.
fn order_of(machine: &Machine, order: Option<Order>) -> Order {
    order.unwrap_or_else(|| machine.conventions().default_order.map_or(Order::Exact, Order::Degree))
}
