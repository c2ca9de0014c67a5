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
from pathlib import Path

import pytest

import mp_motion as mp
from mp_motion import _mp


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
    with pytest.raises(mp.Error, match="`threads` must be 1 or more, not 0"):
        mp.plan_many([], threads=0)
    assert list(mp.plan_many([])) == []


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_a_panic_is_an_exception_after_the_results_before_it(threads: int) -> None:
    results = _mp.panics("on purpose", 5, threads)
    assert [isinstance(next(results), mp.Error) for _ in range(5)] == [True] * 5
    with pytest.raises(mp.InternalError, match="on purpose"):
        next(results)
    assert next(results, None) is None
    assert next(mp.plan_many(mp.Scene("easy")))


LONG = mp.Options("rrt-star", time=600, nodes=10**7)


def test_others_cancel_and_what_was_found_is_kept() -> None:
    cancel = mp.Cancel()

    def drawn() -> Iterator[mp.Scene]:
        # From the moment at which one is begun.
        threading.Timer(1, cancel.cancel).start()
        while True:
            yield scene

    scene = mp.Scene("easy")
    results = list(mp.plan_many(drawn(), LONG, threads=2, cancel=cancel))
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


def in_a_process(work: str) -> subprocess.CompletedProcess[str]:
    """Runs Python code in a process of its own, with a scene of a robot of one's own whose function takes its time."""
    scene = """
    import os, sys, time
    from threading import Thread
    import mp_motion as mp
    def valid(q):
        time.sleep(0.0005)
        return True
    robot = mp.Robot(mp.Space([0, 0], [4, 4]), valid=valid)
    scene = mp.Scene.own(robot, start=[0.5, 2], goal=[3.5, 2])
    options = mp.Options("rrt-star", time=0.5)
    """
    script = textwrap.dedent(scene) + work
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)


@pytest.mark.parametrize(
    "left",
    [
        "results = mp.plan_many([scene] * 9, options, threads=2); next(results)",
        "Thread(target=lambda: list(mp.plan_many([scene] * 9, options)), daemon=True).start()",
        "Thread(target=lambda: [scene.plan('rrt-star', time=0.1) for _ in range(999)], daemon=True).start()",
        "Thread(target=lambda: scene.plan('rrt-star', time=600, threads=2), daemon=True).start()",
    ],
)
def test_functions_of_ones_own_are_not_called_after_the_end(left: str) -> None:
    done = in_a_process(f"{left}\ntime.sleep(0.3)\n")
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_forked_process_has_no_work_of_the_other() -> None:
    # In a process of its own, which forks while it plans. At its end a process waits up to 5 s for work that goes on.
    script = """
    results = mp.plan_many([scene] * 99, options, threads=2)
    next(results)
    begin = time.monotonic()
    for end in ["pass", "results.close()", "next(results)", "list(mp.plan_many([scene], mp.Options(time=1)))"]:
        if os.fork() == 0:
            exec(end)
            sys.exit(7)
        print(os.waitstatus_to_exitcode(os.wait()[1]), flush=True)
    print(time.monotonic() - begin < 4)
    results.close()
    """
    done = in_a_process(textwrap.dedent(script))
    assert done.stdout.split() == ["7", "7", "1", "7", "True"], done
    assert "planned by the process that was forked" in done.stderr


LIST = """{"scene": "easy", "seeds": [3, 1]}
{"scene": "easy", "request": {"budget": {"iterations": 1}}}
{"scene": "easy", "request": {"planner": "no-such-planner"}}
{"scene": "maze", "seeds": {"from": 4, "count": 2}, "request": {"planner": "rrt"}}
"""


def test_results_of_the_program_are_read(program: str, folder: Path) -> None:
    (folder / "list.jsonl").write_text(LIST)
    subprocess.run([program, "many", "list.jsonl", "--out", "r.jsonl"], check=True, capture_output=True)
    results = mp.read_results(folder / "r.jsonl")
    assert results.header["items"] == 6 and repr(results) == "<Results of list.jsonl: shard 1/1 of 6 items>"
    items = list(results)
    assert [item for item, _ in items] == [item for item, _ in results] == list(range(6))
    reports = {item: result for item, result in items if isinstance(result, mp.Report)}
    assert [reports[item].seed for item in (0, 1, 2, 4, 5)] == [3, 1, 1, 4, 5]
    assert reports[2].path is None and reports[2].stopped_by == "iterations"
    error = items[3][1]
    assert isinstance(error, mp.Error) and "no-such-planner" in str(error) and error.remedy
    for item, (name, planner, seed) in {0: ("easy", None, 3), 5: ("maze", "rrt", 5)}.items():
        report, scene = reports[item], mp.Scene(name)
        again = scene.plan(planner, seed=seed)
        assert report.path is not None and again.path is not None and (report.path == again.path).all()
        assert scene.check(report) and report.fingerprint == again.fingerprint

    table = results.to_pandas()
    assert table.index.tolist() == list(range(6)) and table["solved"].tolist() == [True, True, False, None, True, True]
    assert table.loc[5, "planner"] == "rrt" and table.loc[5, "path_length"] == reports[5].path_length
    assert "no-such-planner" in str(table.loc[3, "error"]) and table["error"].count() == 1

    whole = (folder / "r.jsonl").read_bytes()
    lines = whole.splitlines(keepends=True)
    (folder / "cut.jsonl").write_bytes(b"".join(lines[:4]) + lines[4][:20])
    found: list[int] = []
    with pytest.raises(mp.Error, match="it has 3 of 6 items") as raised:
        found.extend(item for item, _ in mp.read_results("cut.jsonl"))
    assert found == [0, 1, 2] and "mp many list.jsonl" in str(raised.value.remedy)
    assert [item for item, _ in mp.read_results("cut.jsonl", partial=True)] == found
    (folder / "bad.jsonl").write_bytes(whole.replace(b'"seed":5', b'"seed":6'))
    with pytest.raises(mp.Error, match="checksum"):
        list(mp.read_results("bad.jsonl"))
    with pytest.raises(mp.Error, match="no file of results"):
        mp.read_results("list.jsonl")
    with pytest.raises(mp.Error, match=r"nowhere\.jsonl"):
        mp.read_results("nowhere.jsonl")
