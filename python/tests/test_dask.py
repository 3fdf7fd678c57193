"""Work on Dask: the same bytes as in one process, for any number of workers and when one is killed in the middle."""

from __future__ import annotations

import builtins
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import dask
import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from conftest import CONFIGS, REPOSITORY
from distributed import Client, LocalCluster, as_completed

import abbe
import abbe.dask
from abbe.dask import Grid, Interval, Sample

TRUNNION = CONFIGS / "trunnion.yaml"
STUDY = REPOSITORY / "docs" / "examples" / "study.yaml"

pytestmark = pytest.mark.filterwarnings("ignore:.*:DeprecationWarning", "ignore:.*:ResourceWarning")


@pytest.fixture(scope="module", params=[1, 2, 7])
def client(request: Any) -> Iterator[Client]:
    """Workers in processes of their own."""
    settings: dict[str, Any] = {"processes": True, "threads_per_worker": 1, "dashboard_address": ":0"}
    with LocalCluster(n_workers=request.param, **settings) as cluster, Client(cluster) as found:
        yield found


def alone(lazy: Any) -> Any:
    """Computes in this process and thread."""
    with dask.config.set(scheduler="synchronous"):
        return lazy.compute()


def budgeted(machine: abbe.Machine) -> Mapping[str, float]:
    """Measures a variant by few draws."""
    found = machine.budget(samples=40, poses=10).to_dict()
    return {"p95_um": found["position_um"]["monte_carlo"]["p95"], "threads": abbe._calls.threads_of(None)}


def slow(machine: abbe.Machine) -> Mapping[str, float]:
    """The same, long enough to be killed."""
    time.sleep(0.1)
    return budgeted(machine)


def bounded() -> abbe.Machine:
    return abbe.loads(
        "abbe: 1\nmachine: G\nchain: w b X Y Z t\n"
        "axes: {X: {travel: [0, 300], origin: [0, 0, 0]}, Y: {travel: [0, 300], origin: [0, 0, 0]},"
        " Z: {travel: [0, 300], origin: [0, 0, 0]}}\n"
        "errors: {EC0Y: {tolerance: 9 urad}, EB0Z: {tolerance: 5 urad}, EAY: {tolerance: 8 urad}}\n"
    )


SPACE: dict[str, Any] = {
    "errors.EC0Y.tolerance": Interval(1, 30, "urad"),
    "axes.X.travel": [[0, 200], [0, 300], [0, 400]],
}


def table_bytes(table: pyarrow.Table) -> bytes:
    sink = pyarrow.BufferOutputStream()
    with pyarrow.ipc.new_stream(sink, table.schema) as writer:
        writer.write_table(table.combine_chunks())
    return bytes(sink.getvalue())


def test_designs_hang_on_their_index_alone() -> None:
    sample = Sample(SPACE, size=50, seed=3)
    assert list(sample) == [sample[index] for index in range(50)] == sample[0:50]
    assert list(Sample(SPACE, size=7, seed=3)) == sample[:7]
    assert sample[0] != Sample(SPACE, size=50, seed=4)[0]
    values = np.array([design["errors.EC0Y.tolerance"] for design in Sample(SPACE, size=4000, seed=1)])
    # The mean of a uniform variable has the standard error 29 / sqrt(12 * 4000).
    assert abs(values.mean() - 15.5) < 4 * 29 / np.sqrt(12 * 4000)
    assert values.min() >= 1 and values.max() <= 30
    picked = [design["axes.X.travel"][1] for design in Sample(SPACE, size=3000, seed=1)]
    assert all(abs(picked.count(end) - 1000) < 120 for end in (200, 300, 400))
    grid = Grid(SPACE, steps=3)
    assert [design["errors.EC0Y.tolerance"] for design in grid] == [1] * 3 + [15.5] * 3 + [30] * 3
    assert grid[-1] == {"errors.EC0Y.tolerance": 30, "axes.X.travel": [0, 400]}
    with pytest.raises(IndexError):
        grid[9]


def test_a_study_is_that_of_one_process(client: Client) -> None:
    table = abbe.dask.evaluate(bounded(), Sample(SPACE, size=60, seed=2), budgeted, ["p95_um", "threads"], batch=4)
    found = table.compute()
    assert table_bytes(found) == table_bytes(alone(table))
    assert found["index"].to_pylist() == list(range(60))
    assert set(found["threads"].to_pylist()) == {1.0}
    row = found.to_pylist()[17]
    changes = {
        "errors.EC0Y.tolerance": f"{row['errors.EC0Y.tolerance']!r} urad",
        "axes.X.travel": eval(row["axes.X.travel"]),
    }
    assert row["p95_um"] == budgeted(bounded().with_(changes))["p95_um"]


def test_refused_designs_are_rows() -> None:
    designs = [{"errors.EC0Y.tolerance": "3 urad"}, {"errors.EC0Y.tolerance": "3 kg"}]
    rows = alone(abbe.dask.evaluate(bounded(), designs, budgeted, ["p95_um"])).to_pylist()
    assert rows[0]["p95_um"] > 0 and rows[0]["refused"] is None
    assert rows[1]["p95_um"] is None and rows[1]["refused"].startswith("E0")
    with pytest.raises(LookupError, match=r"`measure` returns .*p95_um.* and no p95"):
        alone(abbe.dask.evaluate(bounded(), designs, budgeted, ["p95"]))


def test_maps(client: Client, tmp_path: Path) -> None:
    machine = abbe.load(TRUNNION)
    axes: dict[str, Any] = {"X": np.linspace(0, 500, 11), "A": [-30.0, 0.0, 10.0], "C": np.linspace(0, 350, 17)}
    grid = abbe.dask.deviations(machine, axes, nodes=40)
    assert list(grid.axes) == ["C", "A", "X"] and grid.position.shape == (17, 3, 11, 3)
    position, rotation = dask.compute(grid.position, grid.rotation)
    nodes = np.meshgrid(*grid.axes.values(), indexing="ij")
    expected = machine.deviations({name: of.ravel() for name, of in zip(grid.axes, nodes, strict=True)})
    assert position.tobytes() == np.ascontiguousarray(expected.position).tobytes()
    assert rotation.tobytes() == np.ascontiguousarray(expected.rotation).tobytes()
    paths = grid.to_parquet(tmp_path / "map")
    assert len(paths) == 17 and {path.name for path in paths} == {path.name for path in (tmp_path / "map").iterdir()}
    alone_paths = abbe.dask.deviations(machine, axes, nodes=40).to_parquet(tmp_path / "alone", scheduler="synchronous")
    assert [path.read_bytes() for path in paths] == [path.read_bytes() for path in alone_paths]
    with pytest.raises(FileExistsError):
        grid.to_parquet(tmp_path / "map")


def test_a_map_of_the_volume_has_the_rows_of_the_program(tmp_path: Path) -> None:
    machine = abbe.load(CONFIGS / "vmc-cframe-754.yaml")
    expected = machine.map(rows=True).to_arrow()
    found = alone(abbe.dask.deviations(machine, nodes=100).table)
    assert found.schema.names == expected.schema.names
    for name in expected.schema.names:
        assert found[name].to_numpy().tobytes() == expected[name].to_numpy().tobytes(), name


def test_blocks_are_pieces_of_the_list_of_nodes() -> None:
    machine = abbe.load(TRUNNION)
    for nodes in (1, 7, 33, 34, 200, 10_000):
        axes: dict[str, Any] = {"X": np.linspace(0, 500, 11), "A": [-30.0, 0.0, 10.0], "C": np.linspace(0, 350, 17)}
        table = abbe.dask.deviations(machine, axes, nodes=nodes).table
        found = alone(table)
        assert found.num_rows == 17 * 3 * 11
        order = np.lexsort([found["X [mm]"], found["A [deg]"], found["C [deg]"]])
        assert (order == np.arange(found.num_rows)).all(), nodes
        assert max(alone(part).num_rows for part in table.parts) <= nodes


def test_options_of_maps_are_refused_at_once() -> None:
    machine = abbe.load(TRUNNION)
    with pytest.raises(abbe.DiagnosticError):
        abbe.dask.deviations(machine, order="seventh")
    with pytest.raises(ValueError, match="W"):
        abbe.dask.deviations(machine, {"W": [0.0]})


def test_budget(client: Client) -> None:
    options: dict[str, Any] = {"samples": 330, "poses": 30, "class_": "production", "seed": 5}
    machine = abbe.load(STUDY)
    expected = machine.budget(**options).to_dict()
    for shards in (1, 3, 20):
        assert abbe.dask.budget(machine, shards=shards, **options).compute().to_dict() == expected


def test_enumerate(client: Client) -> None:
    options: dict[str, Any] = {"samples": 20, "poses": 20, "class_": "production", "first": 2}
    machine = abbe.load(CONFIGS / "hmc-4ax.yaml")
    expected = machine.enumerate(**options).to_dict()
    assert len(expected["rounds"]["done"]) > 1
    for shards in (1, 4):
        assert abbe.dask.enumerate(machine, shards=shards, **options).compute().to_dict() == expected


def measured(tmp_path: Path) -> tuple[abbe.Machine, dict[str, Any]]:
    known = abbe.load(CONFIGS / "vmc-cframe-754.yaml")
    where = np.random.default_rng(1).uniform([0, 0, -500], [700, 500, 0], (50, 3))
    columns: dict[str, Any] = {f"{name} [mm]": where[:, k] for k, name in enumerate(["X", "Y", "Z"])}
    read = known.deviations({name: where[:, k] for k, name in enumerate(["X", "Y", "Z"])}).position
    columns |= {f"d{letter} [um]": read[:, k] * 1e3 for k, letter in enumerate("xyz")}
    return known.with_({f"errors.{name}": None for name in ("EC0Y", "EB0Z", "EA0Z")}), columns


def test_calibrations(client: Client, tmp_path: Path) -> None:
    blank, columns = measured(tmp_path)
    fit = ["EC0Y", "EB0Z", "EA0Z"]
    noise = {f"d{letter} [um]": 2.0 for letter in "xyz"}
    table = abbe.dask.identify_noise(blank, columns, noise, draws=12, batch=5, fit=fit)
    found = table.compute()
    assert table_bytes(found) == table_bytes(alone(table)) and found.num_rows == 36
    values = {row["parameter"]: row for row in found.to_pylist() if row["draw"] == 4}
    exact = {one["name"]: one for one in blank.identify(columns, fit=fit).to_dict()["parameters"]}
    for name, row in values.items():
        # 2 um of noise at 50 poses leaves these a few urad, and no draw hits the value exactly.
        assert 0 < abs(row["value"] - exact[name]["value"]) < 5 * row["sigma"], name
    good, bad = tmp_path / "good.csv", tmp_path / "bad.csv"
    from abbe._readings import csv_of

    good.write_text(csv_of(columns))
    bad.write_text("X [mm],nonsense\n1,2\n")
    rows = abbe.dask.identify_files(blank, [good, bad, [good]], fit=fit).compute().to_pylist()
    assert [row["file"] for row in rows] == [str(good)] * 3 + [str(bad)] + [str(good)] * 3
    assert [row["value"] for row in rows[:3]] == [exact[name]["value"] for name in exact]
    assert rows[3]["refused"] and rows[3]["value"] is None


def kill_one(client: Client) -> int:
    """Kills a worker that works, as a computer dies."""
    busy = [worker for worker, tasks in client.processing().items() if tasks]
    pids = client.run(os.getpid)
    os.kill(pids[busy[0]], signal.SIGKILL)
    return int(pids[busy[0]])


@pytest.fixture
def mortal() -> Iterator[Client]:
    settings: dict[str, Any] = {"processes": True, "threads_per_worker": 1, "dashboard_address": ":0"}
    with LocalCluster(n_workers=2, silence_logs=50, **settings) as cluster, Client(cluster) as found:
        yield found


def test_a_worker_is_killed_in_a_study(mortal: Client) -> None:
    table = abbe.dask.evaluate(bounded(), Sample(SPACE, size=60, seed=2), slow, ["p95_um"], batch=2)
    futures = mortal.compute(list(table.parts))
    for count, _ in enumerate(as_completed(futures), 1):
        if count == 8:
            break
    killed = kill_one(mortal)
    assert sum(future.status == "finished" for future in futures) < len(futures) // 2
    found = pyarrow.concat_tables(mortal.gather(futures))
    assert killed not in mortal.run(os.getpid).values()
    fast = abbe.dask.evaluate(bounded(), Sample(SPACE, size=60, seed=2), budgeted, ["p95_um"], batch=7)
    assert table_bytes(found) == table_bytes(alone(fast))


def test_a_worker_is_killed_while_it_writes(mortal: Client, tmp_path: Path) -> None:
    machine = abbe.load(TRUNNION)
    axes: dict[str, Any] = {"X": np.linspace(0, 500, 60), "A": np.linspace(-90, 20, 50), "C": np.linspace(0, 350, 200)}
    grid = abbe.dask.deviations(machine, axes, nodes=3000)
    killed: list[int] = []

    def kill() -> None:
        while len(list((tmp_path / "map").glob("part-*.parquet"))) < 20:
            time.sleep(0.01)
        killed.append(kill_one(mortal))

    thread = threading.Thread(target=kill)
    thread.start()
    paths = grid.to_parquet(tmp_path / "map")
    thread.join()
    assert killed and killed[0] not in mortal.run(os.getpid).values()
    assert sorted((tmp_path / "map").iterdir()) == paths
    expected = grid.to_parquet(tmp_path / "alone", scheduler="threads", num_workers=2)
    assert [path.read_bytes() for path in paths] == [path.read_bytes() for path in expected]


def test_a_worker_is_killed_in_a_budget(mortal: Client) -> None:
    machine = abbe.load(STUDY)
    options: dict[str, Any] = {"samples": 4000, "poses": 100, "class_": "production"}
    future = mortal.compute(abbe.dask.budget(machine, shards=40, **options))
    while not any(mortal.has_what().values()) or not any(mortal.processing().values()):
        time.sleep(0.01)
    killed = kill_one(mortal)
    assert not future.done()
    assert future.result().to_dict() == machine.budget(**options).to_dict()
    assert killed not in mortal.run(os.getpid).values()


@pytest.mark.parametrize("workers", [1, 2, pytest.param(7, marks=pytest.mark.slow)])
def test_a_worker_is_killed_in_a_ranking(workers: int) -> None:
    machine = abbe.load(CONFIGS / "hmc-4ax.yaml")
    options: dict[str, Any] = {"samples": 100, "poses": 80, "class_": "production", "first": 2}
    expected = json.dumps(machine.enumerate(**options).to_dict())
    settings: dict[str, Any] = {"processes": True, "threads_per_worker": 1, "dashboard_address": ":0"}
    with LocalCluster(n_workers=workers, silence_logs=50, **settings) as cluster, Client(cluster) as client:
        future = client.compute(abbe.dask.enumerate(machine, shards=24, **options))
        while not any(client.has_what().values()) or not any(client.processing().values()):
            time.sleep(0.01)
        killed = kill_one(client)
        assert not future.done()
        assert json.dumps(future.result().to_dict()) == expected
        assert killed not in client.run(os.getpid).values()


def test_scheduler_and_workers_started_by_hand(tmp_path: Path) -> None:
    # As on office computers: only what travels with the tasks is there, neither a file of the machine nor its folder.
    home, away = tmp_path / "home", tmp_path / "away"
    away.mkdir()
    shutil.copytree(CONFIGS, home)
    machine = abbe.load(home / "trunnion.yaml")
    shutil.rmtree(home)
    mapped: Any = lambda of: of.map(poses={"random": 500}).to_dict()  # noqa: E731, travels by value
    expected = mapped(machine)
    at, one = ["--scheduler-file", str(tmp_path / "at.json")], ["--nthreads", "1", "--no-dashboard"]
    settings: dict[str, Any] = {"cwd": away, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    started = [
        subprocess.Popen([sys.executable, "-m", "dask", *command, *at], **settings)
        for command in (["scheduler", "--port", "0", "--no-dashboard"], ["worker", *one], ["worker", *one])
    ]
    try:
        with Client(scheduler_file=at[1], timeout=60) as client:
            client.wait_for_workers(2, timeout=60)
            each = client.scheduler_info()["workers"]
            found = client.gather([client.submit(mapped, machine, workers=[worker]) for worker in each])
            axes = {"X": np.linspace(0, 500, 50), "C": np.linspace(0, 350, 40)}
            grid = abbe.dask.deviations(machine, axes, nodes=300)
            assert grid.position.compute().tobytes() == alone(grid.position).tobytes()
        assert found == [expected] * 2
    finally:
        for process in started:
            process.terminate()
        for process in started:
            process.wait(30)


def test_a_star_import_hides_nothing() -> None:
    assert not set(dir(builtins)) & set(abbe.dask.__all__)


def test_the_package_does_not_import_dask() -> None:
    script = (
        "import abbe, abbe.study, sys; print([m for m in ('dask', 'pyarrow', 'scipy', 'pymoo') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
