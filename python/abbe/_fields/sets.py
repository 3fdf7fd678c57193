"""Fields of results by type. python/generate.py writes this file from the results of the façade."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Union

from .._record import Named, Record
from .deviations import Bands, Over, Summary
from .machines import DiffFields
from .measurements import JudgedReading, SeenCorrection, SetUpValue


class CertifiedFigures(Record):
    """Figures of a certificate: statistics of a field over poses."""

    position_um: Annotated[Summary, "Deviation of the functional point, um."]
    rotation_urad: Annotated[Summary, "Rotation of the tool, urad."]
    tool_axis_urad: Annotated[Summary, "Tilt of the tool axis, urad."]


class DrawnRepair(Record):
    """Fractions that files take off the figure that decides, over machines drawn between bounds: 1 is all of it."""

    machines: Annotated[int, "Number of machines drawn."]
    least: Annotated[float, "The least."]
    median: Annotated[float, "The median; of an even number the lower one."]
    most: Annotated[float, "The most."]


class TargetResidual(Record):
    """The errors that the files of a target leave."""

    target: Annotated[str, "Its name; of kinematic parameters with tables for what they leave ``A+B``."]
    expresses: Annotated[str, "Errors that it corrects, in words."]
    syntax: Annotated[list[str], "Certainty of the format of each, in a word."]
    over: Annotated[Over, "Poses and reference of the figures."]
    uncompensated: Annotated[CertifiedFigures, "Without the files."]
    compensated: Annotated[CertifiedFigures, "With the files."]
    drawn: Annotated[Union[DrawnRepair, None], "Fractions that the files take off drawn machines, where errors are only bounded; the figures are then those of the machine with the median."]
    remarks: Annotated[list[str], "Warnings of the files, such as that the scale in force is not known."]


class RefusedTarget(Record):
    """A target that has no files for a machine."""

    target: Annotated[str, "Its name."]
    code: Annotated[str, "Code of the diagnostic."]
    why: Annotated[str, "The reason."]


class TargetsFields(Record):
    """The targets that are for a machine, the one that leaves least first, and those that are not."""

    machine: Annotated[str, "Name of the machine."]
    targets: Annotated[list[TargetResidual], "Those with files for the machine."]
    refused: Annotated[list[RefusedTarget], "Those without."]


class ReferenceShift(Record):
    """Displacement of the reference."""

    shift_um: Annotated[Named[float], "Shifts of the linear axes, um."]
    shift_urad: Annotated[Named[float], "Shifts of the rotary axes, urad."]
    position_um: Annotated[Summary, "Position deviation with it, um."]
    without_tables_um: Annotated[Summary, "Position deviation by it alone, um."]


class RaisedFigure(Record):
    """A figure of the position deviation that the files raise."""

    direction: Annotated[Literal["mean", "forward", "reverse"], "The side of approach."]
    figure: Annotated[str, "Name of the figure."]
    before_um: Annotated[float, "Its value without the files, um."]
    after_um: Annotated[float, "Its value with the files, um."]


class CertifiedError(Record):
    """An error in a certificate."""

    handled: Annotated[Literal["fully", "partly", "no"], "Degree to which the files correct it."]
    left_um: Annotated[float, "95 % position deviation that the files leave of it alone, um."]
    alone_um: Annotated[float, "The same without the files, um."]


class AtReference(Record):
    """Motions that files add at home, or with all axes at 0, by axis, mm and deg."""

    forward: Annotated[Named[float], "Approached forward."]
    reverse: Annotated[Named[float], "Approached in reverse."]


class ProgrammingFigures(Record):
    """Figures of a controller's transformation for one way to program the tool and one tool."""

    tool_direction: Annotated[Literal["vector", "rotary axes"], "The way in which blocks program the direction of the tool."]
    tool: Annotated[str, "Name of the tool in the machine file, empty for the only one."]
    longer_mm: Annotated[float, "Length by which the tool is longer than that of the machine file, mm."]
    uncompensated: Annotated[CertifiedFigures, "Figures without the parameters."]
    compensated: Annotated[CertifiedFigures, "Figures with them."]
    at_poles: Annotated[int, "The number of poses at a pole, where the controller keeps an axis."]
    away_from_poles: Annotated[Union[CertifiedFigures, None], "Figures with them without those poses; ``None`` if there are none, or no others."]


class DriveDemand(Record):
    """The largest demand on the drive of a joint while a rotary axis turns."""

    turning: Annotated[str, "The rotary axis of the program."]
    joint: Annotated[str, "The axis of the joint that moves with it."]
    rate: Annotated[float, "Its largest rate per deg/s, mm/s or deg/s."]
    rate_at: Annotated[Named[float], "The positions of the program at which it has that rate."]
    acceleration: Annotated[float, "Its largest acceleration per (deg/s)^2, mm/s^2 or deg/s^2."]
    acceleration_at: Annotated[Named[float], "The positions of the program at which it has that acceleration."]
    ideal_acceleration: Annotated[float, "The largest acceleration that the machine without errors needs, in the same unit."]


class BallCheck(Record):
    """Two touches of a ball that stands on the part, one rotary axis turned between them."""

    turned: Annotated[str, "The axis that is turned."]
    first: Annotated[Named[float], "Positions of the first touch, mm and deg: the tip is at the centre of the ball."]
    second: Annotated[Named[float], "Positions of the second touch."]
    before_um: Annotated[list[float], "Centre found second less that found first, X, Y, Z of the part, with the numbers before the set, um."]
    with_um: Annotated[list[float], "The same with the set, um."]


class CertificateStep(Record):
    """Figures after a step of a composed set."""

    target: Annotated[str, "Names of the targets so far."]
    compensated: Annotated[CertifiedFigures, "With their files."]


class CertificateBeyond(Record):
    """Figures of a certificate where curves were not measured: beyond their points they go on as the machine file says."""

    measured: Annotated[Named[list[float]], "The measured ranges, by axis, mm and deg."]
    poses: Annotated[int, "Number of poses beyond one of them."]
    direction: Annotated[Literal["mean", "forward", "reverse"], "The side of approach that is worse."]
    uncompensated: Annotated[CertifiedFigures, "Without the files."]
    compensated: Annotated[CertifiedFigures, "With the files."]


class JobCertificate(Record):
    """Figures of a certificate over a job, without what the set-up of the part takes out."""

    over: Annotated[Over, "Poses and reference that they are over."]
    direction: Annotated[Literal["mean", "forward", "reverse"], "The side of approach that is worse."]
    uncompensated: Annotated[CertifiedFigures, "Without the files."]
    compensated: Annotated[CertifiedFigures, "With the files: the part is set up on the machine as it runs."]
    raised: Annotated[list[RaisedFigure], "Figures that the files raise."]


class CertificateBands(Record):
    """Intervals of the figures of a certificate."""

    uncompensated: Annotated[Bands, "Without the files."]
    compensated: Annotated[Bands, "With them: what the uncertainty of the errors leaves, whatever the files correct."]
    not_stated: Annotated[Union[list[str], None], "Errors with a value of which the machine file states no uncertainty: they count as exact."]


class RmsInterval(Record):
    """A root of mean squares with its 95 % interval."""

    rms: Annotated[float, "Over the places of a kind of reading, all components together."]
    interval: Annotated[list[float], "The interval in which that of the machine lies (k = 2)."]


class MeasuredKind(Record):
    """Predicted and measured readings of one kind, without what the set-up explains."""

    kind: Annotated[str, "``deviations``, ``lengths`` ..."]
    unit: Annotated[str, "``um`` or ``urad``."]
    places: Annotated[int, "Number of rows."]
    within: Annotated[float, "Share of |E_n| <= 1."]
    predicted: Annotated[RmsInterval, "By the machine file and the set; its uncertainty raises the figure, too."]
    measured: Annotated[RmsInterval, "By the readings, less their scatter."]


class SecondMeasurement(Record):
    """A set judged by readings that were taken with it in force."""

    verdict: Annotated[Literal["within", "not-within", "cannot-tell"], "The verdict."]
    words: Annotated[str, "The verdict in words."]
    within: Annotated[float, "Share of |E_n| <= 1."]
    within_expected: Annotated[float, "The share expected, k = 2."]
    within_least: Annotated[float, "The least share that 995 of 1000 good campaigns reach: what readings share makes it small."]
    correction: Annotated[Union[SeenCorrection, None], "The amount of the whole correction that is seen; none if the set does nothing at these places."]
    correction_by_axis: Annotated[list[SeenCorrection], "The same for what each axis adds, together."]
    instead: Annotated[Union[Literal["not-in-force", "reversed", "half"], None], "A machine that the readings agree with, if not with the one with the set."]
    has_predicted_uncertainty: Annotated[bool, "True if the machine file states how sure its errors are."]
    counted_once: Annotated[list[str], "Contributions of both campaigns that count once, by name."]
    kinds: Annotated[list[MeasuredKind], "By kind of reading."]
    set_up: Annotated[list[SetUpValue], "Set-up and instruments of the second campaign."]
    readings: Annotated[list[JudgedReading], "Every reading."]


class CertificateFields(Record):
    """Residual of a machine after a controller has applied a set of files."""

    reference_shift: Annotated[Union[ReferenceShift, None], "Displacement of the reference that the controller does not see; none for most."]
    raised: Annotated[list[RaisedFigure], "Figures that the files raise."]
    target: Annotated[str, "Name of the target."]
    files: Annotated[list[str], "Names of the files."]
    over: Annotated[Over, "Poses and reference of the figures: the volume."]
    poses: Annotated[int, "Number of poses."]
    direction: Annotated[Literal["mean", "forward", "reverse"], "The side of approach that is worse."]
    tool: Annotated[str, "Name of the tool; may be empty."]
    uncompensated: Annotated[CertifiedFigures, "Without the files."]
    compensated: Annotated[CertifiedFigures, "With the files."]
    errors: Annotated[Named[CertifiedError], "The errors by name."]
    single_error_poses: Annotated[int, "Number of poses for single errors."]
    at_reference: Annotated[AtReference, "Motions that the files add at home, or with all axes at 0 where the machine file does not state ``home`` for each."]
    cannot: Annotated[list[str], "Errors that the controller cannot correct, in words."]
    straight: Annotated[Union[CertifiedFigures, None], "Figures with straight lines between points, where the control has them as an option; ``compensated`` is then with steps, in the worst place of each section."]
    programming: Annotated[Union[list[ProgrammingFigures], None], "Figures for each form of the tool direction, where the controller transforms."]
    drives: Annotated[Union[list[DriveDemand], None], "Demands of a kinematics module on the drives while a rotary axis turns and the tip stands on the part."]
    pole_zone_deg: Annotated[Union[float, None], "Angle from a pole within which a kinematics module bounds rotary corrections, deg."]
    ball_checks: Annotated[Union[list[BallCheck], None], "Touches of a ball by which loaded kinematic parameters are checked."]
    steps: Annotated[Union[list[CertificateStep], None], "Figures after each step of a composed set, the last for all of it."]
    beyond_measured: Annotated[Union[CertificateBeyond, None], "The figures beyond the measured ranges, over which the others are, where these are less than the volume."]
    job: Annotated[Union[JobCertificate, None], "The figures over a job, if one was given."]
    uncertainty: Annotated[Union[CertificateBands, None], "Intervals of the figures, where the machine file states uncertainties of errors."]
    second: Annotated[Union[SecondMeasurement, None], "The verdict of a second measurement, with the set in force, if there was one."]


class SetDiffFields(Record):
    """Second set less the first."""

    axes: Annotated[Named[Named[float]], "By axis, in the order of the chain."]
    position_um: Annotated[Summary, "Displacement of the functional point, um."]


class TargetCertainty(Record):
    """Certainty of a fact, with its source."""

    level: Annotated[str, "Level in a word."]
    source: Annotated[str, "The source."]


class TargetSummary(Record):
    """A controller in short."""

    target: Annotated[str, "Name for ``compile``."]
    title: Annotated[str, "The controller's own name."]
    mechanism: Annotated[str, "Mechanisms of compensation, separated by spaces."]
    expresses: Annotated[str, "Errors that it corrects, in words."]
    cannot: Annotated[list[str], "Errors that it cannot correct, in words."]
    limits: Annotated[str, "Limits of its tables, in words."]
    sign_test: Annotated[str, "A test of the sign at the machine."]
    syntax: Annotated[TargetCertainty, "Certainty of the syntax."]
    sign: Annotated[TargetCertainty, "Certainty of the sign."]
    frame: Annotated[Union[TargetCertainty, None], "The frame of kinematic parameters, and its certainty; ``None`` of tables."]


class TestPieceFields(Record):
    """A test piece as a job."""

    kind: Annotated[Literal["square", "diamond", "circle", "cone", "s-shape", "nas-979", "box"], "The kind."]
    poses: Annotated[int, "Number of tool poses."]
    features: Annotated[list[str], "Names of its features."]
    c_motion: Annotated[Union[Literal["turn", "pole", "swing"], None], "The motion of a rotary axis about Z, of a cone."]
    largest_tilt_deg: Annotated[float, "Largest angle of the tool to Z, deg."]
    notes: Annotated[list[str], "Notes on what rests on memory, or is geometry of our own."]
    job: Annotated[str, "Name of the job file."]


class Dates(Record):
    """First and last day of the calibration, and the day of issue."""

    begin: Annotated[str, "First day."]
    end: Annotated[str, "Last day."]
    issued: Annotated[Union[str, None], "Day of issue."]


class Contact(Record):
    """A laboratory or a customer."""

    name: Annotated[str, "Name."]
    code: Annotated[Union[str, None], "Code of the laboratory, such as that of its accreditation."]
    email: Annotated[Union[str, None], "Electronic mail."]
    street: Annotated[Union[str, None], "Street and number."]
    post_code: Annotated[Union[str, None], "Post code."]
    city: Annotated[str, "City."]
    country: Annotated[Union[str, None], "Country, ISO 3166-1."]


class Person(Record):
    """A responsible person."""

    name: Annotated[str, "Name."]
    role: Annotated[Union[str, None], "Role, such as ``calibration engineer``."]


class Plate(Record):
    """The machine by its plate."""

    serial: Annotated[str, "Serial number."]
    manufacturer: Annotated[Union[str, None], "Manufacturer."]
    model: Annotated[Union[str, None], "Model."]


class Instrument(Record):
    """An instrument and its certificate."""

    name: Annotated[str, "Name."]
    manufacturer: Annotated[Union[str, None], "Manufacturer."]
    model: Annotated[Union[str, None], "Model."]
    serial: Annotated[str, "Serial number."]
    certificate: Annotated[str, "Number of its certificate."]
    calibrated: Annotated[str, "Day of its calibration."]
    due: Annotated[Union[str, None], "Day on which its certificate ends."]
    uncertainty: Annotated[str, "Uncertainty in the words of its certificate."]
    file: Annotated[Union[str, None], "The certificate as a file; in the record its copy."]


class Temperature(Record):
    """A temperature during the calibration."""

    name: Annotated[str, "Place of the sensor."]
    deg_c: Annotated[float, "Temperature, degC."]
    expanded_uncertainty_k: Annotated[Union[float, None], "Expanded uncertainty (k = 2), K."]


class Statements(Record):
    """What ISO/IEC 17025 asks of a certificate beside the numbers; ``null`` where the description does not state it."""

    traceability: Annotated[Union[str, None], "Chain of calibrations to the unit of length."]
    decision_rule: Annotated[Union[str, None], "Rule by which the decisions count, and who agreed to it."]
    environment: Annotated[Union[str, None], "Conditions during the calibration."]
    location: Annotated[Union[str, None], "Place at which the machine stands: address, hall."]
    path: Annotated[Union[str, None], "Lines and volume that were measured, and how they were approached."]
    replaces: Annotated[Union[str, None], "Name of the record that this one replaces."]


class Hashed(Record):
    """A file and its hash."""

    name: Annotated[str, "Its name."]
    sha256: Annotated[str, "SHA-256 of its bytes, hexadecimal."]


class MachineState(Record):
    """The machine file of a state."""

    file: Annotated[str, "The machine file within the record."]
    inputs: Annotated[list[Hashed], "Every file that it is read from, within the record."]


class StateValue(Record):
    """An error in one state of the machine."""

    value: Annotated[float, "The value of the largest size over the volume: of a bounded error its bound."]
    bounded: Annotated[bool, "True if the error is only bounded."]
    expanded_uncertainty: Annotated[Union[float, None], "Expanded uncertainty (k = 2), if the machine file states it."]
    held: Annotated[bool, "True of a zero that the datum of a fit sets, or its user: nothing is measured."]


class ErrorRow(Record):
    """An error as found and as left."""

    error: Annotated[str, "Name of the error."]
    unit: Annotated[str, "``um`` or ``urad``."]
    found: Annotated[Union[StateValue, None], "As found; ``null`` if the file does not give it."]
    left: Annotated[Union[StateValue, None], "As left; ``null`` if the file does not give it."]


class CovariedError(Record):
    """An error whose value has a covariance with those of others."""

    error: Annotated[str, "Name of the error."]
    position: Annotated[Union[float, None], "Position (mm or deg) of the value, approached with rising position; ``null`` for a location error."]
    value: Annotated[float, "The value: of a curve that of the largest size at its positions."]
    unit: Annotated[str, "``um`` or ``urad``."]


class RecordedCovariance(Record):
    """Covariance of the fit in a state of the machine."""

    state: Annotated[str, "``found`` or ``left``."]
    errors: Annotated[list[CovariedError], "The errors that the fit knows with an uncertainty, in the order of rows and columns."]
    covariance: Annotated[list[list[float]], "The covariance, row by row, in products of the units."]


class ErrorCurve(Record):
    """Curve of a component error."""

    state: Annotated[str, "``found`` or ``left``."]
    error: Annotated[str, "Name of the error."]
    axis: Annotated[str, "Name of the axis."]
    unit: Annotated[str, "``um`` or ``urad``."]
    position_unit: Annotated[str, "``mm`` or ``deg``."]
    positions: Annotated[list[float], "Positions: those of the table, or 21 over the volume."]
    forward: Annotated[list[float], "Values approached with rising position."]
    reverse: Annotated[Union[list[float], None], "Values approached with falling position; ``null`` if they are the same."]
    expanded_uncertainty: Annotated[Union[float, None], "Expanded uncertainty (k = 2) of the values, if the file states it."]


class LimitDecision(Record):
    """A decision on a limit, ISO 14253-1."""

    name: Annotated[str, "Name of the limited value."]
    of: Annotated[str, "``found``, ``left`` or the file of figures."]
    at: Annotated[Union[str, None], "The place of the value in a file of figures, a JSON pointer."]
    value: Annotated[float, "The value."]
    expanded_uncertainty: Annotated[Union[float, None], "Expanded uncertainty (k = 2)."]
    limit: Annotated[float, "The limit."]
    unit: Annotated[str, "Unit of the three, and of the guard."]
    sides: Annotated[Literal["upper", "both"], "Sides of the limit."]
    guard: Annotated[Union[float, None], "Distance from the limit within which nothing is proven."]
    decision: Annotated[Literal["conform", "not_conform", "undecided"], "The decision."]


class AlarmLimit(Record):
    """An alarm limit of an error."""

    error: Annotated[str, "Name of the error."]
    limit: Annotated[float, "Limit of the absolute value, um or urad."]
    unit: Annotated[str, "``um`` or ``urad``."]


class UnheldReversal(Record):
    """A reversal that was measured and that the machine file does not hold."""

    error: Annotated[str, "Name of the error."]
    um: Annotated[float, "Its largest size with the expanded uncertainty (k = 2) that the file of figures states, um."]
    file: Annotated[str, "The file of figures."]


class PromisedResidual(Record):
    """Residual of an installed set that is promised."""

    model_um: Annotated[float, "95 % position deviation over the volume by the values of the errors alone, um."]
    interval_um: Annotated[Union[list[float], None], "Its interval at 95 % by the uncertainty of the errors, um; ``null`` if the machine file states none."]
    type_b: Annotated[list[str], "Contributions of type B in this uncertainty, in words; empty if the fit states none."]
    reversals: Annotated[list[UnheldReversal], "Reversals that the model does not hold, the largest of each error."]
    within_um: Annotated[Union[float, None], "Upper end of the interval, plus the reversals of each direction added and the directions at right angles, um; ``null`` without an interval."]


class RecordedSet(Record):
    """A set of compensation files."""

    folder: Annotated[str, "Its folder within the record."]
    installed: Annotated[bool, "True if it is in force as left, false if it was replaced."]
    target: Annotated[str, "The controller."]
    files: Annotated[list[Hashed], "Its files, within the record."]
    verified_with: Annotated[Union[str, None], "The state of the machine by which it is verified: ``found`` or ``left``; ``null`` for a replaced set."]
    verify: Annotated[Any, "Certificate of ``verify``; ``null`` for a replaced set."]
    promised: Annotated[Union[PromisedResidual, None], "Residual that the certificate allows to promise; ``null`` for a replaced set."]
    compile: Annotated[Any, "Certificate that ``compile`` printed, if the description names it."]


class CopiedFile(Record):
    """A copied file."""

    source: Annotated[str, "Name as the description has it."]
    file: Annotated[str, "Name within the record."]
    bytes: Annotated[int, "Size in bytes."]
    sha256: Annotated[str, "SHA-256 of its bytes, hexadecimal."]


class RecordedFigure(Record):
    """A figure of a standard, from a document of another verb."""

    figure: Annotated[str, "Its name."]
    value: Annotated[float, "Its value."]
    expanded_uncertainty: Annotated[Union[float, None], "Its expanded uncertainty (k = 2), if the document states one."]
    unit: Annotated[str, "Unit of both."]


class RecordedFigures(Record):
    """A document of figures."""

    source: Annotated[str, "Name as the description has it."]
    file: Annotated[str, "Name within the record."]
    bytes: Annotated[int, "Size in bytes."]
    sha256: Annotated[str, "SHA-256 of its bytes, hexadecimal."]
    contributors: Annotated[list[str], "In sentences which contributors the uncertainties have and lack."]


class RecordSignature(Record):
    """The signature of a record, as the record states it."""

    algorithm: Annotated[str, "``ed25519``."]
    public_key: Annotated[str, "The public key: its 32 bytes, hexadecimal."]
    file: Annotated[str, "File of the signature within the record."]


class RecordFields(Record):
    """A record in memory."""

    record: Annotated[int, "Version of the contract: 1."]
    abbe: Annotated[str, "Version of the program."]
    id: Annotated[str, "Unique name of the record."]
    dates: Annotated[Dates, "Days."]
    language: Annotated[str, "Language of the texts."]
    country: Annotated[str, "Country of the calibration."]
    place: Annotated[Literal["laboratory", "customer", "laboratoryBranch", "customerBranch", "other"], "Place of the calibration."]
    laboratory: Annotated[Contact, "The laboratory."]
    customer: Annotated[Contact, "The customer."]
    persons: Annotated[list[Person], "Responsible persons."]
    machine: Annotated[str, "Name of the machine."]
    chain: Annotated[str, "Its chain."]
    plate: Annotated[Plate, "Its plate."]
    instruments: Annotated[list[Instrument], "Instruments."]
    temperatures: Annotated[list[Temperature], "Temperatures."]
    standards: Annotated[list[str], "Standards."]
    statements: Annotated[Statements, "What ISO/IEC 17025 asks beside the numbers."]
    remarks: Annotated[list[str], "Remarks."]
    as_found: Annotated[MachineState, "The machine as found."]
    as_left: Annotated[Union[MachineState, None], "The machine as left; ``null`` if it was left as found."]
    errors: Annotated[list[ErrorRow], "Every error."]
    covariances: Annotated[list[RecordedCovariance], "Covariances of the fits, for each state that states one."]
    curves: Annotated[list[ErrorCurve], "Curves of component errors."]
    decisions: Annotated[list[LimitDecision], "Decisions."]
    alarms: Annotated[list[AlarmLimit], "Alarm limits for the trend."]
    sets: Annotated[list[RecordedSet], "Sets of compensation files."]
    data: Annotated[list[CopiedFile], "Raw data."]
    figures: Annotated[list[RecordedFigures], "Figures: JSON documents of other verbs."]
    signature: Annotated[Union[RecordSignature, None], "The signature; ``null`` if the record is not signed."]
    files: Annotated[list[Hashed], "Every file but this document, its signature and the list of the hashes."]


class TrendRecord(Record):
    """A record of the line."""

    id: Annotated[str, "Unique name."]
    folder: Annotated[str, "The folder."]
    dates: Annotated[Dates, "First and last day."]
    adjusted: Annotated[bool, "True if the machine was left otherwise than found."]


class TrendPoint(Record):
    """An error in a state of a record."""

    id: Annotated[str, "Unique name of the record."]
    day: Annotated[str, "The first day for the state as found, the last day for the state as left."]
    state: Annotated[str, "``found`` or ``left``."]
    value: Annotated[float, "The value of the largest size over the volume."]
    expanded_uncertainty: Annotated[Union[float, None], "Expanded uncertainty (k = 2), if the machine file states it."]


class ErrorTrend(Record):
    """An error over the records."""

    error: Annotated[str, "Name of the error."]
    unit: Annotated[str, "``um`` or ``urad``."]
    alarm_limit: Annotated[Union[float, None], "Alarm limit of the absolute value: that of the newest record that states one."]
    alarm: Annotated[Literal["below", "alarm", "none"], "State of the newest value."]
    change: Annotated[Union[float, None], "Newest less oldest value; ``None`` for a single one."]
    points: Annotated[list[TrendPoint], "The values, oldest first."]


class TrendStep(Record):
    """What changed from a record to the next: the machine as it was left against the machine as it was found."""

    to: Annotated[str, "The later record."]
    difference: Annotated[DiffFields, "The difference of the machines, as ``diff`` states it."]


class TrendFields(Record):
    """Records in a line."""

    machine: Annotated[str, "Name of the machine in the newest record."]
    serial: Annotated[str, "Its serial number."]
    errors: Annotated[list[ErrorTrend], "Every error that a record gives a value."]
    steps: Annotated[list[TrendStep], "What changed between neighbours."]


class CheckRecordFields(Record):
    """A record that is as it was written."""

    folder: Annotated[str, "The folder."]
    files: Annotated[int, "Number of files that are as the list states."]
    replaced_sets: Annotated[int, "Number of sets that ``compile --record`` archived beside them, whole by their manifests."]
    unlisted: Annotated[list[str], "Files that no list names."]
    signature: Annotated[Union[RecordSignature, None], "The signature, which holds; ``null`` if the record is not signed."]
    of_given_key: Annotated[bool, "True if the signature is of the key that was given."]
    sha256: Annotated[str, "SHA-256 of the list itself: who notes it elsewhere notices a change of any file."]
