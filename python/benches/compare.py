"""Python beside the native benchmark, NumPy and the program, in turn and on one core.

    python python/benches/compare.py NATIVE PROGRAM FOLDER [ROUNDS]

NATIVE is the benchmark `evaluate` of the root crate, built as `benches/run` builds it; the package is the release that
`python/wheel` makes with PROGRAM. The machine, the poses and NumPy's peer are those of `benches`.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benches"))
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")

import compare  # type: ignore[import-not-found]
import machine  # type: ignore[import-not-found]
import numpy as np
import peers  # type: ignore[import-not-found]

import abbe

COUNT, NUMPY, MEASURED = 1 << 20, 1 << 16, 33_334
FIT = ["location", "EXX:poly3", "EYY:poly3", "EZZ:poly3"]


def main() -> None:
    """Prints the smallest and the median of all samples, with ratios to the native ones."""
    native, program, folder, rounds = sys.argv[1], sys.argv[2], sys.argv[3], int((sys.argv[4:] or ["10"])[0])
    os.sched_setaffinity(0, {0})
    os.environ["RAYON_NUM_THREADS"] = "1"
    os.makedirs(folder, exist_ok=True)
    evaluations(native, folder, rounds)
    identifications(program, folder, rounds)


def cpu_ns(pid: int) -> int:
    """Returns the processor time of a process: other load on the machine does not count."""
    # The clock of a process as clock_getcpuclockid(3) makes it on Linux.
    return time.clock_gettime_ns((~pid << 3) | 2)


def worked(pid: int, count: int, job: Callable[[], object]) -> float:
    """Returns the processor time of a process by pose."""
    begin = cpu_ns(pid)
    job()
    return (cpu_ns(pid) - begin) / count


def evaluations(native: str, folder: str, rounds: int) -> None:
    """A million poses."""
    file = machine.write(folder)
    path, columns = machine.poses(folder, COUNT)
    of, peer, ours = abbe.load(file), peers.NumPy(columns), compare.Ours(native, file, path, 0)
    by_columns = np.fromfile(path).reshape(5, COUNT).T
    by_rows = np.ascontiguousarray(by_columns)
    one = by_rows[:1]
    takes: dict[str, Callable[[], float]] = {}
    own, other = os.getpid(), ours.process.pid
    for order in ("1", "exact"):
        out = of.deviations(by_columns, order=order, threads=1)
        forms = {"columns, given arrays": (by_columns, out), "columns": (by_columns, None), "rows": (by_rows, None)}

        def sample(order: str = order) -> float:
            return worked(other, COUNT, lambda: ours.sample(f"batch {order} widest 1"))

        takes[f"native, order {order}"] = sample
        for name, (poses, into) in forms.items():

            def run(poses=poses, into=into, order=order) -> float:  # type: ignore[no-untyped-def] # noqa: ANN001
                job = lambda: of.deviations(poses, order=order, threads=1, out=into)  # noqa: E731
                return worked(own, COUNT, job)

            takes[f"Python, order {order}, {name}"] = run
    takes["NumPy, 4x4, curves by interp"] = lambda: worked(own, NUMPY, lambda: peer.run(NUMPY))
    takes["one pose, ns a call"] = lambda: worked(own, 1, lambda: of.deviations(one, threads=1))
    times = compare.interleaved(rounds, takes)
    print(f"{COUNT} poses, ns of processor time per pose, load {os.getloadavg()[0]:.1f}: smallest, median;")
    print("ratio of the medians to the native one of the order")
    for name, (smallest, median) in times.items():
        base = times[f"native, order {'exact' if 'exact' in name else '1'}"][1]
        print(f"  {name:42} {smallest:9.2f} {median:9.2f} {median / base:8.2f}")


def identifications(program: str, folder: str, rounds: int) -> None:
    """Readings of 33,334 vectors, from arrays and by the program from a file."""
    true = abbe.load(f"{folder}/machine.yaml")
    generator = np.random.default_rng(2)
    poses = {name: generator.uniform(*axis.travel, MEASURED) for name, axis in true.axes.items()}
    read = true.deviations(poses).position * 1e3 + generator.normal(0, 1, (MEASURED, 3))
    units = {name: axis.unit for name, axis in true.axes.items()}
    columns = {f"{name} [{units[name]}]": of for name, of in poses.items()}
    columns |= {f"d{letter} [um]": read[:, k] for k, letter in enumerate("xyz")}
    data = f"{folder}/readings.csv"
    heads = ",".join(columns)
    np.savetxt(data, np.column_stack(list(columns.values())), delimiter=",", header=heads, comments="", fmt="%.17g")
    asked = [program, "identify", f"{folder}/machine.yaml", "--data", data, "--fit", ",".join(FIT), "--format", "json"]
    takes: dict[str, Callable[[], float]] = {
        "program, from a file": lambda: seconds(lambda: subprocess.run(asked, check=True, stdout=subprocess.DEVNULL)),
        "Python, from arrays": lambda: seconds(lambda: true.identify(columns, fit=FIT, threads=1)),
        "Python, from the file": lambda: seconds(lambda: true.identify(data, fit=FIT, threads=1)),
    }
    times = compare.interleaved(rounds, takes)
    print(f"{3 * MEASURED} readings, s of processor time: smallest, median; ratio of the medians to the program's")
    for name, (smallest, median) in times.items():
        print(f"  {name:42} {smallest:9.3f} {median:9.3f} {median / times['program, from a file'][1]:8.2f}")


def seconds(job: Callable[[], object]) -> float:
    """Returns the processor time of a job, with that of programs that it runs."""
    begin = sum(os.times()[:4])
    job()
    return sum(os.times()[:4]) - begin


if __name__ == "__main__":
    main()
