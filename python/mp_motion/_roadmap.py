"""Roadmaps that answer many queries."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from . import _mp
from ._arguments import number, whole
from ._errors import Interrupted
from ._mp import Cancel
from ._progress import Progress, reporter
from ._report import Report

if TYPE_CHECKING:
    from ._scene import Scene


class Roadmap:
    """A roadmap of a scene, which answers queries between any two free configurations.

    Queries add no nodes. Each edge is verified at most once, and an edge that fails is blocked for good. Made by
    :meth:`Scene.roadmap`.
    """

    __slots__ = ("_native", "_scene")
    _native: _mp.Roadmap
    _scene: Scene

    @classmethod
    def _from(cls, native: _mp.Roadmap, scene: Scene) -> Roadmap:
        roadmap = cls.__new__(cls)
        roadmap._native, roadmap._scene = native, scene
        return roadmap

    def query(self, start: ArrayLike, goal: ArrayLike, *, cancel: Cancel | None = None) -> Report:
        """Return a path from one configuration to another, finished and verified.

        Parameters
        ----------
        start, goal : array_like, shape (columns,)
            Free configurations.
        cancel : Cancel, optional
            Ends the query when it is cancelled in another thread.

        Returns
        -------
        Report
            Without a path, ``report.why`` says whether more nodes are needed near an end or between.

        Raises
        ------
        Error
            When an end is not free.
        """
        ends = [self._scene._row(q) for q in (start, goal)]
        parts, raised = self._native.query(ends[0], ends[1], cancel)
        report = Report._of(*parts, scene=self._scene)
        if raised is None:
            return report
        if isinstance(raised, KeyboardInterrupt):
            raise Interrupted(report) from raised
        raise raised

    def grow(
        self,
        *,
        time: float | None = None,
        iterations: int | None = None,
        queries: int | None = None,
        nodes: int | None = None,
        progress: bool | Callable[[Progress], object] = False,
        cancel: Cancel | None = None,
    ) -> None:
        """Continue building until a budget is used up. `nodes` includes those that exist.

        Parameters
        ----------
        time : float, optional
            Seconds.
        iterations, queries, nodes : int, optional
            Budgets.
        progress, cancel
            As of :meth:`Scene.plan`.
        """
        wholes = {"iterations": iterations, "queries": queries, "nodes": nodes}
        given = {name: None if value is None else whole(name, value, 1) for name, value in wholes.items()}
        budget = {"time_s": None if time is None else number("time", time, above=0), **given}
        with reporter(progress) as tell:
            self._native.grow(json.dumps(budget), cancel, tell)

    def verify(self) -> int:
        """Verify all edges now, so that queries need not. Returns how many failed and are blocked."""
        return self._native.verify()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write it to a file, with which the option `roadmap` of :meth:`Scene.plan` goes on."""
        self._native.save(os.fspath(file))

    @property
    def nodes(self) -> int:
        """The number of nodes."""
        return self._native.size()[0]

    @property
    def edges(self) -> int:
        """The number of edges that are not blocked."""
        return self._native.size()[1]

    @property
    def components(self) -> int:
        """The number of connected components."""
        return self._native.size()[2]

    def __repr__(self) -> str:
        nodes, edges, components = self._native.size()
        return f"<Roadmap of {self._scene.name}: {nodes} nodes, {edges} edges, {components} components>"
