"""Measurements from memory."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _abbe
from ._types import Table, Text


def files_and_texts(data: Any) -> tuple[list[str], list[tuple[str, str]]]:
    """Returns measurements as paths, and as texts by name for those that are columns in memory."""
    if data is None:
        return [], []
    single = isinstance(data, (str, os.PathLike, Mapping)) or hasattr(data, "columns")
    items: Iterable[Table] = [data] if single else data
    paths: list[str] = []
    texts: list[tuple[str, str]] = []
    for item in items:
        if isinstance(item, (str, os.PathLike)):
            paths.append(os.fspath(item))
        else:
            texts.append((f"readings-{len(texts) + 1}.csv", csv_of(item)))
    return paths, texts


def folders_and_texts(*folders: Text | Mapping[str, bytes]) -> tuple[list[str], list[tuple[str, str]]]:
    """Returns sets of files as paths; those in memory, or of a result, as texts below a name."""
    words: list[str] = []
    texts: list[tuple[str, str]] = []
    for number, folder in enumerate(folders, 1):
        contents = getattr(folder, "contents", folder)
        if isinstance(contents, Mapping):
            folder = f"set in memory {number}"
            texts += [(f"{folder}/{name}", bytes(content).decode()) for name, content in contents.items()]
        words.append(os.fspath(folder))  # type: ignore[arg-type]
    return words, texts


def csv_of(columns: Any) -> str:
    """Returns columns by their names (a mapping, a DataFrame) as CSV; numbers keep every bit."""
    names = [str(name) for name in columns]
    if any("," in name or "\n" in name for name in names):
        raise ValueError("the name of a column has a comma or a line break")
    cells = [_cells(columns[name]) for name in columns]
    if len({len(column) for column in cells}) > 1:
        lengths = ", ".join(f"{name} {len(column)}" for name, column in zip(names, cells, strict=True))
        raise ValueError(f"the columns of measurements are not of one length: {lengths}")
    return _abbe.csv(names, cells)


def real(values: Any, name: str) -> NDArray[np.float64]:
    """Returns an array of real numbers; refuses what NumPy would cut off in silence."""
    if np.ma.isMaskedArray(values) and np.ma.getmaskarray(values).any():
        raise ValueError(f"{name}: masked values have no number; fill them or leave the rows out")
    array = np.asarray(values)
    if array.dtype.kind == "c":
        raise ValueError(f"{name}: complex numbers; real ones are wanted")
    return array.astype(np.float64, copy=False)


def _cells(column: Any) -> NDArray[np.float64] | list[str]:
    """Returns numbers, or the cells of a column of text; a value that is missing is an empty cell."""
    values = np.asarray(column)
    if values.dtype.kind in "fciu":
        values = real(column, "measurements")
        # A copy too where the memory is not aligned, as of arrays that Dask has sent.
        return np.require(values, dtype=np.float64, requirements=["C", "A"])
    cells = ["" if value is None or value != value else str(value) for value in values.tolist()]
    if any(character in cell for cell in cells for character in ",\r\n"):
        raise ValueError("a cell of measurements has a comma or a line break")
    return cells
