//! Results of the functions, and their parts, for `abbe::results`; `results.md` has them by verb.

pub use super::algebra::AlgebraResult;
pub use super::bounded::{AddedByBounds, AddedDeviation};
pub use super::budget::{BudgetResult, ContributionsAt, FittedBudget, ZoneBudget};
pub use super::budgets::{
    BudgetDifference, ComparedBudget, ComparedBudgets, ComparedContribution, ComparedVerdict,
    DeviationBudgetDifference, DrawnDifference, WithheldVerdict,
};
pub use super::certificate::{
    AtReference, CertificateBeyond, CertificateReport, CertificateStep, JobCertificate, ReferenceShift,
};
pub use super::check::CheckedFile;
pub use super::classify::{
    Classification, ErrorClass, ErrorPart, ErrorsOfDegree, MotionWithErrors, NoMotion, SixErrors,
};
pub use super::compare::{CompareResult, ComparedBounds, ComparedMachine, ComparedPose, ErrorContribution};
pub use super::compare_figures::{FittedComparison, FittedMachine, JudgedDifference, MachineVerdict};
pub use super::compare_targets::{DrawnRepair, RefusedTarget, TargetComparison, TargetResidual};
pub use super::compile::CompiledSet;
pub use super::compiled_model::{CompiledModel, DeviationColumns, DeviationSlices, PoseDeviation};
pub use super::compose::ComposedSet;
pub use super::convert::{ConversionProof, ConvertResult, ConvertedError, MisfitSize};
pub use super::diff::{AxisDifference, SetDifference};
pub use super::effects::{ErrorEffect, InversePole, Neglected};
pub use super::enumerate::{
    AgainstFirst, Arrangement, EnumerateResult, ExcludedArrangements, RankedArrangements, RankingRounds, StudyProgress,
};
pub use super::equations::{
    EquationSymbol, EquationUnits, EquationsResult, MatrixFactor, Polynomial, PolynomialMatrix, PolynomialTerm,
};
pub use super::eval::{EvalResult, EvalUnits, PoseResult};
pub use super::explain::Explanation;
pub use super::goal::{GoalCost, GoalTolerance, ToleranceGoal};
pub use super::identify::{
    BentError, ExpectedParameter, ExpectedPrediction, FittedDatum, FittedError, FittedParameter, FormOfAxis,
    IdentifyResult, KindResidual, KnownValue, LackOfFit, MeasurementPlan, MonomialCoefficient, MonomialComponent,
    MonomialFit, NamedSvg, OrderShares, OutlierPlace, PlanGoal, PlannedPose, PredictedUncertainty, ReadingResidual,
    RepeatedReadings, ResidualGroup, ResidualTest, Rms, RmsBeforeAfter, ScatterOfKind, SharedUncertainty,
    SuspectReadings,
};
pub use super::instrument::{InstrumentResult, LaserReadings, Readings, ReadingsOfBounds};
pub use super::locate::{AxisLine, LocateResult, LocatedAxis, LocatedError};
pub use super::map_result::{
    BeyondMeasured, BodyDiagonal, MapFromBounds, MapResult, Uncompensated, WorstBoundedPose, WorstPose,
};
pub use super::place::PlacementResult;
pub use super::reach::{ReachDirections, ReachResult};
pub use super::set_part::ComposedPart;
pub use super::show::{Arm, ChainAxis, ChainResult, ChainTool, LocationError, LocationErrors, OtherSide};
pub use super::sources::{ErrorSource, ErrorSources};
pub use super::summary::{AxisSummary, ErrorCounts, MachineSummary};
pub use super::targets::{TargetCertainty, TargetSummary};
pub use super::terms::{DegreePart, MonomialPart};
pub use super::uncertainty::CertificateBands;
pub use super::withheld::TurnedVerdicts;
pub use crate::analysis::Lemma;
pub use crate::analysis::budget::{
    Binding, Bound, BoundedDeviation, BoundedLength, Coverage, PairedDifference, Percentile, Proportion, Role, Verdict,
    VersusFirst,
};
pub use crate::analysis::enumerate::{FittedArrangement, RoundCount};
pub use crate::analysis::figure_bands::{ComparedBands, PoseUncertainty};
pub use crate::analysis::instrument::{BallBar, BoundedReading, Diagonal, RTest, RTestReading};
pub use crate::analysis::zone::{CharacteristicKind, ZoneFit};
pub use crate::analysis::{Bands, Status as LocationStatus, SummaryBand};
pub use crate::controller::{
    BallCheck, CompensationDegree, ControllerTarget, DriveDemand, Figures, MIN_READING_MM, NumberChange,
    ProgrammingFigures, ROUNDING_UM, RaisedFigure, SignTrial, SignTrials, SingleErrorResidual, Strongest,
    ToolDirection,
};
pub use crate::diagnostic::{Severity, Sources};
pub use crate::evaluate::{Difference, Statistics, Summary};
pub use crate::file_set::restore::Restored;
pub use crate::identify::second::{
    JudgedReading, MeasuredKind, ModelAlternative, ModelVerdict, PredictedKind, PredictedReadings, RmsInterval,
    SecondMeasurement, SecondVerdict, SeenCorrection, SetAlternative, SetUpValue,
};
pub use crate::identify::{BallCentre, OutlierTouch, ProbeLobing, TouchImport};
pub use crate::job::characteristics::{CharacteristicPart, CharacteristicResult, DrawnCharacteristic};
pub use crate::job::features::{DominatingError, FeatureResult};
pub use crate::job::limit::LimitVerdict;
pub use crate::job::machine_file::InputFile;
pub use crate::job::over::{Over, OverKind};
pub use crate::job::path::{DeviationStep, PathAxis, PathPole, PathResult, PathRewind};
pub use crate::job::place_grid::PlaceRange;
pub use crate::job::place_study::{CommonFigures, PlacementGain, TriedPlace};
pub use crate::job::poses::AxisPositions;
pub use crate::job::test_piece::TestPiece;
pub use crate::job::tool_poses::{BeyondTravel, Lack, MissedToolPose, NeededTravel, ReachedToolPoses};
pub use crate::machine::{Axis, AxisKind, Branch, ErrorId, ErrorKind, ErrorTerm, Machine, Sense, Travel};
pub use crate::record::check::RecordCheck;
pub use crate::record::make::Record;
pub use crate::record::trend::{AlarmState, ErrorTrend, RecordTrend, TrendPoint, TrendRecord, TrendStep};
pub use crate::record::{
    AlarmLimit, Contact, CopiedFile, CovariedError, Dates, Day, ErrorCurve, ErrorRow, Instrument, LimitDecision, Line,
    MachineState, NoValue, Person, Place, Plate, PromisedResidual, RecordData, RecordSignature, RecordedCovariance,
    RecordedFigure, RecordedFigures, RecordedSet, StateValue, Statements, Temperature, TwoLetters, UnheldReversal,
};
pub use crate::report::imported::{
    ImportFinding, ImportResult, ImportedChannel, ImportedError, LeftOutColumn, LeftOutRow, ReferenceMaterial,
    StraightnessReference,
};
pub use crate::report::measuring_program::{MeasuredSet, MeasuringProgram};
pub use crate::report::page::RenderedPage;
pub use crate::report::positioning::{
    AccuracyUncertainties, MeasuredTarget, OneWayAccuracy, OneWayBoth, ReadAtTarget, StatedContributors,
};
pub use crate::report::standard_tests::{
    CauseTest, CircleTest, CircleUncertainties, DiagonalTest, DiagonalsTest, DriftOf, DriftTest, MotionTest,
    RotationTest, SpikeTest, TemperatureRange, TestFigures, TurningTest, UncertainValue,
};
pub use crate::report::{
    ActingValues, BoundedContribution, BoundedFigures, BoundedLengths, BudgetFigures, DeviationBudget, DrawSettings,
    DrawnMachineFigures, LengthStatistics, MachineDifference, PercentileInterval, Picture, PictureFailure,
    PropertyDifference, RssDifference, Tightening,
};
pub use crate::shards::budget_parts::BudgetShard;
pub use crate::standards::{BothSenses, Conformity, LimitSides};
pub use crate::syntax::{FolderEntry, ReadFailure};

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    #[test]
    fn every_result_stands_under_a_verb_once() {
        let types = include_str!("results.rs").split("#[cfg(test)]").next().unwrap();
        let types = types.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ' ').map(str::trim);
        let types = types.filter_map(|word| word.rsplit(' ').next());
        let types: BTreeSet<&str> = types.filter(|word| word.starts_with(|c: char| c.is_ascii_uppercase())).collect();
        let named = include_str!("results.md").split("[`").skip(1).filter_map(|rest| rest.split_once("`]"));
        // The report is a result of `wire`.
        let named: Vec<&str> = named.map(|(name, _)| name).filter(|name| *name != "Report").collect();
        assert_eq!(named.iter().copied().collect::<BTreeSet<_>>(), types, "left: named in results.md");
        assert_eq!(named.len(), types.len(), "a type stands twice");
    }
}
