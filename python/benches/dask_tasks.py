"""Cost of Dask beside the work: overhead per task, efficiency on two workers, memory of a worker of a large map.

    python python/benches/dask_tasks.py FOLDER [NODES]

FOLDER takes the Parquet files of the map (about 30 bytes a node) and must be empty. Tasks of 0.2 s sleep, so that other
load on the machine disturbs little.
"""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path

import numpy as np
from dask import delayed
from distributed import Client, LocalCluster

import abbe
import abbe.dask

CONFIG = Path(__file__).resolve().parents[2] / "configs" / "trunnion.yaml"
WORKERS, SECONDS = 2, 0.2


def rest(index: int) -> int:
    """Takes the time of a usual task."""
    time.sleep(SECONDS)
    return index


def nothing(index: int) -> int:
    """Takes no time."""
    return index


def peak_mb() -> float:
    """Returns the largest resident set of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def timed(client: Client, function: object, count: int) -> float:
    """Returns the seconds that so many tasks take."""
    begin = time.perf_counter()
    client.gather(client.compute([delayed(function, pure=False)(index) for index in range(count)]))
    return time.perf_counter() - begin


def main() -> None:
    """Prints the figures."""
    folder, nodes = Path(sys.argv[1]), int(float((sys.argv[2:] or ["1e7"])[0]))
    machine = abbe.load(CONFIG)
    count = round(nodes ** (1 / 3))
    axes = {"X": np.linspace(0, 500, count), "A": np.linspace(-90, 20, count), "C": np.linspace(0, 359, count)}
    settings = {"processes": True, "threads_per_worker": 1, "dashboard_address": ":0"}
    with LocalCluster(n_workers=WORKERS, **settings) as cluster, Client(cluster) as client:
        timed(client, nothing, 100)
        print(f"overhead per task: {timed(client, nothing, 2000) / 2000 * 1e3:.2f} ms")
        for tasks in (40, 200):
            efficiency = tasks * SECONDS / WORKERS / timed(client, rest, tasks)
            print(f"{tasks} tasks of {SECONDS} s on {WORKERS} workers: efficiency {efficiency:.3f}")
        print("a worker at rest, MB:", [round(peak) for peak in client.run(peak_mb).values()])
        begin = time.perf_counter()
        abbe.dask.deviations(machine, axes).to_parquet(folder)
        seconds, size = time.perf_counter() - begin, sum(file.stat().st_size for file in folder.iterdir())
        print(f"{count**3:.3g} nodes, exact, to Parquet: {seconds:.1f} s, {size / 1e6:.0f} MB")
        print("a worker at its largest, MB:", [round(peak) for peak in client.run(peak_mb).values()])


if __name__ == "__main__":
    main()
