"""Many problems at once."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from dataclasses import replace
from typing import TypeAlias

from . import _mp
from ._arguments import whole
from ._errors import Error
from ._mp import Cancel
from ._report import Report
from ._scene import Options, Scene

#: A scene, alone or with options of its own.
Problem: TypeAlias = Scene | tuple[Scene, Options]


def plan_many(
    problems: Iterable[Problem] | Scene,
    options: Options | None = None,
    *,
    seeds: Iterable[int] | None = None,
    threads: int | None = None,
    cancel: Cancel | None = None,
) -> Generator[Report | Error, None, None]:
    """Plan many problems on all cores, and yield their results in order.

    Problems are drawn as they are needed, results are yielded as soon as those before them are: memory does not grow with their
    number. Results are the same for any number of threads, to the bit, as long as no budget of time ends a run.

    Parameters
    ----------
    problems : iterable of Scene or (Scene, Options), or Scene
        Scenes; for queries in one scene, ``(scene.with_ends(a, b) for a, b in queries)``. Drawn in a thread of the engine.
    options : Options, optional
        How to plan where a problem has no options of its own.
    seeds : iterable of int, optional
        Each problem is planned with each of these seeds, one after the other.
    threads : int, optional
        How many problems are planned at a time: by default as many as there are cores.
    cancel : Cancel, optional
        When it is cancelled no further problem begins, and those that have begun end soon.

    Yields
    ------
    Report or Error
        A problem that cannot be planned, as its start is in collision, gives an error, which is not raised.

    Raises
    ------
    Exception
        That of `problems`, or of a function of a robot of yours, after the results before it.

    Examples
    --------
    >>> scene = mp.Scene("easy")
    >>> [report.seed for report in mp.plan_many(scene, seeds=range(1, 5)) if report.solved]
    [1, 2, 3, 4]
    >>> queries = [(scene.start, scene.goals[0]), (scene.goals[0], scene.start)]
    >>> results = mp.plan_many(scene.with_ends(a, b) for a, b in queries)
    >>> [isinstance(result, mp.Report) and result.solved for result in results]
    [True, True]
    """
    if threads is None:
        threads = os.cpu_count() or 1
    whole("threads", threads, 1)
    given = [problems] if isinstance(problems, Scene) else problems
    return _results(given, options or Options(), None if seeds is None else list(seeds), threads, cancel)


def _results(
    problems: Iterable[Problem], options: Options, seeds: list[int] | None, threads: int, cancel: Cancel | None
) -> Generator[Report | Error, None, None]:
    # The scenes of results to come.
    scenes = deque[Scene]()

    def draw() -> Iterator[tuple[_mp.Scene, str]]:
        for problem in problems:
            scene, how = problem if isinstance(problem, tuple) else (problem, options)
            if not isinstance(scene, Scene):  # pyright: ignore[reportUnnecessaryIsInstance]
                raise TypeError(f"a problem is a Scene or (Scene, Options), not {type(scene).__name__}")
            for seed in [how.seed] if seeds is None else seeds:
                scenes.append(scene)
                yield scene._native, replace(how, seed=seed).to_json(scene)

    native = _mp.Many(draw(), threads, cancel)
    try:
        for result in native:
            scene = scenes.popleft()
            yield result if isinstance(result, Error) else Report._of(*result, scene=scene)
    finally:
        native.close()
