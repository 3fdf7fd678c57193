"""Results as tables, arrays and pictures."""

from __future__ import annotations

import html
import io
import pickle
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import CONFIGS, REPOSITORY

import abbe
from abbe._readings import csv_of

TRUNNION = CONFIGS / "trunnion.yaml"
VMC = CONFIGS / "vmc-cframe-754.yaml"

pytestmark = pytest.mark.filterwarnings("ignore::abbe.DiagnosticWarning")


def test_rows_are_the_table_of_the_program(program: Any, tmp_path: Path) -> None:
    table = tmp_path / "map.csv"
    program("map", TRUNNION, "--random", 1500, "--csv", table)
    found = abbe.load(TRUNNION).map(poses={"random": 1500}, rows=True)
    heads = table.read_text().splitlines()[0].split(",")
    assert list(found.rows.dtype.names or ()) == heads
    numbers = np.loadtxt(table, delimiter=",", skiprows=1)
    assert (np.column_stack([found.rows[head] for head in heads]) == numbers).all()


def test_rows_are_deviations() -> None:
    machine = abbe.load(TRUNNION)
    rows = machine.map(poses={"low_discrepancy": 400}, rows=True).rows
    found = machine.deviations(
        {name: rows[f"{name} [{unit}]"] for name, unit in zip("CAYXZ", ["deg"] * 2 + ["mm"] * 3, strict=True)}
    )
    # Rows are in um and urad: a rounding of each product.
    np.testing.assert_allclose(rows["dx [um]"], found.position[:, 0] * 1e3, rtol=1e-15, atol=0)
    np.testing.assert_allclose(rows["wz [urad]"], found.rotation[:, 2] * 1e6, rtol=1e-15, atol=0)


def test_rows_are_kept_if_asked_for() -> None:
    with pytest.raises(ValueError, match="rows=True"):
        _ = abbe.load(VMC).map(poses={"random": 5}).rows


def test_pandas() -> None:
    pandas = pytest.importorskip("pandas")
    machine = abbe.load(TRUNNION)
    found = machine.map(poses={"random": 20}, rows=True)
    frame = found.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame.shape == (20, 11)
    assert (frame["dx [um]"].to_numpy() == found.rows["dx [um]"]).all()
    worst = machine.map(poses={"random": 20}, worst=3).to_pandas()
    assert list(worst["axes.C"]) == [
        record["axes"]["C"] for record in machine.map(poses={"random": 20}, worst=3).to_dict()["worst"]
    ]
    budget = abbe.load(REPOSITORY / "docs" / "examples" / "study.yaml").budget(
        poses=20, samples=50, class_="production"
    )
    assert len(budget.to_pandas()) == len(budget.to_dict()["tighten"]) > 5


def test_the_table_of_an_instrument() -> None:
    pytest.importorskip("pandas")
    machine = abbe.load(TRUNNION)
    for instrument, rows, column in (
        ("ball_bar", 3, "plane"),
        ("r_test", 2, "axis"),
        ("diagonals", 4, "e_d_um"),
        ("step_diagonals", 4, "e_d_um"),
    ):
        frame = machine.instrument(instrument).to_pandas()  # type: ignore[arg-type]
        assert len(frame) == rows and column in frame, instrument


def test_columns_of_measurements_are_of_one_length() -> None:
    with pytest.raises(ValueError, match=r"not of one length: X \[mm\] 2, dx \[um\] 3"):
        abbe.load(VMC).identify({"X [mm]": [0.0, 1.0], "dx [um]": [1.0, 2.0, 3.0]}, fit=["EC0Y"])


def test_arrow() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    found = abbe.load(TRUNNION).map(poses={"random": 20}, rows=True)
    table = found.to_arrow()
    assert table.column_names == list(found.rows.dtype.names or ())
    assert (table["wz [urad]"].to_numpy() == found.rows["wz [urad]"]).all()
    assert pyarrow.table(found).equals(table)


def test_xarray() -> None:
    pytest.importorskip("xarray")
    machine = abbe.load(VMC)
    found = machine.map(rows=True)
    data = found.to_xarray()
    assert found.grid == tuple(data.sizes.values())
    assert data["dx"].attrs["units"] == "um" and data["X"].attrs["units"] == "mm"
    at = dict(X=data["X"][3], Y=data["Y"][1], Z=data["Z"][2])
    one = machine.deviations({name: float(value) for name, value in at.items()})
    assert float(data["dy"].sel(at)) == pytest.approx(one.position[0, 1] * 1e3, rel=1e-12)
    with pytest.raises(ValueError, match="no grid"):
        machine.map(poses={"random": 5}, rows=True).to_xarray()


def test_pictures() -> None:
    machine = abbe.load(TRUNNION)
    study = abbe.load(REPOSITORY / "docs" / "examples" / "study.yaml")
    budget = study.budget(poses=20, samples=50, class_="production")
    assert set(budget.pictures) == {"pareto.svg", "waterfall.svg"}
    found = machine.map(poses={"random": 20})
    for shown in (machine, found, budget, machine.instrument("ball_bar", points=20), machine.reach(directions=4)):
        page = shown._repr_html_()
        # One picture: a saved notebook holds whatever stands here.
        assert "<table>" in page and page.count("<svg") == 1 and "<?xml" not in page
        assert not hasattr(shown, "_repr_svg_")
        assert ElementTree.fromstring(page[page.index("<svg") :]).tag.endswith("svg")
    assert machine.curves_svg is not None
    columns, fit = readings(abbe.load(VMC))
    fitted = abbe.load(VMC).identify(columns, fit=fit)
    assert not fitted.pictures
    page = fitted._repr_html_()
    assert "<svg" in page and all(f"<td>{name}</td>" in page for name in fit)
    assert fitted.pictures and pickle.loads(pickle.dumps(fitted)).pictures == fitted.pictures
    # A robot has no plane of two linear axes.
    assert abbe.load(CONFIGS / "robots" / "ur5.yaml").map(poses={"random": 20})._picture() is None


def first_lines(program: Any, *arguments: object) -> str:
    """Returns the text of the program without its folds."""
    return " ".join(program.text(*arguments).split())


def test_the_key_number_comes_first(program: Any) -> None:
    machine, study = abbe.load(TRUNNION), abbe.load(REPOSITORY / "docs" / "examples" / "study.yaml")
    short = abbe.loads("abbe: 1\nmachine: G\nchain: w b X t\naxes: { X: { travel: [0, 9] } }")
    columns, fit = readings(abbe.load(VMC))
    shown: list[abbe.Result] = [
        machine.map(poses={"random": 50}),
        study.budget(poses=20, samples=50, class_="production"),
        machine.compare(machine, poses=20),
        abbe.load(CONFIGS / "hmc-4ax.yaml").enumerate(poses=20, samples=20, class_="production"),
        machine.compile("grid-csv", poses=50),
        abbe.load(VMC).plan(poses=4, fit=["EC0Y"]),
        machine.eval(at=["X=100"]),
        machine.diff(machine.with_({"errors.EC0Y": "50 urad"})),
        machine.equations(order=1),
        abbe.load(VMC).identify(columns, fit=fit),
        machine.reach(directions=4),
    ]
    for found in shown:
        first = found.headline.splitlines()[0]
        assert any(letter.isdigit() for letter in first) and first in repr(found), repr(found)
        assert html.escape(first) in found._repr_html_()
        assert pickle.loads(pickle.dumps(found)).headline == found.headline
    assert shown[0].headline in first_lines(program, "map", TRUNNION, "--random", 50)
    assert "EC0Y  " in repr(shown[9]) and "95 %" in shown[0].headline and "W0" in repr(short.eval(at=["X=20"]))


def test_results_do_not_change() -> None:
    machine = abbe.load(TRUNNION)
    found = machine.map(poses={"random": 20}, rows=True)
    before = found.to_dict()
    found.to_dict()["position_um"]["p95"] = 0.0
    found.to_dict()["worst"].clear()
    found.records()[0].clear()
    assert found.to_dict() == before and found == machine.map(poses={"random": 20}) == before
    for of, name in ((found, "poses"), (found.position_um, "p95"), (machine, "name")):
        with pytest.raises(AttributeError, match="not change"):
            setattr(of, name, 3)
    with pytest.raises(ValueError, match="read-only"):
        found.rows["dx [um]"][0] = 3
    with pytest.raises(ValueError, match="read-only"):
        machine.grid["X"][:] += 100
    with pytest.raises(TypeError):
        machine.errors["EC0Y"] = machine.errors["EC0Y"]  # type: ignore[index]


def test_records() -> None:
    found = abbe.load(TRUNNION).map(poses={"random": 20})
    assert found.position_um.p95 == found["position_um"]["p95"] == found.to_dict()["position_um"]["p95"]
    assert found.worst[0].axes.X == found.to_dict()["worst"][0]["axes"]["X"]
    assert "position_um" in dir(found) and len(found) == len(found.to_dict())
    restored = pickle.loads(pickle.dumps(found))
    assert restored.to_dict() == found.to_dict()
    with pytest.raises(AttributeError, match="no field `position`"):
        _ = found.position


def readings(machine: abbe.Machine) -> tuple[dict[str, Any], list[str]]:
    """Vectors of a machine of three axes with noise, and the errors to fit."""
    generator = np.random.default_rng(4)
    poses = {name: generator.uniform(axis["travel"][0], axis["travel"][1], 60) for name, axis in machine.axes.items()}
    read = machine.deviations(poses).position * 1e3 + generator.normal(0, 0.2, (60, 3))
    columns: dict[str, Any] = {f"{name} [mm]": values for name, values in poses.items()}
    columns.update({f"d{letter} [um]": read[:, k] for k, letter in enumerate("xyz")})
    return columns, ["EC0Y", "EB0Z", "EZ0X"]


def test_measurements_from_memory(program: Any, tmp_path: Path) -> None:
    machine = abbe.load(VMC)
    columns, fit = readings(machine)
    found = machine.identify(columns, fit=fit, machine_file=True)
    file = tmp_path / "readings.csv"
    heads = ",".join(columns)
    np.savetxt(file, np.column_stack(list(columns.values())), delimiter=",", header=heads, comments="", fmt="%.17g")
    expected = program("identify", VMC, "--data", file, "--fit", ",".join(fit))
    of_file = machine.identify(file, fit=fit)
    assert of_file.to_dict() == expected
    values = [(parameter["name"], parameter["value"]) for parameter in found.to_dict()["parameters"]]
    assert values == [(parameter["name"], parameter["value"]) for parameter in expected["parameters"]]
    assert abbe.loads(found.machine_file, name=str(VMC)).errors["EC0Y"].kind == "location"


def test_report_and_texts(tmp_path: Path) -> None:
    machine = abbe.load(VMC)
    found = machine.report(poses=100)
    found.save(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text(encoding="utf-8").startswith("<!doctype html>")
    assert "documentclass" in machine.equations(order=1).latex
    converted = machine.convert("carried_body")
    assert "location: carried_body" in converted.machine_file
    assert machine.plan(poses=4, fit=["EC0Y"]).csv.count("\n") == 5


def test_npy_is_readable_by_itself() -> None:
    found = abbe.load(VMC).map(poses={"random": 7}, rows=True)
    file = io.BytesIO()
    np.save(file, found.rows)
    file.seek(0)
    assert np.load(file).tobytes() == found.rows.tobytes()


def test_cells_of_measurements() -> None:
    """Numbers keep every bit, missing ones are empty, and text does not break the table."""
    numbers = np.array([0.1, -0.0, 1e-300, 5e-324, 1.7976931348623157e308, 3.0, np.nan])
    text = csv_of({"a": numbers, "b": np.arange(7), "c": ["x", None, "y", "", "z", "w", "v"]})
    rows = [line.split(",") for line in text.splitlines()]
    assert rows[0] == ["a", "b", "c"] and rows[-1] == ["", "6.0", "v"] and rows[2][2] == ""
    assert np.array([float(row[0]) for row in rows[1:-1]]).tobytes() == numbers[:-1].tobytes()
    for columns in ({"a": [1.0], "b": [1.0, 2.0]}, {"a,b": [1.0]}, {"a": ["1,2"]}, {"a": ["1\n2"]}):
        with pytest.raises(ValueError, match=r"measurements|comma"):
            csv_of(columns)


def test_readings_need_no_alignment() -> None:
    """Arrays that came over a network may start anywhere."""
    aside = np.zeros(2 * 8 + 1, dtype=np.uint8)[1:].view(np.float64)
    aside[:] = (1.5, 2.0)
    assert not aside.flags.aligned and [float(cell) for cell in csv_of({"a": aside}).split()[1:]] == [1.5, 2.0]


def test_types_of_results() -> None:
    """Fields have classes of their own; one that may be absent is none."""
    found = abbe.load(TRUNNION).map(poses={"random": 20}, worst=1)
    assert type(found.position_um).__name__ == "Summary" and "ceil(0.95 n)" in found.position_um.field_docs()["p95"]
    assert found.bounds is None and "bounds" not in found
    assert isinstance(found.worst[0].axes, abbe.Named) and found.worst[0].axes["X"] == found.worst[0].axes.X
    restored = pickle.loads(pickle.dumps(found))
    assert restored.worst[0] == found.worst[0] and isinstance(restored.worst[0].axes, abbe.Named)


def test_values_that_the_data_do_not_hold_are_none() -> None:
    machine = abbe.load(VMC)
    rng = np.random.default_rng(3)
    columns: dict[str, Any] = {f"{name} [mm]": rng.uniform(0, 100, 12) for name in "XY"}
    columns["Z [mm]"] = np.full(12, -200.0)
    columns |= {f"rel.d{letter} [um]": np.append(0, rng.normal(0, 1, 11)) for letter in "xyz"}
    # Readings less the first know no constant.
    fit = machine.identify(columns, fit=["EC0Y", "EZ0X"], accept=["undetermined"])
    found = {parameter.name: parameter for parameter in fit.parameters}
    assert found["EC0Y"].determined and found["EC0Y"].value is not None
    free = found["EZ0X"]
    assert not free.determined and free.value is None and free["value"] is None and free.sigma is None
    assert {row["name"]: row["value"] for row in fit.to_dict()["parameters"]}["EZ0X"] == pytest.approx(0.0, abs=50)
    errors = {error.error: error for error in fit.errors}
    assert errors["EZ0X"].largest is None and errors["EC0Y"].largest is not None
