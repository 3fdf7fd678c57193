"""The repository and the program that the package is compared with."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import typed

import abbe

REPOSITORY = Path(__file__).resolve().parents[2]
CONFIGS = REPOSITORY / "configs"

#: What a program prints as JSON for arguments.
Program = Callable[..., Any]


@pytest.fixture(scope="session")
def program() -> Program:
    """Runs the program; ABBE_PROGRAM names it."""
    path = os.environ.get("ABBE_PROGRAM", str(REPOSITORY / "target" / "debug" / "abbe"))

    def run(*arguments: object) -> Any:
        command = [path, *(str(argument) for argument in arguments), "--format", "json"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.stdout, done.stderr
        return json.loads(done.stdout)

    def text(*arguments: object) -> str:
        command = [path, *(str(argument) for argument in arguments)]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout

    run.text = text  # type: ignore[attr-defined]
    return run


@pytest.fixture(autouse=True, scope="session")
def results_are_typed() -> Iterator[None]:
    """Checks every result of every test against its declared types."""
    made = abbe.Result.__init__

    def checked(self: abbe.Result, found: Any) -> None:
        made(self, found)
        # A part of a study has no ranking yet.
        if "walks_done" not in self and "drawn" not in self:
            typed.check_result(self)

    abbe.Result.__init__ = checked  # type: ignore[method-assign]
    yield
    abbe.Result.__init__ = made  # type: ignore[method-assign]
