"""Cost of Dask beside the work: overhead per task, efficiency on two workers, evaluations, memory of a worker.

    python python/benches/dask_tasks.py FOLDER [NODES]

FOLDER takes the Parquet files of the map (about 30 bytes a node) and must be empty. Tasks of 0.2 s sleep, and their own
clock tells for how long, so that other load on the machine disturbs little. Figures are medians of repetitions in turn.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from dask import delayed
from distributed import Client, LocalCluster

import abbe
import abbe.dask

CONFIG = Path(__file__).resolve().parents[2] / "configs" / "trunnion.yaml"
WORKERS, SECONDS, REPETITIONS = 2, 0.2, 5


def rest(index: int) -> float:
    """Takes the time of a usual task, and returns it."""
    begin = time.perf_counter()
    time.sleep(SECONDS)
    return time.perf_counter() - begin


def nothing(index: int) -> float:
    """Takes no time."""
    return 0.0


def peak_mb() -> float:
    """Returns the largest resident set of this process so far; that of getrusage(2) starts with its parent's."""
    (line,) = (line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024


def timed(client: Client, function: object, count: int) -> tuple[float, float]:
    """Returns the seconds that so many tasks take, and the sum of those that they return."""
    begin = time.perf_counter()
    found = client.gather(client.compute([delayed(function, pure=False)(index) for index in range(count)]))
    return time.perf_counter() - begin, sum(found)


def overhead_ms(client: Client, count: int = 2000) -> float:
    """Returns the time of an empty task."""
    return timed(client, nothing, count)[0] / count * 1e3


def efficiency(client: Client, count: int) -> float:
    """Returns the part of the workers' time in which they work."""
    whole, worked = timed(client, rest, count)
    return worked / WORKERS / whole


def grid(count: int) -> dict[str, np.ndarray[Any, Any]]:
    """Returns the axes of a grid of `count`^3 nodes."""
    return {"X": np.linspace(0, 500, count), "A": np.linspace(-90, 20, count), "C": np.linspace(0, 359, count)}


def ns_per_node(client: Client, machine: abbe.Machine, nodes: int, *, alone: bool) -> float:
    """Returns the time of a node of a map, of which the largest component is kept: all workers, or one call."""
    axes = grid(160)
    begin = time.perf_counter()
    if alone:
        columns = [of.reshape(-1) for of in np.meshgrid(*axes.values(), indexing="ij")]
        for first in range(0, 160**3, nodes):
            block = {name: of[first : first + nodes] for name, of in zip(axes, columns, strict=True)}
            np.abs(machine.deviations(block, order=1, threads=1).position).max()
    else:
        abs(abbe.dask.deviations(machine, axes, order=1, nodes=nodes).position).max().compute()
    return (time.perf_counter() - begin) / 160**3 * 1e9


def main() -> None:
    """Prints the figures."""
    folder, nodes = Path(sys.argv[1]), int(float((sys.argv[2:] or ["1e7"])[0]))
    machine = abbe.load(CONFIG)
    settings = {"processes": True, "threads_per_worker": 1, "dashboard_address": ":0"}
    with LocalCluster(n_workers=WORKERS, **settings) as cluster, Client(cluster) as client:
        takes: dict[str, Callable[[], float]] = {
            "overhead per task, ms": lambda: overhead_ms(client),
            "efficiency, 40 tasks of 0.2 s": lambda: efficiency(client, 40),
            "efficiency, 200 tasks of 0.2 s": lambda: efficiency(client, 200),
            "order 1, ns a node, one call after the other": lambda: ns_per_node(client, machine, 1 << 17, alone=True),
            "order 1, ns a node, 2^17 a task": lambda: ns_per_node(client, machine, 1 << 17, alone=False),
            "order 1, ns a node, 2^19 a task": lambda: ns_per_node(client, machine, 1 << 19, alone=False),
        }
        timed(client, nothing, 100)
        found: dict[str, list[float]] = {name: [] for name in takes}
        for _ in range(REPETITIONS):
            for name, take in takes.items():
                found[name].append(take())
        print(f"{WORKERS} workers of one thread, load {os.getloadavg()[0]:.1f}: median, all")
        for name, values in found.items():
            print(f"  {name:46} {statistics.median(values):8.3f}  {[round(value, 3) for value in values]}")
    # Workers of their own, so that nothing before counts.
    with LocalCluster(n_workers=WORKERS, **settings) as cluster, Client(cluster) as client:
        timed(client, nothing, 100)
        print("a worker at rest, MB:", [round(peak) for peak in client.run(peak_mb).values()])
        count = round(nodes ** (1 / 3))
        begin = time.perf_counter()
        abbe.dask.deviations(machine, grid(count)).to_parquet(folder)
        seconds, size = time.perf_counter() - begin, sum(file.stat().st_size for file in folder.iterdir())
        print(f"{count**3:.3g} nodes, exact, to Parquet: {seconds:.1f} s, {size / 1e6:.0f} MB")
        print("a worker at its largest, MB:", [round(peak) for peak in client.run(peak_mb).values()])


if __name__ == "__main__":
    main()
