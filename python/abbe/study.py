"""Optimise a design: numbers of the machine file with ranges, goals, constraints (``pip install abbe[study]``).

SciPy's and pymoo's optimisers search; this module turns their vectors into machines and machines into their numbers.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ._diagnostics import DiagnosticError
from ._machine import Machine
from ._spaces import Changes, Grid, Interval, Parameter, Parameters, Sample, Space, changes_of, refuse_missing
from ._types import Text

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._verbs import BudgetOptions, ReachOptions

__all__ = [
    "Design",
    "Front",
    "Grid",
    "Interval",
    "Parameter",
    "Parameters",
    "Problem",
    "Sample",
    "Space",
    "minimize",
    "p95_um",
    "pareto",
    "reach_share",
]

#: A design that is refused counts as this far beyond its constraints; optimisers do not take infinity.
_REFUSED = 1e9


def p95_um(machine: Machine, *, threads: int | None = None, **options: Unpack[BudgetOptions]) -> float:
    """Returns the 95 % value of the position error of machines drawn between the tolerances, um.

    The options are those of :meth:`abbe.Machine.budget`.
    """
    return float(machine.budget(**options, threads=threads).to_dict()["position_um"]["monte_carlo"]["p95"])


def reach_share(machine: Machine, *, threads: int | None = None, **options: Unpack[ReachOptions]) -> float:
    """Returns the share of tips and directions that the machine reaches, 0 to 1; options of ``Machine.reach``."""
    return machine.reach(**options, threads=threads).share


@dataclass(frozen=True)
class Design:
    """A design with its numbers."""

    #: Parameters by name.
    parameters: Mapping[str, Any]
    #: What the problem measures, by name; empty where the machine is refused.
    measured: Mapping[str, float]
    #: The diagnostic, where the machine or a measure of it is refused.
    refused: str | None
    #: The changes of the machine file, for ``machine.with_``.
    changes: Mapping[str, Any] = field(repr=False)
    _machine: Machine = field(repr=False)

    @property
    def machine(self) -> Machine:
        """The machine of this design."""
        return self._machine.with_(self.changes)


@dataclass(frozen=True)
class Problem:
    """What may be changed, what counts, and what must hold.

    ``parameters`` are intervals and lists of choices by name: paths of the machine file, or names of one's own that
    ``changes`` turns into what ``machine.with_`` takes. ``measure`` returns numbers by name; ``goals`` names those to
    make small, or with ``"max"`` large; ``constraints`` are the lowest and the highest allowed value of others, or
    ``None`` for an open end.
    """

    machine: Machine
    parameters: Parameters
    measure: Callable[[Machine], Mapping[str, float]]
    goals: Mapping[str, Literal["min", "max"]] | Sequence[str]
    constraints: Mapping[str, tuple[float | None, float | None]] = field(default_factory=dict)
    changes: Changes | None = None

    def __post_init__(self) -> None:
        if not self.parameters or not self.goals:
            raise ValueError("a problem has one parameter and one goal at least")

    @property
    def senses(self) -> dict[str, float]:
        """The goals by name: 1 to make small, -1 to make large."""
        goals = self.goals if isinstance(self.goals, Mapping) else dict.fromkeys(self.goals, "min")
        return {name: {"min": 1.0, "max": -1.0}[sense] for name, sense in goals.items()}

    def design(self, values: Mapping[str, Any]) -> Design:
        """Measures a design."""
        changes = changes_of(self.parameters, values, self.changes)
        try:
            measured = dict(self.measure(self.machine.with_(changes)))
        except DiagnosticError as refused:
            return Design(values, {}, str(refused.reason or refused), changes, self.machine)
        refuse_missing(measured, (*self.senses, *self.constraints))
        return Design(values, {name: float(of) for name, of in measured.items()}, None, changes, self.machine)

    def is_allowed(self, design: Design) -> bool:
        """True if no constraint is violated and the machine is not refused."""
        return design.refused is None and max(self.violations(design), default=0.0) <= 0.0

    def violations(self, design: Design) -> list[float]:
        """Returns by how much each end of a constraint is violated; below 0 there is room."""
        ends: list[float] = []
        for name, (low, high) in self.constraints.items():
            refused = design.refused is not None
            ends += [] if low is None else [_REFUSED if refused else low - design.measured[name]]
            ends += [] if high is None else [_REFUSED if refused else design.measured[name] - high]
        return ends if ends or design.refused is None else [_REFUSED]

    def objectives(self, design: Design) -> list[float]:
        """Returns the goals as numbers to make small."""
        refused = design.refused is not None
        return [_REFUSED if refused else sense * design.measured[name] for name, sense in self.senses.items()]


class _Vectors:
    """The vectors of an optimiser: an interval as it is, of a list the index."""

    def __init__(self, problem: Problem, map_: Callable[..., Iterable[Design]]) -> None:
        self.problem, self.map = problem, map_
        self.known: dict[tuple[float, ...], Design] = {}

    @property
    def bounds(self) -> list[tuple[float, float]]:
        # Of a list the bins [0, 1), [1, 2) ... are of one width.
        return [
            (of.low, of.high) if isinstance(of, Interval) else (0.0, float(len(of)))
            for of in self.problem.parameters.values()
        ]

    def values(self, vector: Sequence[float]) -> dict[str, Any]:
        values: dict[str, Any] = {}
        for (name, of), number in zip(self.problem.parameters.items(), vector, strict=True):
            plain = float(number)
            values[name] = plain if isinstance(of, Interval) else of[min(int(plain), len(of) - 1)]
        return values

    def key(self, vector: Sequence[float]) -> tuple[float, ...]:
        """Returns the vector with indices as whole numbers: designs that are equal have equal keys."""
        pairs = zip(self.problem.parameters.values(), vector, strict=True)
        return tuple(
            float(number) if isinstance(of, Interval) else float(min(int(number), len(of) - 1)) for of, number in pairs
        )

    def designs(self, vectors: NDArray[np.float64]) -> list[Design]:
        """Measures designs, each once."""
        rows: list[list[float]] = np.reshape(vectors, (-1, len(self.bounds))).tolist()
        keys = [self.key(row) for row in rows]
        new = [key for key in dict.fromkeys(keys) if key not in self.known]
        self.known.update(zip(new, self.map(self.problem.design, [self.values(key) for key in new]), strict=True))
        return [self.known[key] for key in keys]


def minimize(problem: Problem, *, seed: int = 1, map: Callable[..., Iterable[Design]] = map, **options: Any) -> Design:
    """Returns the best design for the only goal, by SciPy's differential evolution.

    ``options`` are those of ``scipy.optimize.differential_evolution`` (``maxiter``, ``popsize``, ``tol`` ...). ``map``
    measures the designs of a generation, in the order given. Raises ``ValueError`` if no design is allowed.
    """
    from scipy.optimize import NonlinearConstraint, differential_evolution

    if len(problem.senses) != 1:
        raise ValueError("`minimize` has one goal; `pareto` takes several")
    vectors = _Vectors(problem, map)

    def columns(x: NDArray[np.float64], of: Callable[[Design], list[float]], count: int) -> NDArray[np.float64]:
        # While no design is allowed SciPy asks for the goals of none.
        found = np.array([of(design) for design in vectors.designs(x.T)]).reshape(-1, count).T
        return found[:, 0] if x.ndim == 1 else found

    ends = sum((low is not None) + (high is not None) for low, high in problem.constraints.values())

    def goals(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(columns(x, problem.objectives, 1)[0])

    def limits(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return columns(x, problem.violations, ends)

    within = NonlinearConstraint(limits, -np.inf, 0.0) if ends else ()
    settings: dict[str, Any] = {"maxiter": 50, "popsize": 10, "polish": False, "vectorized": True, **options}
    # Its stubs know goals of one vector only.
    search: Any = differential_evolution
    search(goals, vectors.bounds, constraints=within, rng=seed, updating="deferred", **settings)
    allowed = [design for design in vectors.known.values() if problem.is_allowed(design)]
    if not allowed:
        raise ValueError(_none_allowed(vectors))
    return min(allowed, key=lambda design: problem.objectives(design)[0])


def _none_allowed(vectors: _Vectors) -> str:
    designs = list(vectors.known.values())
    refused = next((design.refused for design in designs if design.refused), None)
    why = f"; one was refused: {refused}" if refused else ""
    problem, measured = vectors.problem, [design for design in designs if not design.refused]
    if measured:
        nearest = min(measured, key=lambda design: max(problem.violations(design), default=0.0))
        numbers = ", ".join(f"{name} {nearest.measured[name]:.6g}" for name in problem.constraints)
        why += f"; the nearest has {numbers}: widen the constraints or the ranges, or search longer"
    return f"none of {len(designs)} designs keeps the constraints{why}"


@dataclass(frozen=True)
class Front(Sequence[Design]):
    """Designs of which none is better than another in all goals, in the order of the first goal."""

    designs: tuple[Design, ...]
    #: Number of designs that were measured.
    measured: int
    problem: Problem = field(repr=False)

    def __getitem__(self, index: Any) -> Any:
        return self.designs[index]

    def __len__(self) -> int:
        return len(self.designs)

    def __iter__(self) -> Iterator[Design]:
        return iter(self.designs)

    def records(self) -> list[dict[str, Any]]:
        """Returns a row for each design: its parameters and numbers."""
        return [{**design.parameters, **design.measured} for design in self.designs]

    def to_pandas(self) -> Any:
        """Returns the rows as a DataFrame (needs pandas); the names of columns hold the units of intervals."""
        import pandas

        intervals = {name: of for name, of in self.problem.parameters.items() if isinstance(of, Interval) and of.unit}
        columns = {name: f"{name} [{of.unit}]" for name, of in intervals.items()}
        return pandas.DataFrame(self.records()).rename(columns=columns)

    def save(self, folder: Text) -> list[Path]:
        """Writes the machines into a folder that is new or empty, and returns the paths of the designs in order.

        ``design-1.yaml`` and so on extend the machine of the problem, whose files are copied there too.
        """
        path = Path(folder)
        path.mkdir(parents=True, exist_ok=True)
        if any(path.iterdir()):
            raise FileExistsError(f"{path} is not empty")
        machine = self.problem.machine
        above = os.path.dirname(machine.path)
        texts = {os.path.relpath(name, above or "."): text for name, text in machine.texts.items()}
        outside = [name for name in texts if name.startswith("..") or os.path.isabs(name)]
        if outside:
            raise ValueError(f"{outside[0]} is outside the folder of {machine.path}: keep the machine's files in one")
        for name, text in texts.items():
            (path / name).parent.mkdir(parents=True, exist_ok=True)
            (path / name).write_text(text, encoding="utf-8")
        paths = []
        for index, design in enumerate(self.designs, 1):
            paths.append(path / f"design-{index:0{len(str(len(self)))}}.yaml")
            text = design.machine.texts[design.machine.path]
            paths[-1].write_text(json.dumps(json.loads(text), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        return paths


def pareto(
    problem: Problem,
    *,
    population: int = 40,
    generations: int = 20,
    seed: int = 1,
    map: Callable[..., Iterable[Design]] = map,
) -> Front:
    """Returns the designs that no other is better than in all goals, by pymoo's NSGA-II.

    All designs that were measured are compared, not only the last generation. ``map`` measures the designs of a
    generation, in the order given: the built-in one, or one that a cluster answers, such as
    ``lambda function, designs: client.gather(client.map(function, designs))``. Raises ``ValueError`` if no design is
    allowed.
    """
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem as Vectorized
    from pymoo.optimize import minimize as search
    from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

    vectors = _Vectors(problem, map)
    low, high = np.array(vectors.bounds).T
    ends = sum((low is not None) + (high is not None) for low, high in problem.constraints.values())

    class Asked(Vectorized):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(n_var=len(low), n_obj=len(problem.senses), n_ieq_constr=ends, xl=low, xu=high)

        def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *_: Any, **__: Any) -> None:
            designs = vectors.designs(x)
            out["F"] = np.array([problem.objectives(design) for design in designs])
            if ends:
                out["G"] = np.array([problem.violations(design) for design in designs])

    search(Asked(), NSGA2(pop_size=population), ("n_gen", generations), seed=seed, verbose=False)
    allowed = [design for design in vectors.known.values() if problem.is_allowed(design)]
    if not allowed:
        raise ValueError(_none_allowed(vectors))
    numbers = np.array([problem.objectives(design) for design in allowed])
    first = NonDominatedSorting().do(numbers, only_non_dominated_front=True)
    order = sorted(first, key=lambda index: (*numbers[index], index))
    return Front(tuple(allowed[index] for index in order), len(vectors.known), problem)
