"""The repository and the program that the package is compared with."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

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

    return run
