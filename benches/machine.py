"""The machine of the benchmarks: the trunnion's geometry with 30 curves of 129 nodes, and random poses. Deterministic."""

import pathlib

import numpy as np

TRAVEL = {"X": (0.0, 500.0), "Y": (0.0, 450.0), "Z": (-400.0, 0.0), "A": (-120.0, 30.0), "C": (0.0, 360.0)}
WALK = ["C", "A", "Y", "X", "Z"]  # from the workpiece to the tool, as the program orders poses
ORIGIN = {"A": (250.0, 225.0, -350.0), "C": (250.0, 225.0, -380.0)}
WORKPIECE = (250.0, 225.0, -380.0)
TIP = (250.0, 225.0, -120.0)
LETTERS = "XYZABC"
LOCATION = {"EC0Y": 21, "EB0Z": -22, "EA0Z": 15, "EY0A": -8, "EZ0A": 7, "EB0A": 24, "EC0A": -20,
            "EX0C": 6, "EY0C": -9, "EA0C": -22, "EB0C": 24}  # um or urad


def curve(axis, letter, nodes):
    """Smooth and rough, some um or urad; equal ends for the continuous axis."""
    low, high = TRAVEL[axis]
    x = np.linspace(low, high, nodes)
    t = (x - low) / (high - low)
    phase = 1.7 * WALK.index(axis) + 0.9 * LETTERS.index(letter)
    value = 4 * np.sin(2 * np.pi * t + phase) + 1.5 * np.sin(14 * np.pi * t - phase) + 0.3 * np.cos(46 * np.pi * t)
    value[-1] = value[0] if axis == "C" else value[-1]
    return x, np.round(value, 4)


def axis_line(axis):
    low, high = TRAVEL[axis]
    unit = "mm" if axis in "XYZ" else "deg"
    travel = "continuous" if axis == "C" else f"[{low} {unit}, {high} {unit}]"
    origin = f", origin: [{', '.join(map(str, ORIGIN[axis]))}]" if axis in ORIGIN else ""
    return f"  {axis}: {{ travel: {travel}{origin} }}\n"


def write(folder, nodes=129, joints="orthogonal", steps=None, axes=5):
    """machine.yaml and its tables; `steps` is the grid of the volume. Fewer axes leave curves and joints out from the workpiece on."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    walk = WALK[5 - axes:]
    workpiece = [a for a in walk if a in "CAY"]
    chain = "w " + "".join(f"{a}' " for a in workpiece) + "b " + "".join(f"{a} " for a in walk if a in "XZ") + "t"
    text = f"abbe: 1\nmachine: Benchmark\nchain: \"{chain}\"\naxes:\n" + "".join(axis_line(a) for a in walk)
    text += "tool: { gauge: [250, 225, 0], length: 120 mm }\nworkpiece: { origin: [250, 225, -380] }\n"
    text += f"conventions: {{ joints: {joints} }}\nerrors:\n"
    for name, value in LOCATION.items():
        if name[3] in walk:
            text += f"  {name}: {value} {'um' if name[1] in 'XYZ' else 'urad'}\n"
    text += "measured: [" + ", ".join(f"{a}.csv" for a in walk) + "]\n"
    if steps:
        text += "volume:\n" + "".join(
            f"  {a}: {{ step: {(TRAVEL[a][1] - TRAVEL[a][0]) / (steps - 1)!r} {'mm' if a in 'XYZ' else 'deg'} }}\n" for a in walk)
    (folder / "machine.yaml").write_text(text)
    for a in walk:
        columns = [curve(a, letter, nodes) for letter in LETTERS]
        head = f"{a} [{'mm' if a in 'XYZ' else 'deg'}]," + ",".join(
            f"E{letter}{a} [{'um' if letter in 'XYZ' else 'urad'}]" for letter in LETTERS)
        rows = zip(columns[0][0], *(values for _, values in columns))
        (folder / f"{a}.csv").write_text("\n".join([head] + [",".join(repr(float(v)) for v in row) for row in rows]) + "\n")
    return folder / "machine.yaml"


def poses(folder, count, axes=5):
    """Columns of doubles, axis after axis in the order of the walk."""
    random = np.random.Generator(np.random.PCG64(7))
    columns = np.array([random.uniform(*TRAVEL[a], count) for a in WALK[5 - axes:]])
    path = pathlib.Path(folder) / "poses.f64"
    columns.astype("<f8").tofile(path)
    return path, columns
