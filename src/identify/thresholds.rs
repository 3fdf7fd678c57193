//! Every number that decides what a fit says: one table, used by all files of the stage.
//!
//! A share is a ratio to the largest of its kind. Entries state what goes wrong with a smaller value ("below") and a
//! larger one ("above"), and reason or source. Values without a source are a choice between the two failures; the
//! simulated campaigns of `tests/it/coverage.rs` measure what they do to the stated intervals.

// Rank and null space.

/// Singular values below this share count as zero. Below: rounding of the model counts as rank; above: a direction that
/// the data do show is reported as free.
pub const RANK_TOLERANCE: f64 = 1e-10;
/// [`RANK_TOLERANCE`] of a step of the fit, which may follow weaker directions than the report states.
pub const STEP_RANK_TOLERANCE: f64 = 1e-12;
/// [`RANK_TOLERANCE`] of small design matrices with entries near 1: bases at knots, sums of terms, rigid motions.
pub const DESIGN_RANK_TOLERANCE: f64 = 1e-9;
/// [`RANK_TOLERANCE`] of effects over the volume, which come from derivatives at many poses. Below: unknowns that move
/// nothing follow a motion by rounding.
pub const VOLUME_RANK_TOLERANCE: f64 = 1e-6;
/// [`RANK_TOLERANCE`] of the multilateration of a station. Looser: a constant beside readings that hardly vary is a
/// column like another.
pub const STATION_RANK_TOLERANCE: f64 = 1e-6;
/// Third singular value of points, as a share, below which they lie in a plane: the side of a station is undetermined.
pub const COPLANAR_SHARE: f64 = 1e-3;
/// Second singular value of points, as a share, below which they lie on a line.
pub const COLLINEAR_SHARE: f64 = 1e-6;
/// Squared share in the null space above which a parameter or a sum has no value. Below: rounding frees it; above: a
/// value is stated that the data do not determine.
pub const MAX_NULL_SPACE_SHARE: f64 = 1e-3;
/// Least scale of a column, as a share of the displacement that its parameter usually makes. Below: a column that holds
/// only rounding is scaled to unit length and counts as rank.
pub const MIN_COLUMN_SHARE: f64 = 1e-2;
/// Uncertainty of a monomial's coefficient over that without the other monomials, up to which the data tell it from
/// them: the root of a variance inflation factor of 100.
pub const MAX_INFLATION: f64 = 10.0;
/// Least coefficient of a monomial that is a column (mm, parameters in units of displacement): less is rounding.
pub const MIN_MONOMIAL_MM: f64 = 1e-12;
/// Part of the travel that the readings must span for a datum to be formed over the travel, else over what they span.
/// Below: conditions are put on curves where they only extrapolate; above: a grid that stops short of the ends is named
/// as a part of the travel.
pub const MIN_WHOLE_RANGE_SHARE: f64 = 0.9;
/// Length that a datum leaves of a free direction of unit length, below which it fixes the direction.
pub const MIN_FREE_LENGTH: f64 = 5e-2;
/// Part of a rigid motion of the machine beyond the free directions above which it is a free direction of its own.
pub const MIN_NEW_MOTION_SHARE: f64 = 0.1;
/// Displacement of a point (mm) by a free direction of unit size (mm) from which the deviation is free, too.
pub const MIN_FREE_EFFECT_MM: f64 = 1e-3;
/// Variance of an independent part of the covariance, as a share, below which the part is not stated.
pub const MIN_COVARIANCE_SHARE: f64 = 1e-12;
/// The larger of two numbers is larger by this factor; otherwise the first counts. Below: rounding would choose.
pub const TIE_RATIO: f64 = 1.0001;

// Weakly identified directions and free directions in words.

/// Part of a direction below noise, as a share, from which a parameter is named.
pub const MIN_WEAK_PART_SHARE: f64 = 0.02;
/// Part of the effect of such a direction on the readings from which a parameter is named.
pub const MIN_WEAK_EFFECT_SHARE: f64 = 0.1;
/// Part of a null-space direction, as a share, from which a parameter is named: amounts are printed to three digits, so
/// that their rounding changes the readings by more than what is left out.
pub const MIN_NULL_PART_SHARE: f64 = 2e-4;
/// Distance of knots from a straight line, as a share of its ends, up to which they are on it: three digits are
/// printed.
pub const MAX_STRAIGHT_SHARE: f64 = 5e-3;
/// Displacement of points (mm) from which an error is implausible for a machine: smaller parts of it are stated.
pub const IMPLAUSIBLE_DISPLACEMENT_MM: f64 = 1.0;

// Convergence of the fit.

/// Largest number of accepted steps.
pub const MAX_FIT_STEPS: usize = 200;
/// Relative offset (Bates and Watts 1981), the step over the radius of the confidence region, of a last step. Above:
/// the estimate is off by a visible part of its uncertainty; below: steps run on over rounding.
pub const CONVERGED_OFFSET: f64 = 1e-3;
/// Relative offset up to which the linear problem alone is trusted for the last step, if the steps before converged.
pub const LINEAR_OFFSET: f64 = 0.1;
/// Predicted reduction of the sum of squares, as a share, below which there is no step: rounding of the sum.
pub const MIN_REDUCTION_SHARE: f64 = 1e-15;
/// Predicted reduction per reading (mm^2) below which there is no step: rounding of positions.
pub const MIN_REDUCTION_MM2: f64 = 1e-22;
/// Damping of the first step, as a share of the largest squared singular value.
pub const FIRST_DAMPING: f64 = 1e-12;
/// Damping at which the search is given up.
pub const MAX_DAMPING: f64 = 1e6;
/// Condition up to which normal equations give the step: they square it.
pub const MAX_NORMAL_CONDITION: f64 = 1e5;
/// Iterations by which scatter and prior are weighed against each other in a step.
pub const STEP_SCATTER_ITERATIONS: usize = 6;
/// Iterations by which scatter and prior are weighed against each other in the report, which starts near the result.
pub const REPORT_SCATTER_ITERATIONS: usize = 4;

// Prior of the fit.

/// Least standard deviation (mm) of a displacement before the data: 1 mrad of a rotation. Below: true errors that the
/// readings hardly show are pulled to the start; above: directions that they hardly show run away, and through products
/// of errors the others with them.
pub const MIN_PRIOR_SIGMA_MM: f64 = 0.3;
/// Plausible size of an error over the RMS of the readings before the fit. An error of the prior's standard deviation
/// is moved by less than half of its standard uncertainty.
pub const PLAUSIBLE_OVER_RMS: f64 = 3.0;
/// Least displacement of a unit of an unknown, as a share of its usual one: tells apart bases that hold a curve twice.
pub const MIN_METRIC_SHARE: f64 = 1e-7;
/// Standard deviation (mm) before the data of second-order-only directions: 0.1 mrad of a rotation. Above: the part of
/// the readings that the chosen curves miss draws them out by millimetres.
pub const SECOND_ORDER_SIGMA_MM: f64 = 0.03;
/// Number of readings from which [`SECOND_ORDER_SIGMA_MM`] falls with the root: misfit does not average out.
pub const SECOND_ORDER_READINGS: f64 = 1000.0;
/// Singular value of the exact model, as a share, from which a direction does not need products of errors to be seen.
pub const MIN_FIRST_ORDER_SHARE: f64 = 1e-2;
/// Effect on the readings at the solution, over that of the strongest unknown, from which a direction that only
/// products of errors show counts as others do. Below: uncertainties of millimetres by products of mrad;
/// above: the errors of a robot, ten times as large, leave directions free that its readings hold.
pub const MIN_PRODUCT_SHARE: f64 = 2e-3;

// Rigid motions and datum.

/// Effect on the volume, as a share, below which a combination of errors only moves the workpiece frame.
pub const MAX_RIGID_SHARE: f64 = 1e-8;
/// [`MAX_RIGID_SHARE`] of what turns with a rotary axis, whose splines only come near to sine and cosine.
pub const MAX_TURNING_SHARE: f64 = 2e-2;
/// Part of a condition beyond the conditions before it, as a share, up to which it adds none.
pub const MAX_DEPENDENT_SHARE: f64 = 1e-5;
/// The same of a rigid motion beyond the motions before it.
pub const MAX_DEPENDENT_MOTION_SHARE: f64 = 1e-9;
/// Displacement of points (mm) by a unit displacement of an unknown up to which it is without effect.
pub const MAX_IDLE_EFFECT_MM: f64 = 1e-9;
/// Singular values, as a share, that a step to the exact model in a datum uses. Below: the step follows directions in
/// which exact model and first order differ by rounding.
pub const DATUM_STEP_TOLERANCE: f64 = 1e-4;
/// Steps to the exact model in a datum, and of a rigid alignment.
pub const DATUM_ITERATIONS: usize = 4;
/// Effect of a rigid motion of the workpiece on the readings, as a share, up to which no reading notices it once the
/// places of instruments have followed; also the part of a motion that is rounding. Below: rounding of far stations
/// holds the frame; above: a weak hold of the readings is left out of the deviations.
pub const MAX_UNNOTICED_SHARE: f64 = 1e-7;
/// Part of an unheld motion of unit length beyond the others from which it is one of its own: a datum's are found over
/// the volume, those of the readings at the readings, and they differ by rounding.
pub const MIN_UNHELD_PART: f64 = 1e-3;
/// Residual of a motion of the whole machine, as a share, up to which the parameters make it.
pub const MAX_MOTION_RESIDUAL: f64 = 1e-2;
/// Change of a reading over that of the size of the machine, RMS over the volume, up to which no reading holds the
/// size. Below: the rounding of a fixed part of the machine counts as a length; above: a gauge of a thousandth of it
/// counts as none.
pub const MAX_UNNOTICED_SIZE_SHARE: f64 = 1e-3;
/// Distance of points (mm) up to which readings say that points are the same, and hold no length.
pub const SAME_POINT_MM: f64 = 1.0;
/// Largest amount of an unknown in a stretch, over the displacements (RMS) that the stretch makes: levers make a few.
pub const MAX_STRETCH_AMOUNT: f64 = 50.0;
/// Part of a stretch, as a share, from which a parameter is named.
pub const MIN_STRETCH_PARAMETER_SHARE: f64 = 0.05;
/// Part of a stretch, as a share, from which a direction of it is named.
pub const MIN_STRETCH_PART_SHARE: f64 = 0.02;

// Scatter and weights.

/// Least scatter of readings (mm): less is rounding of positions.
pub const MIN_SCATTER_MM: f64 = 1e-9;
/// Least scatter of one quantity, as a share of the largest: a quantity that is fitted exactly takes all weight.
pub const MIN_SCATTER_SHARE: f64 = 1e-3;
/// Huber's constant, in standard deviations of a component: 96 % efficiency for normal readings (Huber 1981).
pub const HUBER_CONSTANT: f64 = 1.5;
/// The median of the absolute value of a normal deviate, in standard deviations.
pub const MEDIAN_OVER_SIGMA: f64 = 0.6745;
/// Degrees of freedom of the median of absolute values over those of the standard deviation: 0.37 of many readings,
/// more of few, where the upper of two middle values errs to the safe side.
pub const MEDIAN_EFFICIENCY: f64 = 0.5;
/// Redundancy below which a quantity takes the common variance: its own standard deviation would be known to
/// `1 / sqrt(2 f)` only, 41 % at f = 3.
pub const MIN_REDUNDANCY: f64 = 3.0;
/// Largest number of reweightings.
pub const MAX_REWEIGHTINGS: usize = 30;
/// Largest number of iterations of the variance components on one linear problem.
pub const MAX_VARIANCE_ITERATIONS: usize = 100;
/// Relative change of weights below which they have settled.
pub const SETTLED_WEIGHT_CHANGE: f64 = 1e-3;

// Lack of fit.

/// Residual degrees of freedom below which scatter and form cannot be told apart.
pub const MIN_FORM_FREEDOM: usize = 20;
/// Positions of an axis below which form and curve cannot be told apart.
pub const MIN_FORM_POSITIONS: usize = 6;
/// Distance of positions, as a share of the interval, below which they count as one.
pub const SAME_POSITION_SHARE: f64 = 1e-3;
/// Least interval of positions, as a share of the travel.
pub const MIN_FORM_SPAN_SHARE: f64 = 0.01;
/// Correlation lengths, as shares of the interval: from two thirds of the distance of the knots to a single bend.
pub const CORRELATION_LENGTHS: [f64; 3] = [0.06, 0.15, 0.4];
/// The longest of a rotary axis (deg): bearings and worms repeat several times a turn.
pub const ROTARY_CORRELATION_LENGTHS_DEG: [f64; 3] = [10.0, 25.0, 60.0];
/// Knots of a form over the interval.
pub const MIN_FORM_KNOTS: usize = 12;
/// Largest distance of the knots of a rotary axis (deg): its shortest correlation length.
pub const ROTARY_FORM_STEP_DEG: f64 = 10.0;
/// Number of knots of all errors of all axes above which each axis has fewer, but the least. Above: memory and time
/// grow with its square.
pub const MAX_FORM_KNOTS: usize = 1300;
/// Variance of a mode of a form, as a share of its largest, below which sizes are estimated without it.
pub const MIN_FORM_MODE_SHARE: f64 = 1e-2;
/// Largest number of modes of all forms; the readings feel the others least. Above: time grows with its third power.
pub const MAX_FORM_MODES: usize = 500;
/// Size of a form before the data, in standard deviations of a reading.
pub const FORM_SIZE: f64 = 0.5;
/// Standard deviations before the data of logarithms of sizes: of the common size of all forms, of the size of all
/// displacements (or rotations) beside it, of those of an axis beside these, and of each error beside those of its
/// axis. Below: a bent error among straight ones is shared out; above: sizes that the data do not separate go astray.
pub const FORM_SIZE_SPREADS: [f64; 4] = [1.5, 0.7, 0.5, 1.0];
/// Share of the data in what is known of a size, the rest being those of the other forms, below which it counts as
/// tied to them.
pub const MIN_SIZE_RESOLUTION: f64 = 0.5;
/// Steps of the estimate of all sizes.
pub const MAX_FORM_STEPS: usize = 25;
/// Largest step of the logarithm of a size: beyond, the quadratic model of the likelihood means nothing.
pub const MAX_SIZE_STEP: f64 = 1.5;
/// Step of the logarithms from which they have settled: no size is known to 2 %.
pub const SETTLED_SIZE_STEP: f64 = 0.02;
/// Probability before the data that the axes have no form. Below: forms are found in noise; above: they are missed.
pub const PRIOR_PROBABILITY_NO_FORM: f64 = 0.75;
/// Probability of any form from which the forms are stated.
pub const MIN_FORM_PROBABILITY: f64 = 0.5;
/// Errors that are named as bent.
pub const MAX_BENDS: usize = 5;
/// Sum of squares that a richer curve takes off, over its number of functions and the variance of a reading, from which
/// an error is bent: of three functions one error in a hundred thousand exceeds it by chance.
pub const MIN_BEND_RATIO: f64 = 8.0;
/// Share of the residual sum of squares that it takes off. Below: bends are named that nobody would miss.
pub const MIN_BEND_SHARE: f64 = 0.02;
/// [`RANK_TOLERANCE`] of squared effects of such functions. Below: what the unknowns follow already is a bend.
pub const BEND_RANK_TOLERANCE: f64 = 1e-6;
/// Sum of squares, over the variance of a reading, that a form of the size of the scatter must make to be seen.
pub const MIN_FORM_SQUARES: f64 = 1e-3;
/// Share of the other kind of motion from which displacements or rotations of an axis are stated.
pub const MIN_FORM_SHARE: f64 = 1e-2;
/// Residual sum of squares, as a share, that a form must leave: a form that explains all would have no variance.
pub const MIN_RESIDUAL_SHARE: f64 = 1e-12;

// Checks of data and residuals.

/// Robust standard deviations (RMS of the components) from which a measurement is an outlier.
pub const OUTLIER_DEVIATIONS: f64 = 4.0;
/// The same from which on there is a warning: no form of an axis comes there.
pub const MAX_OUTLYING_DEVIATIONS: f64 = 10.0;
/// Share of all that is left (sum of squares) that is one outlier's from which on it is named however few readings
/// there are: of eight normal ones one in ten sets has such a row, of twenty none.
pub const MAX_OUTLYING_SHARE: f64 = 0.6;
/// Location error of a fit, mm, from which on the data are rather wrong than the machine: origins are known better.
pub const MAX_LIKELY_SHIFT_MM: f64 = 3.0;
/// The same of its angle, rad: 1000 arcsec.
pub const MAX_LIKELY_TURN: f64 = 5e-3;
/// Least residual (mm) of an outlier: residuals of mere rounding have none.
pub const MIN_OUTLIER_MM: f64 = 1e-6;
/// Residuals below which tests for randomness say nothing.
pub const MIN_TESTED_RESIDUALS: usize = 20;
/// Standard deviations of the other repeats from which a difference is a contradiction.
pub const CONTRADICTION_DEVIATIONS: f64 = 6.0;
/// Degrees of freedom of the other repeats that this takes.
pub const MIN_OTHER_REPEATS: usize = 10;
/// Correlation of first and last readings below which they have opposite signs.
pub const OPPOSITE_SIGN_CORRELATION: f64 = -0.8;
/// Repeated poses that this takes.
pub const MIN_REPEATED_POSES: usize = 6;
/// Least weight; the greatest is its inverse. Beyond, sums of squares lose the other readings.
pub const MIN_WEIGHT: f64 = 1e-15;
/// Least distance (mm) that has a direction.
pub const MIN_LENGTH_MM: f64 = 1.0;
/// Misfit of a tracker's points to their poses, and of their sizes, as a share of the size. Above: coordinates in
/// another unit or of other poses are taken.
pub const MAX_FRAME_MISFIT_SHARE: f64 = 0.05;
/// Distance (mm, RMS) of readings from their poses from which on something must be mixed up, if a change of the data
/// explains it: a robot as its maker has it is 2 to 3 mm off.
pub const MIN_COARSE_MM: f64 = 5.0;
/// Ratio of what is left without and with a change that explains it. The nominal machine leaves its errors: a
/// millimetre of 20.
pub const MIN_COARSE_GAIN: f64 = 10.0;
/// Ratio to the least that is left, up to which other changes explain as much.
pub const MAX_COARSE_ALIKE: f64 = 3.0;
/// Fewest rows for that: of fewer some change brings a few together by chance.
pub const MIN_COARSE_POINTS: usize = 10;
/// Rows that are looked at for that.
pub const COARSE_ROWS: usize = 200;
/// Of more rows as many neighbours are looked at together, so that exchanges of neighbours can be tried.
pub const COARSE_BLOCK: usize = 8;
/// Distance of positions (mm or deg) up to which they are one target whatever the steps are: rounding of decimals.
pub const SAME_TARGET: f64 = 1e-6;
/// Farthest apart (mm or deg) of measured positions of one target: a worn machine, and less than the steps of any test.
pub const MAX_TARGET_SCATTER: f64 = 0.05;
/// Least step of targets over their scatter: a gap that no even spacing has, so that targets 1 um apart stay targets.
pub const MIN_STEP_OVER_SCATTER: f64 = 20.0;

// Readings of an instrument's file against each other (`import`). Simulated campaigns of a ball screw
// (tests/it/suspect.rs) hold false alarms of all of them together to 1 % of good files.

/// Share of rows that cannot be read above which the file is not understood: a bumped probe takes a row in ten, a
/// layout that is misread most of them.
pub const MAX_LOST_SHARE: f64 = 0.25;
/// Largest number of a run, above which a whole number is a position.
pub const MAX_RUN_NUMBER: f64 = 50.0;
/// Rows in which readings go one way from which on they are positions: of scattering readings 2 in 720 files of six do.
pub const MIN_EXCHANGED_ROWS: usize = 6;
/// Share of those rows at which the positions turn back: a row out of place makes two, scattering readings two of
/// three.
pub const MIN_TURNED_SHARE: f64 = 0.25;
/// Equal readings in a row and the row before it from which on the row is there twice; two in turn at a turning point
/// differ by the reversal.
pub const MIN_EQUAL_NEIGHBOURS: usize = 2;
/// Equal readings in any two rows from which on a row is there twice: at steps of half the scatter, one chance in 600.
pub const MIN_EQUAL_CELLS: usize = 4;
/// Targets from which on runs are compared. Below: a median of two values follows each of them.
pub const MIN_JUDGED_TARGETS: usize = 3;
/// Readings with repeats from which on their scatter is known well enough to call one an outlier.
pub const MIN_REPEATED_READINGS: usize = 8;
/// Passes up to which runs are compared: time grows with their number times that of the readings.
pub const MAX_JUDGED_PASSES: usize = 100;
/// Deviation from the median of the repeats, in robust standard deviations of these, above which a reading is an
/// outlier. Below 8: one good test in a hundred has one, its scatter growing along the axis and of heavier tails than
/// normal; above: bumps and interrupted beams, which are hundreds, stay as they are.
pub const MAX_OUTLIER_SIGMA: f64 = 9.0;
/// Lever (mm) by which a limit of lengths is one of angles: the reach of a tool.
pub const JUDGING_LEVER_MM: f64 = 200.0;
/// Least such deviation (mm): less harms no table.
pub const MIN_HARM_MM: f64 = 1e-4;
/// Share of outliers above which they are none: the test does not repeat.
pub const MAX_OUTLIER_SHARE: f64 = 0.1;
/// Drift over all runs, in standard deviations of a reading within them; twice that of two runs. Below 4: one good test
/// in a hundred drifts, its runs scattering by 0.7 of that.
pub const MIN_DRIFT_SIGMA: f64 = 5.0;
/// Least drift (mm): a controlled room makes as much.
pub const MIN_DRIFT_MM: f64 = 1e-3;
/// Coefficient of determination of the line through the means of the runs above which they drift, if they do not go one
/// way: a warm-up that has come to its end has 0.8.
pub const MIN_DRIFT_DETERMINATION: f64 = 0.8;
/// Misfit of a run to the others over that after a change of unit or sign. The factors are 2 and more apart: a run of
/// the right unit fits the worse.
pub const MIN_UNIT_RATIO: f64 = 2.5;
/// The same from which a run is not of the same quantity, or not measured: no loose mount scatters as much.
pub const MIN_OTHER_RUN_RATIO: f64 = 100.0;
/// Slope of such a run on the curve of the others over its 95 % uncertainty (Student). Below: any factor below 1 fits
/// readings that only scatter.
pub const MIN_UNIT_SLOPE: f64 = 3.0;
/// Reversal of the others, in standard deviations of its mean, from which on the exchanged directions of a run are
/// seen: a run of the right directions is then six of them from half way to the other sign.
pub const MIN_EXCHANGE_SIGMA: f64 = 5.0;
/// Reversal of a run over that of the others, with the other sign, from which on its directions are exchanged: half way
/// between none and all of it.
pub const MIN_EXCHANGE_SHARE: f64 = 0.5;
/// Reversal (mm) of readings larger from below from which on directions are exchanged: less is backlash that is
/// compensated a little too much, or a scale's.
pub const MIN_EXCHANGED_REVERSAL_MM: f64 = 1e-3;
/// Share of the targets that must show it.
pub const MIN_EXCHANGED_SHARE: f64 = 0.9;
/// Slope (mm per mm) that no screw has: the loosest grade of ISO 3408-3 is 210 um over 300 mm, 60 K are 700 um/m, and
/// this is more than both together.
pub const MAX_AXIS_SLOPE: f64 = 2e-3;
/// Least rise (mm) with it: between targets a micrometre apart scatter is a slope.
pub const MIN_AXIS_RISE: f64 = 0.1;
/// Slope that a screw of grade 7 (52 um over 300 mm) has 20 K warm, above which, with [`MIN_AXIS_RISE`], it is
/// remarked.
pub const UNLIKELY_AXIS_SLOPE: f64 = 4e-4;
/// Length of an axis (mm) from which on that holds: over a turn of the screw its periodic error is a slope.
pub const MIN_AXIS_LENGTH_MM: f64 = 10.0;
/// Range of an angular error (rad) that no axis has, and that few have: an arcminute is 0.3 mrad.
pub const MAX_AXIS_ANGLE: f64 = 1e-2;
/// See [`MAX_AXIS_ANGLE`].
pub const UNLIKELY_AXIS_ANGLE: f64 = 1e-3;
/// Range of all readings over the length of the axis (at least ten times [`MIN_AXIS_LENGTH_MM`]) that no axis is below:
/// 0.01 K makes as much, and a laser in air is five times as uncertain.
pub const MIN_AXIS_RANGE: f64 = 1e-7;
/// Scatter of repeats (mm) that no instrument has over such a length, in air.
pub const MIN_AXIS_SIGMA: f64 = 3e-6;
/// Scatter (mm) that is rounding of numbers: readings that were computed.
pub const MIN_WRITTEN_SIGMA: f64 = 1e-8;

// Changes of the data that explain what a fit leaves (`suspect`). Simulated campaigns (tests/it/accused.rs) hold false
// alarms to 1 % of good ones.

/// Runs, tools or stations up to which each is tried by itself: time grows with their number.
pub const MAX_SUSPECT_GROUPS: usize = 12;
/// Part of a travel by which changed positions may be beyond it: rounding of the stated travel.
pub const MAX_BEYOND_TRAVEL: f64 = 0.01;
/// Rows of the sample on which changes are tried; more for many unknowns.
pub const MAX_SCREENED_ROWS: usize = 160;
/// See [`MAX_SCREENED_ROWS`].
pub const SCREENED_ROWS_PER_UNKNOWN: usize = 2;
/// Residual degrees of freedom below which a change fits by chance.
pub const MIN_SUSPECT_FREEDOM: f64 = 20.0;
/// Rows of a run from which on it is compared with another one, or with its first row.
pub const MIN_TURNED_ROWS: usize = 4;
/// Scatter (mm) from which on readings of one pose differ in their last digit, so that equal ones were copied. Below:
/// readings without noise are accused.
pub const MIN_COPIED_SCATTER_MM: f64 = 1e-4;
/// Their correlation from which on one follows the other: of four rows of noise 1 pair in 200 does.
pub const MIN_TURNED_CORRELATION: f64 = 0.995;
/// Slopes of one over the other that are asked about: the opposite, and twice. A square that is true leaves 1, one
/// that is out by a fifth of the machine 0.67 or 1.5.
pub const TURNED_SLOPES: [std::ops::RangeInclusive<f64>; 2] = [-1.6..=-0.625, 1.6..=2.5];
/// Rounds in which weights follow the scatter of each component.
pub const SUSPECT_WEIGHTINGS: usize = 2;
/// Share of all readings that the common scatter counts for beside those of a component.
pub const SUSPECT_PULL: f64 = 0.02;
/// Powers of the row by which readings drift: warming up is no line.
pub const DRIFT_POWERS: u8 = 3;
/// Scatter over the stated noise of readings that are all 1000 times too large: form is left as well.
pub const UNIT_NOISE_RATIOS: std::ops::Range<f64> = 300.0..5000.0;
/// Least residual (mm) of such readings: form is smaller.
pub const MIN_UNIT_LEFT_MM: f64 = 0.1;
/// Waves of a form over what was measured of an axis, to a length of an eighth.
pub const SUSPECT_FORM_WAVES: usize = 8;
/// Rotation (rad) that comes with a displacement (mm) of a form: 3 urad with 1 um.
pub const SUSPECT_FORM_TILT: f64 = 3e-3;
/// Sizes of a form over the scatter that are tried.
pub const SUSPECT_FORM_SIZES: [f64; 8] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 1000.0];
/// Rows that may be left out as single ones, and their share of all, whichever is more.
pub const MIN_SUSPECT_ROWS: usize = 3;
/// See [`MIN_SUSPECT_ROWS`].
pub const MAX_SUSPECT_ROW_SHARE: f64 = 0.03;
/// Standard deviations from which on a row is left out on trial.
pub const MIN_SUSPECT_ROW_SIGMA: f64 = 6.0;
/// Logarithm of the odds against any one change before the data: some two hundred are tried, one campaign in five has
/// a trouble.
pub const SUSPECT_CHARGE: f64 = 7.0;
/// Standard deviation (mm) before the data of an error in a trial.
pub const SUSPECT_PRIOR_MM: f64 = 30.0;
/// Scatter (mm) below which what is left is rounding of numbers, also of a component.
pub const MIN_SUSPECT_MM: f64 = 1e-5;
/// Scatter over that of repeated readings, or over the stated noise, below which nothing is looked for.
pub const MIN_SUSPECT_RATIO: f64 = 1.7;
/// Single changes of which pairs are tried.
pub const SUSPECT_BEAM: usize = 8;
/// Changes that are judged well, the best at a glance.
pub const SUSPECT_FINALISTS: usize = 16;
/// Changes, the best first, of which the fit of all readings is tried.
pub const SUSPECT_VERIFIED: usize = 3;
/// Logarithm of the likelihood within which changes explain alike.
pub const MAX_ALIKE_LIKELIHOOD: f64 = 3.0;
/// Other changes of the kind that are named.
pub const MAX_ALTERNATIVES: usize = 2;
/// Gain in likelihood from which on a change is named: odds of a million to one.
pub const MIN_SUSPECT_LIKELIHOOD: f64 = 20.0;
/// The same as a ratio of what is left, before over after. Below: good campaigns are accused; above: troubles of three
/// times the noise, which leave form as well, pass.
pub const MIN_SUSPECT_GAIN: f64 = 1.9;
/// [`MIN_SUSPECT_GAIN`] of exchanges and signs alone, which of good data make nothing better.
pub const MIN_EXCHANGE_GAIN: f64 = 1.2;
/// Scatter of one component, before over after, that is enough whatever the others say. Below: form in one direction
/// is taken for a drift.
pub const MIN_COMPONENT_GAIN: f64 = 2.5;
/// [`MIN_SUSPECT_GAIN`] of a single change, below which no pairs are tried: of good campaigns none comes near.
pub const MIN_FIRST_GAIN: f64 = 1.03;
/// The same of a second change beside the first.
pub const MIN_SECOND_GAIN: f64 = 1.1;

// Verdict on a fit.

/// What is left of a group of readings over what is left of all, above which the text names it.
pub const MIN_GROUP_RATIO: f64 = 1.4;
/// Readings of such a group.
pub const MIN_GROUP_READINGS: usize = 5;
/// Probability below which residuals are not noise.
pub const MAX_NOISE_PROBABILITY: f64 = 1e-4;
/// Correlation of neighbours above which such residuals drift.
pub const MIN_DRIFT_CORRELATION: f64 = 0.2;
/// Degrees of freedom of repeated readings from which their scatter is compared with the residuals.
pub const MIN_REPEAT_FREEDOM: usize = 10;
/// Residual scatter over that of repeated readings above which the model does not fit: four times the variance is
/// beyond the 99.9 % point of the ratio from ten degrees of freedom on.
pub const MAX_SCATTER_RATIO: f64 = 2.0;
/// Median deviation (mm) above which the readings are in another unit: no machine has such errors.
pub const MAX_MEDIAN_MM: f64 = 5.0;
/// Median deviation (mm) below which the readings are in another unit: machines that were not corrected are off by
/// more, and so are most that were.
pub const MIN_MEDIAN_MM: f64 = 1e-4;
/// Uncertainty over the largest deviation predicted up to which a prediction is of use ...
pub const MAX_UNCERTAINTY_SHARE: f64 = 0.5;
/// ... or uncertainty over the RMS of the residuals.
pub const MAX_UNCERTAINTY_OVER_RESIDUALS: f64 = 10.0;
/// Parameters at most that are advised to be fixed: each is found by a fit for each candidate.
pub const MAX_ADVISED_FIXED: usize = 6;
/// RMS of the residuals, over that with nothing fixed, up to which fixing parameters is advised.
pub const MAX_FIXING_COST: f64 = 1.05;
/// Largest number of unknowns of a fit: time grows with their third power.
pub const MAX_UNKNOWNS: usize = 500;

// Sampling: below, extremes between the samples are missed; above, time.

/// Positions of the travel at which the uncertainty of a curve is looked at.
pub const UNCERTAINTY_SITES: usize = 25;
/// Intervals of the travel over which a bounded slope is taken.
pub const SLOPE_SITES: usize = 25;
/// Positions of the travel at which the displacement by a curve is averaged.
pub const METRIC_SITES: usize = 50;
/// Positions of the travel at which the conditions of a datum look at a curve.
pub const DATUM_SITES: usize = 64;
/// Positions of the travel at which a fitted error is evaluated for its range.
pub const ERROR_SITES: usize = 101;
/// Low-discrepancy poses inside the volume.
pub const VOLUME_POSES: usize = 256;
/// Largest number of axes whose corners are all among the poses.
pub const MAX_CORNER_AXES: usize = 6;
/// Least share, per touch and mm of a motion (of a rotation over the usual lever), of what its other unknowns do not
/// take up, for the motion of a feature to be an unknown.
pub const MIN_TOUCH_SHARE: f64 = 1e-3;
/// Least wandering (mm) of a ball that rests, by the machine file, from which on its points are looked at.
pub const MIN_WANDER_MM: f64 = 1.0;
/// Share of it that another point of the file may leave to be named: errors of machines leave less of millimetres, and
/// readings that are meant to wander more.
pub const MAX_RESTING_SHARE: f64 = 0.05;
/// Difference (mm) of two features' sizes up to which they are one size: errors of machines make less, gauges differ by
/// more.
pub const MAX_SIZE_GAP_MM: f64 = 0.5;
/// Standard uncertainty (mm, of an angle over the usual lever) of an unknown of an instrument that is fixed: below the
/// digits of any reading, and above what rounding makes of the equation beside the readings.
pub const HELD_MM: f64 = 1e-6;
/// Difference of a value known before the data from what the fit finds, in its standard deviations, from which it is
/// remarked. Below: one of a hundred good gauges would be; above: a gauge of the wrong pair passes.
pub const MAX_KNOWN_DEVIATIONS: f64 = 3.0;
/// Variance of that difference over that of the known value, below which the readings say nothing of it.
pub const MIN_KNOWN_SHARE: f64 = 1e-3;
/// Largest rotation (rad) that is read as the deviation of an orientation. Below: robots before their calibration are
/// refused; above: whole orientations, and degrees taken for microradians, are read as deviations.
pub const MAX_TURN_RAD: f64 = 0.5;
/// Standard uncertainty of each component of the threefold lobing of a touch probe before its readings (mm): data
/// sheets of kinematic resistive probes state pre-travel variations of 0.25 to 10 um.
pub const TOUCH_LOBE_MM: f64 = 5e-3;
/// Random poses to choose a plan from, for each tool and ball.
pub const PLAN_CANDIDATES: usize = 500;
/// Share of what readings say of all unknowns, which tells apart those that say nothing of the machine yet.
pub const PLAN_SHARE_OF_ALL: f64 = 1e-6;
/// Random poses of the rotary axes to choose a plan of touches from: each is driven around each ball on trial.
pub const PLAN_TOUCH_POSES: usize = 100;
/// Lines along each axis to choose a plan from.
pub const PLAN_LINES: usize = 40;
/// Readings on such a line.
pub const PLAN_LINE_POINTS: usize = 11;
/// Rows per unknown of a sample that shows what the first order sees.
pub const SAMPLE_ROWS_PER_UNKNOWN: usize = 4;
/// Least number of rows of that sample.
pub const MIN_SAMPLE_ROWS: usize = 1000;

// The second measurement.

/// Standard uncertainty (mm) of the place in which the second campaign was set up beside the first, and of zeros of
/// instruments. As good as free: below, a part that was put back elsewhere counts against the set.
pub const SET_UP_MM: f64 = 10.0;
/// The same of turns and alignments (rad): 1 mm over 1 m. Above, a part set up askew hides squareness entirely; below,
/// it counts against the set. Turns are followed to first order, so that they never hide a scale.
pub const SET_UP_RAD: f64 = 1e-3;
/// Cosine of the angle to its axis up to which a single error lies across it.
pub const ACROSS_SHARE: f64 = 0.7;
/// Draws behind the share of |E_n| <= 1 that chance explains ...
pub const SECOND_DRAWS: usize = 1000;
/// ... and the number of them that have a smaller one: five of a thousand.
pub const SECOND_OUTSIDE: usize = 5;
/// Readings at which the draws look.
pub const SECOND_DRAWN_READINGS: usize = 1000;
/// Standard uncertainties by which the amount of the correction that is seen may be off: 5 of 10,000 good campaigns
/// are beyond, of several axes more.
pub const MAX_AMOUNT_DEVIATIONS: f64 = 3.5;
/// Part of the correction by which the amount may be off in any case: what a correction leaves is for E_n to judge.
pub const MAX_AMOUNT_OFF: f64 = 0.1;
/// Information on an amount that counts as none: known to a thousand times the correction. It keeps effects apart that
/// the readings do not.
pub const NO_INFORMATION: f64 = 1e-6;
/// Uncertainty of an amount from which on it is not stated.
pub const LARGEST_AMOUNT: f64 = 100.0;
/// Standard uncertainty of the amount up to which a half, or none, or the opposite is told by name.
pub const MAX_NAMED_UNCERTAINTY: f64 = 0.08;
/// Variance of a reading without what the set-up explains, as a share, below which it holds nothing but the set-up.
pub const MIN_JUDGED_SHARE: f64 = 1e-6;
/// Largest number of readings of a second measurement.
pub const MAX_SECOND_READINGS: usize = 20_000;

// Touches of balls.

/// Distance (mm) of a touch from the one before up to which both are of one place: a fast touch stops some 0.1 mm off
/// at most, and touches of a ball are millimetres apart.
pub const SAME_TOUCH_MM: f64 = 0.2;
/// Robust standard deviations from which on a touch is an outlier, as of runs of single-axis readings. Below: balls
/// that are not round are refused; above: shafts that touched by some micrometres pass.
pub const MAX_TOUCH_DEVIATIONS: f64 = 9.0;
/// Size (mm) below which a touch is no outlier: no ball is rounder, and perfect data have no scatter.
pub const MIN_TOUCH_OUTLIER_MM: f64 = 1e-3;
/// Distance (mm) inside the ball from which on a touch is a miss: a probe that meets a ball stops before.
pub const MIN_MISS_MM: f64 = 0.5;
/// Share of the touches of which outliers are looked for.
pub const MAX_TOUCH_OUTLIERS: f64 = 0.1;
/// Upper quartile of the size of a normal deviate.
pub const NORMAL_QUARTILE: f64 = 1.1503;
/// Scatter (mm) of the places of one ball over its poses above which the log is not of this machine file. Below:
/// machines whose rotary axes are known to a millimetre are refused; above: a wrong tool passes.
pub const MAX_PLACE_SCATTER_MM: f64 = 2.0;
/// Scatter in other coordinates, or with another tool length, over that scatter, that explains it.
pub const MAX_EXPLAINED_SCATTER: f64 = 0.1;
/// Mean square of the difference of tool axes over the poses below which they tell no length.
pub const MIN_AXIS_SPREAD: f64 = 1e-2;
/// Distance (mm) up to which centres without a name are of one ball.
pub const SAME_BALL_MM: f64 = 5.0;
/// Chi-square of two degrees of freedom that chance exceeds once in a thousand: the lobing is there.
pub const MIN_LOBING_CHI_SQUARE: f64 = 13.8;
/// Standard uncertainty of the lobing over that before the touches, above which they do not tell it.
pub const MAX_LOBING_SHARE: f64 = 0.5;
/// Value over its standard uncertainty from which on noise does not hide it. Below: values that are mostly chance are
/// written without a word; above: a squareness known to a thirtieth is warned of.
pub const MIN_TOLD: f64 = 3.0;
