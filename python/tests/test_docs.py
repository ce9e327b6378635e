"""Every example of the documentation and of the package's own texts runs."""

from __future__ import annotations

import doctest
import importlib
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parent.parent.parent / "docs" / "python.md"
ROOT = DOCS.parent.parent


def sections() -> list[tuple[str, str]]:
    """Each section of the document with the Python in it, run as one program."""
    parts = re.split(r"^## (.*)$", DOCS.read_text(), flags=re.M)[1:]
    named = zip(parts[::2], parts[1::2], strict=True)
    found = [
        (name, re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)) for name, text in named
    ]
    return [(name, "\n".join(blocks)) for name, blocks in found if blocks]


@pytest.mark.parametrize(("name", "program"), sections(), ids=[name for name, _ in sections()])
def test_the_documents_examples_run(
    name: str, program: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # What an example names is in the repository, what it writes is not.
    (tmp_path / "sitl").symlink_to(ROOT / "sitl")
    monkeypatch.chdir(tmp_path)
    exec(compile(program, f"{DOCS.name}: {name}", "exec"), {"__name__": "docs"})


def test_the_document_has_examples_of_everything() -> None:
    text = "".join(program for _, program in sections())
    for name in (
        "fly(",
        "Sim(",
        "Plant(",
        "TetherEnv(",
        "TetherVectorEnv(",
        "controller=",
        "estimator=",
        "campaign.run(",
        "tautbench.score(",
    ):
        assert name in text, name


@pytest.mark.parametrize("module", ["tautline", "tautline.sim", "tautline.plant"])
def test_the_packages_own_examples_run(module: str) -> None:
    result = doctest.testmod(importlib.import_module(module))
    assert result.attempted > 0 and result.failed == 0
