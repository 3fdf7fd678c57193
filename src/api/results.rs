//! Results of the functions, and their parts. Serde writes results in the shapes that docs/formats.md describes.

pub use super::bounded::{AddedByBounds, AddedDeviation};
pub use super::budget::BudgetResult;
pub use super::budget_parts::BudgetShard;
pub use super::budgets::ComparedBudgets;
pub use super::certificate::{CertificateReport, CertificateStep};
pub use super::check::CheckedFile;
pub use super::classify::{Classification, MotionWithErrors, NoMotion, SixErrors};
pub use super::compare::{CompareResult, ComparedBounds, ComparedMachine, ComparedPose, ErrorContribution};
pub use super::compile::CompiledSet;
pub use super::compiled_model::{DeviationColumns, DeviationSlices, PoseDeviation};
pub use super::compose::{ComposedPart, ComposedSet};
pub use super::convert::{ConversionProof, ConvertResult, ConvertedError, MisfitSize};
pub use super::diff::{AxisDifference, SetDifference};
pub use super::diff_machines::{MachineDifference, PropertyDifference};
pub use super::effects::{ErrorEffect, Neglected};
pub use super::enumerate::{EnumerateResult, RankedArrangements, StudyProgress};
pub use super::equations::EquationsResult;
pub use super::eval::{EvalResult, EvalUnits, PoseResult};
pub use super::explain::Explanation;
pub use super::features::{DominatingError, FeatureResult};
pub use super::figures::{
    BothSenses, CauseTest, CircleTest, DiagonalTest, DiagonalsTest, DriftOf, DriftTest, MotionTest, RotationTest,
    SpikeTest, TemperatureRange, TestFigures, TurningTest, UncertainValue,
};
pub use super::goal::{NewTolerance, ToleranceGoal};
pub use super::identify::{
    ExpectedParameter, FittedDatum, FittedError, FittedParameter, FormOfAxis, IdentifyResult, KindResidual, KnownValue,
    LackOfFit, MeasurementPlan, MonomialCoefficient, MonomialComponent, MonomialFit, NamedSvg, OrderShares,
    OutlierPlace, PlannedPose, PredictedUncertainty, RepeatedReadings, ResidualTest, Rms, RmsBeforeAfter,
    ScatterOfKind, SharedUncertainty,
};
pub use super::import::{
    ImportResult, ImportedChannel, ImportedError, LeftOutColumn, LeftOutRow, ReferenceMaterial, StraightnessReference,
};
pub use super::instrument::{InstrumentResult, Readings};
pub use super::locate::{AxisLine, LocateResult, LocatedAxis, LocatedError};
pub use super::machine_file::InputFile;
pub use super::map::{BodyDiagonal, MapResult, Uncompensated, WorstPose};
pub use super::map_bounds::{MapFromBounds, WorstBoundedPose};
pub use super::poses::AxisPositions;
pub use super::positioning::{AccuracyUncertainties, MeasuredTarget, OneWayAccuracy, OneWayBoth, ReadAtTarget};
pub use super::reach::{ReachDirections, ReachResult};
pub use super::record::{AlarmState, ErrorTrend, Record, RecordCheck, RecordTrend, TrendPoint, TrendRecord, TrendStep};
pub use super::report::Report;
pub use super::show::{Arm, ChainAxis, ChainResult, ChainTool, LocationError, LocationErrors, OtherSide};
pub use super::sources::{ErrorSource, ErrorSources};
pub use super::summary::{AxisSummary, ErrorCounts, MachineSummary};
pub use super::targets::{TargetCertainty, TargetSummary};
pub use super::tool_poses::{BeyondTravel, Lack, MissedToolPose, NeededTravel, ReachedToolPoses};
pub use super::uncertainty::{CertificateBands, ComparedBands, PoseUncertainty};
pub use crate::analysis::Status as LocationStatus;
pub use crate::analysis::budget::{
    Binding, Bound, BoundedDeviation, BoundedLength, Budget, BudgetPart, CheapestTolerances, Contribution, PERCENTS,
    PairedDifference, Percentile, Role, Totals, Verdict, VersusFirst,
};
pub use crate::analysis::enumerate::{ArrangementRow, NeededRange, Ranking, RoundCount};
pub use crate::analysis::instrument::{BallBar, Diagonal, RTest};
pub use crate::analysis::{Bands, SummaryBand};
pub use crate::controller::{
    Certificate, CompensationDegree, ControllerTarget, Figures, ProgrammingFigures, ROUNDING_UM, SingleErrorResidual,
};
pub use crate::diagnostic::{Severity, Sources};
pub use crate::evaluate::{Difference, Statistics, Summary};
pub use crate::machine::{Axis, AxisKind, Branch, ErrorId, ErrorKind, ErrorTerm, Machine, Sense, Travel};
pub use crate::report::page::RenderedPage;
pub use crate::report::record::{
    AlarmLimit, Contact, CopiedFile, Dates, Day, ErrorCurve, ErrorRow, Instrument, LimitDecision, Line, MachineState,
    NoValue, Person, Place, Plate, RecordData, RecordedFigure, RecordedFigures, RecordedSet, StateValue, Temperature,
    TwoLetters,
};
pub use crate::report::{BoundedFigures, LengthDifference, Picture, PictureFailure, RssDifference};
pub use crate::standards::{Conformity, LimitSides};
pub use crate::syntax::{FolderEntry, ReadFailure};
