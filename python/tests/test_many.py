"""Many problems at once."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Iterator
from dataclasses import replace

import pytest

import mp_motion as mp


def queries(count: int) -> Iterator[mp.Scene]:
    """Yield easy problems between points of a walk, of which some are in collision."""
    scene = mp.Scene("easy")
    a, b = scene.start, scene.goals[0]
    for i in range(count):
        yield scene.with_ends(a + (b - a) * (i % 17) / 16, b)


def outcome(result: mp.Report | mp.Error) -> str | None:
    return str(result) if isinstance(result, mp.Error) else result.fingerprint or result.why


def test_results_do_not_depend_on_threads() -> None:
    one = [outcome(r) for r in mp.plan_many(queries(60), threads=1)]
    assert len(one) == 60 and any(o and "collision" in o for o in one)
    assert [outcome(r) for r in mp.plan_many(queries(60), threads=2)] == one
    assert [outcome(r) for r in mp.plan_many(queries(60))] == one


def test_they_are_those_of_plan() -> None:
    scene, options = mp.Scene("maze"), mp.Options("rrt", iterations=20_000)
    prm, arm = mp.Options("prm", nodes=500), mp.Scene("arm")
    results = list(mp.plan_many([scene, (scene, prm), arm], options, seeds=[5, 6]))
    alone = [
        problem.plan_by(replace(how, seed=seed))
        for problem, how in [(scene, options), (scene, prm), (arm, options)]
        for seed in (5, 6)
    ]
    assert [(r.planner, r.seed, r.fingerprint) for r in results if isinstance(r, mp.Report)] == [
        (r.planner, r.seed, r.fingerprint) for r in alone
    ]
    assert results[0]._scene is scene  # type: ignore[union-attr]


def test_problems_are_drawn_as_they_are_needed() -> None:
    drawn = 0

    def endless() -> Iterator[mp.Scene]:
        nonlocal drawn
        scene = mp.Scene("easy")
        while True:
            drawn += 1
            yield scene

    results = mp.plan_many(endless(), mp.Options(iterations=1), threads=2)
    first = next(results)
    assert isinstance(first, mp.Report) and first.stopped_by == "iterations"
    results.close()
    assert drawn < 3000


def test_an_error_while_drawing_comes_after_the_results_before_it() -> None:
    def broken() -> Iterator[mp.Scene]:
        yield from queries(10)
        raise LookupError("the list ends here")

    results = mp.plan_many(broken())
    assert len([next(results) for _ in range(10)]) == 10
    with pytest.raises(LookupError, match="ends here"):
        next(results)
    with pytest.raises(mp.Error, match="no scene"):
        list(mp.plan_many(mp.Scene(name) for name in ["easy", "nowhere"]))
    with pytest.raises(TypeError):
        list(mp.plan_many([1, 2]))  # type: ignore[list-item]
    with pytest.raises(mp.Error, match="0 threads"):
        mp.plan_many([], threads=0)
    assert list(mp.plan_many([])) == []


LONG = mp.Options("rrt-star", time=600, nodes=10**7)


def test_others_cancel_and_what_was_found_is_kept() -> None:
    cancel = mp.Cancel()
    threading.Timer(0.3, cancel.cancel).start()
    results = list(mp.plan_many(mp.Scene("easy"), LONG, seeds=range(1000), threads=2, cancel=cancel))
    # Those that had begun.
    assert 1 <= len(results) <= 2
    assert all(isinstance(r, mp.Report) and r.solved for r in results)


def test_ctrl_c_ends_all_of_it() -> None:
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        list(mp.plan_many(mp.Scene("easy"), LONG, seeds=range(1000), threads=2))
    # It would go on for ten minutes.
    assert time.perf_counter() - began < 60


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory_stays_the_same() -> None:
    # In a process of its own: others have caches that grow.
    script = """
    import mp_motion as mp
    def pages():
        return int(open("/proc/self/statm").read().split()[1])
    scene = mp.Scene("maze")
    before, most = 0, 0
    for i, report in enumerate(mp.plan_many(scene, mp.Options("rrt", iterations=20), seeds=range(12000), threads=2)):
        if i == 3000:
            before = pages()
        most = max(most, pages())
    print((most - before) * 4096)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 6_000_000


def test_a_program_that_leaves_off_in_the_middle_ends() -> None:
    script = """
    import mp_motion as mp
    results = mp.plan_many(mp.Scene("cubicles"), mp.Options("rrt-star", time=600, nodes=10**7), seeds=range(100))
    import threading
    threading.Thread(target=lambda: next(results, None), daemon=True).start()
    import time
    time.sleep(0.3)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
