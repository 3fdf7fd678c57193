"""Work that outgrows one machine, on Dask: ``pip install abbe[dask]``.

Everything here is lazy: it returns Dask's own objects, whose ``compute()`` runs on whatever scheduler or cluster is
current. Pieces of work are known by their index and are put together in the order of their indices, so that the result
has the same bytes for any number of workers, any order of arrival, and when a worker was lost in between. A task takes
one thread unless ``threads`` says otherwise. docs/cluster.md tells how to run this on several computers.
"""

from __future__ import annotations

import builtins
import hashlib
import itertools
import math
import os
import pickle
import tempfile
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import dask
import dask.array
import numpy as np
import pyarrow
import pyarrow.parquet
from dask.delayed import Delayed, delayed
from dask.highlevelgraph import HighLevelGraph
from numpy.typing import ArrayLike, NDArray

from ._calls import task_threads
from ._diagnostics import DiagnosticError
from ._machine import Approach, Frame, Machine
from ._results import BudgetResult, EnumerateResult, IdentifyResult
from ._spaces import Grid, Interval, Sample, Space, refuse_missing
from ._types import Text

if TYPE_CHECKING:
    import xarray
    from typing_extensions import Unpack

    from ._verbs import BudgetOptions, EnumerateOptions, IdentifyOptions

#: :func:`enumerate` is not among them: a star import would hide Python's own.
__all__ = [
    "Grid",
    "GridDeviations",
    "Interval",
    "Sample",
    "Space",
    "Table",
    "budget",
    "deviations",
    "evaluate",
    "identify_files",
    "identify_noise",
]

#: Nodes of a block of a map: about 12 MB of positions and deviations, and several times that while they are computed.
NODES = 1 << 17


class _Sent:
    """A machine for tasks: a process reads it once, however many tasks name it."""

    __slots__ = ("digest", "packed")

    def __init__(self, machine: Machine) -> None:
        self.packed = pickle.dumps(machine, protocol=5)
        self.digest = hashlib.sha256(self.packed).hexdigest()

    def machine(self) -> Machine:
        known = _machines.get(self.digest)
        if known is None:
            if len(_machines) >= _MAX_MACHINES:
                _machines.clear()
            known = _machines[self.digest] = pickle.loads(self.packed)
        return known

    def __dask_tokenize__(self) -> object:
        return self.digest


_MAX_MACHINES = 16
_machines: dict[str, Machine] = {}


@contextmanager
def _task(threads: int) -> Iterator[None]:
    """Calls of the package within take so many threads."""
    token = task_threads.set(threads)
    try:
        yield
    finally:
        task_threads.reset(token)


def _sent(machine: Machine) -> Any:
    # A key of its own: the scheduler sends it to a worker once, and not with every task.
    sent = _Sent(machine)
    return delayed(sent, name=f"abbe-machine-{sent.digest}", pure=True, traverse=False)


def _named(name: str, token: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """Returns a task that Dask's dashboard shows under a name."""
    return delayed(function, pure=True, traverse=True)(*arguments, dask_key_name=f"abbe-{name}-{token}")


# Tables ------------------------------------------------------------------------------------------------------------


class Table:
    """A table in parts, each made by one task: ``parts`` are Dask's delayed Arrow tables in their order."""

    def __init__(self, parts: Sequence[Delayed], schema: pyarrow.Schema) -> None:
        self.parts = tuple(parts)
        self.schema = schema

    def __repr__(self) -> str:
        return f"<Table: {len(self.parts)} parts, {', '.join(self.schema.names)}>"

    def compute(self, **options: Any) -> pyarrow.Table:
        """Returns the whole table; the options are those of ``dask.compute``."""
        return pyarrow.concat_tables([self.schema.empty_table(), *dask.compute(*self.parts, **options)])

    def to_parquet(self, folder: Text, *, compression: str = "zstd", **options: Any) -> list[Path]:
        """Writes a file for each part into a folder that is new or empty, and returns their paths in order.

        The workers write, so that the folder is one that all of them see. A file appears under its name when it is
        whole. ``dask.dataframe.read_parquet(folder)`` reads them as one table.
        """
        path = Path(folder).resolve()
        path.mkdir(parents=True, exist_ok=True)
        if any(path.iterdir()):
            raise FileExistsError(f"{path} is not empty")
        digits = len(str(max(len(self.parts) - 1, 0)))
        names = [path / f"part-{index:0{digits}}.parquet" for index in range(len(self.parts))]
        write = delayed(_written, pure=False, traverse=False)
        tasks = [write(part, str(name), compression) for part, name in zip(self.parts, names, strict=True)]
        dask.compute(*tasks, **options)
        # What a lost worker left behind.
        for left in path.glob(".part-*.tmp"):
            left.unlink(missing_ok=True)
        return names


def _written(part: pyarrow.Table, name: str, compression: str) -> None:
    path = Path(name)
    own = path.with_name(f".{path.stem}-{uuid.uuid4().hex}.tmp")
    try:
        pyarrow.parquet.write_table(part, own, compression=compression)
        os.replace(own, path)
    finally:
        own.unlink(missing_ok=True)


# Maps --------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class GridDeviations:
    """Deviations at the nodes of a grid, as Dask arrays; none is computed yet."""

    #: Positions along the axes that the grid runs over, mm and deg, in the order of the dimensions.
    axes: Mapping[str, NDArray[np.float64]]
    #: Displacement of the functional point along x, y, z, shape (n1, ..., nk, 3), mm.
    position: Any
    #: Rotation of the tool about x, y, z, shape (n1, ..., nk, 3), rad.
    rotation: Any
    _table: Table

    def __repr__(self) -> str:
        return f"<GridDeviations: {' x '.join(f'{name} {len(of)}' for name, of in self.axes.items())}>"

    @property
    def table(self) -> Table:
        """The nodes as rows, the last axis fastest, with the columns of ``abbe map --csv`` in mm, deg, um and urad."""
        return self._table

    def to_parquet(self, folder: Text, **options: Any) -> list[Path]:
        """Writes :attr:`table` straight to partitioned Parquet, as :meth:`Table.to_parquet` does."""
        return self._table.to_parquet(folder, **options)

    def to_xarray(self) -> xarray.Dataset:
        """Returns the deviations as a dataset of Dask arrays, a dimension for each axis (needs xarray)."""
        import xarray

        dimensions = list(self.axes)
        both = ((self.position, "d", "mm"), (self.rotation, "w", "rad"))
        variables = {
            f"{name}{letter}": (dimensions, array[..., k], {"units": unit})
            for array, name, unit in both
            for k, letter in builtins.enumerate("xyz")
        }
        return xarray.Dataset(variables, {name: (name, of) for name, of in self.axes.items()})


@dataclass(frozen=True)
class _Evaluation:
    """How a map is evaluated."""

    order: int | str | None
    approach: Approach
    frame: Frame
    threads: int

    def deviations(self, machine: Machine, axes: Mapping[str, NDArray[np.float64]]) -> tuple[Any, Any]:
        """Returns the columns of positions at the nodes of a block, the last axis fastest, and their deviations."""
        nodes = np.meshgrid(*axes.values(), indexing="ij", copy=False)
        columns = {name: np.ascontiguousarray(of).reshape(-1) for name, of in zip(axes, nodes, strict=True)}
        with _task(self.threads):
            found = machine.deviations(columns, order=self.order, approach=self.approach, frame=self.frame)
        return columns, found


def _block(sent: _Sent, evaluation: _Evaluation, axes: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Returns the deviations at the nodes of a block: shape (n1, ..., nk, 6), mm and rad."""
    _, found = evaluation.deviations(sent.machine(), axes)
    shape = [len(of) for of in axes.values()]
    return np.concatenate([found.position, found.rotation], axis=1).reshape(*shape, 6)


def _rows(sent: _Sent, evaluation: _Evaluation, axes: Mapping[str, NDArray[np.float64]]) -> pyarrow.Table:
    """Returns the nodes of a block as rows."""
    columns, found = evaluation.deviations(sent.machine(), axes)
    names = _row_names(sent.machine(), list(axes))
    values = [*columns.values()]
    # Adding zero turns -0 into 0, as the program's tables have it.
    values += [found.position[:, k] * 1e3 + 0.0 for k in range(3)]
    values += [found.rotation[:, k] * 1e6 + 0.0 for k in range(3)]
    return pyarrow.table(dict(zip(names, values, strict=True)))


def _row_names(machine: Machine, axes: Sequence[str]) -> list[str]:
    names = [f"{name} [{machine.axes[name]['unit']}]" for name in axes]
    return names + [f"d{letter} [um]" for letter in "xyz"] + [f"w{letter} [urad]" for letter in "xyz"]


def deviations(
    machine: Machine,
    axes: Mapping[str, ArrayLike] | None = None,
    *,
    order: int | str | None = None,
    approach: Approach = "mean",
    frame: Frame = "workpiece",
    nodes: int = NODES,
    threads: int = 1,
) -> GridDeviations:
    """Maps the error over a grid that may be too large for one machine.

    ``axes`` are positions by axis, mm and deg; axes left out are at 0. Without it the grid is that of the volume of the
    machine. A task evaluates a block of at most ``nodes`` nodes; the other options are those of
    :meth:`abbe.Machine.deviations`.
    """
    given = machine.grid if axes is None else axes
    unknown = [name for name in given if name not in machine.axis_names]
    if unknown or not given:
        raise ValueError(f"a grid runs over some of the axes {', '.join(machine.axis_names)}, not {unknown}")
    along = {name: np.asarray(given[name], dtype=np.float64) for name in machine.axis_names if name in given}
    if any(of.ndim != 1 or not of.size for of in along.values()):
        raise ValueError("positions along an axis have the shape (N,)")
    evaluation = _Evaluation(order, approach, frame, threads)
    # Refused here rather than in every task: options that do not exist, ends that no table covers.
    evaluation.deviations(machine, {name: of[:1] for name, of in along.items()})
    evaluation.deviations(machine, {name: of[-1:] for name, of in along.items()})
    chunks = _chunks([len(of) for of in along.values()], nodes)
    sent = _sent(machine)
    token = dask.base.tokenize(sent.key, list(along.items()), order, approach, frame, nodes)
    slices = [_slices(of, sizes) for of, sizes in zip(along.values(), chunks, strict=True)]
    pieces = [dict(zip(along, piece, strict=True)) for piece in itertools.product(*slices)]
    name = f"abbe-deviations-{token}"
    indices = itertools.product(*(range(len(sizes)) for sizes in chunks))
    tasks = {(name, *at, 0): (_block, sent.key, evaluation, piece) for at, piece in zip(indices, pieces, strict=True)}
    graph = HighLevelGraph.from_collections(name, tasks, dependencies=[sent])
    whole = dask.array.Array(graph, name, chunks=(*chunks, (6,)), dtype=np.float64)
    parts = [_named("rows", f"{token}-{k}", _rows, sent, evaluation, piece) for k, piece in builtins.enumerate(pieces)]
    schema = pyarrow.schema([(column, pyarrow.float64()) for column in _row_names(machine, list(along))])
    return GridDeviations(along, whole[..., :3], whole[..., 3:], Table(parts, schema))


def _chunks(counts: Sequence[int], nodes: int) -> list[tuple[int, ...]]:
    """Returns sizes of blocks along the axes, such that each block is one piece of the list of all nodes."""
    if nodes < 1:
        raise ValueError("nodes: 1 or more")
    chunks: list[tuple[int, ...]] = []
    room = nodes
    for count in reversed(counts):
        size = math.ceil(count / math.ceil(count / room))
        chunks.append(tuple(min(size, count - first) for first in range(0, count, size)))
        room = room // count if len(chunks[-1]) == 1 else 1
        room = max(room, 1)
    return chunks[::-1]


def _slices(positions: NDArray[np.float64], sizes: Sequence[int]) -> list[NDArray[np.float64]]:
    return np.split(positions, np.cumsum(sizes)[:-1])


# Studies -----------------------------------------------------------------------------------------------------------


def evaluate(
    machine: Machine,
    designs: Sequence[Mapping[str, Any]],
    measure: Callable[[Machine], Mapping[str, float]],
    columns: Sequence[str],
    *,
    batch: int = 64,
    threads: int = 1,
) -> Table:
    """Measures variants of a machine: "what if" over any numbers of its file.

    ``designs`` are a :class:`Grid` or a :class:`Sample` of parameters, or a list of changes for
    :meth:`abbe.Machine.with_`; ``measure`` takes the variant and returns numbers by name, of which ``columns`` are
    kept. A row has the ``index`` of the design, its parameters (in the units of their intervals), the numbers, and in
    ``refused`` the diagnostic where the variant or its measure is refused. A task does ``batch`` designs.
    """
    if batch < 1:
        raise ValueError("batch: 1 or more")
    names = list(designs[0]) if len(designs) else []
    kinds = [_kind(designs, name) for name in names]
    schema = pyarrow.schema(
        [("index", pyarrow.int64()), *zip(names, kinds, strict=True)]
        + [(name, pyarrow.float64()) for name in columns]
        + [("refused", pyarrow.string())]
    )
    study = _Study(measure, tuple(columns), schema, threads)
    sent = _sent(machine)
    token = uuid.uuid4().hex
    parts = []
    # A space is known by its index; of a list every task gets its own piece.
    whole = delayed(designs, name=f"abbe-designs-{token}", traverse=False) if isinstance(designs, Space) else None
    shared = delayed(study, name=f"abbe-study-{token}", traverse=False)
    for first in range(0, len(designs), batch):
        end = min(first + batch, len(designs))
        piece = list(designs[first:end]) if whole is None else None
        parts.append(_named("study", f"{token}-{first}", _measured, sent, shared, whole, piece, first, end))
    return Table(parts, schema)


@dataclass(frozen=True)
class _Study:
    measure: Callable[[Machine], Mapping[str, float]]
    columns: tuple[str, ...]
    schema: Any
    threads: int


def _kind(designs: Sequence[Mapping[str, Any]], name: str) -> Any:
    if isinstance(designs, Space):
        of = designs.parameters[name]
        values = [0.0] if isinstance(of, Interval) else of
    else:
        values = [design[name] for design in designs]
    numbers = all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)
    return pyarrow.float64() if numbers else pyarrow.string()


def _measured(
    sent: _Sent,
    study: _Study,
    space: Space | None,
    piece: Sequence[Mapping[str, Any]] | None,
    first: int,
    end: int,
) -> pyarrow.Table:
    rows = []
    with _task(study.threads):
        for index in range(first, end):
            design = space[index] if space is not None else (piece or [])[index - first]
            row: dict[str, Any] = {
                "index": index,
                **{name: _cell(study.schema, name, of) for name, of in design.items()},
            }
            try:
                changes = space.changes_of(design) if space is not None else design
                found = study.measure(sent.machine().with_(changes))
                refuse_missing(found, study.columns)
                row |= {name: float(found[name]) for name in study.columns}
            except DiagnosticError as refused:
                row["refused"] = str(refused.reason or refused)
            rows.append(row)
    return pyarrow.Table.from_pylist(rows, schema=study.schema)


def _cell(schema: Any, name: str, value: Any) -> Any:
    return float(value) if schema.field(name).type == pyarrow.float64() else str(value)


# Calibrations ------------------------------------------------------------------------------------------------------

_FITTED: list[tuple[str, Any]] = [
    ("parameter", pyarrow.string()),
    ("value", pyarrow.float64()),
    ("sigma", pyarrow.float64()),
    ("unit", pyarrow.string()),
    ("refused", pyarrow.string()),
]
_FILES = pyarrow.schema([("file", pyarrow.string()), *_FITTED])
_DRAWS = pyarrow.schema([("draw", pyarrow.int64()), *_FITTED])


def _fitted(fit: Callable[[], IdentifyResult], of: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Returns a row for each parameter of a fit, or one with the reason why there is none."""
    try:
        found = fit()
    except DiagnosticError as refused:
        return [{**of, "refused": str(refused.reason or refused)}]
    keys = ("value", "sigma", "unit")
    return [
        {**of, "parameter": one["name"], **{key: one[key] for key in keys}} for one in found.to_dict()["parameters"]
    ]


def identify_files(
    machine: Machine, files: Sequence[Text | Sequence[Text]], *, threads: int = 1, **options: Unpack[IdentifyOptions]
) -> Table:
    """Fits errors to each of many files of measurements; a list of files among them is one set of data.

    A task reads a file, so that workers see the files by the same paths. A row has the ``file``, the ``parameter`` with
    ``value``, ``sigma`` and ``unit``, and in ``refused`` the diagnostic of a file that is refused. The options are
    those of :meth:`abbe.Machine.identify`.
    """
    sent, token, parts = _sent(machine), uuid.uuid4().hex, []
    for index, of in builtins.enumerate(files):
        paths = [os.fspath(of)] if isinstance(of, (str, os.PathLike)) else [os.fspath(path) for path in of]
        parts.append(_named("identify", f"{token}-{index}", _file_fit, sent, paths, options, threads))
    return Table(parts, _FILES)


def _file_fit(sent: _Sent, paths: list[str], options: Mapping[str, Any], threads: int) -> pyarrow.Table:
    with _task(threads):
        rows = _fitted(lambda: sent.machine().identify(paths, **options), {"file": ", ".join(paths)})
    return pyarrow.Table.from_pylist(rows, schema=_FILES)


def identify_noise(
    machine: Machine,
    data: Mapping[str, ArrayLike],
    noise: Mapping[str, float],
    *,
    draws: int,
    seed: int = 1,
    batch: int = 16,
    threads: int = 1,
    **options: Unpack[IdentifyOptions],
) -> Table:
    """Monte Carlo of an identification: fits errors to the same readings with noise drawn anew.

    ``data`` are columns as :meth:`abbe.Machine.identify` takes them, ``noise`` the standard deviation of the noise for
    some of them, in their unit. The noise of a draw depends on its index, the seed and the column alone. A row has the
    ``draw``, the ``parameter`` with ``value``, ``sigma`` and ``unit``, and ``refused``.
    """
    unknown = [name for name in noise if name not in data]
    if unknown or draws < 1 or batch < 1:
        raise ValueError(f"no column {unknown}" if unknown else "draws, batch: 1 or more")
    columns = {name: np.asarray(of) for name, of in data.items()}
    sent, token = _sent(machine), uuid.uuid4().hex
    shared = delayed((columns, dict(noise), seed, dict(options)), name=f"abbe-readings-{token}", traverse=False)
    parts = [
        _named("identify", f"{token}-{first}", _noise_fits, sent, shared, first, min(first + batch, draws), threads)
        for first in range(0, draws, batch)
    ]
    return Table(parts, _DRAWS)


def _noise_fits(sent: _Sent, shared: Any, first: int, end: int, threads: int) -> pyarrow.Table:
    columns, noise, seed, options = shared
    rows = []
    with _task(threads):
        for draw in range(first, end):
            noisy = dict(columns)
            for place, (name, sigma) in builtins.enumerate(noise.items()):
                stream = np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, draw, place + 1]))
                noisy[name] = columns[name] + sigma * stream.standard_normal(len(columns[name]))
            rows += _fitted(partial(sent.machine().identify, noisy, **options), {"draw": draw})
    return pyarrow.Table.from_pylist(rows, schema=_DRAWS)


# Budgets and arrangements ------------------------------------------------------------------------------------------


@contextmanager
def _files(states: Sequence[str]) -> Iterator[list[str]]:
    """Holds states in files while they are merged."""
    with tempfile.TemporaryDirectory(prefix="abbe-") as folder:
        paths = [Path(folder) / f"part-{index}" for index in range(len(states))]
        for path, state in zip(paths, states, strict=True):
            path.write_text(state, encoding="utf-8")
        yield [str(path) for path in paths]


def budget(machine: Machine, *, shards: int = 16, threads: int = 1, **options: Unpack[BudgetOptions]) -> Delayed:
    """Budgets as :meth:`abbe.Machine.budget` does, the machines drawn in so many tasks; ``compute()`` returns it.

    The result is that of one process to the last bit, for any number of shards. Options are those of the method.
    """
    sent, token = _sent(machine), uuid.uuid4().hex
    each = [(part + 1, shards) for part in range(_positive(shards))]
    states = [_named("budget", f"{token}-{at[0]}", _budget_part, sent, at, options, threads) for at in each]
    merged: Delayed = _named("budget-merge", token, _budget_merged, sent, states, options, threads)
    return merged


def _budget_part(sent: _Sent, shard: tuple[int, int], options: Mapping[str, Any], threads: int) -> str:
    # The search for a goal is of the whole.
    draws = {name: of for name, of in options.items() if name not in ("goal_mm", "cost", "loosen")}
    return sent.machine().budget(shard=shard, **draws, threads=threads).state


def _budget_merged(sent: _Sent, states: Sequence[str], options: Mapping[str, Any], threads: int) -> BudgetResult:
    with _files(states) as paths:
        return sent.machine().budget(merge=paths, **options, threads=threads)


def enumerate(machine: Machine, *, shards: int = 16, threads: int = 1, **options: Unpack[EnumerateOptions]) -> Delayed:
    """Ranks arrangements as :meth:`abbe.Machine.enumerate` does, every round in tasks; ``compute()`` returns it.

    The result is that of one process to the last bit, for any number of shards. Options are those of the method.
    """
    sent, token = _sent(machine), uuid.uuid4().hex
    each = [(part + 1, shards) for part in range(_positive(shards))]
    known: list[Delayed] = []
    for turn in range(_rounds(options)):
        known = [
            _named("enumerate", f"{token}-{turn}-{at[0]}", _enumerate_part, sent, at, known, options, threads)
            for at in each
        ]
    merged: Delayed = _named("enumerate-merge", token, _enumerate_merged, sent, known, options, threads)
    return merged


def _rounds(options: Mapping[str, Any]) -> int:
    """Returns the number of rounds of a study, each twice the one before; a study may end earlier."""
    samples = options.get("samples") or 200
    limit = options.get("max_samples") or 8 * samples
    return 1 + max(math.ceil(math.log2(limit / samples)), 0)


def _enumerate_part(
    sent: _Sent, shard: tuple[int, int], known: Sequence[str], options: Mapping[str, Any], threads: int
) -> str:
    with _files([state for state in known if state]) as paths:
        found = sent.machine().enumerate(shard=shard, merge=paths, **options, threads=threads)
    # Where the round has no work for this shard, it hands on what it was given: the last round holds all before it.
    return found.state or (known[shard[0] - 1] if known else "")


def _enumerate_merged(sent: _Sent, known: Sequence[str], options: Mapping[str, Any], threads: int) -> EnumerateResult:
    with _files([state for state in known if state]) as paths:
        return sent.machine().enumerate(merge=paths, **options, threads=threads)


def _positive(shards: int) -> int:
    if shards < 1:
        raise ValueError("shards: 1 or more")
    return shards
