"""Types: mypy accepts what the documents promise, and each ignored line is one that it refuses (python/test)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    import pandas

    import abbe
    import abbe.dask
    import abbe.study

    def accepted(machine: abbe.Machine, table: pandas.DataFrame) -> None:
        """What the documents show."""
        machine.deviations(table)
        machine.deviations({"X": [0, 1], "C": 90})
        machine.map(poses={"random": 5}, order=2, picture={"plane": ("X", "Z"), "at": {"Y": 3}})
        machine.map(poses={"tool_poses": table}, class_="production", target="linuxcnc")
        machine.eval(at=[{"X": 3.0}], poses=table)
        machine.budget(tool_poses=table, at={"X": 100}, progress=lambda phase, done, total: print(phase, done, total))
        machine.goal("30 um", class_="desktop", samples=50)
        machine.identify(table, fit=["location"])
        machine.identify([table, "more.csv"])
        machine.compile(Path("own-template"), compensation={"templates": "templates"})
        machine.verify(machine.compile("grid-csv").contents)
        abbe.dask.budget(machine, shards=3, samples=100)
        abbe.study.p95_um(machine, samples=100)

    def refused(machine: abbe.Machine) -> None:
        """What they do not."""
        machine.map(poses={"randm": 5})  # type: ignore[arg-type]
        machine.map(poses={"random": "5"})  # type: ignore[arg-type]
        machine.map(poses="gird")  # type: ignore[arg-type]
        machine.map(class_="produktion")  # type: ignore[arg-type]
        machine.map(order="seventh")  # type: ignore[arg-type]
        machine.map(picture={"plan": "XZ"})  # type: ignore[arg-type]
        machine.compile("linuxnc")  # type: ignore[arg-type]
        machine.budget(sample=3)  # type: ignore[call-arg]
        machine.goal(30)  # type: ignore[arg-type]
        machine.goal("30 um", sample=3)  # type: ignore[call-arg]
        abbe.dask.budget(machine, sample=3)  # type: ignore[call-arg]
        abbe.study.p95_um(machine, sample=3)  # type: ignore[call-arg]
