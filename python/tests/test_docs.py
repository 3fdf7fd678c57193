"""The blocks of docs/python.md run one after the other."""

from __future__ import annotations

import re
from typing import Any

import pytest
from conftest import REPOSITORY


def test_blocks_of_the_documentation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(REPOSITORY)
    text = (REPOSITORY / "docs" / "python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert len(blocks) > 5
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert names["machine"].chain == "w C' A' Y' b X Z t"


def test_every_public_name_is_documented() -> None:
    import abbe

    for name in abbe.__all__:
        if name != "__version__":
            assert (getattr(abbe, name).__doc__ or "").strip(), name
