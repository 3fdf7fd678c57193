"""The methods have the options of the façade, all of them, with its defaults."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
from pathlib import Path

import abbe
from abbe import _abbe

#: Options that the package sets itself: texts are columns in memory.
OWN = {("identify", "texts"), ("fit_monomials", "texts"), ("predict", "texts")}


def test_no_option_is_missing() -> None:
    verbs = json.loads(_abbe.verbs())
    assert len(verbs) == 28
    for name, options in verbs.items():
        free = name in ("import_readings", "figures", "record", "record_trend", "testpiece")
        method = getattr(abbe if free else abbe.Machine, name)
        parameters = inspect.signature(method).parameters
        for option, default in options["default"].items():
            if (name, option) in OWN:
                continue
            parameter = parameters.get(option) or parameters[f"{option}_"]
            assert parameter.default in (None, default, inspect.Parameter.empty), (name, option)
            assert f"``{parameter.name}``: " in (inspect.getdoc(method) or ""), (name, option)


def test_generated_methods_are_up_to_date() -> None:
    script = Path(__file__).resolve().parents[1] / "generate.py"
    done = subprocess.run([sys.executable, "-I", script, "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
