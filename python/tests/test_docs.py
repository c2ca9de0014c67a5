"""The Python in the documentation runs."""

from __future__ import annotations

import re
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
