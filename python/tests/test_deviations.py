"""Deviations from arrays against a rigid-body model in NumPy, and in every form in which poses are given."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from conftest import CONFIGS
from numpy.typing import NDArray
from rigid_body import RigidBody

import abbe

# Location errors of the robot: the file has none.
ROBOT = {
    f"E{letter}0J{k}": f"{30 + 7 * k} {unit}" for k in range(2, 7) for letter, unit in (("X", "um"), ("A", "urad"))
}


def poses_of(machine: abbe.Machine, count: int, seed: int) -> NDArray[np.float64]:
    """Returns random poses within the travel."""
    travel = np.array([axis["travel"] for axis in machine.axes.values()])
    return np.random.default_rng(seed).uniform(travel[:, 0], travel[:, 1], (count, len(travel)))


@pytest.mark.parametrize("approach", ["mean", "forward", "reverse"])
@pytest.mark.parametrize("name", ["trunnion", "ur5"])
def test_rigid_body(name: str, approach: Any) -> None:
    path = CONFIGS / ("trunnion.yaml" if name == "trunnion" else "robots/ur5.yaml")
    extra = {} if name == "trunnion" else ROBOT
    machine = abbe.load(path)
    if extra:
        machine = machine.with_({f"errors.{error}": value for error, value in extra.items()})
    poses, oracle = poses_of(machine, 200, 7), RigidBody(path, extra)
    found = machine.deviations(poses, approach=approach)
    assert np.abs(found.position).max() > 1e-2
    for i, pose in enumerate(poses):
        position, rotation = oracle.deviation(pose, approach)
        # The oracle subtracts positions of up to 2000 mm: rounding of 2000 * 2^-52 in each of some ten products.
        np.testing.assert_allclose(found.position[i], position, rtol=0, atol=1e-11)
        np.testing.assert_allclose(found.rotation[i], rotation, rtol=0, atol=1e-14)


def test_order_1_is_the_limit_of_small_errors() -> None:
    path = CONFIGS / "robots" / "ur5.yaml"
    machine = abbe.load(path)
    poses = poses_of(machine, 50, 3)
    small = machine.with_(
        {f"errors.{error}": f"{value.split()[0]} n{value.split()[1][1:]}" for error, value in ROBOT.items()}
    )
    first, exact = (small.deviations(poses, order=order) for order in (1, "exact"))
    # A thousand times smaller errors leave a millionth of the terms of second order: below 1e-9 mm over 1 m.
    np.testing.assert_allclose(first.position, exact.position, rtol=0, atol=1e-9)
    assert np.abs(exact.position).max() > 1e-5


def test_forms_of_poses() -> None:
    machine = abbe.load(CONFIGS / "trunnion.yaml")
    rows = poses_of(machine, 9001, 1)
    expected = machine.deviations(rows)
    columns = {name: rows[:, k] for k, name in enumerate(machine.axis_names)}
    padded = np.asfortranarray(np.zeros((9100, 5)))
    padded[:9001] = rows
    structured = np.empty(9001, [(name, "<f8") for name in columns])
    for name, column in columns.items():
        structured[name] = column
    forms: list[Any] = [
        np.asfortranarray(rows),
        padded[:9001],
        np.repeat(rows, 2, axis=0)[::2],
        columns,
        {name: column.tolist() for name, column in columns.items()},
        dict(reversed(columns.items())),
        structured,
    ]
    for form in forms:
        for threads in (1, 2):
            found = machine.deviations(form, threads=threads)
            assert found.position.tobytes() == expected.position.tobytes()
            assert found.rotation.tobytes() == expected.rotation.tobytes()
    assert expected.position.flags.f_contiguous and expected.position.shape == (9001, 3)
    again = machine.deviations(rows, order=1)
    assert machine.deviations(rows, out=again).position is again.position
    assert again.position.tobytes() == expected.position.tobytes()
    with pytest.raises(ValueError, match="column order"):
        machine.deviations(rows[:7], out=again)
    one = machine.deviations(rows[4])
    assert (one.position == expected.position[4:5]).all()


def test_dataframe() -> None:
    pandas = pytest.importorskip("pandas")
    machine = abbe.load(CONFIGS / "trunnion.yaml")
    rows = poses_of(machine, 12, 2)
    frame = pandas.DataFrame(rows, columns=machine.axis_names)
    assert (machine.deviations(frame).position == machine.deviations(rows).position).all()
    assert next(iter(machine.deviations(frame).to_pandas())) == "dx [um]"


def test_axes_left_out_are_at_0() -> None:
    machine = abbe.load(CONFIGS / "trunnion.yaml")
    found = machine.deviations({"X": [100.0, 200.0], "C": 90})
    expected = machine.deviations([[90, 0, 0, 100, 0], [90, 0, 0, 200, 0]])
    assert (found.position == expected.position).all()


def test_frames(program: Any) -> None:
    path = CONFIGS / "trunnion.yaml"
    machine = abbe.load(path)
    for frame in ("workpiece", "machine", "tool"):
        pose = program("eval", path, "--at", "X=120,Y=80,Z=-40,A=-35,C=70", "--frame", frame)["poses"][0]
        found = machine.deviations({"X": 120, "Y": 80, "Z": -40, "A": -35, "C": 70}, frame=frame)
        # The program evaluates one pose by the general algebra.
        np.testing.assert_allclose(found.position[0], pose["deviation"], rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.rotation[0], pose["rotation"], rtol=0, atol=1e-15)


def test_no_poses() -> None:
    machine = abbe.load(CONFIGS / "trunnion.yaml")
    forms: list[Any] = [np.zeros((0, 5)), {"X": []}]
    for form in forms:
        assert machine.deviations(form).position.shape == (0, 3)


def test_what_does_not_fit_is_refused() -> None:
    machine = abbe.load(CONFIGS / "trunnion.yaml")
    with pytest.raises(ValueError, match="no axis 'B'; its axes are C, A, Y, X, Z"):
        machine.deviations({"B": [1.0]})
    with pytest.raises(ValueError, match="shape"):
        machine.deviations(np.zeros((1, 2, 5)))
    with pytest.raises(ValueError, match="not of one length: Y 3, X 2"):
        machine.deviations({"X": [1, 2], "Y": [1, 2, 3], "Z": [4], "A": 5})
    with pytest.raises(ValueError, match="positions of X are no numbers"):
        machine.deviations({"X": "far"})
    with pytest.raises(ValueError, match=r"positions of Y have the shape \(N,\), not \(2, 2\)"):
        machine.deviations({"Y": np.zeros((2, 2))})
    for poses, code in [
        (np.zeros((3, 4)), "E0818"),
        (np.full((3, 5), np.nan), "E0802"),
        (np.full((20_000, 5), 5000.0), "E0803"),
    ]:
        with pytest.raises(abbe.DiagnosticError) as refused:
            machine.deviations(poses)
        assert refused.value.code == code
    rows = poses_of(machine, 50, 3)
    rows[31, 1] = np.nan
    with pytest.raises(abbe.DiagnosticError, match="row 31 of the poses: A = nan"):
        machine.deviations(rows)
    rows[31, 1], rows[12, 3] = 0, 1e4
    for form in (rows, dict(zip(machine.axis_names, rows.T, strict=True))):
        with pytest.raises(abbe.DiagnosticError, match="row 12 of the poses: X = 10000"):
            machine.deviations(form)
    with pytest.raises(ValueError, match="masked"):
        machine.deviations(np.ma.masked_greater(rows, 100))
    with pytest.raises(ValueError, match="complex"):
        machine.deviations(rows * 1j)
    with pytest.raises(abbe.DiagnosticError, match="option `order`: `7`"):
        machine.deviations(np.zeros((1, 5)), order=7)


@pytest.mark.parametrize(
    ("low", "high", "count", "warned"),
    [(0, 6.28, 25, True), (-3.1, 3.1, 20, True), (0, 6.28, 19, False), (0, 360, 25, False), (0, 2.9, 25, False)],
)
def test_sweeps_that_look_like_radians_are_asked_about(low: float, high: float, count: int, warned: bool) -> None:
    machine = abbe.load(CONFIGS / "trunnion.yaml")
    turn = np.linspace(low, high, count)
    poses = np.zeros((count, len(machine.axis_names)), order="F")
    poses[:, machine.axis_names.index("C")] = turn
    both: list[Any] = [poses, {"C": turn, "X": 100}]
    for given in both:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            machine.deviations(given)
        assert sum("radians" in str(one.message) for one in caught) == (1 if warned else 0)
        assert all(one.filename == __file__ for one in caught if "radians" in str(one.message))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        machine.deviations({"X": np.linspace(0, 6, 25)})
