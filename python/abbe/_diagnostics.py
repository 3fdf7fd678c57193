"""Refusals and warnings: one exception and one class of warnings, each with code, places and remedy."""

from __future__ import annotations

import errno
import json
import warnings
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Place:
    """A place in a file. Lines and columns count from 1, columns in characters; the end is exclusive."""

    file: str
    line: int
    column: int
    end_line: int
    end_column: int
    text: str


@dataclass(frozen=True)
class Diagnostic:
    """One thing that is wrong with an input.

    ``code`` is stable (``abbe.explain(code)`` has its long text), ``severity`` is ``"refusal"`` or ``"warning"``,
    ``help`` is the remedy, and ``places`` are places in files, the primary one first.
    """

    code: str
    severity: str
    message: str
    help: str | None
    places: tuple[Place, ...]

    @property
    def place(self) -> Place | None:
        """The primary place; none for a diagnostic about no file."""
        return self.places[0] if self.places else None

    def __str__(self) -> str:
        place = f" ({self.place.file}:{self.place.line}:{self.place.column})" if self.place else ""
        help_ = f"; {self.help}" if self.help else ""
        return f"{self.code}: {self.message}{place}{help_}"


class DiagnosticError(ValueError):
    """An input is refused. As text it is what the program prints; ``diagnostics`` are the reasons and the warnings.

    ``code``, ``place`` and ``help`` are those of the first refusal.
    """

    def __init__(self, text: str, diagnostics: tuple[Diagnostic, ...] = ()) -> None:
        super().__init__(text, diagnostics)
        self.text = text
        self.diagnostics = diagnostics

    def __str__(self) -> str:
        return self.text

    @property
    def reason(self) -> Diagnostic | None:
        """The first refusal; none where only the text is known."""
        return next((diagnostic for diagnostic in self.diagnostics if diagnostic.severity == "refusal"), None)

    @property
    def code(self) -> str:
        """The code of the first refusal."""
        return self.reason.code if self.reason else ""

    @property
    def place(self) -> Place | None:
        """The primary place of the first refusal; none if it is about no file."""
        return self.reason.place if self.reason else None

    @property
    def help(self) -> str | None:
        """The remedy of the first refusal."""
        return self.reason.help if self.reason else None

    def _render_traceback_(self) -> list[str]:
        # Notebooks show what is wrong with the input, and not the calls that found it.
        return [f"{type(self).__name__}: {self}"]


class MissingFileError(FileNotFoundError, DiagnosticError):
    """An input is refused because a file is not there."""

    def __init__(self, text: str, diagnostics: tuple[Diagnostic, ...] = ()) -> None:
        DiagnosticError.__init__(self, text, diagnostics)
        self.errno = errno.ENOENT

    __str__ = DiagnosticError.__str__


class DiagnosticWarning(UserWarning):
    """An input is accepted with a reservation, ``diagnostic``."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic)
        self.diagnostic = diagnostic

    def __str__(self) -> str:
        return str(self.diagnostic)


def parsed(text: str) -> tuple[Diagnostic, ...]:
    """Returns the diagnostics of a JSON list."""

    def one(record: dict[str, Any]) -> Diagnostic:
        places = tuple(Place(**place) for place in record["places"])
        return Diagnostic(record["code"], record["severity"], record["message"], record["help"], places)

    return tuple(one(record) for record in json.loads(text))


def refusal(text: str, diagnostics: str) -> DiagnosticError:
    """Returns the exception for a text and a JSON list; the native module calls this."""
    found = parsed(diagnostics)
    missing = any(one.code == "E0101" and one.message.startswith("there is no file") for one in found)
    return (MissingFileError if missing else DiagnosticError)(text, found)


def warn(text: str, stacklevel: int, *, known: str = "[]") -> None:
    """Warns of the diagnostics of a JSON list, but for those of another."""
    before = {(diagnostic.code, diagnostic.message) for diagnostic in parsed(known)}
    for diagnostic in parsed(text):
        if (diagnostic.code, diagnostic.message) in before:
            continue
        warnings.warn(DiagnosticWarning(diagnostic), stacklevel=stacklevel + 1)
