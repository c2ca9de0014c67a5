"""What `mp check` says of the trajectories of others: paths of OMPL, timed by toppra and by Ruckig.

Usage: pip install mp-motion ompl toppra ruckig scipy, then: python trajectories.py [SEEDS]
"""

import csv
import math
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

import numpy as np
import toppra
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou
from ruckig import InputParameter, Result, Ruckig
from ruckig import Trajectory as Timed
from toppra import algorithm, constraint

import mp_motion as mp

SCENES = ["arm", "arm-6", "arm-7", "humanoid"]
SEEDS = int(sys.argv[1]) if len(sys.argv) > 1 else 10
RATE = 100
# rad/s and rad/s², of all joints; Ruckig limits jerk too.
VELOCITY, ACCELERATION, JERK = 1.0, 1.0, 20.0

Array = np.ndarray


def planned(scene: mp.Scene) -> Array | None:
    """Plan by RRT-Connect at OMPL's defaults, and simplify: states are judged by `mp`, motions by samples, as OMPL does."""
    joints = len(scene.columns)
    space = ob.RealVectorStateSpace(joints)
    bounds = ob.RealVectorBounds(joints)
    for i, (low, high) in enumerate(scene.limits):
        bounds.setLow(i, low if math.isfinite(low) else -math.pi)
        bounds.setHigh(i, high if math.isfinite(high) else math.pi)
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    row = lambda state: [state[i] for i in range(joints)]  # noqa: E731
    setup.setStateValidityChecker(lambda state: scene.is_free(row(state)))
    start, goal = space.allocState(), space.allocState()
    for i in range(joints):
        start[i], goal[i] = scene.start[i], scene.goals[0][i]
    setup.setStartAndGoalStates(start, goal)
    setup.setPlanner(og.RRTConnect(setup.getSpaceInformation()))
    if not setup.solve(10.0) or not setup.haveExactSolutionPath():
        return None
    setup.simplifySolution()
    return np.array([row(state) for state in setup.getSolutionPath().getStates()])


def by_toppra(path: Array) -> tuple[Array, ...]:
    """Go along the cubic spline through the configurations, as in toppra's examples: times, positions and their derivatives."""
    spline = toppra.SplineInterpolator(np.linspace(0, 1, len(path)), path)
    limit = np.ones((path.shape[1], 1)) * np.array([[-1.0, 1.0]])
    limits = [
        constraint.JointVelocityConstraint(VELOCITY * limit),
        constraint.JointAccelerationConstraint(ACCELERATION * limit),
    ]
    made = algorithm.TOPPRA(limits, spline, parametrizer="ParametrizeConstAccel").compute_trajectory()
    times = np.append(np.arange(0, made.duration, 1 / RATE), made.duration)
    return times, made(times), made(times, 1), made(times, 2)


def by_ruckig(path: Array) -> tuple[Array, ...]:
    """Go from configuration to configuration, at rest at each: all joints end at the same time, not on a straight line."""
    rows: list[list[float]] = []
    begins = 0.0
    for a, b in pairwise(path):
        task = InputParameter(path.shape[1])
        task.current_position, task.target_position = a.tolist(), b.tolist()
        task.max_velocity = [VELOCITY] * len(a)
        task.max_acceleration = [ACCELERATION] * len(a)
        task.max_jerk = [JERK] * len(a)
        made = Timed(path.shape[1])
        if Ruckig(path.shape[1]).calculate(task, made) not in (Result.Working, Result.Finished):
            raise RuntimeError("Ruckig failed")
        times = np.arange(0, made.duration, 1 / RATE)
        # Points that are nearer than a tenth of a period to the end are left out.
        times = times[times < made.duration - 0.1 / RATE]
        for t in times:
            p, v, acceleration = made.at_time(float(t))
            rows.append([begins + t, *p, *v, *acceleration])
        begins += made.duration
    still = [0.0] * path.shape[1]
    rows.append([begins, *path[-1], *still, *still])
    table = np.array(rows)
    joints = path.shape[1]
    return table[:, 0], *(table[:, 1 + k * joints : 1 + (k + 1) * joints] for k in range(3))


def write(file: Path, scene: mp.Scene, times: Array, *kinds: Array) -> None:
    """Write it as others might: joints from the last to the first, degrees, lines of Windows."""
    names = [c.name for c in scene.columns]
    order = list(reversed(range(len(names))))
    header = ["time"]
    for suffix, unit, _ in zip(("", "_velocity", "_acceleration"), ("deg", "deg/s", "deg/s^2"), kinds, strict=False):
        header += [f"{names[i]}{suffix} [{unit}]" for i in order]
    with file.open("w", newline="") as out:
        writer = csv.writer(out, lineterminator="\r\n")
        writer.writerow(header)
        for k, t in enumerate(times):
            writer.writerow([t, *(x for kind in kinds for x in np.degrees(kind[k])[order])])


def told(scene: mp.Scene, file: Path, curve: str = "controller") -> str:
    """Say what `mp check` says."""
    verdict = scene.check_trajectory(file, curve=curve)
    assert verdict.trajectory is not None
    if verdict.trajectory["collides_at"] is not None:
        return "collides"
    faults = [fault for fault in verdict.faults if "beyond its limit" not in fault]
    if faults:
        return faults[0]
    return "free"


def main() -> None:
    """Count what collides."""
    ou.RNG.setSeed(1)
    print(
        f"{'scene':9} {'OMPL paths':>10} {'collide':>8} {'toppra':>7} {'collide':>8} {'Ruckig':>7} {'collide':>8} "
        f"{'mp':>4} {'collide':>8}"
    )
    folder = Path(tempfile.mkdtemp())
    for name in SCENES:
        scene = mp.Scene(name)
        counts = dict.fromkeys(["paths", "hit", "toppra", "toppra hit", "ruckig", "ruckig hit", "own", "own hit"], 0)
        for _ in range(SEEDS):
            path = planned(scene)
            if path is None:
                continue
            counts["paths"] += 1
            # As OMPL prints it, and as columns of another order.
            text = "\n".join(" ".join(map(repr, map(float, row))) for row in path)
            (folder / "p.txt").write_text(text + "\n")
            verdict = scene.check(scene.read_path(folder / "p.txt"))
            free = bool(verdict)
            counts["hit"] += any("hits" in fault for fault in verdict.faults)
            for tool, made in (("toppra", by_toppra), ("ruckig", by_ruckig)):
                write(folder / "t.csv", scene, *made(path))
                counts[tool] += 1
                counts[f"{tool} hit"] += told(scene, folder / "t.csv") == "collides"
            if free:
                scene.trajectory(path).save(folder / "own.csv")
                counts["own"] += 1
                counts["own hit"] += told(scene, folder / "own.csv") == "collides"
        print(
            f"{name:9} {counts['paths']:10} {counts['hit']:8} {counts['toppra']:7} {counts['toppra hit']:8} "
            f"{counts['ruckig']:7} {counts['ruckig hit']:8} {counts['own']:4} {counts['own hit']:8}",
            flush=True,
        )


if __name__ == "__main__":
    main()
