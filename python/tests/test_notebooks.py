"""The notebooks run from the first cell to the last."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import nbclient
import nbformat
import pytest

FOLDER = Path(__file__).parents[1] / "notebooks"
# Libraries of notebooks have no types.
READ = cast(Callable[..., Any], nbformat.read)  # pyright: ignore[reportUnknownMemberType]
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_it_runs(file: Path, folder: Path) -> None:
    notebook = READ(file, as_version=4)
    # What is kept has no results: they are large, and change with each run.
    assert all(not cell.outputs and cell.execution_count is None for cell in notebook.cells if cell.cell_type == "code")
    client: Any = nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(folder)}})
    client.execute()
    shown: list[Any] = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert not [output for output in shown if output.output_type == "error"]
    if file.stem.startswith("1-"):
        # The scene, the report, and what `show` shows: a page, and a picture where there is no browser.
        frames = [output["data"] for output in shown if "<iframe" in str(output.get("data", {}).get("text/html", ""))]
        assert len(frames) == 3 and all("image/png" in data for data in frames)


def test_there_are_five() -> None:
    assert len(NOTEBOOKS) == 5
