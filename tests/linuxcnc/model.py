"""What LinuxCNC makes of a COMP_FILE, written down independently of abbe.

Measured on the real controller: trims and slopes are kept as float32 (and the
difference of two trims is taken in float32), nominals as float64; linear between
points, constant outside, one column per direction of the last motion.
"""

import bisect
import math
import re
import struct

MAX_POINTS = 256
MAX_LINE = 254
NUMBER = re.compile(r"-?[0-9]+(\.[0-9]+)?")
DIRECTIONS = ("forward", "reverse")


class TableRefused(Exception):
    """A compensation file that LinuxCNC would not take as it stands."""


def f32(value):
    """`value` rounded to single precision."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def lint(data):
    """Everything LinuxCNC would swallow in silence, as (line number, what)."""
    findings = []
    if b"\r" in data:
        findings.append((0, "carriage return"))
    if not data:
        return [(0, "empty file")]
    if not data.endswith(b"\n"):
        findings.append((0, "no final newline"))
    try:
        lines = data.decode("ascii").split("\n")
    except UnicodeDecodeError:
        return findings + [(0, "not ASCII")]
    if lines[-1] == "":
        lines.pop()
    if len(lines) > MAX_POINTS:
        findings.append((MAX_POINTS + 1, f"{len(lines)} lines, {MAX_POINTS} are read"))
    last = -math.inf
    for number, line in enumerate(lines, 1):
        found = lint_line(line)
        findings += [(number, what) for what in found]
        if not found:
            nominal = float(line.split()[0])
            if nominal <= last:
                findings.append((number, "nominal does not increase"))
            last = nominal
    return findings


def lint_line(line):
    """What is wrong with one line by itself."""
    if not line.strip():
        return ["blank line"]
    if line.lstrip().startswith(("#", ";")):
        return ["comment line"]
    found = []
    if len(line) > MAX_LINE:
        found.append(f"longer than {MAX_LINE} characters")
    words = line.split()
    if len(words) != 3:
        found.append(f"{len(words)} columns instead of 3")
    for word in words:
        if not NUMBER.fullmatch(word):
            found.append(f"not a plain decimal: {word[:20]!r}")
        elif not math.isfinite(float(word)):
            found.append(f"not finite: {word[:20]!r}")
        elif word.startswith("-") and float(word) == 0.0:
            found.append(f"negative zero: {word!r}")
    return found


class Table:
    """One compensation file of type 0 or 1, evaluated as the controller does."""

    def __init__(self, points, kind=1):
        if kind == 0:  # nominal and actual positions: the correction is the difference
            points = [(n, n - forward, n - reverse) for n, forward, reverse in points]
        self.nominal = [point[0] for point in points]
        self.trim = {name: [f32(point[column]) for point in points]
                     for column, name in enumerate(DIRECTIONS, 1)}
        self.slope = {name: self._slopes(self.trim[name]) for name in DIRECTIONS}

    def _slopes(self, trim):
        inner = [f32(f32(trim[i + 1] - trim[i]) / (self.nominal[i + 1] - self.nominal[i]))
                 for i in range(len(trim) - 1)]
        return inner + [0.0]

    @classmethod
    def read(cls, path, kind=1):
        """Reads a file that passes `lint`; TableRefused otherwise."""
        with open(path, "rb") as source:
            data = source.read()
        findings = lint(data)
        if findings:
            number, what = findings[0]
            raise TableRefused(f"{path}:{number}: {what} ({len(findings)} findings)")
        rows = data.decode("ascii").splitlines()
        return cls([tuple(float(word) for word in row.split()) for row in rows], kind)

    @property
    def low(self):
        return self.nominal[0]

    @property
    def high(self):
        return self.nominal[-1]

    def correction(self, position, direction):
        """The value of joint.N.backlash-corr; a node belongs to the interval above it."""
        index = bisect.bisect_right(self.nominal, position) - 1
        trim, slope = self.trim[direction], self.slope[direction]
        if index < 0:
            return trim[0]
        return trim[index] + slope[index] * (position - self.nominal[index])

    def steepest(self, low=-math.inf, high=math.inf):
        """Largest absolute slope of either column between two positions."""
        first = max(bisect.bisect_right(self.nominal, low) - 1, 0)
        last = bisect.bisect_left(self.nominal, high)
        return max((abs(slope) for name in DIRECTIONS
                    for slope in self.slope[name][first:last]), default=0.0)
