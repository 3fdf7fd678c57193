/** Answers of the library. python/generate.py writes this file from the results of the façade. */

/** Errors with values in a budget. */
export interface ActingValues {
  /** Number of these errors. */
  errors: number;
  /** Their part of the 95 % value of the position, um. */
  um_of_p95: number;
}

/** What the bounds of a machine add to its measured errors: a budget of those errors that have no value. */
export interface AddedByBounds {
  /** Number of these errors. */
  errors: number;
  /** Number of poses: those of the budget, or of the work. */
  poses: number;
  /** Number of machines drawn. */
  samples: number;
  /** Seed of poses and errors. */
  seed: number;
  /** Of the position deviation, um. */
  position_um: AddedDeviation;
  /** Of the orientation, urad. */
  rotation_urad: AddedDeviation;
}

/** A deviation that bounds add. */
export interface AddedDeviation {
  /** Root of the sum of squares of the bounds' effects, at the pose where that is largest. */
  rss: number;
  /** The largest deviation over the poses that 95 % of the machines drawn do not exceed. */
  p95: number;
}

/** The algebra that a result was computed over. */
export interface AlgebraResult {
  /** Names of the generators, x1 first. */
  generators: string[];
  /** Order of monomials: graded reverse lexicographic, x1 > x2 > ... */
  monomial_order: string;
  /** Reduced Groebner basis of the ideal up to the degree, each element solved for its leading monomial; empty without relations. */
  groebner_basis: string[];
  /** Monomials that are a basis of the algebra over the reals. */
  monomials: string[];
}

/** The side from which a position is approached; curves may differ (reversal). */
export type Approach = "mean" | "forward" | "reverse";

/** A lever arm, mm. */
export interface Arm {
  /** At the zero pose. */
  at_zero: number;
  /** The longest over the volume. */
  longest: number;
  /** Fraction of the sum of squares of all errors, each by itself, that the angular errors of the axis make over the volume, at their values or bounds. None without errors. */
  share: number | null;
}

/** The kind of motion of an axis. */
export type AxisKind = "linear" | "rotary";

/** An axis in short. */
export interface AxisSummary {
  /** Name of the axis. */
  name: string;
  /** Linear or rotary. */
  kind: AxisKind;
  /** The branch that the axis is on. */
  branch: Branch;
  /** Unit vector in machine coordinates at the zero pose. */
  direction: [number, number, number];
  /** Point about which angular errors turn, in machine coordinates at the zero pose, mm. */
  origin: [number, number, number];
  /** True if the axis turns without end. */
  continuous: boolean;
  /** Limits in `unit`; 0 and 360 for a continuous axis. */
  travel: [number, number];
  /** Range in which its curves were measured, in `unit`, where it is less than the travel. */
  measured?: [number, number] | null;
  /** `mm` or `deg`. */
  unit: string;
  /** Arms from the point about which angular errors turn to the functional point, and what hangs on them. */
  arm_mm: Arm;
}

/** A circle of a ball bar in both senses, evaluated by ISO 230-4. */
export interface BallBar {
  /** The plane, workpiece frame. */
  plane: Plane;
  /** Circular deviation G of each path, um: range about its own centre of least squares. */
  circular_deviation_um: BothSenses;
  /** Bidirectional circular deviation G(b), um. */
  bidirectional_um: number;
  /** Mean bidirectional radial deviation D, um. */
  mean_radial_um: number;
  /** Radial deviations F, um: largest and smallest reading. */
  radial_max_min_um: BothSenses2;
  /** Angle between the plane's directions minus 90 deg by the second harmonic, urad. */
  squareness_urad: number;
  /** Scale of the first direction minus that of the second, um/m. */
  scale_mismatch_um_per_m: number;
  /** Angles of the readings from the plane's first direction to its second, deg. */
  angle_deg: number[];
  /** Length read minus radius with rising angle, um. */
  counter_clockwise_um: number[];
  /** Length read minus radius with falling angle, um. */
  clockwise_um: number[];
}

/** Intervals of the statistics of deviations. */
export interface Bands {
  /** Number of independent parts of the uncertainty. */
  parts: number;
  /** Number of poses at which they were followed. */
  poses: number;
  /** True if the intervals were drawn, false if they are to first order (k = 2). */
  drawn: boolean;
  /** Position deviations of the functional point, um. */
  position_um: SummaryBand;
  /** Rotations of the tool, urad. */
  rotation_urad: SummaryBand;
}

/** Poses of a map beyond the ranges in which curves were measured. */
export interface BeyondMeasured {
  /** Number of the poses, of those counted. */
  poses: number;
  /** Number of poses that were counted: those of the map, or of more than [`MapPoses::MAX_HELD`] some spread over them. */
  of: number;
  /** The measured ranges that poses leave, by axis, mm and deg. */
  measured: Record<string, [number, number]>;
}

/** An axis that would have to leave its travel. */
export interface BeyondTravel {
  /** Name of the axis. */
  axis: string;
  /** Distance from the nearer end of its travel: negative below the lower end. */
  by: number;
  /** `mm` or `deg`. */
  unit: string;
}

/** What holds a tolerance where it is. */
export type Binding = "goal" | "finest" | "coarsest" | "present" | "held";

/** Displacement along a body diagonal. */
export interface BodyDiagonal {
  /** Senses of the axes along it, such as `ppp`. */
  name: string;
  /** The pose at its beginning, mm and deg. */
  from: Record<string, number>;
  /** The pose at its end, mm and deg. */
  to: Record<string, number>;
  /** Length, mm. */
  length_mm: number;
  /** Maximum minus minimum of the displacement, um. */
  range_um: number;
  /** Displacement along the diagonal at equal intervals, um. */
  deviations_um: number[];
}

/** Figures of each sense of rotation. */
export interface BothSenses {
  /** With rising angle. */
  counter_clockwise: number;
  /** With falling angle. */
  clockwise: number;
}

/** Figures of each sense of rotation. */
export interface BothSenses2 {
  /** With rising angle. */
  counter_clockwise: [number, number];
  /** With falling angle. */
  clockwise: [number, number];
}

/** Effect of an error at its bound. */
export interface BoundedContribution {
  /** Name of the error. */
  error: string;
  /** Share of the sum of squares, 0 to 1. */
  share: number;
  /** Position deviation, um. */
  um: number;
}

/** A deviation that bounds lead to over poses. */
export interface BoundedLengths {
  /** Statistics over the poses of the root of the sum of squares. */
  rss: LengthStatistics;
  /** Largest deviation over the poses, of machines drawn. */
  monte_carlo: DrawnMachineFigures;
}

/** A reading to which bounds lead. */
export interface BoundedReading {
  /** The plane, the axis with a direction, or the senses along a diagonal. */
  name: string;
  /** Root of the sum of squares of what 95 % of machines read in which one bound acts alone, um. */
  rss_um: number;
  /** The reading that 95 % of the machines drawn do not exceed, um. */
  p95_um: Percentile;
}

/** A side of the bed. */
export type Branch = "workpiece" | "tool";

/** Figures of a budget minus those of another. */
export interface BudgetDifference {
  /** Differences of the position deviation, um. */
  position_um: DeviationBudgetDifference;
  /** Differences of the orientation deviation, urad. */
  rotation_urad: DeviationBudgetDifference;
}

/** A budget with what it is of. */
export interface BudgetResult {
  /** The class that bounds what the machine file does not. */
  class: string | null;
  /** Source of the class. */
  class_source: string | null;
  /** Number of machines drawn. */
  samples: number;
  /** Seed of poses and errors. */
  seed: number;
  /** Distribution of an error between its bounds. */
  distribution: Distribution;
  /** Statistic of a machine over the poses. */
  statistic: Statistic;
  /** Frame of the vectors: the workpiece frame. */
  frame: Frame;
  /** Order of the errors: 1. */
  order: Order;
  /** Number of errors that have values and are left out, for bounds stand for them. */
  left_out: number;
  /** The errors with values that no bound stands for, if there are any: they act in every machine drawn. */
  with_values?: ActingValues | null;
  /** Number of poses. */
  poses: number;
  /** The position deviation, um. */
  position_um: DeviationBudget;
  /** The rotation of the tool, urad. */
  rotation_urad: DeviationBudget;
  /** Effect of each error at its bound where the RSS is largest, largest first. */
  contributions: BoundedContribution[];
  /** The same, averaged over the poses. */
  contributions_on_average: BoundedContribution[];
  /** The bounded errors; first the one whose tightening lowers the 95 % value most. */
  tighten: Tightening[];
  /** `values` where no error is bounded: then each is between ± the largest value that it has at the poses of the axes. */
  from?: string | null;
  /** Which of the errors that act are known. */
  coverage: Coverage;
  /** Name of the machine. */
  machine: string;
  /** The kinematic chain. */
  chain: string;
  /** What the budget is over. */
  over: Over;
  /** The 95 % value of the position against the limit of the job, if it states one. */
  limit?: LimitVerdict | null;
  /** Events of the path, if the tool poses are one. */
  path?: PathResult | null;
  /** The same without the rigid motion of the best fit, for a volume whose reference is not stated. */
  best_fit?: FittedBudget | null;
  /** The machines drawn without the minimum zone, where it is the reference: it has no worst case, RSS and effects of single errors, so the other figures are without the least squares. */
  minimum_zone?: ZoneBudget | null;
  /** Tool poses of a file that the machine reaches. */
  tool_poses?: ReachedToolPoses | null;
  /** The characteristics of features for which the job states tolerances, over the machines drawn. */
  characteristics?: CharacteristicResult[];
  /** The cheapest tolerances, if a goal was given. */
  goal?: ToleranceGoal | null;
  /** Contributions at the pose that was named. */
  at?: ContributionsAt | null;
}

/** Figures of a certificate: statistics of a field over poses. */
export interface CertifiedFigures {
  /** Deviation of the functional point, um. */
  position_um: Summary;
  /** Rotation of the tool, urad. */
  rotation_urad: Summary;
  /** Tilt of the tool axis, urad. */
  tool_axis_urad: Summary;
}

/** An axis of a chain, in machine coordinates at the zero pose. */
export interface ChainAxis {
  /** Name of the axis. */
  name: string;
  /** Linear or rotary. */
  kind: AxisKind;
  /** The branch that the axis stands on. */
  side: Branch;
  /** Sense of the positive direction. */
  sense: Sense;
  /** Unit vector. */
  direction: [number, number, number];
  /** Point about which angular errors turn, mm. */
  origin_mm: [number, number, number];
  /** Limits in `unit`; 0 and 360 for a continuous axis. */
  travel: [number, number];
  /** True if the axis turns without end. */
  continuous: boolean;
  /** `mm` or `deg`. */
  unit: string;
  /** Arms from the point about which angular errors turn to the functional point. */
  arm_mm: Arm;
  /** True if the file states the geometry for the side on which the axis stands. */
  geometry_stated: boolean;
  /** Geometry that the file states for the other side. */
  other_side: OtherSide | null;
}

/** A mesh that a body is drawn by. */
export interface ChainMesh {
  /** `bed`, `workpiece`, `tool`, or the name of an axis. */
  body: string;
  /** Path of its file. */
  file: string;
  /** Unit of its coordinates, mm; null for that of its format. */
  unit_mm: number | null;
  /** Place of its origin, mm. */
  origin_mm: [number, number, number];
  /** Angles A, B, C by which it is turned about X, then Y, then Z, deg. */
  rotation_deg: [number, number, number];
}

/** The kinematic chain of a machine. */
export interface ChainResult {
  /** Name of the machine. */
  machine: string;
  /** The chain from workpiece to tool, such as `w C' A' Y' b X Z t`. */
  chain: string;
  /** The axes in the order of the chain. */
  axes: ChainAxis[];
  /** The tools. */
  tools: ChainTool[];
  /** Origin of the workpiece in machine coordinates at the zero pose, mm. */
  workpiece_origin_mm: [number, number, number];
  /** Angles A, B, C by which the workpiece's coordinates are turned about X, then Y, then Z of the machine, deg. */
  workpiece_rotation_deg: [number, number, number];
  /** Unit vector upwards in the picture, in machine coordinates; none where the file states none. */
  up: [number, number, number] | null;
  /** Meshes that bodies are drawn by. */
  look: ChainMesh[];
  /** The conventions in force. */
  conventions: Conventions;
  /** The location errors. */
  location_errors: LocationErrors;
  /** The files that the machine was read from. */
  inputs: InputFile[];
}

/** A tool, in machine coordinates at the zero pose. */
export interface ChainTool {
  /** Name of the tool; may be empty. */
  name: string;
  /** Gauge point, mm. */
  gauge_mm: [number, number, number];
  /** Functional point, mm. */
  tip_mm: [number, number, number];
  /** Unit vector of its axis, from the tip towards the spindle. */
  direction: [number, number, number];
}

/** A geometrical characteristic (ISO 1101). */
export type CharacteristicKind = "straightness" | "flatness" | "roundness" | "cylindricity" | "profile" | "position" | "parallelism" | "perpendicularity" | "angularity";

/** The part of an error in a characteristic. */
export interface CharacteristicPart {
  /** Name of the error; `values` for all errors with values beside bounds. */
  error: string;
  /** Its part, um, first order; the parts of all errors sum up to the value. */
  um: number;
  /** The same as a fraction of the value. */
  share: number;
}

/** A characteristic of a feature (ISO 1101) with its tolerance. */
export interface CharacteristicResult {
  /** Name of the feature. */
  feature: string;
  /** The characteristic. */
  kind: CharacteristicKind;
  /** Name of the datum feature. */
  datum?: string | null;
  /** The fit by which it is judged. */
  fit: ZoneFit;
  /** Its largest value, um. */
  tolerance_um: number | null;
  /** Number of its points that are reached. */
  poses: number;
  /** Number of its points, and those of its datum, that are not. */
  unreached: number;
  /** The reason why the points in reach do not carry it. */
  lacks?: string | null;
  /** Its value by the errors that have values, um. */
  value_um: number | null;
  /** Width of the narrowest zone, um; none where nothing is fitted. */
  minimum_zone_um: number | null;
  /** Width of the zone about the least-squares feature, um; none where nothing is fitted. */
  least_squares_um: number | null;
  /** Interval of the value by the uncertainty of the errors, 95 %, um. */
  interval_um?: [number, number] | null;
  /** True if the value is within the tolerance; none where it is, but points are out of reach. */
  holds: boolean | null;
  /** The values of machines drawn between the bounds of errors. */
  drawn?: DrawnCharacteristic | null;
  /** The parts of errors in the value, or in the 95 % value of the machines drawn, largest first. */
  errors: CharacteristicPart[];
}

/** Figures of two places on the tool poses that both reach. */
export interface CommonFigures {
  /** Number of these tool poses. */
  poses: number;
  /** 95 % value at the place of the job, um. */
  own_p95_um: number;
  /** The same at the best place. */
  best_p95_um: number;
  /** The first less the second. */
  p95_um: number;
  /** Largest deviation at the place of the job, um. */
  own_max_um: number;
  /** The same at the best place. */
  best_max_um: number;
  /** Figure of the ranking at the place of the job, um. */
  own_um: number;
  /** The same at the best place. */
  best_um: number;
  /** The best place against that of the job, on the same machines; none where no machines are drawn, and where the path has other rewinds. */
  versus_own?: VersusFirst | null;
}

/** Machines side by side, over the tool poses that all of them reach. */
export interface CompareResult {
  /** What the comparison is over. */
  over: Over;
  /** Effect of each error alone, largest first. */
  contributions: ErrorContribution[];
  /** Number of tool poses asked for. */
  asked: number;
  /** Number of tool poses that all machines reach. */
  poses: number;
  /** Seed of the tool poses, and of the errors that are drawn. */
  seed: number;
  /** Frame of the vectors: the workpiece frame. */
  frame: Frame;
  /** Side of approach. */
  direction: Approach;
  /** The machines in their order. */
  machines: ComparedMachine[];
  /** Budgets on the same work, where every machine bounds errors. */
  budgets?: ComparedBudgets | null;
  /** The same without the best fit of each machine, where neither tool poses nor a reference are given. */
  best_fit?: FittedComparison | null;
  /** The verdict on each machine but the first. */
  verdicts: MachineVerdict[];
}

/** Intervals of the statistics of a machine beside another. Machines share the uncertainty that both files state. */
export interface ComparedBands {
  /** Number of independent parts of the uncertainty. */
  parts: number;
  /** Number of poses at which they were followed. */
  poses: number;
  /** True if the intervals were drawn, false if they are to first order (k = 2). */
  drawn: boolean;
  /** Position deviations of the functional point, um. */
  position_um: SummaryBand;
  /** Rotations of the tool, urad. */
  rotation_urad: SummaryBand;
  /** Those of its statistics minus the first machine's. */
  minus_first: Bands;
  /** True if the 95 % position deviation differs from the first machine's by more than the uncertainty. */
  told_apart: boolean;
}

/** What the bounds of a machine lead to on the tool poses, where nothing is measured. */
export interface ComparedBounds {
  /** Number of bounded errors. */
  errors: number;
  /** The class that bounds what the machine file does not. */
  class: string | null;
  /** Source of the class. */
  class_source: string | null;
  /** Number of machines drawn. */
  samples: number;
  /** Seed of poses and errors. */
  seed: number;
  /** Distribution of an error between its bounds. */
  distribution: Distribution;
  /** Statistic of a machine over the poses. */
  statistic: Statistic;
  /** The position deviation, um. */
  position_um: BoundedLengths;
  /** The rotation of the tool, urad. */
  rotation_urad: BoundedLengths;
  /** The statistics of the RSS minus those of the first machine. */
  rss_minus_first: RssDifference | null;
}

/** The budget of a machine beside others. */
export interface ComparedBudget {
  /** Number of bounded errors. */
  errors: number;
  /** Number of these that the class bounds; the machine file bounds the others. */
  errors_by_class: number;
  /** Number of errors that act and have neither a value nor a bound. */
  unbounded: number;
  /** The position deviation, um. */
  position_um: DeviationBudget;
  /** The rotation of the tool, urad. */
  rotation_urad: DeviationBudget;
  /** Minus the figures of the first machine. */
  minus_first: BudgetDifference;
  /** The class that bounds what the machine file does not. */
  class: string | null;
  /** Source of the class. */
  class_source: string | null;
  /** Number of errors that have values and are left out, for bounds of a class stand for them. */
  left_out: number;
  /** The errors with values that act in every machine drawn, if there are any. */
  with_values?: ActingValues | null;
}

/** Budgets on the same work. */
export interface ComparedBudgets {
  /** The budget of each machine. */
  machines: ComparedBudget[];
  /** Effect of the error that is first in `contributions`, um. */
  largest_um: number;
  /** Error by error, largest first. */
  contributions: ComparedContribution[];
  /** The class that bounds what the machine file does not. */
  class: string | null;
  /** Source of the class. */
  class_source: string | null;
  /** Number of machines drawn. */
  samples: number;
  /** Seed of poses and errors. */
  seed: number;
  /** Distribution of an error between its bounds. */
  distribution: Distribution;
  /** Statistic of a machine over the poses. */
  statistic: Statistic;
  /** Number of machines that are drawn at most, if the first ones do not tell the machines apart. */
  max_samples: number;
  /** The 95 % value of the position of each machine but the first, minus that of the first. */
  versus_first_p95_um: ComparedVerdict[];
}

/** An error in several budgets; a list has a value for each machine, none where a machine does not bound it. */
export interface ComparedContribution {
  /** Name of the error. */
  error: string;
  /** `um` or `urad`. */
  unit: string;
  /** Its tolerance, in `unit`. */
  tolerance: (number | null)[];
  /** Its part of the 95 % value, um. */
  um_of_p95: (number | null)[];
  /** Standard error of that part, um. */
  um_of_p95_sigma: (number | null)[];
  /** That part minus that of the first machine, um. */
  minus_first: number[];
  /** Its effect averaged over the poses, um. */
  average_um: (number | null)[];
}

/** One machine of a comparison. */
export interface ComparedMachine {
  /** Name of the machine. */
  machine: string;
  /** Name of its file. */
  file: string;
  /** Order of its errors. */
  order: Order;
  /** Number of tool poses that it does not reach, by reason. */
  unreachable: UnreachableCount;
  /** `bounds` where nothing is measured: then the statistics are of the 95 % value at each tool pose. */
  from?: string | null;
  /** What its bounds lead to, where nothing is measured. */
  bounds?: ComparedBounds | null;
  /** What bounds of errors without a value add to the measured ones. */
  bounds_add?: AddedByBounds | null;
  /** Statistics of the deviation of the functional point, um. */
  position_um: Summary;
  /** Statistics of the deviation of the orientation of the tool, urad. */
  rotation_urad: Summary;
  /** The statistics minus those of the first machine: negative is better than the first. None where of only one of the two nothing is measured. */
  minus_first: Difference | null;
  /** Intervals of its statistics, and of these minus those of the first machine, where any of the files states uncertainties of errors. */
  uncertainty?: ComparedBands | null;
  /** Rows of a file of tool poses that it does not reach. */
  missed?: MissedToolPose[] | null;
  /** The travel that the tool poses of a file need, axis by axis. */
  travel?: NeededTravel[] | null;
  /** Its 95 % value against the limit of the job, if it states one: of its budget, or else of its measured errors. */
  limit?: LimitVerdict | null;
  /** Events of the path, if the tool poses are one. */
  path?: PathResult | null;
}

/** A machine against the first, on the machines drawn of both. */
export interface ComparedVerdict {
  /** The verdict on the two; none if errors that only one of the files bounds could turn it. */
  verdict: Verdict | null;
  /** Its 95 % value minus that of the first, um. The intervals of all pairs and all rounds hold together with 95 % confidence. */
  minus_first: PairedDifference;
  /** The same with the other machine's bounds for what only one of them bounds: like with like. None where both bound the same errors, and without a verdict. */
  minus_first_alike?: PairedDifference | null;
  /** The reason why there is no verdict. */
  withheld?: WithheldVerdict | null;
}

/** Contributions at a pose. */
export interface ContributionsAt {
  /** The pose, mm and deg. */
  axes: Record<string, number>;
  /** Effect of each error at its bound, largest first. */
  contributions: BoundedContribution[];
}

/** The conventions in force for a machine. */
export interface Conventions {
  /** The action of location errors. */
  location: Location;
  /** Component errors of linear axes. */
  linear: LinearOrder;
  /** Component errors of rotary axes. */
  rotary: RotaryOrder;
  /** Sense of workpiece-side axes. */
  workpiece_axes: Sense;
  /** Owner of the errors of workpiece-side axes. */
  errors_are: ErrorsAre;
  /** Order of location errors. */
  location_order: LocationOrder;
  /** Shape of error matrices. */
  joints: Joints;
  /** Order used when the command line names none (`hrdina-vasik-2014` is of order 1, `holub-2015` of order 2); `None` is exact. */
  default_order: number | null;
}

/** Counts of the known errors among those that act in a machine's own chain: six of each axis, and the location errors that are no choice of coordinates. */
export interface Coverage {
  /** Number of errors with a value that no bound stands for. */
  valued: number;
  /** Number of errors that are bounded, by the file or by a class. */
  bounded: number;
  /** Names of the errors that have neither. None on a machine with measured values and no bounds: what it does not state is zero. */
  missing: string[];
}

/** The part of a deviation that all monomials of one degree make. */
export interface DegreePart {
  /** Total degree; 0 of location errors in the real part. */
  degree: number;
  /** Displacement of the functional point, mm. */
  deviation: [number, number, number];
  /** Rotation of the tool, rad. */
  rotation: [number, number, number];
  /** `T_tool^-1 T_work`, row by row. */
  e_ve: [[number, number, number, number], [number, number, number, number], [number, number, number, number], [number, number, number, number]];
}

/** A deviation, as bounds lead to it. */
export interface DeviationBudget {
  /** Sum of the effects of all bounds, at the pose where it is largest. */
  worst_case: number;
  /** Root of the sum of their squares, at the pose where it is largest. */
  rss: number;
  /** Mean of both. */
  mean_of_both: number;
  /** Pose of the worst case, mm and deg. */
  worst_case_at: Record<string, number>;
  /** Pose of the largest RSS, mm and deg. */
  rss_at: Record<string, number>;
  /** Machines drawn between the bounds. */
  monte_carlo: DrawnMachineFigures;
}

/** Figures of a deviation minus those of another. */
export interface DeviationBudgetDifference {
  /** Difference of the worst cases. */
  worst_case: number;
  /** Difference of the RSS values. */
  rss: number;
  /** Difference of the means of both. */
  mean_of_both: number;
  /** Differences of the figures of machines drawn. */
  monte_carlo: DrawnDifference;
}

/** The largest change of the position deviation from one row to the next that is in reach, rewinds apart: the step that it leaves in the part. */
export interface DeviationStep {
  /** Length of the change, um, workpiece frame; of machines drawn between bounds the one that 95 % do not exceed. */
  um: number;
  /** The interval in which it lies, um; none where it is not drawn. */
  interval_um?: [number, number] | null;
  /** True if machines are drawn between bounds. */
  drawn: boolean;
  /** Lines of the file before and after it; of machines drawn in the one whose step that is. */
  lines: [number, number];
}

/** A laser along a diagonal. */
export interface Diagonal {
  /** Sense of each axis along it: p or n, in the order of `axes`. */
  name: string;
  /** Names of the axes. */
  axes: string[];
  /** E_d, um: range of both runs, the bidirectional systematic deviation E of ISO 230-2. */
  e_d_um: number;
  /** B_d, um: largest difference of both runs. */
  b_d_um: number;
  /** Sum of the changes of the reading by each axis's motions on the forward run, um; with steps only. */
  by_axis_um: number[] | null;
  /** Nominal displacement from the start, mm. */
  way_mm: number[];
  /** Actual minus nominal on the forward run, um; 0 at the start. */
  there_um: number[];
  /** Actual minus nominal on the return run, um, in the order of `way_mm`. */
  back_um: number[];
}

/** Statistics minus statistics. */
export interface Difference {
  /** Position deviations of the functional point, um. */
  position_um: Summary;
  /** Rotations of the tool, urad. */
  rotation_urad: Summary;
}

/** The kind of a set of directions. */
export type DirectionKind = "one" | "circle" | "hemisphere" | "listed";

/** The distribution of an error between its bounds. */
export type Distribution = "uniform" | "triangular";

/** An error in the deviation at a pose. */
export interface DominatingError {
  /** Name of the error. */
  error: string;
  /** Its part along the deviation, first order, um. */
  um: number;
}

/** Settings of the machines drawn for a budget. */
export interface DrawSettings {
  /** The class that bounds what the machine file does not. */
  class: string | null;
  /** Source of the class. */
  class_source: string | null;
  /** Number of machines drawn. */
  samples: number;
  /** Seed of poses and errors. */
  seed: number;
  /** Distribution of an error between its bounds. */
  distribution: Distribution;
  /** Statistic of a machine over the poses. */
  statistic: Statistic;
}

/** A characteristic over machines drawn between the bounds of errors. */
export interface DrawnCharacteristic {
  /** Number of machines drawn. */
  samples: number;
  /** Median, um. */
  median_um: number;
  /** The value that 95 % of the machines do not exceed, um, with its 95 % confidence interval. */
  p95_um: Percentile;
  /** The fraction of the machines that hold the tolerance at the points in reach, with its 95 % interval (Wilson): while points are out of reach, an upper limit. */
  holds: Proportion | null;
}

/** Figures of machines drawn minus those of others. */
export interface DrawnDifference {
  /** Difference of the means. */
  mean: number;
  /** Difference of the 95 % values. */
  p95: number;
}

/** Figures of machines drawn. */
export interface DrawnMachineFigures {
  /** Mean. */
  mean: number;
  /** Standard error of the mean. */
  mean_sigma: number;
  /** Value that 95 % of the machines do not exceed. */
  p95: number;
  /** Percentiles by name, such as `p95`. */
  percentiles: Record<string, PercentileInterval>;
}

/** Fractions that files take off the figure that decides, over machines drawn between bounds: 1 is all of it. */
export interface DrawnRepair {
  /** Number of machines drawn. */
  machines: number;
  /** The least. */
  least: number;
  /** The median; of an even number the lower one. */
  median: number;
  /** The most. */
  most: number;
}

/** Effect of an error alone in each machine. */
export interface ErrorContribution {
  /** Name of the error. */
  error: string;
  /** 95 % position deviation with only this error, first order, um, by machine; none without a value. */
  um: (number | null)[];
  /** The same minus that of the first machine. */
  minus_first: number[];
}

/** Counts of the errors of a machine. */
export interface ErrorCounts {
  /** Location errors with a value. */
  location: number;
  /** Component errors with a value. */
  component: number;
  /** Bounds that the file states: of errors, of axes and of squareness. */
  tolerance: number;
}

/** Effect of an error, or of a pair of errors, at a pose; workpiece frame. */
export interface ErrorEffect {
  /** Name of the error; of a pair `A*B`. */
  error: string;
  /** Displacement of the functional point when each error is 1 mm or 1 rad, mm. */
  deviation: [number, number, number];
  /** Rotation of the tool, rad. */
  rotation: [number, number, number];
  /** Product of the values of the errors at the pose, mm and rad. */
  value: number;
}

export type ErrorId = string;

/** The kind of an error. */
export type ErrorKind = "positioning" | "straightness" | "angular" | "squareness" | "position" | "orientation" | "radial" | "axial" | "tilt" | "angular_positioning";

/** One error alone, first order. */
export interface ErrorSource {
  /** Name of the error. */
  error: ErrorId;
  /** What it is, in words. */
  words: string;
  /** 95 % of the poses have a smaller position deviation, um. */
  p95_um: number;
  /** Largest position deviation, um. */
  max_um: number;
  /** 95 % of the poses have a smaller rotation of the tool, urad. */
  p95_urad: number;
  /** Its part along the deviation at one pose, um: the parts of all errors are, to first order, its length. */
  at_um: number;
}

/** Each error that has a value, alone. */
export interface ErrorSources {
  /** Name of the machine. */
  machine: string;
  /** Poses and reference of the effects. */
  over: Over;
  /** Number of poses. */
  poses: number;
  /** Seed of the poses. */
  seed: number;
  /** The pose of [`ErrorSource::at_um`], mm and deg. */
  at: Record<string, number>;
  /** The errors, largest 95 % position deviation first. */
  errors: ErrorSource[];
}

/** The body whose error motion the numbers of a workpiece-side axis describe. */
export type ErrorsAre = "tool_relative" | "body";

/** Deviations at poses. */
export interface EvalResult {
  /** Name of the machine. */
  machine: string;
  /** `exact`, a degree, or the algebra in words. */
  order: string;
  /** The algebra asked for. */
  algebra?: AlgebraResult | null;
  /** Frame of the vectors. */
  frame: Frame;
  /** Side of approach. */
  direction: Approach;
  /** Name of the tool; empty for a tool without a name. */
  tool: string;
  /** What the result is over, for a job or a reference, and where something is taken out of the deviations. */
  over?: Over | null;
  /** Events of the path, if the tool poses are one. */
  path?: PathResult | null;
  /** Units of the numbers. */
  units: EvalUnits;
  /** The poses in their order. */
  poses: PoseResult[];
}

/** Units of an [`EvalResult`]. */
export interface EvalUnits {
  /** Unit of positions and deviations of points. */
  position: string;
  /** Unit of rotations. */
  rotation: string;
  /** Unit of positions of linear axes. */
  linear_axis: string;
  /** Unit of positions of rotary axes. */
  rotary_axis: string;
}

/** A feature of the work: rows of a file with the same label. */
export interface FeatureResult {
  /** Its label; empty for rows without. */
  feature: string;
  /** Number of its tool poses that are reached. */
  poses: number;
  /** Number of those that are not. */
  unreached: number;
  /** Largest deviation of the functional point, um; none without a pose. */
  max_um: number | null;
  /** Deviation below which 95 % of its poses lie, um. */
  p95_um: number | null;
  /** Line of the file with the largest deviation. */
  line: number | null;
  /** The pose there, mm and deg. */
  axes: Record<string, number> | null;
  /** The errors with the largest parts in that deviation. */
  errors: DominatingError[];
}

/** A budget without the rigid motion of the part that fits the deviations best. */
export interface FittedBudget {
  /** Poses and reference that it is over. */
  over: Over;
  /** The position deviation, um. */
  position_um: DeviationBudget;
  /** The rotation of the tool, urad. */
  rotation_urad: DeviationBudget;
  /** The error whose tolerance to tighten first. */
  tighten_first: string;
  /** True if that is the same error in machine coordinates. */
  agrees: boolean;
}

/** Machines side by side without the rigid motion of the part that fits the deviations of each best. */
export interface FittedComparison {
  /** Poses and reference that it is over. */
  over: Over;
  /** The machines in their order. */
  machines: FittedMachine[];
  /** The 95 % value of the position of each machine but the first, minus that of the first, where budgets are compared. */
  versus_first_p95_um?: ComparedVerdict[];
}

/** One machine of a comparison without the best fit. */
export interface FittedMachine {
  /** Statistics of the deviation of the functional point, um. */
  position_um: Summary;
  /** Statistics of the deviation of the orientation of the tool, urad. */
  rotation_urad: Summary;
  /** The statistics minus those of the first machine; none where of only one of the two nothing is measured. */
  minus_first: Difference | null;
  /** The 95 % value of its budget, um. */
  budget_p95_um?: number | null;
}

/** Frame of vectors; all are parallel to the machine frame at the zero pose, but for the rotation of the workpiece. */
export type Frame = "workpiece" | "machine" | "tool";

/** The cost of tolerances. */
export interface GoalCost {
  /** Its unit. */
  unit: string;
  /** Power of the tolerance in the cost; none where the cost is relative to the present tolerances, weight x (present / new - 1). */
  power: number | null;
  /** Value with the old tolerances. */
  before: number;
  /** Value with the new tolerances. */
  after: number;
  /** Cost of lowering the 95 % value by one um; none if no tolerance is free. */
  per_um: number | null;
}

/** A tolerance for a goal. */
export interface GoalTolerance {
  /** Name of the error. */
  error: string;
  /** The kind by which it is paid for. */
  kind: ErrorKind;
  /** `um` or `urad`. */
  unit: string;
  /** Before, in `unit`. */
  old: number;
  /** After, in `unit`. */
  new: number;
  /** The limit that holds it. */
  binds: Binding;
  /** Its part of the 95 % value, um. */
  um_of_p95: number;
  /** Its weight in the cost. */
  weight: number;
  /** Its cost before. */
  cost_before: number;
  /** Its cost after. */
  cost_after: number;
}

/** A file that a machine was read from. */
export interface InputFile {
  /** Its path, as it was named. */
  file: string;
  /** SHA-256 of its text, hexadecimal. */
  sha256: string;
  /** True if it is outside the folder of the machine file, links resolved. */
  outside: boolean;
}

/** Readings of an instrument on a machine, exact model. */
export type InstrumentResult = {
  /** Name of the machine. */
  machine: string;
  /** Readings to which the bounds of a machine lead of which nothing is measured; the others are then zero. */
  bounds?: ReadingsOfBounds | null;
} & ({
  instrument: "ball_bar";
  /** Centre of the circles, mm and deg. */
  centre: Record<string, number>;
  /** Length of the ball bar, mm. */
  radius_mm: number;
  /** The circles, plane by plane. */
  planes: BallBar[];
} | {
  instrument: "r_test";
  /** Pose at which the ball is, mm and deg. */
  ball_at: Record<string, number>;
  /** Frame of the readings: the machine frame. */
  frame: Frame;
  /** The tests, axis by axis. */
  axes: RTest[];
} | {
  instrument: "diagonals";
} & LaserReadings | {
  instrument: "step_diagonals";
} & LaserReadings);

/** A pose at which the tool is parallel to a rotary axis: the position alone is solved for. */
export interface InversePole {
  /** The rotary axis that is free: it does not turn the tool axis. */
  free: string;
  /** Unit vector across the tool axis, workpiece frame, into which no axis turns it. */
  unreachable: [number, number, number];
}

/** Shape of an error matrix. */
export type Joints = "orthogonal" | "linearised";

/** The figure of the position deviation by which a machine is judged, minus that of the first machine. */
export interface JudgedDifference {
  /** True if it is the value that 95 % of machines drawn do not exceed. */
  drawn: boolean;
  /** The class whose bounds stand for the values of both machines, where these are left out. */
  class?: string | null;
  /** True if what only one of the machines bounds has the bounds of the other one in both. */
  alike: boolean;
  /** The figure of a machine over the poses. */
  statistic: Statistic;
  /** The difference, um: negative is better than the first. */
  um: number;
  /** Lower end of its interval, um, if it has one. */
  low?: number | null;
  /** Upper end of its interval, um, if it has one. */
  high?: number | null;
}

/** Tool poses that lack the same, with the largest amount. */
export interface Lack {
  /** The reason. */
  why: Unreachable;
  /** Name of the axis that would leave its travel; none for the other reasons. */
  axis?: string | null;
  /** The end of its travel, mm or deg. */
  end?: number | null;
  /** True if it would have to go above that end, false below it. */
  above?: boolean | null;
  /** Number of tool poses; one that several axes stop counts for each of them. */
  tool_poses: number;
  /** Largest amount, in `unit`; none where it is not known. */
  up_to?: number | null;
  /** `mm` or `deg`. */
  unit?: string | null;
}

/** Readings of a laser along diagonals. */
export interface LaserReadings {
  /** Pose of the axes that stand, mm and deg. */
  at: Record<string, number>;
  /** The diagonals, at least one. */
  diagonals: Diagonal[];
  /** The largest E_d, um. */
  e_um: number;
}

/** Statistics of lengths, or of lengths minus those of others. */
export interface LengthStatistics {
  /** Largest. */
  max: number;
  /** Mean. */
  mean: number;
  /** Root of the mean square. */
  rms: number;
  /** The ceil(0.95 n)-th smallest. */
  p95: number;
}

/** A figure against the limit of a job. */
export interface LimitVerdict {
  /** The limit, um. */
  limit_um: number;
  /** The position deviation that is judged, um: the statistic over the poses; of machines drawn the value that 95 % of them do not exceed. */
  um: number;
  /** The interval in which it lies, um: of machines drawn by their number, else by the uncertainties of errors that the file states; none without such. */
  interval_um?: [number, number] | null;
  /** The figure of a machine over the poses. */
  statistic: Statistic;
  /** True if machines are drawn between bounds; errors with values act in each. */
  drawn: boolean;
  /** Number of tool poses of the job that are out of reach. */
  missed: number;
  /** True if errors or bounds of the machine are left out of the figure, so that it decides nothing. */
  partial?: boolean;
  /** The errors with neither value nor bound that could turn the verdict, if there are any. */
  missing?: MissingInLimit | null;
  /** True if the limit is held; none where the interval is on both sides of it, where it is not exceeded but tool poses are out of reach, so that the job is not done, where errors or bounds are left out of the figure, and where missing errors could turn it. */
  held: boolean | null;
}

/** The side of the motion on which the component errors of a linear axis act. */
export type LinearOrder = "after" | "before";

/** The action of a location error. */
export type Location = "axis_only" | "carried_body";

/** A location error that a chain needs. */
export interface LocationError {
  /** Name of the error. */
  error: ErrorId;
  /** Status of its value. */
  status: Status;
}

/** The location errors of a chain. */
export interface LocationErrors {
  /** Those that the chain needs. */
  set: LocationError[];
  /** Names of those that are given besides. */
  besides: ErrorId[];
}

/** The order of location errors. */
export type LocationOrder = "nilpotent" | "real";

/** A machine in short, as `check` prints it. */
export interface MachineSummary {
  /** Name of the machine. */
  machine: string;
  /** The kinematic chain from workpiece to tool, such as `w C' A' Y' b X Z t`. */
  chain: string;
  /** The axes in the order of the chain. */
  axes: AxisSummary[];
  /** Names of the tools; empty for a tool without a name. */
  tools: string[];
  /** The conventions in force. */
  conventions: Conventions;
  /** Counts of the errors. */
  errors: ErrorCounts;
  /** Which of the errors that act are known, by the file and the class that it names. */
  coverage: Coverage;
  /** The files that the machine was read from. */
  inputs: InputFile[];
}

/** The verdict on a machine. */
export interface MachineVerdict {
  /** Number of the machine, from 1. */
  machine: number;
  /** Its 95 % value against that of the first; none where that depends on the reference, or is not known. */
  verdict: Verdict | null;
  /** The difference by which it is judged; none without a verdict. */
  by?: JudgedDifference | null;
  /** The reason why there is none. */
  reason?: string | null;
}

/** What the bounds of a machine lead to over a map. */
export interface MapFromBounds {
  /** Number of bounded errors. */
  errors: number;
  /** The class that bounds what the machine file does not. */
  class: string | null;
  /** Source of the class. */
  class_source: string | null;
  /** Number of machines drawn. */
  samples: number;
  /** Seed of poses and errors. */
  seed: number;
  /** Distribution of an error between its bounds. */
  distribution: Distribution;
  /** Statistic of a machine over the poses. */
  statistic: Statistic;
  /** The position deviation, um. */
  position_um: BoundedLengths;
  /** The rotation of the tool, urad. */
  rotation_urad: BoundedLengths;
  /** The worst poses, largest 95 % value of the position deviation first. */
  worst: WorstBoundedPose[];
}

/** A map of deviations, actual minus nominal; of a machine of which nothing is measured, of what its bounds lead to. */
export interface MapResult {
  /** Name of the machine. */
  machine: string;
  /** `exact`, or a degree. */
  order: Order;
  /** Degree in the errors, if the part of one degree alone is mapped. */
  degree?: number | null;
  /** Frame of the vectors. */
  frame: Frame;
  /** Side of approach. */
  direction: Approach;
  /** What the map is over. */
  over: Over;
  /** Events of the path, if the tool poses are one. */
  path?: PathResult | null;
  /** The 95 % value of the position against the limit of the job, if it states one. */
  limit?: LimitVerdict | null;
  /** Number of poses. */
  poses: number;
  /** `bounds` where nothing is measured: then the statistics are of the 95 % value at each pose. */
  from?: string | null;
  /** What the bounds lead to, where nothing is measured. */
  bounds?: MapFromBounds | null;
  /** What bounds of errors without a value add to the measured ones. */
  bounds_add?: AddedByBounds | null;
  /** Statistics of the deviation of the functional point, um. */
  position_um: Summary;
  /** Statistics of the deviation of the orientation of the tool, urad. */
  rotation_urad: Summary;
  /** Intervals of the statistics, where the machine file states uncertainties of errors. */
  uncertainty?: Bands | null;
  /** The value that 95 % of the whole volume keeps, um, with its interval by the number of random poses; of random poses alone. */
  p95_over_volume?: Percentile | null;
  /** The poses beyond the ranges in which the curves of the axes were measured. */
  beyond_measured?: BeyondMeasured | null;
  /** The worst poses, largest deviation of the functional point first. */
  worst: WorstPose[];
  /** The body diagonals of the volume; none of a job. */
  diagonals: BodyDiagonal[];
  /** Relative error of the 95 % values, for a map of more than [`MapPoses::MAX_HELD`] poses. */
  p95_relative_error?: number | null;
  /** Tool poses of a file, with those that the machine reaches. */
  tool_poses?: ReachedToolPoses | null;
  /** The features of the file, where it names some: the largest deviation on each. */
  features?: FeatureResult[];
  /** The characteristics of features for which the job states tolerances. */
  characteristics?: CharacteristicResult[];
  /** The target whose compensation is in the map. */
  target?: string | null;
  /** The same without compensation, for a map with. */
  uncompensated?: Uncompensated | null;
}

/** A tool pose that a machine does not reach. */
export interface MissedToolPose {
  /** Line of the file, from 1. */
  line: number;
  /** Name of the feature to which it belongs. */
  feature?: string | null;
  /** The reason. */
  why: Unreachable;
  /** The axes that would leave their travel. */
  beyond?: BeyondTravel[];
  /** Angle between the tool axis and the nearest direction in which the machine can hold its tool, deg. */
  off_deg?: number | null;
  /** Distance of the place from those that the axes span, mm. */
  off_mm?: number | null;
  /** True if no pose was found, without a proof that there is none. */
  not_proved?: boolean;
}

/** Errors with neither value nor bound that could turn a limit that is held without them. */
export interface MissingInLimit {
  /** Number of these errors. */
  errors: number;
  /** The class that has bounds for them. */
  class: string;
  /** The figure with these bounds, um; none where it was not asked for, place by place. */
  um?: number | null;
}

/** The part of a deviation that one monomial in the generators makes, with the errors as large as they are. */
export interface MonomialPart {
  /** `EXX*EC0Y^2`; `i^2` of an order; `1` of location errors in the real part. */
  monomial: string;
  /** Displacement of the functional point, mm. */
  deviation: [number, number, number];
  /** Rotation of the tool, rad. */
  rotation: [number, number, number];
  /** `T_tool^-1 T_work`, row by row. */
  e_ve: [[number, number, number, number], [number, number, number, number], [number, number, number, number], [number, number, number, number]];
}

/** The travel that a work needs of an axis, and the travel that it has. */
export interface NeededTravel {
  /** Name of the axis. */
  axis: string;
  /** `mm` or `deg`. */
  unit: string;
  /** Smallest and largest position over the tool poses that are reached, or would be with longer travels. */
  needs: [number, number];
  /** Ends of the travel; none of a continuous axis. */
  has: [number, number] | null;
  /** Length by which the travel is too short at its lower and its upper end. */
  short: [number, number];
}

/** Bound of the terms that order 1 neglects: all interactions of second degree with one sign. */
export interface Neglected {
  /** Displacement of the functional point, mm. */
  position_mm: number;
  /** Rotation of the tool, rad. */
  rotation_rad: number;
}

/** The order to which errors are followed; as text `exact` or `1` to `6`. */
export type Order = string;

/** Geometry of an axis for the side on which it does not stand, the other axes staying where they are. */
export interface OtherSide {
  /** The other branch. */
  side: Branch;
  /** Unit vector. */
  direction: [number, number, number];
  /** Point about which angular errors turn, mm. */
  origin_mm: [number, number, number];
  /** Limits in the unit of the axis; 0 and 360 for a continuous axis. */
  travel: [number, number];
  /** True if the axis turns without end. */
  continuous: boolean;
}

/** What a result is over. */
export interface Over {
  /** A volume, a job, or poses of the axes. */
  kind: OverKind;
  /** Motion that the part's set-up takes out. */
  reference: ReferenceKind;
  /** True if the best fit is the minimum zone. */
  minimum_zone?: boolean;
  /** True if the poses are one continuous path. */
  path: boolean;
  /** Number of poses asked for. */
  poses: number;
  /** Number of poses that are reached. */
  reached: number;
  /** Name of the tool; empty where the machine has one without a name. */
  tool: string;
}

/** What poses are of. */
export type OverKind = "volume" | "job" | "axis_poses";

/** The difference of two 95 % values with its interval; `None` where there are too few samples for an end. */
export interface PairedDifference {
  /** Of the samples. */
  value: number;
  /** Lower end. */
  low: number | null;
  /** Upper end. */
  high: number | null;
}

/** The motion of an axis along a path. */
export interface PathAxis {
  /** Its name. */
  axis: string;
  /** `mm` or `deg`. */
  unit: string;
  /** Sum of its motions, rewinds among them. */
  motion: number;
  /** Its largest motion from one row to the next, rewinds apart. */
  largest_step: number;
  /** The line after that step; none if it does not move. */
  largest_step_line: number | null;
  /** Lines of the file at which it reverses. */
  reversals: number[];
}

/** A passage near the line of a rotary axis. */
export interface PathPole {
  /** Name of the rotary axis. */
  axis: string;
  /** Lines of the file before and after it. */
  lines: [number, number];
  /** The line after the step that comes nearest. */
  nearest_line: number;
  /** Least angle between the tool and the axis, deg. */
  nearest_deg: number;
  /** Angle by which the axis turns meanwhile, deg. */
  turn_deg: number;
  /** Largest turn of the axis per motion of the tip, deg/mm; none if the axis turns while the tip stands. */
  deg_per_mm: number | null;
}

/** Events of a path on a machine. */
export interface PathResult {
  /** The steps in which the tool has to leave the path, in their order. */
  rewinds: PathRewind[];
  /** The passages near the line of a rotary axis, axis by axis. */
  pole_crossings: PathPole[];
  /** The motion of each axis. */
  axes: PathAxis[];
  /** The largest change of the position deviation from one row to the next, in a map. */
  deviation_step?: DeviationStep | null;
}

/** A step in which the tool has to leave the path. */
export interface PathRewind {
  /** Lines of the file before and after it. */
  lines: [number, number];
  /** Motions of the rotary axes, deg. */
  turns_deg: Record<string, number>;
}

/** A percentile of the population the samples come from. */
export interface Percentile {
  /** The percentile, in percent. */
  percent: number;
  /** The ceil(percent n / 100)-th smallest sample. */
  value: number;
  /** Lower end of the interval that holds it with 95 % confidence; `None` with too few samples. */
  low: number | null;
  /** Upper end. */
  high: number | null;
}

/** A percentile of machines drawn with its confidence interval; none where there are too few machines for one. */
export interface PercentileInterval {
  /** The percentile. */
  value: number;
  /** Lower end of its 95 % confidence interval. */
  low: number | null;
  /** Upper end of its 95 % confidence interval. */
  high: number | null;
}

/** Values of one number of a place. */
export interface PlaceRange {
  /** `X`, `Y`, `Z` of `origin`, or `A`, `B`, `C` of `rotation`, which turn about X, Y, Z. */
  of: string;
  /** `mm` or `deg`. */
  unit: string;
  /** The first and the last value. */
  ends: [number, number];
  /** Number of values at equal distances. */
  count: number;
}

/** The place of a part on the workpiece frame: a point p of the part lies at origin + Rz(c) Ry(b) Rx(a) p. */
export interface Placement {
  /** Origin of the part, mm. */
  origin: [number, number, number];
  /** Rotations about X, then Y, then Z of the workpiece frame, deg. */
  rotation: [number, number, number];
}

/** Gain of the best place over that of the job. */
export interface PlacementGain {
  /** Number of tool poses that it reaches more. */
  poses: number;
  /** Number of rewinds that it has less. */
  rewinds?: number | null;
  /** Margin that it has more, mm. */
  margin_mm?: number | null;
  /** The figures of both on the tool poses that both reach. */
  common?: CommonFigures | null;
}

/** Places of a part on a machine. */
export interface PlacementResult {
  /** Name of the machine. */
  machine: string;
  /** Poses and reference of the result; `reached` counts at the place of the job. */
  over: Over;
  /** `values` or `bounds`, from which the figures are; none for reach alone. */
  from?: string | null;
  /** The statistic of a machine over the tool poses, by which places are ranked; none for reach alone. */
  statistic?: Statistic | null;
  /** Settings of the machines drawn, where errors are bounded. */
  drawing?: DrawSettings | null;
  /** The ranges, in the order named. */
  ranges: PlaceRange[];
  /** Number of places that were tried; that of the job is one of them. */
  places: number;
  /** Number of places that reach all tool poses. */
  reach_all: number;
  /** Number of places that are ranked: those that reach the same tool poses, the most of all, and the reference. */
  ranked: number;
  /** Number of ranked places that the machines drawn do not tell apart from the best, or that are equal to it; none where no machines are drawn. */
  not_told_apart?: number | null;
  /** The place of the job. */
  own: TriedPlace;
  /** The best place; none if no tool pose is reached anywhere. */
  best?: TriedPlace | null;
  /** Ranges at whose end the best place lies. */
  at_end_of?: string[];
  /** Gain of the best place over that of the job. */
  gain?: PlacementGain | null;
  /** All places: those of the ranges, the first range running fastest, then that of the job if it is none of them. */
  tried: TriedPlace[];
}

/** A plane of the workpiece frame; the circle runs from its first to its second direction. */
export type Plane = "XY" | "YZ" | "ZX";

/** Deviation at one pose. */
export interface PoseResult {
  /** The pose, mm and deg. */
  axes: Record<string, number>;
  /** Nominal position of the functional point from the workpiece origin, mm. */
  nominal: [number, number, number];
  /** Actual minus nominal position of the functional point, mm. */
  deviation: [number, number, number];
  /** Actual minus nominal orientation of the tool, rad. */
  rotation: [number, number, number];
  /** The part of the deviation along the normal of the surface, out of the material, mm; none where the tool poses have no columns NX, NY, NZ. */
  along_normal?: number | null;
  /** `T_tool^-1 T_work`, actual minus nominal, row by row; of the machine, whatever the reference. */
  e_ve: [[number, number, number, number], [number, number, number, number], [number, number, number, number], [number, number, number, number]];
  /** Axes that the pose takes beyond the range in which their curves were measured. */
  beyond_measured?: string[];
  /** Expanded uncertainty of the deviation, where the machine states that of its errors. */
  uncertainty?: PoseUncertainty | null;
  /** Effect of each error, with [`EvalOptions::sensitivity`]. */
  sensitivity?: ErrorEffect[] | null;
  /** Effect of pairs of errors, with [`EvalOptions::interactions`]. */
  interactions?: ErrorEffect[] | null;
  /** Bound of the terms that order 1 neglects at this pose, with [`EvalOptions::interactions`]. */
  order_1_neglects?: Neglected | null;
  /** Parts of the monomials of an algebra, or of the powers of one generator with an order, lowest degree first; those that are 0 left out. */
  coefficients?: MonomialPart[] | null;
  /** Their sums by degree. */
  degrees?: DegreePart[] | null;
  /** Motions of the axes that undo the errors, mm and deg, with [`EvalOptions::inverse`]. */
  inverse?: Record<string, number> | null;
  /** The pole at which they hold the position alone: what is free, and what is left. */
  inverse_pole?: InversePole | null;
}

/** Expanded uncertainty (k = 2) of the deviation at a pose, component by component, to first order. */
export interface PoseUncertainty {
  /** Uncertainty of the position of the functional point, mm. */
  deviation: [number, number, number];
  /** Uncertainty of the orientation of the tool, rad. */
  rotation: [number, number, number];
}

/** The fraction of a population that has a property, by samples of it. */
export interface Proportion {
  /** The fraction of the samples, 0 to 1. */
  value: number;
  /** Lower end of its 95 % interval (Wilson). */
  low: number;
  /** Upper end. */
  high: number;
}

/** An R-test of rotary axes that turn together. */
export interface RTest {
  /** The axes that turn, such as `C` or `A+C`. */
  axis: string;
  /** Ranges of the readings along x, y, z, um. */
  range_um: [number, number, number];
  /** Number of readings. */
  count: number;
  /** Number of positions that the other axes cannot follow. */
  skipped: number;
  /** The readings. */
  readings: RTestReading[];
}

/** A reading of an R-test. */
export interface RTestReading {
  /** Position of the first axis that turns, deg. */
  position_deg: number;
  /** The pose, mm and deg. */
  axes: Record<string, number>;
  /** Deviation of the functional point from the ball, tool relative to workpiece, minus that at the first position, um, machine frame. */
  reading_um: [number, number, number];
}

/** Directions of the tool at every tip. */
export interface ReachDirections {
  /** `one`, `circle` (equal turns of an axis), `hemisphere` (equal areas) or `listed` (those of a job, one at each tip). */
  kind: DirectionKind;
  /** Number of directions. */
  count: number;
  /** The tool axis at rest, from the tip to the holder, workpiece frame. */
  about: [number, number, number];
}

/** The reach of a machine. */
export interface ReachResult {
  /** Name of the machine. */
  machine: string;
  /** Name of the tool; empty for a tool without a name. */
  tool: string;
  /** Poses and reference of the reach. */
  over: Over;
  /** Events of the path, if the tool poses are one. */
  path?: PathResult | null;
  /** Ends of the box along x, y, z of the workpiece frame, mm. */
  box_mm: [[number, number], [number, number], [number, number]];
  /** Number of tips along x, y, z; of a job all tips stand in one row. */
  counts: [number, number, number];
  /** Number of tips. */
  tips: number;
  /** The directions at every tip. */
  directions: ReachDirections;
  /** Number of tool poses: tips times directions. */
  tool_poses: number;
  /** Number of them that are reached. */
  reached: number;
  /** Their fraction. */
  share: number;
  /** Number of tips that are reached in all directions. */
  tips_in_all_directions: number;
  /** Number of tips that are reached in at least one. */
  tips_in_any_direction: number;
  /** Number of the tool poses out of reach, by reason. */
  unreachable: UnreachableCount;
  /** What they lack, the most frequent first. */
  lacks: Lack[];
  /** Tool poses of a job, row by row where they are out of reach. */
  job?: ReachedToolPoses | null;
}

/** Tool poses of a file that a machine reaches. */
export interface ReachedToolPoses {
  /** Name of the file. */
  file: string;
  /** Number of tool poses in the file. */
  asked: number;
  /** Number of tool poses that the machine reaches. */
  reached: number;
  /** Number of the others, by reason. */
  unreachable: UnreachableCount;
  /** The others, row by row. */
  rows: MissedToolPose[];
  /** The travel that the tool poses need, axis by axis. */
  travel: NeededTravel[];
}

/** Readings to which bounds lead, first order, without reversal. */
export interface ReadingsOfBounds {
  /** Number of bounded errors. */
  errors: number;
  /** The class that bounds what the machine file does not. */
  class: string | null;
  /** Source of the class. */
  class_source: string | null;
  /** Number of machines drawn. */
  samples: number;
  /** Seed of poses and errors. */
  seed: number;
  /** Distribution of an error between its bounds. */
  distribution: Distribution;
  /** Statistic of a machine over the poses. */
  statistic: Statistic;
  /** Circular deviation G(b) of each plane, ranges of an R-test along X, Y and Z, or E_d of each diagonal. */
  readings: BoundedReading[];
}

/** What is taken out of the deviations of a part. */
export type ReferenceKind = "machine" | "machine-less-unheld" | "zero" | "zero-less-unheld" | "datum" | "best-fit";

/** A target that has no files for a machine. */
export interface RefusedTarget {
  /** Its name. */
  target: string;
  /** Code of the diagnostic. */
  code: string;
  /** The reason. */
  why: string;
}

/** The side of the motion on which the component errors of a rotary axis act. */
export type RotaryOrder = "stationary" | "rotating";

/** Statistics of the RSS minus those of another machine. */
export interface RssDifference {
  /** Of the position, um. */
  position_um: LengthStatistics;
  /** Of the orientation, urad. */
  rotation_urad: LengthStatistics;
}

/** The sense of a positive command of a workpiece-side axis. */
export type Sense = "iso841" | "direct";

/** The statistic of one machine's deviations over the poses. */
export type Statistic = "max" | "p95";

/** The state of a member of the set in the machine file. */
export type Status = "given" | "bounded" | "covered" | "missing";

/** Statistics of vectors: of their length, except for the range. */
export interface Summary {
  /** Largest length. */
  max: number;
  /** Mean length. */
  mean: number;
  /** Root of the mean of the squared length. */
  rms: number;
  /** The ceil(0.95 n)-th smallest length. */
  p95: number;
  /** Maximum minus minimum of each component; ISO 230-1 builds V_XYZ of these. */
  range: [number, number, number];
}

/** Intervals of the statistics of vectors at a level of confidence of 95 %: lower and upper end. */
export interface SummaryBand {
  /** Interval of the largest length. */
  max: [number, number];
  /** Interval of the mean length. */
  mean: [number, number];
  /** Interval of the root of the mean of the squared length. */
  rms: [number, number];
  /** Interval of the 95 % value of the length. */
  p95: [number, number];
}

/** Certainty of a fact, with its source. */
export interface TargetCertainty {
  /** Level in a word. */
  level: string;
  /** The source. */
  source: string;
}

/** The targets that are for a machine, the one that leaves least first, and those that are not. */
export interface TargetComparison {
  /** Name of the machine. */
  machine: string;
  /** Those with files for the machine. */
  targets: TargetResidual[];
  /** Those without. */
  refused: RefusedTarget[];
}

/** The errors that the files of a target leave. */
export interface TargetResidual {
  /** Its name; of kinematic parameters with tables for what they leave `A+B`. */
  target: string;
  /** Errors that it corrects, in words. */
  expresses: string;
  /** Certainty of the format of each, in a word. */
  syntax: string[];
  /** Poses and reference of the figures. */
  over: Over;
  /** Without the files. */
  uncompensated: CertifiedFigures;
  /** With the files. */
  compensated: CertifiedFigures;
  /** Fractions that the files take off drawn machines, where errors are only bounded; the figures are then those of the machine with the median. */
  drawn?: DrawnRepair | null;
  /** Warnings of the files, such as that the scale in force is not known. */
  remarks: string[];
}

/** A controller in short. */
export interface TargetSummary {
  /** Name for `compile`. */
  target: string;
  /** The controller's own name. */
  title: string;
  /** Mechanisms of compensation, separated by spaces. */
  mechanism: string;
  /** Errors that it corrects, in words. */
  expresses: string;
  /** Errors that it cannot correct, in words. */
  cannot: string[];
  /** Limits of its tables, in words. */
  limits: string;
  /** A test of the sign at the machine. */
  sign_test: string;
  /** Certainty of the syntax. */
  syntax: TargetCertainty;
  /** Certainty of the sign. */
  sign: TargetCertainty;
  /** The frame of kinematic parameters, and its certainty; `None` of tables. */
  frame: TargetCertainty | null;
}

/** A bounded error, and the effect of its tolerance. */
export interface Tightening {
  /** Name of the error. */
  error: string;
  /** Its tolerance, in `unit`. */
  tolerance: number;
  /** `um` or `urad`. */
  unit: string;
  /** Its direction, machine frame. */
  direction: [number, number, number];
  /** True if its name has the letter of a direction. */
  by_letter: boolean;
  /** True if the class bounds it, false if the machine file does. */
  of_class: boolean;
  /** Derivative of the 95 % value by the tolerance, um by unit. */
  um_per_unit: number;
  /** Standard error of the derivative, um by unit. */
  sigma: number;
  /** Its part of the 95 % value, um. */
  um_of_p95: number;
  /** Standard error of that part, um. */
  um_of_p95_sigma: number;
  /** Its effect where the RSS is largest, um. */
  at_worst_um: number | null;
  /** Its effect averaged over the poses, um. */
  average_um: number | null;
}

/** The cheapest tolerances for a goal. */
export interface ToleranceGoal {
  /** The goal of the 95 % value, um. */
  goal_um: number;
  /** The 95 % value with the old tolerances, um, by the machines of the search. */
  before_um: Percentile;
  /** The 95 % value with the new tolerances, um, of machines drawn anew. */
  proof_um: Percentile;
  /** Number of machines of the proof. */
  proof_samples: number;
  /** The 95 % value of what no tolerance of the cost model changes, um. */
  staying_um: number;
  /** Number of steps of the search. */
  steps: number;
  /** The cost. */
  cost: GoalCost;
  /** The tolerances, those of the largest part in the 95 % value first. */
  tolerances: GoalTolerance[];
}

/** A part tried at a place. */
export interface TriedPlace {
  /** The place. */
  place: Placement;
  /** True for the place that the job states. */
  own: boolean;
  /** Number of tool poses that are reached. */
  reached: number;
  /** Their fraction. */
  share: number;
  /** Number of rewinds of a path. */
  rewinds?: number | null;
  /** Least distance of a linear axis from an end of its travel, mm; none without such an axis or a tool pose. */
  margin_mm?: number | null;
  /** True if the machine reaches the points at which the part is probed. */
  reaches_reference: boolean;
  /** The 95 % value of the position deviation over the tool poses that are reached, um; from bounds of what 95 % of the machines do not exceed at each. None for reach alone. */
  p95_um?: number | null;
  /** The largest of these, um. */
  max_um?: number | null;
  /** The figure by which places are ranked and the limit of the job is judged, um: the statistic of the position deviation over the tool poses that are reached; of machines drawn the value that 95 % of them do not exceed. */
  um?: number | null;
  /** The interval that holds it with 95 % confidence, um: of machines drawn, or of values with a stated uncertainty. */
  interval_um?: [number, number] | null;
  /** A ranked place against the first, on the same machines; none where no machines are drawn, and where the path has more rewinds. */
  versus_first?: VersusFirst | null;
  /** The figure against the limit of the job, if it states one. */
  limit?: LimitVerdict | null;
  /** Rank from 1; none of a place that cannot be compared with the best. */
  rank?: number | null;
}

/** Statistics of a machine without compensation. */
export interface Uncompensated {
  /** Displacement of the functional point, um. */
  position_um: Summary;
  /** Rotation of the tool, urad. */
  rotation_urad: Summary;
}

/** The reason why a machine cannot take a tool pose. */
export type Unreachable = "direction" | "place" | "travel";

/** Number of unreachable tool poses, by reason. */
export interface UnreachableCount {
  /** Their total number. */
  total: number;
  /** Number for which the rotary axes cannot point the tool in the direction. */
  direction: number;
  /** Number whose place the linear axes do not span. */
  place: number;
  /** Number for which an axis would leave its travel. */
  travel: number;
  /** Number of them for which no pose was found, without a proof that there is none. */
  not_proved?: number;
}

/** What is known of a machine or arrangement and the first. */
export type Verdict = "first" | "equal" | "not_told_apart" | "worse" | "better";

/** A machine or arrangement against the first, on the machines drawn of both. */
export interface VersusFirst {
  /** What is known of the two. */
  verdict: Verdict;
  /** Its 95 % value minus that of the first, um. The intervals of all pairs and all rounds hold together with 95 % confidence. */
  minus_first: PairedDifference;
}

/** The reason why there is no verdict on two machines: errors without a value or a bound could turn it. */
export interface WithheldVerdict {
  /** The reason in words. */
  reason: string;
  /** The verdict on the errors that are bounded. */
  as_bounded: Verdict;
  /** Errors that the first machine states nothing of. */
  missing_first: string[];
  /** Errors that this machine states nothing of. */
  missing: string[];
  /** The class that bounds them, where the other machine does not. */
  class: string;
  /** Its 95 % value minus that of the first, um, with the bounds of the other machine for what is missing, and with those of the class for what neither bounds. */
  minus_first_if_filled: [PairedDifference, PairedDifference];
}

/** A pose with a large 95 % value. */
export interface WorstBoundedPose {
  /** The pose, mm and deg. */
  axes: Record<string, number>;
  /** Root of the sum of squares of the bounds' effects on the functional point, um. */
  rss_um: number;
  /** The position deviation that 95 % of the machines drawn do not exceed, um. */
  p95_um: number;
}

/** A pose with a large deviation. */
export interface WorstPose {
  /** The pose, mm and deg. */
  axes: Record<string, number>;
  /** Deviation of the functional point, um. */
  deviation_um: [number, number, number];
}

/** Machines drawn without the motion of the part that leaves the smallest largest deviation of each. */
export interface ZoneBudget {
  /** Poses and reference that it is over. */
  over: Over;
  /** The position deviation, um. */
  position_um: DrawnMachineFigures;
  /** The rotation of the tool, urad. */
  rotation_urad: DrawnMachineFigures;
}

/** The fit by which a zone is judged. */
export type ZoneFit = "minimum-zone" | "least-squares";
