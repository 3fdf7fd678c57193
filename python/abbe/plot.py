"""Drawings with Matplotlib, where the pictures of the program are not enough (``pip install abbe[plot]``).

Every function draws into the axes ``ax`` that it is given, or into new ones, and returns them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._machine import Machine
from ._results import MapResult, Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["budget", "field", "parameters", "spread"]


def field(
    machine: Machine,
    plane: tuple[str, str] = ("X", "Y"),
    *,
    at: Mapping[str, float] | None = None,
    nodes: int = 25,
    ax: Axes | None = None,
    **options: Any,
) -> Axes:
    """Draws the length of the deviation (um) over two linear axes as colours, and its parts along them as arrows.

    ``plane`` names the axes; ``at`` are the positions of the others, mm and deg (left out: 0). ``options`` are those of
    :meth:`abbe.Machine.deviations`. Vectors are in the machine's directions where the axes run
    along X, Y and Z and no rotary axis turns the workpiece.
    """
    first, second = plane
    ends = [machine.axes[name]["travel"] for name in (first, second)]
    across, along = (np.linspace(float(low), float(high), nodes) for low, high in ends)
    grid = np.meshgrid(across, along, indexing="ij")
    poses: dict[str, Any] = {**(at or {}), first: grid[0].ravel(), second: grid[1].ravel()}
    deviation = machine.deviations(poses, **options).position * 1e3
    length = np.linalg.norm(deviation, axis=1).reshape(nodes, nodes)
    axes = ax if ax is not None else _new()
    colours = axes.contourf(across, along, length.T, levels=12, cmap="cividis")
    axes.figure.colorbar(colours, ax=axes, label="deviation, um")
    parts = ["XYZ".index(name[0]) for name in (first, second) if name[0] in "XYZ"]
    if len(parts) == 2:
        step = max(1, nodes // 9)
        arrows = [deviation[:, k].reshape(nodes, nodes)[::step, ::step].T for k in parts]
        axes.quiver(across[::step], along[::step], *arrows, angles="xy", color="white", width=0.004)
    axes.set_xlabel(f"{first}, {machine.axes[first]['unit']}")
    axes.set_ylabel(f"{second}, {machine.axes[second]['unit']}")
    axes.set_title(machine.name)
    return axes


def budget(result: Result, *, top: int = 12, ax: Axes | None = None) -> Axes:
    """Draws what each error does at its bound to the position, averaged over the poses (um), the largest first.

    ``result`` is that of :meth:`abbe.Machine.budget`.
    """
    rows = sorted(result.records(), key=lambda row: float(row["average_um"]), reverse=True)[:top][::-1]
    axes = ax if ax is not None else _new()
    names = [f"{row['error']}  {row['tolerance']:g} {row['unit']}" for row in rows]
    axes.barh(names, [row["average_um"] for row in rows])
    axes.set_xlabel("deviation of each error at its bound, mean over the poses, um")
    return axes


def parameters(result: Result, unit: str = "um", *, top: int = 20, ax: Axes | None = None) -> Axes:
    """Draws the fitted values of a unit with their expanded uncertainties (k = 2), the largest against theirs first.

    ``result`` is that of :meth:`abbe.Machine.identify`. Values that are held, or that the readings leave free, are left
    out.
    """
    rows = [row for row in result.records() if row["unit"] == unit and row["sigma"]]
    if not rows:
        raise ValueError(f"no value is fitted in {unit}: there are {sorted({row['unit'] for row in result.records()})}")
    rows = sorted(rows, key=lambda row: abs(float(row["value"]) / float(row["sigma"])), reverse=True)[:top][::-1]
    axes = ax if ax is not None else _new()
    values, expanded = ([float(row[key]) * k for row in rows] for key, k in (("value", 1), ("sigma", 2)))
    axes.errorbar(values, [row["name"] for row in rows], xerr=expanded, fmt="o", capsize=3)
    axes.axvline(0, color="0.7", linewidth=0.8)
    axes.set_xlabel(f"value with its expanded uncertainty (k = 2), {unit}")
    return axes


def spread(result: MapResult, *, ax: Axes | None = None) -> Axes:
    """Draws which share of the poses has a deviation up to a length (um), with the 95 % value.

    ``result`` is that of :meth:`abbe.Machine.map` with ``rows=True``.
    """
    rows = result.rows
    lengths = np.sort(np.linalg.norm(np.stack([rows[f"d{letter} [um]"] for letter in "xyz"]), axis=0))
    axes = ax if ax is not None else _new()
    axes.step(lengths, np.arange(1, len(lengths) + 1) / len(lengths) * 100, where="post")
    p95 = float(result.position_um.p95)
    axes.axvline(p95, color="0.5", linewidth=0.8, label=f"95 %: {p95:.4g} um")
    axes.set_xlabel("deviation, um")
    axes.set_ylabel("poses, %")
    axes.legend()
    return axes


def _new() -> Axes:
    import matplotlib.pyplot

    return matplotlib.pyplot.subplots()[1]
