"""The blocks of docs/python.md, docs/cluster.md and docs/guide-researcher.md run one after the other."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from conftest import REPOSITORY


@pytest.mark.filterwarnings("ignore:.*:DeprecationWarning", "ignore:.*:ResourceWarning")
@pytest.mark.parametrize("document", ["python", "cluster"])
def test_blocks_of_the_documentation(document: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(REPOSITORY)
    text = (REPOSITORY / "docs" / f"{document}.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert len(blocks) > 3
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, f"docs/{document}.md", "exec"), names)
    assert names["machine"].chain == "w C' A' Y' b X Z t"


def test_blocks_of_the_guide_for_researchers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = (REPOSITORY / "docs/guide-researcher.md").read_text(encoding="utf-8")
    for name, content in re.findall(r'^```\w+ title="([^"]+)"\n(.*?)^```$', text, re.MULTILINE | re.DOTALL):
        (tmp_path / name).write_text(content, encoding="utf-8")
    names: dict[str, Any] = {}
    for block in re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        exec(compile(block, "docs/guide-researcher.md", "exec"), names)
    assert names["difference"].shape == (100_000, 3)


def test_every_public_name_is_documented() -> None:
    import abbe

    for name in abbe.__all__:
        if name != "__version__":
            assert (getattr(abbe, name).__doc__ or "").strip(), name
