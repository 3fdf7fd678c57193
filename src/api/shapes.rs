//! Shapes of the results whose JSON is put together by hand, as JSON Schema: the fields that docs/formats.md describes,
//! for faces whose types are generated. `python/tests` holds them to what the program prints.

use super::budget::BudgetResult;
use super::budgets::ComparedBudgets;
use super::certificate::CertificateReport;
use super::enumerate::{JudgedBy, RankedArrangements};
use super::equations::EquationsResult;
use super::goal::ToleranceGoal;
use super::instrument::InstrumentResult;
use super::uncertainty::CertificateBands;
use crate::analysis::budget::{Binding, Distribution, Percentile, Statistic, VersusFirst};
use crate::analysis::enumerate::RoundCount;
use crate::diagnostic::Code;
use crate::evaluate::{Frame, Summary};
use crate::job::poses::AxisPositions;
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::{Approach, ErrorId, ErrorKind};
use crate::report::BoundedFigures;
use indexmap::IndexMap;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use std::borrow::Cow;

/// Gives a result the schema of its shape.
macro_rules! shaped {
    ($($result:ident: $shape:ident,)*) => { $(
        impl JsonSchema for $result {
            fn schema_name() -> Cow<'static, str> {
                stringify!($result).into()
            }

            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                $shape::json_schema(generator)
            }
        }
    )* };
}

shaped! {
    BudgetResult: BudgetShape,
    ToleranceGoal: GoalShape,
    ComparedBudgets: ComparedBudgetsShape,
    CertificateReport: CertificateShape,
    RankedArrangements: RankedShape,
    InstrumentResult: InstrumentShape,
    EquationsResult: EquationsShape,
    BoundedFigures: BoundedShape,
    // Written as text.
    ErrorId: String,
    Code: String,
}

/// Figures of what bounds lead to over poses.
#[derive(JsonSchema)]
struct BoundedShape {
    /// Number of bounded errors.
    errors: usize,
    #[serde(flatten)]
    drawn: DrawShape,
    /// The position deviation, um.
    position_um: BoundedDeviationShape,
    /// The rotation of the tool, urad.
    rotation_urad: BoundedDeviationShape,
}

/// A deviation that bounds lead to over poses.
#[derive(JsonSchema)]
struct BoundedDeviationShape {
    /// Statistics over the poses of the root of the sum of squares.
    rss: LengthFigures,
    /// Largest deviation over the poses, of machines drawn.
    monte_carlo: DrawnMachineFigures,
}

/// Statistics of lengths.
#[derive(JsonSchema)]
struct LengthFigures {
    /// Largest.
    max: f64,
    /// Mean.
    mean: f64,
    /// Root of the mean square.
    rms: f64,
    /// The ceil(0.95 n)-th smallest.
    p95: f64,
}

/// Settings of the machines drawn.
#[derive(JsonSchema)]
struct DrawShape {
    /// The class that bounds what the machine file does not.
    class: Option<String>,
    /// Source of the class.
    class_source: Option<String>,
    /// Number of machines drawn.
    samples: usize,
    /// Seed of poses and errors.
    seed: u64,
    /// Distribution of an error between its bounds.
    distribution: Distribution,
    /// Statistic of a machine over the poses.
    statistic: Statistic,
}

/// A budget: to first order, in the workpiece frame.
#[derive(JsonSchema)]
struct BudgetShape {
    /// Name of the machine.
    machine: String,
    /// The kinematic chain.
    chain: String,
    #[serde(flatten)]
    drawn: DrawShape,
    /// Frame of the vectors: the workpiece frame.
    frame: String,
    /// Order of the errors: 1.
    order: String,
    /// Number of errors that have values and are left out.
    left_out: usize,
    /// Number of poses.
    poses: usize,
    /// The position deviation, um.
    position_um: DeviationBudget,
    /// The rotation of the tool, urad.
    rotation_urad: DeviationBudget,
    /// Effect of each error at its bound where the RSS is largest, largest first.
    contributions: Vec<BoundedContribution>,
    /// The same, averaged over the poses.
    contributions_on_average: Vec<BoundedContribution>,
    /// The bounded errors; first the one whose tightening lowers the 95 % value most.
    tighten: Vec<Tightening>,
    /// Tool poses of a file that the machine reaches.
    #[serde(skip_serializing_if = "Option::is_none")]
    tool_poses: Option<ReachedToolPoses>,
    /// The cheapest tolerances for a goal.
    #[serde(skip_serializing_if = "Option::is_none")]
    goal: Option<ToleranceGoal>,
    /// Contributions at a pose that was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<ContributionsAt>,
}

/// A deviation, as bounds lead to it.
#[derive(JsonSchema)]
struct DeviationBudget {
    /// Sum of the effects of all bounds, at the pose where it is largest.
    worst_case: f64,
    /// Root of the sum of their squares, at the pose where it is largest.
    rss: f64,
    /// Mean of both.
    mean_of_both: f64,
    /// Pose of the worst case, mm and deg.
    worst_case_at: AxisPositions,
    /// Pose of the largest RSS, mm and deg.
    rss_at: AxisPositions,
    /// Machines drawn between the bounds.
    monte_carlo: DrawnMachineFigures,
}

/// Figures of machines drawn.
#[derive(JsonSchema)]
struct DrawnMachineFigures {
    /// Mean.
    mean: f64,
    /// Standard error of the mean.
    mean_sigma: f64,
    /// Value that 95 % of the machines do not exceed.
    p95: f64,
    /// Percentiles by name, such as `p95`.
    percentiles: IndexMap<String, PercentileInterval>,
}

/// A percentile of machines drawn with its confidence interval; none where there are too few machines for one.
#[derive(JsonSchema)]
struct PercentileInterval {
    /// The percentile.
    value: f64,
    /// Lower end of its 95 % confidence interval.
    low: Option<f64>,
    /// Upper end of its 95 % confidence interval.
    high: Option<f64>,
}

/// Effect of an error at its bound.
#[derive(JsonSchema)]
struct BoundedContribution {
    /// Name of the error.
    error: String,
    /// Share of the sum of squares, 0 to 1.
    share: f64,
    /// Position deviation, um.
    um: f64,
}

/// A bounded error, and the effect of its tolerance.
#[derive(JsonSchema)]
struct Tightening {
    /// Name of the error.
    error: String,
    /// Its tolerance, in `unit`.
    tolerance: f64,
    /// `um` or `urad`.
    unit: String,
    /// Its direction, machine frame.
    direction: [f64; 3],
    /// True if its name has the letter of a direction.
    by_letter: bool,
    /// True if the class bounds it, false if the machine file does.
    of_class: bool,
    /// Derivative of the 95 % value by the tolerance, um by unit.
    um_per_unit: f64,
    /// Standard error of the derivative, um by unit.
    sigma: f64,
    /// Its part of the 95 % value, um.
    um_of_p95: f64,
    /// Standard error of that part, um.
    um_of_p95_sigma: f64,
    /// Its effect where the RSS is largest, um.
    at_worst_um: Option<f64>,
    /// Its effect averaged over the poses, um.
    average_um: Option<f64>,
}

/// Contributions at a pose.
#[derive(JsonSchema)]
struct ContributionsAt {
    /// The pose, mm and deg.
    axes: AxisPositions,
    /// Effect of each error at its bound, largest first.
    contributions: Vec<BoundedContribution>,
}

/// The cheapest tolerances for a goal.
#[derive(JsonSchema)]
struct GoalShape {
    /// The goal of the 95 % value, um.
    goal_um: f64,
    /// The 95 % value with the old tolerances, um.
    before_um: Percentile,
    /// The 95 % value with the new tolerances, of machines drawn anew, um.
    proof_um: Percentile,
    /// Number of machines of the proof.
    proof_samples: usize,
    /// The 95 % value of what no tolerance of the cost model changes, um.
    staying_um: f64,
    /// Number of steps of the search.
    steps: usize,
    /// The cost.
    cost: GoalCost,
    /// The tolerances.
    tolerances: Vec<GoalTolerance>,
}

/// The cost of tolerances.
#[derive(JsonSchema)]
struct GoalCost {
    /// Power of the tolerance in the cost.
    power: f64,
    /// Value with the old tolerances.
    before: f64,
    /// Value with the new tolerances.
    after: f64,
    /// By um of the goal.
    per_um: f64,
}

/// A tolerance for a goal.
#[derive(JsonSchema)]
struct GoalTolerance {
    /// Name of the error.
    error: String,
    /// The kind by which it is paid for.
    kind: ErrorKind,
    /// `um` or `urad`.
    unit: String,
    /// Before, in `unit`.
    old: f64,
    /// After, in `unit`.
    new: f64,
    /// The limit that holds it.
    binds: Binding,
    /// Its part of the 95 % value, um.
    um_of_p95: f64,
    /// Its weight in the cost.
    weight: f64,
    /// Its cost before.
    cost_before: f64,
    /// Its cost after.
    cost_after: f64,
}

/// Budgets on the same work.
#[derive(JsonSchema)]
struct ComparedBudgetsShape {
    /// The budget of each machine.
    machines: Vec<ComparedBudget>,
    /// Effect of the error that is first in `contributions`, um.
    largest_um: f64,
    /// Error by error, largest first; a list has a value for each machine.
    contributions: Vec<ComparedContribution>,
    #[serde(flatten)]
    drawn: DrawShape,
    /// Number of machines that are drawn at most.
    max_samples: usize,
    /// The 95 % value of each machine but the first, minus that of the first.
    versus_first_p95_um: Vec<VersusFirst>,
}

/// The budget of a machine beside others.
#[derive(JsonSchema)]
struct ComparedBudget {
    /// Number of bounded errors.
    errors: usize,
    /// The class that bounds what the machine file does not.
    class: Option<String>,
    /// Source of the class.
    class_source: Option<String>,
    /// The position deviation, um.
    position_um: DeviationBudget,
    /// The rotation of the tool, urad.
    rotation_urad: DeviationBudget,
    /// Minus the figures of the first machine.
    minus_first: BudgetDifference,
}

/// Figures of a budget minus those of another.
#[derive(JsonSchema)]
struct BudgetDifference {
    /// Differences of the position deviation, um.
    position_um: Option<DeviationBudgetDifference>,
    /// Differences of the orientation deviation, urad.
    rotation_urad: Option<DeviationBudgetDifference>,
}

/// Figures of a deviation minus those of another.
#[derive(JsonSchema)]
struct DeviationBudgetDifference {
    /// Difference of the worst cases.
    worst_case: f64,
    /// Difference of the RSS values.
    rss: f64,
    /// Difference of the means of both.
    mean_of_both: f64,
    /// Differences of the figures of machines drawn.
    monte_carlo: DrawnDifference,
}

/// Figures of machines drawn minus those of others.
#[derive(JsonSchema)]
struct DrawnDifference {
    /// Difference of the means.
    mean: f64,
    /// Difference of the 95 % values.
    p95: f64,
}

/// An error in several budgets; none where a machine does not bound it.
#[derive(JsonSchema)]
struct ComparedContribution {
    /// Name of the error.
    error: String,
    /// `um` or `urad`.
    unit: String,
    /// Its tolerance, in `unit`.
    tolerance: Vec<Option<f64>>,
    /// Its part of the 95 % value, um.
    um_of_p95: Vec<Option<f64>>,
    /// Standard error of that part, um.
    um_of_p95_sigma: Vec<Option<f64>>,
    /// That part minus that of the first machine, um.
    minus_first: Vec<f64>,
    /// Its effect averaged over the poses, um.
    average_um: Vec<Option<f64>>,
}

/// A machine after a controller has applied its files.
#[derive(JsonSchema)]
struct CertificateShape {
    /// Name of the target.
    target: String,
    /// Names of the files.
    files: Vec<String>,
    /// Number of poses.
    poses: usize,
    /// The side of approach that is worse.
    direction: Approach,
    /// Name of the tool; may be empty.
    tool: String,
    /// Without the files.
    uncompensated: CertifiedFigures,
    /// With the files.
    compensated: CertifiedFigures,
    /// The errors by name.
    errors: IndexMap<String, CertifiedError>,
    /// Number of poses for single errors.
    single_error_poses: usize,
    /// Motions that the files add with all axes at 0.
    at_reference: AtReference,
    /// Errors that the controller cannot correct, in words.
    cannot: Vec<String>,
    /// Figures that the files raise.
    raised: Vec<RaisedShape>,
    /// Displacement of the reference that the controller does not see; none for most.
    reference_shift: Option<ReferenceShift>,
    /// Figures for each form of the tool direction, where the controller transforms.
    #[serde(skip_serializing_if = "Option::is_none")]
    programming: Option<Vec<ProgrammingShape>>,
    /// Figures after each step of a composed set.
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<Vec<StepShape>>,
    /// Intervals of the figures, where the machine file states uncertainties of errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    uncertainty: Option<CertificateBands>,
}

/// Figures of a certificate.
#[derive(JsonSchema)]
struct CertifiedFigures {
    /// Deviation of the functional point, um.
    position_um: Summary,
    /// Rotation of the tool, urad.
    rotation_urad: Summary,
    /// Tilt of the tool axis, urad.
    tool_axis_urad: Summary,
}

/// An error in a certificate.
#[derive(JsonSchema)]
struct CertifiedError {
    /// Degree to which the files correct it.
    handled: crate::controller::CompensationDegree,
    /// 95 % position deviation that the files leave of it alone, um.
    left_um: f64,
    /// The same without the files, um.
    alone_um: f64,
}

/// Motions that files add with all axes at 0, by axis, mm and deg.
#[derive(JsonSchema)]
struct AtReference {
    /// Approached forward.
    forward: AxisPositions,
    /// Approached in reverse.
    reverse: AxisPositions,
}

/// A figure that files raise.
#[derive(JsonSchema)]
struct RaisedShape {
    /// The side of approach.
    direction: Approach,
    /// Name of the figure.
    figure: String,
    /// Its value without the files, um.
    before_um: f64,
    /// Its value with the files, um.
    after_um: f64,
}

/// Displacement of the reference.
#[derive(JsonSchema)]
struct ReferenceShift {
    /// Shifts of the linear axes, um.
    shift_um: AxisPositions,
    /// Shifts of the rotary axes, urad.
    shift_urad: AxisPositions,
    /// Position deviation with it, um.
    position_um: Summary,
    /// Position deviation by it alone, um.
    without_tables_um: Summary,
}

/// Figures for one form of the tool direction.
#[derive(JsonSchema)]
struct ProgrammingShape {
    /// `vector` or `rotary axes`.
    tool_direction: String,
    /// Name of the tool in the machine file, empty for the only one.
    tool: String,
    /// Added to the length of the tool, mm.
    longer_mm: f64,
    /// Without the files.
    uncompensated: CertifiedFigures,
    /// With the files.
    compensated: CertifiedFigures,
    /// The number of poses at which the controller keeps an axis at a pole.
    at_poles: u64,
    /// With the files at the other poses, where some are at a pole.
    away_from_poles: Option<CertifiedFigures>,
}

/// Figures after a step of a composed set.
#[derive(JsonSchema)]
struct StepShape {
    /// Names of the targets so far.
    target: String,
    /// With their files.
    compensated: CertifiedFigures,
}

/// Arrangements in order.
#[derive(JsonSchema)]
struct RankedShape {
    /// Name of the machine.
    machine: String,
    /// Its kinematic chain as the file has it.
    chain: String,
    /// Criterion of the arrangements.
    by: JudgedBy,
    /// The class that bounds what the machine file does not.
    class: Option<String>,
    /// Source of the class.
    class_source: Option<String>,
    /// Number of errors that count.
    errors: usize,
    /// Number of tool poses.
    poses: usize,
    /// Number of machines drawn of every arrangement.
    samples: Option<usize>,
    /// The rounds, where machines are drawn.
    rounds: Option<RoundsShape>,
    /// Seed of poses and errors.
    seed: u64,
    /// Statistic of a machine over the poses.
    statistic: Statistic,
    /// Fraction of the tool poses that a ranked arrangement reaches.
    reach: f64,
    /// Number of arrangements.
    arrangements: usize,
    /// The arrangements, best first.
    ranked: Vec<ArrangementShape>,
    /// Arrangements that reach less.
    reach_less: Vec<ArrangementShape>,
    /// Arrangements whose geometry the file does not state.
    geometry_not_stated: Vec<ArrangementShape>,
    /// Chains of arrangements that cannot turn the tool.
    cannot_turn_the_tool: Vec<String>,
    /// Tool poses of a file that the machine reaches.
    #[serde(skip_serializing_if = "Option::is_none")]
    tool_poses: Option<ReachedToolPoses>,
}

/// Rounds of a ranking.
#[derive(JsonSchema)]
struct RoundsShape {
    /// Maximum number of machines drawn of an arrangement.
    max_samples: usize,
    /// Number of first ranks that were to be told apart.
    first: usize,
    /// True if they are.
    told_apart: bool,
    /// The rounds done.
    done: Vec<RoundCount>,
    /// Number of machines drawn.
    drawn: usize,
    /// Their number if no arrangement were left out.
    drawn_without_elimination: usize,
}

/// An arrangement of the axes.
#[derive(JsonSchema)]
struct ArrangementShape {
    /// Its rank, from 1; of ranked arrangements only.
    #[serde(skip_serializing_if = "Option::is_none")]
    rank: Option<usize>,
    /// Its kinematic chain.
    chain: String,
    /// Number of axes that carry the workpiece.
    on_table: usize,
    /// Number of tool poses that it reaches.
    reached: usize,
    /// Number of tool poses that it does not reach, by reason.
    unreachable: crate::analysis::UnreachableCount,
    /// Its figure, um; none where it is not judged.
    um: Option<f64>,
    /// Lower end of the confidence interval of the figure, um.
    low: Option<f64>,
    /// Upper end of the confidence interval of the figure, um.
    high: Option<f64>,
    /// Mean of the machines drawn, um.
    mean: Option<f64>,
    /// Its figure minus that of the arrangement of the file, um.
    minus_file: Option<f64>,
    /// Number of machines drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<usize>,
    /// Its figure minus that of the best.
    #[serde(skip_serializing_if = "Option::is_none")]
    versus_first: Option<VersusFirst>,
    /// Travel that the work needs by axis, mm: minimum and maximum.
    #[serde(skip_serializing_if = "Option::is_none")]
    travel: Option<IndexMap<String, [f64; 2]>>,
    /// Geometry that the file does not state.
    #[serde(skip_serializing_if = "Option::is_none")]
    not_stated: Option<Vec<String>>,
}

/// Readings of an instrument; the fields of other instruments are absent.
#[derive(JsonSchema)]
struct InstrumentShape {
    /// Name of the machine.
    machine: String,
    /// `ball_bar`, `r_test`, `diagonals` or `step_diagonals`.
    instrument: String,
    /// Ball bar: centre of the circles, mm and deg.
    #[serde(skip_serializing_if = "Option::is_none")]
    centre: Option<AxisPositions>,
    /// Ball bar: its length, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    radius_mm: Option<f64>,
    /// Ball bar: the circles.
    #[serde(skip_serializing_if = "Option::is_none")]
    planes: Option<Vec<CircleReadings>>,
    /// R-test: pose at which the ball is, mm and deg.
    #[serde(skip_serializing_if = "Option::is_none")]
    ball_at: Option<AxisPositions>,
    /// R-test: frame of the readings, the machine frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<Frame>,
    /// R-test: the axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    axes: Option<Vec<TurnReadings>>,
    /// Diagonals: pose of the axes that stand, mm and deg.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<AxisPositions>,
    /// Diagonals: the lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    diagonals: Option<Vec<DiagonalReadings>>,
    /// Diagonals: the largest E_d, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    e_um: Option<f64>,
}

/// A circle by both senses.
#[derive(JsonSchema)]
struct CircleReadings {
    /// The plane, workpiece frame.
    plane: String,
    /// Circular deviation G, um.
    circular_deviation_um: BothSensesShape,
    /// Bidirectional circular deviation G(b), um.
    bidirectional_um: f64,
    /// Mean bidirectional radial deviation D, um.
    mean_radial_um: f64,
    /// Radial deviations F, um: largest and smallest.
    radial_max_min_um: ExtremesShape,
    /// Angle between the plane's directions minus 90 deg, urad.
    squareness_urad: f64,
    /// Scale of the first direction minus that of the second, um/m.
    scale_mismatch_um_per_m: f64,
    /// Angles of the readings, deg.
    angle_deg: Vec<f64>,
    /// Length read minus radius, um.
    counter_clockwise_um: Vec<f64>,
    /// Length read minus radius, um.
    clockwise_um: Vec<f64>,
}

/// A figure by the sense of rotation.
#[derive(JsonSchema)]
struct BothSensesShape {
    /// By rising angle.
    counter_clockwise: f64,
    /// By falling angle.
    clockwise: f64,
}

/// Largest and smallest reading by the sense of rotation.
#[derive(JsonSchema)]
struct ExtremesShape {
    /// By rising angle.
    counter_clockwise: [f64; 2],
    /// By falling angle.
    clockwise: [f64; 2],
}

/// An R-test of an axis.
#[derive(JsonSchema)]
struct TurnReadings {
    /// Name of the axis.
    axis: String,
    /// Ranges along x, y, z, um.
    range_um: [f64; 3],
    /// Number of readings.
    count: usize,
    /// Number of positions that the other axes cannot follow.
    skipped: usize,
    /// The readings.
    readings: Vec<TurnReading>,
}

/// A reading of an R-test.
#[derive(JsonSchema)]
struct TurnReading {
    /// Position of the axis, deg.
    position_deg: f64,
    /// The pose, mm and deg.
    axes: AxisPositions,
    /// Deviation minus that at the first position, um, machine frame.
    reading_um: [f64; 3],
}

/// A laser along a diagonal.
#[derive(JsonSchema)]
struct DiagonalReadings {
    /// Sense of each axis: p or n.
    name: String,
    /// Names of the axes.
    axes: Vec<String>,
    /// Range of both runs E_d, um.
    e_d_um: f64,
    /// Largest difference of both runs B_d, um.
    b_d_um: f64,
    /// Sum of the changes by each axis on the forward run, um; with steps only.
    by_axis_um: Option<Vec<f64>>,
    /// Nominal displacement from the start, mm.
    way_mm: Vec<f64>,
    /// Actual minus nominal on the forward run, um.
    there_um: Vec<f64>,
    /// Actual minus nominal on the return run, um.
    back_um: Vec<f64>,
}

/// Closed forms; mm and rad, workpiece frame.
#[derive(JsonSchema)]
struct EquationsShape {
    /// Name of the machine.
    machine: String,
    /// Degree of the algebra.
    degree: u8,
    /// Frame of the vectors: the workpiece frame.
    frame: Frame,
    /// Units of lengths and angles.
    units: EquationUnits,
    /// The symbols.
    symbols: Vec<EquationSymbol>,
    /// The matrix of each joint.
    joints: IndexMap<String, Vec<Vec<PolynomialShape>>>,
    /// From the bed to the tool.
    t_tool: Vec<Vec<PolynomialShape>>,
    /// From the bed to the workpiece.
    t_work: Vec<Vec<PolynomialShape>>,
    /// The volumetric error E_VE.
    e_ve: Vec<Vec<PolynomialShape>>,
    /// Displacement of the functional point.
    deviation: Vec<PolynomialShape>,
    /// Rotation of the tool.
    rotation: Vec<PolynomialShape>,
}

/// Units of closed forms.
#[derive(JsonSchema)]
struct EquationUnits {
    /// `mm`.
    length: String,
    /// `rad`.
    angle: String,
}

/// A symbol of closed forms.
#[derive(JsonSchema)]
struct EquationSymbol {
    /// As it stands in the text.
    symbol: String,
    /// `error`, `position`, `sine`, `cosine` or `tool_length`.
    kind: String,
    /// Name of the error or axis.
    of: String,
    /// 1 or -1.
    sign: f64,
    /// As LaTeX.
    latex: String,
}

/// A polynomial in the symbols.
#[derive(JsonSchema)]
struct PolynomialShape {
    /// As text.
    text: String,
    /// Its terms.
    terms: Vec<TermShape>,
}

/// A term of a polynomial.
#[derive(JsonSchema)]
struct TermShape {
    /// Its number.
    coefficient: f64,
    /// Powers by symbol.
    powers: IndexMap<String, u8>,
    /// Its order in the errors.
    order: usize,
}
