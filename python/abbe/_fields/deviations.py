"""Fields of results by type. python/generate.py writes this file from the results of the façade."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Union

from .._record import Named, Record


class AlgebraResult(Record):
    """The algebra that a result was computed over."""

    generators: Annotated[list[str], "Names of the generators, x1 first."]
    monomial_order: Annotated[str, "Order of monomials: graded reverse lexicographic, x1 > x2 > ..."]
    groebner_basis: Annotated[list[str], "Reduced Groebner basis of the ideal up to the degree, each element solved for its leading monomial; empty without relations."]
    monomials: Annotated[list[str], "Monomials that are a basis of the algebra over the reals."]


class Over(Record):
    """What a result is over."""

    kind: Annotated[Literal["volume", "job", "axis_poses"], "A volume, a job, or poses of the axes."]
    reference: Annotated[Literal["machine", "machine-less-unheld", "zero", "zero-less-unheld", "datum", "best-fit"], "Motion that the part's set-up takes out."]
    minimum_zone: Annotated[Union[bool, None], "True if the best fit is the minimum zone."]
    path: Annotated[bool, "True if the poses are one continuous path."]
    poses: Annotated[int, "Number of poses asked for."]
    reached: Annotated[int, "Number of poses that are reached."]
    tool: Annotated[str, "Name of the tool; empty where the machine has one without a name."]


class PathRewind(Record):
    """A step in which the tool has to leave the path."""

    lines: Annotated[list[int], "Lines of the file before and after it."]
    turns_deg: Annotated[Named[float], "Motions of the rotary axes, deg."]


class PathPole(Record):
    """A passage near the line of a rotary axis."""

    axis: Annotated[str, "Name of the rotary axis."]
    lines: Annotated[list[int], "Lines of the file before and after it."]
    nearest_line: Annotated[int, "The line after the step that comes nearest."]
    nearest_deg: Annotated[float, "Least angle between the tool and the axis, deg."]
    turn_deg: Annotated[float, "Angle by which the axis turns meanwhile, deg."]
    deg_per_mm: Annotated[Union[float, None], "Largest turn of the axis per motion of the tip, deg/mm; none if the axis turns while the tip stands."]


class PathAxis(Record):
    """The motion of an axis along a path."""

    axis: Annotated[str, "Its name."]
    unit: Annotated[str, "``mm`` or ``deg``."]
    motion: Annotated[float, "Sum of its motions, rewinds among them."]
    largest_step: Annotated[float, "Its largest motion from one row to the next, rewinds apart."]
    largest_step_line: Annotated[Union[int, None], "The line after that step; none if it does not move."]
    reversals: Annotated[list[int], "Lines of the file at which it reverses."]


class DeviationStep(Record):
    """The largest change of the position deviation from one row to the next that is in reach, rewinds apart: the step that it leaves in the part."""

    um: Annotated[float, "Length of the change, um, workpiece frame; of machines drawn between bounds the one that 95 % do not exceed."]
    interval_um: Annotated[Union[list[float], None], "The interval in which it lies, um; none where it is not drawn."]
    drawn: Annotated[bool, "True if machines are drawn between bounds."]
    lines: Annotated[list[int], "Lines of the file before and after it; of machines drawn in the one whose step that is."]


class PathResult(Record):
    """Events of a path on a machine."""

    rewinds: Annotated[list[PathRewind], "The steps in which the tool has to leave the path, in their order."]
    pole_crossings: Annotated[list[PathPole], "The passages near the line of a rotary axis, axis by axis."]
    axes: Annotated[list[PathAxis], "The motion of each axis."]
    deviation_step: Annotated[Union[DeviationStep, None], "The largest change of the position deviation from one row to the next, in a map."]


class EvalUnits(Record):
    """Units of an ``EvalResult``."""

    position: Annotated[str, "Unit of positions and deviations of points."]
    rotation: Annotated[str, "Unit of rotations."]
    linear_axis: Annotated[str, "Unit of positions of linear axes."]
    rotary_axis: Annotated[str, "Unit of positions of rotary axes."]


class PoseUncertainty(Record):
    """Expanded uncertainty (k = 2) of the deviation at a pose, component by component, to first order."""

    deviation: Annotated[list[float], "Uncertainty of the position of the functional point, mm."]
    rotation: Annotated[list[float], "Uncertainty of the orientation of the tool, rad."]


class ErrorEffect(Record):
    """Effect of an error, or of a pair of errors, at a pose; workpiece frame."""

    error: Annotated[str, "Name of the error; of a pair ``A*B``."]
    deviation: Annotated[list[float], "Displacement of the functional point when each error is 1 mm or 1 rad, mm."]
    rotation: Annotated[list[float], "Rotation of the tool, rad."]
    value: Annotated[float, "Product of the values of the errors at the pose, mm and rad."]


class Neglected(Record):
    """Bound of the terms that order 1 neglects: all interactions of second degree with one sign."""

    position_mm: Annotated[float, "Displacement of the functional point, mm."]
    rotation_rad: Annotated[float, "Rotation of the tool, rad."]


class MonomialPart(Record):
    """The part of a deviation that one monomial in the generators makes, with the errors as large as they are."""

    monomial: Annotated[str, "``EXX*EC0Y^2``; ``i^2`` of an order; ``1`` of location errors in the real part."]
    deviation: Annotated[list[float], "Displacement of the functional point, mm."]
    rotation: Annotated[list[float], "Rotation of the tool, rad."]
    e_ve: Annotated[list[list[float]], "``T_tool^-1 T_work``, row by row."]


class DegreePart(Record):
    """The part of a deviation that all monomials of one degree make."""

    degree: Annotated[int, "Total degree; 0 of location errors in the real part."]
    deviation: Annotated[list[float], "Displacement of the functional point, mm."]
    rotation: Annotated[list[float], "Rotation of the tool, rad."]
    e_ve: Annotated[list[list[float]], "``T_tool^-1 T_work``, row by row."]


class InversePole(Record):
    """A pose at which the tool is parallel to a rotary axis: the position alone is solved for."""

    free: Annotated[str, "The rotary axis that is free: it does not turn the tool axis."]
    unreachable: Annotated[list[float], "Unit vector across the tool axis, workpiece frame, into which no axis turns it."]


class PoseResult(Record):
    """Deviation at one pose."""

    axes: Annotated[Named[float], "The pose, mm and deg."]
    nominal: Annotated[list[float], "Nominal position of the functional point from the workpiece origin, mm."]
    deviation: Annotated[list[float], "Actual minus nominal position of the functional point, mm."]
    rotation: Annotated[list[float], "Actual minus nominal orientation of the tool, rad."]
    along_normal: Annotated[Union[float, None], "The part of the deviation along the normal of the surface, out of the material, mm; none where the tool poses have no columns NX, NY, NZ."]
    e_ve: Annotated[list[list[float]], "``T_tool^-1 T_work``, actual minus nominal, row by row; of the machine, whatever the reference."]
    beyond_measured: Annotated[Union[list[str], None], "Axes that the pose takes beyond the range in which their curves were measured."]
    uncertainty: Annotated[Union[PoseUncertainty, None], "Expanded uncertainty of the deviation, where the machine states that of its errors."]
    sensitivity: Annotated[Union[list[ErrorEffect], None], "Effect of each error, with ``sensitivity``."]
    interactions: Annotated[Union[list[ErrorEffect], None], "Effect of pairs of errors, with ``interactions``."]
    order_1_neglects: Annotated[Union[Neglected, None], "Bound of the terms that order 1 neglects at this pose, with ``interactions``."]
    coefficients: Annotated[Union[list[MonomialPart], None], "Parts of the monomials of an algebra, or of the powers of one generator with an order, lowest degree first; those that are 0 left out."]
    degrees: Annotated[Union[list[DegreePart], None], "Their sums by degree."]
    inverse: Annotated[Union[Named[float], None], "Motions of the axes that undo the errors, mm and deg, with ``inverse``."]
    inverse_pole: Annotated[Union[InversePole, None], "The pole at which they hold the position alone: what is free, and what is left."]


class EvalFields(Record):
    """Deviations at poses."""

    machine: Annotated[str, "Name of the machine."]
    order: Annotated[str, "``exact``, a degree, or the algebra in words."]
    algebra: Annotated[Union[AlgebraResult, None], "The algebra asked for."]
    frame: Annotated[Literal["workpiece", "machine", "tool"], "Frame of the vectors."]
    direction: Annotated[Literal["mean", "forward", "reverse"], "Side of approach."]
    tool: Annotated[str, "Name of the tool; empty for a tool without a name."]
    over: Annotated[Union[Over, None], "What the result is over, for a job or a reference, and where something is taken out of the deviations."]
    path: Annotated[Union[PathResult, None], "Events of the path, if the tool poses are one."]
    units: Annotated[EvalUnits, "Units of the numbers."]
    poses: Annotated[list[PoseResult], "The poses in their order."]


class MissingInLimit(Record):
    """Errors with neither value nor bound that could turn a limit that is held without them."""

    errors: Annotated[int, "Number of these errors."]
    um: Annotated[Union[float, None], "The figure with these bounds, um; none where it was not asked for, place by place."]


class LimitVerdict(Record):
    """A figure against the limit of a job."""

    limit_um: Annotated[float, "The limit, um."]
    um: Annotated[float, "The position deviation that is judged, um: the statistic over the poses; of machines drawn the value that 95 % of them do not exceed."]
    interval_um: Annotated[Union[list[float], None], "The interval in which it lies, um: of machines drawn by their number, else by the uncertainties of errors that the file states; none without such."]
    statistic: Annotated[Literal["max", "p95"], "The figure of a machine over the poses."]
    drawn: Annotated[bool, "True if machines are drawn between bounds; errors with values act in each."]
    missed: Annotated[int, "Number of tool poses of the job that are out of reach."]
    partial: Annotated[Union[bool, None], "True if errors or bounds of the machine are left out of the figure, so that it decides nothing."]
    missing: Annotated[Union[MissingInLimit, None], "The errors with neither value nor bound that could turn the verdict, if there are any."]
    held: Annotated[Union[bool, None], "True if the limit is held; none where the interval is on both sides of it, where it is not exceeded but tool poses are out of reach, so that the job is not done, where errors or bounds are left out of the figure, and where missing errors could turn it."]


class LengthStatistics(Record):
    """Statistics of lengths, or of lengths minus those of others."""

    max: Annotated[float, "Largest."]
    mean: Annotated[float, "Mean."]
    rms: Annotated[float, "Root of the mean square."]
    p95: Annotated[float, "The ceil(0.95 n)-th smallest."]


class PercentileInterval(Record):
    """A percentile of machines drawn with its confidence interval; none where there are too few machines for one."""

    value: Annotated[float, "The percentile."]
    low: Annotated[Union[float, None], "Lower end of its 95 % confidence interval."]
    high: Annotated[Union[float, None], "Upper end of its 95 % confidence interval."]


class DrawnMachineFigures(Record):
    """Figures of machines drawn."""

    mean: Annotated[float, "Mean."]
    mean_sigma: Annotated[float, "Standard error of the mean."]
    p95: Annotated[float, "Value that 95 % of the machines do not exceed."]
    percentiles: Annotated[Named[PercentileInterval], "Percentiles by name, such as ``p95``."]


class BoundedLengths(Record):
    """A deviation that bounds lead to over poses."""

    rss: Annotated[LengthStatistics, "Statistics over the poses of the root of the sum of squares."]
    monte_carlo: Annotated[DrawnMachineFigures, "Largest deviation over the poses, of machines drawn."]


class WorstBoundedPose(Record):
    """A pose with a large 95 % value."""

    axes: Annotated[Named[float], "The pose, mm and deg."]
    rss_um: Annotated[float, "Root of the sum of squares of the bounds' effects on the functional point, um."]
    p95_um: Annotated[float, "The position deviation that 95 % of the machines drawn do not exceed, um."]


class MapFromBounds(Record):
    """What the bounds of a machine lead to over a map."""

    errors: Annotated[int, "Number of bounded errors."]
    class_source: Annotated[Union[str, None], "Source of the class."]
    samples: Annotated[int, "Number of machines drawn."]
    seed: Annotated[int, "Seed of poses and errors."]
    distribution: Annotated[Literal["uniform", "triangular"], "Distribution of an error between its bounds."]
    statistic: Annotated[Literal["max", "p95"], "Statistic of a machine over the poses."]
    position_um: Annotated[BoundedLengths, "The position deviation, um."]
    rotation_urad: Annotated[BoundedLengths, "The rotation of the tool, urad."]
    worst: Annotated[list[WorstBoundedPose], "The worst poses, largest 95 % value of the position deviation first."]


class AddedDeviation(Record):
    """A deviation that bounds add."""

    rss: Annotated[float, "Root of the sum of squares of the bounds' effects, at the pose where that is largest."]
    p95: Annotated[float, "The largest deviation over the poses that 95 % of the machines drawn do not exceed."]


class AddedByBounds(Record):
    """What the bounds of a machine add to its measured errors: a budget of those errors that have no value."""

    errors: Annotated[int, "Number of these errors."]
    poses: Annotated[int, "Number of poses: those of the budget, or of the work."]
    samples: Annotated[int, "Number of machines drawn."]
    seed: Annotated[int, "Seed of poses and errors."]
    position_um: Annotated[AddedDeviation, "Of the position deviation, um."]
    rotation_urad: Annotated[AddedDeviation, "Of the orientation, urad."]


class Summary(Record):
    """Statistics of vectors: of their length, except for the range."""

    max: Annotated[float, "Largest length."]
    mean: Annotated[float, "Mean length."]
    rms: Annotated[float, "Root of the mean of the squared length."]
    p95: Annotated[float, "The ceil(0.95 n)-th smallest length."]
    range: Annotated[list[float], "Maximum minus minimum of each component; ISO 230-1 builds V_XYZ of these."]


class SummaryBand(Record):
    """Intervals of the statistics of vectors at a level of confidence of 95 %: lower and upper end."""

    max: Annotated[list[float], "Interval of the largest length."]
    mean: Annotated[list[float], "Interval of the mean length."]
    rms: Annotated[list[float], "Interval of the root of the mean of the squared length."]
    p95: Annotated[list[float], "Interval of the 95 % value of the length."]


class Bands(Record):
    """Intervals of the statistics of deviations."""

    parts: Annotated[int, "Number of independent parts of the uncertainty."]
    poses: Annotated[int, "Number of poses at which they were followed."]
    drawn: Annotated[bool, "True if the intervals were drawn, false if they are to first order (k = 2)."]
    position_um: Annotated[SummaryBand, "Position deviations of the functional point, um."]
    rotation_urad: Annotated[SummaryBand, "Rotations of the tool, urad."]


class Percentile(Record):
    """A percentile of the population the samples come from."""

    percent: Annotated[int, "The percentile, in percent."]
    value: Annotated[float, "The ceil(percent n / 100)-th smallest sample."]
    low: Annotated[Union[float, None], "Lower end of the interval that holds it with 95 % confidence; ``None`` with too few samples."]
    high: Annotated[Union[float, None], "Upper end."]


class BeyondMeasured(Record):
    """Poses of a map beyond the ranges in which curves were measured."""

    poses: Annotated[int, "Number of the poses, of those counted."]
    of: Annotated[int, "Number of poses that were counted: those of the map, or of more than ``MAX_HELD`` some spread over them."]
    measured: Annotated[Named[list[float]], "The measured ranges that poses leave, by axis, mm and deg."]


class WorstPose(Record):
    """A pose with a large deviation."""

    axes: Annotated[Named[float], "The pose, mm and deg."]
    deviation_um: Annotated[list[float], "Deviation of the functional point, um."]


class BodyDiagonal(Record):
    """Displacement along a body diagonal."""

    name: Annotated[str, "Senses of the axes along it, such as ``ppp``."]
    to: Annotated[Named[float], "The pose at its end, mm and deg."]
    length_mm: Annotated[float, "Length, mm."]
    range_um: Annotated[float, "Maximum minus minimum of the displacement, um."]
    deviations_um: Annotated[list[float], "Displacement along the diagonal at equal intervals, um."]


class UnreachableCount(Record):
    """Number of unreachable tool poses, by reason."""

    total: Annotated[int, "Their total number."]
    direction: Annotated[int, "Number for which the rotary axes cannot point the tool in the direction."]
    place: Annotated[int, "Number whose place the linear axes do not span."]
    travel: Annotated[int, "Number for which an axis would leave its travel."]
    not_proved: Annotated[Union[int, None], "Number of them for which no pose was found, without a proof that there is none."]


class BeyondTravel(Record):
    """An axis that would have to leave its travel."""

    axis: Annotated[str, "Name of the axis."]
    by: Annotated[float, "Distance from the nearer end of its travel: negative below the lower end."]
    unit: Annotated[str, "``mm`` or ``deg``."]


class MissedToolPose(Record):
    """A tool pose that a machine does not reach."""

    line: Annotated[int, "Line of the file, from 1."]
    feature: Annotated[Union[str, None], "Name of the feature to which it belongs."]
    why: Annotated[Literal["direction", "place", "travel"], "The reason."]
    beyond: Annotated[Union[list[BeyondTravel], None], "The axes that would leave their travel."]
    off_deg: Annotated[Union[float, None], "Angle between the tool axis and the nearest direction in which the machine can hold its tool, deg."]
    off_mm: Annotated[Union[float, None], "Distance of the place from those that the axes span, mm."]
    not_proved: Annotated[Union[bool, None], "True if no pose was found, without a proof that there is none."]


class NeededTravel(Record):
    """The travel that a work needs of an axis, and the travel that it has."""

    axis: Annotated[str, "Name of the axis."]
    unit: Annotated[str, "``mm`` or ``deg``."]
    needs: Annotated[list[float], "Smallest and largest position over the tool poses that are reached, or would be with longer travels."]
    has: Annotated[Union[list[float], None], "Ends of the travel; none of a continuous axis."]
    short: Annotated[list[float], "Length by which the travel is too short at its lower and its upper end."]


class ReachedToolPoses(Record):
    """Tool poses of a file that a machine reaches."""

    file: Annotated[str, "Name of the file."]
    asked: Annotated[int, "Number of tool poses in the file."]
    reached: Annotated[int, "Number of tool poses that the machine reaches."]
    unreachable: Annotated[UnreachableCount, "Number of the others, by reason."]
    rows: Annotated[list[MissedToolPose], "The others, row by row."]
    travel: Annotated[list[NeededTravel], "The travel that the tool poses need, axis by axis."]


class DominatingError(Record):
    """An error in the deviation at a pose."""

    error: Annotated[str, "Name of the error."]
    um: Annotated[float, "Its part along the deviation, first order, um."]


class FeatureResult(Record):
    """A feature of the work: rows of a file with the same label."""

    feature: Annotated[str, "Its label; empty for rows without."]
    poses: Annotated[int, "Number of its tool poses that are reached."]
    unreached: Annotated[int, "Number of those that are not."]
    max_um: Annotated[Union[float, None], "Largest deviation of the functional point, um; none without a pose."]
    p95_um: Annotated[Union[float, None], "Deviation below which 95 % of its poses lie, um."]
    line: Annotated[Union[int, None], "Line of the file with the largest deviation."]
    axes: Annotated[Union[Named[float], None], "The pose there, mm and deg."]
    errors: Annotated[list[DominatingError], "The errors with the largest parts in that deviation."]


class Proportion(Record):
    """The fraction of a population that has a property, by samples of it."""

    value: Annotated[float, "The fraction of the samples, 0 to 1."]
    low: Annotated[float, "Lower end of its 95 % interval (Wilson)."]
    high: Annotated[float, "Upper end."]


class DrawnCharacteristic(Record):
    """A characteristic over machines drawn between the bounds of errors."""

    samples: Annotated[int, "Number of machines drawn."]
    median_um: Annotated[float, "Median, um."]
    p95_um: Annotated[Percentile, "The value that 95 % of the machines do not exceed, um, with its 95 % confidence interval."]
    holds: Annotated[Union[Proportion, None], "The fraction of the machines that hold the tolerance at the points in reach, with its 95 % interval (Wilson): while points are out of reach, an upper limit."]


class CharacteristicPart(Record):
    """The part of an error in a characteristic."""

    error: Annotated[str, "Name of the error; ``values`` for all errors with values beside bounds."]
    um: Annotated[float, "Its part, um, first order; the parts of all errors sum up to the value."]
    share: Annotated[float, "The same as a fraction of the value."]


class CharacteristicResult(Record):
    """A characteristic of a feature (ISO 1101) with its tolerance."""

    feature: Annotated[str, "Name of the feature."]
    kind: Annotated[Literal["straightness", "flatness", "roundness", "cylindricity", "profile", "position", "parallelism", "perpendicularity", "angularity"], "The characteristic."]
    datum: Annotated[Union[str, None], "Name of the datum feature."]
    fit: Annotated[Literal["minimum-zone", "least-squares"], "The fit by which it is judged."]
    tolerance_um: Annotated[Union[float, None], "Its largest value, um."]
    poses: Annotated[int, "Number of its points that are reached."]
    unreached: Annotated[int, "Number of its points, and those of its datum, that are not."]
    lacks: Annotated[Union[str, None], "The reason why the points in reach do not carry it."]
    value_um: Annotated[Union[float, None], "Its value by the errors that have values, um."]
    minimum_zone_um: Annotated[Union[float, None], "Width of the narrowest zone, um; none where nothing is fitted."]
    least_squares_um: Annotated[Union[float, None], "Width of the zone about the least-squares feature, um; none where nothing is fitted."]
    interval_um: Annotated[Union[list[float], None], "Interval of the value by the uncertainty of the errors, 95 %, um."]
    holds: Annotated[Union[bool, None], "True if the value is within the tolerance; none where it is, but points are out of reach."]
    drawn: Annotated[Union[DrawnCharacteristic, None], "The values of machines drawn between the bounds of errors."]
    errors: Annotated[list[CharacteristicPart], "The parts of errors in the value, or in the 95 % value of the machines drawn, largest first."]


class Uncompensated(Record):
    """Statistics of a machine without compensation."""

    position_um: Annotated[Summary, "Displacement of the functional point, um."]
    rotation_urad: Annotated[Summary, "Rotation of the tool, urad."]


class MapFields(Record):
    """A map of deviations, actual minus nominal; of a machine of which nothing is measured, of what its bounds lead to."""

    machine: Annotated[str, "Name of the machine."]
    order: Annotated[str, "``exact``, or a degree."]
    degree: Annotated[Union[int, None], "Degree in the errors, if the part of one degree alone is mapped."]
    frame: Annotated[Literal["workpiece", "machine", "tool"], "Frame of the vectors."]
    direction: Annotated[Literal["mean", "forward", "reverse"], "Side of approach."]
    over: Annotated[Over, "What the map is over."]
    path: Annotated[Union[PathResult, None], "Events of the path, if the tool poses are one."]
    limit: Annotated[Union[LimitVerdict, None], "The 95 % value of the position against the limit of the job, if it states one."]
    poses: Annotated[int, "Number of poses."]
    bounds: Annotated[Union[MapFromBounds, None], "What the bounds lead to, where nothing is measured."]
    bounds_add: Annotated[Union[AddedByBounds, None], "What bounds of errors without a value add to the measured ones."]
    position_um: Annotated[Summary, "Statistics of the deviation of the functional point, um."]
    rotation_urad: Annotated[Summary, "Statistics of the deviation of the orientation of the tool, urad."]
    uncertainty: Annotated[Union[Bands, None], "Intervals of the statistics, where the machine file states uncertainties of errors."]
    p95_over_volume: Annotated[Union[Percentile, None], "The value that 95 % of the whole volume keeps, um, with its interval by the number of random poses; of random poses alone."]
    beyond_measured: Annotated[Union[BeyondMeasured, None], "The poses beyond the ranges in which the curves of the axes were measured."]
    worst: Annotated[list[WorstPose], "The worst poses, largest deviation of the functional point first."]
    diagonals: Annotated[list[BodyDiagonal], "The body diagonals of the volume; none of a job."]
    p95_relative_error: Annotated[Union[float, None], "Relative error of the 95 % values, for a map of more than ``MAX_HELD`` poses."]
    tool_poses: Annotated[Union[ReachedToolPoses, None], "Tool poses of a file, with those that the machine reaches."]
    features: Annotated[Union[list[FeatureResult], None], "The features of the file, where it names some: the largest deviation on each."]
    characteristics: Annotated[Union[list[CharacteristicResult], None], "The characteristics of features for which the job states tolerances."]
    target: Annotated[Union[str, None], "The target whose compensation is in the map."]
    uncompensated: Annotated[Union[Uncompensated, None], "The same without compensation, for a map with."]


class ReachDirections(Record):
    """Directions of the tool at every tip."""

    kind: Annotated[Literal["one", "circle", "hemisphere", "listed"], "``one``, ``circle`` (equal turns of an axis), ``hemisphere`` (equal areas) or ``listed`` (those of a job, one at each tip)."]
    count: Annotated[int, "Number of directions."]
    about: Annotated[list[float], "The tool axis at rest, from the tip to the holder, workpiece frame."]


class Lack(Record):
    """Tool poses that lack the same, with the largest amount."""

    why: Annotated[Literal["direction", "place", "travel"], "The reason."]
    axis: Annotated[Union[str, None], "Name of the axis that would leave its travel; none for the other reasons."]
    end: Annotated[Union[float, None], "The end of its travel, mm or deg."]
    above: Annotated[Union[bool, None], "True if it would have to go above that end, false below it."]
    tool_poses: Annotated[int, "Number of tool poses; one that several axes stop counts for each of them."]
    up_to: Annotated[Union[float, None], "Largest amount, in ``unit``; none where it is not known."]
    unit: Annotated[Union[str, None], "``mm`` or ``deg``."]


class ReachFields(Record):
    """The reach of a machine."""

    machine: Annotated[str, "Name of the machine."]
    tool: Annotated[str, "Name of the tool; empty for a tool without a name."]
    over: Annotated[Over, "Poses and reference of the reach."]
    path: Annotated[Union[PathResult, None], "Events of the path, if the tool poses are one."]
    box_mm: Annotated[list[list[float]], "Ends of the box along x, y, z of the workpiece frame, mm."]
    counts: Annotated[list[int], "Number of tips along x, y, z; of a job all tips stand in one row."]
    tips: Annotated[int, "Number of tips."]
    directions: Annotated[ReachDirections, "The directions at every tip."]
    tool_poses: Annotated[int, "Number of tool poses: tips times directions."]
    reached: Annotated[int, "Number of them that are reached."]
    share: Annotated[float, "Their fraction."]
    tips_in_all_directions: Annotated[int, "Number of tips that are reached in all directions."]
    tips_in_any_direction: Annotated[int, "Number of tips that are reached in at least one."]
    unreachable: Annotated[UnreachableCount, "Number of the tool poses out of reach, by reason."]
    lacks: Annotated[list[Lack], "What they lack, the most frequent first."]
    job: Annotated[Union[ReachedToolPoses, None], "Tool poses of a job, row by row where they are out of reach."]


class DrawSettings(Record):
    """Settings of the machines drawn for a budget."""

    class_source: Annotated[Union[str, None], "Source of the class."]
    samples: Annotated[int, "Number of machines drawn."]
    seed: Annotated[int, "Seed of poses and errors."]
    distribution: Annotated[Literal["uniform", "triangular"], "Distribution of an error between its bounds."]
    statistic: Annotated[Literal["max", "p95"], "Statistic of a machine over the poses."]


class PlaceRange(Record):
    """Values of one number of a place."""

    of: Annotated[str, "``X``, ``Y``, ``Z`` of ``origin``, or ``A``, ``B``, ``C`` of ``rotation``, which turn about X, Y, Z."]
    unit: Annotated[str, "``mm`` or ``deg``."]
    ends: Annotated[list[float], "The first and the last value."]
    count: Annotated[int, "Number of values at equal distances."]


class Placement(Record):
    """The place of a part on the workpiece frame: a point p of the part lies at origin + Rz(c) Ry(b) Rx(a) p."""

    origin: Annotated[list[float], "Origin of the part, mm."]
    rotation: Annotated[list[float], "Rotations about X, then Y, then Z of the workpiece frame, deg."]


class PairedDifference(Record):
    """The difference of two 95 % values with its interval; ``None`` where there are too few samples for an end."""

    value: Annotated[float, "Of the samples."]
    low: Annotated[Union[float, None], "Lower end."]
    high: Annotated[Union[float, None], "Upper end."]


class VersusFirst(Record):
    """A machine or arrangement against the first, on the machines drawn of both."""

    verdict: Annotated[Literal["first", "equal", "not_told_apart", "worse", "better"], "What is known of the two."]
    minus_first: Annotated[PairedDifference, "Its 95 % value minus that of the first, um. The intervals of all pairs and all rounds hold together with 95 % confidence."]


class TriedPlace(Record):
    """A part tried at a place."""

    place: Annotated[Placement, "The place."]
    own: Annotated[bool, "True for the place that the job states."]
    reached: Annotated[int, "Number of tool poses that are reached."]
    share: Annotated[float, "Their fraction."]
    rewinds: Annotated[Union[int, None], "Number of rewinds of a path."]
    margin_mm: Annotated[Union[float, None], "Least distance of a linear axis from an end of its travel, mm; none without such an axis or a tool pose."]
    reaches_reference: Annotated[bool, "True if the machine reaches the points at which the part is probed."]
    p95_um: Annotated[Union[float, None], "The 95 % value of the position deviation over the tool poses that are reached, um; from bounds of what 95 % of the machines do not exceed at each. None for reach alone."]
    max_um: Annotated[Union[float, None], "The largest of these, um."]
    um: Annotated[Union[float, None], "The figure by which places are ranked and the limit of the job is judged, um: the statistic of the position deviation over the tool poses that are reached; of machines drawn the value that 95 % of them do not exceed."]
    interval_um: Annotated[Union[list[float], None], "The interval that holds it with 95 % confidence, um: of machines drawn, or of values with a stated uncertainty."]
    versus_first: Annotated[Union[VersusFirst, None], "A ranked place against the first, on the same machines; none where no machines are drawn, and where the path has more rewinds."]
    limit: Annotated[Union[LimitVerdict, None], "The figure against the limit of the job, if it states one."]
    rank: Annotated[Union[int, None], "Rank from 1; none of a place that cannot be compared with the best."]


class CommonFigures(Record):
    """Figures of two places on the tool poses that both reach."""

    poses: Annotated[int, "Number of these tool poses."]
    own_p95_um: Annotated[float, "95 % value at the place of the job, um."]
    best_p95_um: Annotated[float, "The same at the best place."]
    p95_um: Annotated[float, "The first less the second."]
    own_max_um: Annotated[float, "Largest deviation at the place of the job, um."]
    best_max_um: Annotated[float, "The same at the best place."]
    own_um: Annotated[float, "Figure of the ranking at the place of the job, um."]
    best_um: Annotated[float, "The same at the best place."]
    versus_own: Annotated[Union[VersusFirst, None], "The best place against that of the job, on the same machines; none where no machines are drawn, and where the path has other rewinds."]


class PlacementGain(Record):
    """Gain of the best place over that of the job."""

    poses: Annotated[int, "Number of tool poses that it reaches more."]
    rewinds: Annotated[Union[int, None], "Number of rewinds that it has less."]
    margin_mm: Annotated[Union[float, None], "Margin that it has more, mm."]
    common: Annotated[Union[CommonFigures, None], "The figures of both on the tool poses that both reach."]


class PlacementFields(Record):
    """Places of a part on a machine."""

    machine: Annotated[str, "Name of the machine."]
    over: Annotated[Over, "Poses and reference of the result; ``reached`` counts at the place of the job."]
    statistic: Annotated[Union[Literal["max", "p95"], None], "The statistic of a machine over the tool poses, by which places are ranked; none for reach alone."]
    drawing: Annotated[Union[DrawSettings, None], "Settings of the machines drawn, where errors are bounded."]
    ranges: Annotated[list[PlaceRange], "The ranges, in the order named."]
    places: Annotated[int, "Number of places that were tried; that of the job is one of them."]
    reach_all: Annotated[int, "Number of places that reach all tool poses."]
    ranked: Annotated[int, "Number of places that are ranked: those that reach the same tool poses, the most of all, and the reference."]
    not_told_apart: Annotated[Union[int, None], "Number of ranked places that the machines drawn do not tell apart from the best, or that are equal to it; none where no machines are drawn."]
    own: Annotated[TriedPlace, "The place of the job."]
    best: Annotated[Union[TriedPlace, None], "The best place; none if no tool pose is reached anywhere."]
    at_end_of: Annotated[Union[list[str], None], "Ranges at whose end the best place lies."]
    gain: Annotated[Union[PlacementGain, None], "Gain of the best place over that of the job."]
    tried: Annotated[list[TriedPlace], "All places: those of the ranges, the first range running fastest, then that of the job if it is none of them."]


class ErrorContribution(Record):
    """Effect of an error alone in each machine."""

    error: Annotated[str, "Name of the error."]
    um: Annotated[list[Union[float, None]], "95 % position deviation with only this error, first order, um, by machine; none without a value."]
    minus_first: Annotated[list[float], "The same minus that of the first machine."]


class RssDifference(Record):
    """Statistics of the RSS minus those of another machine."""

    position_um: Annotated[LengthStatistics, "Of the position, um."]
    rotation_urad: Annotated[LengthStatistics, "Of the orientation, urad."]


class ComparedBounds(Record):
    """What the bounds of a machine lead to on the tool poses, where nothing is measured."""

    errors: Annotated[int, "Number of bounded errors."]
    class_source: Annotated[Union[str, None], "Source of the class."]
    samples: Annotated[int, "Number of machines drawn."]
    seed: Annotated[int, "Seed of poses and errors."]
    distribution: Annotated[Literal["uniform", "triangular"], "Distribution of an error between its bounds."]
    statistic: Annotated[Literal["max", "p95"], "Statistic of a machine over the poses."]
    position_um: Annotated[BoundedLengths, "The position deviation, um."]
    rotation_urad: Annotated[BoundedLengths, "The rotation of the tool, urad."]
    rss_minus_first: Annotated[Union[RssDifference, None], "The statistics of the RSS minus those of the first machine."]


class Difference(Record):
    """Statistics minus statistics."""

    position_um: Annotated[Summary, "Position deviations of the functional point, um."]
    rotation_urad: Annotated[Summary, "Rotations of the tool, urad."]


class ComparedBands(Record):
    """Intervals of the statistics of a machine beside another. Machines share the uncertainty that both files state."""

    parts: Annotated[int, "Number of independent parts of the uncertainty."]
    poses: Annotated[int, "Number of poses at which they were followed."]
    drawn: Annotated[bool, "True if the intervals were drawn, false if they are to first order (k = 2)."]
    position_um: Annotated[SummaryBand, "Position deviations of the functional point, um."]
    rotation_urad: Annotated[SummaryBand, "Rotations of the tool, urad."]
    minus_first: Annotated[Bands, "Those of its statistics minus the first machine's."]
    told_apart: Annotated[bool, "True if the 95 % position deviation differs from the first machine's by more than the uncertainty."]


class ComparedMachine(Record):
    """One machine of a comparison."""

    machine: Annotated[str, "Name of the machine."]
    file: Annotated[str, "Name of its file."]
    order: Annotated[str, "Order of its errors."]
    unreachable: Annotated[UnreachableCount, "Number of tool poses that it does not reach, by reason."]
    bounds: Annotated[Union[ComparedBounds, None], "What its bounds lead to, where nothing is measured."]
    bounds_add: Annotated[Union[AddedByBounds, None], "What bounds of errors without a value add to the measured ones."]
    position_um: Annotated[Summary, "Statistics of the deviation of the functional point, um."]
    rotation_urad: Annotated[Summary, "Statistics of the deviation of the orientation of the tool, urad."]
    minus_first: Annotated[Union[Difference, None], "The statistics minus those of the first machine: negative is better than the first. None where of only one of the two nothing is measured."]
    uncertainty: Annotated[Union[ComparedBands, None], "Intervals of its statistics, and of these minus those of the first machine, where any of the files states uncertainties of errors."]
    missed: Annotated[Union[list[MissedToolPose], None], "Rows of a file of tool poses that it does not reach."]
    travel: Annotated[Union[list[NeededTravel], None], "The travel that the tool poses of a file need, axis by axis."]
    limit: Annotated[Union[LimitVerdict, None], "Its 95 % value against the limit of the job, if it states one: of its budget, or else of its measured errors."]
    path: Annotated[Union[PathResult, None], "Events of the path, if the tool poses are one."]


class DeviationBudget(Record):
    """A deviation, as bounds lead to it."""

    worst_case: Annotated[float, "Sum of the effects of all bounds, at the pose where it is largest."]
    rss: Annotated[float, "Root of the sum of their squares, at the pose where it is largest."]
    mean_of_both: Annotated[float, "Mean of both."]
    worst_case_at: Annotated[Named[float], "Pose of the worst case, mm and deg."]
    rss_at: Annotated[Named[float], "Pose of the largest RSS, mm and deg."]
    monte_carlo: Annotated[DrawnMachineFigures, "Machines drawn between the bounds."]


class DrawnDifference(Record):
    """Figures of machines drawn minus those of others."""

    mean: Annotated[float, "Difference of the means."]
    p95: Annotated[float, "Difference of the 95 % values."]


class DeviationBudgetDifference(Record):
    """Figures of a deviation minus those of another."""

    worst_case: Annotated[float, "Difference of the worst cases."]
    rss: Annotated[float, "Difference of the RSS values."]
    mean_of_both: Annotated[float, "Difference of the means of both."]
    monte_carlo: Annotated[DrawnDifference, "Differences of the figures of machines drawn."]


class BudgetDifference(Record):
    """Figures of a budget minus those of another."""

    position_um: Annotated[DeviationBudgetDifference, "Differences of the position deviation, um."]
    rotation_urad: Annotated[DeviationBudgetDifference, "Differences of the orientation deviation, urad."]


class ActingValues(Record):
    """Errors with values in a budget."""

    errors: Annotated[int, "Number of these errors."]
    um_of_p95: Annotated[float, "Their part of the 95 % value of the position, um."]


class ComparedBudget(Record):
    """The budget of a machine beside others."""

    errors: Annotated[int, "Number of bounded errors."]
    errors_by_class: Annotated[int, "Number of these that the class bounds; the machine file bounds the others."]
    unbounded: Annotated[int, "Number of errors that act and have neither a value nor a bound."]
    position_um: Annotated[DeviationBudget, "The position deviation, um."]
    rotation_urad: Annotated[DeviationBudget, "The rotation of the tool, urad."]
    minus_first: Annotated[BudgetDifference, "Minus the figures of the first machine."]
    class_source: Annotated[Union[str, None], "Source of the class."]
    left_out: Annotated[int, "Number of errors that have values and are left out, for bounds of a class stand for them."]
    with_values: Annotated[Union[ActingValues, None], "The errors with values that act in every machine drawn, if there are any."]


class ComparedContribution(Record):
    """An error in several budgets; a list has a value for each machine, none where a machine does not bound it."""

    error: Annotated[str, "Name of the error."]
    unit: Annotated[str, "``um`` or ``urad``."]
    tolerance: Annotated[list[Union[float, None]], "Its tolerance, in ``unit``."]
    um_of_p95: Annotated[list[Union[float, None]], "Its part of the 95 % value, um."]
    um_of_p95_sigma: Annotated[list[Union[float, None]], "Standard error of that part, um."]
    minus_first: Annotated[list[float], "That part minus that of the first machine, um."]
    average_um: Annotated[list[Union[float, None]], "Its effect averaged over the poses, um."]


class WithheldVerdict(Record):
    """The reason why there is no verdict on two machines: errors without a value or a bound could turn it."""

    reason: Annotated[str, "The reason in words."]
    as_bounded: Annotated[Literal["first", "equal", "not_told_apart", "worse", "better"], "The verdict on the errors that are bounded."]
    missing_first: Annotated[list[str], "Errors that the first machine states nothing of."]
    missing: Annotated[list[str], "Errors that this machine states nothing of."]
    minus_first_if_filled: Annotated[list[PairedDifference], "Its 95 % value minus that of the first, um, with the bounds of the other machine for what is missing, and with those of the class for what neither bounds."]


class ComparedVerdict(Record):
    """A machine against the first, on the machines drawn of both."""

    verdict: Annotated[Union[Literal["first", "equal", "not_told_apart", "worse", "better"], None], "The verdict on the two; none if errors that only one of the files bounds could turn it."]
    minus_first: Annotated[PairedDifference, "Its 95 % value minus that of the first, um. The intervals of all pairs and all rounds hold together with 95 % confidence."]
    minus_first_alike: Annotated[Union[PairedDifference, None], "The same with the other machine's bounds for what only one of them bounds: like with like. None where both bound the same errors, and without a verdict."]
    withheld: Annotated[Union[WithheldVerdict, None], "The reason why there is no verdict."]


class ComparedBudgets(Record):
    """Budgets on the same work."""

    machines: Annotated[list[ComparedBudget], "The budget of each machine."]
    largest_um: Annotated[float, "Effect of the error that is first in ``contributions``, um."]
    contributions: Annotated[list[ComparedContribution], "Error by error, largest first."]
    class_source: Annotated[Union[str, None], "Source of the class."]
    samples: Annotated[int, "Number of machines drawn."]
    seed: Annotated[int, "Seed of poses and errors."]
    distribution: Annotated[Literal["uniform", "triangular"], "Distribution of an error between its bounds."]
    statistic: Annotated[Literal["max", "p95"], "Statistic of a machine over the poses."]
    max_samples: Annotated[int, "Number of machines that are drawn at most, if the first ones do not tell the machines apart."]
    versus_first_p95_um: Annotated[list[ComparedVerdict], "The 95 % value of the position of each machine but the first, minus that of the first."]


class FittedMachine(Record):
    """One machine of a comparison without the best fit."""

    position_um: Annotated[Summary, "Statistics of the deviation of the functional point, um."]
    rotation_urad: Annotated[Summary, "Statistics of the deviation of the orientation of the tool, urad."]
    minus_first: Annotated[Union[Difference, None], "The statistics minus those of the first machine; none where of only one of the two nothing is measured."]
    budget_p95_um: Annotated[Union[float, None], "The 95 % value of its budget, um."]


class FittedComparison(Record):
    """Machines side by side without the rigid motion of the part that fits the deviations of each best."""

    over: Annotated[Over, "Poses and reference that it is over."]
    machines: Annotated[list[FittedMachine], "The machines in their order."]
    versus_first_p95_um: Annotated[Union[list[ComparedVerdict], None], "The 95 % value of the position of each machine but the first, minus that of the first, where budgets are compared."]


class JudgedDifference(Record):
    """The figure of the position deviation by which a machine is judged, minus that of the first machine."""

    drawn: Annotated[bool, "True if it is the value that 95 % of machines drawn do not exceed."]
    alike: Annotated[bool, "True if what only one of the machines bounds has the bounds of the other one in both."]
    statistic: Annotated[Literal["max", "p95"], "The figure of a machine over the poses."]
    um: Annotated[float, "The difference, um: negative is better than the first."]
    low: Annotated[Union[float, None], "Lower end of its interval, um, if it has one."]
    high: Annotated[Union[float, None], "Upper end of its interval, um, if it has one."]


class MachineVerdict(Record):
    """The verdict on a machine."""

    machine: Annotated[int, "Number of the machine, from 1."]
    verdict: Annotated[Union[Literal["first", "equal", "not_told_apart", "worse", "better"], None], "Its 95 % value against that of the first; none where that depends on the reference, or is not known."]
    by: Annotated[Union[JudgedDifference, None], "The difference by which it is judged; none without a verdict."]
    reason: Annotated[Union[str, None], "The reason why there is none."]


class CompareFields(Record):
    """Machines side by side, over the tool poses that all of them reach."""

    over: Annotated[Over, "What the comparison is over."]
    contributions: Annotated[list[ErrorContribution], "Effect of each error alone, largest first."]
    asked: Annotated[int, "Number of tool poses asked for."]
    poses: Annotated[int, "Number of tool poses that all machines reach."]
    seed: Annotated[int, "Seed of the tool poses, and of the errors that are drawn."]
    frame: Annotated[Literal["workpiece", "machine", "tool"], "Frame of the vectors: the workpiece frame."]
    direction: Annotated[Literal["mean", "forward", "reverse"], "Side of approach."]
    machines: Annotated[list[ComparedMachine], "The machines in their order."]
    budgets: Annotated[Union[ComparedBudgets, None], "Budgets on the same work, where every machine bounds errors."]
    best_fit: Annotated[Union[FittedComparison, None], "The same without the best fit of each machine, where neither tool poses nor a reference are given."]
    verdicts: Annotated[list[MachineVerdict], "The verdict on each machine but the first."]
