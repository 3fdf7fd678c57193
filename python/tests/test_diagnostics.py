"""Refusals and warnings."""

from __future__ import annotations

import pickle
import warnings

import pytest

import abbe

WRONG = """abbe: 1
machine: Gantry
chain: w b X Y t
axes: { X: { travle: [0, 400] }, Y: { travel: [0, 300] } }
errors: { EC0Y: 10 }
"""


def test_refusal_has_all_faults_with_places() -> None:
    with pytest.raises(abbe.DiagnosticError) as refused:
        abbe.loads(WRONG)
    failure = refused.value
    assert isinstance(failure, ValueError)
    by_code = {diagnostic.code: diagnostic for diagnostic in failure.diagnostics}
    unknown = by_code["E0201"]
    assert (unknown.severity, unknown.help) == ("refusal", "did you mean `travel`?")
    place = unknown.place
    assert place is not None
    assert (place.file, place.line, place.column, place.end_column) == ("machine.yaml", 4, 14, 20)
    assert len(by_code) == 2 and failure.reason in failure.diagnostics
    first = by_code[failure.code]
    assert (failure.place, failure.help) == (first.place, first.help)
    # What is lacking in the file has no place; a file that is not there no text either.
    with pytest.raises(abbe.DiagnosticError) as refused:
        abbe.load("nowhere.yaml")
    assert refused.value.place is None and refused.value.help


def test_text_is_what_the_program_prints() -> None:
    with pytest.raises(abbe.DiagnosticError) as refused:
        abbe.loads(WRONG)
    text = str(refused.value)
    assert text.startswith("refused[E0201]: unknown key `travle` in `axes.X`\n --> machine.yaml:4:14\n")
    assert "4 | axes: { X: { travle: [0, 400] }" in text and text.endswith("2 mistakes")


def test_refusals_pickle() -> None:
    with pytest.raises(abbe.DiagnosticError) as refused:
        abbe.loads(WRONG)
    restored = pickle.loads(pickle.dumps(refused.value))
    assert (str(restored), restored.diagnostics) == (str(refused.value), refused.value.diagnostics)


def test_options_are_refused_with_their_name() -> None:
    machine = abbe.loads(abbe.starter())
    with pytest.raises(abbe.DiagnosticError, match="option `poses`: unknown value `randm`, expected") as refused:
        machine.map(poses={"randm": 5})  # type: ignore[arg-type]
    assert refused.value.code == "E0818" and "help(abbe.Machine)" in (refused.value.diagnostics[0].help or "")
    with pytest.raises(abbe.DiagnosticError, match=r"option `samples`: .*, expected a whole number"):
        machine.map(samples="many")  # type: ignore[arg-type]
    with pytest.raises(abbe.DiagnosticError, match=r"option `fit`: .*, expected a list") as refused:
        machine.plan(fit="location")
    # Lines and columns of the JSON that nobody wrote, and types of Rust, name nothing in a notebook.
    assert not any(word in str(refused.value) for word in ("line 1", "sequence", "usize"))
    for length in ("30", "30 lbs"):
        with pytest.raises(abbe.DiagnosticError, match="such as `30 um`"):
            machine.goal(length)
    with pytest.raises(TypeError, match="with its unit"):
        machine.goal(30)  # type: ignore[arg-type]
    with pytest.raises(abbe.DiagnosticError, match="there are 2000000000 poses; a map takes 1000000000"):
        machine.map(poses={"random": 2_000_000_000})
    with pytest.raises(TypeError):
        machine.map(sample=3)  # type: ignore[call-arg]
    with pytest.raises(abbe.DiagnosticError) as missing:
        abbe.load("nowhere.yaml")
    assert "nowhere.yaml" in str(missing.value)
    with pytest.raises(FileNotFoundError):
        machine.map(poses={"tool_poses": "nowhere.csv"})
    assert pickle.loads(pickle.dumps(missing.value)).code == missing.value.code
    assert missing.value._render_traceback_() == [f"MissingFileError: {missing.value}"]


def test_warnings_name_the_caller() -> None:
    text = "machine: G\nchain: w b X t\naxes: { X: { travel: [0, 9] } }"
    with pytest.warns(abbe.DiagnosticWarning, match="W0201") as caught:
        machine = abbe.loads(text)
    assert caught[0].filename == __file__
    warning = caught[0].message
    assert isinstance(warning, abbe.DiagnosticWarning)
    assert (warning.diagnostic.code, warning.diagnostic.severity) == ("W0201", "warning")
    with pytest.warns(abbe.DiagnosticWarning, match="W0801: poses beyond the travel of `X`") as caught:
        machine.eval(at=["X=20"])
    assert caught[0].filename == __file__ and len(caught) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error", abbe.DiagnosticWarning)
        with pytest.raises(abbe.DiagnosticWarning):
            machine.eval(at=["X=20"])


def test_check_refuses_nothing(tmp_path: object) -> None:
    (entry,) = abbe.check("nowhere.yaml")
    assert entry["refused"] and entry["file"] == "nowhere.yaml"
