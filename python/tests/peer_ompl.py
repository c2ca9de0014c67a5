"""What is measured of OMPL's wheel, in an environment of its own, and the functions that both sides call.

``bench_engine.py`` runs ``python peer_ompl.py locked``, ``… wall``, ``… cubicles SEED FOLDER`` and
``… shortened SEED PROBLEM``. They need ``ompl`` from PyPI and, for ``cubicles``, ``python-fcl``.
"""

from __future__ import annotations

import importlib
import json
import math
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Counted:
    """A function that counts configurations, and the seconds of processor time that it takes itself."""

    def __init__(self, function: Callable[[Any], Any], many: bool = False) -> None:
        self.function, self.many, self.calls, self.inside = function, many, 0, 0.0

    def __call__(self, q: Any) -> Any:
        """Call the function."""
        self.calls += len(q) if self.many else 1
        began = time.thread_time()
        result = self.function(q)
        self.inside += time.thread_time() - began
        return result


def wall(q: Any) -> bool:
    """Return whether a point passes a wall with a gap, in a square of 4 m."""
    return not (1.9 <= q[0] <= 2.1 and q[1] <= 3)


def arm(q: Any) -> bool:
    """Return whether the joints and the middles of the links of an arm in the plane are outside three discs."""
    x = y = angle = 0.0
    for turn in q:
        angle += turn
        for along in (0.5, 1.0):
            at = x + along * math.cos(angle), y + along * math.sin(angle)
            if any(math.dist(at, disc[:2]) < disc[2] for disc in ((2.5, 2.5, 0.8), (-2.5, 2, 0.7), (0, -3, 0.6))):
                return False
        x, y = x + math.cos(angle), y + math.sin(angle)
    return True


# Own robots: the function, the bounds, the start and the goal.
PROBLEMS: dict[str, tuple[Callable[[Any], bool], list[float], list[float], list[float], list[float]]] = {
    "wall": (wall, [0] * 2, [4] * 2, [1, 1], [3, 1]),
    "arm": (arm, [-3.1] * 6, [3.1] * 6, [0] * 6, [1.57, 0.3, 0.3, 0.3, 0, 0]),
}


class Bodies:
    """Robot and obstacles of an exported scene, as python-fcl has them."""

    def __init__(self, folder: Path, name: str) -> None:
        self.fcl: Any = importlib.import_module("fcl")
        self.problem: dict[str, Any] = json.loads((folder / f"{name}.json").read_text())
        self.robot, self.obstacles = (
            self.fcl.CollisionObject(self._mesh(folder / self.problem[which]["mesh"])) for which in ("robot", "env")
        )
        self.request, self.result = self.fcl.CollisionRequest(), self.fcl.CollisionResult

    def _mesh(self, file: Path) -> Any:
        words = file.read_text().split()
        n, m = int(words[1]), int(words[2])
        vertices = np.array(words[4 : 4 + 3 * n], dtype=np.float64).reshape(n, 3)
        triangles = np.array(words[4 + 3 * n : 4 + 3 * n + 4 * m], dtype=np.int64).reshape(m, 4)[:, 1:]
        model = self.fcl.BVHModel()
        model.beginModel(n, m)
        model.addSubModel(vertices, triangles)
        model.endModel()
        return model

    def is_free(self, position: Any, turn: Any) -> bool:
        """Return whether the robot is free there; `turn` is a matrix or a quaternion, w first."""
        self.robot.setTransform(self.fcl.Transform(turn, position))
        return not self.fcl.collide(self.robot, self.obstacles, self.request, self.result())


def own(problem: str, valid: Any, planner: str) -> Any:
    """Make one of the problems of own robots; without a function nothing is in the way."""
    _, low, high, *ends = PROBLEMS[problem]
    space = ob.RealVectorStateSpace(len(low))
    bounds = ob.RealVectorBounds(len(low))
    for i, (least, most) in enumerate(zip(low, high, strict=True)):
        bounds.setLow(i, least)
        bounds.setHigh(i, most)
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    states = [space.allocState(), space.allocState()]
    for state, end in zip(states, ends, strict=True):
        for i, value in enumerate(end):
            state[i] = value
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(valid if valid is not None else ob.AllValidStateValidityChecker(information))
    setup.setStartAndGoalStates(*states)
    setup.setPlanner(getattr(og, planner)(information))
    return setup


def free_body(bodies: Bodies, valid: Counted) -> Any:
    """Make an exported problem in SE(3), for RRT-Connect with the step and resolution of docs/benchmarks.md."""
    problem = bodies.problem
    space = ob.SE3StateSpace()
    bounds = ob.RealVectorBounds(3)
    for i in range(3):
        bounds.setLow(i, problem["bounds"]["low"][i])
        bounds.setHigh(i, problem["bounds"]["high"][i])
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(valid)
    information.setStateValidityCheckingResolution(problem["resolution_fraction"])
    ends: list[Any] = []
    for end in (problem["start"], problem["goal"]):
        state = space.allocState()
        state.setXYZ(*end["position"])
        for axis in "xyzw":
            setattr(state.rotation(), axis, end["quaternion"][axis])
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    planner = og.RRTConnect(information)
    planner.setRange(0.05 * space.getMaximumExtent())
    setup.setPlanner(planner)
    return setup


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
    seconds, counted = time.perf_counter() - began, count
    over.set()
    thread.join()
    return counted, seconds


def solve_beside_ticks(setup: Any, seconds: float) -> dict[str, Any]:
    """Solve beside a thread that ticks."""
    ended: list[Any] = []
    spent = time.process_time()
    ticks, took = ticks_during(lambda: ended.append(setup.solve(seconds)))
    return {"ticks": ticks, "time_s": took, "processor_s": time.process_time() - spent, "solved": bool(ended[0])}


def main(what: str, seed: str = "1", folder: str = ".") -> None:
    """Measure, and print a line of JSON."""
    ou.RNG.setSeed(int(seed))
    ou.setLogLevel(ou.LOG_ERROR)
    counted = Counted(wall)
    if what == "locked":
        print(json.dumps(solve_beside_ticks(own("wall", None, "RRTstar"), 2.0)))
        return
    if what == "shortened":
        function, low, *_ = PROBLEMS[folder]
        counted = Counted(lambda state: function([state[i] for i in range(len(low))]))
        setup = own(folder, counted, "RRTConnect")
        spent = time.process_time()
        solved = setup.solve(60.0)
        setup.simplifySolution()
        done = {
            "processor_s": time.process_time() - spent,
            "solved": bool(solved),
            "length": setup.getSolutionPath().length(),
            "path": [[state[i] for i in range(len(low))] for state in setup.getSolutionPath().getStates()],
        }
    elif what == "wall":
        done = solve_beside_ticks(own("wall", counted, "RRTstar"), 2.0)
    else:
        bodies = Bodies(Path(folder), "cubicles")

        def free(state: Any) -> bool:
            r = state.rotation()
            return bodies.is_free([state.getX(), state.getY(), state.getZ()], [r.w, r.x, r.y, r.z])

        counted = Counted(free)
        setup = free_body(bodies, counted)
        spent = time.process_time()
        solved = setup.solve(120.0)
        done = {"processor_s": time.process_time() - spent, "solved": bool(solved)}
    print(json.dumps(done | {"calls": counted.calls, "inside_s": counted.inside}))


if __name__ == "__main__":
    ob: Any = importlib.import_module("ompl.base")
    og: Any = importlib.import_module("ompl.geometric")
    ou: Any = importlib.import_module("ompl.util")
    main(*sys.argv[1:])
