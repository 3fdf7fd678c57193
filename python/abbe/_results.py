"""Results: the JSON of the program as objects, with tables, pictures and files beside it."""

from __future__ import annotations

import html
import io
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from . import _abbe, _fields
from ._record import Record, copied

if TYPE_CHECKING:
    import pandas
    import pyarrow
    import xarray


class Result(Record):
    """What a verb gives back.

    The fields are those of the program's JSON (docs/formats/json.md), as attributes, as items, and whole by
    :meth:`to_dict`. Units stand in the names of the fields.
    """

    __slots__ = ("_files", "_headline", "_texts")

    #: The field that :meth:`to_pandas` and :meth:`to_arrow` make a table of.
    _table: str | None = None
    #: The columns that text and notebooks show, and the field that has them if it is not that of the table.
    _shown: tuple[str, ...] = ()
    _ranking: str | None = None

    def __init__(self, found: _abbe.NativeOutcome) -> None:
        super().__init__(json.loads(found.json()))
        self._headline = found.headline()
        self._texts = dict(found.texts())
        self._files = dict(found.files())

    def __getstate__(self) -> Any:
        return self._value, self._headline, self._texts, self._files

    def __setstate__(self, state: Any) -> None:
        self._value, self._headline, self._texts, self._files = state

    @property
    def headline(self) -> str:
        """The first lines of the program's text: the figure that decides, its interval, and what it is over."""
        return self._headline

    def __repr__(self) -> str:
        lines = [*(self._headline.splitlines() or [", ".join(self._value)]), *self._rows_of_text(), *self._warned()]
        return "\n  ".join([f"<{type(self).__name__}: {lines[0]}", *lines[1:]]) + ">"

    def _warned(self) -> list[str]:
        count = self._value.get("more_warnings", 0)
        lines = [f"warning {one['code']}: {one['message']}" for one in self._value.get("warnings", [])]
        return [*lines, f"and {count} more warnings"] if count else lines

    def _ranked(self) -> list[list[Any]]:
        rows = _at(self._value, self._ranking or self._table or "") if self._shown else []
        if isinstance(rows, dict):
            # Errors by name, the one first that leaves most.
            named = [{"error": name, **of} for name, of in rows.items()]
            rows = sorted(named, key=lambda row: -row["left_um"])
        return [[_at(row, column, None) for column in self._shown] for row in rows]

    def _rows_of_text(self) -> list[str]:
        rows = self._ranked()
        lines = ["  ".join(_text(cell) for cell in row) for row in rows[:_LINES]]
        more = [f"and {len(rows) - _LINES} more: to_pandas()"] if len(rows) > _LINES else []
        return [", ".join(self._shown) + ":", *lines, *more] if rows else []

    @property
    def pictures(self) -> dict[str, str]:
        """The pictures by name, SVG."""
        return {name: text for name, text in self._texts.items() if name.endswith(".svg")}

    def records(self) -> list[dict[str, Any]]:
        """Returns the rows of the table of this result as flat dictionaries, names of nested keys joined by dots."""
        rows = self._value if self._table is None else _at(self._value, self._table)
        return [dict(_flat(row)) for row in (rows if isinstance(rows, (list, tuple)) else [rows])]

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the table of this result as a DataFrame (needs pandas)."""
        import pandas

        return pandas.DataFrame(self.records())

    def to_arrow(self) -> pyarrow.Table:
        """Returns the table of this result as an Arrow table (needs pyarrow)."""
        import pyarrow

        return pyarrow.Table.from_pylist(self.records())

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Hands the table of this result to other libraries (needs pyarrow)."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def _picture(self) -> str | None:
        return next(iter(self.pictures.values()), None)

    def _repr_html_(self) -> str:
        facts = [(key, value) for key, value in self._value.items() if isinstance(value, (str, int, float, bool))]
        head = [f"<strong>{html.escape(line)}</strong>" for line in self._headline.splitlines()]
        lines = "<br>".join(head + [html.escape(line) for line in self._warned()])
        rows = self._ranked()
        table = html_rows(self._shown, rows) if rows else ""
        picture = self._picture()
        return f"<p>{lines}</p>" * bool(lines) + (table or html_table(facts)) + (inline(picture) if picture else "")


#: Rows of a ranking in the text of a result.
_LINES = 5

#: Rows of a table that notebooks show; ``to_pandas`` has all.
_ROWS = 40


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(inner)}" for key, inner in value.items())
    if isinstance(value, list):
        return f"({', '.join(map(_text, value))})"
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


def _cell(value: Any) -> str:
    return html.escape(_text(value))


def html_table(rows: list[tuple[str, Any]]) -> str:
    """Returns facts as a table."""
    lines = (f"<tr><th style='text-align:left'>{_cell(key)}</th><td>{_cell(value)}</td></tr>" for key, value in rows)
    return f"<table>{''.join(lines)}</table>"


def html_rows(heads: tuple[str, ...], rows: list[list[Any]]) -> str:
    """Returns the first rows of a table."""
    lines = ["".join(f"<td>{_cell(value)}</td>" for value in row) for row in rows[:_ROWS]]
    lines += [f"<td colspan='{len(heads)}'>and {len(rows) - _ROWS} more</td>"] if len(rows) > _ROWS else []
    head = "".join(f"<th>{_cell(name)}</th>" for name in heads)
    return f"<table><tr>{head}</tr>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def inline(svg: str) -> str:
    """Returns a picture for a page of HTML: without the XML declaration."""
    return svg[svg.index("<svg") :]


def _at(value: Any, path: str, absent: Any = ()) -> Any:
    for key in path.split("."):
        value = value.get(key, absent) if isinstance(value, dict) else absent
    return value


def _flat(value: dict[str, Any], lead: str = "") -> Iterator[tuple[str, Any]]:
    for key, inner in value.items():
        if isinstance(inner, dict):
            yield from _flat(inner, f"{lead}{key}.")
        else:
            yield lead + key, copied(inner)


class EvalResult(_fields.EvalFields, Result):
    """Deviations at poses, mm and rad. The table has a row for each pose."""

    __slots__ = ()
    _table = "poses"
    _shown = ("axes", "deviation", "rotation")


class DrawnLater(Result):
    """A result whose pictures are drawn when a notebook asks for them."""

    __slots__ = ("_again",)

    def __init__(self, found: _abbe.NativeOutcome, again: Callable[[], Any] | None = None) -> None:
        super().__init__(found)
        self._again = again

    def __setstate__(self, state: Any) -> None:
        super().__setstate__(state)
        self._again = None

    def _picture(self) -> str | None:
        picture = super()._picture()
        if picture is None and self._again is not None:
            found, self._again = self._again(), None
            if found is not None:
                self._texts.update({name: text for name, text in found.texts() if name.endswith(".svg")})
            picture = super()._picture()
        return picture


class MapResult(_fields.MapFields, DrawnLater):
    """The error over a volume: statistics in um and urad.

    The table has a row for each pose, if ``rows=True`` asked for them, and one for each of the worst poses otherwise.
    """

    __slots__ = ("_rows",)
    _table = "worst"
    _shown = ("axes", "deviation_um")

    def __init__(self, found: _abbe.NativeOutcome, again: Callable[[], Any] | None = None) -> None:
        super().__init__(found, again)
        rows = found.rows()
        self._rows = None if rows is None else np.load(io.BytesIO(rows.tobytes()))
        if self._rows is not None:
            self._rows.flags.writeable = False

    def __getstate__(self) -> Any:
        return super().__getstate__(), self._rows

    def __setstate__(self, state: Any) -> None:
        inner, self._rows = state
        super().__setstate__(inner)

    @property
    def rows(self) -> NDArray[np.void]:
        """Every pose with its deviation: a structured array with the columns of ``abbe map --csv``.

        Positions are in mm and deg, deviations in um and urad; the names of the columns hold the units.
        """
        if self._rows is None:
            raise ValueError("a map keeps its poses if asked for them: machine.map(..., rows=True)")
        return cast("NDArray[np.void]", self._rows)

    @property
    def grid(self) -> tuple[int, ...] | None:
        """Numbers of nodes along the axes, for a map over the grid of the volume; the last axis runs fastest."""
        text = self._texts.get("grid")
        return None if text is None else tuple(json.loads(text))

    def records(self) -> list[dict[str, Any]]:
        if self._rows is None:
            return super().records()
        names = self._rows.dtype.names or ()
        return [dict(zip(names, row, strict=True)) for row in self._rows.tolist()]

    def to_pandas(self) -> pandas.DataFrame:
        if self._rows is None:
            return super().to_pandas()
        import pandas

        return pandas.DataFrame({name: self._rows[name] for name in self._rows.dtype.names or ()})

    def to_arrow(self) -> pyarrow.Table:
        if self._rows is None:
            return super().to_arrow()
        import pyarrow

        names = self._rows.dtype.names or ()
        return pyarrow.table({name: np.ascontiguousarray(self._rows[name]) for name in names})

    def to_xarray(self) -> xarray.Dataset:
        """Returns the map over the grid of the volume as a dataset, a dimension for each axis (needs xarray)."""
        import xarray

        if self.grid is None:
            raise ValueError("these poses are no grid: map without `poses`")
        rows, counts = self.rows, self.grid
        names = rows.dtype.names or ()
        axes, values = names[: len(counts)], names[len(counts) :]
        plain = [_name_and_unit(name) for name in names]
        dimensions = [name for name, _ in plain[: len(counts)]]
        coordinates = {}
        for k, column in enumerate(axes):
            along = rows[column].reshape(counts)[tuple(slice(None) if i == k else 0 for i in range(len(counts)))]
            coordinates[dimensions[k]] = (dimensions[k], along, {"units": plain[k][1]})
        variables = {
            name: (dimensions, rows[column].reshape(counts), {"units": unit})
            for column, (name, unit) in zip(values, plain[len(counts) :], strict=True)
        }
        facts = {key: value for key, value in self._value.items() if isinstance(value, (str, int, float))}
        return xarray.Dataset(variables, coordinates, facts)


def _name_and_unit(column: str) -> tuple[str, str]:
    name, _, unit = column.partition(" [")
    return name, unit.rstrip("]")


class ReachResult(_fields.ReachFields, Result):
    """The share of tips and directions of the tool that the machine takes."""

    __slots__ = ()
    _table = "lacks"


class PlacementResult(_fields.PlacementFields, Result):
    """The part of a job at places of the table. The table has a row for each place."""

    __slots__ = ()
    _table = "tried"


class CompareResult(_fields.CompareFields, Result):
    """Machines side by side on the same tool poses. The table has a row for each machine."""

    __slots__ = ()
    _table = "machines"
    _shown = ("machine", "file", "position_um.p95", "position_um.max")


class BudgetResult(_fields.BudgetFields, Result):
    """From tolerances to the volumetric error, um and urad. The table has a row for each bounded error."""

    __slots__ = ()
    _table = "tighten"
    _shown = ("error", "tolerance", "unit", "um_of_p95")

    @property
    def state(self) -> str:
        """The drawn machines of a part (``shard``) as a state file holds them, for ``merge``."""
        if "state" not in self._texts:
            raise ValueError("a part of a budget has a state: machine.budget(..., shard=(1, 4))")
        return self._texts["state"]


class EnumerateResult(_fields.EnumerateFields, Result):
    """Arrangements of the axes in order. The table has a row for each arrangement."""

    __slots__ = ()
    _table = "ranked"
    _shown = ("chain", "um", "low", "high", "reached")

    @property
    def state(self) -> str:
        """The results of the study as its state file holds them, for ``merge``."""
        return self._texts["state"]


class InstrumentResult(_fields.InstrumentFields, Result):
    """Readings of an instrument. The table has a row for each plane, axis or diagonal."""

    __slots__ = ()

    def records(self) -> list[dict[str, Any]]:
        tables = (self._value[name] for name in ("planes", "axes", "diagonals") if name in self._value)
        return [dict(_flat(row)) for row in next(tables)]


class IdentifyResult(_fields.IdentifyFields, DrawnLater):
    """Errors from measurements. The table has a row for each fitted parameter."""

    __slots__ = ()
    _table = "parameters"
    _shown = ("name", "value", "sigma", "unit")

    @property
    def covariance(self) -> pandas.DataFrame:
        """The covariance of ``parameters`` in their units, by their names; free ones have no part (needs pandas)."""
        import pandas

        names = [parameter.name for parameter in self.parameters]
        return pandas.DataFrame(json.loads(self._texts["covariance.json"]), names, names)

    @property
    def reading_residuals(self) -> pandas.DataFrame:
        """Measured minus predicted, a row for each measurement in its order (needs pandas).

        ``kind`` is that of the reading, ``x``, ``y``, ``z`` are in ``unit``; of a single number ``x`` has it.
        """
        import pandas

        rows = json.loads(self._texts["residuals.json"])
        flat = [{"kind": r["kind"], **dict(zip("xyz", r["residual"], strict=True)), "unit": r["unit"]} for r in rows]
        return pandas.DataFrame(flat)

    @property
    def machine_file(self) -> str:
        """The text of the fitted machine file, asked for by ``machine_file=True``."""
        if "machine.yaml" not in self._texts:
            raise ValueError("a fit writes its machine if asked for it: machine.identify(..., machine_file=True)")
        return self._texts["machine.yaml"]


class PlanResult(_fields.PlanFields, Result):
    """Poses worth measuring, in the order of their worth. The table has a row for each pose."""

    __slots__ = ()
    _table = "poses"
    _ranking = "parameters"
    _shown = ("name", "sigma", "unit")

    @property
    def csv(self) -> str:
        """The poses as a file to measure by."""
        return self._texts["plan.csv"]


class PredictResult(_fields.PredictFields, Result):
    """Readings against the prediction of a machine. The table has a row for each reading."""

    __slots__ = ()
    _table = "readings"
    _ranking = "kinds"
    _shown = ("kind", "places", "measured", "predicted", "left", "unit")


class ImportResult(_fields.ImportFields, Result):
    """A measurement as an instrument exports it. The table has a row for each error."""

    __slots__ = ()
    _table = "errors"

    @property
    def csv(self) -> str:
        """The table of error curves, as a machine file names it."""
        return self._texts["table.csv"]


class TouchImportResult(_fields.TouchImportFields, Result):
    """What a touch probe logged at balls. The table has a row for each ball and pose."""

    __slots__ = ()
    _table = "centres"

    @property
    def csv(self) -> str:
        """The table of touches, as ``identify`` reads it."""
        return self._texts["table.csv"]


class EquationsResult(_fields.EquationsFields, Result):
    """Closed forms."""

    __slots__ = ()

    @property
    def text(self) -> str:
        """The equations as text."""
        return self._texts["equations.txt"]

    @property
    def latex(self) -> str:
        """The equations as a LaTeX document."""
        return self._texts["equations.tex"]


class ConvertResult(_fields.ConvertFields, Result):
    """The same machine under other conventions. The table has a row for each error that changed."""

    __slots__ = ()
    _table = "errors"

    @property
    def machine_file(self) -> str:
        """The text of the converted machine file."""
        return self._texts["machine.yaml"]


class CertificateResult(_fields.CertificateFields, Result):
    """The residual after a controller has applied its files, um and urad."""

    __slots__ = ()
    _ranking = "errors"
    _shown = ("error", "alone_um", "left_um")


class Folder(Result):
    """A result with the files of a folder."""

    __slots__ = ()

    @property
    def contents(self) -> dict[str, bytes]:
        """The files by name, the list of their hashes last."""
        return dict(self._files)

    def save(self, folder: str | Path) -> None:
        """Writes the files into a folder that is new or empty. The command `abbe compile` replaces sets in use."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise FileExistsError(f"{folder} is not empty; the command `abbe compile` replaces a set as a whole")
        for name, content in self._files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


class TargetsResult(_fields.TargetsFields, Result):
    """What the files of each target leave of a machine's errors. The table has a row for each target."""

    __slots__ = ()
    _table = "targets"


class CompileResult(CertificateResult, Folder):
    """The files of a controller, with their certificate."""

    __slots__ = ()


class MeasureResult(_fields.MeasureFields, Folder):
    """The program that touches balls. The table has a row for each set of touches."""

    __slots__ = ()
    _table = "sets"


class RecordResult(_fields.RecordFields, Folder):
    """The record of a calibration. The table has a row for each decision."""

    __slots__ = ()
    _table = "decisions"


class TestPieceResult(_fields.TestPieceFields, Folder):
    """A test piece as a job: its files, and what rests on memory."""

    __slots__ = ()


class TrendResult(_fields.TrendFields, Result):
    """Records of one machine in a line. The table has a row for each error."""

    __slots__ = ()
    _table = "errors"


class LocateResult(_fields.LocateFields, Result):
    """Location errors as a control's own calibration found them. The table has a row for each error."""

    __slots__ = ()
    _table = "errors"

    @property
    def machine_file(self) -> str:
        """The text of the machine file with the errors found."""
        return self._texts["machine.yaml"]


class DiffResult(_fields.DiffFields, Result):
    """What two machines differ in. The table has a row for each difference."""

    __slots__ = ()
    _table = "differences"
    _shown = ("kind", "name", "first", "second", "minus_first_um")


class SetDiffResult(_fields.SetDiffFields, Result):
    """What the files in two folders add to commands, second less first."""

    __slots__ = ()


class MonomialResult(_fields.MonomialFields, Result):
    """Monomials of order 2, fitted component by component. The table has a row for each component."""

    __slots__ = ()
    _table = "components"


class FiguresResult(_fields.FiguresFields, Result):
    """Figures of the ISO 230 series."""

    __slots__ = ()


class ClassifyResult(_fields.ClassifyFields, Result):
    """Motion and errors of a matrix over the dual numbers."""

    __slots__ = ()


class CheckRecordResult(_fields.CheckRecordFields, Result):
    """A record whose files are all as its hashes state."""

    __slots__ = ()


class ReportResult(_fields.ReportFields, Result):
    """One self-contained page of HTML."""

    __slots__ = ()

    @property
    def page(self) -> str:
        """The page."""
        return self._texts["report.html"]

    def save(self, path: str | Path) -> None:
        """Writes the page to a file."""
        Path(path).write_text(self.page, encoding="utf-8")
