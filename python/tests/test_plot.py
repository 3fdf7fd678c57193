"""Drawings with Matplotlib: what stands in them is what the machine says."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import matplotlib.pyplot
import numpy as np
import pytest
from conftest import CONFIGS, REPOSITORY
from matplotlib.patches import Rectangle
from matplotlib.quiver import Quiver

import abbe
import abbe.plot

matplotlib.use("Agg")


@pytest.mark.filterwarnings("ignore::abbe.DiagnosticWarning")
def test_the_field_has_the_deviations_and_their_units(tmp_path: Path) -> None:
    """Levels span the deviations of the plane; arrows are its parts along the axes."""
    machine = abbe.load(CONFIGS / "trunnion.yaml")
    axes = abbe.plot.field(machine, ("X", "Z"), at={"Y": 200, "C": 90}, nodes=19)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("X, mm", "Z, mm")
    x, z = np.linspace(0, 500, 19)[::2], np.linspace(-400, 0, 19)[::2]
    (arrows,) = [part for part in axes.collections if isinstance(part, Quiver)]
    here = machine.deviations({"X": np.tile(x, 10), "Y": 200, "Z": np.repeat(z, 10), "C": 90}).position * 1e3
    assert np.allclose(np.asarray(arrows.U).ravel(), here[:, 0], rtol=0, atol=1e-9)
    assert np.allclose(np.asarray(arrows.V).ravel(), here[:, 2], rtol=0, atol=1e-9)
    low, high = axes.collections[0].get_clim()
    assert low <= np.linalg.norm(here, axis=1).min() and np.linalg.norm(here, axis=1).max() <= high
    matplotlib.pyplot.savefig(tmp_path / "field.png")
    assert (tmp_path / "field.png").stat().st_size > 1000
    matplotlib.pyplot.close("all")


@pytest.mark.filterwarnings("ignore::abbe.DiagnosticWarning")
def test_a_budget_is_drawn_largest_first_into_given_axes() -> None:
    """The bars are the means of the table."""
    found = abbe.load(CONFIGS / "trunnion.yaml").budget(class_="production", samples=20, poses=20)
    own = matplotlib.pyplot.subplots()[1]
    assert abbe.plot.budget(found, top=5, ax=own) is own
    widths = [bar.get_width() for bar in own.patches if isinstance(bar, Rectangle)]
    means = sorted((row["average_um"] for row in found.records()), reverse=True)[:5]
    assert widths == means[::-1]
    assert own.get_xlabel().endswith("um")
    matplotlib.pyplot.close("all")


def test_fitted_values_have_their_uncertainties() -> None:
    """Points and bars are those of the table; a unit that nothing has is refused."""
    folder = REPOSITORY / "docs" / "examples" / "shop-floor"
    fit = abbe.load(folder / "machine.yaml").identify([folder / "volume.csv"], fit=["location", "EXX:poly3"])
    axes = abbe.plot.parameters(fit, "urad", top=3)
    rows = {row["name"]: row for row in fit.records()}
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert len(names) == 3
    (container,) = axes.containers
    values = np.asarray(container[0].get_xdata())
    assert list(values) == [rows[name]["value"] for name in names]
    ends = [np.asarray(segment)[:, 0] for segment in container[2][0].get_segments()]
    halves = [(high - low) / 2 for low, high in ends]
    assert np.allclose(halves, [2 * rows[name]["sigma"] for name in names], rtol=1e-12, atol=0)
    with pytest.raises(ValueError, match="no value is fitted in mm"):
        abbe.plot.parameters(fit, "mm")
    matplotlib.pyplot.close("all")


@pytest.mark.filterwarnings("ignore::abbe.DiagnosticWarning")
def test_the_spread_of_a_map_reaches_its_largest_value() -> None:
    """95 % of the poses lie below the line."""
    found = abbe.load(CONFIGS / "trunnion.yaml").map(poses={"random": 1000}, rows=True)
    axes = abbe.plot.spread(found)
    step, line = axes.lines
    lengths, shares = np.asarray(step.get_xdata(), dtype=float), np.asarray(step.get_ydata(), dtype=float)
    assert shares[-1] == 100 and np.isclose(lengths[-1], found.position_um.max, rtol=1e-12, atol=0)
    assert np.isclose(shares[np.searchsorted(lengths, np.asarray(line.get_xdata())[0])], 95, rtol=0, atol=0.11)
    matplotlib.pyplot.close("all")
