"""A rigid-body model of machines in NumPy, by docs/theory.md and docs/language.md; it shares no code with abbe.

Default conventions: location errors displace the axis, component errors of a linear axis act on the carriage, those of
a rotary axis in the frame that does not turn, joints are orthogonal.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Vector = NDArray[np.float64]

UNITS = {"nm": 1e-6, "um": 1e-3, "mm": 1.0, "m": 1e3, "nrad": 1e-9, "urad": 1e-6, "mrad": 1e-3, "rad": 1.0}
DIRECTIONS = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1), "A": (1, 0, 0), "B": (0, 1, 0), "C": (0, 0, 1)}


def quantity(text: Any) -> float:
    """Returns a quantity in mm or rad."""
    if isinstance(text, (int, float)):
        return float(text)
    number, unit = text.split()
    return float(number) * UNITS[unit]


class Axis:
    """A joint: its line, and its errors as functions of the position."""

    def __init__(self, name: str, entry: dict[str, Any]) -> None:
        self.name = name
        self.rotary = entry.get("kind", "rotary" if name[0] in "ABC" else "linear") == "rotary"
        direction = np.array(entry.get("direction", DIRECTIONS.get(name[0])), float)
        self.direction = direction / np.linalg.norm(direction)
        self.origin = np.array(entry.get("origin", (0, 0, 0)), float)
        self.location = np.zeros(6)
        self.tables: list[tuple[Vector, list[tuple[int, str, Vector]]]] = []

    def motion(self, q: float) -> Vector:
        """Returns the nominal motion about the origin."""
        if self.rotary:
            return homogeneous(np.zeros(3), self.direction * np.radians(q))
        return homogeneous(self.direction * q, np.zeros(3))

    def errors(self, q: float, approach: str) -> Vector:
        """Returns the six component errors."""
        six = np.zeros(6)
        for positions, columns in self.tables:
            for index, side, values in columns:
                if approach == "mean":
                    weight = 1.0 if side == "" else 0.5
                else:
                    weight = float(side in ("", "+" if approach == "forward" else "-"))
                at = q % 360.0 if self.rotary and positions[-1] - positions[0] == 360.0 else q
                six[index] += weight * np.interp(at, positions, values)
        return six


def homogeneous(shift: Vector, turn: Vector) -> Vector:
    """Returns a motion: the rotation by a vector, then the shift."""
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    matrix[:3, 3] = shift
    return matrix


class RigidBody:
    """A machine file, read by itself."""

    def __init__(self, path: Path, extra: dict[str, str] | None = None) -> None:
        text = yaml.safe_load(path.read_text())
        left, right = text["chain"].split(" b ")
        self.carried = {name.rstrip("'") for name in left.split()[1:]}
        names = [name.rstrip("'") for name in (left + " " + right).split() if name not in ("w", "t")]
        self.axes = [Axis(name, text["axes"][name]) for name in names]
        tool = text["tool"]
        offset = np.array(tool.get("offset", (0, 0, -quantity(tool.get("length", 0.0)))), float)
        self.tip = np.array(tool["gauge"], float) + offset
        for name, value in {**text.get("errors", {}), **(extra or {})}.items():
            axis = next(axis for axis in self.axes if axis.name == name[3:])
            axis.location["XYZABC".index(name[1])] = quantity(value)
        for table in text.get("measured", []):
            self.read(path.parent / table)

    def read(self, path: Path) -> None:
        """Reads a table of component errors."""
        lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
        heads = [head.strip() for head in lines[0].split(",")]
        numbers = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
        axis = next(axis for axis in self.axes if axis.name == heads[0].split()[0])
        columns = []
        for k, head in enumerate(heads[1:], 1):
            name, unit = head.split(" [")
            side = name[-1] if name[-1] in "+-" else ""
            columns.append(("XYZABC".index(name[1]), side, numbers[:, k] * UNITS[unit.rstrip("]")]))
        axis.tables.append((numbers[:, 0], columns))

    def deviation(self, pose: Vector, approach: str = "mean") -> tuple[Vector, Vector]:
        """Returns displacement of the tip (mm) and rotation of the tool (rad), workpiece frame."""
        actual, nominal = np.eye(4), np.eye(4)
        for axis, q in zip(self.axes, pose, strict=True):
            motion = axis.motion(q)
            location = homogeneous(axis.location[:3], axis.location[3:])
            six = axis.errors(q, approach)
            error = homogeneous(six[:3], six[3:])
            moved = location @ motion @ np.linalg.inv(location)
            # Seen from the other side of the bed the order is the other one.
            error_first = axis.rotary != (axis.name in self.carried)
            joint = error @ moved if error_first else moved @ error
            there, back = homogeneous(axis.origin, np.zeros(3)), homogeneous(-axis.origin, np.zeros(3))
            actual, nominal = actual @ there @ joint @ back, nominal @ there @ motion @ back
        tip = np.append(self.tip, 1.0)
        turn = Rotation.from_matrix(actual[:3, :3] @ nominal[:3, :3].T).as_rotvec()
        return ((actual - nominal) @ tip)[:3], turn
