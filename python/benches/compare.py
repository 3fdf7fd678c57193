"""Nanoseconds per pose from Python, beside the native benchmark and NumPy, in turn and on one core.

    python python/benches/compare.py NATIVE FOLDER [ROUNDS]

NATIVE is the benchmark `evaluate` of the root crate, built as `benches/run` builds it; the package is the release that
`python/wheel` makes. The machine, the poses and NumPy's peer are those of `benches`.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benches"))
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")

import compare  # type: ignore[import-not-found]
import machine  # type: ignore[import-not-found]
import numpy as np
import peers  # type: ignore[import-not-found]

import abbe

COUNT, NUMPY = 1 << 20, 1 << 16


def main() -> None:
    """Prints the smallest and the median of all samples, with ratios to the native ones."""
    native, folder, rounds = sys.argv[1], sys.argv[2], int((sys.argv[3:] or ["10"])[0])
    os.sched_setaffinity(0, {0})
    os.makedirs(folder, exist_ok=True)
    file = machine.write(folder)
    path, columns = machine.poses(folder, COUNT)
    of, peer, ours = abbe.load(file), peers.NumPy(columns), compare.Ours(native, file, path, 0)
    by_columns = np.fromfile(path).reshape(5, COUNT).T
    by_rows = np.ascontiguousarray(by_columns)
    one = by_rows[:1]
    takes: dict[str, Callable[[], float]] = {}
    for order in ("1", "exact"):
        out = of.deviations(by_columns, order=order, threads=1)
        forms = {"columns, given arrays": (by_columns, out), "columns": (by_columns, None), "rows": (by_rows, None)}
        takes[f"native, order {order}"] = lambda order=order: ours.sample(f"batch {order} widest 1")  # type: ignore[misc]
        for name, (poses, into) in forms.items():

            def run(poses=poses, into=into, order=order) -> float:  # type: ignore[no-untyped-def] # noqa: ANN001
                job = lambda: of.deviations(poses, order=order, threads=1, out=into)  # noqa: E731
                return float(compare.clocked(COUNT, job))

            takes[f"Python, order {order}, {name}"] = run
    takes["NumPy, 4x4, curves by interp"] = lambda: float(compare.clocked(NUMPY, lambda: peer.run(NUMPY)))
    takes["one pose, ns a call"] = lambda: float(compare.clocked(1, lambda: of.deviations(one, threads=1)))
    times = compare.interleaved(rounds, takes)
    print(f"{COUNT} poses, one core; ratio to the native time of the order")
    for name, (smallest, median) in times.items():
        base = times[f"native, order {'exact' if 'exact' in name else '1'}"][0]
        print(f"  {name:42} {smallest:9.2f} {median:9.2f} {smallest / base:8.2f}")


if __name__ == "__main__":
    main()
