"""Fields of results by type. python/generate.py writes this file from the results of the façade."""

from __future__ import annotations

from typing import Any, Literal, Union

from ._record import Named, Names, Record

class EvalUnits(Record):
    """Units of an ``EvalResult``.

    * ``position``: Unit of positions and deviations of points.
    * ``rotation``: Unit of rotations.
    * ``linear_axis``: Unit of positions of linear axes.
    * ``rotary_axis``: Unit of positions of rotary axes.
    """

    __slots__ = ()

    position: str
    rotation: str
    linear_axis: str
    rotary_axis: str


class PoseUncertainty(Record):
    """Expanded uncertainty (k = 2) of the deviation at a pose, component by component, to first order.

    * ``deviation``: Uncertainty of the position of the functional point, mm.
    * ``rotation``: Uncertainty of the orientation of the tool, rad.
    """

    __slots__ = ()

    deviation: list[float]
    rotation: list[float]


class ErrorEffect(Record):
    """Effect of an error, or of a pair of errors, at a pose; workpiece frame.

    * ``error``: Name of the error; of a pair ``A*B``.
    * ``deviation``: Displacement of the functional point when each error is 1 mm or 1 rad, mm.
    * ``rotation``: Rotation of the tool, rad.
    * ``value``: Product of the values of the errors at the pose, mm and rad.
    """

    __slots__ = ()

    error: str
    deviation: list[float]
    rotation: list[float]
    value: float


class Neglected(Record):
    """Bound of the terms that order 1 neglects: all interactions of second degree with one sign.

    * ``position_mm``: Displacement of the functional point, mm.
    * ``rotation_rad``: Rotation of the tool, rad.
    """

    __slots__ = ()

    position_mm: float
    rotation_rad: float


class PoseResult(Record):
    """Deviation at one pose.

    * ``axes``: The pose, mm and deg.
    * ``nominal``: Nominal position of the functional point from the workpiece origin, mm.
    * ``deviation``: Actual minus nominal position of the functional point, mm.
    * ``rotation``: Actual minus nominal orientation of the tool, rad.
    * ``e_ve``: ``T_tool^-1 T_work``, actual minus nominal, row by row.
    * ``uncertainty``: Expanded uncertainty of the deviation, where the machine states that of its errors.
    * ``sensitivity``: Effect of each error, with ``EvalOptions::sensitivity``.
    * ``interactions``: Effect of pairs of errors, with ``EvalOptions::interactions``.
    * ``order_1_neglects``: Bound of the terms that order 1 neglects at this pose, with ``EvalOptions::interactions``.
    * ``inverse``: Motions of the axes that undo the errors, mm and deg, with ``EvalOptions::inverse``.
    """

    __slots__ = ()

    axes: Named[float]
    nominal: list[float]
    deviation: list[float]
    rotation: list[float]
    e_ve: list[list[float]]
    uncertainty: Union[PoseUncertainty, None]
    sensitivity: Union[list[ErrorEffect], None]
    interactions: Union[list[ErrorEffect], None]
    order_1_neglects: Union[Neglected, None]
    inverse: Union[Named[float], None]

    _kinds = {
        "axes": Names(None),
        "uncertainty": PoseUncertainty,
        "sensitivity": ErrorEffect,
        "interactions": ErrorEffect,
        "order_1_neglects": Neglected,
        "inverse": Names(None),
    }

    _optional = frozenset({
        "uncertainty",
        "sensitivity",
        "interactions",
        "order_1_neglects",
        "inverse",
    })


class EvalFields(Record):
    """Deviations at poses.

    * ``machine``: Name of the machine.
    * ``order``: ``exact``, a degree, or the algebra in words.
    * ``frame``: Frame of the vectors.
    * ``direction``: Side of approach.
    * ``tool``: Name of the tool; empty for a tool without a name.
    * ``units``: Units of the numbers.
    * ``poses``: The poses in their order.
    """

    __slots__ = ()

    machine: str
    order: str
    frame: Literal["workpiece", "machine", "tool"]
    direction: Literal["mean", "forward", "reverse"]
    tool: str
    units: EvalUnits
    poses: list[PoseResult]

    _kinds = {
        "units": EvalUnits,
        "poses": PoseResult,
    }


class EquationUnits(Record):
    """Units of closed forms.

    * ``length``: ``mm``.
    * ``angle``: ``rad``.
    """

    __slots__ = ()

    length: str
    angle: str


class EquationSymbol(Record):
    """A symbol of closed forms.

    * ``symbol``: As it stands in the text.
    * ``kind``: ``error``, ``position``, ``sine``, ``cosine`` or ``tool_length``.
    * ``of``: Name of the error or axis.
    * ``sign``: 1 or -1.
    * ``latex``: As LaTeX.
    """

    __slots__ = ()

    symbol: str
    kind: str
    of: str
    sign: float
    latex: str


class TermShape(Record):
    """A term of a polynomial.

    * ``coefficient``: Its number.
    * ``powers``: Powers by symbol.
    * ``order``: Its order in the errors.
    """

    __slots__ = ()

    coefficient: float
    powers: Named[int]
    order: int

    _kinds = {
        "powers": Names(None),
    }


class PolynomialShape(Record):
    """A polynomial in the symbols.

    * ``text``: As text.
    * ``terms``: Its terms.
    """

    __slots__ = ()

    text: str
    terms: list[TermShape]

    _kinds = {
        "terms": TermShape,
    }


class EquationsFields(Record):
    """Closed forms; mm and rad, workpiece frame.

    * ``machine``: Name of the machine.
    * ``degree``: Degree of the algebra.
    * ``frame``: Frame of the vectors: the workpiece frame.
    * ``units``: Units of lengths and angles.
    * ``symbols``: The symbols.
    * ``joints``: The matrix of each joint.
    * ``t_tool``: From the bed to the tool.
    * ``t_work``: From the bed to the workpiece.
    * ``e_ve``: The volumetric error E_VE.
    * ``deviation``: Displacement of the functional point.
    * ``rotation``: Rotation of the tool.
    """

    __slots__ = ()

    machine: str
    degree: int
    frame: Literal["workpiece", "machine", "tool"]
    units: EquationUnits
    symbols: list[EquationSymbol]
    joints: Named[list[list[PolynomialShape]]]
    t_tool: list[list[PolynomialShape]]
    t_work: list[list[PolynomialShape]]
    e_ve: list[list[PolynomialShape]]
    deviation: list[PolynomialShape]
    rotation: list[PolynomialShape]

    _kinds = {
        "units": EquationUnits,
        "symbols": EquationSymbol,
        "joints": Names(PolynomialShape),
        "t_tool": PolynomialShape,
        "t_work": PolynomialShape,
        "e_ve": PolynomialShape,
        "deviation": PolynomialShape,
        "rotation": PolynomialShape,
    }


class Conventions(Record):
    """The conventions in force for a machine.

    * ``location``: The action of location errors.
    * ``linear``: Component errors of linear axes.
    * ``rotary``: Component errors of rotary axes.
    * ``workpiece_axes``: Sense of workpiece-side axes.
    * ``errors_are``: Owner of the errors of workpiece-side axes.
    * ``location_order``: Order of location errors.
    * ``joints``: Shape of error matrices.
    * ``default_order``: Order used when the command line names none (``hrdina-vasik-2014`` is of order 1); ``None`` is
      exact.
    """

    __slots__ = ()

    location: Literal["axis_only", "carried_body"]
    linear: Literal["after", "before"]
    rotary: Literal["stationary", "rotating"]
    workpiece_axes: Literal["iso841", "direct"]
    errors_are: Literal["tool_relative", "body"]
    location_order: Literal["nilpotent", "real"]
    joints: Literal["orthogonal", "linearised"]
    default_order: Union[int, None]


class ConvertedError(Record):
    """An error with another value, or another curve.

    * ``name``: Name such as ``EC0Y``, ``EXX``, ``workpiece.A``.
    * ``before``: Constant before, in ``unit``; none for a curve.
    * ``after``: Constant after, in ``unit``; none for a curve.
    * ``unit``: ``um`` or ``urad``; none for a curve.
    * ``curve``: True for a curve.
    """

    __slots__ = ()

    name: str
    before: Union[float, None]
    after: Union[float, None]
    unit: Union[str, None]
    curve: Union[bool, None]

    _optional = frozenset({
        "before",
        "after",
        "unit",
        "curve",
    })


class MisfitSize(Record):
    """An error that no curve of the language holds exactly.

    * ``name``: Name of the error.
    * ``off``: Largest difference of the curve written, mm or rad.
    """

    __slots__ = ()

    name: str
    off: float


class ConversionProof(Record):
    """The comparison of both machines by the exact model, from every direction of approach.

    * ``grid_poses``: Poses on a grid over the volume.
    * ``random_poses``: Random poses over the travels.
    * ``position_mm``: Largest difference of the functional point, mm.
    * ``rotation_rad``: Largest difference of the orientation, rad.
    * ``bound_mm``: Difference of the functional point that was accepted, mm.
    * ``bound_rad``: Difference of the orientation that was accepted, rad.
    """

    __slots__ = ()

    grid_poses: int
    random_poses: int
    position_mm: float
    rotation_rad: float
    bound_mm: float
    bound_rad: float


class ConvertFields(Record):
    """A converted machine with its proof.

    * ``conventions``: The new conventions.
    * ``changed``: The conventions that changed, in words.
    * ``errors``: The errors that changed.
    * ``misfits``: Errors that no curve of the language holds exactly.
    * ``proof``: The comparison of both machines.
    """

    __slots__ = ()

    conventions: Conventions
    changed: list[str]
    errors: list[ConvertedError]
    misfits: list[MisfitSize]
    proof: ConversionProof

    _kinds = {
        "conventions": Conventions,
        "errors": ConvertedError,
        "misfits": MisfitSize,
        "proof": ConversionProof,
    }


class LengthFigures(Record):
    """Statistics of lengths.

    * ``max``: Largest.
    * ``mean``: Mean.
    * ``rms``: Root of the mean square.
    * ``p95``: The ceil(0.95 n)-th smallest.
    """

    __slots__ = ()

    max: float
    mean: float
    rms: float
    p95: float


class PercentileInterval(Record):
    """A percentile of machines drawn with its confidence interval; none where there are too few machines for one.

    * ``value``: The percentile.
    * ``low``: Lower end of its 95 % confidence interval.
    * ``high``: Upper end of its 95 % confidence interval.
    """

    __slots__ = ()

    value: float
    low: Union[float, None]
    high: Union[float, None]


class DrawnMachineFigures(Record):
    """Figures of machines drawn.

    * ``mean``: Mean.
    * ``mean_sigma``: Standard error of the mean.
    * ``p95``: Value that 95 % of the machines do not exceed.
    * ``percentiles``: Percentiles by name, such as ``p95``.
    """

    __slots__ = ()

    mean: float
    mean_sigma: float
    p95: float
    percentiles: Named[PercentileInterval]

    _kinds = {
        "percentiles": Names(PercentileInterval),
    }


class BoundedDeviationShape(Record):
    """A deviation that bounds lead to over poses.

    * ``rss``: Statistics over the poses of the root of the sum of squares.
    * ``monte_carlo``: Largest deviation over the poses, of machines drawn.
    """

    __slots__ = ()

    rss: LengthFigures
    monte_carlo: DrawnMachineFigures

    _kinds = {
        "rss": LengthFigures,
        "monte_carlo": DrawnMachineFigures,
    }


class WorstBoundedPose(Record):
    """A pose with a large 95 % value.

    * ``axes``: The pose, mm and deg.
    * ``rss_um``: Root of the sum of squares of the bounds' effects on the functional point, um.
    * ``p95_um``: The position deviation that 95 % of the machines drawn do not exceed, um.
    """

    __slots__ = ()

    axes: Named[float]
    rss_um: float
    p95_um: float

    _kinds = {
        "axes": Names(None),
    }


class MapFromBounds(Record):
    """What the bounds of a machine lead to over a map.

    * ``errors``: Number of bounded errors.
    * ``class``: The class that bounds what the machine file does not.
    * ``class_source``: Source of the class.
    * ``samples``: Number of machines drawn.
    * ``seed``: Seed of poses and errors.
    * ``distribution``: Distribution of an error between its bounds.
    * ``statistic``: Statistic of a machine over the poses.
    * ``position_um``: The position deviation, um.
    * ``rotation_urad``: The rotation of the tool, urad.
    * ``worst``: The worst poses, largest 95 % value of the position deviation first.
    """

    __slots__ = ()

    errors: int
    class_source: Union[str, None]
    samples: int
    seed: int
    distribution: Literal["uniform", "triangular"]
    statistic: Literal["max", "p95"]
    position_um: BoundedDeviationShape
    rotation_urad: BoundedDeviationShape
    worst: list[WorstBoundedPose]

    _kinds = {
        "position_um": BoundedDeviationShape,
        "rotation_urad": BoundedDeviationShape,
        "worst": WorstBoundedPose,
    }


class AddedDeviation(Record):
    """A deviation that bounds add.

    * ``rss``: Root of the sum of squares of the bounds' effects, at the pose where that is largest.
    * ``p95``: The largest deviation over the poses that 95 % of the machines drawn do not exceed.
    """

    __slots__ = ()

    rss: float
    p95: float


class AddedByBounds(Record):
    """What the bounds of a machine add to its measured errors: a budget of those errors that have no value.

    * ``errors``: Number of these errors.
    * ``poses``: Number of poses: those of the budget, or of the work.
    * ``samples``: Number of machines drawn.
    * ``seed``: Seed of poses and errors.
    * ``position_um``: Of the position deviation, um.
    * ``rotation_urad``: Of the orientation, urad.
    """

    __slots__ = ()

    errors: int
    poses: int
    samples: int
    seed: int
    position_um: AddedDeviation
    rotation_urad: AddedDeviation

    _kinds = {
        "position_um": AddedDeviation,
        "rotation_urad": AddedDeviation,
    }


class Summary(Record):
    """Statistics of vectors: of their length, except for the range.

    * ``max``: Largest length.
    * ``mean``: Mean length.
    * ``rms``: Root of the mean of the squared length.
    * ``p95``: The ceil(0.95 n)-th smallest length.
    * ``range``: Maximum minus minimum of each component; ISO 230-1 builds V_XYZ of these.
    """

    __slots__ = ()

    max: float
    mean: float
    rms: float
    p95: float
    range: list[float]


class SummaryBand(Record):
    """Intervals of the statistics of vectors at a level of confidence of 95 %: lower and upper end.

    * ``max``: Interval of the largest length.
    * ``mean``: Interval of the mean length.
    * ``rms``: Interval of the root of the mean of the squared length.
    * ``p95``: Interval of the 95 % value of the length.
    """

    __slots__ = ()

    max: list[float]
    mean: list[float]
    rms: list[float]
    p95: list[float]


class Bands(Record):
    """Intervals of the statistics of deviations.

    * ``parts``: Number of independent parts of the uncertainty.
    * ``poses``: Number of poses at which they were followed.
    * ``drawn``: True if the intervals were drawn, false if they are to first order (k = 2).
    * ``position_um``: Position deviations of the functional point, um.
    * ``rotation_urad``: Rotations of the tool, urad.
    """

    __slots__ = ()

    parts: int
    poses: int
    drawn: bool
    position_um: SummaryBand
    rotation_urad: SummaryBand

    _kinds = {
        "position_um": SummaryBand,
        "rotation_urad": SummaryBand,
    }


class WorstPose(Record):
    """A pose with a large deviation.

    * ``axes``: The pose, mm and deg.
    * ``deviation_um``: Deviation of the functional point, um.
    """

    __slots__ = ()

    axes: Named[float]
    deviation_um: list[float]

    _kinds = {
        "axes": Names(None),
    }


class BodyDiagonal(Record):
    """Displacement along a body diagonal.

    * ``name``: Senses of the axes along it, such as ``ppp``.
    * ``from``: The pose at its beginning, mm and deg.
    * ``to``: The pose at its end, mm and deg.
    * ``length_mm``: Length, mm.
    * ``range_um``: Maximum minus minimum of the displacement, um.
    * ``deviations_um``: Displacement along the diagonal at equal intervals, um.
    """

    __slots__ = ()

    name: str
    to: Named[float]
    length_mm: float
    range_um: float
    deviations_um: list[float]

    _kinds = {
        "from": Names(None),
        "to": Names(None),
    }


class UnreachableCount(Record):
    """Number of unreachable tool poses, by reason.

    * ``total``: Their total number.
    * ``direction``: Number for which the rotary axes cannot point the tool in the direction.
    * ``place``: Number whose place the linear axes do not span.
    * ``travel``: Number for which an axis would leave its travel.
    """

    __slots__ = ()

    total: int
    direction: int
    place: int
    travel: int


class BeyondTravel(Record):
    """An axis that would have to leave its travel.

    * ``axis``: Name of the axis.
    * ``by``: Distance from the nearer end of its travel: negative below the lower end.
    * ``unit``: ``mm`` or ``deg``.
    """

    __slots__ = ()

    axis: str
    by: float
    unit: str


class MissedToolPose(Record):
    """A tool pose that a machine does not reach.

    * ``line``: Line of the file, from 1.
    * ``feature``: Name of the feature to which it belongs.
    * ``why``: The reason.
    * ``beyond``: The axes that would leave their travel.
    * ``off_deg``: Angle between the tool axis and the nearest direction in which the machine can hold its tool, deg.
    * ``off_mm``: Distance of the place from those that the axes span, mm.
    """

    __slots__ = ()

    line: int
    feature: Union[str, None]
    why: Literal["direction", "place", "travel"]
    beyond: Union[list[BeyondTravel], None]
    off_deg: Union[float, None]
    off_mm: Union[float, None]

    _kinds = {
        "beyond": BeyondTravel,
    }

    _optional = frozenset({
        "feature",
        "beyond",
        "off_deg",
        "off_mm",
    })


class NeededTravel(Record):
    """The travel that a work needs of an axis, and the travel that it has.

    * ``axis``: Name of the axis.
    * ``unit``: ``mm`` or ``deg``.
    * ``needs``: Smallest and largest position over the tool poses that are reached, or would be with longer travels.
    * ``has``: Ends of the travel; none of a continuous axis.
    * ``short``: Length by which the travel is too short at its lower and its upper end.
    """

    __slots__ = ()

    axis: str
    unit: str
    needs: list[float]
    has: Union[list[float], None]
    short: list[float]


class ReachedToolPoses(Record):
    """Tool poses of a file that a machine reaches.

    * ``file``: Name of the file.
    * ``asked``: Number of tool poses in the file.
    * ``reached``: Number of tool poses that the machine reaches.
    * ``unreachable``: Number of the others, by reason.
    * ``rows``: The others, row by row.
    * ``travel``: The travel that the tool poses need, axis by axis.
    """

    __slots__ = ()

    file: str
    asked: int
    reached: int
    unreachable: UnreachableCount
    rows: list[MissedToolPose]
    travel: list[NeededTravel]

    _kinds = {
        "unreachable": UnreachableCount,
        "rows": MissedToolPose,
        "travel": NeededTravel,
    }


class DominatingError(Record):
    """An error in the deviation at a pose.

    * ``error``: Name of the error.
    * ``um``: Its part along the deviation, first order, um.
    """

    __slots__ = ()

    error: str
    um: float


class FeatureResult(Record):
    """A feature of the work: rows of a file with the same label.

    * ``feature``: Its label; empty for rows without.
    * ``poses``: Number of its tool poses that are reached.
    * ``unreached``: Number of those that are not.
    * ``max_um``: Largest deviation of the functional point, um; none without a pose.
    * ``p95_um``: Deviation below which 95 % of its poses lie, um.
    * ``line``: Line of the file with the largest deviation.
    * ``axes``: The pose there, mm and deg.
    * ``errors``: The errors with the largest parts in that deviation.
    """

    __slots__ = ()

    feature: str
    poses: int
    unreached: int
    max_um: Union[float, None]
    p95_um: Union[float, None]
    line: Union[int, None]
    axes: Union[Named[float], None]
    errors: list[DominatingError]

    _kinds = {
        "axes": Names(None),
        "errors": DominatingError,
    }


class Uncompensated(Record):
    """Statistics of a machine without compensation.

    * ``position_um``: Displacement of the functional point, um.
    * ``rotation_urad``: Rotation of the tool, urad.
    """

    __slots__ = ()

    position_um: Summary
    rotation_urad: Summary

    _kinds = {
        "position_um": Summary,
        "rotation_urad": Summary,
    }


class MapFields(Record):
    """A map of deviations, actual minus nominal; of a machine of which nothing is measured, of what its bounds lead to.

    * ``machine``: Name of the machine.
    * ``order``: ``exact``, or a degree.
    * ``frame``: Frame of the vectors.
    * ``direction``: Side of approach.
    * ``poses``: Number of poses.
    * ``from``: ``bounds`` where nothing is measured: then the statistics are of the 95 % value at each pose.
    * ``bounds``: What the bounds lead to, where nothing is measured.
    * ``bounds_add``: What bounds of errors without a value add to the measured ones.
    * ``position_um``: Statistics of the deviation of the functional point, um.
    * ``rotation_urad``: Statistics of the deviation of the orientation of the tool, urad.
    * ``uncertainty``: Intervals of the statistics, where the machine file states uncertainties of errors.
    * ``worst``: The worst poses, largest deviation of the functional point first.
    * ``diagonals``: The body diagonals of the volume.
    * ``p95_relative_error``: Relative error of the 95 % values, for a map of more than ``MapPoses::MAX_HELD`` poses.
    * ``tool_poses``: Tool poses of a file, with those that the machine reaches.
    * ``features``: The features of the file, where it names some: the largest deviation on each.
    * ``target``: The target whose compensation is in the map.
    * ``uncompensated``: The same without compensation, for a map with.
    """

    __slots__ = ()

    machine: str
    order: str
    frame: Literal["workpiece", "machine", "tool"]
    direction: Literal["mean", "forward", "reverse"]
    poses: int
    bounds: Union[MapFromBounds, None]
    bounds_add: Union[AddedByBounds, None]
    position_um: Summary
    rotation_urad: Summary
    uncertainty: Union[Bands, None]
    worst: list[WorstPose]
    diagonals: list[BodyDiagonal]
    p95_relative_error: Union[float, None]
    tool_poses: Union[ReachedToolPoses, None]
    features: Union[list[FeatureResult], None]
    target: Union[str, None]
    uncompensated: Union[Uncompensated, None]

    _kinds = {
        "bounds": MapFromBounds,
        "bounds_add": AddedByBounds,
        "position_um": Summary,
        "rotation_urad": Summary,
        "uncertainty": Bands,
        "worst": WorstPose,
        "diagonals": BodyDiagonal,
        "tool_poses": ReachedToolPoses,
        "features": FeatureResult,
        "uncompensated": Uncompensated,
    }

    _optional = frozenset({
        "from",
        "bounds",
        "bounds_add",
        "uncertainty",
        "p95_relative_error",
        "tool_poses",
        "features",
        "target",
        "uncompensated",
    })


class ReachDirections(Record):
    """Directions of the tool at every tip.

    * ``kind``: ``one``, ``circle`` (equal turns of an axis) or ``hemisphere`` (equal areas).
    * ``count``: Number of directions.
    * ``about``: The tool axis at rest, from the tip to the holder, workpiece frame.
    """

    __slots__ = ()

    kind: Literal["one", "circle", "hemisphere"]
    count: int
    about: list[float]


class Lack(Record):
    """Tool poses that lack the same, with the largest amount.

    * ``why``: The reason.
    * ``axis``: Name of the axis that would leave its travel; none for the other reasons.
    * ``end``: The end of its travel, mm or deg.
    * ``above``: True if it would have to go above that end, false below it.
    * ``tool_poses``: Number of tool poses; one that several axes stop counts for each of them.
    * ``up_to``: Largest amount, in ``unit``; none where it is not known.
    * ``unit``: ``mm`` or ``deg``.
    """

    __slots__ = ()

    why: Literal["direction", "place", "travel"]
    axis: Union[str, None]
    end: Union[float, None]
    above: Union[bool, None]
    tool_poses: int
    up_to: Union[float, None]
    unit: Union[str, None]

    _optional = frozenset({
        "axis",
        "end",
        "above",
        "up_to",
        "unit",
    })


class ReachFields(Record):
    """The reach of a machine.

    * ``machine``: Name of the machine.
    * ``tool``: Name of the tool; empty for a tool without a name.
    * ``box_mm``: Ends of the box along x, y, z of the workpiece frame, mm.
    * ``counts``: Number of tips along x, y, z.
    * ``tips``: Number of tips.
    * ``directions``: The directions at every tip.
    * ``tool_poses``: Number of tool poses: tips times directions.
    * ``reached``: Number of them that are reached.
    * ``share``: Their fraction.
    * ``tips_in_all_directions``: Number of tips that are reached in all directions.
    * ``tips_in_any_direction``: Number of tips that are reached in at least one.
    * ``unreachable``: Number of the tool poses out of reach, by reason.
    * ``lacks``: What they lack, the most frequent first.
    """

    __slots__ = ()

    machine: str
    tool: str
    box_mm: list[list[float]]
    counts: list[int]
    tips: int
    directions: ReachDirections
    tool_poses: int
    reached: int
    share: float
    tips_in_all_directions: int
    tips_in_any_direction: int
    unreachable: UnreachableCount
    lacks: list[Lack]

    _kinds = {
        "directions": ReachDirections,
        "unreachable": UnreachableCount,
        "lacks": Lack,
    }


class ErrorContribution(Record):
    """Effect of an error alone in each machine.

    * ``error``: Name of the error.
    * ``um``: 95 % position deviation with only this error, first order, um, by machine; none without a value.
    * ``minus_first``: The same minus that of the first machine.
    """

    __slots__ = ()

    error: str
    um: list[Union[float, None]]
    minus_first: list[float]


class LengthDifference(Record):
    """Statistics of lengths minus those of others.

    * ``max``: Of the largest.
    * ``mean``: Of the mean.
    * ``rms``: Of the root of the mean square.
    * ``p95``: Of the ceil(0.95 n)-th smallest.
    """

    __slots__ = ()

    max: float
    mean: float
    rms: float
    p95: float


class RssDifference(Record):
    """Statistics of the RSS minus those of another machine; no ranges.

    * ``position_um``: Of the position, um.
    * ``rotation_urad``: Of the orientation, urad.
    """

    __slots__ = ()

    position_um: LengthDifference
    rotation_urad: LengthDifference

    _kinds = {
        "position_um": LengthDifference,
        "rotation_urad": LengthDifference,
    }


class ComparedBounds(Record):
    """What the bounds of a machine lead to on the tool poses, where nothing is measured.

    * ``errors``: Number of bounded errors.
    * ``class``: The class that bounds what the machine file does not.
    * ``class_source``: Source of the class.
    * ``samples``: Number of machines drawn.
    * ``seed``: Seed of poses and errors.
    * ``distribution``: Distribution of an error between its bounds.
    * ``statistic``: Statistic of a machine over the poses.
    * ``position_um``: The position deviation, um.
    * ``rotation_urad``: The rotation of the tool, urad.
    * ``rss_minus_first``: The statistics of the RSS minus those of the first machine.
    """

    __slots__ = ()

    errors: int
    class_source: Union[str, None]
    samples: int
    seed: int
    distribution: Literal["uniform", "triangular"]
    statistic: Literal["max", "p95"]
    position_um: BoundedDeviationShape
    rotation_urad: BoundedDeviationShape
    rss_minus_first: Union[RssDifference, None]

    _kinds = {
        "position_um": BoundedDeviationShape,
        "rotation_urad": BoundedDeviationShape,
        "rss_minus_first": RssDifference,
    }


class Difference(Record):
    """Statistics minus statistics.

    * ``position_um``: Position deviations of the functional point, um.
    * ``rotation_urad``: Rotations of the tool, urad.
    """

    __slots__ = ()

    position_um: Summary
    rotation_urad: Summary

    _kinds = {
        "position_um": Summary,
        "rotation_urad": Summary,
    }


class ComparedBands(Record):
    """Intervals of the statistics of a machine beside another. Machines share the uncertainty that both files state.

    * ``parts``: Number of independent parts of the uncertainty.
    * ``poses``: Number of poses at which they were followed.
    * ``drawn``: True if the intervals were drawn, false if they are to first order (k = 2).
    * ``position_um``: Position deviations of the functional point, um.
    * ``rotation_urad``: Rotations of the tool, urad.
    * ``minus_first``: Those of its statistics minus the first machine's.
    * ``told_apart``: True if the 95 % position deviation differs from the first machine's by more than the uncertainty.
    """

    __slots__ = ()

    parts: int
    poses: int
    drawn: bool
    position_um: SummaryBand
    rotation_urad: SummaryBand
    minus_first: Bands
    told_apart: bool

    _kinds = {
        "position_um": SummaryBand,
        "rotation_urad": SummaryBand,
        "minus_first": Bands,
    }


class ComparedMachine(Record):
    """One machine of a comparison.

    * ``machine``: Name of the machine.
    * ``file``: Name of its file.
    * ``order``: Order of its errors.
    * ``unreachable``: Number of tool poses that it does not reach, by reason.
    * ``from``: ``bounds`` where nothing is measured: then the statistics are of the 95 % value at each tool pose.
    * ``bounds``: What its bounds lead to, where nothing is measured.
    * ``bounds_add``: What bounds of errors without a value add to the measured ones.
    * ``position_um``: Statistics of the deviation of the functional point, um.
    * ``rotation_urad``: Statistics of the deviation of the orientation of the tool, urad.
    * ``minus_first``: The statistics minus those of the first machine: negative is better than the first. None where of
      only one of the two nothing is measured.
    * ``uncertainty``: Intervals of its statistics, and of these minus those of the first machine, where any of the
      files states uncertainties of errors.
    * ``missed``: Rows of a file of tool poses that it does not reach.
    * ``travel``: The travel that the tool poses of a file need, axis by axis.
    """

    __slots__ = ()

    machine: str
    file: str
    order: str
    unreachable: UnreachableCount
    bounds: Union[ComparedBounds, None]
    bounds_add: Union[AddedByBounds, None]
    position_um: Summary
    rotation_urad: Summary
    minus_first: Union[Difference, None]
    uncertainty: Union[ComparedBands, None]
    missed: Union[list[MissedToolPose], None]
    travel: Union[list[NeededTravel], None]

    _kinds = {
        "unreachable": UnreachableCount,
        "bounds": ComparedBounds,
        "bounds_add": AddedByBounds,
        "position_um": Summary,
        "rotation_urad": Summary,
        "minus_first": Difference,
        "uncertainty": ComparedBands,
        "missed": MissedToolPose,
        "travel": NeededTravel,
    }

    _optional = frozenset({
        "from",
        "bounds",
        "bounds_add",
        "uncertainty",
        "missed",
        "travel",
    })


class DeviationBudget(Record):
    """A deviation, as bounds lead to it.

    * ``worst_case``: Sum of the effects of all bounds, at the pose where it is largest.
    * ``rss``: Root of the sum of their squares, at the pose where it is largest.
    * ``mean_of_both``: Mean of both.
    * ``worst_case_at``: Pose of the worst case, mm and deg.
    * ``rss_at``: Pose of the largest RSS, mm and deg.
    * ``monte_carlo``: Machines drawn between the bounds.
    """

    __slots__ = ()

    worst_case: float
    rss: float
    mean_of_both: float
    worst_case_at: Named[float]
    rss_at: Named[float]
    monte_carlo: DrawnMachineFigures

    _kinds = {
        "worst_case_at": Names(None),
        "rss_at": Names(None),
        "monte_carlo": DrawnMachineFigures,
    }


class DrawnDifference(Record):
    """Figures of machines drawn minus those of others.

    * ``mean``: Of the mean.
    * ``p95``: Of the 95 % value.
    """

    __slots__ = ()

    mean: float
    p95: float


class DeviationBudgetDifference(Record):
    """Figures of a deviation minus those of another.

    * ``worst_case``: Of the worst case.
    * ``rss``: Of the RSS.
    * ``mean_of_both``: Of the mean of both.
    * ``monte_carlo``: Of machines drawn.
    """

    __slots__ = ()

    worst_case: float
    rss: float
    mean_of_both: float
    monte_carlo: DrawnDifference

    _kinds = {
        "monte_carlo": DrawnDifference,
    }


class BudgetDifference(Record):
    """Figures of a budget minus those of another.

    * ``position_um``: Of the position, um.
    * ``rotation_urad``: Of the rotation, urad.
    """

    __slots__ = ()

    position_um: Union[DeviationBudgetDifference, None]
    rotation_urad: Union[DeviationBudgetDifference, None]

    _kinds = {
        "position_um": DeviationBudgetDifference,
        "rotation_urad": DeviationBudgetDifference,
    }


class ComparedBudget(Record):
    """The budget of a machine beside others.

    * ``errors``: Number of bounded errors.
    * ``class``: The class that bounds what the machine file does not.
    * ``class_source``: Source of the class.
    * ``position_um``: The position deviation, um.
    * ``rotation_urad``: The rotation of the tool, urad.
    * ``minus_first``: Minus the figures of the first machine.
    """

    __slots__ = ()

    errors: int
    class_source: Union[str, None]
    position_um: DeviationBudget
    rotation_urad: DeviationBudget
    minus_first: BudgetDifference

    _kinds = {
        "position_um": DeviationBudget,
        "rotation_urad": DeviationBudget,
        "minus_first": BudgetDifference,
    }


class ComparedContribution(Record):
    """An error in several budgets; none where a machine does not bound it.

    * ``error``: Name of the error.
    * ``unit``: ``um`` or ``urad``.
    * ``tolerance``: Its tolerance, in ``unit``.
    * ``um_of_p95``: Its part of the 95 % value, um.
    * ``um_of_p95_sigma``: Standard error of that part, um.
    * ``minus_first``: That part minus that of the first machine, um.
    * ``average_um``: Its effect averaged over the poses, um.
    """

    __slots__ = ()

    error: str
    unit: str
    tolerance: list[Union[float, None]]
    um_of_p95: list[Union[float, None]]
    um_of_p95_sigma: list[Union[float, None]]
    minus_first: list[float]
    average_um: list[Union[float, None]]


class PairedDifference(Record):
    """The difference of two 95 % values with its interval; ``None`` where there are too few samples for an end.

    * ``value``: Of the samples.
    * ``low``: Lower end.
    * ``high``: Upper end.
    """

    __slots__ = ()

    value: float
    low: Union[float, None]
    high: Union[float, None]


class VersusFirst(Record):
    """A machine or arrangement against the first, on the machines drawn of both.

    * ``verdict``: What is known of the two.
    * ``minus_first``: Its 95 % value minus that of the first, um. The intervals of all pairs and all rounds hold
      together with 95 % confidence.
    """

    __slots__ = ()

    verdict: Literal["first", "equal", "not_told_apart", "worse", "better"]
    minus_first: PairedDifference

    _kinds = {
        "minus_first": PairedDifference,
    }


class ComparedBudgets(Record):
    """Budgets on the same work.

    * ``machines``: The budget of each machine.
    * ``largest_um``: Effect of the error that is first in ``contributions``, um.
    * ``contributions``: Error by error, largest first; a list has a value for each machine.
    * ``class``: The class that bounds what the machine file does not.
    * ``class_source``: Source of the class.
    * ``samples``: Number of machines drawn.
    * ``seed``: Seed of poses and errors.
    * ``distribution``: Distribution of an error between its bounds.
    * ``statistic``: Statistic of a machine over the poses.
    * ``max_samples``: Number of machines that are drawn at most.
    * ``versus_first_p95_um``: The 95 % value of each machine but the first, minus that of the first.
    """

    __slots__ = ()

    machines: list[ComparedBudget]
    largest_um: float
    contributions: list[ComparedContribution]
    class_source: Union[str, None]
    samples: int
    seed: int
    distribution: Literal["uniform", "triangular"]
    statistic: Literal["max", "p95"]
    max_samples: int
    versus_first_p95_um: list[VersusFirst]

    _kinds = {
        "machines": ComparedBudget,
        "contributions": ComparedContribution,
        "versus_first_p95_um": VersusFirst,
    }


class CompareFields(Record):
    """Machines side by side, over the tool poses that all of them reach.

    * ``contributions``: Effect of each error alone, largest first.
    * ``asked``: Number of tool poses asked for.
    * ``poses``: Number of tool poses that all machines reach.
    * ``seed``: Seed of the tool poses, and of the errors that are drawn.
    * ``frame``: Frame of the vectors: the workpiece frame.
    * ``direction``: Side of approach.
    * ``machines``: The machines in their order.
    * ``budgets``: Budgets on the same work, where every machine bounds errors.
    """

    __slots__ = ()

    contributions: list[ErrorContribution]
    asked: int
    poses: int
    seed: int
    frame: Literal["workpiece", "machine", "tool"]
    direction: Literal["mean", "forward", "reverse"]
    machines: list[ComparedMachine]
    budgets: Union[ComparedBudgets, None]

    _kinds = {
        "contributions": ErrorContribution,
        "machines": ComparedMachine,
        "budgets": ComparedBudgets,
    }

    _optional = frozenset({
        "budgets",
    })


class BoundedContribution(Record):
    """Effect of an error at its bound.

    * ``error``: Name of the error.
    * ``share``: Share of the sum of squares, 0 to 1.
    * ``um``: Position deviation, um.
    """

    __slots__ = ()

    error: str
    share: float
    um: float


class Tightening(Record):
    """A bounded error, and the effect of its tolerance.

    * ``error``: Name of the error.
    * ``tolerance``: Its tolerance, in ``unit``.
    * ``unit``: ``um`` or ``urad``.
    * ``direction``: Its direction, machine frame.
    * ``by_letter``: True if its name has the letter of a direction.
    * ``of_class``: True if the class bounds it, false if the machine file does.
    * ``um_per_unit``: Derivative of the 95 % value by the tolerance, um by unit.
    * ``sigma``: Standard error of the derivative, um by unit.
    * ``um_of_p95``: Its part of the 95 % value, um.
    * ``um_of_p95_sigma``: Standard error of that part, um.
    * ``at_worst_um``: Its effect where the RSS is largest, um.
    * ``average_um``: Its effect averaged over the poses, um.
    """

    __slots__ = ()

    error: str
    tolerance: float
    unit: str
    direction: list[float]
    by_letter: bool
    of_class: bool
    um_per_unit: float
    sigma: float
    um_of_p95: float
    um_of_p95_sigma: float
    at_worst_um: Union[float, None]
    average_um: Union[float, None]


class Percentile(Record):
    """A percentile of the population the samples come from.

    * ``percent``: The percentile, in percent.
    * ``value``: The ceil(percent n / 100)-th smallest sample.
    * ``low``: Lower end of the interval that holds it with 95 % confidence; ``None`` with too few samples.
    * ``high``: Upper end.
    """

    __slots__ = ()

    percent: int
    value: float
    low: Union[float, None]
    high: Union[float, None]


class GoalCost(Record):
    """The cost of tolerances.

    * ``power``: Power of the tolerance in the cost.
    * ``before``: Of the old tolerances.
    * ``after``: Of the new tolerances.
    * ``per_um``: By um of the goal.
    """

    __slots__ = ()

    power: float
    before: float
    after: float
    per_um: float


class GoalTolerance(Record):
    """A tolerance for a goal.

    * ``error``: Name of the error.
    * ``kind``: The kind by which it is paid for.
    * ``unit``: ``um`` or ``urad``.
    * ``old``: Before, in ``unit``.
    * ``new``: After, in ``unit``.
    * ``binds``: The limit that holds it.
    * ``um_of_p95``: Its part of the 95 % value, um.
    * ``weight``: Its weight in the cost.
    * ``cost_before``: Its cost before.
    * ``cost_after``: Its cost after.
    """

    __slots__ = ()

    error: str
    kind: Literal["positioning", "straightness", "angular", "squareness", "position", "orientation", "radial", "axial", "tilt", "angular_positioning"]
    unit: str
    old: float
    new: float
    binds: Literal["goal", "finest", "coarsest"]
    um_of_p95: float
    weight: float
    cost_before: float
    cost_after: float


class ToleranceGoal(Record):
    """The cheapest tolerances for a goal.

    * ``goal_um``: The goal of the 95 % value, um.
    * ``before_um``: The 95 % value with the old tolerances, um.
    * ``proof_um``: The 95 % value with the new tolerances, of machines drawn anew, um.
    * ``proof_samples``: Number of machines of the proof.
    * ``staying_um``: The 95 % value of what no tolerance of the cost model changes, um.
    * ``steps``: Number of steps of the search.
    * ``cost``: The cost.
    * ``tolerances``: The tolerances.
    """

    __slots__ = ()

    goal_um: float
    before_um: Percentile
    proof_um: Percentile
    proof_samples: int
    staying_um: float
    steps: int
    cost: GoalCost
    tolerances: list[GoalTolerance]

    _kinds = {
        "before_um": Percentile,
        "proof_um": Percentile,
        "cost": GoalCost,
        "tolerances": GoalTolerance,
    }


class ContributionsAt(Record):
    """Contributions at a pose.

    * ``axes``: The pose, mm and deg.
    * ``contributions``: Effect of each error at its bound, largest first.
    """

    __slots__ = ()

    axes: Named[float]
    contributions: list[BoundedContribution]

    _kinds = {
        "axes": Names(None),
        "contributions": BoundedContribution,
    }


class BudgetFields(Record):
    """A budget: to first order, in the workpiece frame.

    * ``machine``: Name of the machine.
    * ``chain``: The kinematic chain.
    * ``class``: The class that bounds what the machine file does not.
    * ``class_source``: Source of the class.
    * ``samples``: Number of machines drawn.
    * ``seed``: Seed of poses and errors.
    * ``distribution``: Distribution of an error between its bounds.
    * ``statistic``: Statistic of a machine over the poses.
    * ``frame``: Frame of the vectors: the workpiece frame.
    * ``order``: Order of the errors: 1.
    * ``left_out``: Number of errors that have values and are left out.
    * ``poses``: Number of poses.
    * ``position_um``: The position deviation, um.
    * ``rotation_urad``: The rotation of the tool, urad.
    * ``contributions``: Effect of each error at its bound where the RSS is largest, largest first.
    * ``contributions_on_average``: The same, averaged over the poses.
    * ``tighten``: The bounded errors; first the one whose tightening lowers the 95 % value most.
    * ``tool_poses``: Tool poses of a file that the machine reaches.
    * ``goal``: The cheapest tolerances for a goal.
    * ``at``: Contributions at a pose that was named.
    """

    __slots__ = ()

    machine: str
    chain: str
    class_source: Union[str, None]
    samples: int
    seed: int
    distribution: Literal["uniform", "triangular"]
    statistic: Literal["max", "p95"]
    frame: str
    order: str
    left_out: int
    poses: int
    position_um: DeviationBudget
    rotation_urad: DeviationBudget
    contributions: list[BoundedContribution]
    contributions_on_average: list[BoundedContribution]
    tighten: list[Tightening]
    tool_poses: Union[ReachedToolPoses, None]
    goal: Union[ToleranceGoal, None]
    at: Union[ContributionsAt, None]

    _kinds = {
        "position_um": DeviationBudget,
        "rotation_urad": DeviationBudget,
        "contributions": BoundedContribution,
        "contributions_on_average": BoundedContribution,
        "tighten": Tightening,
        "tool_poses": ReachedToolPoses,
        "goal": ToleranceGoal,
        "at": ContributionsAt,
    }

    _optional = frozenset({
        "tool_poses",
        "goal",
        "at",
    })


class RoundCount(Record):
    """A finished round.

    * ``samples``: Number of machines of each arrangement after it.
    * ``arrangements``: Number of arrangements that took part.
    """

    __slots__ = ()

    samples: int
    arrangements: int


class RoundsShape(Record):
    """Rounds of a ranking.

    * ``max_samples``: Maximum number of machines drawn of an arrangement.
    * ``first``: Number of first ranks that were to be told apart.
    * ``told_apart``: True if they are.
    * ``done``: The rounds done.
    * ``drawn``: Number of machines drawn.
    * ``drawn_without_elimination``: Their number if no arrangement were left out.
    """

    __slots__ = ()

    max_samples: int
    first: int
    told_apart: bool
    done: list[RoundCount]
    drawn: int
    drawn_without_elimination: int

    _kinds = {
        "done": RoundCount,
    }


class ArrangementShape(Record):
    """An arrangement of the axes.

    * ``rank``: Its rank, from 1; of ranked arrangements only.
    * ``chain``: Its kinematic chain.
    * ``on_table``: Number of axes that carry the workpiece.
    * ``reached``: Number of tool poses that it reaches.
    * ``unreachable``: Number of tool poses that it does not reach, by reason.
    * ``um``: Its figure, um; none where it is not judged.
    * ``low``: Lower end of the confidence interval of the figure, um.
    * ``high``: Upper end of the confidence interval of the figure, um.
    * ``mean``: Mean of the machines drawn, um.
    * ``minus_file``: Its figure minus that of the arrangement of the file, um.
    * ``samples``: Number of machines drawn.
    * ``versus_first``: Its figure minus that of the best.
    * ``travel``: Travel that the work needs by axis, mm: minimum and maximum.
    * ``not_stated``: Geometry that the file does not state.
    """

    __slots__ = ()

    rank: Union[int, None]
    chain: str
    on_table: int
    reached: int
    unreachable: UnreachableCount
    um: Union[float, None]
    low: Union[float, None]
    high: Union[float, None]
    mean: Union[float, None]
    minus_file: Union[float, None]
    samples: Union[int, None]
    versus_first: Union[VersusFirst, None]
    travel: Union[Named[list[float]], None]
    not_stated: Union[list[str], None]

    _kinds = {
        "unreachable": UnreachableCount,
        "versus_first": VersusFirst,
        "travel": Names(None),
    }

    _optional = frozenset({
        "rank",
        "samples",
        "versus_first",
        "travel",
        "not_stated",
    })


class EnumerateFields(Record):
    """Arrangements in order.

    * ``machine``: Name of the machine.
    * ``chain``: Its kinematic chain as the file has it.
    * ``by``: Criterion of the arrangements.
    * ``class``: The class that bounds what the machine file does not.
    * ``class_source``: Source of the class.
    * ``errors``: Number of errors that count.
    * ``poses``: Number of tool poses.
    * ``samples``: Number of machines drawn of every arrangement.
    * ``rounds``: The rounds, where machines are drawn.
    * ``seed``: Seed of poses and errors.
    * ``statistic``: Statistic of a machine over the poses.
    * ``reach``: Fraction of the tool poses that a ranked arrangement reaches.
    * ``arrangements``: Number of arrangements.
    * ``ranked``: The arrangements, best first.
    * ``reach_less``: Arrangements that reach less.
    * ``geometry_not_stated``: Arrangements whose geometry the file does not state.
    * ``cannot_turn_the_tool``: Chains of arrangements that cannot turn the tool.
    * ``tool_poses``: Tool poses of a file that the machine reaches.
    """

    __slots__ = ()

    machine: str
    chain: str
    by: Literal["budget", "errors"]
    class_source: Union[str, None]
    errors: int
    poses: int
    samples: Union[int, None]
    rounds: Union[RoundsShape, None]
    seed: int
    statistic: Literal["max", "p95"]
    reach: float
    arrangements: int
    ranked: list[ArrangementShape]
    reach_less: list[ArrangementShape]
    geometry_not_stated: list[ArrangementShape]
    cannot_turn_the_tool: list[str]
    tool_poses: Union[ReachedToolPoses, None]

    _kinds = {
        "rounds": RoundsShape,
        "ranked": ArrangementShape,
        "reach_less": ArrangementShape,
        "geometry_not_stated": ArrangementShape,
        "tool_poses": ReachedToolPoses,
    }

    _optional = frozenset({
        "tool_poses",
    })


class BothSensesShape(Record):
    """A figure by the sense of rotation.

    * ``counter_clockwise``: By rising angle.
    * ``clockwise``: By falling angle.
    """

    __slots__ = ()

    counter_clockwise: float
    clockwise: float


class ExtremesShape(Record):
    """Largest and smallest reading by the sense of rotation.

    * ``counter_clockwise``: By rising angle.
    * ``clockwise``: By falling angle.
    """

    __slots__ = ()

    counter_clockwise: list[float]
    clockwise: list[float]


class CircleReadings(Record):
    """A circle by both senses.

    * ``plane``: The plane, workpiece frame.
    * ``circular_deviation_um``: Circular deviation G, um.
    * ``bidirectional_um``: Bidirectional circular deviation G(b), um.
    * ``mean_radial_um``: Mean bidirectional radial deviation D, um.
    * ``radial_max_min_um``: Radial deviations F, um: largest and smallest.
    * ``squareness_urad``: Angle between the plane's directions minus 90 deg, urad.
    * ``scale_mismatch_um_per_m``: Scale of the first direction minus that of the second, um/m.
    * ``angle_deg``: Angles of the readings, deg.
    * ``counter_clockwise_um``: Length read minus radius, um.
    * ``clockwise_um``: Length read minus radius, um.
    """

    __slots__ = ()

    plane: str
    circular_deviation_um: BothSensesShape
    bidirectional_um: float
    mean_radial_um: float
    radial_max_min_um: ExtremesShape
    squareness_urad: float
    scale_mismatch_um_per_m: float
    angle_deg: list[float]
    counter_clockwise_um: list[float]
    clockwise_um: list[float]

    _kinds = {
        "circular_deviation_um": BothSensesShape,
        "radial_max_min_um": ExtremesShape,
    }


class TurnReading(Record):
    """A reading of an R-test.

    * ``position_deg``: Position of the axis, deg.
    * ``axes``: The pose, mm and deg.
    * ``reading_um``: Deviation minus that at the first position, um, machine frame.
    """

    __slots__ = ()

    position_deg: float
    axes: Named[float]
    reading_um: list[float]

    _kinds = {
        "axes": Names(None),
    }


class TurnReadings(Record):
    """An R-test of an axis.

    * ``axis``: Name of the axis.
    * ``range_um``: Ranges along x, y, z, um.
    * ``count``: Number of readings.
    * ``skipped``: Number of positions that the other axes cannot follow.
    * ``readings``: The readings.
    """

    __slots__ = ()

    axis: str
    range_um: list[float]
    count: int
    skipped: int
    readings: list[TurnReading]

    _kinds = {
        "readings": TurnReading,
    }


class DiagonalReadings(Record):
    """A laser along a diagonal.

    * ``name``: Sense of each axis: p or n.
    * ``axes``: Names of the axes.
    * ``e_d_um``: Range of both runs E_d, um.
    * ``b_d_um``: Largest difference of both runs B_d, um.
    * ``by_axis_um``: Sum of the changes by each axis on the forward run, um; with steps only.
    * ``way_mm``: Nominal displacement from the start, mm.
    * ``there_um``: Actual minus nominal on the forward run, um.
    * ``back_um``: Actual minus nominal on the return run, um.
    """

    __slots__ = ()

    name: str
    axes: list[str]
    e_d_um: float
    b_d_um: float
    by_axis_um: Union[list[float], None]
    way_mm: list[float]
    there_um: list[float]
    back_um: list[float]


class InstrumentFields(Record):
    """Readings of an instrument; the fields of other instruments are absent.

    * ``machine``: Name of the machine.
    * ``instrument``: ``ball_bar``, ``r_test``, ``diagonals`` or ``step_diagonals``.
    * ``centre``: Ball bar: centre of the circles, mm and deg.
    * ``radius_mm``: Ball bar: its length, mm.
    * ``planes``: Ball bar: the circles.
    * ``ball_at``: R-test: pose at which the ball is, mm and deg.
    * ``frame``: R-test: frame of the readings, the machine frame.
    * ``axes``: R-test: the axes.
    * ``at``: Diagonals: pose of the axes that stand, mm and deg.
    * ``diagonals``: Diagonals: the lines.
    * ``e_um``: Diagonals: the largest E_d, um.
    """

    __slots__ = ()

    machine: str
    instrument: str
    centre: Union[Named[float], None]
    radius_mm: Union[float, None]
    planes: Union[list[CircleReadings], None]
    ball_at: Union[Named[float], None]
    frame: Union[Literal["workpiece", "machine", "tool"], None]
    axes: Union[list[TurnReadings], None]
    at: Union[Named[float], None]
    diagonals: Union[list[DiagonalReadings], None]
    e_um: Union[float, None]

    _kinds = {
        "centre": Names(None),
        "planes": CircleReadings,
        "ball_at": Names(None),
        "axes": TurnReadings,
        "at": Names(None),
        "diagonals": DiagonalReadings,
    }

    _optional = frozenset({
        "centre",
        "radius_mm",
        "planes",
        "ball_at",
        "frame",
        "axes",
        "at",
        "diagonals",
        "e_um",
    })


class FittedParameter(Record):
    """A parameter with its value.

    * ``name``: Name such as ``EX0C``.
    * ``value``: Value, in ``unit``.
    * ``sigma``: Combined standard uncertainty, in ``unit``; none if the data leave the value free or nothing scatters.
    * ``type_a``: The part of it that the scatter of the readings makes, as if each were independent (type A).
    * ``lack_of_fit``: The part of it that the form of the axes makes, which readings near each other share.
    * ``type_b``: The part of it that all readings share, as the user states it (type B).
    * ``unit``: Unit of value and uncertainty.
    * ``coverage_factor_95``: Standard uncertainties that a 95 % interval reaches to either side.
    * ``valuation``: Standard deviation of a reading over that of the parameter's effect on a usual reading; 0 if the
      value is free.
    """

    __slots__ = ()

    name: str
    value: float
    sigma: Union[float, None]
    type_a: Union[float, None]
    lack_of_fit: float
    type_b: float
    unit: str
    coverage_factor_95: Union[float, None]
    valuation: float


class KnownValue(Record):
    """A value that was known before the data.

    * ``name``: Name of the unknown.
    * ``value``: Value, in ``unit``.
    * ``sigma``: Standard uncertainty, in ``unit``.
    * ``unit``: Unit of value and uncertainty.
    """

    __slots__ = ()

    name: str
    value: float
    sigma: float
    unit: str


class SharedUncertainty(Record):
    """A standard uncertainty that all readings share (type B).

    * ``name``: Its name.
    * ``scale_um_per_m``: Scale of all lengths, um/m.
    * ``offset_um``: Offset of every component, um.
    """

    __slots__ = ()

    name: str
    scale_um_per_m: Union[float, None]
    offset_um: Union[float, None]


class FormOfAxis(Record):
    """The form of an axis beside its fitted curves.

    * ``axis``: The axis.
    * ``size_um``: Standard deviation of each displacement over the positions measured, um.
    * ``length``: Correlation length, in ``unit``.
    * ``unit``: mm or deg.
    """

    __slots__ = ()

    axis: str
    size_um: float
    length: float
    unit: str


class LackOfFit(Record):
    """The form of the axes that the fitted curves leave.

    * ``probability``: Probability that there is any, with odds of one to three before the data.
    * ``forms``: The axes with their forms, if one is likelier than none.
    """

    __slots__ = ()

    probability: float
    forms: list[FormOfAxis]

    _kinds = {
        "forms": FormOfAxis,
    }


class RmsBeforeAfter(Record):
    """Root mean square of the readings, um.

    * ``before``: Against the machine file as it was.
    * ``after``: Against the fitted machine.
    * ``held_out``: Against fits without the readings that they predict, if asked for.
    """

    __slots__ = ()

    before: float
    after: float
    held_out: Union[float, None]


class ScatterOfKind(Record):
    """Scatter of one kind of reading.

    * ``of``: Kind of reading, or ``uncertainties given``.
    * ``sigma_um``: Standard deviation of a reading of weight 1, um.
    """

    __slots__ = ()

    of: str
    sigma_um: float


class RepeatedReadings(Record):
    """Scatter of readings of one kind in poses that were measured again.

    * ``of``: Kind of reading.
    * ``sigma_um``: Standard deviation of a reading of weight 1, um.
    * ``degrees_of_freedom``: Degrees of freedom behind it.
    """

    __slots__ = ()

    of: str
    sigma_um: float
    degrees_of_freedom: int


class OrderShares(Record):
    """Deviations by the order of the errors that make them, root mean square over the readings, um.

    * ``first``: First order.
    * ``second``: Second order.
    * ``higher``: All higher orders.
    * ``left_by_first``: Residual of the model of order 1.
    * ``left_by_second``: Residual of the model of order 2.
    """

    __slots__ = ()

    first: float
    second: float
    higher: float
    left_by_first: float
    left_by_second: float


class KindResidual(Record):
    """Residual of one kind of reading.

    * ``kind``: Kind of reading.
    * ``rows``: Number of readings.
    * ``rms_um``: Root mean square of their residuals, um.
    """

    __slots__ = ()

    kind: str
    rows: int
    rms_um: float


class ResidualTest(Record):
    """Tests of residuals for randomness; the probabilities hold if the residuals are noise.

    * ``of``: Readings tested.
    * ``count``: Number of residuals.
    * ``normality``: Probability of residuals so far from a normal distribution.
    * ``runs``: Probability of so few or so many runs of one sign.
    * ``lag1``: Correlation of a residual with the one before it.
    """

    __slots__ = ()

    of: str
    count: int
    normality: float
    runs: float
    lag1: float


class OutlierPlace(Record):
    """A reading that stands out.

    * ``place``: File and line.
    * ``residual_um``: Its residual, um.
    * ``deviations``: The same in standard deviations.
    """

    __slots__ = ()

    place: str
    residual_um: float
    deviations: float


class PredictedUncertainty(Record):
    """The uncertainty of the deviation over the volume, after the best rigid motion of the workpiece frame.

    * ``largest_um``: The largest standard uncertainty, um, along the direction in which it is largest; none if the data
      leave the deviation free, or nothing scatters.
    * ``infinite``: True if the data leave it free somewhere: the uncertainty is infinite.
    * ``combination``: A combination of parameters that changes the deviation and no reading, in words.
    * ``at``: Pose at which it is largest, mm and deg.
    * ``tool``: The tool there.
    * ``deviation_um``: The largest deviation predicted, um.
    * ``held``: True if the data hold the prediction, so that a machine file is written.
    """

    __slots__ = ()

    largest_um: Union[float, None]
    infinite: bool
    combination: Union[str, None]
    at: Named[float]
    tool: str
    deviation_um: float
    held: bool

    _kinds = {
        "at": Names(None),
    }


class FittedDatum(Record):
    """The datum of the fitted errors.

    * ``line``: Reference straight line of the straightness errors of linear axes.
    * ``zero``: Position at which positioning and angular errors are zero.
    * ``squareness``: Place of the squareness of the axes.
    * ``conditions``: Number of conditions: each fixes a combination of errors that changes nothing but where the
      workpiece stands.
    * ``translation_um``: Translation of the whole that was taken out of the errors, um.
    * ``rotation_urad``: Rotation of the whole that was taken out, about the middle of the volume, urad.
    """

    __slots__ = ()

    line: Literal["least-squares", "end-points", "free"]
    zero: Literal["start", "middle", "machine", "free"]
    squareness: Literal["in location", "in straightness"]
    conditions: int
    translation_um: list[float]
    rotation_urad: list[float]


class FittedError(Record):
    """A fitted error over the travel of its axis.

    * ``error``: ISO name.
    * ``smallest``: Smallest value, in ``unit``.
    * ``largest``: Largest value, in ``unit``; that of a location error is its only one.
    * ``sigma``: Largest standard uncertainty, in ``unit``; none if the data leave the error free somewhere.
    * ``unit``: ``um`` or ``urad``.
    """

    __slots__ = ()

    error: str
    smallest: float
    largest: float
    sigma: Union[float, None]
    unit: str


class IdentifyFields(Record):
    """A fit.

    * ``rows``: Number of readings.
    * ``points``: Number of measurements.
    * ``parameters``: The machine's parameters.
    * ``instruments``: Unknowns of the instruments, such as places of stations.
    * ``known``: Values that were known before the data.
    * ``type_b``: Standard uncertainties that all readings share.
    * ``lack_of_fit``: The form of the axes beside the fitted curves; none if the readings cannot show it: fewer than 20
      to spare, or no axis at six positions.
    * ``rank``: Numerical rank of the problem.
    * ``rank_first_order``: The rank of the model to first order in the errors: what the readings show without products
      of errors.
    * ``unknowns``: Number of unknowns.
    * ``well_determined``: Number of independent combinations above the noise.
    * ``null_space``: Combinations without effect on the data, in words.
    * ``drowned``: Combinations below the noise, in words.
    * ``condition``: Ratio of the largest singular value to the smallest that counts.
    * ``valuation``: Least valuation of the machine's parameters that have a value.
    * ``singular_values``: Singular values of the column-scaled problem.
    * ``rms_um``: Root mean square of the readings.
    * ``sigma_um``: Standard deviation of a reading of weight 1, um; none where kinds scatter differently.
    * ``degrees_of_freedom``: Readings beyond the rank.
    * ``scatter``: Scatter kind by kind, where kinds scatter differently.
    * ``repeatability_um``: Scatter of repeated poses, um: that of the first kind.
    * ``repeats``: Scatter of repeated poses, kind by kind.
    * ``orders_um``: Deviations by order.
    * ``kinds``: Residuals kind by kind.
    * ``residual_tests``: Tests of the residuals.
    * ``outliers``: Readings that stand out, farthest first.
    * ``prediction``: Uncertainty of the fit's prediction over the volume.
    * ``invariances``: Rigid motions of the whole machine that no reading notices, such as ``along X``.
    * ``datum``: The datum of the errors, where curves are fitted.
    * ``errors``: Every fitted error of an axis over its travel.
    * ``steps``: Steps of the fit.
    * ``settled``: False if the fit was stopped before it had settled.
    """

    __slots__ = ()

    rows: int
    points: int
    parameters: list[FittedParameter]
    instruments: list[FittedParameter]
    known: list[KnownValue]
    type_b: list[SharedUncertainty]
    lack_of_fit: Union[LackOfFit, None]
    rank: int
    rank_first_order: int
    unknowns: int
    well_determined: int
    null_space: list[str]
    drowned: list[str]
    condition: float
    valuation: float
    singular_values: list[float]
    rms_um: RmsBeforeAfter
    sigma_um: Union[float, None]
    degrees_of_freedom: int
    scatter: list[ScatterOfKind]
    repeatability_um: Union[float, None]
    repeats: list[RepeatedReadings]
    orders_um: OrderShares
    kinds: list[KindResidual]
    residual_tests: list[ResidualTest]
    outliers: list[OutlierPlace]
    prediction: PredictedUncertainty
    invariances: list[str]
    datum: Union[FittedDatum, None]
    errors: list[FittedError]
    steps: int
    settled: bool

    _kinds = {
        "parameters": FittedParameter,
        "instruments": FittedParameter,
        "known": KnownValue,
        "type_b": SharedUncertainty,
        "lack_of_fit": LackOfFit,
        "rms_um": RmsBeforeAfter,
        "scatter": ScatterOfKind,
        "repeats": RepeatedReadings,
        "orders_um": OrderShares,
        "kinds": KindResidual,
        "residual_tests": ResidualTest,
        "outliers": OutlierPlace,
        "prediction": PredictedUncertainty,
        "datum": FittedDatum,
        "errors": FittedError,
    }


class Rms(Record):
    """Root mean square of readings, um.

    * ``before``: As measured.
    * ``after``: After the fit.
    """

    __slots__ = ()

    before: float
    after: float


class MonomialCoefficient(Record):
    """The coefficient of a monomial.

    * ``monomial``: Name such as ``EX0C`` or ``EA0C*EB0C``.
    * ``value``: Value, in ``unit``.
    * ``unit``: Unit of the value.
    * ``determined``: True if the data tell it from the others.
    """

    __slots__ = ()

    monomial: str
    value: float
    unit: str
    determined: bool


class MonomialComponent(Record):
    """One component of the deviation.

    * ``component``: ``dx``, ``dy`` or ``dz``.
    * ``readings``: Number of readings.
    * ``columns``: Number of monomials.
    * ``rank``: Rank of the problem.
    * ``rms_um``: Root mean square of the readings.
    * ``coefficients``: The coefficients.
    """

    __slots__ = ()

    component: str
    readings: int
    columns: int
    rank: int
    rms_um: Rms
    coefficients: list[MonomialCoefficient]

    _kinds = {
        "rms_um": Rms,
        "coefficients": MonomialCoefficient,
    }


class MonomialFields(Record):
    """Coefficients of monomials of the errors, which give no machine.

    * ``method``: ``moore-penrose``.
    * ``order``: Highest degree of the monomials.
    * ``components``: The components of the deviation.
    """

    __slots__ = ()

    method: str
    order: int
    components: list[MonomialComponent]

    _kinds = {
        "components": MonomialComponent,
    }


class PlannedPose(Record):
    """A pose to measure.

    * ``axes``: Positions by axis, mm and deg, to two decimals.
    * ``tool``: Name of the tool.
    """

    __slots__ = ()

    axes: Named[float]
    tool: str

    _kinds = {
        "axes": Names(None),
    }


class ExpectedParameter(Record):
    """A parameter with its expected uncertainty.

    * ``name``: Name such as ``EX0C``.
    * ``sigma``: Expected standard uncertainty, in ``unit``; none if the poses leave it free.
    * ``unit``: Unit of the uncertainty.
    """

    __slots__ = ()

    name: str
    sigma: Union[float, None]
    unit: str


class PlanFields(Record):
    """Poses, and what is expected of their measurement.

    * ``poses``: The poses in the order of their worth.
    * ``noise_um``: Standard deviation of a reading, um.
    * ``parameters``: The parameters.
    * ``rank``: Numerical rank of the problem.
    * ``rank_first_order``: The rank of the model to first order in the errors: what the readings show without products
      of errors.
    * ``unknowns``: Number of unknowns.
    * ``well_determined``: Number of independent combinations above the noise.
    * ``null_space``: Combinations without effect, in words.
    * ``drowned``: Combinations below the noise, in words.
    * ``condition``: Ratio of the largest singular value to the smallest that counts.
    """

    __slots__ = ()

    poses: list[PlannedPose]
    noise_um: float
    parameters: list[ExpectedParameter]
    rank: int
    rank_first_order: int
    unknowns: int
    well_determined: int
    null_space: list[str]
    drowned: list[str]
    condition: float

    _kinds = {
        "poses": PlannedPose,
        "parameters": ExpectedParameter,
    }


class StraightnessReference(Record):
    """The straight line in a straightness, before it was taken off.

    * ``slope_um_per_m``: Its slope.
    * ``rise_um``: Its rise over the targets.
    * ``length_mm``: The distance between the outermost targets.
    * ``taken_off``: True if it was taken off: all figures and the table are without it.
    * ``squareness``: The squareness that it would be if the reference was an artefact of the machine.
    * ``squareness_urad``: The value of that squareness in urad.
    """

    __slots__ = ()

    slope_um_per_m: float
    rise_um: float
    length_mm: float
    taken_off: bool
    squareness: Union[str, None]
    squareness_urad: Union[float, None]


class OneWayAccuracy(Record):
    """Figures of one direction of approach, in the unit of the error.

    * ``E``: Systematic deviation E of the direction.
    * ``R``: Repeatability R of the direction; none without repeated runs.
    * ``A``: Accuracy A of the direction; none without repeated runs.
    """

    __slots__ = ()

    E: float
    R: Union[float, None]
    A: Union[float, None]


class OneWayBoth(Record):
    """Figures of both directions of approach; none of a direction that was not measured.

    * ``forward``: Approached with rising position.
    * ``reverse``: Approached with falling position.
    """

    __slots__ = ()

    forward: Union[OneWayAccuracy, None]
    reverse: Union[OneWayAccuracy, None]

    _kinds = {
        "forward": OneWayAccuracy,
        "reverse": OneWayAccuracy,
    }


class AccuracyUncertainties(Record):
    """Expanded uncertainties, k = 2, in the unit of the error, after ISO 230-2 annex A: not verified against its text.

    * ``E``: Uncertainty of E, of one direction and of both.
    * ``M``: Uncertainty of M.
    * ``B``: Uncertainty of B.
    * ``R``: Uncertainty of R.
    * ``A``: Uncertainty of A.
    """

    __slots__ = ()

    E: float
    M: float
    B: float
    R: float
    A: float


class ReadAtTarget(Record):
    """Readings of one direction at a target, in the unit of the error.

    * ``mean``: Their mean.
    * ``s``: The estimate of the standard deviation; none of a single reading.
    * ``runs``: Their number.
    """

    __slots__ = ()

    mean: float
    s: Union[float, None]
    runs: int


class MeasuredTarget(Record):
    """A target with its readings.

    * ``position``: Position, mm or deg.
    * ``forward``: Approached with rising position.
    * ``reverse``: Approached with falling position.
    * ``unknown``: Approached from a side that is not known.
    * ``B``: Reversal: mean of the forward approach minus mean of the reverse one. Lost motion is below zero.
    """

    __slots__ = ()

    position: float
    forward: Union[ReadAtTarget, None]
    reverse: Union[ReadAtTarget, None]
    unknown: Union[ReadAtTarget, None]
    B: Union[float, None]

    _kinds = {
        "forward": ReadAtTarget,
        "reverse": ReadAtTarget,
        "unknown": ReadAtTarget,
    }


class ImportedError(Record):
    """Figures of one error over the axis, after ISO 230-2:2014; lengths in um, angles in urad.

    * ``error``: Name of the error.
    * ``unit``: Unit of the figures.
    * ``targets``: Number of target positions.
    * ``runs``: Least number of runs of a target in a direction.
    * ``bidirectional``: True if both directions were measured.
    * ``E``: Systematic deviation E.
    * ``M``: Mean deviation M.
    * ``B``: Reversal B: the largest size of those of the targets; none without two directions.
    * ``mean_B``: Mean of the reversals of the targets, with its sign.
    * ``R``: Repeatability R; none without repeated runs.
    * ``A``: Accuracy A; none without repeated runs.
    * ``slope``: Slope of the line of best fit, in ``slope_unit``.
    * ``slope_unit``: Unit of the slope, such as ``um/m``.
    * ``line``: Line of the reference, of a straightness of a linear axis.
    * ``one_way``: Figures by direction.
    * ``U``: Expanded uncertainties, k = 2, where contributors are stated that count for this error.
    * ``remarks``: In sentences what ISO 230-2 wants of targets and runs; not verified against its text.
    * ``at_targets``: The readings by target.
    """

    __slots__ = ()

    error: str
    unit: str
    targets: int
    runs: int
    bidirectional: bool
    E: float
    M: float
    B: Union[float, None]
    mean_B: Union[float, None]
    R: Union[float, None]
    A: Union[float, None]
    slope: float
    slope_unit: str
    line: Union[StraightnessReference, None]
    one_way: OneWayBoth
    U: Union[AccuracyUncertainties, None]
    remarks: list[str]
    at_targets: list[MeasuredTarget]

    _kinds = {
        "line": StraightnessReference,
        "one_way": OneWayBoth,
        "U": AccuracyUncertainties,
        "at_targets": MeasuredTarget,
    }


class ReferenceMaterial(Record):
    """The material of a machine at the time of a measurement.

    * ``temperature_deg_c``: Its temperature, deg C.
    * ``expansion_um_per_m_k``: Its coefficient of expansion, um/(m K).
    """

    __slots__ = ()

    temperature_deg_c: float
    expansion_um_per_m_k: float


class LeftOutRow(Record):
    """A row that was not used.

    * ``line``: Its line.
    * ``reason``: The reason.
    """

    __slots__ = ()

    line: int
    reason: str


class LeftOutColumn(Record):
    """A column that was not used.

    * ``column``: Its title.
    * ``reason``: The reason.
    """

    __slots__ = ()

    column: str
    reason: str


class ImportedChannel(Record):
    """A channel of a six-degree instrument.

    * ``column``: Title of the column.
    * ``error``: The error that it shows.
    * ``sign``: ``+`` or ``-``: the error is the column's value times this sign.
    """

    __slots__ = ()

    column: str
    error: str
    sign: str


class ImportFields(Record):
    """A measurement with its figures after ISO 230-2.

    * ``axis``: Name of the axis.
    * ``form``: Layout of the file, in words.
    * ``directions_inferred``: True if directions were read off the order of the rows.
    * ``errors``: The errors with their figures.
    * ``material``: The material whose expansion was taken off the positions.
    * ``readings``: Number of readings.
    * ``left_out``: Rows that were not used.
    * ``columns_left_out``: Columns, blocks and runs that were not used.
    * ``channels``: The errors of the channels of a six-degree instrument.
    * ``metadata``: Entries before the table.
    """

    __slots__ = ()

    axis: str
    form: str
    directions_inferred: bool
    errors: list[ImportedError]
    material: Union[ReferenceMaterial, None]
    readings: int
    left_out: list[LeftOutRow]
    columns_left_out: list[LeftOutColumn]
    channels: list[ImportedChannel]
    metadata: list[list[str]]

    _kinds = {
        "errors": ImportedError,
        "material": ReferenceMaterial,
        "left_out": LeftOutRow,
        "columns_left_out": LeftOutColumn,
        "channels": ImportedChannel,
    }


class BothSenses(Record):
    """Figures of each sense of rotation.

    * ``counter_clockwise``: With rising angle.
    * ``clockwise``: With falling angle.
    """

    __slots__ = ()

    counter_clockwise: Union[float, None]
    clockwise: Union[float, None]


class BothSenses2(Record):
    """Figures of each sense of rotation.

    * ``counter_clockwise``: With rising angle.
    * ``clockwise``: With falling angle.
    """

    __slots__ = ()

    counter_clockwise: Union[list[float], None]
    clockwise: Union[list[float], None]


class UncertainValue(Record):
    """A value with its standard uncertainty.

    * ``value``: The value.
    * ``sigma``: Standard uncertainty by what the causes leave (type A); none without readings to spare.
    """

    __slots__ = ()

    value: float
    sigma: Union[float, None]


class CauseTest(Record):
    """Causes of the deviations of a circle, each beside the others by least squares.

    * ``squareness_urad``: Angle between the directions of the plane minus 90 deg. Of one sense servo mismatch is in it.
    * ``scale_mismatch_um_per_m``: Scale of the first direction minus scale of the second.
    * ``reversal_um``: Reversal of both axes, as ISO 230-2 signs it: below zero is lost motion.
    * ``servo_um``: Servo mismatch as a radial amplitude: above zero the first axis lags more. None of one sense.
    * ``servo_ms``: The same as a difference of delays, with a feed.
    * ``rest_um``: Root mean square of what these causes leave.
    """

    __slots__ = ()

    squareness_urad: UncertainValue
    scale_mismatch_um_per_m: UncertainValue
    reversal_um: list[UncertainValue]
    servo_um: Union[UncertainValue, None]
    servo_ms: Union[UncertainValue, None]
    rest_um: float

    _kinds = {
        "squareness_urad": UncertainValue,
        "scale_mismatch_um_per_m": UncertainValue,
        "reversal_um": UncertainValue,
        "servo_um": UncertainValue,
        "servo_ms": UncertainValue,
    }


class MotionTest(Record):
    """An error motion about the centre of least squares.

    * ``motion``: Probe, or what was formed of probes.
    * ``unit``: Unit of the figures, ``um`` or ``urad``.
    * ``places``: Places of the turn.
    * ``turns``: Turns, at the place that has fewest.
    * ``total``: Total error motion.
    * ``synchronous``: Synchronous error motion; of an axial probe the residual one, without the fundamental.
    * ``asynchronous``: Asynchronous error motion; none of one turn.
    * ``once``: Amplitude of what goes round once. Radial: how far the artefact stood off the axis. Axial: the
      fundamental, which is an error motion.
    * ``synchronous_with_once``: Synchronous error motion with what goes round once.
    """

    __slots__ = ()

    motion: str
    unit: str
    places: int
    turns: int
    total: float
    synchronous: float
    asynchronous: Union[float, None]
    once: float
    synchronous_with_once: float


class DriftOf(Record):
    """The drift of one displacement or tilt.

    * ``drift``: Probe or tilt.
    * ``unit``: Unit of the figures, ``um`` or ``urad``.
    * ``range``: Range over the test.
    * ``first_hour``: Range over the first 60 minutes.
    * ``largest_in_an_hour``: Largest range within 60 minutes.
    * ``change``: Last minus first.
    """

    __slots__ = ()

    drift: str
    unit: str
    range: float
    first_hour: float
    largest_in_an_hour: float
    change: float


class TemperatureRange(Record):
    """The range of a temperature.

    * ``sensor``: The sensor.
    * ``deg_c``: Lowest and highest, deg C.
    """

    __slots__ = ()

    sensor: str
    deg_c: list[float]


class FiguresFields(Record):
    """Figures of a test. Serialises as docs/formats.md describes.

    * ``test``:
    * ``plane``: The plane.
    * ``radius_mm``: Nominal radius.
    * ``arc_deg``: Arc on which there are readings.
    * ``readings``: Number of readings.
    * ``circular_deviation_um``: Circular deviation G about the centre of least squares.
    * ``bidirectional_um``: Bidirectional circular deviation G(b).
    * ``mean_radial_um``: Mean bidirectional radial deviation D.
    * ``radial_max_min_um``: Radial deviations F about the nominal centre, largest and smallest.
    * ``centre_um``: Centre of least squares from the nominal one: how the ball stood.
    * ``causes``: The circle taken apart; none where the readings do not tell causes apart.
    * ``note``: The standard's text was not at hand.
    * ``motions``: Error motions by probe, then in the rotating sensitive direction, then tilts.
    * ``minutes``: Duration of the test.
    * ``drifts``: Displacements by probe, then tilts.
    * ``temperatures``: Ranges of the temperatures.
    """

    __slots__ = ()

    test: Literal["circle", "rotation", "drift"]
    plane: Union[Literal["XY", "YZ", "ZX"], None]
    radius_mm: Union[float, None]
    arc_deg: Union[float, None]
    readings: Union[int, None]
    circular_deviation_um: Union[BothSenses, None]
    bidirectional_um: Union[float, None]
    mean_radial_um: Union[float, None]
    radial_max_min_um: Union[BothSenses2, None]
    centre_um: Union[list[float], None]
    causes: Union[CauseTest, None]
    note: str
    motions: Union[list[MotionTest], None]
    minutes: Union[float, None]
    drifts: Union[list[DriftOf], None]
    temperatures: Union[list[TemperatureRange], None]

    _kinds = {
        "circular_deviation_um": BothSenses,
        "radial_max_min_um": BothSenses2,
        "causes": CauseTest,
        "motions": MotionTest,
        "drifts": DriftOf,
        "temperatures": TemperatureRange,
    }

    _optional = frozenset({
        "plane",
        "radius_mm",
        "arc_deg",
        "readings",
        "circular_deviation_um",
        "bidirectional_um",
        "mean_radial_um",
        "radial_max_min_um",
        "centre_um",
        "causes",
        "motions",
        "minutes",
        "drifts",
        "temperatures",
    })


class LocatedError(Record):
    """A location error.

    * ``name``: Its name.
    * ``unit``: ``um`` or ``urad``.
    * ``found``: Value by the lines that were found.
    * ``uncertainty``: Expanded uncertainty (k = 2) that the table states.
    * ``in_file``: Value in the machine file, 0 if it gives none.
    * ``in_file_uncertainty``: Expanded uncertainty (k = 2) in the machine file.
    * ``difference``: Found minus in the file.
    * ``agrees``: True if the difference is within both uncertainties, as the root of the sum of their squares; none if
      neither is stated.
    """

    __slots__ = ()

    name: str
    unit: str
    found: float
    uncertainty: Union[float, None]
    in_file: float
    in_file_uncertainty: Union[float, None]
    difference: float
    agrees: Union[bool, None]


class LocateFields(Record):
    """Location errors that were found.

    * ``machine``: Name of the machine.
    * ``target``: The controller whose parameters were read; none of a table.
    * ``errors``: The errors, axis by axis.
    """

    __slots__ = ()

    machine: str
    target: Union[str, None]
    errors: list[LocatedError]

    _kinds = {
        "errors": LocatedError,
    }


class Dates(Record):
    """First and last day of the calibration, and the day of issue.

    * ``begin``: First day.
    * ``end``: Last day.
    * ``issued``: Day of issue.
    """

    __slots__ = ()

    begin: str
    end: str
    issued: Union[str, None]


class Contact(Record):
    """A laboratory or a customer.

    * ``name``: Name.
    * ``code``: Code of the laboratory, such as that of its accreditation.
    * ``email``: Electronic mail.
    * ``street``: Street and number.
    * ``post_code``: Post code.
    * ``city``: City.
    * ``country``: Country, ISO 3166-1.
    """

    __slots__ = ()

    name: str
    code: Union[str, None]
    email: Union[str, None]
    street: Union[str, None]
    post_code: Union[str, None]
    city: str
    country: Union[str, None]


class Person(Record):
    """A responsible person.

    * ``name``: Name.
    * ``role``: Role, such as ``calibration engineer``.
    """

    __slots__ = ()

    name: str
    role: Union[str, None]


class Plate(Record):
    """The machine by its plate.

    * ``serial``: Serial number.
    * ``manufacturer``: Manufacturer.
    * ``model``: Model.
    """

    __slots__ = ()

    serial: str
    manufacturer: Union[str, None]
    model: Union[str, None]


class Instrument(Record):
    """An instrument and its certificate.

    * ``name``: Name.
    * ``manufacturer``: Manufacturer.
    * ``model``: Model.
    * ``serial``: Serial number.
    * ``certificate``: Number of its certificate.
    * ``calibrated``: Day of its calibration.
    * ``due``: Day on which its certificate ends.
    * ``uncertainty``: Uncertainty in the words of its certificate.
    * ``file``: The certificate as a file; in the record its copy.
    """

    __slots__ = ()

    name: str
    manufacturer: Union[str, None]
    model: Union[str, None]
    serial: str
    certificate: str
    calibrated: str
    due: Union[str, None]
    uncertainty: str
    file: Union[str, None]


class Temperature(Record):
    """A temperature during the calibration.

    * ``name``: Place of the sensor.
    * ``deg_c``: Temperature, degC.
    * ``expanded_uncertainty_k``: Expanded uncertainty (k = 2), K.
    """

    __slots__ = ()

    name: str
    deg_c: float
    expanded_uncertainty_k: Union[float, None]


class Hashed(Record):
    """A file and its hash.

    * ``name``: Its name.
    * ``sha256``: SHA-256 of its bytes, hexadecimal.
    """

    __slots__ = ()

    name: str
    sha256: str


class MachineState(Record):
    """The machine file of a state.

    * ``file``: The machine file within the record.
    * ``inputs``: Every file that it is read from, within the record.
    """

    __slots__ = ()

    file: str
    inputs: list[Hashed]

    _kinds = {
        "inputs": Hashed,
    }


class StateValue(Record):
    """An error in one state of the machine.

    * ``value``: The value of the largest size over the volume: of a bounded error its bound.
    * ``bounded``: True if the error is only bounded.
    * ``expanded_uncertainty``: Expanded uncertainty (k = 2), if the machine file states it.
    """

    __slots__ = ()

    value: float
    bounded: bool
    expanded_uncertainty: Union[float, None]


class ErrorRow(Record):
    """An error as found and as left.

    * ``error``: Name of the error.
    * ``unit``: ``um`` or ``urad``.
    * ``found``: As found; ``null`` if the file does not give it.
    * ``left``: As left; ``null`` if the file does not give it.
    """

    __slots__ = ()

    error: str
    unit: str
    found: Union[StateValue, None]
    left: Union[StateValue, None]

    _kinds = {
        "found": StateValue,
        "left": StateValue,
    }


class ErrorCurve(Record):
    """Curve of a component error.

    * ``state``: ``found`` or ``left``.
    * ``error``: Name of the error.
    * ``axis``: Name of the axis.
    * ``unit``: ``um`` or ``urad``.
    * ``position_unit``: ``mm`` or ``deg``.
    * ``positions``: Positions: those of the table, or 21 over the volume.
    * ``forward``: Values approached with rising position.
    * ``reverse``: Values approached with falling position; ``null`` if they are the same.
    * ``expanded_uncertainty``: Expanded uncertainty (k = 2) of the values, if the file states it.
    """

    __slots__ = ()

    state: str
    error: str
    axis: str
    unit: str
    position_unit: str
    positions: list[float]
    forward: list[float]
    reverse: Union[list[float], None]
    expanded_uncertainty: Union[float, None]


class LimitDecision(Record):
    """A decision on a limit, ISO 14253-1.

    * ``name``: Name of the limited value.
    * ``of``: ``found``, ``left`` or the file of figures.
    * ``value``: The value.
    * ``expanded_uncertainty``: Expanded uncertainty (k = 2).
    * ``limit``: The limit.
    * ``unit``: Unit of the three, and of the guard.
    * ``sides``: Sides of the limit.
    * ``guard``: Distance from the limit within which nothing is proven.
    * ``decision``: The decision.
    """

    __slots__ = ()

    name: str
    of: str
    value: float
    expanded_uncertainty: Union[float, None]
    limit: float
    unit: str
    sides: Literal["upper", "both"]
    guard: Union[float, None]
    decision: Literal["conform", "not_conform", "undecided"]


class AlarmLimit(Record):
    """An alarm limit of an error.

    * ``error``: Name of the error.
    * ``limit``: Limit of the absolute value, um or urad.
    * ``unit``: ``um`` or ``urad``.
    """

    __slots__ = ()

    error: str
    limit: float
    unit: str


class RecordedSet(Record):
    """A set of compensation files.

    * ``folder``: Its folder within the record.
    * ``installed``: True if it is in force as left, false if it was replaced.
    * ``target``: The controller.
    * ``files``: Its files, within the record.
    * ``verified_with``: The state of the machine by which it is verified: ``found`` or ``left``; ``null`` for a
      replaced set.
    * ``verify``: Certificate of ``verify``; ``null`` for a replaced set.
    * ``compile``: Certificate that ``compile`` printed, if the description names it.
    """

    __slots__ = ()

    folder: str
    installed: bool
    target: str
    files: list[Hashed]
    verified_with: Union[str, None]
    verify: Any
    compile: Any

    _kinds = {
        "files": Hashed,
    }


class CopiedFile(Record):
    """A copied file.

    * ``source``: Name as the description has it.
    * ``file``: Name within the record.
    * ``bytes``: Size in bytes.
    * ``sha256``: SHA-256 of its bytes, hexadecimal.
    """

    __slots__ = ()

    source: str
    file: str
    bytes: int
    sha256: str


class RecordFields(Record):
    """A record in memory.

    * ``record``: Version of the contract: 1.
    * ``abbe``: Version of the program.
    * ``id``: Unique name of the record.
    * ``dates``: Days.
    * ``language``: Language of the texts.
    * ``country``: Country of the calibration.
    * ``place``: Place of the calibration.
    * ``laboratory``: The laboratory.
    * ``customer``: The customer.
    * ``persons``: Responsible persons.
    * ``machine``: Name of the machine.
    * ``chain``: Its chain.
    * ``plate``: Its plate.
    * ``instruments``: Instruments.
    * ``temperatures``: Temperatures.
    * ``standards``: Standards.
    * ``remarks``: Remarks.
    * ``as_found``: The machine as found.
    * ``as_left``: The machine as left; ``null`` if it was left as found.
    * ``errors``: Every error.
    * ``curves``: Curves of component errors.
    * ``decisions``: Decisions.
    * ``alarms``: Alarm limits for the trend.
    * ``sets``: Sets of compensation files.
    * ``data``: Raw data.
    * ``figures``: Figures: JSON documents of other verbs.
    """

    __slots__ = ()

    record: int
    abbe: str
    id: str
    dates: Dates
    language: str
    country: str
    place: Literal["laboratory", "customer", "laboratoryBranch", "customerBranch", "other"]
    laboratory: Contact
    customer: Contact
    persons: list[Person]
    machine: str
    chain: str
    plate: Plate
    instruments: list[Instrument]
    temperatures: list[Temperature]
    standards: list[str]
    remarks: list[str]
    as_found: MachineState
    as_left: Union[MachineState, None]
    errors: list[ErrorRow]
    curves: list[ErrorCurve]
    decisions: list[LimitDecision]
    alarms: list[AlarmLimit]
    sets: list[RecordedSet]
    data: list[CopiedFile]
    figures: list[CopiedFile]

    _kinds = {
        "dates": Dates,
        "laboratory": Contact,
        "customer": Contact,
        "persons": Person,
        "plate": Plate,
        "instruments": Instrument,
        "temperatures": Temperature,
        "as_found": MachineState,
        "as_left": MachineState,
        "errors": ErrorRow,
        "curves": ErrorCurve,
        "decisions": LimitDecision,
        "alarms": AlarmLimit,
        "sets": RecordedSet,
        "data": CopiedFile,
        "figures": CopiedFile,
    }


class TrendRecord(Record):
    """A record of the line.

    * ``id``: Unique name.
    * ``folder``: The folder.
    * ``dates``: First and last day.
    * ``adjusted``: True if the machine was left otherwise than found.
    """

    __slots__ = ()

    id: str
    folder: str
    dates: Dates
    adjusted: bool

    _kinds = {
        "dates": Dates,
    }


class TrendPoint(Record):
    """An error in a state of a record.

    * ``id``: Unique name of the record.
    * ``day``: The first day for the state as found, the last day for the state as left.
    * ``state``: ``found`` or ``left``.
    * ``value``: The value of the largest size over the volume.
    * ``expanded_uncertainty``: Expanded uncertainty (k = 2), if the machine file states it.
    """

    __slots__ = ()

    id: str
    day: str
    state: str
    value: float
    expanded_uncertainty: Union[float, None]


class ErrorTrend(Record):
    """An error over the records.

    * ``error``: Name of the error.
    * ``unit``: ``um`` or ``urad``.
    * ``alarm_limit``: Alarm limit of the absolute value: that of the newest record that states one.
    * ``alarm``: State of the newest value.
    * ``change``: Newest less oldest value; ``None`` for a single one.
    * ``points``: The values, oldest first.
    """

    __slots__ = ()

    error: str
    unit: str
    alarm_limit: Union[float, None]
    alarm: Literal["below", "alarm", "none"]
    change: Union[float, None]
    points: list[TrendPoint]

    _kinds = {
        "points": TrendPoint,
    }


class PropertyDifference(Record):
    """A property in which two machines differ.

    * ``kind``: ``chain``, ``direction``, ``origin``, ``sense``, ``travel``, ``tool``, ``workpiece``, ``conventions``,
      ``setup``, ``class``, ``tolerances`` or ``error``.
    * ``name``: Name of the axis or error; empty where the property is the machine's.
    * ``first``: Value of the first machine, in words: of an error the largest absolute value over the volume.
    * ``second``: Value of the second.
    * ``largest``: Of an error: the largest absolute difference over the volume, um or urad.
    * ``minus_first_um``: Change of the 95 % position deviation of the first machine by this difference alone, um: of
      the chain on the first machine, of all others on the first with the chain of the second. ``None`` where no
      deviation depends on it, and where an error curve of the second does not cover the travel of the first.
    """

    __slots__ = ()

    kind: str
    name: str
    first: str
    second: str
    largest: Union[float, None]
    minus_first_um: Union[float, None]

    _optional = frozenset({
        "largest",
    })


class DiffFields(Record):
    """Two machines against each other.

    * ``machines``: Name of each machine.
    * ``files``: File of each machine.
    * ``asked``: Number of tool poses asked for.
    * ``poses``: Number of tool poses that both machines reach, with every difference by itself too.
    * ``seed``: Seed of the tool poses.
    * ``p95_um``: 95 % position deviation of each machine at these tool poses, um.
    * ``minus_first_um``: Second less first.
    * ``differences``: The chain first, then geometry, conventions and errors joint by joint.
    """

    __slots__ = ()

    machines: list[str]
    files: list[str]
    asked: int
    poses: int
    seed: int
    p95_um: list[float]
    minus_first_um: float
    differences: list[PropertyDifference]

    _kinds = {
        "differences": PropertyDifference,
    }


class TrendStep(Record):
    """What changed from a record to the next: the machine as it was left against the machine as it was found.

    * ``from``: The earlier record.
    * ``to``: The later record.
    * ``difference``: The difference of the machines, as ``diff`` states it.
    """

    __slots__ = ()

    to: str
    difference: DiffFields

    _kinds = {
        "difference": DiffFields,
    }


class TrendFields(Record):
    """Records in a line.

    * ``machine``: Name of the machine in the newest record.
    * ``serial``: Its serial number.
    * ``records``: The records, oldest first.
    * ``errors``: Every error that a record gives a value.
    * ``steps``: What changed between neighbours.
    """

    __slots__ = ()

    machine: str
    serial: str
    errors: list[ErrorTrend]
    steps: list[TrendStep]

    _kinds = {
        "records": TrendRecord,
        "errors": ErrorTrend,
        "steps": TrendStep,
    }


class CertifiedFigures(Record):
    """Figures of a certificate.

    * ``position_um``: Deviation of the functional point, um.
    * ``rotation_urad``: Rotation of the tool, urad.
    * ``tool_axis_urad``: Tilt of the tool axis, urad.
    """

    __slots__ = ()

    position_um: Summary
    rotation_urad: Summary
    tool_axis_urad: Summary

    _kinds = {
        "position_um": Summary,
        "rotation_urad": Summary,
        "tool_axis_urad": Summary,
    }


class CertifiedError(Record):
    """An error in a certificate.

    * ``handled``: Degree to which the files correct it.
    * ``left_um``: 95 % position deviation that the files leave of it alone, um.
    * ``alone_um``: The same without the files, um.
    """

    __slots__ = ()

    handled: Literal["fully", "partly", "no"]
    left_um: float
    alone_um: float


class AtReference(Record):
    """What files add with all axes at 0, by axis, mm and deg.

    * ``forward``: Approached forward.
    * ``reverse``: Approached in reverse.
    """

    __slots__ = ()

    forward: Named[float]
    reverse: Named[float]

    _kinds = {
        "forward": Names(None),
        "reverse": Names(None),
    }


class RaisedShape(Record):
    """A figure that files raise.

    * ``direction``: The side of approach.
    * ``figure``: Name of the figure.
    * ``before_um``: Its value without the files, um.
    * ``after_um``: Its value with the files, um.
    """

    __slots__ = ()

    direction: Literal["mean", "forward", "reverse"]
    figure: str
    before_um: float
    after_um: float


class ReferenceShift(Record):
    """Displacement of the reference.

    * ``shift_um``: Of the linear axes, um.
    * ``shift_urad``: Of the rotary axes, urad.
    * ``position_um``: Position deviation with it, um.
    * ``without_tables_um``: Position deviation by it alone, um.
    """

    __slots__ = ()

    shift_um: Named[float]
    shift_urad: Named[float]
    position_um: Summary
    without_tables_um: Summary

    _kinds = {
        "shift_um": Names(None),
        "shift_urad": Names(None),
        "position_um": Summary,
        "without_tables_um": Summary,
    }


class ProgrammingShape(Record):
    """Figures for one form of the tool direction.

    * ``tool_direction``: ``vector`` or ``rotary axes``.
    * ``longer_mm``: Added to the length of the tool, mm.
    * ``uncompensated``: Without the files.
    * ``compensated``: With the files.
    """

    __slots__ = ()

    tool_direction: str
    longer_mm: float
    uncompensated: CertifiedFigures
    compensated: CertifiedFigures

    _kinds = {
        "uncompensated": CertifiedFigures,
        "compensated": CertifiedFigures,
    }


class StepShape(Record):
    """Figures after a step of a composed set.

    * ``target``: Names of the targets so far.
    * ``compensated``: With their files.
    """

    __slots__ = ()

    target: str
    compensated: CertifiedFigures

    _kinds = {
        "compensated": CertifiedFigures,
    }


class CertificateBands(Record):
    """Intervals of the figures of a certificate.

    * ``uncompensated``: Without the files.
    * ``compensated``: With them: what the uncertainty of the errors leaves, whatever the files correct.
    """

    __slots__ = ()

    uncompensated: Bands
    compensated: Bands

    _kinds = {
        "uncompensated": Bands,
        "compensated": Bands,
    }


class CertificateFields(Record):
    """A machine after a controller has applied its files.

    * ``target``: Name of the target.
    * ``files``: Names of the files.
    * ``poses``: Number of poses.
    * ``direction``: The side of approach that is worse.
    * ``tool``: Name of the tool; may be empty.
    * ``uncompensated``: Without the files.
    * ``compensated``: With the files.
    * ``errors``: The errors by name.
    * ``single_error_poses``: Number of poses for single errors.
    * ``at_reference``: What the files add with all axes at 0.
    * ``cannot``: Errors that the controller cannot correct, in words.
    * ``raised``: Figures that the files raise.
    * ``reference_shift``: Displacement of the reference that the controller does not see; none for most.
    * ``programming``: Figures for each form of the tool direction, where the controller transforms.
    * ``steps``: Figures after each step of a composed set.
    * ``uncertainty``: Intervals of the figures, where the machine file states uncertainties of errors.
    """

    __slots__ = ()

    target: str
    files: list[str]
    poses: int
    direction: Literal["mean", "forward", "reverse"]
    tool: str
    uncompensated: CertifiedFigures
    compensated: CertifiedFigures
    errors: Named[CertifiedError]
    single_error_poses: int
    at_reference: AtReference
    cannot: list[str]
    raised: list[RaisedShape]
    reference_shift: Union[ReferenceShift, None]
    programming: Union[list[ProgrammingShape], None]
    steps: Union[list[StepShape], None]
    uncertainty: Union[CertificateBands, None]

    _kinds = {
        "uncompensated": CertifiedFigures,
        "compensated": CertifiedFigures,
        "errors": Names(CertifiedError),
        "at_reference": AtReference,
        "raised": RaisedShape,
        "reference_shift": ReferenceShift,
        "programming": ProgrammingShape,
        "steps": StepShape,
        "uncertainty": CertificateBands,
    }

    _optional = frozenset({
        "programming",
        "steps",
        "uncertainty",
    })


class SetDiffFields(Record):
    """Second set less the first.

    * ``axes``: By axis, in the order of the chain.
    * ``position_um``: Displacement of the functional point, um.
    """

    __slots__ = ()

    axes: Named[Named[float]]
    position_um: Summary

    _kinds = {
        "axes": Names(Names(None)),
        "position_um": Summary,
    }


class ReportFields(Record):
    """Size of a page.

    * ``bytes``: Number of its bytes.
    """

    __slots__ = ()

    bytes: int


class Arm(Record):
    """A lever arm, mm.

    * ``at_zero``: At the zero pose.
    * ``longest``: The longest over the volume.
    * ``share``: Fraction of the sum of squares of all errors, each by itself, that the angular errors of the axis make
      over the volume, at their values or bounds. None without errors.
    """

    __slots__ = ()

    at_zero: float
    longest: float
    share: Union[float, None]


class OtherSide(Record):
    """Geometry of an axis for the side on which it does not stand, the other axes staying where they are.

    * ``side``: The other branch.
    * ``direction``: Unit vector.
    * ``origin_mm``: Point about which angular errors turn, mm.
    * ``travel``: Limits in the unit of the axis; 0 and 360 for a continuous axis.
    * ``continuous``: True if the axis turns without end.
    """

    __slots__ = ()

    side: Literal["workpiece", "tool"]
    direction: list[float]
    origin_mm: list[float]
    travel: list[float]
    continuous: bool


class ChainAxis(Record):
    """An axis of a chain, in machine coordinates at the zero pose.

    * ``name``: Name of the axis.
    * ``kind``: Linear or rotary.
    * ``side``: The branch that the axis stands on.
    * ``sense``: Sense of the positive direction.
    * ``direction``: Unit vector.
    * ``origin_mm``: Point about which angular errors turn, mm.
    * ``travel``: Limits in ``unit``; 0 and 360 for a continuous axis.
    * ``continuous``: True if the axis turns without end.
    * ``unit``: ``mm`` or ``deg``.
    * ``arm_mm``: Arms from the point about which angular errors turn to the functional point.
    * ``geometry_stated``: True if the file states the geometry for the side on which the axis stands.
    * ``other_side``: Geometry that the file states for the other side.
    """

    __slots__ = ()

    name: str
    kind: Literal["linear", "rotary"]
    side: Literal["workpiece", "tool"]
    sense: Literal["iso841", "direct"]
    direction: list[float]
    origin_mm: list[float]
    travel: list[float]
    continuous: bool
    unit: str
    arm_mm: Arm
    geometry_stated: bool
    other_side: Union[OtherSide, None]

    _kinds = {
        "arm_mm": Arm,
        "other_side": OtherSide,
    }


class ChainTool(Record):
    """A tool, in machine coordinates at the zero pose.

    * ``name``: Name of the tool; may be empty.
    * ``gauge_mm``: Gauge point, mm.
    * ``tip_mm``: Functional point, mm.
    * ``direction``: Unit vector of its axis, from the tip towards the spindle.
    """

    __slots__ = ()

    name: str
    gauge_mm: list[float]
    tip_mm: list[float]
    direction: list[float]


class LocationError(Record):
    """A location error that a chain needs.

    * ``error``: Name of the error.
    * ``status``: Status of its value.
    """

    __slots__ = ()

    error: str
    status: Literal["given", "bounded", "covered", "missing"]


class LocationErrors(Record):
    """The location errors of a chain.

    * ``set``: Those that the chain needs.
    * ``besides``: Names of those that are given besides.
    """

    __slots__ = ()

    set: list[LocationError]
    besides: list[str]

    _kinds = {
        "set": LocationError,
    }


class InputFile(Record):
    """A file that a machine was read from.

    * ``file``: Its path, as it was named.
    * ``sha256``: SHA-256 of its text, hexadecimal.
    * ``outside``: True if it is outside the folder of the machine file, links resolved.
    """

    __slots__ = ()

    file: str
    sha256: str
    outside: bool


class ChainResult(Record):
    """The kinematic chain of a machine.

    * ``machine``: Name of the machine.
    * ``chain``: The chain from workpiece to tool, such as ``w C' A' Y' b X Z t``.
    * ``axes``: The axes in the order of the chain.
    * ``tools``: The tools.
    * ``workpiece_origin_mm``: Origin of the workpiece in machine coordinates at the zero pose, mm.
    * ``workpiece_rotation_deg``: Angles A, B, C by which the workpiece's coordinates are turned about X, then Y, then Z
      of the machine, deg.
    * ``conventions``: The conventions in force.
    * ``location_errors``: The location errors.
    * ``inputs``: The files that the machine was read from.
    """

    __slots__ = ()

    machine: str
    chain: str
    axes: list[ChainAxis]
    tools: list[ChainTool]
    workpiece_origin_mm: list[float]
    workpiece_rotation_deg: list[float]
    conventions: Conventions
    location_errors: LocationErrors
    inputs: list[InputFile]

    _kinds = {
        "axes": ChainAxis,
        "tools": ChainTool,
        "conventions": Conventions,
        "location_errors": LocationErrors,
        "inputs": InputFile,
    }


class AxisSummary(Record):
    """An axis in short.

    * ``name``: Name of the axis.
    * ``kind``: Linear or rotary.
    * ``branch``: The branch that the axis is on.
    * ``direction``: Unit vector in machine coordinates at the zero pose.
    * ``origin``: Point about which angular errors turn, in machine coordinates at the zero pose, mm.
    * ``continuous``: True if the axis turns without end.
    * ``travel``: Limits in ``unit``; 0 and 360 for a continuous axis.
    * ``unit``: ``mm`` or ``deg``.
    * ``arm_mm``: Arms from the point about which angular errors turn to the functional point, and what hangs on them.
    """

    __slots__ = ()

    name: str
    kind: Literal["linear", "rotary"]
    branch: Literal["workpiece", "tool"]
    direction: list[float]
    origin: list[float]
    continuous: bool
    travel: list[float]
    unit: str
    arm_mm: Arm

    _kinds = {
        "arm_mm": Arm,
    }


class ErrorCounts(Record):
    """Counts of the errors of a machine.

    * ``location``: Location errors with a value.
    * ``component``: Component errors with a value.
    * ``tolerance``: Errors of which only a bound is known.
    """

    __slots__ = ()

    location: int
    component: int
    tolerance: int


class MachineSummary(Record):
    """A machine in short, as ``check`` prints it.

    * ``machine``: Name of the machine.
    * ``chain``: The kinematic chain from workpiece to tool, such as ``w C' A' Y' b X Z t``.
    * ``axes``: The axes in the order of the chain.
    * ``tools``: Names of the tools; empty for a tool without a name.
    * ``conventions``: The conventions in force.
    * ``errors``: Counts of the errors.
    * ``inputs``: The files that the machine was read from.
    """

    __slots__ = ()

    machine: str
    chain: str
    axes: list[AxisSummary]
    tools: list[str]
    conventions: Conventions
    errors: ErrorCounts
    inputs: list[InputFile]

    _kinds = {
        "axes": AxisSummary,
        "conventions": Conventions,
        "errors": ErrorCounts,
        "inputs": InputFile,
    }


class SixErrors(Record):
    """Six errors; displacements in mm, rotations in rad.

    * ``EX``: Displacement along X.
    * ``EY``: Displacement along Y.
    * ``EZ``: Displacement along Z.
    * ``EA``: Rotation about X.
    * ``EB``: Rotation about Y.
    * ``EC``: Rotation about Z.
    """

    __slots__ = ()

    EX: float
    EY: float
    EZ: float
    EA: float
    EB: float
    EC: float


class Units(Record):
    """Fields of Units.

    * ``length``:
    * ``angle``:
    """

    __slots__ = ()

    length: str
    angle: str


class ClassifyFields(Record):
    """A matrix over the dual numbers, classified.

    * ``admissible``:
    * ``rotation``: Rotation of N, row by row.
    * ``translation_mm``: Translation of N, mm.
    * ``errors_before``: Errors on the left of N: mm and rad.
    * ``errors_after``: Errors on the right of N: mm and rad.
    * ``units``:
    * ``reason``: The reason.
    """

    __slots__ = ()

    admissible: bool
    rotation: Union[list[list[float]], None]
    translation_mm: Union[list[float], None]
    errors_before: Union[SixErrors, None]
    errors_after: Union[SixErrors, None]
    units: Union[Units, None]
    reason: Union[str, None]

    _kinds = {
        "errors_before": SixErrors,
        "errors_after": SixErrors,
        "units": Units,
    }

    _optional = frozenset({
        "rotation",
        "translation_mm",
        "errors_before",
        "errors_after",
        "units",
        "reason",
    })


class CheckRecordFields(Record):
    """A record that is as it was written.

    * ``folder``: The folder.
    * ``files``: Number of files that are as the list states.
    * ``replaced_sets``: Number of sets that ``compile --record`` archived beside them, whole by their manifests.
    * ``unlisted``: Files that no list names.
    * ``sha256``: SHA-256 of the list itself: who notes it elsewhere notices a change of any file.
    """

    __slots__ = ()

    folder: str
    files: int
    replaced_sets: int
    unlisted: list[str]
    sha256: str


class TargetCertainty(Record):
    """Certainty of a fact, with its source.

    * ``level``: Level in a word.
    * ``source``: The source.
    """

    __slots__ = ()

    level: str
    source: str


class TargetSummary(Record):
    """A controller in short.

    * ``target``: Name for ``compile``.
    * ``title``: The controller's own name.
    * ``mechanism``: Mechanisms of compensation, separated by spaces.
    * ``expresses``: Errors that it corrects, in words.
    * ``cannot``: Errors that it cannot correct, in words.
    * ``limits``: Limits of its tables, in words.
    * ``sign_test``: A test of the sign at the machine.
    * ``syntax``: Certainty of the syntax.
    * ``sign``: Certainty of the sign.
    """

    __slots__ = ()

    target: str
    title: str
    mechanism: str
    expresses: str
    cannot: list[str]
    limits: str
    sign_test: str
    syntax: TargetCertainty
    sign: TargetCertainty

    _kinds = {
        "syntax": TargetCertainty,
        "sign": TargetCertainty,
    }
