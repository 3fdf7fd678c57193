"""Arrays beside deviations, against the rigid-body model in NumPy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from conftest import CONFIGS
from numpy.typing import NDArray
from rigid_body import RigidBody, homogeneous
from test_deviations import poses_of

import abbe

TRUNNION = CONFIGS / "trunnion.yaml"
LOCATION = ["EC0Y", "EA0C", "EX0C", "EB0A", "EA0Z"]


def nominal_tool(oracle: RigidBody, pose: NDArray[np.float64], up: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the functional point (mm, machine coordinates at the zero pose) and the direction of the tool."""
    matrix = np.eye(4)
    for axis, q in zip(oracle.axes, pose, strict=True):
        # What carries the workpiece moves it the other way.
        motion = axis.motion(q)
        there, back = homogeneous(axis.origin, np.zeros(3)), homogeneous(-axis.origin, np.zeros(3))
        matrix = matrix @ there @ motion @ back
    return np.concatenate([(matrix @ np.append(oracle.tip, 1.0))[:3], matrix[:3, :3] @ up])


def effects(extra: dict[str, float], pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the six deviations of the rigid body with these values (mm, rad) in place of those of the file."""
    words = {name: f"{value * 1e3} {'um' if name[1] in 'XYZ' else 'mrad'}" for name, value in extra.items()}
    return np.concatenate(RigidBody(TRUNNION, words).deviation(pose))


@pytest.mark.filterwarnings("ignore:W0851|W0608:abbe.DiagnosticWarning")
def test_nominal_and_inverse() -> None:
    machine = abbe.load(TRUNNION)
    poses, oracle = poses_of(machine, 60, 4), RigidBody(TRUNNION)
    found = machine.nominal(poses)
    origin = np.array(machine.geometry.workpiece_origin_mm)
    expected = np.array([nominal_tool(oracle, pose, np.array([0.0, 0, 1])) for pose in poses])
    np.testing.assert_allclose(found.tip, expected[:, :3] - origin, rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.direction, expected[:, 3:], rtol=0, atol=1e-13)
    for path in (False, True):
        back = machine.inverse(found.tip, found.direction, path=path)
        again = np.array([nominal_tool(oracle, pose, np.array([0.0, 0, 1])) for pose in back])
        np.testing.assert_allclose(again, expected, rtol=0, atol=1e-8)
    far = found.tip.copy()
    far[7] = [9e3, 0, 0]
    lost = machine.inverse(far, found.direction)
    assert np.isnan(lost[7]).all() and np.isfinite(np.delete(lost, 7, axis=0)).all()


def test_jacobian_is_the_slope_of_the_rigid_body() -> None:
    machine = abbe.load(TRUNNION)
    poses = poses_of(machine, 12, 5)
    blank = machine.with_({f"errors.{name}": None for name in machine.errors if name[2] == "0"} | {"measured": []})
    found = blank.jacobian(poses, LOCATION)
    assert found.shape == (12, 6, len(LOCATION))
    step = 1e-5
    none = {name: 0.0 for name in machine.errors if name[2] == "0"}
    for k, name in enumerate(LOCATION):
        for i, pose in enumerate(poses):
            there, back = (effects(none | {name: side * step}, pose) for side in (1, -1))
            # Second order cancels; the curves of the file leave products of 1e-5, and rounding 1e-12 over the step.
            np.testing.assert_allclose(found[i, :, k], (there - back) / (2 * step), rtol=0, atol=0.05)


def test_curves_and_jacobian_are_the_deviations_of_first_order() -> None:
    machine = abbe.load(TRUNNION)
    poses = poses_of(machine, 200, 6)
    names = list(machine.errors)
    column = {name: poses[:, k] for k, name in enumerate(machine.axis_names)}
    values = np.column_stack([machine.errors[name](column[name.lstrip("E")[1:].lstrip("0")]) for name in names])
    summed = np.einsum("nke,ne->nk", machine.jacobian(poses, names), values)
    first = machine.deviations(poses, order=1)
    np.testing.assert_allclose(summed[:, :3], first.position, rtol=0, atol=1e-12)
    np.testing.assert_allclose(summed[:, 3:], first.rotation, rtol=0, atol=1e-15)
    oracle = next(axis for axis in RigidBody(TRUNNION).axes if axis.name == "X")
    at = np.linspace(0, 500, 37)
    expected = [oracle.errors(q, "forward")[0] for q in at]
    np.testing.assert_allclose(machine.errors["EXX"](at, approach="forward"), expected, rtol=0, atol=1e-15)
    with pytest.raises(abbe.DiagnosticError, match="not known at X = 5000"):
        machine.errors["EXX"]([5000])


def test_drawn_machines_are_rigid_bodies() -> None:
    machine = abbe.load(TRUNNION)
    poses, rng = poses_of(machine, 7, 8), np.random.default_rng(3)
    values = {name: rng.normal(0, 2e-5, 9) for name in LOCATION}
    found = machine.drawn_deviations(poses, values)
    assert found.position.shape == found.rotation.shape == (9, 7, 3)
    for m in range(9):
        for n, pose in enumerate(poses):
            expected = effects({name: float(of[m]) for name, of in values.items()}, pose)
            np.testing.assert_allclose(found.position[m, n], expected[:3], rtol=0, atol=1e-11)
            np.testing.assert_allclose(found.rotation[m, n], expected[3:], rtol=0, atol=1e-14)
    for threads in (1, 2):
        assert (machine.drawn_deviations(poses, values, threads=threads).position == found.position).all()
    with pytest.raises(abbe.DiagnosticError, match="EXX is a curve"):
        machine.drawn_deviations(poses, {"EXX": [0.0]})
    with pytest.raises(abbe.DiagnosticError, match="not finite: row 1 of EC0Y"):
        machine.drawn_deviations(poses, {"EC0Y": [0.0, np.nan]})


def test_uncertainty_of_location_errors() -> None:
    text = """abbe: 1
machine: Mill
chain: w Y' X' b Z t
axes: { X: { travel: [0, 400] }, Y: { travel: [0, 300] }, Z: { travel: [-200, 0] } }
errors: { EC0Y: { value: 30 urad, uncertainty: 4 urad }, EB0Z: { value: 5 urad, uncertainty: 6 urad } }
"""
    machine = abbe.loads(text)
    poses: Any = {"Y": [0.0, 300.0, 150.0], "Z": [-200.0, 0.0, -50.0]}
    found = machine.uncertainty(poses)
    rows = machine.eval(poses=poses).poses
    for k, row in enumerate(rows):
        assert row.uncertainty is not None and found.position[k].tolist() == row.uncertainty.deviation
    # Squarenesses turn what they carry: 4 urad of Y and 6 urad of Z along x.
    expected = [math.hypot(4e-6 * y, 6e-6 * z) for y, z in zip(poses["Y"], poses["Z"], strict=True)]
    np.testing.assert_allclose(found.position[:, 0], expected, rtol=1e-9)
    with pytest.raises(ValueError, match="states no uncertainty"):
        abbe.load(CONFIGS / "vmc-cframe-754.yaml").uncertainty({"X": 0})


def test_covariance_and_residuals_are_those_of_least_squares() -> None:
    known = abbe.load(CONFIGS / "vmc-cframe-754.yaml")
    names = ["EC0Y", "EB0Z", "EA0Z"]
    rng = np.random.default_rng(11)
    where = rng.uniform([0, 0, -500], [700, 500, 0], (60, 3))
    poses: Any = {name: where[:, k] for k, name in enumerate("XYZ")}
    blank = known.with_({f"errors.{name}": None for name in names})
    noise = rng.normal(0, 2e-3, (60, 3))
    read = known.deviations(poses, order=1).position + noise
    columns = {f"{name} [mm]": of for name, of in poses.items()}
    columns |= {f"d{letter} [um]": read[:, k] * 1e3 for k, letter in enumerate("xyz")}
    fit = blank.identify(columns, fit=names, order=1)
    design = np.concatenate([blank.jacobian(poses, names)[:, k] for k in range(3)])
    right = (read - blank.deviations(poses, order=1).position).T.reshape(-1)
    theta, squares, *_ = np.linalg.lstsq(design, right, rcond=None)
    np.testing.assert_allclose([(one.value or 0.0) * 1e-6 for one in fit.parameters], theta, rtol=0, atol=1e-9)
    expected = np.linalg.inv(design.T @ design) * squares / (len(right) - 3) * 1e12
    scatter = np.array([one.type_a for one in fit.parameters])
    np.testing.assert_allclose(scatter**2, np.diag(expected), rtol=1e-6)
    correlation = expected / np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    found = fit.covariance.loc[names, names].to_numpy()
    sigma = np.array([one.sigma for one in fit.parameters])
    np.testing.assert_allclose(np.diag(found), sigma**2, rtol=1e-9)
    # The form of the axes beside the fit adds to the scatter; it is small here.
    np.testing.assert_allclose(found / np.outer(sigma, sigma), correlation, rtol=0, atol=0.2)
    left = fit.reading_residuals[["x", "y", "z"]].to_numpy()
    np.testing.assert_allclose(left, (right - design @ theta).reshape(3, -1).T * 1e3, rtol=0, atol=1e-3)
