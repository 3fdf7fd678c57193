"""Fields of results by type. python/generate.py writes this file from the results of the façade."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Union

from .._record import Named, Record
from .deviations import Percentile


class BoundedReading(Record):
    """A reading to which bounds lead."""

    name: Annotated[str, "The plane, the axis with a direction, or the senses along a diagonal."]
    rss_um: Annotated[float, "Root of the sum of squares of what 95 % of machines read in which one bound acts alone, um."]
    p95_um: Annotated[Percentile, "The reading that 95 % of the machines drawn do not exceed, um."]


class ReadingsOfBounds(Record):
    """Readings to which bounds lead, first order, without reversal."""

    errors: Annotated[int, "Number of bounded errors."]
    class_source: Annotated[Union[str, None], "Source of the class."]
    samples: Annotated[int, "Number of machines drawn."]
    seed: Annotated[int, "Seed of poses and errors."]
    distribution: Annotated[Literal["uniform", "triangular"], "Distribution of an error between its bounds."]
    statistic: Annotated[Literal["max", "p95"], "Statistic of a machine over the poses."]
    readings: Annotated[list[BoundedReading], "Circular deviation G(b) of each plane, ranges of an R-test along X, Y and Z, or E_d of each diagonal."]


class BothSenses(Record):
    """Figures of each sense of rotation."""

    counter_clockwise: Annotated[float, "With rising angle."]
    clockwise: Annotated[float, "With falling angle."]


class BothSenses2(Record):
    """Figures of each sense of rotation."""

    counter_clockwise: Annotated[list[float], "With rising angle."]
    clockwise: Annotated[list[float], "With falling angle."]


class BallBar(Record):
    """A circle of a ball bar in both senses, evaluated by ISO 230-4."""

    plane: Annotated[Literal["XY", "YZ", "ZX"], "The plane, workpiece frame."]
    circular_deviation_um: Annotated[BothSenses, "Circular deviation G of each path, um: range about its own centre of least squares."]
    bidirectional_um: Annotated[float, "Bidirectional circular deviation G(b), um."]
    mean_radial_um: Annotated[float, "Mean bidirectional radial deviation D, um."]
    radial_max_min_um: Annotated[BothSenses2, "Radial deviations F, um: largest and smallest reading."]
    squareness_urad: Annotated[float, "Angle between the plane's directions minus 90 deg by the second harmonic, urad."]
    scale_mismatch_um_per_m: Annotated[float, "Scale of the first direction minus that of the second, um/m."]
    angle_deg: Annotated[list[float], "Angles of the readings from the plane's first direction to its second, deg."]
    counter_clockwise_um: Annotated[list[float], "Length read minus radius with rising angle, um."]
    clockwise_um: Annotated[list[float], "Length read minus radius with falling angle, um."]


class RTestReading(Record):
    """A reading of an R-test."""

    position_deg: Annotated[float, "Position of the first axis that turns, deg."]
    axes: Annotated[Named[float], "The pose, mm and deg."]
    reading_um: Annotated[list[float], "Deviation of the functional point from the ball, tool relative to workpiece, minus that at the first position, um, machine frame."]


class RTest(Record):
    """An R-test of rotary axes that turn together."""

    axis: Annotated[str, "The axes that turn, such as ``C`` or ``A+C``."]
    range_um: Annotated[list[float], "Ranges of the readings along x, y, z, um."]
    count: Annotated[int, "Number of readings."]
    skipped: Annotated[int, "Number of positions that the other axes cannot follow."]
    readings: Annotated[list[RTestReading], "The readings."]


class Diagonal(Record):
    """A laser along a diagonal."""

    name: Annotated[str, "Sense of each axis along it: p or n, in the order of ``axes``."]
    axes: Annotated[list[str], "Names of the axes."]
    e_d_um: Annotated[float, "E_d, um: range of both runs, the bidirectional systematic deviation E of ISO 230-2."]
    b_d_um: Annotated[float, "B_d, um: largest difference of both runs."]
    by_axis_um: Annotated[Union[list[float], None], "Sum of the changes of the reading by each axis's motions on the forward run, um; with steps only."]
    way_mm: Annotated[list[float], "Nominal displacement from the start, mm."]
    there_um: Annotated[list[float], "Actual minus nominal on the forward run, um; 0 at the start."]
    back_um: Annotated[list[float], "Actual minus nominal on the return run, um, in the order of ``way_mm``."]


class InstrumentFields(Record):
    """Readings of an instrument on a machine, exact model."""

    machine: Annotated[str, "Name of the machine."]
    bounds: Annotated[Union[ReadingsOfBounds, None], "Readings to which the bounds of a machine lead of which nothing is measured; the others are then zero."]
    instrument: Annotated[Literal["ball_bar", "r_test", "diagonals", "step_diagonals"], ""]
    centre: Annotated[Union[Named[float], None], "Centre of the circles, mm and deg."]
    radius_mm: Annotated[Union[float, None], "Length of the ball bar, mm."]
    planes: Annotated[Union[list[BallBar], None], "The circles, plane by plane."]
    ball_at: Annotated[Union[Named[float], None], "Pose at which the ball is, mm and deg."]
    frame: Annotated[Union[Literal["workpiece", "machine", "tool"], None], "Frame of the readings: the machine frame."]
    axes: Annotated[Union[list[RTest], None], "The tests, axis by axis."]
    at: Annotated[Union[Named[float], None], "Pose of the axes that stand, mm and deg."]
    diagonals: Annotated[Union[list[Diagonal], None], "The diagonals, at least one."]
    e_um: Annotated[Union[float, None], "The largest E_d, um."]


class FittedParameter(Record):
    """A parameter with its value."""

    name: Annotated[str, "Name such as ``EX0C``."]
    value: Annotated[Union[float, None], "Value, in ``unit``."]
    determined: Annotated[bool, "False if the readings leave the value free: it is then what the datum makes of it, as a rule 0."]
    sigma: Annotated[Union[float, None], "Combined standard uncertainty, in ``unit``; none if the data leave the value free or nothing scatters."]
    type_a: Annotated[Union[float, None], "The part of it that the scatter of the readings makes, as if each were independent (type A)."]
    lack_of_fit: Annotated[float, "The part of it that the form of the axes makes, which readings near each other share."]
    type_b: Annotated[float, "The part of it that all readings share, as the user states it (type B)."]
    unit: Annotated[str, "Unit of the value and of its uncertainties."]
    coverage_factor_95: Annotated[Union[float, None], "Standard uncertainties that a 95 % interval reaches to either side."]
    valuation: Annotated[float, "Standard deviation of a reading over that of the parameter's effect on a usual reading; 0 if the value is free."]


class KnownValue(Record):
    """A value that was known before the data."""

    name: Annotated[str, "Name of the unknown, or ``distance`` and two points."]
    value: Annotated[float, "Value, in ``unit``."]
    sigma: Annotated[float, "Standard uncertainty, in ``unit``."]
    found: Annotated[float, "Value that the fit finds, in ``unit``."]
    deviations: Annotated[Union[float, None], "Found minus known value in standard deviations of that difference; none where the readings say nothing of it."]
    unit: Annotated[str, "Unit of the value and of its uncertainties."]


class SharedUncertainty(Record):
    """A standard uncertainty that all readings share (type B)."""

    name: Annotated[str, "Its name."]
    scale_um_per_m: Annotated[Union[float, None], "Scale of all lengths, um/m."]
    offset_um: Annotated[Union[float, None], "Offset of every component, um."]


class FormOfAxis(Record):
    """The form of an axis beside its fitted curves."""

    axis: Annotated[str, "The axis."]
    size_um: Annotated[float, "Standard deviation of what the fitted curves leave of a displacement, um, root mean square of the three; 0 if none is stated."]
    rotation_urad: Annotated[float, "Standard deviation of what the fitted curves leave of a rotation, urad, root mean square of the three; 0 if none is stated."]
    sizes_um: Annotated[list[float], "Standard deviation of each displacement, along X, Y and Z, um."]
    rotations_urad: Annotated[list[float], "Standard deviation of each rotation, about X, Y and Z, urad."]
    length: Annotated[float, "Correlation length, in ``unit``."]
    unit: Annotated[str, "mm or deg."]


class BentError(Record):
    """An error that a richer curve would bend."""

    error: Annotated[str, "The error."]
    bend: Annotated[float, "Largest less smallest value of what the curve would add to it, over the positions measured, in ``unit``."]
    unit: Annotated[str, "um or urad."]
    rms_ratio: Annotated[float, "Root mean square of the residuals that it would leave, over that of today."]
    fit: Annotated[Union[str, None], "Word of ``--fit`` that fits the curve; none where ``linear`` holds the error straight."]


class LackOfFit(Record):
    """The form of the axes that the fitted curves leave."""

    probability: Annotated[float, "Probability that there is any, with odds of one to three before the data."]
    forms: Annotated[list[FormOfAxis], "The axes with their forms, if one is likelier than none."]
    bends: Annotated[list[BentError], "Errors that a richer curve would bend, the one first that takes most off the residuals."]
    tied: Annotated[list[str], "Errors with a form whose size is tied to those of the others: the readings do not tell it from them."]


class RmsBeforeAfter(Record):
    """Root mean square of the readings, um."""

    before: Annotated[float, "Against the machine file as it was."]
    after: Annotated[float, "Against the fitted machine."]
    held_out: Annotated[Union[float, None], "Against fits without the readings that they predict, if asked for."]


class ScatterOfKind(Record):
    """Scatter of one kind of reading."""

    of: Annotated[str, "Kind of reading, or ``uncertainties given``."]
    sigma_um: Annotated[float, "Standard deviation of a reading of weight 1, um."]


class RepeatedReadings(Record):
    """Scatter of readings of one kind in poses that were measured again."""

    of: Annotated[str, "Kind of reading."]
    sigma_um: Annotated[float, "Standard deviation of a reading of weight 1, um."]
    degrees_of_freedom: Annotated[int, "Degrees of freedom behind it."]


class OrderShares(Record):
    """Deviations by the order of the errors that make them, root mean square over the readings, um."""

    first: Annotated[float, "First order."]
    second: Annotated[float, "Second order."]
    higher: Annotated[float, "All higher orders."]
    left_by_first: Annotated[float, "Residual of the model of order 1."]
    left_by_second: Annotated[float, "Residual of the model of order 2."]


class KindResidual(Record):
    """Residual of one kind of reading."""

    kind: Annotated[str, "Kind of reading."]
    rows: Annotated[int, "Number of readings."]
    rms_um: Annotated[float, "Root mean square of their residuals, um."]


class ResidualTest(Record):
    """Tests of residuals for randomness; the probabilities hold if the residuals are noise."""

    of: Annotated[str, "Readings tested."]
    count: Annotated[int, "Number of residuals."]
    normality: Annotated[float, "Probability of residuals so far from a normal distribution."]
    runs: Annotated[float, "Probability of so few or so many runs of one sign."]
    lag1: Annotated[float, "Correlation of a residual with the one before it."]


class ResidualGroup(Record):
    """What is left of some of the readings."""

    by: Annotated[str, "``component``, ``axis`` (a third of what was measured of it), ``tool``, ``run`` or ``station``."]
    of: Annotated[str, "Name, such as ``dz``, ``X from 0 to 150``, ``run 3``."]
    readings: Annotated[int, "Number of readings."]
    rms_um: Annotated[float, "Root mean square of what is left of a reading, um."]
    stands_out: Annotated[bool, "True if that is far more than what is left of all."]


class SuspectReadings(Record):
    """A change of the data that explains what the fit leaves."""

    changes: Annotated[list[str], "The changes in words, such as ``dx and dy exchanged``; one or two."]
    others: Annotated[list[str], "Other changes that explain as much, in words: the readings do not tell which it is."]
    left_um: Annotated[float, "Root mean square of what is left with them, um."]
    instead_um: Annotated[float, "What is left without, um."]
    remedies: Annotated[list[str], "The remedies, one for each change."]
    accepted: Annotated[bool, "True if the caller takes the readings as they are."]


class OutlierPlace(Record):
    """A reading that stands out."""

    place: Annotated[str, "File and line."]
    residual_um: Annotated[float, "Its residual, um."]
    deviations: Annotated[float, "The same in standard deviations."]


class PredictedUncertainty(Record):
    """The uncertainty of the deviation over the volume, after the best rigid motion of the workpiece frame."""

    largest_um: Annotated[Union[float, None], "The largest standard uncertainty, um, along the direction in which it is largest; none if the data leave the deviation free, or nothing scatters."]
    infinite: Annotated[bool, "True if the data leave it free somewhere: the uncertainty is infinite."]
    combination: Annotated[Union[str, None], "A combination of parameters that changes the deviation and no reading, in words."]
    at: Annotated[Named[float], "Pose at which it is largest, mm and deg."]
    tool: Annotated[str, "The tool there."]
    deviation_um: Annotated[float, "The largest deviation predicted, um."]
    held: Annotated[bool, "True if the data hold the prediction, so that a machine file is written."]


class FittedDatum(Record):
    """The datum of the fitted errors."""

    line: Annotated[Literal["least-squares", "end-points", "free"], "Reference straight line of the straightness errors of linear axes."]
    zero: Annotated[Literal["start", "middle", "machine", "free"], "Position at which positioning and angular errors are zero."]
    squareness: Annotated[Literal["in location", "in straightness"], "Place of the squareness of the axes."]
    conditions: Annotated[int, "Number of conditions: each fixes a combination of errors that changes nothing but where the workpiece stands."]
    translation_um: Annotated[list[float], "Translation of the whole that was taken out of the errors, um."]
    rotation_urad: Annotated[list[float], "Rotation of the whole that was taken out, about the middle of the volume, urad."]
    measured: Annotated[Union[Named[list[float]], None], "Measured range of each axis (mm, deg) that was measured over less than its travel: the datum is formed there."]


class FittedError(Record):
    """A fitted error over the travel of its axis."""

    error: Annotated[str, "ISO name."]
    smallest: Annotated[Union[float, None], "Smallest value, in ``unit``."]
    largest: Annotated[Union[float, None], "Largest value, in ``unit``; that of a location error is its only one."]
    determined: Annotated[bool, "False if the readings leave one of its parameters free."]
    sigma: Annotated[Union[float, None], "Largest standard uncertainty, in ``unit``; none if the data leave the error free somewhere."]
    unit: Annotated[str, "``um`` or ``urad``."]


class IdentifyFields(Record):
    """A fit."""

    rows: Annotated[int, "Number of readings."]
    points: Annotated[int, "Number of measurements."]
    parameters: Annotated[list[FittedParameter], "The machine's parameters."]
    instruments: Annotated[list[FittedParameter], "Unknowns of the instruments, such as places of stations."]
    known: Annotated[list[KnownValue], "Values that were known before the data."]
    type_b: Annotated[list[SharedUncertainty], "Standard uncertainties that all readings share."]
    lack_of_fit: Annotated[Union[LackOfFit, None], "The form of the axes beside the fitted curves; none if the readings cannot show it: fewer than 20 to spare, or no axis at six positions."]
    rank: Annotated[int, "Numerical rank of the problem."]
    rank_first_order: Annotated[int, "The rank of the model to first order in the errors: what the readings show without products of errors."]
    unknowns: Annotated[int, "Number of unknowns."]
    well_determined: Annotated[int, "Number of independent combinations above the noise."]
    null_space: Annotated[list[str], "Combinations without effect on the data, in words."]
    drowned: Annotated[list[str], "Combinations below the noise, in words."]
    condition: Annotated[float, "Ratio of the largest singular value to the smallest that counts."]
    valuation: Annotated[float, "Least observability of the machine's parameters that have a value."]
    singular_values: Annotated[list[float], "Singular values of the column-scaled problem."]
    rms_um: Annotated[RmsBeforeAfter, "Root mean square of the readings."]
    sigma_um: Annotated[Union[float, None], "Standard deviation of a reading of weight 1, um; none where kinds scatter differently."]
    degrees_of_freedom: Annotated[int, "Readings beyond the rank."]
    scatter: Annotated[list[ScatterOfKind], "Scatter kind by kind, where kinds scatter differently."]
    repeatability_um: Annotated[Union[float, None], "Scatter of repeated poses, um: that of the first kind."]
    repeats: Annotated[list[RepeatedReadings], "Scatter of repeated poses, kind by kind."]
    orders_um: Annotated[OrderShares, "Deviations by order."]
    kinds: Annotated[list[KindResidual], "Residuals kind by kind."]
    residual_tests: Annotated[list[ResidualTest], "Tests of the residuals."]
    residuals: Annotated[list[ResidualGroup], "What is left by component, axis, tool, run and station."]
    suspect: Annotated[Union[SuspectReadings, None], "Changes of the data that explain what is left."]
    outliers: Annotated[list[OutlierPlace], "Readings that stand out, farthest first."]
    prediction: Annotated[PredictedUncertainty, "Uncertainty of the fit's prediction over the volume."]
    invariances: Annotated[list[str], "Rigid motions of the whole machine that no reading notices, such as ``along X``."]
    datum: Annotated[Union[FittedDatum, None], "The datum of the errors, where curves are fitted."]
    errors: Annotated[list[FittedError], "Every fitted error of an axis over its travel."]
    steps: Annotated[int, "Steps of the fit."]
    settled: Annotated[bool, "False if the fit was stopped before it had settled."]


class Rms(Record):
    """Root mean square of readings, um."""

    before: Annotated[float, "As measured."]
    after: Annotated[float, "After the fit."]


class MonomialCoefficient(Record):
    """The coefficient of a monomial."""

    monomial: Annotated[str, "Name such as ``EX0C`` or ``EA0C*EB0C``."]
    value: Annotated[Union[float, None], "Value, in ``unit``."]
    unit: Annotated[str, "Unit of the value."]
    sigma: Annotated[Union[float, None], "Standard uncertainty, in ``unit``, by the pseudo-inverse and what is left of the readings; none without readings to spare. Of a coefficient that the data do not tell from others it is that of the shortest answer."]
    determined: Annotated[bool, "True if the data tell it from the others: it is free of the null space, and the others make its uncertainty no more than ten times what it would be without them."]


class MonomialComponent(Record):
    """One component of the deviation."""

    component: Annotated[str, "``dx``, ``dy`` or ``dz``."]
    readings: Annotated[int, "Number of readings."]
    columns: Annotated[int, "Number of monomials."]
    rank: Annotated[int, "Rank of the problem."]
    rms_um: Annotated[Rms, "Root mean square of the readings."]
    coefficients: Annotated[list[MonomialCoefficient], "The coefficients."]


class MonomialFields(Record):
    """Coefficients of monomials of the errors, which give no machine."""

    method: Annotated[str, "``moore-penrose``."]
    order: Annotated[int, "Highest degree of the monomials."]
    components: Annotated[list[MonomialComponent], "The components of the deviation."]


class PlannedPose(Record):
    """A pose to measure."""

    axes: Annotated[Named[float], "Positions by axis, mm and deg."]
    to: Annotated[Union[Named[float], None], "Positions at the other end of a length, if that is a pose."]
    tool: Annotated[str, "Name of the tool."]
    run: Annotated[Union[str, None], "The run to which it belongs, if there are runs."]


class ExpectedParameter(Record):
    """A parameter with its expected uncertainty."""

    name: Annotated[str, "Name such as ``EX0C``."]
    sigma: Annotated[Union[float, None], "Expected standard uncertainty, in ``unit``; none if the poses leave it free."]
    unit: Annotated[str, "Unit of the uncertainty."]


class ExpectedPrediction(Record):
    """The uncertainty of the deviation over the volume to be expected of a fit, after the best rigid motion of the workpiece frame."""

    largest_um: Annotated[Union[float, None], "The largest standard uncertainty, um, along the direction in which it is largest; none if the readings leave the deviation free, or none is to spare."]
    combination: Annotated[Union[str, None], "A combination of parameters that changes the deviation and no reading, in words."]
    at: Annotated[Named[float], "Pose at which it is largest, mm and deg."]


class PlanGoal(Record):
    """A plan for an uncertainty of the deviation over the volume."""

    um: Annotated[float, "The largest standard uncertainty that was asked for, um."]
    reached: Annotated[bool, "True if the readings reach it; one fewer of them in their order do not."]


class PlanFields(Record):
    """Readings, and what is expected of their measurement."""

    poses: Annotated[list[PlannedPose], "The poses in the order of their worth; those of runs, and of a file, in the order in which they are measured."]
    readings: Annotated[int, "Number of readings: poses, of a laser lines."]
    candidates: Annotated[int, "Number of readings to choose from."]
    noise_um: Annotated[float, "Standard deviation of a reading, um."]
    parameters: Annotated[list[ExpectedParameter], "The parameters of the machine."]
    prediction: Annotated[ExpectedPrediction, "Uncertainty of the deviation that their fit will predict over the volume."]
    goal: Annotated[Union[PlanGoal, None], "The uncertainty that was asked for, if one was."]
    rank: Annotated[int, "Numerical rank of the problem."]
    rank_first_order: Annotated[int, "The rank of the model to first order in the errors: what the readings show without products of errors."]
    unknowns: Annotated[int, "Number of unknowns, those of the instrument among them."]
    well_determined: Annotated[int, "Number of independent combinations above the noise."]
    null_space: Annotated[list[str], "Combinations without effect, in words."]
    drowned: Annotated[list[str], "Combinations below the noise, in words."]
    condition: Annotated[float, "Ratio of the largest singular value to the smallest that counts."]


class SeenCorrection(Record):
    """The amount of a correction that the readings see: 1 as predicted, 0 none, -1 reversed."""

    axis: Annotated[Union[str, None], "The axis that is corrected; none for all together."]
    amount: Annotated[float, "The amount."]
    expanded_uncertainty: Annotated[float, "Its expanded uncertainty (k = 2), that of the prediction and of the readings in it."]


class PredictedKind(Record):
    """Readings of one kind against their prediction, without what the set-up explains; root mean squares over the places, all components together."""

    kind: Annotated[str, "``deviations``, ``lengths`` ..."]
    unit: Annotated[str, "``um`` or ``urad``."]
    places: Annotated[int, "Number of rows."]
    within: Annotated[float, "Share of |E_n| <= 1."]
    measured: Annotated[float, "RMS of the readings."]
    predicted: Annotated[float, "RMS of the prediction."]
    left: Annotated[float, "RMS of measured less predicted."]


class SetUpValue(Record):
    """A motion of the set-up, or an unknown of an instrument, by the readings."""

    name: Annotated[str, "Such as ``part x``, ``turn C``, ``slope EYX``, ``station.x``."]
    value: Annotated[float, "Distance from where it starts."]
    unit: Annotated[str, "``um`` or ``urad``."]
    known: Annotated[Union[float, None], "Standard uncertainty with which it was known before, in ``unit``; none if it was free."]


class JudgedReading(Record):
    """A reading against its prediction, both less nominal and without what the set-up explains."""

    place: Annotated[str, "Name of the file, and line."]
    component: Annotated[int, "Component of its row: 0, 1 or 2."]
    unit: Annotated[str, "``um`` or ``urad``."]
    predicted: Annotated[float, "Predicted."]
    measured: Annotated[float, "Measured."]
    predicted_u: Annotated[float, "Expanded uncertainty of the predicted one (k = 2)."]
    measured_u: Annotated[float, "Expanded uncertainty of the measured one (k = 2), the set-up's in it."]
    e_n: Annotated[Union[float, None], "Difference over the root of the sum of both squared; none where the reading holds nothing but the set-up."]


class PredictFields(Record):
    """Readings of a machine against the prediction of its file, without a fit."""

    machine: Annotated[str, "Name of the machine."]
    verdict: Annotated[Literal["within", "not-within", "cannot-tell"], "The verdict."]
    words: Annotated[str, "The verdict in words."]
    within: Annotated[float, "Share of |E_n| <= 1."]
    within_expected: Annotated[float, "The share expected, k = 2."]
    within_least: Annotated[float, "The least share that 995 of 1000 good campaigns reach: what readings share makes it small."]
    errors_seen: Annotated[Union[SeenCorrection, None], "The amount of the errors of the file that is seen; none if they do nothing at these places."]
    instead: Annotated[Union[Literal["nominal", "reversed", "half"], None], "A machine that the readings agree with, if not with that of the file."]
    has_predicted_uncertainty: Annotated[bool, "True if the machine file states how sure its errors are."]
    counted_once: Annotated[list[str], "Contributions of the errors and of the readings that count once, by name."]
    kinds: Annotated[list[PredictedKind], "By kind of reading."]
    set_up: Annotated[list[SetUpValue], "Set-up and instruments, by the readings."]
    readings: Annotated[list[JudgedReading], "Every reading."]


class LocatedError(Record):
    """A location error."""

    name: Annotated[str, "Its name."]
    unit: Annotated[str, "``um`` or ``urad``."]
    found: Annotated[float, "Value by the lines that were found."]
    uncertainty: Annotated[Union[float, None], "Expanded uncertainty (k = 2) that the table states."]
    in_file: Annotated[float, "Value in the machine file, 0 if it gives none."]
    in_file_uncertainty: Annotated[Union[float, None], "Expanded uncertainty (k = 2) in the machine file."]
    difference: Annotated[float, "Found minus in the file."]
    agrees: Annotated[Union[bool, None], "True if the difference is within both uncertainties, as the root of the sum of their squares; none if neither is stated."]


class AxisLine(Record):
    """A line in machine directions, all axes at 0."""

    point_mm: Annotated[list[float], "The point next to the nominal origin of the axis, in the coordinates of the machine file."]
    direction: Annotated[list[float], "The unit vector about which a positive command turns the tool right-handed relative to the workpiece."]


class LocatedAxis(Record):
    """A rotary axis as a line."""

    axis: Annotated[str, "Name of the axis."]
    found: Annotated[Union[AxisLine, None], "The line that was found; none if nothing was."]
    in_file: Annotated[AxisLine, "The line where the machine file displaces it."]
    uncertainty_um: Annotated[Union[float, None], "The largest expanded uncertainty (k = 2) of its shifts in the machine file."]
    uncertainty_urad: Annotated[Union[float, None], "The largest expanded uncertainty (k = 2) of its tilts in the machine file."]


class LocateFields(Record):
    """Location errors that were found."""

    machine: Annotated[str, "Name of the machine."]
    target: Annotated[Union[str, None], "The controller whose parameters were read; none of a table."]
    errors: Annotated[list[LocatedError], "The errors, axis by axis; none if nothing was found."]
    lines: Annotated[list[LocatedAxis], "The rotary axes in the order of the walk."]


class StraightnessReference(Record):
    """The straight line in a straightness, before it was taken off."""

    slope_um_per_m: Annotated[float, "Its slope."]
    rise_um: Annotated[float, "Its rise over the targets."]
    length_mm: Annotated[float, "The distance between the outermost targets."]
    taken_off: Annotated[bool, "True if it was taken off: all figures and the table are without it."]
    squareness: Annotated[Union[str, None], "The squareness that it would be if the reference was an artefact of the machine."]
    squareness_urad: Annotated[Union[float, None], "The value of that squareness in urad."]


class OneWayAccuracy(Record):
    """Figures of one direction of approach, in the unit of the error."""

    E: Annotated[float, "Systematic deviation E of the direction."]
    R: Annotated[Union[float, None], "Repeatability R of the direction; none without repeated runs."]
    A: Annotated[Union[float, None], "Accuracy A of the direction; none without repeated runs."]


class OneWayBoth(Record):
    """Figures of both directions of approach; none of a direction that was not measured."""

    forward: Annotated[Union[OneWayAccuracy, None], "Approached with rising position."]
    reverse: Annotated[Union[OneWayAccuracy, None], "Approached with falling position."]


class AccuracyUncertainties(Record):
    """Expanded uncertainties, k = 2, in the unit of the error, after ISO 230-2 annex A: not verified against its text."""

    E: Annotated[float, "Uncertainty of E, of one direction and of both."]
    M: Annotated[float, "Uncertainty of M."]
    B: Annotated[float, "Uncertainty of B."]
    R: Annotated[float, "Uncertainty of R."]
    A: Annotated[float, "Uncertainty of A."]


class StatedContributors(Record):
    """Contributors of ISO/TR 230-9 that an uncertainty has, and those that it lacks; the list may not be complete."""

    has: Annotated[list[str], "Those that count."]
    lacks: Annotated[list[str], "Those that are not stated."]


class ReadAtTarget(Record):
    """Readings of one direction at a target, in the unit of the error."""

    mean: Annotated[float, "Their mean."]
    s: Annotated[Union[float, None], "The estimate of the standard deviation; none of a single reading."]
    runs: Annotated[int, "Their number."]


class MeasuredTarget(Record):
    """A target with its readings."""

    position: Annotated[float, "Position, mm or deg."]
    forward: Annotated[Union[ReadAtTarget, None], "Approached with rising position."]
    reverse: Annotated[Union[ReadAtTarget, None], "Approached with falling position."]
    unknown: Annotated[Union[ReadAtTarget, None], "Approached from a side that is not known."]
    B: Annotated[Union[float, None], "Reversal: mean of the forward approach minus mean of the reverse one. Lost motion is below zero."]


class ImportedError(Record):
    """Figures of one error over the axis, after ISO 230-2:2014; lengths in um, angles in urad."""

    error: Annotated[str, "Name of the error."]
    unit: Annotated[str, "Unit of the figures."]
    targets: Annotated[int, "Number of target positions."]
    runs: Annotated[int, "Least number of runs of a target in a direction."]
    bidirectional: Annotated[bool, "True if both directions were measured."]
    E: Annotated[float, "Systematic deviation E."]
    M: Annotated[float, "Mean deviation M."]
    B: Annotated[Union[float, None], "Reversal B: the largest size of those of the targets; none without two directions."]
    mean_B: Annotated[Union[float, None], "Mean of the reversals of the targets, with its sign."]
    R: Annotated[Union[float, None], "Repeatability R; none without repeated runs."]
    A: Annotated[Union[float, None], "Accuracy A; none without repeated runs."]
    slope: Annotated[float, "Slope of the line of best fit, in ``slope_unit``."]
    slope_unit: Annotated[str, "Unit of the slope, such as ``um/m``."]
    line: Annotated[Union[StraightnessReference, None], "Line of the reference, of a straightness of a linear axis."]
    one_way: Annotated[OneWayBoth, "Figures by direction."]
    U: Annotated[Union[AccuracyUncertainties, None], "Expanded uncertainties, k = 2, where contributors are stated that count for this error."]
    contributors: Annotated[Union[StatedContributors, None], "Contributors that these uncertainties have and lack."]
    remarks: Annotated[list[str], "In sentences what ISO 230-2 wants of targets and runs; not verified against its text."]
    at_targets: Annotated[list[MeasuredTarget], "The readings by target."]


class ReferenceMaterial(Record):
    """The material of a machine at the time of a measurement."""

    temperature_deg_c: Annotated[float, "Its temperature, deg C."]
    expansion_um_per_m_k: Annotated[float, "Its coefficient of expansion, um/(m K)."]


class LeftOutRow(Record):
    """A row that was not used."""

    line: Annotated[int, "Its line."]
    reason: Annotated[str, "The reason."]


class LeftOutColumn(Record):
    """A column that was not used."""

    column: Annotated[str, "Its title."]
    reason: Annotated[str, "The reason."]


class ImportFinding(Record):
    """A suspicion against readings."""

    kind: Annotated[Literal["rows-lost", "columns-exchanged", "twice", "outlier", "scatter", "drift", "directions-exchanged", "unit-of-run", "sign-of-run", "unit"], "The kind."]
    error: Annotated[Union[str, None], "The error; none of the file as a whole."]
    lines: Annotated[list[int], "The lines, in the order of their weight."]
    message: Annotated[str, "In a sentence."]
    remedy: Annotated[str, "The remedy."]
    effect: Annotated[Literal["used", "left-out", "refused", "accepted"], "The use that was made of the readings."]


class ImportedChannel(Record):
    """A channel of a six-degree instrument."""

    column: Annotated[str, "Title of the column."]
    error: Annotated[str, "The error that it shows."]
    sign: Annotated[str, "``+`` or ``-``: the error is the column's value times this sign."]


class ImportFields(Record):
    """A measurement with its figures after ISO 230-2."""

    axis: Annotated[str, "Name of the axis."]
    form: Annotated[str, "Layout of the file, in words."]
    directions_inferred: Annotated[bool, "True if directions were read off the order of the rows."]
    errors: Annotated[list[ImportedError], "The errors with their figures."]
    material: Annotated[Union[ReferenceMaterial, None], "The material whose expansion was taken off the positions."]
    readings: Annotated[int, "Number of readings."]
    left_out: Annotated[list[LeftOutRow], "Rows that were not used."]
    columns_left_out: Annotated[list[LeftOutColumn], "Columns, blocks and runs that were not used."]
    findings: Annotated[list[ImportFinding], "Suspicions against the readings."]
    channels: Annotated[list[ImportedChannel], "The errors of the channels of a six-degree instrument."]
    metadata: Annotated[list[list[str]], "Entries before the table."]


class ProbeLobing(Record):
    """Threefold lobing of a probe: what its effective radius changes by with the angle t of the touch about its axis, ``cos`` cos 3t + ``sin`` sin 3t, in the frame of the tool."""

    amplitude_um: Annotated[float, "Its amplitude."]
    cos_um: Annotated[float, "Part with the cosine."]
    sin_um: Annotated[float, "Part with the sine."]
    u_um: Annotated[float, "The larger standard uncertainty of the two."]
    is_significant: Annotated[bool, "True if chance would show as much once in a thousand."]
    is_determined: Annotated[bool, "True if the touches tell it from the places of the balls."]


class BallCentre(Record):
    """Centre of a ball in a pose, by the nominal machine: how the centres of a ball differ is its error."""

    ball: Annotated[str, "Name of the ball."]
    pose: Annotated[str, "Name of the pose."]
    rotary: Annotated[Named[float], "Positions of the rotary axes, deg."]
    centre_mm: Annotated[list[float], "The centre from the workpiece origin, workpiece frame."]
    covariance_um2: Annotated[list[list[float]], "Covariance of its coordinates, radius and lobing unknown."]
    touches: Annotated[int, "Number of touches."]


class OutlierTouch(Record):
    """A touch that stands out."""

    ball: Annotated[str, "Name of the ball."]
    pose: Annotated[str, "Name of the pose."]
    touch: Annotated[int, "Number of the touch in its set."]
    line: Annotated[int, "Its line."]
    off_um: Annotated[float, "Distance outside the ball by the other touches; below 0 inside."]


class TouchImportFields(Record):
    """Balls by touch."""

    machine: Annotated[str, "Name of the machine."]
    balls: Annotated[int, "Number of balls."]
    touches: Annotated[int, "Number of touches."]
    sigma_um: Annotated[float, "Standard deviation of a touch."]
    degrees_of_freedom: Annotated[float, "Residual degrees of freedom."]
    effective_radius_mm: Annotated[float, "Radius of ball and stylus less the pre-travel, one for all touches."]
    effective_radius_u_um: Annotated[float, "Its standard uncertainty."]
    lobing: Annotated[ProbeLobing, "Threefold lobing of the probe."]
    centres: Annotated[list[BallCentre], "The centres, in the order of the log."]
    outliers: Annotated[list[OutlierTouch], "Touches that stand out."]


class MeasuredSet(Record):
    """A ball in a pose of the rotary axes."""

    ball: Annotated[str, "Name of the ball."]
    pose: Annotated[str, "Name of the pose."]
    middle: Annotated[Named[float], "Positions of the axes (mm, deg) with the stylus in the middle of the ball."]


class MeasureFields(Record):
    """A program that measures balls."""

    machine: Annotated[str, "Name of the machine."]
    controller: Annotated[str, "The controller."]
    certainty: Annotated[str, "The certainty of the syntax, in a word."]
    start: Annotated[Named[float], "Positions of the axes (mm, deg) from which the program starts: high above all balls."]
    sets: Annotated[list[MeasuredSet], "The sets in their order."]
    checked: Annotated[str, "Sizes of balls, stems and probe of which the moves keep clear, in words."]
    touches: Annotated[int, "Number of touches that are logged."]
    slow_mm_per_min: Annotated[float, "Feed of the touches that are logged, mm/min."]
    fast_mm_per_min: Annotated[float, "Feed of approaches, mm/min."]
    names: Annotated[list[str], "Names of the files."]


class BothSenses3(Record):
    """Figures of each sense of rotation."""

    counter_clockwise: Annotated[Union[float, None], "With rising angle."]
    clockwise: Annotated[Union[float, None], "With falling angle."]


class BothSenses4(Record):
    """Figures of each sense of rotation."""

    counter_clockwise: Annotated[Union[list[float], None], "With rising angle."]
    clockwise: Annotated[Union[list[float], None], "With falling angle."]


class CircleUncertainties(Record):
    """Expanded uncertainties (k = 2) of the figures of a circle, um: by the scatter about the causes alone, which is in single readings. Errors that repeat along an axis count as scatter; what the instrument adds is not in them."""

    G: Annotated[float, "Of G and G(b), the difference of two readings."]
    D: Annotated[float, "Of D, a mean of all."]
    F: Annotated[float, "Of each of F, one reading."]
    contributors: Annotated[StatedContributors, "Contributors that these have and lack."]


class UncertainValue(Record):
    """A value with its standard uncertainty."""

    value: Annotated[float, "The value."]
    sigma: Annotated[Union[float, None], "Standard uncertainty by what the causes leave (type A); none without readings to spare."]


class SpikeTest(Record):
    """A reversal spike: a short peak after an axis has turned, the same in both senses."""

    height_um: Annotated[UncertainValue, "Height: above zero outwards."]
    start_deg: Annotated[float, "Angle from the turning point to its beginning."]
    width_deg: Annotated[float, "Length at half its height, as an angle."]
    width_mm: Annotated[float, "The same along the path."]
    width_ms: Annotated[Union[float, None], "The same in time, with a feed."]
    chance: Annotated[float, "Probability that normal scatter shows one as strong at any turning point; below 1e-9 it is rounding."]


class TurningTest(Record):
    """A turning point of an axis."""

    axis: Annotated[str, "The axis, ``X``, ``Y`` or ``Z``."]
    end: Annotated[str, "The end at which it turns: ``+`` where it is largest, or ``-``."]
    angle_deg: Annotated[float, "Its angle on the circle."]
    spike: Annotated[Union[SpikeTest, None], "The reversal spike after it; none if the readings show none."]
    limit_um: Annotated[Union[float, None], "Height from which on a spike of any length would be found; none where the readings are too few to judge."]


class CauseTest(Record):
    """Causes of the deviations of a circle, each beside the others by least squares."""

    squareness_urad: Annotated[UncertainValue, "Angle between the directions of the plane minus 90 deg. Of one sense servo mismatch is in it."]
    scale_mismatch_um_per_m: Annotated[UncertainValue, "Scale of the first direction minus scale of the second."]
    reversal_um: Annotated[list[UncertainValue], "Reversal of both axes, as ISO 230-2 signs it: below zero is lost motion."]
    servo_um: Annotated[Union[UncertainValue, None], "Servo mismatch as a radial amplitude: above zero the first axis lags more. None of one sense."]
    servo_ms: Annotated[Union[UncertainValue, None], "The same as a difference of delays, with a feed."]
    turning_points: Annotated[list[TurningTest], "Where the axes turn, by rising angle, with the reversal spikes."]
    rest_um: Annotated[float, "Root mean square of what these causes leave beside the spikes."]


class MotionTest(Record):
    """An error motion about the centre of least squares."""

    motion: Annotated[str, "Probe, or what was formed of probes."]
    unit: Annotated[str, "Unit of the figures, ``um`` or ``urad``."]
    places: Annotated[int, "Places of the turn."]
    turns: Annotated[int, "Turns, at the place that has fewest."]
    total: Annotated[float, "Total error motion."]
    synchronous: Annotated[float, "Synchronous error motion; of an axial probe the residual one, without the fundamental."]
    asynchronous: Annotated[Union[float, None], "Asynchronous error motion; none of one turn."]
    once: Annotated[float, "Amplitude of what goes round once. Radial: how far the artefact stood off the axis. Axial: the fundamental, which is an error motion."]
    synchronous_with_once: Annotated[float, "Synchronous error motion with what goes round once."]


class DriftOf(Record):
    """The drift of one displacement or tilt."""

    drift: Annotated[str, "Probe or tilt."]
    unit: Annotated[str, "Unit of the figures, ``um`` or ``urad``."]
    range: Annotated[float, "Range over the test."]
    first_hour: Annotated[float, "Range over the first 60 minutes."]
    largest_in_an_hour: Annotated[float, "Largest range within 60 minutes."]
    change: Annotated[float, "Last minus first."]


class TemperatureRange(Record):
    """The range of a temperature."""

    sensor: Annotated[str, "The sensor."]
    deg_c: Annotated[list[float], "Lowest and highest, deg C."]


class DiagonalTest(Record):
    """One diagonal, with the figures of ISO 230-2."""

    diagonal: Annotated[str, "Its name."]
    length_mm: Annotated[float, "Largest minus smallest target."]
    targets: Annotated[int, "Number of targets."]
    runs: Annotated[int, "Smallest number of runs that a target has in a direction."]
    e_um: Annotated[float, "Systematic deviation E of both directions."]
    b_um: Annotated[Union[float, None], "Largest reversal B, and the mean with its sign; none of one direction."]
    mean_b_um: Annotated[Union[float, None], "Mean reversal: below zero is lost motion."]
    m_um: Annotated[float, "Mean deviation M."]
    r_um: Annotated[Union[float, None], "Repeatability R; none of single runs."]
    a_um: Annotated[Union[float, None], "Accuracy A; none of single runs."]


class FiguresFields(Record):
    """Figures of a test. Serialises as docs/formats/measurements.md describes."""

    test: Annotated[Literal["circle", "rotation", "drift", "diagonals"], ""]
    plane: Annotated[Union[Literal["XY", "YZ", "ZX"], None], "The plane."]
    radius_mm: Annotated[Union[float, None], "Nominal radius."]
    arc_deg: Annotated[Union[float, None], "Arc on which there are readings."]
    readings: Annotated[Union[int, None], "Number of readings."]
    circular_deviation_um: Annotated[Union[BothSenses3, None], "Circular deviation G about the centre of least squares."]
    bidirectional_um: Annotated[Union[float, None], "Bidirectional circular deviation G(b)."]
    mean_radial_um: Annotated[Union[float, None], "Mean bidirectional radial deviation D."]
    radial_max_min_um: Annotated[Union[BothSenses4, None], "Radial deviations F about the nominal centre, largest and smallest."]
    U: Annotated[Union[CircleUncertainties, None], "Expanded uncertainties (k = 2) of G, G(b), D and F, type A."]
    centre_um: Annotated[Union[list[float], None], "Centre of least squares from the nominal one: how the ball stood."]
    causes: Annotated[Union[CauseTest, None], "The circle taken apart; none where the readings do not tell causes apart."]
    note: Annotated[str, "The standard's text was not at hand."]
    motions: Annotated[Union[list[MotionTest], None], "Error motions by probe, then in the rotating sensitive direction, then tilts."]
    minutes: Annotated[Union[float, None], "Duration of the test."]
    drifts: Annotated[Union[list[DriftOf], None], "Displacements by probe, then tilts."]
    temperatures: Annotated[Union[list[TemperatureRange], None], "Ranges of the temperatures."]
    e_d_um: Annotated[Union[float, None], "Diagonal systematic deviation of positioning E_d: the largest E of the diagonals."]
    b_d_um: Annotated[Union[float, None], "Diagonal reversal B_d: the largest B of the diagonals; none of one direction."]
    diagonals: Annotated[Union[list[DiagonalTest], None], "Each diagonal."]
