"""Reports of progress."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from ._errors import Error


@dataclass(frozen=True)
class Progress:
    """What a run has done so far.

    Attributes
    ----------
    stage : str
        ``planning``, ``relaxing`` or ``finishing``.
    iterations, nodes, motions, rejected : int
        Counts of the search.
    length : float or None
        The length of the best path found, in the metric of the space.
    """

    stage: str
    iterations: int
    nodes: int
    motions: int
    rejected: int
    length: float | None


@contextmanager
def reporter(
    progress: bool | Callable[[Progress], object],
) -> Generator[Callable[[dict[str, Any]], object] | None]:
    """Return what the native half calls."""
    if callable(progress):
        told = progress
        yield lambda members: told(Progress(**members))
        return
    if not progress:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError as e:
        raise Error("progress=True needs tqdm", remedy="pip install tqdm, or give a function") from e
    with tqdm(unit=" iterations") as bar:

        def tell(members: dict[str, Any]) -> None:
            bar.update(members["iterations"] - bar.n)
            length = "" if members["length"] is None else f", length {members['length']:.4g}"
            bar.set_description_str(members["stage"], refresh=False)
            bar.set_postfix_str(f"{members['nodes']} nodes{length}")

        yield tell
