"""Scenes as pages, pictures and films."""

from __future__ import annotations

import html
import importlib
import json
import os
import sys
import tempfile
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from ._errors import Error
from ._report import Report

if TYPE_CHECKING:
    from ._scene import File, PathRows, Scene

#: Size, mode, camera, moment, seconds.
Wanted: TypeAlias = tuple[tuple[int, int] | None, str | None, str | None, float | None, float | None]
NOTHING: Wanted = (None, None, None, None, None)
#: The picture of a notebook where no page can be shown, as on paper.
SMALL: Wanted = ((720, 480), None, None, None, None)


def content(scene: Scene, file: File, path: PathRows | None, wanted: Wanted) -> bytes:
    """Return the bytes of a file whose kind is that of its ending."""
    file = os.fspath(file)
    kind = scene._native.kind_of_file(file)
    rows = rows_of(scene, path)
    if kind == "path":
        if rows is None:
            raise Error("there is no path to write", remedy="give a path, or a report of a run that was solved")
        return scene._native.path_text(file, rows).encode()
    refuse_own(scene)
    if kind == "view":
        return scene._native.view(file, told(path), rows, 8.0 if wanted[4] is None else wanted[4])
    caption = str(path) if isinstance(path, Report) else ""
    caption = caption.removeprefix(f"{scene.name}: ")
    drawn = scene._native.draw(file, rows, caption, wanted)
    if drawn is None:
        raise Error("the film was cancelled")
    return drawn


def rows_of(scene: Scene, path: PathRows | None) -> Any:
    """Return the configurations of a path; ``None`` where there is none."""
    return None if path is None or (isinstance(path, Report) and path.path is None) else scene._path(path)


def refuse_own(scene: Scene) -> None:
    """Refuse robots that nobody can draw."""
    if scene._robot is not None:
        raise Error("a robot of your own has no picture", remedy="plot `report.path`, or save it as .txt, .csv or .json")


def told(path: PathRows | None) -> str | None:
    """Return a report as JSON, without its paths."""
    if not isinstance(path, Report):
        return None
    members = path.to_dict()
    members["path"] = members["first_path"] = None
    return json.dumps(members)


def save(scene: Scene, file: File, path: PathRows | None, wanted: Wanted) -> None:
    """Write such a file, whole or not at all."""
    scene._native.write(os.fspath(file), content(scene, file, path, wanted))


def show(scene: Scene, path: PathRows | None) -> None:
    """Open the page in the browser, in a notebook below the cell."""
    if in_notebook():
        display: Any = importlib.import_module("IPython.display")
        display.display({"text/html": frame(scene, path), "image/png": content(scene, "x.png", path, SMALL)}, raw=True)
        return
    page = content(scene, "x.html", path, NOTHING)
    # It stays: the browser may read it after this program has ended.
    with tempfile.NamedTemporaryFile(prefix=f"{scene.name}-", suffix=".html", delete=False) as file:
        file.write(page)
    if not webbrowser.open(Path(file.name).as_uri()):
        raise Error(
            "there is no browser here",
            remedy='write a page with scene.save("scene.html", path) or a picture with scene.save("scene.png", path)',
        )


def in_notebook() -> bool:
    """Return whether this is a cell of a notebook, where a browser is already."""
    ipython: Any = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return shell is not None and hasattr(shell, "kernel")


def frame(scene: Scene, path: PathRows | None) -> str:
    """Return the page in a frame, for notebooks."""
    page = content(scene, "x.html", path, NOTHING).decode()
    return (
        f'<iframe title="{html.escape(scene.name)}" srcdoc="{html.escape(page)}" '
        'style="width: 100%; height: 480px; border: 0" sandbox="allow-scripts allow-downloads"></iframe>'
    )
