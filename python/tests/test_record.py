"""What a control found, and the record of a calibration: those of the program."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from conftest import CONFIGS

import abbe

pytestmark = pytest.mark.filterwarnings("ignore::abbe.DiagnosticWarning")

MACHINE = """abbe: 1
machine: Mill
chain: w Y' X' b Z t
axes: { X: { travel: [0, 400] }, Y: { travel: [0, 300] }, Z: { travel: [-200, 0] } }
errors: { EC0Y: { value: 30 urad, uncertainty: 4 urad } }
"""

DESCRIPTION = """record: 1
id: R-%(day)s
dates: { begin: 2026-11-%(day)s, end: 2026-11-%(day)s }
country: DE
place: customer
laboratory: { name: Lab, city: Hamburg, country: DE }
customer: { name: Works, city: Bremen }
persons: [{ name: A. Engineer, role: engineer }]
machine: { serial: "4711", manufacturer: Maker, model: M }
as_found: machine.yaml
instruments:
  - { name: Laser, serial: L-7, certificate: C-12, calibrated: 2026-03-01, uncertainty: 0.5 um/m }
data: [raw/x.csv]
"""


def files(folder: Path) -> dict[str, bytes]:
    """The files below a folder by name."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def described(folder: Path, day: str) -> Path:
    (folder / "raw").mkdir(exist_ok=True)
    (folder / "raw" / "x.csv").write_text("X [mm],EXX [um]\n0,0\n")
    (folder / "machine.yaml").write_text(MACHINE)
    path = folder / f"{day}.yaml"
    path.write_text(DESCRIPTION % {"day": day})
    return path


def test_records_are_those_of_the_program(program: Any, tmp_path: Path) -> None:
    for day in ("02", "03"):
        description = described(tmp_path, day)
        found = abbe.record(description)
        assert found.to_dict() == program("record", description, "--out", tmp_path / f"program-{day}")
        found.save(tmp_path / f"own-{day}")
        assert files(tmp_path / f"own-{day}") == files(tmp_path / f"program-{day}") == found.contents
        with pytest.raises(FileExistsError):
            found.save(tmp_path / f"own-{day}")
    folders = [tmp_path / f"own-{day}" for day in ("02", "03")]
    trend = abbe.record_trend(*folders)
    assert trend.to_dict() == program("record", "--trend", *folders)
    assert list(trend.pictures) == ["trend.svg"]
    assert list(trend.to_pandas()["error"]) == ["EC0Y"]
    assert abbe.check_record(folders[0]).to_dict() == program("record", "--check", folders[0])
    (folders[0] / "record.json").write_text("{}")
    with pytest.raises(abbe.DiagnosticError):
        abbe.check_record(folders[0])


def test_a_control_has_found(program: Any, tmp_path: Path) -> None:
    machine = abbe.load(CONFIGS / "trunnion.yaml")
    machine.compile("sinumerik-chain", accept_unverified=True, poses=20).save(tmp_path / "set")
    found = machine.locate(tmp_path / "set")
    assert found.to_dict() == program("locate", CONFIGS / "trunnion.yaml", tmp_path / "set")
    table = found.to_pandas().set_index("name")
    assert (table.loc[["EX0C", "EA0C"], "difference"].abs() < 1e-3).all()
    lines = tmp_path / "lines.csv"
    lines.write_text("axis,x [mm],y [mm],u [um]\nC,250.026,224.991,4\n")
    probed = machine.locate(lines)
    errors = {error["name"]: error for error in probed.to_dict()["errors"]}
    assert errors["EX0C"]["uncertainty"] == 4
    again = abbe.loads(probed.machine_file, name=str(CONFIGS / "found.yaml"))
    assert abs(again.errors["EX0C"].value - errors["EX0C"]["found"] * 1e-3) < 1e-9
