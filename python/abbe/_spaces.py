"""Spaces of designs: numbers of the machine file by their paths, each design by its index."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Union

import numpy as np


@dataclass(frozen=True)
class Interval:
    """The range of a number of the machine file. ``unit`` is written behind it: ``Interval(5, 30, "um")``."""

    low: float
    high: float
    unit: str = ""

    def __post_init__(self) -> None:
        if not -np.inf < self.low <= self.high < np.inf:
            raise ValueError(f"an interval has two finite ends in rising order, not {self.low} and {self.high}")


#: The numbers that a parameter can have: an interval, or a list of choices.
Parameter = Union[Interval, Sequence[Any]]

#: Parameters by name; without ``changes`` the names are paths of the machine file, as in ``machine.with_``.
Parameters = Mapping[str, Parameter]

#: Makes the changes for ``machine.with_`` out of the parameters of a design.
Changes = Callable[[Mapping[str, Any]], Mapping[str, Any]]


def changes_of(parameters: Parameters, design: Mapping[str, Any], changes: Changes | None) -> Mapping[str, Any]:
    """Returns what ``machine.with_`` takes for a design."""
    if changes is not None:
        return changes(design)
    return {name: _written(parameters[name], value) for name, value in design.items()}


def _written(parameter: Parameter, value: Any) -> Any:
    return f"{value!r} {parameter.unit}" if isinstance(parameter, Interval) and parameter.unit else value


@dataclass(frozen=True)
class Space(Sequence[Mapping[str, Any]]):
    """Designs by index: a mapping of parameters for each. No list of them is kept."""

    parameters: Parameters
    changes: Changes | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if not self.parameters:
            raise ValueError("a space has one parameter at least")
        empty = [name for name, of in self.parameters.items() if not isinstance(of, Interval) and not len(of)]
        if empty:
            raise ValueError(f"no choices for {', '.join(empty)}")

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[at] for at in range(*index.indices(len(self)))]
        count = len(self)
        if not -count <= index < count:
            raise IndexError(index)
        return self._design(int(index) % count)

    def __iter__(self) -> Iterator[Mapping[str, Any]]:
        return (self._design(index) for index in range(len(self)))

    def __len__(self) -> int:
        raise NotImplementedError

    def _design(self, index: int) -> dict[str, Any]:
        raise NotImplementedError

    def changes_of(self, design: Mapping[str, Any]) -> Mapping[str, Any]:
        """Returns what ``machine.with_`` takes for a design."""
        return changes_of(self.parameters, design, self.changes)


@dataclass(frozen=True)
class Grid(Space):
    """Every combination; the last parameter runs fastest. Intervals have ``steps`` values, both ends included."""

    steps: int | Mapping[str, int] = 5

    def _count(self, name: str) -> int:
        of = self.parameters[name]
        if not isinstance(of, Interval):
            return len(of)
        count = self.steps if isinstance(self.steps, int) else self.steps[name]
        if count < 1:
            raise ValueError(f"{name}: 1 step or more")
        return count

    def __len__(self) -> int:
        return int(np.prod([self._count(name) for name in self.parameters], dtype=object))

    def _design(self, index: int) -> dict[str, Any]:
        values: dict[str, Any] = {}
        for name in reversed(list(self.parameters)):
            of, count = self.parameters[name], self._count(name)
            index, at = divmod(index, count)
            if isinstance(of, Interval):
                values[name] = (
                    of.high if at and at == count - 1 else of.low + (of.high - of.low) * at / max(count - 1, 1)
                )
            else:
                values[name] = of[at]
        return {name: values[name] for name in self.parameters}


@dataclass(frozen=True)
class Sample(Space):
    """``size`` random designs, even over each parameter. A design depends on its index and the seed alone."""

    size: int = 100
    seed: int = 1

    def __len__(self) -> int:
        return self.size

    def _design(self, index: int) -> dict[str, Any]:
        # The upper halves of the counter leave every index a stream of its own.
        raw = np.random.Philox(key=self.seed, counter=[0, 0, index, 0]).random_raw(len(self.parameters))
        values: dict[str, Any] = {}
        for (name, of), bits in zip(self.parameters.items(), raw.tolist(), strict=True):
            fraction = (bits >> 11) * 2.0**-53
            if isinstance(of, Interval):
                values[name] = of.low + (of.high - of.low) * fraction
            else:
                values[name] = of[int(fraction * len(of))]
        return values


def refuse_missing(measured: Mapping[str, Any], names: Iterable[str]) -> None:
    """Raises LookupError for numbers that a study asks for and its ``measure`` does not return."""
    missing = [name for name in names if name not in measured]
    if missing:
        raise LookupError(f"`measure` returns {', '.join(measured)} and no {', '.join(missing)}")
