"""Writes the phantom measurements beside this file: the closed forms of the machine in configs/papers/holub-2015.yaml over dual
numbers of order 2 (docs/theory.md), on a grid of the paper's measuring space, with a noise of 1 um (standard deviation).

    python3 generate.py [--check]
"""

import math
import sys
from pathlib import Path

# mm and rad: um/m are 1e-6, urad/m are 1e-9.
A, B, C = 14e-6, -11e-6, 16e-6
F1, F2, F3 = 22e-9, -16e-9, 26e-9
G1, G2, G3 = 30e-9, 18e-9, -24e-9
H1, H2, H3 = -20e-9, 12e-9, 28e-9
SXY, SXZ, SYZ = 28e-6, -34e-6, -23e-6
L = -150.0


def deviation(x, y, z):
    """dx, dy, dz in mm: real part, first and second order."""
    dx = -SXY * y - SXZ * z
    dx += A * x + L * (F1 * x + G3 * y + H3 * z) + z * (F1 * x + G3 * y)
    dx += SYZ * z * (F2 * x + G2 * y) - F2 * x * y - G2 * y * y / 2 + H3 * z * z / 2
    dx += L * (F2 * G1 * x * y + F2 * H1 * x * z + G2 * H1 * y * z) - B * F2 * x * y + F1 * G1 * x * y * y / 2
    dx += z * z * (F2 * H1 * x + G2 * H1 * y) / 2
    dx += z * (SXZ * F1 * G3 * x * y + SXZ * F2 * G2 * x * y - SYZ * F1 * G1 * x * y + C * F1 * x + C * G3 * y + F2 * G1 * x * y)
    dy = -SYZ * z
    dy += B * y + F2 * x * x / 2 - SXZ * z * (F2 * x + G2 * y) - F2 * SXY * x * y
    dy += -L * (F3 * x + G1 * y + H1 * z) - z * (F3 * x + G1 * y) - H1 * z * z / 2
    dy += L * (F2 * G3 * x * y + F2 * H3 * x * z + G2 * H3 * y * z) - C * z * (F3 * x + G1 * y)
    dy += -(F2 * G2 + F3 * G1) * x * y * y / 2 + z * z * (F2 * H3 * x + G2 * H3 * y) / 2
    dy += z * (SYZ * F2 * G2 * x * y + SYZ * F3 * G1 * x * y - SXZ * F3 * G3 * x * y + F2 * G3 * x * y)
    dz = C * z + SXZ * z * (F1 * x + G3 * y) + F1 * SXY * x * y - F1 * x * x / 2
    dz += -SYZ * z * (F3 * x + G1 * y) + F3 * x * y + G1 * y * y / 2
    dz += -L * (F1 * G3 * x * y + F3 * G1 * x * y + F1 * H3 * x * z + F3 * H1 * x * z + G3 * H3 * y * z + G1 * H1 * y * z)
    dz += B * F3 * x * y + F1 * G2 * x * y * y / 2 - z * z * (F1 * H3 * x + F3 * H1 * x + G3 * H3 * y + G1 * H1 * y) / 2
    dz += -z * (SXZ * F3 * G2 * x * y + SYZ * F1 * G2 * x * y + F1 * G3 * x * y + F3 * G1 * x * y)
    return dx, dy, dz


def noise():
    """Normal numbers of standard deviation 1 from a fixed seed (Box and Muller)."""
    state = 2015
    def unit():
        nonlocal state
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        return ((state >> 11) + 0.5) / 2**53
    while True:
        radius, angle = math.sqrt(-2 * math.log(unit())), 2 * math.pi * unit()
        yield radius * math.cos(angle)
        yield radius * math.sin(angle)


def table(points):
    numbers = noise()
    lines = ["X [mm],Y [mm],Z [mm],dx [um],dy [um],dz [um]"]
    for x, y, z in points:
        cells = [f"{d * 1e3 + next(numbers):.2f}" for d in deviation(x, y, z)]
        lines.append(",".join([f"{x:g}", f"{y:g}", f"{z:g}", *cells]))
    return "\n".join(lines) + "\n"


def steps(low, high):
    return [round(low + (high - low) * i / 6, 2) for i in range(7)]


def main():
    xs, ys, zs = steps(300, 450), steps(200, 300), steps(-200, -50)
    files = {
        "phantom.csv": table([(x, y, z) for z in zs for y in ys for x in xs]),
        "line.csv": table([(x, 250.0, -125.0) for x in xs]),
        "three-lines.csv": table(
            [(x, 250.0, -125.0) for x in xs] + [(375.0, y, -125.0) for y in ys] + [(375.0, 250.0, z) for z in zs]
        ),
    }
    folder = Path(__file__).parent
    for name, text in files.items():
        if "--check" in sys.argv:
            if (folder / name).read_text() != text:
                sys.exit(f"{name} is not what this script writes")
        else:
            (folder / name).write_text(text)


if __name__ == "__main__":
    main()
