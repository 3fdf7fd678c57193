//! Results of the functions, and their parts. Serde writes results in the shapes that docs/formats/json.md describes.
//!
//! ## `check`, `show`
//! [`ChainResult`], [`CheckedFile`], [`InputFile`], [`Arm`], [`ChainAxis`], [`ChainTool`], [`LocationError`],
//! [`LocationErrors`], [`OtherSide`], [`AxisSummary`], [`ErrorCounts`], [`MachineSummary`], [`LocationStatus`].
//! ## `eval`
//! [`EvalResult`], [`PoseResult`], [`DeviationColumns`], [`DeviationSlices`], [`PoseDeviation`], [`ErrorEffect`],
//! [`Neglected`], [`EvalUnits`].
//! ## `equations`, `classify`
//! [`EquationsResult`], [`Classification`], [`MotionWithErrors`], [`NoMotion`], [`SixErrors`].
//! ## `convert`
//! [`ConvertResult`], [`ConversionProof`], [`ConvertedError`], [`MisfitSize`].
//! ## `map`
//! [`FeatureResult`], [`MapResult`], [`AddedByBounds`], [`AddedDeviation`], [`DominatingError`], [`BodyDiagonal`],
//! [`Uncompensated`], [`WorstPose`], [`MapFromBounds`], [`WorstBoundedPose`], [`AxisPositions`].
//! ## `reach`
//! [`ReachResult`], [`ReachDirections`].
//! ## `sources`
//! [`ErrorSource`], [`ErrorSources`].
//! ## `compare`
//! [`CompareResult`], [`ComparedBudgets`], [`ComparedBounds`], [`ComparedMachine`], [`ComparedPose`],
//! [`ErrorContribution`].
//! ## `budget`
//! [`BudgetResult`], [`BudgetShard`], [`NewTolerance`], [`ToleranceGoal`], [`Binding`], [`Bound`],
//! [`BoundedDeviation`], [`BoundedLength`], [`Budget`], [`BudgetPart`], [`CheapestTolerances`], [`Contribution`],
//! [`PERCENTS`], [`PairedDifference`], [`Percentile`], [`Role`], [`Totals`], [`Verdict`], [`VersusFirst`].
//! ## `enumerate`
//! [`EnumerateResult`], [`RankedArrangements`], [`StudyProgress`], [`NeededRange`], [`Ranking`], [`RoundCount`],
//! [`ArrangementRow`].
//! ## `instrument`
//! [`InstrumentResult`], [`Readings`], [`BallBar`], [`Diagonal`], [`RTest`].
//! ## `import`
//! [`ImportResult`], [`ImportedChannel`], [`ImportedError`], [`LeftOutColumn`], [`LeftOutRow`], [`ReferenceMaterial`],
//! [`StraightnessReference`], [`AccuracyUncertainties`], [`MeasuredTarget`], [`OneWayAccuracy`], [`OneWayBoth`],
//! [`ReadAtTarget`].
//! ## `figures`
//! [`BothSenses`], [`CauseTest`], [`CircleTest`], [`DiagonalTest`], [`DiagonalsTest`], [`DriftOf`], [`DriftTest`],
//! [`MotionTest`], [`RotationTest`], [`SpikeTest`], [`TemperatureRange`], [`TestFigures`], [`TurningTest`],
//! [`UncertainValue`].
//! ## `identify`
//! [`IdentifyResult`], [`ExpectedParameter`], [`FittedDatum`], [`FittedError`], [`FittedParameter`], [`FormOfAxis`],
//! [`KindResidual`], [`KnownValue`], [`LackOfFit`], [`MeasurementPlan`], [`MonomialCoefficient`],
//! [`MonomialComponent`], [`MonomialFit`], [`NamedSvg`], [`OrderShares`], [`OutlierPlace`], [`PlannedPose`],
//! [`PredictedUncertainty`], [`RepeatedReadings`], [`ResidualTest`], [`Rms`], [`RmsBeforeAfter`], [`ScatterOfKind`],
//! [`SharedUncertainty`].
//! ## `locate`
//! [`LocateResult`], [`AxisLine`], [`LocatedAxis`], [`LocatedError`].
//! ## `record`
//! [`AlarmState`], [`ErrorTrend`], [`Record`], [`RecordCheck`], [`RecordTrend`], [`TrendPoint`], [`TrendRecord`],
//! [`TrendStep`], [`AlarmLimit`], [`Contact`], [`CopiedFile`], [`Dates`], [`Day`], [`ErrorCurve`], [`ErrorRow`],
//! [`Instrument`], [`LimitDecision`], [`Line`], [`MachineState`], [`NoValue`], [`Person`], [`Place`], [`Plate`],
//! [`RecordData`], [`RecordedFigure`], [`RecordedFigures`], [`RecordedSet`], [`StateValue`], [`Temperature`],
//! [`TwoLetters`], [`Conformity`], [`LimitSides`].
//! ## `compile`, `verify`
//! [`CertificateReport`], [`CertificateStep`], [`CompiledSet`], [`ComposedPart`], [`ComposedSet`], [`Certificate`],
//! [`CompensationDegree`], [`ControllerTarget`], [`Figures`], [`ProgrammingFigures`], [`ROUNDING_UM`],
//! [`SingleErrorResidual`].
//! ## `diff`
//! [`AxisDifference`], [`SetDifference`], [`MachineDifference`], [`PropertyDifference`].
//! ## `report`
//! [`Report`], [`RenderedPage`], [`BoundedFigures`], [`LengthDifference`], [`Picture`], [`PictureFailure`],
//! [`RssDifference`].
//! ## `explain`, `targets`
//! [`Explanation`], [`TargetCertainty`], [`TargetSummary`].
//! ## Tool poses
//! [`BeyondTravel`], [`Lack`], [`MissedToolPose`], [`NeededTravel`], [`ReachedToolPoses`].
//! ## Uncertainty
//! [`CertificateBands`], [`ComparedBands`], [`PoseUncertainty`], [`Bands`], [`SummaryBand`].
//! ## Statistics
//! [`Difference`], [`Statistics`], [`Summary`].
//! ## The machine
//! [`Axis`], [`AxisKind`], [`Branch`], [`ErrorId`], [`ErrorKind`], [`ErrorTerm`], [`Machine`], [`Sense`], [`Travel`].
//! ## Files and diagnostics
//! [`Severity`], [`Sources`], [`FolderEntry`], [`ReadFailure`].

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
pub use crate::analysis::enumerate::{NeededRange, Ranking, RoundCount, Row as ArrangementRow};
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    /// The headings of the module name every type once.
    #[test]
    fn every_result_stands_under_a_verb() {
        let text = include_str!("results.rs");
        let (head, exports) = text.split_once("\npub use ").unwrap();
        let named: Vec<&str> = head.split("[`").skip(1).filter_map(|rest| rest.split_once("`]")).map(|x| x.0).collect();
        let exports = exports.split("#[cfg(test)]").next().unwrap();
        let words = exports.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ' ').map(str::trim);
        let types = words
            .filter_map(|word| word.rsplit(' ').next())
            .filter(|word| word.starts_with(|c: char| c.is_ascii_uppercase()));
        assert_eq!(named.iter().copied().collect::<BTreeSet<_>>(), types.collect());
        assert_eq!(named.len(), named.iter().collect::<BTreeSet<_>>().len(), "a type stands twice");
    }
}
