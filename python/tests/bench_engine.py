"""Measure the package, beside the program ``mp`` and the wheel of OMPL: the section Python of docs/benchmarks.md.

With the package installed, ``MP=target/release/mp python python/tests/bench_engine.py [SECTION …]``. For the figures of OMPL,
give ``OMPL_PYTHON=…/bin/python``: an environment of its own, with ``ompl`` and ``python-fcl`` from PyPI; the latter here too.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import textwrap
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import mp_motion as mp

Array = NDArray[np.float64]
PEER = Path(__file__).with_name("peer_ompl.py")


@cache
def peer() -> Any:
    """Return the functions that both sides call: Python looks for modules where the script is."""
    return importlib.import_module("peer_ompl")


def python(script: str, *arguments: object) -> str:
    """Run a script in a process of its own."""
    command = [sys.executable, "-c", textwrap.dedent(script), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def program(*arguments: object) -> str:
    """Run the program ``mp``."""
    return subprocess.run([os.environ["MP"], *map(str, arguments)], capture_output=True, text=True, check=True).stdout


def ompl(*arguments: object) -> dict[str, Any] | None:
    """Run the script for OMPL's wheel; ``None`` where it is not installed."""
    if "OMPL_PYTHON" not in os.environ:
        return None
    command = [os.environ["OMPL_PYTHON"], str(PEER), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout))


def wall_scene(robot: mp.Robot) -> mp.Scene:
    """Make the problem of the wall with a gap."""
    return mp.Scene.own(robot, [1, 1], [3, 1])


def other_threads() -> None:
    """Count ticks beside two seconds of work."""
    print("## Ticks of another thread, for each second\n")
    square = mp.Space([0, 0], [4, 4])
    own = wall_scene(mp.Robot(square, valid=peer().wall))
    scene = mp.Scene("cubicles")
    large = large_mesh()
    star = mp.Options("rrt-star", time=2, nodes=10**7)
    path = mp.Scene("apartment").plan(seed=1)
    works: dict[str, Callable[[], object]] = {
        "idle": lambda: time.sleep(2),
        "mp: planning in cubicles": lambda: scene.plan_by(star),
        "mp: planning with a function of Python": lambda: own.plan_by(star),
        "mp: loading a mesh of two million triangles": lambda: mp.Scene(large),
        "mp: checking a path of apartment, 20 times": lambda: [mp.Scene("apartment").check(path) for _ in range(20)],
    }
    for name, work in works.items():
        count, seconds = peer().ticks_during(work)
        print(f"{name}: {count / seconds:.0f} ({count} in {seconds:.2f} s)")
    for name, what in {"nothing in the way": "locked", "a function of Python": "wall"}.items():
        if done := ompl(what):
            print(f"OMPL, RRT*, {name}: {done['ticks'] / done['time_s']:.1f} ({done['ticks']} in {done['time_s']:.2f} s)")


def large_mesh() -> Path:
    """Write a scene with hills of two million triangles."""
    folder = Path(tempfile.mkdtemp())
    n = 1000
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    vertices = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y) - 1], axis=2).reshape(-1, 3)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    triangles = np.concatenate([corner[:, None] + [0, 1, n], corner[:, None] + [1, n + 1, n]])
    with (folder / "hills.off").open("w") as file:
        file.write(f"OFF\n{len(vertices)} {len(triangles)} 0\n")
        np.savetxt(file, vertices, fmt="%.6f")
        np.savetxt(file, np.insert(triangles, 0, 3, axis=1), fmt="%d")
    (folder / "hills.toml").write_text(
        "[robot]\nbox = [0.1, 0.1, 0.1]\n[motion]\nstart = [-0.5, 0, 0, 0, 0, 0]\ngoal = [0.5, 0, 0, 0, 0, 0]\n"
        '[[obstacle]]\nmesh = "hills.off"\n'
    )
    return folder / "hills.toml"


def interrupts() -> None:
    """Measure how long a run goes on after Ctrl-C."""
    print("\n## From Ctrl-C to the exception, the longest and the median of 10, ms\n")
    script = """
    import os, signal, sys, threading, time, mp_motion as mp
    late = []
    robot = mp.Robot(mp.Space([0, 0], [4, 4]), valid=lambda q: not (1.9 <= q[0] <= 2.1 and q[1] <= 3))
    own = mp.Scene.own(robot, [1, 1], [3, 1])
    scene = own if sys.argv[1] == "own" else mp.Scene(sys.argv[1])
    options = mp.Options(sys.argv[2], time=600, nodes=10**8)
    for i in range(10):
        def ring():
            global rung
            rung = time.perf_counter()
            os.kill(os.getpid(), signal.SIGINT)
        threading.Timer(0.2 + 0.01 * i, ring).start()
        try:
            if sys.argv[3] == "many": list(mp.plan_many(scene, options, seeds=range(1000)))
            elif sys.argv[3] == "roadmap": scene.roadmap(options)
            else: scene.plan_by(options)
        except KeyboardInterrupt: late.append(time.perf_counter() - rung)
    print(1e3 * max(late), 1e3 * sorted(late)[len(late) // 2], len(late))
    """
    for name, planner, what in [
        ("easy", "rrt-star", "plan"),
        ("cubicles", "rrt-star", "plan"),
        ("arm", "rrt-star", "plan"),
        ("own", "rrt-star", "plan"),
        ("cubicles", "prm-star", "roadmap"),
        ("cubicles", "rrt-star", "many"),
    ]:
        late, median, count = python(script, name, planner, what).split()
        print(f"{what}, {name}, {planner}: {float(late):.0f}, {float(median):.0f} ({count})", flush=True)


def many() -> None:
    """Plan 10,000 problems on one and two threads, short ones, so that what is beside planning shows."""
    print("\n## 10,000 problems\n")
    script = """
    import hashlib, sys, time, mp_motion as mp
    scene, threads = mp.Scene("easy"), int(sys.argv[1])
    a, b = scene.start, scene.goals[0]
    queries = (scene.with_ends(a + (b - a) * (i % 97) / 400, b) for i in range(10_000))
    options = mp.Options("rrt-connect", time=None, iterations=1_000_000, finish="as-found")
    digest, solved, planning, pages = hashlib.sha256(), 0, 0.0, {}
    began, spent = time.perf_counter(), time.process_time()
    for i, r in enumerate(mp.plan_many(queries, options, threads=threads), start=1):
        report = isinstance(r, mp.Report)
        digest.update(str(r.fingerprint if report else r).encode())
        if report:
            solved += r.solved
            planning += sum(stage.time_s for stage in r.stages if stage.stage != "loading")
        if i in (1000, 10_000):
            pages[i] = int(open("/proc/self/statm").read().split()[1]) * 4096 / 1e6
    took, spent = time.perf_counter() - began, time.process_time() - spent
    print(took, spent, planning, solved, *pages.values(), digest.hexdigest())
    """
    digests = set[str]()
    for threads in (1, 2):
        took, spent, planning, solved, early, late, digest = python(script, threads).split()
        digests.add(digest)
        rate, share = 10_000 / float(took), float(planning) / (threads * float(took))
        print(
            f"{threads} threads: {rate:.0f} a second in {float(took):.1f} s, processor {float(spent):.1f} s, "
            f"{100 * share:.1f}% of the threads' time in planning and verifying, {solved} solved, "
            f"memory {float(early):.1f} MB after 1,000, {float(late):.1f} MB after all"
        )
    print("the same bytes" if len(digests) == 1 else "NOT the same bytes")


def beside_the_program() -> None:
    """Plan in cubicles from Python and by the program, in turn."""
    print("\n## RRT-Connect in cubicles, Python beside the program\n")
    script = """
    import sys, mp_motion as mp
    scene = mp.Scene("cubicles")
    print(*(scene.plan("rrt-connect", seed=seed, finish="as-found").time_s for seed in range(1, 41)))
    """
    ours, theirs = np.full(40, np.inf), np.full(40, np.inf)
    for _ in range(15):
        ours = np.minimum(ours, [float(word) for word in python(script).split()])
        run = json.loads(program("plan", "cubicles", "--planner", "rrt-connect", "--runs", 40, "--no-shorten", "--json"))
        theirs = np.minimum(theirs, [one["time_s"] for one in run["runs"]])
    print(f"sums of 40 seeds, each the least of 15: {1e3 * ours.sum():.1f} and {1e3 * theirs.sum():.1f} ms")
    print(f"ratio of the sums {ours.sum() / theirs.sum():.4f}, median of the 40 ratios {np.median(ours / theirs):.4f}")


def callbacks() -> None:
    """Measure the processor time of runs with a validity in Python, per check, beside OMPL's wheel."""
    print("\n## A validity in Python\n")
    print("| problem | | s | checks | µs a check | of it the function | the rest |\n|---|---|---:|---:|---:|---:|---:|")

    def row(problem: str, name: str, seconds: float, calls: int, inside: float) -> None:
        whole, within = 1e6 * seconds / calls, 1e6 * inside / calls
        print(
            f"| {problem} | {name} | {seconds:.2f} | {calls} | {whole:.2f} | {within:.2f} | {whole - within:.2f} |", flush=True
        )

    def valid_many(qs: Array) -> NDArray[np.bool_]:
        return ~((qs[:, 0] >= 1.9) & (qs[:, 0] <= 2.1) & (qs[:, 1] <= 3))

    space = mp.Space([0, 0], [4, 4])
    for name, function in {"valid": peer().wall, "valid_many": valid_many}.items():
        counted = peer().Counted(function, name == "valid_many")
        spent, _ = spent_by(wall_scene(mp.Robot(space, **{name: counted})), "rrt-star", time=2, nodes=10**7)
        row("wall, RRT*", f"mp, `{name}`", spent, counted.calls, counted.inside)
    if done := ompl("wall"):
        row("wall, RRT*", "OMPL", done["processor_s"], done["calls"], done["inside_s"])
    if importlib.util.find_spec("fcl") is not None:
        with_fcl(row)


def spent_by(scene: mp.Scene, planner: str, **options: Any) -> tuple[float, mp.Report]:
    """Plan, and return the seconds of processor time with the report."""
    spent = time.process_time()
    report = scene.plan(planner, finish="as-found", **options)
    return time.process_time() - spent, report


def with_fcl(row: Callable[[str, str, float, int, float], None]) -> None:
    """Plan in cubicles with a validity by python-fcl, on both sides, and without Python."""
    problem, seeds = "cubicles, RRT-Connect, 10 seeds", range(1, 11)
    with tempfile.TemporaryDirectory() as folder:
        program("plan", "cubicles", "--export", folder)
        bodies = peer().Bodies(Path(folder), "cubicles")
        low, high = (bodies.problem["bounds"][end] for end in ("low", "high"))
        half = [np.pi, np.pi / 2, np.pi]
        space = mp.Space([*low, *(-x for x in half)], [*high, *half], periodic=[False] * 3 + [True, False, True])
        shipped = mp.Scene("cubicles")

        def free(q: Array) -> bool:
            matrix = mp.matrix_from_pose(q)
            return bool(bodies.is_free(matrix[:3, 3], matrix[:3, :3]))

        counted, seconds = peer().Counted(free), 0.0
        for seed in seeds:
            scene = mp.Scene.own(mp.Robot(space, valid=counted), shipped.start, shipped.goals[0])
            spent, report = spent_by(scene, "rrt-connect", seed=seed)
            assert report.solved
            seconds += spent
        row(problem, "mp, `valid`, with verifying", seconds, counted.calls, counted.inside)
        runs = [done for seed in seeds if (done := ompl("cubicles", seed, folder))]
        if runs:
            assert all(run["solved"] for run in runs)
            seconds, calls, inside = (sum(run[what] for run in runs) for what in ("processor_s", "calls", "inside_s"))
            row(problem, "OMPL", seconds, int(calls), inside)
        for motion in ("certified", "discrete:1%"):
            both = [spent_by(shipped, "rrt-connect", seed=seed, motion=motion) for seed in seeds]
            seconds, checks = sum(spent for spent, _ in both), sum(report.collision_checks for _, report in both)
            row(problem, f"mp, the scene itself, {motion}, with verifying", seconds, checks, 0.0)


def shortened() -> None:
    """Count how often a function of Python is asked for a short path: by RRT-Connect, shortened; on our side verified too."""
    print("\n## Short paths: calls of the function, milliseconds of processor time, length; median and most of 20 seeds\n")
    print("| problem | | calls | ms | length | that our verifier finds free |\n|---|---|---:|---:|---:|---:|")
    for name, (function, low, high, start, goal) in peer().PROBLEMS.items():
        ours, theirs = list[tuple[float, ...]](), list[tuple[float, ...]]()
        for seed in range(1, 21):
            scene = mp.Scene.own(mp.Robot(mp.Space(low, high), valid=function), start, goal)
            spent = time.process_time()
            report = scene.plan("rrt-connect", seed=seed)
            spent = time.process_time() - spent
            ours.append((report.calls or 0, 1e3 * spent, report.path_length or 0.0, report.solved))
            if done := ompl("shortened", seed, name):
                assert done["solved"]
                theirs.append((done["calls"], 1e3 * done["processor_s"], done["length"], bool(scene.check(done["path"]))))
        for side, rows in {"mp": ours, "OMPL": theirs}.items():
            if rows:
                middle, most = np.median(rows, axis=0), np.max(rows, axis=0)
                cells = (f"{m:.{d}f}, {x:.{d}f}" for m, x, d in zip(middle[:3], most[:3], (0, 0, 2), strict=True))
                print(f"| {name} | {side} | {' | '.join(cells)} | {sum(row[3] for row in rows)} |", flush=True)


SECTIONS = {
    "threads": other_threads,
    "interrupts": interrupts,
    "many": many,
    "program": beside_the_program,
    "callbacks": callbacks,
    "shortened": shortened,
}

if __name__ == "__main__":
    for section in sys.argv[1:] or SECTIONS:
        SECTIONS[section]()
