"""Measure the package, beside the program ``mp`` and the wheel of OMPL: the Python section of docs/benchmarks.md.

With the package installed, ``MP=target/release/mp python python/tests/bench_engine.py``. With ``ompl`` from PyPI installed, its
figures are beside ours.
"""

from __future__ import annotations

import importlib.util
import json
import os
import statistics
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import mp_motion as mp

Array = NDArray[np.float64]
HAS_OMPL = importlib.util.find_spec("ompl") is not None


def ticks_during(work: Callable[[], object]) -> tuple[int, float]:
    """Count how often a thread that sleeps for a millisecond at a time wakes up, and the seconds."""
    count, over = 0, threading.Event()

    def tick() -> None:
        nonlocal count
        while not over.wait(0.001):
            count += 1

    thread = threading.Thread(target=tick)
    thread.start()
    began = time.perf_counter()
    work()
    seconds = time.perf_counter() - began
    over.set()
    thread.join()
    return count, seconds


OMPL = """
import sys, time, threading
from ompl import base as ob, geometric as og

calls = 0
def valid(q):
    global calls
    calls += 1
    return not (1.9 <= q[0] <= 2.1 and q[1] <= 3)

def solve(seconds, goal, planner):
    space = ob.RealVectorStateSpace(2)
    bounds = ob.RealVectorBounds(2); bounds.setLow(0); bounds.setHigh(4)
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    setup.setStateValidityChecker(ob.StateValidityCheckerFn(valid) if hasattr(ob, "StateValidityCheckerFn") else valid)
    start, end = space.allocState(), space.allocState()
    start[0], start[1], end[0], end[1] = 1, 1, *goal
    setup.setStartAndGoalStates(start, end) if hasattr(setup, "setStartAndGoalStates") else None
    setup.setPlanner(getattr(og, planner)(setup.getSpaceInformation()))
    began = time.perf_counter()
    setup.solve(seconds)
    return time.perf_counter() - began
"""


def other_threads() -> None:
    """Count ticks beside a plan of two seconds."""
    print("## Ticks of another thread in 2 s\n")
    scene = mp.Scene("cubicles")
    idle, _ = ticks_during(lambda: time.sleep(2))
    ours, took = ticks_during(lambda: scene.plan("rrt-star", time=2, nodes=10**7))
    print(f"idle {idle}, mp {ours} in {took:.2f} s")


def interrupts() -> None:
    """Measure how long a run goes on after Ctrl-C."""
    print("\n## From Ctrl-C to the exception\n")
    script = """
    import os, signal, threading, time, mp_motion as mp
    scene, late = mp.Scene(NAME), []
    for _ in range(10):
        def ring():
            global rung
            rung = time.perf_counter()
            os.kill(os.getpid(), signal.SIGINT)
        threading.Timer(0.3, ring).start()
        try: scene.plan(PLANNER, time=600, nodes=10**8)
        except KeyboardInterrupt: late.append(time.perf_counter() - rung)
    print(1e3 * max(late))
    """
    for name, planner in [("easy", "rrt-star"), ("cubicles", "rrt-star"), ("arm", "rrt-star"), ("cubicles", "prm-star")]:
        code = textwrap.dedent(script).replace("NAME", repr(name)).replace("PLANNER", repr(planner))
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        print(f"{name}, {planner}: at most {float(done.stdout):.0f} ms of 10")


def many() -> None:
    """Plan 10,000 problems on one and two threads."""
    print("\n## 10,000 problems\n")
    script = """
    import hashlib, os, resource, sys, time, mp_motion as mp
    scene, threads = mp.Scene("easy"), int(sys.argv[1])
    a, b = scene.start, scene.goals[0]
    queries = (scene.with_ends(a + (b - a) * (i % 97) / 400, b) for i in range(10_000))
    digest, solved, pages = hashlib.sha256(), 0, []
    began, spent = time.perf_counter(), time.process_time()
    for i, r in enumerate(mp.plan_many(queries, threads=threads)):
        digest.update(str(r if isinstance(r, mp.Error) else r.fingerprint).encode())
        solved += isinstance(r, mp.Report) and r.solved
        if i in (2000, 9999):
            pages.append(int(open("/proc/self/statm").read().split()[1]) * 4096 / 1e6)
    took, spent = time.perf_counter() - began, time.process_time() - spent
    print(took, spent, solved, pages[0], pages[1], digest.hexdigest())
    """
    digests = set[str]()
    for threads in (1, 2):
        done = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(script), str(threads)], capture_output=True, text=True, check=True
        )
        took, spent, solved, early, late, digest = done.stdout.split()
        digests.add(digest)
        rate, busy = 10_000 / float(took), float(spent) / (threads * float(took))
        print(
            f"{threads} threads: {rate:.0f} a second, {100 * busy:.0f}% of the cores' time, {solved} solved, "
            f"memory {float(early):.0f} → {float(late):.0f} MB"
        )
    print("the same bytes" if len(digests) == 1 else "NOT the same bytes")


def program() -> None:
    """Plan in cubicles from Python and by the program, in turn."""
    print("\n## RRT-Connect in cubicles, Python : program\n")
    scene = mp.Scene("cubicles")
    ratios: list[float] = []
    ours: list[float] = []
    theirs: list[float] = []
    for seed in range(1, 41):
        a = scene.plan("rrt-connect", seed=seed, finish="as-found").time_s
        done = subprocess.run(
            [os.environ["MP"], "plan", "cubicles", "--planner", "rrt-connect", "--seed", str(seed), "--no-shorten", "--json"],
            capture_output=True,
            text=True,
            check=True,
        )
        b = json.loads(done.stdout)["time_s"]
        ratios.append(a / b)
        ours.append(a)
        theirs.append(b)
    print(
        f"median of 40 pairs {statistics.median(ratios):.3f} "
        f"({1e3 * statistics.median(ours):.1f} and {1e3 * statistics.median(theirs):.1f} ms)"
    )


def callbacks() -> None:
    """Measure a run with a validity in Python, per check, beside OMPL's wheel."""
    print("\n## A validity in Python, microseconds for each check\n")
    calls = 0

    def valid(q: Array) -> bool:
        nonlocal calls
        calls += 1
        return not (1.9 <= q[0] <= 2.1 and q[1] <= 3)

    def valid_many(qs: Array) -> NDArray[np.bool_]:
        nonlocal calls
        calls += len(qs)
        return ~((qs[:, 0] >= 1.9) & (qs[:, 0] <= 2.1) & (qs[:, 1] <= 3))

    q = np.array([1.0, 1.0])
    began = time.perf_counter()
    for _ in range(100_000):
        valid(q)
    print(f"the function alone: {10 * (time.perf_counter() - began):.2f}")
    space = mp.Space([0, 0], [4, 4])
    for name, robot in {
        "valid": mp.Robot(space, valid=valid),
        "valid_many": mp.Robot(space, valid_many=valid_many),
    }.items():
        calls = 0
        report = mp.Scene.own(robot, [1, 1], [3, 1]).plan(
            "rrt", iterations=20_000, finish="as-found", settings={"step": "0.02"}
        )
        whole = mp.Scene.own(robot, [1, 1], [3, 1]).plan("rrt-star", time=2, finish="as-found")
        print(
            f"{name}: rrt {1e6 * report.time_s / report.collision_checks:.2f}, "
            f"rrt-star {1e6 * whole.time_s / whole.collision_checks:.2f}"
        )
    if not HAS_OMPL:
        print("OMPL's wheel is not installed: pip install ompl")
        return
    script = OMPL + "\ntook = solve(2, (3, 1), 'RRTstar')\nprint(took, calls)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        print(done.stderr[-400:])
        return
    took, count = done.stdout.split()[-2:]
    print(f"OMPL, RRTstar: {1e6 * float(took) / int(count):.2f}")


if __name__ == "__main__":
    other_threads()
    interrupts()
    many()
    program()
    callbacks()
