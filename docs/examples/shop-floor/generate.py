#!/usr/bin/env python3
"""Writes the readings of the calibration guide: synthetic, of a machine whose errors are the formulas below.

Nothing here is a measurement of a real machine. `--check` compares instead of writing.
"""

import math
import pathlib
import sys

HERE = pathlib.Path(__file__).parent


class Noise:
    """Normal numbers of a small linear congruential generator, the same on every platform."""

    def __init__(self, seed: int) -> None:
        self.state = seed

    def uniform(self) -> float:
        self.state = (1103515245 * self.state + 12345) % 2**31
        return (self.state + 0.5) / 2**31

    def normal(self, size: float) -> float:
        return size * (sum(self.uniform() for _ in range(12)) - 6.0)


def exx(x: float) -> float:
    """Positioning error of X at 20 degC, um."""
    return 0.012 * x + 1.8 * math.sin(x / 70.0)


def laser() -> str:
    noise, targets = Noise(7), [2.3, 51.9, 104.7, 148.2, 203.6, 251.1, 297.4, 352.8, 399.5, 453.3, 498.6]
    lines = ["# synthetic readings of a laser, material of the machine at 22.4 degC"]
    lines.append("target [mm];" + ";".join(f"{run}+ [um];{run}- [um]" for run in range(1, 6)))
    for x in targets:
        warm = exx(x) + 11.5e-3 * 2.4 * (x - targets[0])
        cells = [warm + sign * -1.4 + noise.normal(0.4) for _ in range(5) for sign in (1, -1)]
        lines.append(f"{x};" + ";".join(f"{cell:.2f}" for cell in cells))
    return "\n".join(lines) + "\n"


def circle() -> str:
    noise, lines = Noise(11), ["# synthetic readings of a ball bar of 150 mm, 1000 mm/min", "angle [deg],ccw [um],cw [um]"]
    for angle in range(0, 360, 3):
        t = math.radians(angle + 1.5)
        row = []
        for sense in (1.0, -1.0):
            along, up = -math.sin(t) * sense, math.cos(t) * sense
            x = 150.0 * math.cos(t) * (1.0 + 8e-6) - 1.4e-3 * math.copysign(1.0, along) - 0.8e-3 * along
            y = 150.0 * math.sin(t) - 0.9e-3 * math.copysign(1.0, up)
            length = math.hypot(x - 18e-6 * y - 4e-3, y + 3e-3)
            row.append(f"{(length - 150.0) * 1e3 + noise.normal(0.1):.3f}")
        lines.append(f"{angle + 1.5},{row[0]},{row[1]}")
    return "\n".join(lines) + "\n"


def volume() -> str:
    noise, lines = Noise(13), ["# synthetic deviations of the functional point, as a tracker reads them", "X,Y,Z,dx [um],dy [um],dz [um]"]
    for i in range(90):
        x, y, z = 500.0 * noise.uniform(), 400.0 * noise.uniform(), -300.0 * noise.uniform()
        # Squarenesses of 18, -9 and 12 urad, positioning of X, and a pitch of Y that lifts the spindle's end of Z.
        dx = exx(x) - 18e-3 * (y - 200.0) + 12e-3 * z
        dy = 0.006 * y + 9e-3 * z
        dz = -0.01 * z + 4.0 * (y / 400.0) ** 2
        cells = [value + noise.normal(0.6) for value in (dx, dy, dz)]
        lines.append(f"{x:.3f},{y:.3f},{z:.3f}," + ",".join(f"{cell:.2f}" for cell in cells))
    return "\n".join(lines) + "\n"


def main() -> int:
    stale = []
    for name, text in {"x-laser.csv": laser(), "circle-xy.csv": circle(), "volume.csv": volume()}.items():
        file = HERE / name
        if "--check" in sys.argv:
            if not file.exists() or file.read_text() != text:
                stale.append(name)
        else:
            file.write_text(text)
    if stale:
        print(f"out of date: {', '.join(stale)}; run docs/examples/shop-floor/generate.py", file=sys.stderr)
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
