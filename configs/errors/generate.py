#!/usr/bin/env python3
"""Write the error curves of the machines in configs/ (python3, standard library only).

    generate.py            write errors/<machine>/<axis>.csv
    generate.py --check    compare the files on disk with what would be written, and
                           check that machine files and curves belong together

Travel, direction and class are read from the machine files, so that they are said once.
The numbers are typical of the machine's class; no product was measured.

A curve is a smooth shape, the period of the drive, reversal and noise. What the location
errors of the machine file already say is removed: the mean of every curve, the straight line
of straightness, the first harmonic of the radial and tilt errors of a rotary axis.
"""

import math
import pathlib
import random
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
CONFIGS = HERE.parent
MAX_ROWS = 400
GRID = 1200  # samples of the fits that remove what the location errors say

# Peak values. Linear: pos and straight um per metre, angle urad. Rotary: radial, axial um,
# tilt, own urad. reversal is forward to reverse, periodic the amplitude of screw or worm.
# period: screw pitch in mm; teeth: worm wheel. step: target spacing in mm, rot_step in deg.
CLASSES = {
    "premium": dict(
        pos=3.0, straight=2.0, angle=7.0, reversal=0.4, periodic=0.2, noise=0.10, noise_angle=0.4,
        radial=1.0, axial=0.7, tilt=3.5, own=13.0, rot_reversal=1.2, rot_periodic=0.6, rot_noise=0.5,
        period=20.0, teeth=66, step=30.0, rot_step=12.0),
    "production": dict(
        pos=7.0, straight=5.0, angle=16.0, reversal=1.2, periodic=0.5, noise=0.20, noise_angle=0.8,
        radial=2.0, axial=1.4, tilt=7.0, own=28.0, rot_reversal=3.0, rot_periodic=1.5, rot_noise=1.0,
        period=16.0, teeth=90, step=30.0, rot_step=12.0),
    "commodity": dict(
        pos=17.0, straight=10.0, angle=32.0, reversal=4.0, periodic=1.5, noise=0.50, noise_angle=2.0,
        radial=4.0, axial=3.0, tilt=14.0, own=60.0, rot_reversal=15.0, rot_periodic=4.0, rot_noise=2.5,
        period=10.0, teeth=72, step=30.0, rot_step=15.0),
    "large-gantry": dict(
        pos=12.0, straight=9.0, angle=40.0, reversal=5.0, periodic=1.5, noise=1.50, noise_angle=2.5,
        radial=5.0, axial=3.5, tilt=12.0, own=26.0, rot_reversal=4.0, rot_periodic=2.0, rot_noise=1.5,
        period=40.0, teeth=120, step=125.0, rot_step=15.0),
    "desktop": dict(
        pos=120.0, straight=60.0, angle=220.0, reversal=15.0, periodic=5.0, noise=1.50, noise_angle=15.0,
        radial=12.0, axial=8.0, tilt=180.0, own=420.0, rot_reversal=150.0, rot_periodic=60.0, rot_noise=25.0,
        period=8.0, teeth=20, step=5.0, rot_step=6.0),
}

# What differs from the class: for a machine, or for one of its axes.
MACHINES = {
    "trunnion": dict(
        pos=6.0, straight=4.0, angle=12.0, reversal=0.9, periodic=0.3, noise=0.12, noise_angle=0.3, step=25.0,
        radial=1.5, axial=1.2, tilt=5.0, own=24.0, rot_reversal=2.0, rot_periodic=0.5, rot_noise=0.4,
        A=dict(tilt=4.0, own=16.0, rot_step=10.0), C=dict(teeth=120)),
    # Targets every quarter of the screw's pitch: here the periodic error is seen as it is.
    "vmc-cframe-754": dict(period=16.0, X=dict(step=4.0), Y=dict(step=20.0), Z=dict(step=25.0)),
    "hmc-4ax": dict(B=dict(rot_step=3.0, teeth=36)),
    "boring-w": dict(pos=8.0, straight=7.0, angle=24.0, reversal=3.0, noise=0.6, step=100.0, W=dict(step=40.0, period=20.0)),
    "hh-bd-ram": dict(step=80.0),
    "hh-ca-gantry": dict(Z=dict(step=60.0, period=20.0)),
    "gantry-3ax": dict(Z=dict(step=50.0, period=20.0)),
    "millturn-bc": dict(Z=dict(step=40.0), X=dict(period=10.0)),
}


# --- machine files: only what the repository's own files use -------------------------------


class Axis:
    def __init__(self, name, fields, number):
        self.name = name
        self.number = number
        self.rotary = self._kind(fields)
        self.direction = self._direction(fields)
        self.continuous = re.search(r"travel:\s*continuous", fields) is not None
        self.lo, self.hi = (0.0, 360.0) if self.continuous else self._travel(fields)

    def _kind(self, fields):
        kind = re.search(r"kind:\s*(\w+)", fields)
        return kind.group(1) == "rotary" if kind else self.name[0] in "ABC"

    def _direction(self, fields):
        given = re.search(r"direction:\s*\[([^]]*)\]", fields)
        if given:
            vector = [float(v) for v in given.group(1).split(",")]
        else:
            letter = {"U": 0, "V": 1, "W": 2}.get(self.name[0], "XYZABC".find(self.name[0]) % 3)
            vector = [1.0 if i == letter else 0.0 for i in range(3)]
        length = math.sqrt(sum(v * v for v in vector))
        return [v / length for v in vector]

    def _travel(self, fields):
        found = re.search(r"travel:\s*\[([^]]*)\]", fields)
        if not found:
            raise SystemExit(f"{self.name}: no travel")
        lo, hi = (float(v.replace("mm", "").replace("deg", "")) for v in found.group(1).split(","))
        return lo, hi


class Machine:
    def __init__(self, path):
        self.path = path
        self.stem = path.stem
        text = path.read_text(encoding="utf-8")
        self.lines = [strip_comment(line) for line in text.splitlines()]
        self.chain = self._scalar("chain").strip('"')
        found = re.search(r"class:\s*([\w-]+)", self._scalar("provenance") or "")
        self.kind = found.group(1) if found else ""
        block = joined(self._block("axes"))
        self.axes = [Axis(m.group(1), m.group(2), i) for i, line in enumerate(block)
                     if (m := re.match(r"\s+(\w+):\s*\{(.*)\}\s*$", line))]
        self.measured = re.findall(r"[\w./-]+\.csv", self._scalar("measured") + " ".join(self._block("measured")))
        self.errors = re.findall(r"(?:^\s+|[{,]\s*)(E[XYZABC]0?\w+):", "\n".join(self._block("errors")), re.M)

    def _scalar(self, key):
        for line in self.lines:
            if line.startswith(key + ":"):
                return line[len(key) + 1:].strip()
        return ""

    def _block(self, key):
        out, inside = [], False
        for line in self.lines:
            if line and not line[0].isspace():
                inside = line.startswith(key + ":")
            elif inside and line.strip():
                out.append(line)
        return out


def joined(lines):
    """Lines of a block, a mapping in braces that goes over several of them as one."""
    out, depth = [], 0
    for line in lines:
        if depth > 0:
            out[-1] += " " + line.strip()
        else:
            out.append(line)
        depth += line.count("{") - line.count("}")
    return out


def strip_comment(line):
    """A `#` opens a comment at the line's start or after a blank; our strings hold none."""
    return re.sub(r"(^|\s)#.*$", "", line).rstrip()


def machine_files():
    return sorted(CONFIGS.glob("*.yaml")) + sorted((CONFIGS / "papers").glob("*.yaml")) + sorted((CONFIGS / "lathes").glob("*.yaml"))


def settings(machine, axis):
    out = dict(CLASSES[machine.kind])
    for source in (MACHINES.get(machine.stem, {}), MACHINES.get(machine.stem, {}).get(axis.name, {})):
        out.update({k: v for k, v in source.items() if not isinstance(v, dict)})
    return out


# --- shapes --------------------------------------------------------------------------------


class Noise:
    """random() is the one generator whose sequence Python guarantees."""

    def __init__(self, key):
        self.rng = random.Random(key)

    def uniform(self, lo, hi):
        return lo + (hi - lo) * self.rng.random()

    def sign(self):
        return 1.0 if self.rng.random() < 0.5 else -1.0

    def normal(self, sigma):
        radius = math.sqrt(-2.0 * math.log(1.0 - self.rng.random()))
        value = radius * math.cos(2.0 * math.pi * self.rng.random())
        return sigma * max(-2.2, min(2.2, value))


def targets(axis, step, noise):
    """(i-1) p + r after ISO 230-2, ends at the limits."""
    span = axis.hi - axis.lo
    count = max(5, round(span / step))
    pitch = span / count
    inner = [axis.lo + i * pitch + noise.uniform(-0.18, 0.18) * pitch for i in range(1, count)]
    return [axis.lo] + [round(q, 1) for q in inner] + [axis.hi]


def grid(axis):
    return [axis.lo + (axis.hi - axis.lo) * (i + 0.5) / GRID for i in range(GRID)]


def basis(axis, straight=False, harmonic=False):
    middle, half = 0.5 * (axis.lo + axis.hi), 0.5 * (axis.hi - axis.lo)
    out = [lambda q: 1.0]
    if straight:
        out.append(lambda q: (q - middle) / half)
    if harmonic:
        out += [lambda q: math.cos(math.radians(q)), lambda q: math.sin(math.radians(q))]
    return out


def solve(matrix, right):
    """Gauss elimination of a small system."""
    n = len(right)
    rows = [list(r) + [v] for r, v in zip(matrix, right)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for k in range(n):
            if k != i:
                factor = rows[k][i] / rows[i][i]
                rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i])]
    return [rows[i][n] / rows[i][i] for i in range(n)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def fit(functions, points, values):
    """Least squares over few functions, by normal equations."""
    sampled = [[f(q) for q in points] for f in functions]
    return solve([[dot(a, b) for b in sampled] for a in sampled], [dot(a, values) for a in sampled])


def interpolate(points, values, at):
    out, i = [], 0
    for q in at:
        while i + 2 < len(points) and points[i + 1] < q:
            i += 1
        share = (q - points[i]) / (points[i + 1] - points[i])
        out.append(values[i] + share * (values[i + 1] - values[i]))
    return out


def moments(axis, points, column, functions):
    """Products with the functions: the mean of a sum over the table's rows and an integral over the curve."""
    fine = grid(axis)
    rows = points[:-1] if axis.continuous else points
    between = interpolate(points, column, fine)
    return [0.5 * dot([f(q) for q in rows], column) / len(rows) + 0.5 * dot([f(q) for q in fine], between) / GRID
            for f in functions]


def redundant(axis, points, values, functions):
    """Weights of the functions in a curve. Readers fit them to rows or to the curve: half way between the two."""
    shapes = [[f(q) for q in points] for f in functions]
    matrix = [moments(axis, points, shape, functions) for shape in shapes]
    return solve([list(column) for column in zip(*matrix)], moments(axis, points, values, functions))


def detrended(axis, points, values, functions):
    parts = redundant(axis, points, values, functions)
    return [v - sum(c * f(q) for c, f in zip(parts, functions)) for q, v in zip(points, values)]


def unit_shape(axis, shape, functions):
    """The shape without the functions, peak 1, as a function of the position."""
    fine = grid(axis)
    values = [shape(q) for q in fine]
    parts = fit(functions, fine, values)

    def rest(q):
        return shape(q) - sum(c * f(q) for c, f in zip(parts, functions))

    peak = max(abs(rest(q)) for q in fine[:: GRID // 200]) or 1.0
    return lambda q: rest(q) / peak


def guide_shape(axis, noise):
    """Angle of a carriage along its guide: long waves, a joint or bolt somewhere. Returns it and its integral."""
    span = axis.hi - axis.lo
    waves = []
    for k in range(1, max(2, min(7, int(2.0 * span / 240.0))) + 1):
        waves.append((math.pi * k / span, noise.uniform(0.5, 1.0) / k ** 1.6, noise.uniform(0.0, 2.0 * math.pi)))
    centre, width = axis.lo + noise.uniform(0.25, 0.75) * span, max(60.0, 0.12 * span)
    height = noise.sign() * noise.uniform(0.2, 0.5)

    def angle(q):
        wave = sum(a * math.sin(w * (q - axis.lo) + p) for w, a, p in waves)
        return wave + height * math.exp(-0.5 * ((q - centre) / width) ** 2)

    def integral(q):
        wave = sum(-a / w * math.cos(w * (q - axis.lo) + p) for w, a, p in waves)
        return wave + height * width * math.sqrt(0.5 * math.pi) * math.erf((q - centre) / (width * math.sqrt(2.0)))

    return angle, integral


def harmonic_shape(noise, first, last):
    terms = [(h, noise.uniform(0.5, 1.0) / h ** 1.6, noise.uniform(0.0, 2.0 * math.pi)) for h in range(first, last + 1)]
    return lambda q: sum(a * math.cos(h * math.radians(q) + p) for h, a, p in terms)


# --- curves --------------------------------------------------------------------------------


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(i):
    return [1.0 if k == i else 0.0 for k in range(3)]


def combine(shapes, weights):
    return lambda q: sum(w * s(q) for s, w in zip(shapes, weights) if w)


def linear_curves(axis, s, noise):
    """Three translations and three rotations as functions of the position, without reversal and noise."""
    metres = (axis.hi - axis.lo) / 1000.0
    straight_peak = s["straight"] * max(metres, 0.3) ** 0.8
    guides = [guide_shape(axis, noise) for _ in range(3)]
    angle = [combine([unit_shape(axis, g[0], basis(axis))], [s["angle"] * noise.uniform(0.6, 1.0)]) for g in guides]
    line = basis(axis, straight=True)
    bends = [unit_shape(axis, g[1], line) for g in guides]
    wave = unit_shape(axis, guide_shape(axis, noise)[0], line)
    slope = noise.sign() * s["pos"] * noise.uniform(0.5, 0.8) / 1000.0
    middle = 0.5 * (axis.lo + axis.hi)
    move = []
    for i in range(3):
        # A carriage that follows a bent guide turns with it: straightness is mostly the angle's integral.
        bend = [cross(unit(j), axis.direction)[i] for j in range(3)]
        own = unit_shape(axis, guide_shape(axis, noise)[0], line)
        peak = straight_peak * noise.uniform(0.6, 1.0)
        screw = drive(axis, s["periodic"], s["period"], noise)
        if abs(axis.direction[i]) > 0.5:
            scale = lambda q: slope * (q - middle)
            move.append(combine([scale, wave, screw], [1.0, 0.4 * s["pos"] * max(metres, 0.25), 1.0]))
        else:
            shape = unit_shape(axis, combine(bends + [own], [0.65 * b for b in bend] + [0.35]), line)
            move.append(combine([shape, screw], [peak, 0.25]))
    return move + angle


def drive(axis, amplitude, period, noise):
    phase, second = noise.uniform(0.0, 2.0 * math.pi), noise.uniform(0.1, 0.3)
    return lambda q: amplitude * (math.sin(2.0 * math.pi * q / period + phase)
                                  + second * math.sin(4.0 * math.pi * q / period + 2.0 * phase))


def rotary_curves(axis, s, noise):
    oblique = max(abs(v) for v in axis.direction) < 0.999
    turning, mean = basis(axis, harmonic=True), basis(axis)
    # An oblique axis shares letters between radial and axial: keep its first harmonics out of all.
    along = turning if oblique else mean
    first = 2 if oblique else 1

    def pick(amplitude, functions, lowest):
        shape = unit_shape(axis, harmonic_shape(noise, lowest, 4), functions)
        return combine([shape], [amplitude * noise.uniform(0.7, 1.0)])

    radial = [pick(s["radial"], turning, 2) for _ in range(2)]
    axial = pick(s["axial"], along, first)
    tilt = [pick(s["tilt"], turning, 2) for _ in range(2)]
    own = pick(s["own"], along, first)
    worm = drive(axis, s["rot_periodic"], 360.0 / s["teeth"], noise)
    own_worm = combine([own, worm], [1.0, 1.0])
    a, b = perpendicular(axis.direction)
    out = []
    for i in range(3):
        out.append(combine(radial + [axial], [a[i], b[i], axis.direction[i]]))
    for i in range(3):
        out.append(combine(tilt + [own_worm], [a[i], b[i], axis.direction[i]]))
    return out


def perpendicular(u):
    smallest = min(range(3), key=lambda i: abs(u[i]))
    e = unit(smallest)
    a = [e[i] - u[i] * u[smallest] for i in range(3)]
    length = math.sqrt(sum(v * v for v in a))
    a = [v / length for v in a]
    return a, cross(u, a)


def column_basis(axis, i):
    """What the location errors (and the set-up) say already, for column i of X Y Z A B C."""
    share = abs(axis.direction[i % 3])
    if not axis.rotary:
        return basis(axis, straight=i < 3 and share < 0.5)
    return basis(axis, harmonic=share < 0.999)


def direction_dependent(axis, i):
    return abs(axis.direction[i % 3]) > 0.5 and (i >= 3) == axis.rotary


def columns(machine, axis):
    """Positions, and (header, values) per column."""
    s = settings(machine, axis)
    noise = Noise(f"{machine.stem}/{axis.name}")
    points = targets(axis, s["rot_step"] if axis.rotary else s["step"], noise)
    curves = (rotary_curves if axis.rotary else linear_curves)(axis, s, noise)
    out = []
    for i, letter in enumerate("XYZABC"):
        sigma = (s["noise"] if i < 3 else s["rot_noise"] if axis.rotary else s["noise_angle"]) / 1.6
        reversal = (s["rot_reversal"] if axis.rotary else s["reversal"]) * axis.direction[i % 3]
        measure = "um" if i < 3 else "urad"
        raw = [curves[i](q) for q in points]
        name = f"E{letter}{axis.name}"
        if not direction_dependent(axis, i):
            runs = {name: [v + noise.normal(sigma) for v in raw]}
        else:
            # Lost motion: the slide stays behind, so forward falls short.
            gap = [reversal * (1.0 + 0.15 * math.sin(2.0 * math.pi * (q - axis.lo) / (axis.hi - axis.lo))) for q in points]
            runs = {name + "+": [v - 0.5 * g + noise.normal(sigma) for v, g in zip(raw, gap)],
                    name + "-": [v + 0.5 * g + noise.normal(sigma) for v, g in zip(raw, gap)]}
        for header, values in finished(axis, points, runs, column_basis(axis, i)).items():
            out.append((f"{header} [{measure}]", values))
    return points, out


def finished(axis, points, runs, functions):
    if axis.continuous:
        for values in runs.values():
            values[-1] = values[0]
    mean = [sum(v) / len(runs) for v in zip(*runs.values())]
    rest = detrended(axis, points, mean, functions)
    return {name: [v - m + r for v, m, r in zip(values, mean, rest)] for name, values in runs.items()}


def number(value):
    text = f"{value:.1f}"
    return "0.0" if text == "-0.0" else text


def table(machine, axis):
    points, cols = columns(machine, axis)
    unit = "deg" if axis.rotary else "mm"
    lines = [", ".join([f"{axis.name} [{unit}]"] + [header for header, _ in cols])]
    for row, q in enumerate(points):
        lines.append(", ".join([number(q)] + [number(values[row]) for _, values in cols]))
    return "\n".join(lines) + "\n"


def all_tables():
    """Path below errors/ and text of every table."""
    out = {}
    for path in machine_files():
        machine = Machine(path)
        if not machine.measured:
            continue
        if machine.kind not in CLASSES:
            raise SystemExit(f"{path.name}: provenance class {machine.kind!r} is not one of {', '.join(CLASSES)}")
        for axis in machine.axes:
            out[f"{machine.stem}/{axis.name.lower()}.csv"] = table(machine, axis)
    return out


# --- checks --------------------------------------------------------------------------------


def check_files(tables):
    problems = []
    for name, text in tables.items():
        path = HERE / name
        if not path.is_file():
            problems.append(f"errors/{name}: missing")
        elif path.read_bytes() != text.encode():
            problems.append(f"errors/{name}: differs from what generate.py writes")
    for path in HERE.glob("*/*.csv"):
        if path.relative_to(HERE).as_posix() not in tables:
            problems.append(f"errors/{path.relative_to(HERE).as_posix()}: belongs to no machine")
    return problems


def check_chain(machine):
    problems = []
    walk = machine.chain.split()
    if not walk or walk[0] != "w" or walk[-1] != "t" or walk.count("b") != 1:
        return [f"chain {machine.chain!r} is not w .. b .. t"]
    bed = walk.index("b")
    for i, name in enumerate(walk[1:-1], 1):
        if i != bed and not name.startswith("(") and name.endswith("'") != (i < bed):
            problems.append(f"{name} is on the wrong side of b")
    moving = [n.strip("'") for n in walk[1:-1] if n != "b" and not n.startswith("(")]
    if sorted(moving) != sorted(a.name for a in machine.axes):
        problems.append(f"chain moves {moving}, axes are {[a.name for a in machine.axes]}")
    bearers = moving + [n.strip("()") for n in walk if n.startswith("(")]
    for error in machine.errors:
        name = error[2:].removeprefix("0")
        if name not in bearers:
            problems.append(f"{error} belongs to no axis of the chain")
    return problems


def read_table(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    header = [h.strip() for h in lines[0].split(",")]
    return header, [[float(v) for v in line.split(",")] for line in lines[1:]]


def check_table(axis, path):
    header, rows = read_table(path)
    q = [row[0] for row in rows]
    problems = []
    wanted = [f"{axis.name} [{'deg' if axis.rotary else 'mm'}]"]
    for i, letter in enumerate("XYZABC"):
        name, unit = f"E{letter}{axis.name}", "um" if i < 3 else "urad"
        both = direction_dependent(axis, i)
        wanted += [f"{name}{sign} [{unit}]" for sign in (("+", "-") if both else ("",))]
    if header != wanted:
        problems.append(f"header {header}, wanted {wanted}")
    if any(len(row) != len(header) for row in rows) or len(rows) >= MAX_ROWS:
        problems.append("ragged or too long")
    if any(b <= a for a, b in zip(q, q[1:])):
        problems.append("positions do not increase")
    if q[0] > axis.lo or q[-1] < axis.hi:
        problems.append(f"covers {q[0]}..{q[-1]}, travel {axis.lo}..{axis.hi}")
    if axis.continuous and rows[0][1:] != rows[-1][1:]:
        problems.append("ends of a continuous axis differ")
    return problems + check_redundancy(axis, header, rows)


def check_redundancy(axis, header, rows):
    """Nothing is left in the curves that a location error says; rounding to 0.1 weighs more over a short travel."""
    q, problems = [row[0] for row in rows], []
    for i, letter in enumerate("XYZABC"):
        picked = [k for k, h in enumerate(header) if re.match(rf"E{letter}{axis.name}[+-]? ", h)]
        if not picked:
            continue
        mean = [sum(row[k] for k in picked) / len(picked) for row in rows]
        worst = max(abs(part) for part in redundant(axis, q, mean, column_basis(axis, i)))
        if worst > 0.2:
            problems.append(f"E{letter}{axis.name} repeats a location error by {worst:.2f}")
    return problems


def check_machine(path):
    machine = Machine(path)
    problems = check_chain(machine)
    if machine.measured:
        named = {(path.parent / m).resolve() for m in machine.measured}
        for file in sorted(named):
            if not file.is_file():
                problems.append(f"{file.name} is missing")
        for axis in machine.axes:
            file = HERE / machine.stem / f"{axis.name.lower()}.csv"
            if file not in named:
                problems.append(f"measured does not name {file.name} of axis {axis.name}")
            elif file.is_file():
                problems += [f"{file.name}: {p}" for p in check_table(axis, file)]
    return [f"{path.relative_to(CONFIGS).as_posix()}: {p}" for p in problems]


def check_variants():
    problems = []
    for path in sorted(CONFIGS.glob("**/*.yaml")):
        found = re.search(r"^extends:\s*(\S+)", path.read_text(encoding="utf-8"), re.M)
        if found and not (path.parent / found.group(1)).is_file():
            problems.append(f"{path.relative_to(CONFIGS).as_posix()}: extends {found.group(1)}, which is missing")
    return problems


def is_variant(path):
    return re.search(r"^extends:", path.read_text(encoding="utf-8"), re.M) is not None


def main(arguments):
    if arguments not in ([], ["--check"]):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    tables = all_tables()
    if arguments == []:
        for name, text in tables.items():
            path = HERE / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text.encode())
        print(f"{len(tables)} tables written")
        return 0
    machines = [p for p in machine_files() if not is_variant(p)]
    problems = check_files(tables) + check_variants()
    for path in machines:
        problems += check_machine(path)
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{len(machines)} machines, {len(tables)} tables, {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
