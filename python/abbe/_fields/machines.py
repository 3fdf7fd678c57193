"""Fields of results by type. python/generate.py writes this file from the results of the façade."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Union

from .._record import Named, Record
from .deviations import Over, PathResult


class Arm(Record):
    """A lever arm, mm."""

    at_zero: Annotated[float, "At the zero pose."]
    longest: Annotated[float, "The longest over the volume."]
    share: Annotated[Union[float, None], "Fraction of the sum of squares of all errors, each by itself, that the angular errors of the axis make over the volume, at their values or bounds. None without errors."]


class OtherSide(Record):
    """Geometry of an axis for the side on which it does not stand, the other axes staying where they are."""

    side: Annotated[Literal["workpiece", "tool"], "The other branch."]
    direction: Annotated[list[float], "Unit vector."]
    origin_mm: Annotated[list[float], "Point about which angular errors turn, mm."]
    travel: Annotated[list[float], "Limits in the unit of the axis; 0 and 360 for a continuous axis."]
    continuous: Annotated[bool, "True if the axis turns without end."]


class ChainAxis(Record):
    """An axis of a chain, in machine coordinates at the zero pose."""

    name: Annotated[str, "Name of the axis."]
    kind: Annotated[Literal["linear", "rotary"], "Linear or rotary."]
    side: Annotated[Literal["workpiece", "tool"], "The branch that the axis stands on."]
    sense: Annotated[Literal["iso841", "direct"], "Sense of the positive direction."]
    direction: Annotated[list[float], "Unit vector."]
    origin_mm: Annotated[list[float], "Point about which angular errors turn, mm."]
    travel: Annotated[list[float], "Limits in ``unit``; 0 and 360 for a continuous axis."]
    continuous: Annotated[bool, "True if the axis turns without end."]
    unit: Annotated[str, "``mm`` or ``deg``."]
    arm_mm: Annotated[Arm, "Arms from the point about which angular errors turn to the functional point."]
    geometry_stated: Annotated[bool, "True if the file states the geometry for the side on which the axis stands."]
    other_side: Annotated[Union[OtherSide, None], "Geometry that the file states for the other side."]


class ChainTool(Record):
    """A tool, in machine coordinates at the zero pose."""

    name: Annotated[str, "Name of the tool; may be empty."]
    gauge_mm: Annotated[list[float], "Gauge point, mm."]
    tip_mm: Annotated[list[float], "Functional point, mm."]
    direction: Annotated[list[float], "Unit vector of its axis, from the tip towards the spindle."]


class ChainMesh(Record):
    """A mesh that a body is drawn by."""

    body: Annotated[str, "``bed``, ``workpiece``, ``tool``, or the name of an axis."]
    file: Annotated[str, "Path of its file."]
    unit_mm: Annotated[Union[float, None], "Unit of its coordinates, mm; null for that of its format."]
    origin_mm: Annotated[list[float], "Place of its origin, mm."]
    rotation_deg: Annotated[list[float], "Angles A, B, C by which it is turned about X, then Y, then Z, deg."]


class Conventions(Record):
    """The conventions in force for a machine."""

    location: Annotated[Literal["axis_only", "carried_body"], "The action of location errors."]
    linear: Annotated[Literal["after", "before"], "Component errors of linear axes."]
    rotary: Annotated[Literal["stationary", "rotating"], "Component errors of rotary axes."]
    workpiece_axes: Annotated[Literal["iso841", "direct"], "Sense of workpiece-side axes."]
    errors_are: Annotated[Literal["tool_relative", "body"], "Owner of the errors of workpiece-side axes."]
    location_order: Annotated[Literal["nilpotent", "real"], "Order of location errors."]
    joints: Annotated[Literal["orthogonal", "linearised"], "Shape of error matrices."]
    default_order: Annotated[Union[int, None], "Order used when the command line names none (``hrdina-vasik-2014`` is of order 1, ``holub-2015`` of order 2); ``None`` is exact."]


class LocationError(Record):
    """A location error that a chain needs."""

    error: Annotated[str, "Name of the error."]
    status: Annotated[Literal["given", "bounded", "covered", "missing"], "Status of its value."]


class LocationErrors(Record):
    """The location errors of a chain."""

    set: Annotated[list[LocationError], "Those that the chain needs."]
    besides: Annotated[list[str], "Names of those that are given besides."]


class InputFile(Record):
    """A file that a machine was read from."""

    file: Annotated[str, "Its path, as it was named."]
    sha256: Annotated[str, "SHA-256 of its text, hexadecimal."]
    outside: Annotated[bool, "True if it is outside the folder of the machine file, links resolved."]


class ChainResult(Record):
    """The kinematic chain of a machine."""

    machine: Annotated[str, "Name of the machine."]
    chain: Annotated[str, "The chain from workpiece to tool, such as ``w C' A' Y' b X Z t``."]
    axes: Annotated[list[ChainAxis], "The axes in the order of the chain."]
    tools: Annotated[list[ChainTool], "The tools."]
    workpiece_origin_mm: Annotated[list[float], "Origin of the workpiece in machine coordinates at the zero pose, mm."]
    workpiece_rotation_deg: Annotated[list[float], "Angles A, B, C by which the workpiece's coordinates are turned about X, then Y, then Z of the machine, deg."]
    up: Annotated[Union[list[float], None], "Unit vector upwards in the picture, in machine coordinates; none where the file states none."]
    look: Annotated[list[ChainMesh], "Meshes that bodies are drawn by."]
    conventions: Annotated[Conventions, "The conventions in force."]
    location_errors: Annotated[LocationErrors, "The location errors."]
    inputs: Annotated[list[InputFile], "The files that the machine was read from."]


class AxisSummary(Record):
    """An axis in short."""

    name: Annotated[str, "Name of the axis."]
    kind: Annotated[Literal["linear", "rotary"], "Linear or rotary."]
    branch: Annotated[Literal["workpiece", "tool"], "The branch that the axis is on."]
    direction: Annotated[list[float], "Unit vector in machine coordinates at the zero pose."]
    origin: Annotated[list[float], "Point about which angular errors turn, in machine coordinates at the zero pose, mm."]
    continuous: Annotated[bool, "True if the axis turns without end."]
    travel: Annotated[list[float], "Limits in ``unit``; 0 and 360 for a continuous axis."]
    measured: Annotated[Union[list[float], None], "Range in which its curves were measured, in ``unit``, where it is less than the travel."]
    unit: Annotated[str, "``mm`` or ``deg``."]
    arm_mm: Annotated[Arm, "Arms from the point about which angular errors turn to the functional point, and what hangs on them."]


class ErrorCounts(Record):
    """Counts of the errors of a machine."""

    location: Annotated[int, "Location errors with a value."]
    component: Annotated[int, "Component errors with a value."]
    tolerance: Annotated[int, "Bounds that the file states: of errors, of axes and of squareness."]


class Coverage(Record):
    """Counts of the known errors among those that act in a machine's own chain: six of each axis, and the location errors that are no choice of coordinates."""

    valued: Annotated[int, "Number of errors with a value that no bound stands for."]
    bounded: Annotated[int, "Number of errors that are bounded, by the file or by a class."]
    missing: Annotated[list[str], "Names of the errors that have neither. None on a machine with measured values and no bounds: what it does not state is zero."]


class MachineSummary(Record):
    """A machine in short, as ``check`` prints it."""

    machine: Annotated[str, "Name of the machine."]
    chain: Annotated[str, "The kinematic chain from workpiece to tool, such as ``w C' A' Y' b X Z t``."]
    axes: Annotated[list[AxisSummary], "The axes in the order of the chain."]
    tools: Annotated[list[str], "Names of the tools; empty for a tool without a name."]
    conventions: Annotated[Conventions, "The conventions in force."]
    errors: Annotated[ErrorCounts, "Counts of the errors."]
    coverage: Annotated[Coverage, "Which of the errors that act are known, by the file and the class that it names."]
    inputs: Annotated[list[InputFile], "The files that the machine was read from."]


class SixErrors(Record):
    """Six errors; displacements in mm, rotations in rad."""

    EX: Annotated[float, "Displacement along X."]
    EY: Annotated[float, "Displacement along Y."]
    EZ: Annotated[float, "Displacement along Z."]
    EA: Annotated[float, "Rotation about X."]
    EB: Annotated[float, "Rotation about Y."]
    EC: Annotated[float, "Rotation about Z."]


class ErrorPart(Record):
    """A coefficient of an error matrix."""

    rotation: Annotated[list[list[float]], "Skew matrix, rad."]
    displacement_mm: Annotated[Union[list[float], None], "Displacement, mm; none of a rotation."]


class ErrorsOfDegree(Record):
    """The errors of one degree."""

    degree: Annotated[int, "Power of i."]
    before: Annotated[ErrorPart, "Errors on the left of N."]
    after: Annotated[ErrorPart, "Errors on the right of N."]


class ErrorClass(Record):
    """The error class I^A of an orthogonal matrix A: all B with A^T B skew."""

    dimension: Annotated[int, "Dimension over the reals."]
    basis: Annotated[list[list[list[float]]], "A basis, each matrix row by row."]
    is_lie_algebra: Annotated[bool, "True if it is closed under the commutator."]
    reason: Annotated[str, "The reason."]


class Lemma(Record):
    """A statement of a paper at one matrix."""

    statement: Annotated[str, "The statement, with its number in the paper."]
    holds: Annotated[bool, "True if it holds for this matrix."]
    reason: Annotated[str, "The reason, with what was computed."]


class Units(Record):
    """Fields of Units."""

    length: Annotated[str, ""]
    angle: Annotated[str, ""]


class ClassifyFields(Record):
    """A matrix over the dual numbers, classified."""

    admissible: Annotated[bool, ""]
    group: Annotated[Union[str, None], "``SO(3, D_2)`` of rotations, ``SE(3, D)`` of motions."]
    rotation: Annotated[Union[list[list[float]], None], "Rotation of N, row by row."]
    translation_mm: Annotated[Union[list[float], None], "Translation of N, mm; none of a rotation."]
    errors_before: Annotated[Union[SixErrors, None], "Errors of degree 1 on the left of N: mm and rad; of motions of space."]
    errors_after: Annotated[Union[SixErrors, None], "Errors of degree 1 on the right of N: mm and rad; of motions of space."]
    degrees: Annotated[Union[list[ErrorsOfDegree], None], "The errors of every degree: E = exp(W), of motions with a displacement."]
    error_class: Annotated[Union[ErrorClass, None], "The error class I^A of the rotation."]
    lemmas: Annotated[Union[list[Lemma], None], "Statements of the papers at this matrix."]
    units: Annotated[Union[Units, None], ""]
    reason: Annotated[Union[str, None], "The reason."]


class ConvertedError(Record):
    """An error with another value, or another curve."""

    name: Annotated[str, "Name such as ``EC0Y``, ``EXX``, ``workpiece.A``."]
    before: Annotated[Union[float, None], "Constant before, in ``unit``; none for a curve."]
    after: Annotated[Union[float, None], "Constant after, in ``unit``; none for a curve."]
    unit: Annotated[Union[str, None], "``um`` or ``urad``; none for a curve."]
    curve: Annotated[Union[bool, None], "True for a curve."]


class MisfitSize(Record):
    """An error that no curve of the language holds exactly."""

    name: Annotated[str, "Name of the error."]
    off: Annotated[float, "Largest difference of the curve written, mm or rad."]


class ConversionProof(Record):
    """The comparison of both machines by the exact model, from every direction of approach."""

    grid_poses: Annotated[int, "Poses on a grid over the volume."]
    random_poses: Annotated[int, "Random poses over the travels."]
    position_mm: Annotated[float, "Largest difference of the functional point, mm."]
    rotation_rad: Annotated[float, "Largest difference of the orientation, rad."]
    bound_mm: Annotated[float, "Difference of the functional point that was accepted, mm."]
    bound_rad: Annotated[float, "Difference of the orientation that was accepted, rad."]


class ConvertFields(Record):
    """A converted machine with its proof."""

    conventions: Annotated[Conventions, "The new conventions."]
    changed: Annotated[list[str], "The conventions that changed, in words."]
    errors: Annotated[list[ConvertedError], "The errors that changed."]
    misfits: Annotated[list[MisfitSize], "Errors that no curve of the language holds exactly."]
    proof: Annotated[ConversionProof, "The comparison of both machines."]


class PropertyDifference(Record):
    """A property in which two machines differ."""

    kind: Annotated[str, "``chain``, ``direction``, ``origin``, ``sense``, ``travel``, ``tool``, ``workpiece``, ``conventions``, ``setup``, ``class``, ``tolerances`` or ``error``."]
    name: Annotated[str, "Name of the axis or error; empty where the property is the machine's."]
    first: Annotated[str, "Value of the first machine, in words: of an error the largest absolute value over the volume."]
    second: Annotated[str, "Value of the second."]
    largest: Annotated[Union[float, None], "Of an error: the largest absolute difference over the volume, um or urad."]
    minus_first_um: Annotated[Union[float, None], "Change of the 95 % position deviation of the first machine by this difference alone, um: of the chain on the first machine, of all others on the first with the chain of the second. ``None`` where no deviation depends on it, and where an error curve of the second does not cover the travel of the first."]


class DiffFields(Record):
    """Two machines against each other."""

    machines: Annotated[list[str], "Name of each machine."]
    files: Annotated[list[str], "File of each machine."]
    over: Annotated[Over, "Poses and reference of the difference."]
    paths: Annotated[Union[list[PathResult], None], "Events of the path on each machine, where the tool poses are one."]
    asked: Annotated[int, "Number of tool poses asked for."]
    poses: Annotated[int, "Number of tool poses that both machines reach, and most differences by themselves: one that reaches less than nine tenths of them is judged on what it reaches."]
    seed: Annotated[int, "Seed of the tool poses."]
    p95_um: Annotated[list[float], "95 % position deviation of each machine at these tool poses, um."]
    minus_first_um: Annotated[float, "Second less first."]
    differences: Annotated[list[PropertyDifference], "The chain first, then geometry, conventions and errors joint by joint."]


class EquationUnits(Record):
    """Units of closed forms."""

    length: Annotated[str, "``mm``."]
    angle: Annotated[str, "``rad``."]


class EquationSymbol(Record):
    """A symbol of closed forms."""

    symbol: Annotated[str, "As it stands in the text."]
    kind: Annotated[str, "``error``, ``parameter``, ``position``, ``sine``, ``cosine`` or ``tool_length``."]
    of: Annotated[str, "Name of the error or axis."]
    sign: Annotated[float, "1 or -1."]
    latex: Annotated[str, "As LaTeX."]


class PolynomialTerm(Record):
    """A term of a polynomial."""

    coefficient: Annotated[float, "Its number."]
    powers: Annotated[Named[int], "Powers by symbol."]
    order: Annotated[int, "Its order in the errors."]


class Polynomial(Record):
    """A polynomial in the symbols."""

    text: Annotated[str, "As text."]
    terms: Annotated[list[PolynomialTerm], "Its terms."]


class MatrixFactor(Record):
    """A factor of the matrix of a joint."""

    name: Annotated[str, "``N``, ``E``, ``E^-1``, ``Loc``, ``Loc^-1``, ``Loc N Loc^-1``, ``T(o)`` and ``T(-o)`` with o the origin of the axis."]
    matrix: Annotated[list[list[Polynomial]], "The matrix."]


class EquationsFields(Record):
    """The closed forms of a machine; mm and rad, workpiece frame."""

    machine: Annotated[str, "Name of the machine."]
    degree: Annotated[int, "Degree of the algebra."]
    frame: Annotated[Literal["workpiece", "machine", "tool"], "Frame of the vectors: the workpiece frame."]
    units: Annotated[EquationUnits, "Units of lengths and angles."]
    symbols: Annotated[list[EquationSymbol], "The symbols."]
    joints: Annotated[Named[list[list[Polynomial]]], "The matrix of each joint."]
    factors: Annotated[Union[Named[list[MatrixFactor]], None], "The factors of these matrices in their order, with ``factors``."]
    t_tool: Annotated[list[list[Polynomial]], "From the bed to the tool."]
    t_work: Annotated[list[list[Polynomial]], "From the bed to the workpiece."]
    e_ve: Annotated[list[list[Polynomial]], "The volumetric error E_VE."]
    deviation: Annotated[list[Polynomial], "Displacement of the functional point."]
    rotation: Annotated[list[Polynomial], "Rotation of the tool."]
