"""Calls of the native module: options as JSON, threads, warnings."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextvars import ContextVar
from typing import Any

from . import _abbe
from ._diagnostics import warn
from ._readings import csv_of
from ._types import Progress, Text

_threads: int | None = None

#: The number of threads within a task of :mod:`abbe.dask`, whatever the scheduler.
task_threads: ContextVar[int | None] = ContextVar("abbe_task_threads", default=None)


def set_threads(threads: int | None) -> None:
    """Sets the number of threads of all later calls that do not name one with ``threads=``.

    ``None`` restores the default: one thread inside a task of Dask, elsewhere ``RAYON_NUM_THREADS`` or one for each
    processor. Results do not depend on it.
    """
    global _threads
    if threads is not None and threads < 1:
        raise ValueError("threads: 1 or more")
    _threads = threads


def threads_of(threads: int | None) -> int:
    """Returns the number of threads for a call; 0 leaves it to the native module."""
    if threads is not None:
        if threads < 1:
            raise ValueError("threads: 1 or more")
        return threads
    of_task = task_threads.get()
    if of_task is not None:
        return of_task
    if _threads is not None:
        return _threads
    return 1 if _in_dask_task() else 0


def _in_dask_task() -> bool:
    worker = sys.modules.get("distributed.worker")
    if worker is None:
        return False
    try:
        worker.get_worker()
    except ValueError:
        return False
    return True


def words_of(words: Iterable[Text]) -> list[str]:
    """Returns paths and names as text."""
    return [os.fspath(word) for word in words]


def json_of(options: Mapping[str, Any]) -> str:
    """Returns options as JSON; those that are ``None`` are left to the façade's defaults."""

    def plain(value: Any) -> Any:
        if isinstance(value, os.PathLike):
            return os.fspath(value)
        if hasattr(value, "tolist"):
            return value.tolist()
        raise TypeError(f"{value!r} is no value of an option")

    return json.dumps({name: value for name, value in options.items() if value is not None}, default=plain)


def spelt(options: Mapping[str, Any], texts: list[tuple[str, str]]) -> dict[str, Any]:
    """Returns options in the words of the façade; tables in memory go among the texts."""

    def one(name: str, value: Any) -> Any:
        if name in ("tool_poses", "axis_poses", "pose_file") and not isinstance(value, (str, os.PathLike, type(None))):
            texts.append((f"{name}-{len(texts) + 1}.csv", csv_of(value)))
            return texts[-1][0]
        if name == "at" and isinstance(value, Mapping):
            return ",".join(f"{axis}={float(position)!r}" for axis, position in value.items())
        if name == "at" and isinstance(value, (list, tuple)):
            return [one(name, each) for each in value]
        if name == "plane" and isinstance(value, tuple):
            return ",".join(value)
        return {key: one(key, inner) for key, inner in value.items()} if isinstance(value, dict) else value

    return {name: one(name, value) for name, value in options.items()}


def call(
    verb: str,
    machines: Sequence[_abbe.NativeMachine],
    options: Mapping[str, Any],
    *,
    words: Iterable[Text] = (),
    texts: Iterable[tuple[str, str]] = (),
    rows: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    stacklevel: int = 2,
) -> _abbe.NativeOutcome:
    """Runs a verb and warns of what it warns of; ``stacklevel`` 1 is the function that calls."""
    named = list(texts)
    asked = json_of(spelt(options, named))
    found = _abbe.run(verb, list(machines), words_of(words), asked, named, rows, threads_of(threads), progress)
    warn(found.warnings(), stacklevel + 1)
    return found


def order_of(order: int | str | None) -> str | None:
    """Returns an order as the façade writes it."""
    return None if order is None else str(order)
