"""Results: the JSON of the program as objects, with tables, pictures and files beside it."""

from __future__ import annotations

import html
import io
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from . import _abbe

if TYPE_CHECKING:
    import pandas
    import pyarrow
    import xarray


class Record(Mapping[str, Any]):
    """An object of a result: its keys are attributes too."""

    __slots__ = ("_value",)

    def __init__(self, value: dict[str, Any]) -> None:
        self._value = value

    def __getitem__(self, key: str) -> Any:
        return wrapped(self._value[key])

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and name in self._value:
            return wrapped(self._value[name])
        raise AttributeError(f"no field `{name}`: there are {', '.join(self._value)}")

    def __getstate__(self) -> dict[str, Any]:
        return self._value

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._value = state

    def __iter__(self) -> Iterator[str]:
        return iter(self._value)

    def __len__(self) -> int:
        return len(self._value)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._value]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self._value == other._value

    def __repr__(self) -> str:
        return f"Record({self._value!r})"

    def to_dict(self) -> dict[str, Any]:
        """Returns the object as plain Python values."""
        return self._value


def wrapped(value: Any) -> Any:
    """Returns JSON objects as records, also in lists."""
    if isinstance(value, dict):
        return Record(value)
    if isinstance(value, list):
        return [wrapped(item) for item in value]
    return value


class Result(Record):
    """What a verb gives back.

    The fields are those of the program's JSON (docs/formats.md), as attributes, as items, and whole by
    :meth:`to_dict`. Units stand in the names of the fields.
    """

    __slots__ = ("_files", "_texts")

    #: The field that :meth:`to_pandas` and :meth:`to_arrow` make a table of.
    _table: str | None = None

    def __init__(self, found: _abbe.NativeOutcome) -> None:
        super().__init__(json.loads(found.json()))
        self._texts = dict(found.texts())
        self._files = dict(found.files())

    def __getstate__(self) -> Any:
        return self._value, self._texts, self._files

    def __setstate__(self, state: Any) -> None:
        self._value, self._texts, self._files = state

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {', '.join(self._value)}>"

    @property
    def pictures(self) -> dict[str, str]:
        """The pictures by name, SVG."""
        return {name: text for name, text in self._texts.items() if name.endswith(".svg")}

    def records(self) -> list[dict[str, Any]]:
        """Returns the rows of the table of this result as flat dictionaries, names of nested keys joined by dots."""
        rows = self._value if self._table is None else _at(self._value, self._table)
        return [dict(_flat(row)) for row in (rows if isinstance(rows, list) else [rows])]

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

    def _repr_svg_(self) -> str | None:
        return next(iter(self.pictures.values()), None)

    def _repr_html_(self) -> str | None:
        facts = [(key, value) for key, value in self._value.items() if isinstance(value, (str, int, float, bool))]
        picture = self._repr_svg_()
        return html_table(facts) + ("" if picture is None else inline(picture))


def html_table(rows: list[tuple[str, Any]]) -> str:
    """Returns facts as a table."""

    def cell(value: Any) -> str:
        return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))

    lines = (
        f"<tr><th style='text-align:left'>{html.escape(key)}</th><td>{cell(value)}</td></tr>" for key, value in rows
    )
    return f"<table>{''.join(lines)}</table>"


def inline(svg: str) -> str:
    """Returns a picture for a page of HTML: without the XML declaration."""
    return svg[svg.index("<svg") :]


def _at(value: Any, path: str) -> Any:
    for key in path.split("."):
        value = value.get(key, []) if isinstance(value, dict) else []
    return value


def _flat(value: dict[str, Any], lead: str = "") -> Iterator[tuple[str, Any]]:
    for key, inner in value.items():
        if isinstance(inner, dict):
            yield from _flat(inner, f"{lead}{key}.")
        else:
            yield lead + key, inner


class EvalResult(Result):
    """Deviations at poses, mm and rad. The table has a row for each pose."""

    __slots__ = ()
    _table = "poses"


class MapResult(Result):
    """The error over a volume: statistics in um and urad.

    The table has a row for each pose, if ``rows=True`` asked for them, and one for each of the worst poses otherwise.
    """

    __slots__ = ("_again", "_rows")
    _table = "worst"

    def __init__(self, found: _abbe.NativeOutcome, again: Any = None) -> None:
        super().__init__(found)
        rows = found.rows()
        self._rows = None if rows is None else np.load(io.BytesIO(rows.tobytes()))
        self._again = again

    def __getstate__(self) -> Any:
        return super().__getstate__(), self._rows

    def __setstate__(self, state: Any) -> None:
        inner, self._rows = state
        super().__setstate__(inner)
        self._again = None

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

    def _repr_svg_(self) -> str | None:
        picture = super()._repr_svg_()
        if picture is None and self._again is not None:
            found = self._again()
            if found is not None:
                self._texts.update({name: text for name, text in found.texts() if name.endswith(".svg")})
            picture = super()._repr_svg_()
        return picture


def _name_and_unit(column: str) -> tuple[str, str]:
    name, _, unit = column.partition(" [")
    return name, unit.rstrip("]")


class ReachResult(Result):
    """The share of tips and directions of the tool that the machine takes."""

    __slots__ = ()
    _table = "lacks"


class CompareResult(Result):
    """Machines side by side on the same tool poses. The table has a row for each machine."""

    __slots__ = ()
    _table = "machines"


class BudgetResult(Result):
    """From tolerances to the volumetric error, um and urad. The table has a row for each bounded error."""

    __slots__ = ()
    _table = "tighten"

    @property
    def state(self) -> str:
        """The drawn machines of a part (``shard``) as a state file holds them, for ``merge``."""
        if "state" not in self._texts:
            raise ValueError("a part of a budget has a state: machine.budget(..., shard=(1, 4))")
        return self._texts["state"]


class EnumerateResult(Result):
    """Arrangements of the axes in order. The table has a row for each arrangement."""

    __slots__ = ()
    _table = "ranked"

    @property
    def state(self) -> str:
        """The results of the study as its state file holds them, for ``merge``."""
        return self._texts["state"]


class InstrumentResult(Result):
    """Readings of an instrument."""

    __slots__ = ()


class IdentifyResult(Result):
    """Errors from measurements. The table has a row for each fitted parameter."""

    __slots__ = ()
    _table = "parameters"

    @property
    def machine_file(self) -> str:
        """The text of the fitted machine file, asked for by ``machine_file=True``."""
        if "machine.yaml" not in self._texts:
            raise ValueError("a fit writes its machine if asked for it: machine.identify(..., machine_file=True)")
        return self._texts["machine.yaml"]


class PlanResult(Result):
    """Poses worth measuring, in the order of their worth. The table has a row for each pose."""

    __slots__ = ()
    _table = "poses"

    @property
    def csv(self) -> str:
        """The poses as a file to measure by."""
        return self._texts["plan.csv"]


class ImportResult(Result):
    """A measurement as an instrument exports it. The table has a row for each error."""

    __slots__ = ()
    _table = "errors"

    @property
    def csv(self) -> str:
        """The table of error curves, as a machine file names it."""
        return self._texts["table.csv"]


class EquationsResult(Result):
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


class ConvertResult(Result):
    """The same machine under other conventions. The table has a row for each error that changed."""

    __slots__ = ()
    _table = "errors"

    @property
    def machine_file(self) -> str:
        """The text of the converted machine file."""
        return self._texts["machine.yaml"]


class CertificateResult(Result):
    """The residual after a controller has applied its files, um and urad."""

    __slots__ = ()


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


class CompileResult(CertificateResult, Folder):
    """The files of a controller, with their certificate."""

    __slots__ = ()


class RecordResult(Folder):
    """The record of a calibration. The table has a row for each decision."""

    __slots__ = ()
    _table = "decisions"


class TrendResult(Result):
    """Records of one machine in a line. The table has a row for each error."""

    __slots__ = ()
    _table = "errors"


class LocateResult(Result):
    """Location errors as a control's own calibration found them. The table has a row for each error."""

    __slots__ = ()
    _table = "errors"

    @property
    def machine_file(self) -> str:
        """The text of the machine file with the errors found."""
        return self._texts["machine.yaml"]


class DiffResult(Result):
    """What two machines, or two sets of files, differ in. The table has a row for each difference."""

    __slots__ = ()
    _table = "differences"


class ReportResult(Result):
    """One self-contained page of HTML."""

    __slots__ = ()

    @property
    def page(self) -> str:
        """The page."""
        return self._texts["report.html"]

    def save(self, path: str | Path) -> None:
        """Writes the page to a file."""
        Path(path).write_text(self.page, encoding="utf-8")
