"""Types of what the methods take."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any, Protocol, Union

from numpy.typing import ArrayLike

#: A text or a path.
Text = Union[str, "os.PathLike[str]"]


class Columns(Protocol):
    """Columns by name, such as a DataFrame."""

    @property
    def columns(self) -> Any:
        """The names of the columns."""

    def __getitem__(self, name: Any, /) -> Any:
        """Returns a column."""


#: A table: the path of a file, or columns in memory.
Table = Union[Text, Mapping[str, Any], Columns]

#: Poses: an array of shape (N, axes), or columns of positions by the names of axes (a mapping, a DataFrame).
Poses = Union[ArrayLike, Mapping[str, ArrayLike], Columns]

#: Positions of axes: ``{"Z": -100, "A": 30}`` or ``"Z=-100,A=30"``, mm and deg.
At = Union[str, Mapping[str, float]]

#: Two linear axes: ``("X", "Z")`` or ``"XZ"``.
Plane = Union[str, tuple[str, str]]

#: Hears of a phase, steps done, and their number, which is 0 where nobody knows it.
Progress = Callable[[str, int, int], object]
