"""`to_dict()` of every verb against the JSON that the program prints for the same machine and options."""

from __future__ import annotations

import json
import math
import warnings
from pathlib import Path
from typing import Any

import pytest
from conftest import CONFIGS, REPOSITORY

import abbe
from abbe._verbs import TargetName

TRUNNION = CONFIGS / "trunnion.yaml"
VMC = CONFIGS / "vmc-cframe-754.yaml"
STUDY = REPOSITORY / "docs" / "examples" / "study.yaml"
BOUNDED = CONFIGS / "tt-ac-800.yaml"

pytestmark = pytest.mark.filterwarnings("ignore::abbe.DiagnosticWarning")


def machine(path: Path = TRUNNION) -> abbe.Machine:
    """Reads a machine."""
    return abbe.load(path)


def test_show_and_check(program: Any) -> None:
    of = machine()
    assert of.geometry.to_dict() == program("show", TRUNNION)
    assert of.summary.to_dict() == program("check", TRUNNION)
    assert abbe.check(TRUNNION, VMC) == program("check", TRUNNION, VMC)


def test_eval(program: Any) -> None:
    options = {"at": ["X=100,C=90"], "order": 2, "sensitivity": True, "approach": "forward"}
    found = machine().eval(**options)  # type: ignore[arg-type]
    asked = ("--at", "X=100,C=90", "--order", 2, "--sensitivity", "--direction", "forward")
    assert found.to_dict() == program("eval", TRUNNION, *asked)


def test_equations(program: Any) -> None:
    assert machine(VMC).equations(order=1, symbols="paper").to_dict() == program(
        "equations", VMC, "--order", 1, "--symbols", "paper"
    )


def test_map(program: Any) -> None:
    assert machine().map().to_dict() == program("map", TRUNNION)
    found = machine().map(poses={"random": 700}, seed=3, order=1, frame="tool", worst=2)
    asked = ("--random", 700, "--seed", 3, "--order", 1, "--frame", "tool", "--worst", 2)
    assert found.to_dict() == program("map", TRUNNION, *asked)


def test_map_of_tool_poses_and_of_a_target(program: Any) -> None:
    work = REPOSITORY / "docs" / "examples" / "work.csv"
    found = machine().map(poses={"tool_poses": str(work)})
    assert found.to_dict() == program("map", TRUNNION, "--tool-poses", work)
    found = machine(VMC).map(poses={"random": 300}, target="linuxcnc")
    assert found.to_dict() == program("map", VMC, "--random", 300, "--target", "linuxcnc")


def test_reach(program: Any) -> None:
    found = machine().reach(step_mm=150, directions=12)
    assert found.to_dict() == program("reach", TRUNNION, "--step", "150 mm", "--directions", 12)


def test_compare(program: Any) -> None:
    other = CONFIGS / "variants"
    paths = [TRUNNION, *sorted(other.glob("*.yaml"))[:1]]
    found = machine().compare(*(machine(path) for path in paths[1:]), poses=200)
    assert found.to_dict() == program("compare", *paths, "--poses", 200)


@pytest.fixture
def bounded(tmp_path: Path) -> Path:
    """A small machine of which only bounds are known."""
    file = tmp_path / "bounded.yaml"
    axes = ", ".join(f"{name}: {{ travel: [-90, 90], origin: [0, 0, {k}] }}" for k, name in enumerate("XYZ"))
    file.write_text(f"abbe: 1\nmachine: G\nchain: w X' b Y Z t\naxes: {{ {axes} }}\nclass: production\n")
    return file


def test_budget_and_goal(program: Any, bounded: Path) -> None:
    found = machine(bounded).budget(poses=20, samples=60, class_="premium", statistic="p95")
    asked = ("--poses", 20, "--samples", 60, "--class", "premium", "--statistic", "p95")
    assert found.to_dict() == program("budget", bounded, *asked)
    found = machine(bounded).goal("9 um", poses=20, samples=60)
    assert found.to_dict() == program("budget", bounded, "--poses", 20, "--samples", 60, "--goal", "9 um")
    assert found.goal is not None and found.goal.goal_um == pytest.approx(9, rel=1e-15)


def test_enumerate(program: Any, bounded: Path, tmp_path: Path) -> None:
    found = machine(bounded).enumerate(poses=30, samples=30, max_table=2)
    assert found.to_dict() == program("enumerate", bounded, "--poses", 30, "--samples", 30, "--max-table", 2)
    assert len(found.to_pandas()) == len(found.ranked) > 1
    parts = []
    for k in (1, 2):
        part = machine(bounded).enumerate(poses=30, samples=30, max_table=2, shard=(k, 2))
        assert part.walks_done < part.walks
        parts.append(tmp_path / f"part-{k}")
        parts[-1].write_text(part.state)
    merged = machine(bounded).enumerate(poses=30, samples=30, max_table=2, merge=parts)
    assert merged.to_dict() == found.to_dict()


@pytest.mark.parametrize("name", ["ball-bar", "r-test", "diagonals", "step-diagonals"])
def test_instrument(program: Any, name: Any) -> None:
    found = machine().instrument(name.replace("-", "_"), points=40)
    assert found.to_dict() == program("instrument", TRUNNION, name, "--points", 40)


def test_identify_and_plan(program: Any, tmp_path: Path) -> None:
    robot, data = CONFIGS / "robots" / "ur5.yaml", sorted((REPOSITORY / "tests" / "data" / "ur5").glob("*.csv"))
    assert data
    found = machine(robot).identify(data[:1], order=1)
    assert found.to_dict() == program("identify", robot, "--data", data[0], "--order", 1)
    assert machine(robot).plan(poses=5).to_dict() == program("identify", robot, "--plan", 5)


def test_convert(program: Any) -> None:
    assert machine().convert("carried_body").to_dict() == program("convert", TRUNNION, "--to", "carried_body")


def test_compile_and_verify(program: Any, tmp_path: Path) -> None:
    by_program, own = tmp_path / "program", tmp_path / "own"
    expected = program("compile", VMC, "--target", "linuxcnc", "--out", by_program, "--poses", 300)
    found = machine(VMC).compile("linuxcnc", poses=300)
    assert found.to_dict() == expected
    found.save(own)

    def files(folder: Path) -> dict[str, bytes]:
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    assert files(own) == files(by_program)
    verified = machine(VMC).verify(own, poses=300)
    assert verified.to_dict() == program("verify", VMC, own, "--poses", 300)
    compiled = machine(VMC).compile("grid-csv", poses=300)
    assert machine(VMC).verify(compiled, poses=300) == machine(VMC).verify(compiled.contents, poses=300) == compiled
    with pytest.raises(abbe.DiagnosticError):
        machine(VMC).verify({"abbe.lock.json": b"{}"})
    difference = machine(VMC).diff_sets(own, by_program, poses=300)
    assert difference.to_dict() == program("diff", VMC, own, by_program, "--poses", 300)
    with pytest.raises(FileExistsError):
        found.save(own)


def test_diff(program: Any) -> None:
    variant = sorted((CONFIGS / "variants").glob("*.yaml"))[0]
    assert machine().diff(machine(variant), poses=100).to_dict() == program("diff", TRUNNION, variant, "--poses", 100)


def test_targets_explain_schema_starter(program: Any, tmp_path: Path) -> None:
    assert [target.to_dict() for target in abbe.targets()] == program("targets")["targets"]
    assert abbe.explain("EC0Y") == program("explain", "EC0Y")["text"]
    assert abbe.schema() == program("schema")
    assert abbe.loads(abbe.starter("trunnion")).chain == "w C' A' Y' b X Z t"


def test_warnings_are_in_the_document(program: Any, tmp_path: Path) -> None:
    file = tmp_path / "bounded.yaml"
    axes = "axes: {X: {travel: [0, 9]}, Y: {travel: [0, 9]}}"
    file.write_text(f"machine: G\nchain: w b X Y t\n{axes}\nerrors: {{EC0Y: {{tolerance: 9 urad}}}}")
    found = machine(file).eval(at=["X=1"])
    assert [warning["code"] for warning in found.to_dict()["warnings"]] == ["W0201", "W0802"]
    assert found.to_dict() == program("eval", file, "--at", "X=1")


def test_refusals_are_those_of_the_program(program: Any, tmp_path: Path) -> None:
    file = tmp_path / "wrong.yaml"
    file.write_text("abbe: 1\nmachine: G\nchain: w b X t\naxes: {X: {travle: [0, 1]}, Y: 3}")
    with pytest.raises(abbe.DiagnosticError) as refused:
        abbe.load(file)
    expected = program("check", file)["diagnostics"]
    assert [diagnostic.code for diagnostic in refused.value.diagnostics] == [record["code"] for record in expected]
    place = refused.value.diagnostics[0].place
    assert place is not None
    assert vars(place) == expected[0]["places"][0]


def test_documents_hold_only_json() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        json.dumps(machine().map(poses={"random": 10}).to_dict(), allow_nan=False)


def test_parts_of_a_budget_are_put_together(tmp_path: Path) -> None:
    study = machine(REPOSITORY / "docs" / "examples" / "study.yaml")
    options: dict[str, Any] = {"samples": 130, "poses": 20, "class_": "production"}
    paths = []
    for part in (3, 1, 2, 4):
        found = study.budget(shard=(part, 4), **options)
        assert found.samples == 130 and found.drawn in (0, 10, 40, 80)
        paths.append(tmp_path / f"part-{part}")
        paths[-1].write_text(found.state)
    assert study.budget(merge=paths, **options).to_dict() == study.budget(**options).to_dict()
    assert study.budget(merge=[*paths, paths[0]], **options).samples == 130, "a part may be named twice"
    bad = tmp_path / "bad"
    bad.write_text(paths[0].read_text().replace('"samples":130', '"samples":"130"'))
    parts = json.loads(paths[1].read_text())
    parts["drawn"]["position"][0]["parts"].pop()
    short = tmp_path / "short"
    short.write_text(json.dumps(parts))
    parts = json.loads(paths[1].read_text())
    parts["drawn"]["position"][0]["value"] *= 2
    other = tmp_path / "other"
    other.write_text(json.dumps(parts))
    for code, merge, changed in [
        ("E0611", paths[1:], {}),
        ("E0610", [*paths, other], {}),
        ("E0610", [*paths[1:], bad], {}),
        ("E0610", [*paths[1:], short], {}),
        ("E0610", [tmp_path / "none"], {}),
        ("E0610", paths, {"seed": 2}),
    ]:
        with pytest.raises(abbe.DiagnosticError) as refused:
            study.budget(merge=merge, **{**options, **changed})
        assert refused.value.code == code, merge
    for shard in ((0, 4), (5, 4), (1, 0)):
        with pytest.raises(abbe.DiagnosticError):
            study.budget(shard=shard, **options)
    with pytest.raises(ValueError, match="shard"):
        print(study.budget(**options).state)


def test_figures_of_a_spindle_and_of_heat(program: Any, tmp_path: Path) -> None:
    spindle, heat = tmp_path / "spindle.csv", tmp_path / "heat.csv"
    turns = [(at, math.cos(math.radians(at)), math.sin(math.radians(2 * at))) for at in range(0, 1440, 10)]
    spindle.write_text("angle [deg],x [um],y [um]\n" + "".join(f"{at},{x:.6f},{y:.6f}\n" for at, x, y in turns))
    heat.write_text(
        "time [min],x [um],ambient [degC]\n" + "".join(f"{at},{at / 9:.3f},{20 + at / 99:.2f}\n" for at in range(90))
    )
    for test, file in (("rotation", spindle), ("drift", heat)):
        assert abbe.figures(file, test=test).to_dict() == program("figures", test, file), test  # type: ignore[arg-type]


def test_import(program: Any) -> None:
    file = REPOSITORY / "docs" / "examples" / "shop-floor" / "x-laser.csv"
    options: Any = {"error": "EXX", "axis": "X", "material": "22.4 degC x 11.5 um/m/K"}
    found = abbe.import_readings(file, **options)
    asked = ("--error", "EXX", "--axis", "X", "--material", "22.4 degC x 11.5 um/m/K")
    assert found.to_dict() == program("import", file, *asked)
    assert found.csv.startswith("X [mm], EXX+ [um], EXX- [um]\n")


def test_fit_monomials(program: Any) -> None:
    folder = REPOSITORY / "docs" / "examples" / "paper-2015"
    found = machine(folder / "as-printed.yaml").fit_monomials(folder / "phantom.csv")
    asked = ("--data", folder / "phantom.csv", "--method", "moore-penrose")
    assert found.to_dict() == program("identify", folder / "as-printed.yaml", *asked)
    assert len(found.to_pandas()) == 3


def test_classify(program: Any, tmp_path: Path) -> None:
    # Rz(90 deg) with the errors EX = 1e-3 mm and EC = 2e-5 rad before it, and a matrix that is none.
    good, bad = tmp_path / "good.yaml", tmp_path / "bad.yaml"
    good.write_text(
        "real: [[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
        "dual: [[-2e-5, 0, 0, 0.001], [0, -2e-5, 0, 1e-4], [0, 0, 0, 0], [0, 0, 0, 0]]\n"
    )
    bad.write_text(
        "real: [[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
        "dual: [[1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]\n"
    )
    found = abbe.classify(good)
    assert found.to_dict() == program("classify", good)
    assert found.errors_before is not None and found.errors_before.EC == pytest.approx(2e-5, rel=1e-12)
    assert abbe.classify(bad).to_dict() == program("classify", bad)


def test_report(program: Any, tmp_path: Path) -> None:
    page = tmp_path / "report.html"
    expected = program("report", VMC, "--poses", 100, "--out", page)
    found = machine(VMC).report(poses=100)
    # The page of the program is a file, and may have an engine; that of the package is in memory.
    assert expected == {"page": str(page), "engines": [], **found.to_dict()}
    assert found.page == page.read_text(encoding="utf-8")


def test_compile_for_two_targets(program: Any, tmp_path: Path) -> None:
    targets: list[TargetName] = ["sinumerik-traori", "sinumerik-cec"]
    by_program, own = tmp_path / "program", tmp_path / "own"
    asked = [word for target in targets for word in ("--target", target)]
    expected = program("compile", TRUNNION, *asked, "--accept-unverified", "--out", by_program, "--poses", 100)
    found = machine().compile(targets, poses=100, accept_unverified=True)
    assert found.to_dict() == expected
    assert found.steps is not None and found.steps[0].target == "sinumerik-traori"
    found.save(own)
    names = {path.relative_to(own) for path in own.rglob("*") if path.is_file()}
    assert names == {path.relative_to(by_program) for path in by_program.rglob("*") if path.is_file()}
    assert all((own / name).read_bytes() == (by_program / name).read_bytes() for name in names)
    assert machine().verify(own, poses=100).to_dict() == program("verify", TRUNNION, own, "--poses", 100)


def test_figures(program: Any, tmp_path: Path) -> None:
    file = tmp_path / "circle.csv"
    rows = [f"{at},{3 * math.cos(math.radians(2 * at)):.6f}" for at in range(0, 360, 5)]
    file.write_text("angle [deg],ccw [um]\n" + "\n".join(rows) + "\n")
    found = abbe.figures(file, test="circle")
    assert found.to_dict() == program("figures", "circle", file)
    # Two times the amplitude of the ellipse.
    assert found.circular_deviation_um is not None
    assert found.circular_deviation_um.counter_clockwise == pytest.approx(6.0, abs=1e-6)
    assert "figures.svg" in found.pictures
