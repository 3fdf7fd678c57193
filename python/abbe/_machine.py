"""Machines."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abbe
from ._calls import json_of, order_of, spelt, threads_of
from ._diagnostics import DiagnosticError, warn
from ._fields import ChainAxis, ChainResult, ChainTool, Conventions, MachineSummary
from ._readings import real
from ._record import Record
from ._results import BudgetResult, html_table, inline
from ._types import Poses, Progress, Text
from ._verbs import BudgetOptions, Verbs

if TYPE_CHECKING:
    import pandas
    from typing_extensions import Unpack

Approach = Literal["mean", "forward", "reverse"]
Frame = Literal["workpiece", "machine", "tool"]


class Deviations(NamedTuple):
    """Deviations at N poses, actual minus nominal, of the tool relative to the workpiece."""

    #: Displacement of the functional point along x, y, z, shape (N, 3), mm.
    position: NDArray[np.float64]
    #: Rotation of the tool about x, y, z, shape (N, 3), rad.
    rotation: NDArray[np.float64]

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the columns ``dx [um]``, ..., ``wz [urad]`` as a DataFrame (needs pandas)."""
        import pandas

        columns = {f"d{letter} [um]": self.position[:, k] * 1e3 for k, letter in enumerate("xyz")}
        columns.update({f"w{letter} [urad]": self.rotation[:, k] * 1e6 for k, letter in enumerate("xyz")})
        return pandas.DataFrame(columns)


class Nominal(NamedTuple):
    """The tool of the machine without errors at N poses, in the coordinates of the part."""

    #: The functional point from the workpiece origin, shape (N, 3), mm.
    tip: NDArray[np.float64]
    #: Unit vectors from it towards the spindle, shape (N, 3).
    direction: NDArray[np.float64]


class ErrorTerm(Record):
    """An error of a machine.

    ``kind`` is location, component or tolerance. ``value`` is in ``unit``, the bound for a tolerance; a component error
    has no single value: its ``value`` is ``None``. The term is a function of the position of its axis.
    """

    __slots__ = ("_at",)

    def __init__(self, value: dict[str, Any], at: tuple[_abbe.NativeMachine, str]) -> None:
        super().__init__(value)
        self._at = at

    def __call__(self, positions: ArrayLike, *, approach: Approach = "mean") -> NDArray[np.float64]:
        """Returns the values at positions of the axis (mm or deg), in ``unit``; of a tolerance 0."""
        given = _positions("the axis", positions)
        flat = np.ascontiguousarray(given).reshape(-1)
        return _abbe.curve(*self._at, flat, approach).reshape(given.shape)

    kind: Literal["location", "component", "tolerance"]
    value: Any
    unit: Literal["mm", "rad"]


class Machine(Verbs):
    """A machine tool: its kinematic chain and its geometric errors, as :func:`abbe.load` reads them.

    A machine never changes. It pickles with every file that it was read from, so that it can be sent to another
    process or another computer.
    """

    def __init__(
        self,
        path: str,
        texts: tuple[tuple[str, str], ...] = (),
        tool: str | None = None,
        changes: Mapping[str, Any] | None = None,
    ) -> None:
        self._arguments = (path, tool, dict(changes or {}))
        if changes:
            name, text = _variant(path, {name for name, _ in texts}, changes)
            texts, path = ((name, text), *texts), name
        self._native = _abbe.load(path, list(texts), tool)

    def __reduce__(self) -> tuple[Any, ...]:
        path, tool, changes = self._arguments
        texts = [text for text in self._native.texts() if not changes or text[0] != self.path]
        return _restored, (path, tuple(texts), tool, changes)

    def __dask_tokenize__(self) -> object:
        return self.__reduce__()[1]

    def _identity(self) -> tuple[Any, ...]:
        # The text of a variant names its place, and says what changed.
        return (*self._sources(), self._arguments[2].__repr__(), self.tool)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Machine) and self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_"):
            raise AttributeError(f"a machine does not change: `with_` returns a variant with another `{name}`")
        super().__setattr__(name, value)

    def __repr__(self) -> str:
        return f"<Machine {self.name!r}: {self.chain}>"

    @property
    def name(self) -> str:
        """The name of the machine."""
        return self._native.name()

    @property
    def path(self) -> str:
        """The name of its file."""
        return self._native.path()

    @property
    def texts(self) -> dict[str, str]:
        """The text of every file that the machine was read from, by name, in the order read."""
        return dict(self._native.texts())

    @cached_property
    def axis_names(self) -> tuple[str, ...]:
        """The names of the axes in the order of the chain, which is that of the columns of poses."""
        return tuple(self._native.axes())

    @cached_property
    def grid(self) -> Mapping[str, NDArray[np.float64]]:
        """The positions of the nodes of the grid of the volume by axis, mm and deg; arrays to read."""
        nodes = {name: np.array(of) for name, of in zip(self.axis_names, self._native.grid(), strict=True)}
        for of in nodes.values():
            of.flags.writeable = False
        return MappingProxyType(nodes)

    @cached_property
    def geometry(self) -> ChainResult:
        """The kinematic chain in numbers, as ``abbe show --format json`` prints it."""
        return ChainResult(json.loads(self._native.show()))

    @cached_property
    def summary(self) -> MachineSummary:
        """The machine in short, as ``abbe check --format json`` prints it."""
        return MachineSummary(json.loads(self._native.summary()))

    @property
    def chain(self) -> str:
        """The chain from workpiece to tool, such as ``w C' A' Y' b X Z t``."""
        return self.geometry.chain

    @property
    def axes(self) -> dict[str, ChainAxis]:
        """The axes by name: direction, origin (mm), travel (mm or deg), lever arms (mm)."""
        return {axis.name: axis for axis in self.geometry.axes}

    @property
    def tools(self) -> list[ChainTool]:
        """The tools, in machine coordinates at the zero pose."""
        return self.geometry.tools

    @property
    def tool(self) -> str:
        """The name of the tool in use; empty for a tool without a name."""
        return self._native.tool()

    @property
    def conventions(self) -> Conventions:
        """The conventions in force."""
        return self.geometry.conventions

    @cached_property
    def errors(self) -> Mapping[str, ErrorTerm]:
        """The errors by name, mm and rad; each is a function of the position of its axis, too."""
        found = json.loads(self._native.errors())
        return MappingProxyType({name: ErrorTerm(error, (self._native, name)) for name, error in found.items()})

    def with_tool(self, name: str) -> Machine:
        """Returns the machine with another of its tools."""
        path, _, changes = self._arguments
        return Machine(path, self._sources(), name, changes)

    def with_(self, changes: Mapping[str, Any]) -> Machine:
        """Returns a variant of the machine: entries of the YAML by their path, such as ``"errors.EC0Y": "12 urad"``.

        The variant is a file that extends the machine's, by the rules of ``extends`` in docs/language.md: mappings
        merge key by key, axes by field; an error term and every list are replaced whole; ``None`` removes an entry.
        """
        path, tool, before = self._arguments
        below = tuple(f"{name}." for name in changes)
        kept = {name: value for name, value in before.items() if name not in changes and not name.startswith(below)}
        variant = Machine(path, self._sources(), tool, {**kept, **changes})
        warn(variant._native.warnings(), 2, known=self._native.warnings())
        return variant

    def _sources(self) -> tuple[tuple[str, str], ...]:
        changes = self._arguments[2]
        return tuple(text for text in self._native.texts() if not changes or text[0] != self.path)

    def deviations(
        self,
        poses: Poses,
        *,
        order: int | str | None = None,
        approach: Approach = "mean",
        frame: Frame = "workpiece",
        threads: int | None = None,
        out: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None,
    ) -> Deviations:
        """Returns the deviations at many poses.

        ``poses`` is an array of shape (N, axes), columns in the order of :attr:`axis_names`, mm and deg; or columns of
        positions by the names of the axes: axes left out are at 0, and a single number counts for all poses. Columns,
        and arrays in column order (``order="F"``), are read where they are; arrays in row order are gathered as they
        are read. The results are in column order.

        ``order`` is ``"exact"`` or 1 to 6; by default the one that the conventions of the machine name, or exact.
        ``approach`` is the side of approach, where forward and reverse curves were given. ``out`` is a pair of arrays
        of shape (N, 3) in column order to write into, such as the result of a call before: new memory takes time.
        """
        positions = self._positions(poses)
        self._warn_of_radians(positions)
        try:
            native = self._native.deviations(positions, order_of(order), approach, frame, threads_of(threads), out)
        except DiagnosticError as refused:
            raise self._with_place(refused, positions) from None
        return Deviations(*native)

    def _with_place(self, refused: DiagnosticError, positions: Any) -> DiagnosticError:
        """Returns a refusal of poses with the first row that is no pose of the machine, and its axis."""
        columns = positions if isinstance(positions, list) else list(np.atleast_2d(positions).T)
        for name, column in zip(self.axis_names, columns, strict=False):
            low, high = self.axes[name].travel
            beyond = (column < low) | (column > high) if not self.axes[name].continuous else np.abs(column) > 1e6
            rows = np.flatnonzero(beyond | ~np.isfinite(column))
            if rows.size and refused.code in ("E0802", "E0803"):
                place = f"first at row {rows[0]} of the poses: {name} = {column[rows[0]]}"
                return type(refused)(f"{refused.text}\n{place}", refused.diagnostics)
        return refused

    def _warn_of_radians(self, positions: Any) -> None:
        """Warns of rotary columns of a sweep that look like radians: positions are in deg."""
        columns = positions if isinstance(positions, list) else list(positions.T)
        for name, column in zip(self.axis_names, columns, strict=False):
            if self.axes[name].kind != "rotary" or column.size < 20:
                continue
            low, high = float(column.min()), float(column.max())
            if high - low > 3 and max(high, -low) <= 2 * np.pi:
                words = f"the column {name!r} turns by more than 3 and ends before 2 pi: are these radians?"
                warnings.warn(f"{words} Positions of rotary axes are in deg.", stacklevel=3)

    def _positions(self, poses: Poses) -> Any:
        names = _column_names(poses)
        if names is not None:
            return self._columns(poses, names)
        array = real(poses, "poses")
        if array.ndim == 1:
            array = array.reshape(1, -1)
        if array.ndim != 2:
            raise ValueError(f"poses have the shape (N, {len(self.axis_names)}), not {array.shape}")
        if array.flags.c_contiguous or array.flags.f_contiguous:
            return array
        if array.strides[0] == array.itemsize:
            return [array[:, k] for k in range(array.shape[1])]
        return np.ascontiguousarray(array)

    def _columns(self, poses: Any, names: list[str]) -> list[NDArray[np.float64]]:
        unknown = [name for name in names if name not in self.axis_names]
        if unknown:
            known = ", ".join(self.axis_names)
            raise ValueError(f"the chain has no axis {', '.join(map(repr, unknown))}; its axes are {known}")
        given = {name: _positions(name, poses[name]) if name in names else np.zeros(()) for name in self.axis_names}
        counts = {name: len(column) for name, column in given.items() if column.ndim and len(column) != 1}
        if len(set(counts.values())) > 1:
            lengths = ", ".join(f"{name} {count}" for name, count in counts.items())
            raise ValueError(f"the columns of positions are not of one length: {lengths}")
        shape = (next(iter(counts.values()), 1),)
        return [np.ascontiguousarray(np.broadcast_to(column, shape)) for column in given.values()]

    def goal(
        self,
        length: str,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        **options: Unpack[BudgetOptions],
    ) -> BudgetResult:
        """Seeks the cheapest tolerances for a 95 % value of the position, such as ``"30 um"``.

        The options are those of :meth:`budget`; the answer is the field ``goal`` of the result.
        """
        if not isinstance(length, str):
            raise TypeError(f"a length with its unit, such as '30 um', and not {length!r}")
        options["goal_mm"] = _abbe.length_mm(length)
        return self.budget(**options, threads=threads, progress=progress)

    def nominal(self, poses: Poses, *, threads: int | None = None) -> Nominal:
        """Returns tip and direction of the tool of the machine without errors, in the coordinates of the part."""
        rows = self._rows(poses)
        found = _abbe.nominal(self._native, rows, threads_of(threads)).reshape(-1, 6)
        return Nominal(found[:, :3], found[:, 3:])

    def inverse(
        self, tips: ArrayLike, directions: ArrayLike, *, path: bool = False, threads: int | None = None
    ) -> NDArray[np.float64]:
        """Returns poses, shape (N, axes), at which the machine without errors holds its tool so; NaN out of reach.

        ``tips`` are points of the part (mm), ``directions`` vectors from them towards the spindle, both of shape
        (N, 3); one direction counts for all. ``path`` solves them as one continuous path: the fewest rewinds, then the
        least motion.
        """
        points = real(tips, "tips")
        both = np.hstack([points, np.broadcast_to(real(directions, "directions"), points.shape)])
        columns = dict(zip(("X [mm]", "Y [mm]", "Z [mm]", "I", "J", "K"), both.T, strict=True))
        found = self.map(poses={"tool_poses": columns}, path=path, order=1, worst=0, rows=True, threads=threads)
        poses = np.full((len(both), len(self.axis_names)), np.nan)
        # The first line has the names.
        missed = [row["line"] - 2 for row in found.to_dict()["tool_poses"]["rows"]]
        rows = [found.rows[name] for name in (found.rows.dtype.names or ())[: len(self.axis_names)]]
        poses[np.setdiff1d(np.arange(len(both)), missed)] = np.column_stack(rows)
        return poses

    def jacobian(
        self,
        poses: Poses,
        errors: Sequence[str] | None = None,
        *,
        frame: Frame = "workpiece",
        threads: int | None = None,
    ) -> NDArray[np.float64]:
        """Returns the deviation for 1 mm or 1 rad of each error, to first order: shape (N, 6, errors).

        The six rows are the position along x, y, z and the rotation about x, y, z; the errors are those of the machine
        unless ``errors`` names others of its chain.
        """
        names = list(self.errors if errors is None else errors)
        found = _abbe.jacobian(self._native, self._rows(poses), names, frame, threads_of(threads))
        return found.reshape(-1, 6, len(names))

    def uncertainty(
        self, poses: Poses, *, approach: Approach = "mean", frame: Frame = "workpiece", threads: int | None = None
    ) -> Deviations:
        """Returns the expanded uncertainty (k = 2) of the deviations, where the machine states that of its errors."""
        found = _abbe.uncertainty(self._native, self._rows(poses), approach, frame, threads_of(threads))
        if found is None:
            raise ValueError("the machine states no uncertainty of its errors")
        return Deviations(found.reshape(-1, 6)[:, :3], found.reshape(-1, 6)[:, 3:])

    def drawn_deviations(
        self,
        poses: Poses,
        values: Mapping[str, ArrayLike],
        *,
        order: int | str | None = None,
        approach: Approach = "mean",
        threads: int | None = None,
    ) -> Deviations:
        """Returns the deviations of M machines at N poses: arrays of shape (M, N, 3).

        ``values`` has for location errors by name the M values (mm and rad), or one for all, in place of those of the
        machine: a mapping, a DataFrame, a structured array.
        """
        names = _column_names(values)
        if not names:
            raise ValueError("values by the names of location errors")
        table = np.stack(np.broadcast_arrays(*(np.atleast_1d(real(values[name], name)) for name in names)), axis=1)
        rows, table = self._rows(poses), np.ascontiguousarray(table)
        found = _abbe.drawn(self._native, rows, names, table, order_of(order), approach, threads_of(threads))
        by_machine = found.reshape(len(table), 6, len(rows)).transpose(0, 2, 1)
        return Deviations(by_machine[..., :3], by_machine[..., 3:])

    def _listed(self, poses: Poses | None) -> list[list[float]] | None:
        return None if poses is None else list(self._rows(poses).tolist())

    def _rows(self, poses: Poses) -> NDArray[np.float64]:
        positions = self._positions(poses)
        rows = np.column_stack(positions) if isinstance(positions, list) else positions
        return np.ascontiguousarray(rows)

    def _picture_again(self, options: Mapping[str, Any], threads: int | None) -> Callable[[], Any]:
        # The picture hangs on a plane, and not on the poses.
        asked = {**options, "poses": {"random": 1}, "worst": 0, "picture": options.get("picture") or {}}
        return self._again("map", asked, [], threads)

    def _fit_picture_again(
        self, options: Mapping[str, Any], texts: list[tuple[str, str]], threads: int | None
    ) -> Callable[[], Any]:
        asked = {**options, "pictures": True, "folds": None, "machine_file": False}
        return self._again("identify", asked, texts, threads)

    def _again(
        self, verb: str, options: Mapping[str, Any], texts: list[tuple[str, str]], threads: int | None
    ) -> Callable[[], Any]:
        """Returns a call that computes a verb for its pictures; it returns none where there is nothing to draw."""

        def again() -> Any:
            try:
                named = list(texts)
                asked = json_of(spelt(options, named))
                return _abbe.run(verb, [self._native], [], asked, named, False, threads_of(threads))
            except DiagnosticError:
                return None

        return again

    @property
    def chain_svg(self) -> str:
        """A picture of the chain, SVG."""
        return self._native.chain_svg()

    @property
    def curves_svg(self) -> str | None:
        """A picture of the curves of the component errors, SVG; none without component errors."""
        return self._native.curves_svg()

    def _repr_html_(self) -> str:
        counts = {"location": 0, "component": 0, "tolerance": 0}
        for error in self.errors.values():
            counts[error["kind"]] += 1
        errors = ", ".join(f"{count} {kind}" for kind, count in counts.items())
        facts = [("machine", self.name), ("file", self.path), ("chain", self.chain), ("errors", errors)]
        return html_table(facts) + inline(self.chain_svg)


def load(path: Text, *, tool: str | None = None) -> Machine:
    """Reads a machine file, and the files that it extends and names.

    ``tool`` is the name of the tool in use; the first by default. Raises :class:`abbe.DiagnosticError` with all faults
    of the files, each with its place; warns with :class:`abbe.DiagnosticWarning`.
    """
    machine = Machine(os.fspath(path), (), tool)
    warn(machine._native.warnings(), 2)
    return machine


def loads(
    text: str, *, files: Mapping[str, str] | None = None, name: str = "machine.yaml", tool: str | None = None
) -> Machine:
    """Reads a machine from the text of a machine file.

    ``files`` are texts of files that it names, by name; others are read from the disk, relative to the folder of
    ``name``.
    """
    machine = Machine(name, ((name, text), *(files or {}).items()), tool)
    warn(machine._native.warnings(), 2)
    return machine


def _restored(path: str, texts: tuple[tuple[str, str], ...], tool: str | None, changes: dict[str, Any]) -> Machine:
    return Machine(path, texts, tool, changes)


def _variant(path: str, taken: set[str], changes: Mapping[str, Any]) -> tuple[str, str]:
    """Returns name and text of a file that extends another; JSON is YAML."""
    tree: dict[str, Any] = {"abbe": 1, "extends": os.path.basename(path)}
    for place, value in changes.items():
        *above, last = place.split(".")
        branch = tree
        for key in above:
            inner = branch.get(key)
            branch[key] = dict(inner) if isinstance(inner, dict) else {}
            branch = branch[key]
        branch[last] = value
    stem, ending = os.path.splitext(path)
    name, count = f"{stem}.variant{ending}", 1
    while name in taken or os.path.exists(name):
        count += 1
        name = f"{stem}.variant{count}{ending}"
    return name, json.dumps(tree, default=lambda value: value.tolist(), ensure_ascii=False)


def _positions(name: str, column: Any) -> NDArray[np.float64]:
    """Returns the positions of an axis: one number, or a column."""
    try:
        positions = real(column, f"the positions of {name}")
    except (TypeError, ValueError) as why:
        raise ValueError(f"the positions of {name} are no numbers (mm or deg): {why}") from None
    if positions.ndim > 1:
        raise ValueError(f"the positions of {name} have the shape (N,), not {positions.shape}")
    return positions


def _column_names(poses: Any) -> list[str] | None:
    """Returns the names of columns; none for an array."""
    if isinstance(poses, Mapping):
        return [str(name) for name in poses]
    names = getattr(poses, "columns", None)
    if names is not None:
        return [str(name) for name in names]
    return list(names) if (names := getattr(getattr(poses, "dtype", None), "names", None)) else None
