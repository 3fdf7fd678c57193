"""The verbs as methods. python/generate.py writes this file from the options of the façade."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypedDict, Union

from . import _abbe
from ._calls import call, order_of
from ._readings import files_and_texts, folders_and_texts
from ._results import (
    BudgetResult,
    CertificateResult,
    CompareResult,
    CompileResult,
    ConvertResult,
    DiffResult,
    EnumerateResult,
    EquationsResult,
    EvalResult,
    FiguresResult,
    IdentifyResult,
    ImportResult,
    InstrumentResult,
    LocateResult,
    MapResult,
    MeasureResult,
    MonomialResult,
    PlacementResult,
    PlanResult,
    PredictResult,
    ReachResult,
    RecordResult,
    ReportResult,
    SetDiffResult,
    TargetsResult,
    TestPieceResult,
    TouchImportResult,
    TrendResult,
)
from ._types import At, Poses, Progress, Table, Text
from ._types import Plane as PlaneOfAxes

#: Classes of machines.
ClassName = Literal["ultra-precision", "premium", "production", "commodity", "large-gantry", "desktop"]

#: Controllers; a path names one of templates of your own.
TargetName = Union[Literal["linuxcnc", "linuxcnc-kins", "linuxcnc-matrixkins", "linuxcnc-trt", "linuxcnc-5axiskins", "linuxcnc-maxkins", "isg-volcomp", "etalon-exchange", "sinumerik-cec", "sinumerik-enc", "sinumerik-traori", "sinumerik-chain", "sinumerik-tcarr", "heidenhain-com", "heidenhain-kinematics", "fanuc-pitch", "fanuc-3d", "fanuc-5axis", "haas-mrzp", "twincat-axis", "pmac", "kmotion-geo", "reprapfirmware", "klipper", "marlin", "grbl", "grid-csv", "grid-json"], PathLike[str]]

#: What is taken out of the deviations of a part.
ReferenceKind = Literal["machine", "machine-less-unheld", "zero", "zero-less-unheld", "datum", "best-fit"]

#: An alignment: a second point gives the rotation about an axis through the first.
#: ``about``: Direction of the axis, part coordinates.
#: ``point``: The second point, mm, part coordinates.
Alignment = TypedDict(
    "Alignment",
    {
        "about": Sequence[float],
        "point": Sequence[float],
    },
    total=False,
)

#: A datum point: a place on the part with the normal of its surface, part coordinates.
#: ``point``: The place, mm.
#: ``normal``: The normal, of any length but 0.
DatumPoint = TypedDict(
    "DatumPoint",
    {
        "point": Sequence[float],
        "normal": Sequence[float],
    },
    total=False,
)

#: A reference with the points at which it is probed, part coordinates.
#: ``kind``: What is taken out.
#: ``point``: Point at which the zero is probed, mm.
#: ``direction``: Direction of the tool while the part is probed, from the tip to the holder; of any length but 0.
#: ``rotary``: Positions of the rotary axes while the zero is probed, deg, by name, in place of the direction; omitted
#: axes are at 0.
#: ``align``: Rotation that a second point of the zero gives.
#: ``minimum_zone``: True for the best fit with the smallest largest position deviation in place of the least squares.
#: ``datum``: The six points of a datum frame.
Reference = TypedDict(
    "Reference",
    {
        "kind": ReferenceKind,
        "point": Sequence[float],
        "direction": Sequence[float],
        "rotary": Union[Mapping[str, float], None],
        "align": Union[Alignment, None],
        "minimum_zone": bool,
        "datum": Sequence[DatumPoint],
    },
    total=False,
)

#: A reference in the schema of options: as text on the command line, or its points.
ReferenceOption = Union[Text, Reference]

#: The order to which errors are followed; as text ``exact`` or ``1`` to ``6``.
Order = Union[int, Literal['exact', '1', '2', '3', '4', '5', '6']]

#: The side from which a position is approached; curves may differ (reversal).
Approach = Literal["mean", "forward", "reverse"]

#: Frame of vectors; all are parallel to the machine frame at the zero pose, but for the rotation of the workpiece.
Frame = Literal["workpiece", "machine", "tool"]

#: Letters of the symbols.
Naming = Literal["iso", "paper", "parameters"]

RandomChoice = TypedDict("RandomChoice", {"random": int})

LowDiscrepancyChoice = TypedDict("LowDiscrepancyChoice", {"low_discrepancy": int})

ToolPosesChoice = TypedDict("ToolPosesChoice", {"tool_poses": Table})

AxisPosesChoice = TypedDict("AxisPosesChoice", {"axis_poses": Table})

JobChoice = TypedDict("JobChoice", {"job": Text})

#: Poses of a map; at most 1e9.
MapPoses = Union[Literal["grid"], RandomChoice, LowDiscrepancyChoice, ToolPosesChoice, AxisPosesChoice, JobChoice]

#: Style of the drawing of a deviation over a plane.
PlaneDrawing = Literal["colours", "grid", "before_after"]

#: Quantity that the colours of a map show.
PlaneComponent = Literal["length", "dx", "dy", "dz"]

#: A picture of the deviation over a plane of two linear axes.
#: ``drawing``: Style of the drawing.
#: ``plane``: The two linear axes, such as ``XY`` or ``X,Z``; by default the first two.
#: ``at``: Positions of the other axes, ``Z=-100,A=30``: mm and deg; by default at 0, or at the end of the travel
#: nearest to it.
#: ``component``: Quantity that the colours show.
PlaneOptions = TypedDict(
    "PlaneOptions",
    {
        "drawing": PlaneDrawing,
        "plane": Union[PlaneOfAxes, None],
        "at": Union[At, None],
        "component": PlaneComponent,
    },
    total=False,
)

#: Goal of the correction.
Goal = Literal["position", "pose"]

#: Axes that correct.
CorrectingAxes = Literal["linear", "all"]

#: The meaning of a stored number.
Stored = Literal["correction", "error", "command"]

#: The error that tables are fitted to.
Fit = Literal["axis", "functional_point"]

#: Options of the compensation of a machine.
#: ``correct``: Goal of the correction; by default the position for tables, the pose for a kinematics module.
#: ``with``: Axes that correct. By default the linear ones for the position, all for the pose.
#: ``templates``: A folder with targets of one's own, each a folder with a ``target.yaml``.
#: ``stored``: Meaning of stored numbers, ``correction`` or ``error``, where the manual does not state it; by default
#: the manifest's.
#: ``without``: Kinds of tables to leave out although the controller has them: product, plane, cross_axis, own_axis.
#: ``fit``: Content of own-axis tables; by default the manifest's.
#: ``map``: Letters and numbers of axes in the controller, such as ``A=AX6`` or ``X1=U``, over those of the machine
#: file.
#: ``scale``: Scales of drives in force when the machine was measured, such as ``X=80``: steps in a mm, or mm in a turn.
#: Without it, and without the control's own settings among the files in force, no scale is written.
CompensationOptions = TypedDict(
    "CompensationOptions",
    {
        "correct": Union[Goal, None],
        "with": Union[CorrectingAxes, None],
        "templates": Union[Text, None],
        "stored": Union[Stored, None],
        "without": Sequence[Text],
        "fit": Union[Fit, None],
        "map": Sequence[Text],
        "scale": Sequence[Text],
    },
    total=False,
)

#: The distribution of an error between its bounds.
Distribution = Literal["uniform", "triangular"]

#: The statistic of one machine's deviations over the poses.
Statistic = Literal["max", "p95"]

#: Options of :meth:`abbe.Machine.reach`.
ReachOptions = TypedDict(
    "ReachOptions",
    {
    "region": Union[Text, None],
    "step_mm": Union[float, None],
    "directions": Union[int, None],
    "tool_poses": Union[Table, None],
    "job": Union[Text, None],
    "path": Union[bool, None],
    "reference": Union[ReferenceOption, None],
    },
    total=False,
)

#: Options of :meth:`abbe.Machine.budget`.
BudgetOptions = TypedDict(
    "BudgetOptions",
    {
    "class_": Union[ClassName, None],
    "distribution": Distribution,
    "statistic": Statistic,
    "seed": int,
    "poses": int,
    "tool_poses": Union[Table, None],
    "axis_poses": Union[Table, None],
    "job": Union[Text, None],
    "path": Union[bool, None],
    "reference": Union[ReferenceOption, None],
    "samples": int,
    "at": Union[At, None],
    "goal_mm": Union[float, None],
    "cost": Union[Text, None],
    "loosen": bool,
    "shard": Union[tuple[int, int], None],
    "merge": Union[Sequence[Text], None],
    },
    total=False,
)

#: Criterion of the arrangements.
JudgedBy = Literal["budget", "errors"]

#: Options of :meth:`abbe.Machine.enumerate`.
EnumerateOptions = TypedDict(
    "EnumerateOptions",
    {
    "class_": Union[ClassName, None],
    "distribution": Distribution,
    "statistic": Statistic,
    "seed": int,
    "by": Union[JudgedBy, None],
    "require": Union[Sequence[Text], None],
    "buildable": bool,
    "max_table": Union[int, None],
    "rotary": Union[int, None],
    "poses": int,
    "tool_poses": Union[Table, None],
    "job": Union[Text, None],
    "path": Union[bool, None],
    "reference": Union[ReferenceOption, None],
    "size": bool,
    "samples": int,
    "max_samples": Union[int, None],
    "first": int,
    "reach_percent": float,
    "state": Union[Text, None],
    "shard": Union[tuple[int, int], None],
    "merge": Union[Sequence[Text], None],
    },
    total=False,
)

#: A measuring instrument.
Instrument = Literal["ball_bar", "r_test", "diagonals", "step_diagonals"]

#: A plane of the workpiece frame; the circle runs from its first to its second direction.
Plane = Literal["XY", "YZ", "ZX"]

#: The part of the volume over which a fit is judged, and which its machine file states.
FitRange = Literal["travel", "measured"]

#: What a caller takes on their own word.
FitAcceptance = Literal["suspect", "undetermined"]

#: Options of :meth:`abbe.Machine.identify`.
IdentifyOptions = TypedDict(
    "IdentifyOptions",
    {
    "fit": Union[Sequence[Text], None],
    "fixed": Union[Sequence[Text], None],
    "priors": Union[Sequence[Text], None],
    "type_b": Union[Sequence[Text], None],
    "frame": Frame,
    "axis_poses": Union[Table, None],
    "order": Union[Order, None],
    "robust": bool,
    "folds": Union[int, None],
    "range": FitRange,
    "machine_file": bool,
    "noise_mm": Union[float, None],
    "accept": Union[Sequence[FitAcceptance], None],
    "accept_undetermined": bool,
    "pictures": bool,
    },
    total=False,
)

#: The instrument for which readings are planned.
PlanInstrument = Literal["points", "lines", "r_test", "tracker", "laser", "touch"]

#: The stylus and the body of the probe that holds it, mm.
#: ``radius``: Radius of its ball, whose middle is the functional point.
#: ``length``: Distance from the middle of the ball to the body.
#: ``shaft``: Radius of its shaft, less than that of the ball.
#: ``body``: Radius of the body.
Stylus = TypedDict(
    "Stylus",
    {
        "radius": float,
        "length": float,
        "shaft": float,
        "body": float,
    },
    total=False,
)

#: Largest corrections that are not refused.
#: ``length``: Limit for a linear axis, mm.
#: ``angle``: Limit for a rotary axis, rad.
#: ``slope``: Change of a correction per change of its own axis's position (mm/mm, deg/deg).
Limits = TypedDict(
    "Limits",
    {
        "length": float,
        "angle": float,
        "slope": float,
    },
    total=False,
)

#: Draws of errors between their bounds, and the statistic of their effect.
#: ``class``: Class of machines whose typical tolerances are taken where the file has none, in place of the class that
#: the file names: ``ultra-precision``, ``premium``, ``production``, ``commodity``, ``large-gantry`` or ``desktop``.
#: Values stay as they are, but in a ranking of arrangements, and on a machine whose errors all have one: there it takes
#: their place.
#: ``distribution``: Distribution of an error between its bounds.
#: ``statistic``: Statistic of a machine over the poses.
ToleranceOptions = TypedDict(
    "ToleranceOptions",
    {
        "class": Union[ClassName, None],
        "distribution": Distribution,
        "statistic": Statistic,
    },
    total=False,
)

#: The sign of the values of a file.
FileContents = Literal["errors", "corrections"]

#: Approach of runs without a direction.
RunApproach = Literal["one-way", "alternating"]

#: Line of a straightness.
StraightnessLine = Literal["least-squares", "end-points"]

#: A suspicion that a caller accepts.
Acceptance = Literal["suspect"]

#: The meaning of X, Y, Z in a log of touches.
TouchCoordinates = Literal["joints", "tip"]

#: A test.
StandardTest = Literal["circle", "rotation", "drift", "diagonals"]

#: A kind of test piece.
TestPieceKind = Literal["square", "diamond", "circle", "cone", "s-shape", "nas-979", "box"]

#: The motion of a rotary axis about Z along the circle of a tilted cone.
ConeMotion = Literal["turn", "pole", "swing"]


class Verbs:
    """The verbs of a machine."""

    _native: _abbe.NativeMachine

    def _picture_again(self, options: Mapping[str, Any], threads: int | None) -> Callable[[], Any]:
        raise NotImplementedError

    def _fit_picture_again(
        self, options: Mapping[str, Any], texts: list[tuple[str, str]], threads: int | None
    ) -> Callable[[], Any]:
        raise NotImplementedError

    def _listed(self, poses: Poses | None) -> list[list[float]] | None:
        raise NotImplementedError

    def eval(
        self,
        *,
        at: Sequence[At] | None = None,
        poses: Poses | None = None,
        pose_file: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        order: Order | None = None,
        approach: Approach = "mean",
        frame: Frame = "workpiece",
        algebra: Text | None = None,
        inverse: bool = False,
        sensitivity: bool = False,
        interactions: bool = False,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> EvalResult:
        """Evaluates poses one by one: deviation, E_VE, and what each error contributes.

        Options, each with the default of the façade where it is ``None``:

        * ``at``: Poses as text, ``X=100,C=90``: mm and deg; omitted axes are at 0.
        * ``poses``: Poses as numbers, mm and deg, each as long as the machine has axes and in the order of the chain.
        * ``pose_file``: A CSV file of poses: a header of axis names, one pose a line, mm and deg.
        * ``job``: A job file instead of poses: the poses for its tool poses, without what its set-up takes out.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out of the deviations; by default what the job says,
          otherwise nothing.
        * ``order``: Order of the errors; exact by default, unless the conventions of the machine name an order.
        * ``approach``: Side of approach, where forward and reverse curves were given.
        * ``frame``: Frame of the vectors.
        * ``algebra``: Follows errors over a Weil algebra instead, in the words of the section ``algebra`` of a machine
          file; an empty text takes that section.
        * ``inverse``: Solves for the displacements of the axes that undo the errors, over ``algebra``.
        * ``sensitivity``: Lists the effect of 1 um or 1 urad of every error.
        * ``interactions``: Lists the effect of pairs of errors, and the error of order 1. Implies ``sensitivity``.
        """
        options: dict[str, Any] = {
            "at": at,
            "poses": self._listed(poses),
            "pose_file": pose_file,
            "job": job,
            "path": path,
            "reference": reference,
            "order": order_of(order),
            "approach": approach,
            "frame": frame,
            "algebra": algebra,
            "inverse": inverse,
            "sensitivity": sensitivity,
            "interactions": interactions,
        }
        found = call("eval", [self._native], options, threads=threads, progress=progress)
        return EvalResult(found)

    def equations(
        self,
        *,
        order: int | None = None,
        algebra: Text | None = None,
        symbols: Naming = "iso",
        tool_length: bool = False,
        factors: bool = False,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> EquationsResult:
        """Returns the closed forms: E_VE and deviations as polynomials in the errors.

        Options, each with the default of the façade where it is ``None``:

        * ``order``: Highest degree in the errors, every error on its own; 1 by default.
        * ``algebra``: The algebra of the errors instead, in the words of the section ``algebra`` of a machine file; an
          empty text takes that section.
        * ``symbols``: Names of the symbols.
        * ``tool_length``: True if the length of the tool stays the symbol L.
        * ``factors``: True to list the factors of each joint: nominal motion, error and location matrices.
        """
        options: dict[str, Any] = {
            "order": order,
            "algebra": algebra,
            "symbols": symbols,
            "tool_length": tool_length,
            "factors": factors,
        }
        found = call("equations", [self._native], options, threads=threads, progress=progress)
        return EquationsResult(found)

    def convert(
        self,
        to: Text | None = None,
        *,
        datum: Text | None = None,
        within_mm: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> ConvertResult:
        """Returns the same machine under other conventions.

        Options, each with the default of the façade where it is ``None``:

        * ``to``: The new conventions: a preset, words such as ``carried_body``, or ``linear: before, rotary:
          rotating``; others stay as they are.
        * ``datum``: The axis from whose actual line location errors count (``axis_only``), instead of the machine
          frame.
        * ``within_mm``: Difference of the machines that is accepted, mm; for rotations this over a metre. By default
          only rounding is.
        """
        options: dict[str, Any] = {
            "to": to,
            "datum": datum,
            "within_mm": within_mm,
        }
        found = call("convert", [self._native], options, threads=threads, progress=progress)
        return ConvertResult(found)

    def map(
        self,
        *,
        rows: bool = False,
        poses: MapPoses = "grid",
        seed: int = 1,
        path: bool | None = None,
        order: Order | None = None,
        degree: int | None = None,
        reference: ReferenceOption | None = None,
        approach: Approach = "mean",
        frame: Frame = "workpiece",
        worst: int = 5,
        picture: PlaneOptions | None = None,
        target: TargetName | None = None,
        compensation: CompensationOptions | None = None,
        class_: ClassName | None = None,
        distribution: Distribution = "uniform",
        statistic: Statistic = "max",
        samples: int = 1000,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> MapResult:
        """Maps the error over the volume.

        ``rows`` keeps every pose with its deviation, for ``rows``, ``to_pandas`` and ``to_xarray``.

        Options, each with the default of the façade where it is ``None``:

        * ``poses``: The poses.
        * ``seed``: Seed of random and low-discrepancy poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``order``: Order of the errors; exact by default, unless the conventions of the machine name an order.
        * ``degree``: Maps the part of this degree in the errors alone, 1 to 6, over a volume of a bare machine.
        * ``reference``: Motion that the part's set-up takes out of the deviations; by default the zero at the part's
          origin for tool poses, nothing for a volume.
        * ``approach``: Side of approach, where forward and reverse curves were given.
        * ``frame``: Frame of the vectors.
        * ``worst``: Number of the worst poses to name.
        * ``picture``: Draws the deviation over a plane.
        * ``target``: Maps the residual of this target's compensation, by the files that ``compile`` would write.
        * ``compensation``: Options of the compensation for the target.
        * ``class_``: Class of machines whose typical tolerances are taken where the file has none, in place of the
          class that the file names: ``ultra-precision``, ``premium``, ``production``, ``commodity``, ``large-gantry``
          or ``desktop``. Values stay as they are, but in a ranking of arrangements, and on a machine whose errors all
          have one: there it takes their place.
        * ``distribution``: Distribution of an error between its bounds.
        * ``statistic``: Statistic of a machine over the poses.
        * ``samples``: Number of machines that are drawn, at least 2.
        """
        options: dict[str, Any] = {
            "poses": poses,
            "seed": seed,
            "path": path,
            "order": order_of(order),
            "degree": degree,
            "reference": reference,
            "approach": approach,
            "frame": frame,
            "worst": worst,
            "picture": picture,
            "target": target,
            "compensation": compensation,
            "class": class_,
            "distribution": distribution,
            "statistic": statistic,
            "samples": samples,
        }
        found = call("map", [self._native], options, rows=rows, threads=threads, progress=progress)
        return MapResult(found, self._picture_again(options, threads))

    def reach(
        self,
        *,
        region: Text | None = None,
        step_mm: float | None = None,
        directions: int | None = None,
        tool_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> ReachResult:
        """Returns the tips and directions of the tool within reach over a box.

        Options, each with the default of the façade where it is ``None``:

        * ``region``: The box of the tips in the workpiece frame, ``X=-100..100,Z=0..200`` (mm, or with units). Sides
          that are left out are those of the box over which the linear axes carry the tip, rotary axes at rest; for
          robots, whose rotary axes place the tip, those of the box around it at 2000 random poses.
        * ``step_mm``: Largest distance of neighbouring tips, mm; by default an eighth of the longest side, for robots a
          third.
        * ``directions``: Number of directions of the tool; 60 by default, 6 for robots. A machine that does not turn
          its tool has one; of a circle those count that are within the hemisphere about the tool axis at rest.
        * ``tool_poses``: A file of tool poses in place of the box.
        * ``job``: A job file in place of the box.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out, whose point is to be reached, too; of tool poses
          alone, by default the zero at the part's origin.
        """
        options: dict[str, Any] = {
            "region": region,
            "step_mm": step_mm,
            "directions": directions,
            "tool_poses": tool_poses,
            "job": job,
            "path": path,
            "reference": reference,
        }
        found = call("reach", [self._native], options, threads=threads, progress=progress)
        return ReachResult(found)

    def place(
        self,
        *,
        ranges: Text = "",
        figure: bool = False,
        job: Text | None = None,
        tool_poses: Table | None = None,
        path: bool | None = None,
        reference: Reference | None = None,
        order: Order | None = None,
        approach: Approach = "mean",
        class_: ClassName | None = None,
        distribution: Distribution = "uniform",
        statistic: Statistic = "max",
        samples: int = 1000,
        seed: int = 1,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> PlacementResult:
        """Tries the part of a job at places of the table: reach and deviation at each.

        Options, each with the default of the façade where it is ``None``:

        * ``ranges``: Ranges of the place of the part, ``X=-200..200:9,C=0..90:4``: X, Y, Z of its origin (mm), A, B, C
          of its rotation (deg), with the number of values; the other numbers are those of the job.
        * ``figure``: True for the figure of the deviation at each place, false for the reach alone.
        * ``job``: The job file.
        * ``tool_poses``: A file of tool poses in place of a job file.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out of the deviations; by default what the job states, or
          else the zero at the part's origin. It moves with the part.
        * ``order``: Order of the errors; exact by default, unless the conventions of the machine name an order.
        * ``approach``: Side of approach, where forward and reverse curves were given.
        * ``class_``: Class of machines whose typical tolerances are taken where the file has none, in place of the
          class that the file names: ``ultra-precision``, ``premium``, ``production``, ``commodity``, ``large-gantry``
          or ``desktop``. Values stay as they are, but in a ranking of arrangements, and on a machine whose errors all
          have one: there it takes their place.
        * ``distribution``: Distribution of an error between its bounds.
        * ``statistic``: Statistic of a machine over the poses.
        * ``samples``: Number of machines that are drawn, at least 2.
        * ``seed``: Seed of these machines.
        """
        options: dict[str, Any] = {
            "ranges": ranges,
            "figure": figure,
            "job": job,
            "tool_poses": tool_poses,
            "path": path,
            "reference": reference,
            "order": order_of(order),
            "approach": approach,
            "class": class_,
            "distribution": distribution,
            "statistic": statistic,
            "samples": samples,
            "seed": seed,
        }
        found = call("place", [self._native], options, threads=threads, progress=progress)
        return PlacementResult(found)

    def compare(
        self,
        *others: Verbs,
        poses: int = 1000,
        tool_poses: Table | None = None,
        axis_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        seed: int = 1,
        class_: ClassName | None = None,
        distribution: Distribution = "uniform",
        statistic: Statistic = "max",
        samples: int = 1000,
        max_samples: int | None = None,
        order: Order | None = None,
        approach: Approach = "mean",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> CompareResult:
        """Compares the machine with others on the same tool poses.

        Options, each with the default of the façade where it is ``None``:

        * ``poses``: Number of tool poses, drawn from the volume of the first machine.
        * ``tool_poses``: A CSV file of tool poses in the workpiece frame instead: columns X, Y, Z (mm) and I, J, K or
          rotary axes (deg) of the first machine.
        * ``axis_poses``: A CSV file of poses of the axes of the first machine instead: a header of axis names, one pose
          a line, mm and deg; omitted axes are at 0. A machine that they give the same tool poses takes them, too.
        * ``job``: A job file instead of the tool poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out of the deviations; by default the zero at the part's
          origin for tool poses. Without tool poses machine coordinates and best fit are both compared by default.
        * ``seed``: Seed of the tool poses, and of the errors that are drawn.
        * ``class_``: Class of machines whose typical tolerances are taken where the file has none, in place of the
          class that the file names: ``ultra-precision``, ``premium``, ``production``, ``commodity``, ``large-gantry``
          or ``desktop``. Values stay as they are, but in a ranking of arrangements, and on a machine whose errors all
          have one: there it takes their place.
        * ``distribution``: Distribution of an error between its bounds.
        * ``statistic``: Statistic of a machine over the poses.
        * ``samples``: Number of machines that are drawn for the budgets, at least 2.
        * ``max_samples``: Maximum number of them: more are drawn until every machine is told apart from the first; by
          default eight times ``samples``.
        * ``order``: Order of the errors; exact by default, unless the conventions of a machine name an order.
        * ``approach``: Side of approach, where forward and reverse curves were given.
        """
        options: dict[str, Any] = {
            "poses": poses,
            "tool_poses": tool_poses,
            "axis_poses": axis_poses,
            "job": job,
            "path": path,
            "reference": reference,
            "seed": seed,
            "class": class_,
            "distribution": distribution,
            "statistic": statistic,
            "samples": samples,
            "max_samples": max_samples,
            "order": order_of(order),
            "approach": approach,
        }
        found = call("compare", [self._native, *(other._native for other in others)], options, threads=threads, progress=progress)
        return CompareResult(found)

    def budget(
        self,
        *,
        class_: ClassName | None = None,
        distribution: Distribution = "uniform",
        statistic: Statistic = "max",
        seed: int = 1,
        poses: int = 500,
        tool_poses: Table | None = None,
        axis_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        samples: int = 1000,
        at: At | None = None,
        goal_mm: float | None = None,
        cost: Text | None = None,
        loosen: bool = False,
        shard: tuple[int, int] | None = None,
        merge: Sequence[Text] | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> BudgetResult:
        """Returns what tolerances do to the volumetric error, and which to tighten first.

        Options, each with the default of the façade where it is ``None``:

        * ``class_``: Class of machines whose typical tolerances are taken where the file has none, in place of the
          class that the file names: ``ultra-precision``, ``premium``, ``production``, ``commodity``, ``large-gantry``
          or ``desktop``. Values stay as they are, but in a ranking of arrangements, and on a machine whose errors all
          have one: there it takes their place.
        * ``distribution``: Distribution of an error between its bounds.
        * ``statistic``: Statistic of a machine over the poses.
        * ``seed``: Seed of poses and errors.
        * ``poses``: Number of random poses, besides the corners of the volume.
        * ``tool_poses``: A CSV file of tool poses in the workpiece frame that replace these poses: columns X, Y, Z (mm)
          and I, J, K or rotary axes (deg).
        * ``axis_poses``: A CSV file of poses of the axes instead: a header of axis names, one pose a line, mm and deg;
          omitted axes are at 0. Where no error is bounded, each with a value is between ± the largest that it has at
          these poses.
        * ``job``: A job file instead of the tool poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out of the effects; by default the zero at the part's
          origin for tool poses, nothing for a volume.
        * ``samples``: Number of machines that are drawn, at least 2.
        * ``at``: A pose at which contributions are listed too, ``X=100,C=90``: mm and deg; axes left out are at 0.
        * ``goal_mm``: Goal of the 95 % value of the position, mm: the cheapest tolerances for it are sought.
        * ``cost``: YAML file with the cost of tolerances; by default the sum of present / new - 1, a tolerance halved
          counts 1.
        * ``loosen``: Tolerances may become coarser than they are for a goal.
        * ``shard``: Draws only part I of N of the machines.
        * ``merge``: Files of drawn machines that together hold all; none is drawn again.
        """
        options: dict[str, Any] = {
            "class": class_,
            "distribution": distribution,
            "statistic": statistic,
            "seed": seed,
            "poses": poses,
            "tool_poses": tool_poses,
            "axis_poses": axis_poses,
            "job": job,
            "path": path,
            "reference": reference,
            "samples": samples,
            "at": at,
            "goal_mm": goal_mm,
            "cost": cost,
            "loosen": loosen,
            "shard": shard,
            "merge": merge,
        }
        found = call("budget", [self._native], options, threads=threads, progress=progress)
        return BudgetResult(found)

    def enumerate(
        self,
        *,
        class_: ClassName | None = None,
        distribution: Distribution = "uniform",
        statistic: Statistic = "max",
        seed: int = 1,
        by: JudgedBy | None = None,
        require: Sequence[Text] | None = None,
        buildable: bool = True,
        max_table: int | None = None,
        rotary: int | None = None,
        poses: int = 500,
        tool_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        size: bool = False,
        samples: int = 200,
        max_samples: int | None = None,
        first: int = 1,
        reach_percent: float = 50.0,
        state: Text | None = None,
        shard: tuple[int, int] | None = None,
        merge: Sequence[Text] | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> EnumerateResult:
        """Ranks all arrangements of the axes on the same work.

        Options, each with the default of the façade where it is ``None``:

        * ``class_``: Class of machines whose typical tolerances are taken where the file has none, in place of the
          class that the file names: ``ultra-precision``, ``premium``, ``production``, ``commodity``, ``large-gantry``
          or ``desktop``. Values stay as they are, but in a ranking of arrangements, and on a machine whose errors all
          have one: there it takes their place.
        * ``distribution``: Distribution of an error between its bounds.
        * ``statistic``: Statistic of a machine over the poses.
        * ``seed``: Seed of poses and errors.
        * ``by``: Criterion of the arrangements; by default a budget if any error is bounded.
        * ``require``: Rules that arrangements obey, such as ``C before A``, ``Y carries A``, ``at most 2 on table``.
        * ``buildable``: Leaves out what is hardly built: a linear axis above a rotary one on the table, more than four
          axes below the part, more than two rotary axes in the head. What the machine's own file has is never left out.
        * ``max_table``: Maximum number of axes that carry the workpiece.
        * ``rotary``: Number of rotary axes at a time, every choice of them; by default all.
        * ``poses``: Number of tool poses.
        * ``tool_poses``: A CSV file of tool poses in the workpiece frame instead: columns X, Y, Z (mm) and I, J, K or
          rotary axes (deg).
        * ``job``: A job file instead of the tool poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out of the deviations; by default the zero at the part's
          origin for tool poses. Without tool poses arrangements are ranked in machine coordinates by default, and their
          best fits beside.
        * ``size``: Gives linear axes the travel that the work needs, whatever the file says; every arrangement tells
          it.
        * ``samples``: Number of machines that are drawn of every arrangement for the budget, at least 2.
        * ``max_samples``: Maximum number of machines that are drawn of the arrangements that could be among the first;
          by default eight times ``samples``, or what can be kept of them.
        * ``first``: Number of first ranks that are to be told apart from each other and from all others.
        * ``reach_percent``: Fraction of the tool poses, in percent, from which on arrangements that miss some are
          listed by their figure. Ranked ones reach all.
        * ``state``: A file of results of this study; what it holds is not computed again.
        * ``shard``: Computes only part I of N of the walks of one round.
        * ``merge``: Files of results that together hold the first round; what they hold is not computed again.
        """
        options: dict[str, Any] = {
            "class": class_,
            "distribution": distribution,
            "statistic": statistic,
            "seed": seed,
            "by": by,
            "require": require,
            "buildable": buildable,
            "max_table": max_table,
            "rotary": rotary,
            "poses": poses,
            "tool_poses": tool_poses,
            "job": job,
            "path": path,
            "reference": reference,
            "size": size,
            "samples": samples,
            "max_samples": max_samples,
            "first": first,
            "reach_percent": reach_percent,
            "state": state,
            "shard": shard,
            "merge": merge,
        }
        found = call("enumerate", [self._native], options, threads=threads, progress=progress)
        return EnumerateResult(found)

    def instrument(
        self,
        instrument: Instrument = "ball_bar",
        *,
        plane: Plane | None = None,
        radius_mm: float = 100.0,
        axis: Text | None = None,
        at: At | None = None,
        points: int | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> InstrumentResult:
        """Returns the readings of an instrument.

        Options, each with the default of the façade where it is ``None``:

        * ``instrument``: The instrument.
        * ``plane``: Ball bar: plane of the circle, workpiece frame; by default all three.
        * ``radius_mm``: Ball bar: its length, above 0 and up to 10000 mm.
        * ``axis``: R-test: name of the rotary axis, or of several that turn at once, ``A+C``; by default all, one after
          the other.
        * ``at``: Centre of the circle, place of the ball, or where the other axes are, ``X=100,C=90``: mm and deg. By
          default the middle of the volume, for the R-test three quarters along it; rotary axes at 0 or nearest to it.
        * ``points``: Readings on a circle or turn, points on a diagonal, or steps of every axis; by default 360, 37,
          11.
        """
        options: dict[str, Any] = {
            "instrument": instrument,
            "plane": plane,
            "radius_mm": radius_mm,
            "axis": axis,
            "at": at,
            "points": points,
        }
        found = call("instrument", [self._native], options, threads=threads, progress=progress)
        return InstrumentResult(found)

    def identify(
        self,
        data: Iterable[Table] | Table | None = None,
        *,
        fit: Sequence[Text] | None = None,
        fixed: Sequence[Text] | None = None,
        priors: Sequence[Text] | None = None,
        type_b: Sequence[Text] | None = None,
        frame: Frame = "workpiece",
        axis_poses: Table | None = None,
        order: Order | None = None,
        robust: bool = False,
        folds: int | None = None,
        range: FitRange = "travel",
        machine_file: bool = False,
        noise_mm: float | None = None,
        accept: Sequence[FitAcceptance] | None = None,
        accept_undetermined: bool = False,
        pictures: bool = False,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> IdentifyResult:
        """Fits errors to measurements.

        Options, each with the default of the façade where it is ``None``:

        * ``data``: Files of measurements, read through ``run.files``: CSV with a column for each axis and ``dx [um]``,
          ``dy [um]``, ``dz [um]``, or lengths, ball readings, lines, single errors (docs/identify/measure.md).
        * ``fit``: Parameters to fit: ``location``, ``tool``, ``tools``, ``tools-by-run``, ``workpiece``, ``workpiece-
          by-run``, ``spindle``, ``linear``, error names, ``EXX:poly3``; if empty, the section ``identify`` of the
          machine file.
        * ``fixed``: Parameters that keep their value although a group names them.
        * ``priors``: Values known before the data, with a standard uncertainty: ``ball b1 50 um``, ``EC0Y 5 urad``,
          ``constant S = 150 mm 1 um``; ``file``: what the machine file states. They come after those of the section
          ``identify``.
        * ``type_b``: Standard uncertainties that all readings share: ``laser 0.4 um/m`` (a scale), ``set-up 2 um`` (an
          offset), ``material 0.5 K x 11.7 um/m/K``. They come after those of the section ``identify``.
        * ``frame``: Frame in which the deviations were measured.
        * ``axis_poses``: The poses of points that a laser tracker's export has by name: a table with a column for each
          axis, and ``point``.
        * ``order``: Model to fit: exact by default, or of order 1 or 2. Monomials are those of order 2 by default.
        * ``robust``: Gives readings that stand out less weight (Huber).
        * ``folds``: Checks the prediction: leaves out every measurement once, in this many parts.
        * ``range``: Part of the volume over which the fit is judged, and which the machine file states as ``volume``.
        * ``machine_file``: Also writes the fitted machine file; fails if it is one that would be refused.
        * ``noise_mm``: Standard deviation of a reading (mm) that is expected: more is remarked, and troubles are looked
          for.
        * ``accept``: Refusals that the caller takes on their word; the machine file states them.
        * ``accept_undetermined``: An older word for ``accept: undetermined``.
        * ``pictures``: Also draws prediction and data over the planes of the linear axes.
        """
        paths, texts = files_and_texts(data)
        options: dict[str, Any] = {
            "data": paths,
            "fit": fit,
            "fixed": fixed,
            "priors": priors,
            "type_b": type_b,
            "frame": frame,
            "axis_poses": axis_poses,
            "order": order_of(order),
            "robust": robust,
            "folds": folds,
            "range": range,
            "machine_file": machine_file,
            "noise_mm": noise_mm,
            "accept": accept,
            "accept_undetermined": accept_undetermined,
            "pictures": pictures,
        }
        found = call("identify", [self._native], options, texts=texts, threads=threads, progress=progress)
        return IdentifyResult(found, self._fit_picture_again(options, texts, threads))

    def fit_monomials(
        self,
        data: Iterable[Table] | Table | None = None,
        *,
        fit: Sequence[Text] | None = None,
        fixed: Sequence[Text] | None = None,
        priors: Sequence[Text] | None = None,
        type_b: Sequence[Text] | None = None,
        frame: Frame = "workpiece",
        axis_poses: Table | None = None,
        order: Order | None = None,
        robust: bool = False,
        folds: int | None = None,
        range: FitRange = "travel",
        machine_file: bool = False,
        noise_mm: float | None = None,
        accept: Sequence[FitAcceptance] | None = None,
        accept_undetermined: bool = False,
        pictures: bool = False,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> MonomialResult:
        """Fits monomials of order 2, component by component, as the papers do.

        Options, each with the default of the façade where it is ``None``:

        * ``data``: Files of measurements, read through ``run.files``: CSV with a column for each axis and ``dx [um]``,
          ``dy [um]``, ``dz [um]``, or lengths, ball readings, lines, single errors (docs/identify/measure.md).
        * ``fit``: Parameters to fit: ``location``, ``tool``, ``tools``, ``tools-by-run``, ``workpiece``, ``workpiece-
          by-run``, ``spindle``, ``linear``, error names, ``EXX:poly3``; if empty, the section ``identify`` of the
          machine file.
        * ``fixed``: Parameters that keep their value although a group names them.
        * ``priors``: Values known before the data, with a standard uncertainty: ``ball b1 50 um``, ``EC0Y 5 urad``,
          ``constant S = 150 mm 1 um``; ``file``: what the machine file states. They come after those of the section
          ``identify``.
        * ``type_b``: Standard uncertainties that all readings share: ``laser 0.4 um/m`` (a scale), ``set-up 2 um`` (an
          offset), ``material 0.5 K x 11.7 um/m/K``. They come after those of the section ``identify``.
        * ``frame``: Frame in which the deviations were measured.
        * ``axis_poses``: The poses of points that a laser tracker's export has by name: a table with a column for each
          axis, and ``point``.
        * ``order``: Model to fit: exact by default, or of order 1 or 2. Monomials are those of order 2 by default.
        * ``robust``: Gives readings that stand out less weight (Huber).
        * ``folds``: Checks the prediction: leaves out every measurement once, in this many parts.
        * ``range``: Part of the volume over which the fit is judged, and which the machine file states as ``volume``.
        * ``machine_file``: Also writes the fitted machine file; fails if it is one that would be refused.
        * ``noise_mm``: Standard deviation of a reading (mm) that is expected: more is remarked, and troubles are looked
          for.
        * ``accept``: Refusals that the caller takes on their word; the machine file states them.
        * ``accept_undetermined``: An older word for ``accept: undetermined``.
        * ``pictures``: Also draws prediction and data over the planes of the linear axes.
        """
        paths, texts = files_and_texts(data)
        options: dict[str, Any] = {
            "data": paths,
            "fit": fit,
            "fixed": fixed,
            "priors": priors,
            "type_b": type_b,
            "frame": frame,
            "axis_poses": axis_poses,
            "order": order_of(order),
            "robust": robust,
            "folds": folds,
            "range": range,
            "machine_file": machine_file,
            "noise_mm": noise_mm,
            "accept": accept,
            "accept_undetermined": accept_undetermined,
            "pictures": pictures,
        }
        found = call("fit_monomials", [self._native], options, texts=texts, threads=threads, progress=progress)
        return MonomialResult(found)

    def plan(
        self,
        *,
        poses: int = 20,
        instrument: PlanInstrument = "points",
        balls: Sequence[Text] | None = None,
        ball_radius: float = 12.5,
        stylus: Stylus | None = None,
        stem: float | None = None,
        within: float = 1.0,
        ranges: Text | None = None,
        candidates: Text | None = None,
        fit: Sequence[Text] | None = None,
        fixed: Sequence[Text] | None = None,
        priors: Sequence[Text] | None = None,
        noise_mm: float = 0.001,
        seed: int = 1,
        until_mm: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> PlanResult:
        """Returns poses worth measuring, and the uncertainty that the parameters will have.

        Options, each with the default of the façade where it is ``None``:

        * ``poses``: Number of readings, 1 to 1000: poses, of a laser lines.
        * ``instrument``: The instrument; it can take what its kind of readings and the volume allow.
        * ``balls``: R-test and touch probe: poses at which the functional point is at a ball on the table, such as
          ``X=100,Y=50``. Other axes are where ``at`` has them. By default there is one.
        * ``ball_radius``: Radius of the balls; above 0.
        * ``stylus``: The stylus; the functional point of the machine file is the middle of its ball.
        * ``stem``: Radius of the stems of the balls, along -Z of the workpiece; half that of the balls by default.
        * ``within``: Distance that each ball may be away from its place; above 0.
        * ``ranges``: Ranges of axes within the volume to which the readings are confined: ``A=-60..60,C=0..180``, mm
          and deg.
        * ``candidates``: The readings to choose from, in place of those of an instrument: a file as it is read once it
          is measured, whose cells of readings are empty.
        * ``fit``: Parameters to fit, as in ``IdentifyOptions``.
        * ``fixed``: Parameters that keep their value.
        * ``priors``: Values known before the data, as in ``IdentifyOptions``.
        * ``noise_mm``: Standard deviation of a reading, mm; above 0.
        * ``seed``: Seed of the readings to choose from.
        * ``until_mm``: Largest standard uncertainty of the deviation predicted over the volume, mm: the plan has as few
          of the readings as reach it.
        """
        options: dict[str, Any] = {
            "poses": poses,
            "instrument": instrument,
            "balls": balls,
            "ball_radius": ball_radius,
            "stylus": stylus,
            "stem": stem,
            "within": within,
            "ranges": ranges,
            "candidates": candidates,
            "fit": fit,
            "fixed": fixed,
            "priors": priors,
            "noise_mm": noise_mm,
            "seed": seed,
            "until_mm": until_mm,
        }
        found = call("plan", [self._native], options, threads=threads, progress=progress)
        return PlanResult(found)

    def predict(
        self,
        data: Iterable[Table] | Table | None = None,
        *,
        frame: Frame = "workpiece",
        axis_poses: Table | None = None,
        type_b: Sequence[Text] | None = None,
        noise_mm: float | None = None,
        seed: int = 1,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> PredictResult:
        """Compares readings with the prediction of the machine, without a fit.

        Options, each with the default of the façade where it is ``None``:

        * ``data``: Files of measurements, as ``identify`` takes them; several files are several set-ups.
        * ``frame``: Frame in which the deviations were measured.
        * ``axis_poses``: The poses of points that a laser tracker's export has by name.
        * ``type_b``: Standard uncertainties that all readings share, in words; one that the machine file names too
          counts once.
        * ``noise_mm``: Standard deviation (mm) of readings that do not state theirs; by default that of repeated
          readings.
        * ``seed``: Seed of the draws behind the share that chance explains.
        """
        paths, texts = files_and_texts(data)
        options: dict[str, Any] = {
            "data": paths,
            "frame": frame,
            "axis_poses": axis_poses,
            "type_b": type_b,
            "noise_mm": noise_mm,
            "seed": seed,
        }
        found = call("predict", [self._native], options, texts=texts, threads=threads, progress=progress)
        return PredictResult(found)

    def locate(
        self,
        path: Text | Mapping[str, bytes],
        *,
        target: TargetName | None = None,
        templates: Text | None = None,
        installed: Text | None = None,
        max_change: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> LocateResult:
        """Returns the location errors that a control's own calibration found, beside those of the machine file.

        Options, each with the default of the façade where it is ``None``:

        * ``target``: Name of the controller whose kinematic parameters the folder holds; by default the one that its
          files name.
        * ``templates``: A folder with targets of one's own, each a folder with a ``target.yaml``.
        * ``installed``: Folder with the kinematic parameters before the calibration; by default those of the nominal
          machine.
        * ``max_change``: Largest distance of an axis in force from that of the machine file, mm; 1 mm if none is
          stated.
        """
        options: dict[str, Any] = {
            "target": target,
            "templates": templates,
            "installed": installed,
            "max_change": max_change,
        }
        words, texts = folders_and_texts(path)
        found = call("locate", [self._native], options, words=words, texts=texts, threads=threads, progress=progress)
        return LocateResult(found)

    def compare_targets(
        self,
        *,
        poses: int = 2000,
        seed: int = 1,
        machines: int = 0,
        target: TargetName | None = None,
        tool_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> TargetsResult:
        """Compares what the files of each target leave of the errors of the machine.

        Options, each with the default of the façade where it is ``None``:

        * ``poses``: Number of poses of the volume.
        * ``seed``: Seed of the poses.
        * ``machines``: Number of machines that are drawn between the bounds of one of which nothing is measured; none
          by default.
        * ``target``: The only target that is tried; all by default.
        * ``tool_poses``: A file of tool poses: CSV or APT CL data.
        * ``job``: A job file instead of the tool poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out; by default the zero at the part's origin.
        """
        options: dict[str, Any] = {
            "poses": poses,
            "seed": seed,
            "machines": machines,
            "target": target,
            "tool_poses": tool_poses,
            "job": job,
            "path": path,
            "reference": reference,
        }
        found = call("compare_targets", [self._native], options, threads=threads, progress=progress)
        return TargetsResult(found)

    def compile(
        self,
        target: TargetName | Sequence[TargetName],
        *,
        compensation: CompensationOptions | None = None,
        poses: int = 2000,
        seed: int = 1,
        accept_unverified: bool = False,
        installed: Text | None = None,
        max_change: float | None = None,
        ini: Text | None = None,
        nothing_else: bool = False,
        out: Text | None = None,
        tool_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        max_correction: Limits | None = None,
        lattice: Sequence[Text] | None = None,
        max_nodes: int | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> CompileResult:
        """Compiles the files of a controller, with their certificate.

        ``target`` may be two: one of kinematic parameters, and one of tables for what they leave.

        Options, each with the default of the façade where it is ``None``:

        * ``target``: Name of the controller's folder, such as ``linuxcnc``.
        * ``compensation``: Options of the compensation.
        * ``poses``: Number of poses of the certificate.
        * ``seed``: Seed of the poses.
        * ``accept_unverified``: True if a format or a sign that is known from memory only may be written.
        * ``installed``: Folder with the files that were in force when the machine was measured: the new files are old
          plus new.
        * ``max_change``: Largest distance of an axis in force from that of the machine file, mm; 1 mm if none is
          stated.
        * ``ini``: INI file of LinuxCNC: the pole zone of a generated module is chosen by the limits of its drives.
        * ``nothing_else``: True if nothing else than kinematic parameters, or nothing but ``installed``, corrects the
          machine: tables in ``out`` are not in force.
        * ``out``: The folder that the files are for, which is searched for tables that kinematic parameters would add
          to.
        * ``tool_poses``: A file of tool poses: CSV or APT CL data.
        * ``job``: A job file instead of the tool poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out; by default the zero at the part's origin.
        * ``max_correction``: Limits on corrections.
        * ``lattice``: Names of the axes that span a lattice; all if empty. The others are at 0 in its nodes.
        * ``max_nodes``: Maximum number of lattice nodes.
        """
        targets = [target] if isinstance(target, (str, PathLike)) else [*target]
        options: dict[str, Any] = {
            "target": targets[0],
            "compensation": compensation,
            "poses": poses,
            "seed": seed,
            "accept_unverified": accept_unverified,
            "installed": installed,
            "max_change": max_change,
            "ini": ini,
            "nothing_else": nothing_else,
            "out": out,
            "tool_poses": tool_poses,
            "job": job,
            "path": path,
            "reference": reference,
            "max_correction": max_correction,
            "lattice": lattice,
            "max_nodes": max_nodes,
        }
        found = call("compile", [self._native], options, words=targets, threads=threads, progress=progress)
        return CompileResult(found)

    def verify(
        self,
        folder: Text | Mapping[str, bytes],
        *,
        target: TargetName | None = None,
        compensation: CompensationOptions | None = None,
        poses: int = 2000,
        seed: int = 1,
        installed: Text | None = None,
        max_change: float | None = None,
        tool_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        data: Sequence[Text] | None = None,
        frame: Frame = "workpiece",
        axis_poses: Table | None = None,
        type_b: Sequence[Text] | None = None,
        noise_mm: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> CertificateResult:
        """Replays the files in a folder, and certifies the residual.

        Options, each with the default of the façade where it is ``None``:

        * ``target``: Name of the controller; by default the one that the folder's manifest or its files name.
        * ``compensation``: Options of the compensation.
        * ``poses``: Number of poses of the certificate.
        * ``seed``: Seed of the poses.
        * ``installed``: Folder with the files that were in force when the machine was measured: the files judged here
          replace them.
        * ``max_change``: Largest distance of an axis in force from that of the machine file, mm; 1 mm if none is
          stated.
        * ``tool_poses``: A file of tool poses: CSV or APT CL data.
        * ``job``: A job file instead of the tool poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out; by default the zero at the part's origin.
        * ``data``: Files of measurements, as ``identify`` takes them; none: there is no second measurement.
        * ``frame``: Frame in which the deviations were measured.
        * ``axis_poses``: The poses of points that a laser tracker's export has by name.
        * ``type_b``: Standard uncertainties that all readings share, in words; one that the machine file names too
          counts once.
        * ``noise_mm``: Standard deviation (mm) of readings that do not state theirs; by default that of repeated
          readings.
        """
        options: dict[str, Any] = {
            "target": target,
            "compensation": compensation,
            "poses": poses,
            "seed": seed,
            "installed": installed,
            "max_change": max_change,
            "tool_poses": tool_poses,
            "job": job,
            "path": path,
            "reference": reference,
            "data": data,
            "frame": frame,
            "axis_poses": axis_poses,
            "type_b": type_b,
            "noise_mm": noise_mm,
        }
        words, texts = folders_and_texts(folder)
        found = call("verify", [self._native], options, words=words, texts=texts, threads=threads, progress=progress)
        return CertificateResult(found)

    def diff_sets(
        self,
        old: Text | Mapping[str, bytes],
        new: Text | Mapping[str, bytes],
        *,
        compensation: CompensationOptions | None = None,
        poses: int = 2000,
        seed: int = 1,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> SetDiffResult:
        """Returns what two sets of files differ in.

        Options, each with the default of the façade where it is ``None``:

        * ``compensation``: Compensation of the machine.
        * ``poses``: Number of poses over the volume, each approached from both sides.
        * ``seed``: Seed of the poses.
        """
        options: dict[str, Any] = {
            "compensation": compensation,
            "poses": poses,
            "seed": seed,
        }
        words, texts = folders_and_texts(old, new)
        found = call("diff_sets", [self._native], options, words=words, texts=texts, threads=threads, progress=progress)
        return SetDiffResult(found)

    def diff(
        self,
        other: Verbs,
        *,
        poses: int = 1000,
        tool_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        seed: int = 1,
        order: Order | None = None,
        approach: Approach = "mean",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> DiffResult:
        """Returns what two machines differ in, and what each difference does.

        Options, each with the default of the façade where it is ``None``:

        * ``poses``: Number of tool poses, drawn from the volume of the first machine.
        * ``tool_poses``: A file of tool poses instead; rotary columns are those of the first machine.
        * ``job``: A job file instead of the tool poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out of the deviations; by default the zero at the part's
          origin for tool poses, nothing for a volume.
        * ``seed``: Seed of the tool poses.
        * ``order``: Order of the errors; exact by default, unless the conventions of a machine name an order.
        * ``approach``: Side of approach, where forward and reverse curves were given.
        """
        options: dict[str, Any] = {
            "poses": poses,
            "tool_poses": tool_poses,
            "job": job,
            "path": path,
            "reference": reference,
            "seed": seed,
            "order": order_of(order),
            "approach": approach,
        }
        found = call("diff", [self._native, other._native], options, threads=threads, progress=progress)
        return DiffResult(found)

    def report(
        self,
        *others: Verbs,
        targets: Sequence[TargetName] | None = None,
        compensation: CompensationOptions | None = None,
        poses: int = 2000,
        tool_poses: Table | None = None,
        axis_poses: Table | None = None,
        job: Text | None = None,
        path: bool | None = None,
        reference: ReferenceOption | None = None,
        seed: int = 1,
        order: Order | None = None,
        approach: Approach = "mean",
        tolerances: ToleranceOptions | None = None,
        samples: int = 1000,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> ReportResult:
        """Returns one self-contained page of HTML for a design review.

        Options, each with the default of the façade where it is ``None``:

        * ``targets``: Controllers whose compensation and certificate are shown.
        * ``compensation``: Options of the compensation.
        * ``poses``: Number of poses of maps and certificates.
        * ``tool_poses``: A file of tool poses, of which statistics and comparison are taken: CSV or APT CL data.
        * ``axis_poses``: A CSV file of poses of the axes of the one machine instead, of which statistics and pictures
          are taken; its page asks its own questions over the volume. A header of axis names, one pose a line, mm and
          deg.
        * ``job``: A job file instead of the tool poses.
        * ``path``: True if the tool poses are one continuous path, solved as a whole; by default what the job file
          says, or else of CL data alone.
        * ``reference``: Motion that the part's set-up takes out of statistics, single errors and comparison; by default
          the zero at the part's origin for tool poses, nothing for a volume.
        * ``seed``: Seed of the poses, and of the errors that are drawn.
        * ``order``: Order of the errors; exact by default, unless the conventions of a machine name an order.
        * ``approach``: Side of approach, where forward and reverse curves were given.
        * ``tolerances``: Bounds, draws and statistic of errors, where a machine bounds some.
        * ``samples``: Number of machines that are drawn for a budget, at least 2.
        """
        options: dict[str, Any] = {
            "targets": targets,
            "compensation": compensation,
            "poses": poses,
            "tool_poses": tool_poses,
            "axis_poses": axis_poses,
            "job": job,
            "path": path,
            "reference": reference,
            "seed": seed,
            "order": order_of(order),
            "approach": approach,
            "tolerances": tolerances,
            "samples": samples,
        }
        found = call("report", [self._native, *(other._native for other in others)], options, threads=threads, progress=progress)
        return ReportResult(found)

    def import_touches(
        self,
        path: Text,
        *,
        touches: int = 8,
        coordinates: TouchCoordinates | None = None,
        accept: Sequence[Acceptance] | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> TouchImportResult:
        """Reads what a touch probe logged at balls: touches for a fit, centres with their covariance.

        Options, each with the default of the façade where it is ``None``:

        * ``touches``: Touches of a ball in a pose, 4 or more, of a log that does not name them.
        * ``coordinates``: The meaning of X, Y, Z, if the log does not state it; positions of the axes by default.
        * ``accept``: Suspicions that the caller accepts: ``suspect`` takes touches that stand out, and places that do
          not agree.
        """
        options: dict[str, Any] = {
            "touches": touches,
            "coordinates": coordinates,
            "accept": accept,
        }
        found = call("import_touches", [self._native], options, words=[path], threads=threads, progress=progress)
        return TouchImportResult(found)

    def measure(
        self,
        sets: Text,
        *,
        ball_radius: float = 12.5,
        stylus: Stylus | None = None,
        stem: float | None = None,
        within: float = 1.0,
        noise: float = 0.001,
        servo_period_s: float = 0.001,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> MeasureResult:
        """Writes the program of a controller that touches balls.

        Options, each with the default of the façade where it is ``None``:

        * ``ball_radius``: Radius of the balls; above 0.
        * ``stylus``: The stylus; the functional point of the machine file is the middle of its ball.
        * ``stem``: Radius of the stems of the balls, along -Z of the workpiece; half that of the balls by default.
        * ``within``: Distance that each ball may be away from its place; above 0.
        * ``noise``: Standard deviation of a touch; above 0.
        * ``servo_period_s``: Time between two looks of the controller at the probe, s; above 0.
        """
        options: dict[str, Any] = {
            "ball_radius": ball_radius,
            "stylus": stylus,
            "stem": stem,
            "within": within,
            "noise": noise,
            "servo_period_s": servo_period_s,
        }
        found = call("measure", [self._native], options, words=[sets], threads=threads, progress=progress)
        return MeasureResult(found)


def import_readings(
    path: Text,
    *,
    axis: Text | None = None,
    error: Text | None = None,
    unit: Text | None = None,
    contents: FileContents | None = None,
    runs: RunApproach | None = None,
    beam: Text | None = None,
    vertical: Text | None = None,
    flip: Sequence[Text] | None = None,
    columns: Text | None = None,
    line: StraightnessLine = "least-squares",
    keep_line: bool = False,
    continuous: bool = False,
    material: Text | None = None,
    uncertainty: Sequence[Text] | None = None,
    accept: Sequence[Acceptance] | None = None,
    needs_table: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> ImportResult:
    """Makes a table of error curves of a measurement as an instrument exports it.

    Options, each with the default of the façade where it is ``None``:

    * ``axis``: The axis that moved.
    * ``error``: The error whose runs the columns are, such as ``EXX``; of several errors the only one to take.
    * ``unit``: Unit of readings that have none in the file.
    * ``contents``: Errors, or corrections, which have the other sign; errors by default. Must be given where the layout
      of the file leaves it open.
    * ``runs``: Approach of runs without a direction.
    * ``beam``: Direction of the beam of a six-degree instrument, from the launch to the receiver, such as ``+X``.
    * ``vertical``: The machine's direction in which the vertical of that instrument points, such as ``+Z``.
    * ``flip``: Titles of its channels that change their sign.
    * ``columns``: A file that maps the columns.
    * ``line``: The line that is taken off a straightness.
    * ``keep_line``: Keeps it: the straightness was read against an artefact of the machine.
    * ``continuous``: The axis turns without end: positions modulo 360 deg, first row again at the end.
    * ``material``: Temperature and expansion of the machine's material, such as ``22.5 degC x 11.5 um/m/K``: positions
      of a linear axis are brought to 20 deg C, about the first target.
    * ``uncertainty``: Contributors to the uncertainty of the figures (ISO 230-2 annex A), such as ``device 0.5 um/m``,
      ``misalignment 1 mm``, ``temperature 0.7 K x 11.5 um/m/K``, ``expansion 2 um/m/K x 5 K``, ``drift 1.2 um``.
    * ``accept``: Suspicions that the caller accepts: ``suspect`` takes readings that accuse themselves.
    * ``needs_table``: Refuses a file whose table would have no row.
    """
    options: dict[str, Any] = {
        "axis": axis,
        "error": error,
        "unit": unit,
        "contents": contents,
        "runs": runs,
        "beam": beam,
        "vertical": vertical,
        "flip": flip,
        "columns": columns,
        "line": line,
        "keep_line": keep_line,
        "continuous": continuous,
        "material": material,
        "uncertainty": uncertainty,
        "accept": accept,
        "needs_table": needs_table,
    }
    found = call("import_readings", [], options, words=[path], threads=threads, progress=progress)
    return ImportResult(found)


def figures(
    path: Text,
    *,
    test: StandardTest = "circle",
    plane: Plane = "XY",
    radius_mm: float = 100.0,
    feed: float | None = None,
    distance_mm: float | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> FiguresResult:
    """Returns figures of the ISO 230 series from the readings of a test.

    Options, each with the default of the façade where it is ``None``:

    * ``test``: The test.
    * ``plane``: Circle: its plane.
    * ``radius_mm``: Circle: its nominal radius, above 0 and up to 10000 mm.
    * ``feed``: Circle: its feed, mm/min.
    * ``distance_mm``: Rotation and drift: distance of the planes of the first and the second probe, mm; the second
      towards the tool holder.
    """
    options: dict[str, Any] = {
        "test": test,
        "plane": plane,
        "radius_mm": radius_mm,
        "feed": feed,
        "distance_mm": distance_mm,
    }
    found = call("figures", [], options, words=[path], threads=threads, progress=progress)
    return FiguresResult(found)


def testpiece(
    kind: TestPieceKind = "cone",
    *,
    size_mm: float | None = None,
    height_mm: float | None = None,
    half_apex_deg: float | None = None,
    tilt_deg: float | None = None,
    c_motion: ConeMotion | None = None,
    steps: int = 360,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TestPieceResult:
    """Makes a test piece of a standard as a job.

    Options, each with the default of the façade where it is ``None``:

    * ``kind``: The kind.
    * ``size_mm``: Side of a square, also of that about a diamond, or of a box; diameter of a circle or of the base of a
      cone; length of an S; 0.1 to 100000 mm; by default 160, of a cone 80.
    * ``height_mm``: Height of the contour, of a box, or of the centre of a cone's base above the part's origin, 0.1 to
      100000 mm; by default 20, of a cone 120, of an S the height of its surface, 40, of a box its side.
    * ``half_apex_deg``: Cone: half of its apex angle, above 0 and below 80 deg; by default 15.
    * ``tilt_deg``: Cone: tilt of its axis about Y, 0 to 80 deg; S: the largest lean of its surface; diamond, also of
      NAS 979: its turn against the square. By default 10 of a cone or by its motion, 20 of an S, 30 of a diamond.
    * ``c_motion``: Cone: the motion of a rotary axis about Z, which chooses the tilt in place of an angle.
    * ``steps``: Number of intervals of a circle, or of each side, 8 to 100000. Of a box, number of tool poses on each
      face, in equal rows, so that there may be a few more.
    """
    options: dict[str, Any] = {
        "kind": kind,
        "size_mm": size_mm,
        "height_mm": height_mm,
        "half_apex_deg": half_apex_deg,
        "tilt_deg": tilt_deg,
        "c_motion": c_motion,
        "steps": steps,
    }
    found = call("testpiece", [], options, threads=threads, progress=progress)
    return TestPieceResult(found)


def record(
    description: Text,
    *,
    tool: Text | None = None,
    compensation: CompensationOptions | None = None,
    poses: int = 2000,
    seed: int = 1,
    sign: Text | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> RecordResult:
    """Makes the record of a calibration from its description.

    Options, each with the default of the façade where it is ``None``:

    * ``tool``: Tool of the machine; the first by default.
    * ``compensation``: Options of the compensation, with which the sets are verified.
    * ``poses``: Number of poses of certificates and comparisons.
    * ``seed``: Seed of the poses.
    * ``sign``: File of the private key that signs a record: ed25519, PKCS #8 in PEM.
    """
    options: dict[str, Any] = {
        "tool": tool,
        "compensation": compensation,
        "poses": poses,
        "seed": seed,
        "sign": sign,
    }
    found = call("record", [], options, words=[description], threads=threads, progress=progress)
    return RecordResult(found)


def record_trend(
    *folders: Text,
    tool: Text | None = None,
    compensation: CompensationOptions | None = None,
    poses: int = 2000,
    seed: int = 1,
    sign: Text | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TrendResult:
    """Puts records of one machine in a line: every error over the dates.

    Options, each with the default of the façade where it is ``None``:

    * ``tool``: Tool of the machine; the first by default.
    * ``compensation``: Options of the compensation, with which the sets are verified.
    * ``poses``: Number of poses of certificates and comparisons.
    * ``seed``: Seed of the poses.
    * ``sign``: File of the private key that signs a record: ed25519, PKCS #8 in PEM.
    """
    options: dict[str, Any] = {
        "tool": tool,
        "compensation": compensation,
        "poses": poses,
        "seed": seed,
        "sign": sign,
    }
    found = call("record_trend", [], options, words=[*folders], threads=threads, progress=progress)
    return TrendResult(found)
