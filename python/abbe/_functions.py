"""Functions that need no machine."""

from __future__ import annotations

import json
from typing import Any, Literal

from ._calls import call
from ._fields import TargetSummary
from ._results import CheckRecordResult, ClassifyResult
from ._types import Text
from ._verbs import figures, import_readings, record, record_trend, testpiece

__all__ = [
    "check",
    "check_record",
    "classify",
    "explain",
    "figures",
    "import_readings",
    "record",
    "record_trend",
    "schema",
    "starter",
    "targets",
    "testpiece",
]


def check(*paths: Text) -> list[dict[str, Any]]:
    """Checks machine files one by one, and returns for each its summary or its refusal with all diagnostics.

    Refuses nothing and warns of nothing: what is wrong stands in the entries, as ``abbe check --format json`` prints
    them for several files.
    """
    entries: list[dict[str, Any]] = json.loads(call("check", [], {}, words=paths).json())
    return entries


def classify(path: Text, *, tolerance: float = 1e-9) -> ClassifyResult:
    """Returns motion and errors of a 4x4 matrix over the dual numbers: a YAML file as ``abbe classify`` reads it."""
    return ClassifyResult(call("classify", [], {"tolerance": tolerance}, words=[path]))


def check_record(folder: Text) -> CheckRecordResult:
    """Compares every file of a record with its hash; refuses a record in which one differs or is missing."""
    return CheckRecordResult(call("check_record", [], {}, words=[folder]))


def explain(what: str) -> str:
    """Returns the long text of a code such as E0203, an error such as EC0Y, a class of machines, or a target."""
    return str(json.loads(call("explain", [], {}, words=[what]).json())["text"])


def targets() -> list[TargetSummary]:
    """Returns the controllers, their mechanisms, and how sure their facts are."""
    return [TargetSummary(target) for target in json.loads(call("targets", [], {}).json())["targets"]]


def schema() -> dict[str, Any]:
    """Returns the JSON Schema (draft-07) of the machine file."""
    found: dict[str, Any] = json.loads(call("schema", [], {}).json())
    return found


def starter(kind: Literal["three-axis", "vertical-rotary", "trunnion", "head-table", "head-head"] = "trunnion") -> str:
    """Returns the text of a machine file to begin with."""
    return str(json.loads(call("starter", [], {"kind": kind}).json()))
