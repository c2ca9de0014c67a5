"""The Python in the documentation runs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r'^```(\w+)(?: title="(.+?)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL)
PAGES = {page: BLOCK.findall(page.read_text()) for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]}
WITH_PYTHON = [page for page, blocks in PAGES.items() if any(language == "python" for language, _, _ in blocks)]


@pytest.mark.parametrize("page", WITH_PYTHON, ids=lambda page: page.stem)
def test_it_runs(page: Path) -> None:
    for language, title, text in PAGES[page]:
        if title:
            Path(title).write_text(text)
        elif language == "python":
            exec(compile(text, page, "exec"), {})


def test_pages_have_some() -> None:
    assert len(WITH_PYTHON) >= 6


def test_samples_pass_all_of_the_museum() -> None:
    museum = ROOT / "docs" / "museum"
    printed = subprocess.run([sys.executable, museum / "sampled.py"], capture_output=True, text=True, check=True).stdout
    assert f"```text\n{printed}```" in (museum / "README.md").read_text()
    for name, verdict in (line.split(": ") for line in printed.splitlines()):
        exhibit = next(part for part in (museum / "README.md").read_text().split("\n## ") if f"mp check {name}.toml" in part)
        assert verdict.endswith("all free") and f"): {verdict}\n" in exhibit
