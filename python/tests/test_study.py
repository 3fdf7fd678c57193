"""Optimised designs against closed forms, and as files."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import abbe
from abbe.study import Interval, Parameters, Problem, minimize, p95_um, pareto

MACHINE = """
abbe: 1
machine: G
chain: w b X Y t
axes: {X: {travel: [0, 300], origin: [0, 0, 0]}, Y: {travel: [0, 300], origin: [0, 0, 0]}}
errors: {EC0Y: 20 urad}
"""


def measure(machine: abbe.Machine) -> Mapping[str, float]:
    """The deviation at the far corner by the squareness, and a price that falls with it."""
    squareness = machine.errors["EC0Y"].value
    length = machine.axes["X"].travel[1]
    deviation = np.linalg.norm(machine.deviations({"X": length, "Y": 300}).position) * 1e3
    return {"um": float(deviation), "price": 1e-3 / squareness + length / 100, "length": length}


PARAMETERS: Parameters = {"errors.EC0Y": Interval(2, 40, "urad"), "axes.X.travel": [[0, 200], [0, 300], [0, 500]]}


def test_a_pareto_front_and_its_files(tmp_path: Path) -> None:
    problem = Problem(abbe.loads(MACHINE), PARAMETERS, measure, ["um", "price"], {"length": (300, None)})
    front = pareto(problem, population=16, generations=8)
    rows = front.records()
    assert len(rows) > 5 and front.measured > 100
    assert all(row["length"] >= 300 for row in rows), "the constraint"
    assert sum(row["length"] == 300 for row in rows) > len(rows) / 2, "longer costs more and gains nothing"
    for row in rows:
        # Squareness EC0Y turns Y, so the corner moves by EC0Y * 300 mm along X.
        urad = row["errors.EC0Y"]
        assert row["um"] == pytest.approx(urad * 1e-6 * 300 * 1e3, rel=1e-4)
        assert row["price"] == pytest.approx(1e3 / urad + row["length"] / 100, rel=1e-9)
    assert list(front.to_pandas()) == ["errors.EC0Y [urad]", "axes.X.travel", "um", "price", "length"]
    assert [row["um"] for row in rows] == sorted(row["um"] for row in rows)
    assert [row["price"] for row in rows] == sorted((row["price"] for row in rows), reverse=True)
    assert len({(row["errors.EC0Y"], row["length"]) for row in rows}) == len(rows), "no design twice"
    again = pareto(problem, population=16, generations=8)
    assert again.records() == rows and again.measured == front.measured
    paths = front.save(tmp_path / "front")
    assert len(paths) == len(front)
    for path, row in zip(paths, rows, strict=True):
        assert measure(abbe.load(path)) == {name: row[name] for name in ("um", "price", "length")}
    with pytest.raises(FileExistsError):
        front.save(tmp_path / "front")


def test_the_best_design() -> None:
    problem = Problem(abbe.loads(MACHINE), PARAMETERS, measure, ["price"], {"um": (None, 4.0), "length": (250, None)})
    best = minimize(problem, maxiter=30, seed=2)
    # The price falls with the squareness, so the limit of 4 um binds: 4 um / 300 mm.
    assert best.measured["price"] == pytest.approx(1e3 / (4e3 / 300) + 3, rel=5e-3)
    assert best.measured["um"] <= 4.0 and best.parameters["axes.X.travel"] == [0, 300]
    assert measure(best.machine) == best.measured


def test_what_is_impossible_is_said() -> None:
    problem = Problem(abbe.loads(MACHINE), PARAMETERS, measure, ["price"], {"um": (None, 1e-6)})
    # At 2 urad, the end of the range, the corner is still 0.6 um away.
    with pytest.raises(ValueError, match=r"none of .*; the nearest has um 0\.6\d*: widen"):
        minimize(problem, maxiter=20)
    unnamed = Problem(abbe.loads(MACHINE), PARAMETERS, measure, ["prise"])
    with pytest.raises(LookupError, match="`measure` returns um, price, length and no prise"):
        minimize(unnamed, maxiter=1)
    wrong = Problem(abbe.loads(MACHINE), {"errors.EC0Y": ["3 kg"]}, measure, ["price", "um"])
    with pytest.raises(ValueError, match="E0"):
        pareto(wrong, population=2, generations=1)
    with pytest.raises(ValueError, match="pareto"):
        minimize(wrong)


def test_goals_to_make_large() -> None:
    problem = Problem(abbe.loads(MACHINE), PARAMETERS, measure, {"length": "max", "um": "min"})
    rows = pareto(problem, population=12, generations=6).records()
    assert max(row["length"] for row in rows) == 500
    assert min(row["um"] for row in rows) < 5e-6 * 300 * 1e3 and all(math.isfinite(row["um"]) for row in rows)


def test_the_measures_of_the_package() -> None:
    machine = abbe.loads(MACHINE).with_({"errors.EC0Y": {"tolerance": "20 urad"}})
    # Uniform between +-20 urad, at most 300 mm away: 95 % of 6 um.
    assert p95_um(machine, samples=4000) == pytest.approx(0.95 * 6.0, rel=0.02)
