"""Robots of one's own: spaces, checks by functions, their errors."""

from __future__ import annotations

import gc
import pickle
import threading
import time
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import mp_motion as mp

Array = NDArray[np.float64]
# A wall with a gap, in a square of 4 m: the point passes at its upper end.
SPACE = mp.Space([0, 0], [4, 4], names=["x", "y"], units="m")


def free(q: Array) -> bool:
    return not (1.9 <= q[0] <= 2.1 and q[1] <= 3)


def free_many(qs: Array) -> NDArray[np.bool_]:
    return ~((qs[:, 0] >= 1.9) & (qs[:, 0] <= 2.1) & (qs[:, 1] <= 3))


def clearance(q: Array) -> float:
    across = max(1.9 - q[0], q[0] - 2.1, 0.0)
    above = max(q[1] - 3, 0.0)
    return float(np.hypot(across, above))


def displacement(a: Array, b: Array) -> float:
    return float(np.hypot(*(b - a)))


ROBOTS = {
    "valid": mp.Robot(SPACE, valid=free),
    "valid_many": mp.Robot(SPACE, valid_many=free_many),
    "clearance": mp.Robot(SPACE, clearance=clearance, displacement=displacement),
    "all": mp.Robot(
        SPACE, clearance=clearance, displacement=displacement, distance=lambda a, b: float(np.abs(a - b).sum()), verify=free
    ),
}


def scene_of(robot: mp.Robot) -> mp.Scene:
    return mp.Scene.own(robot, [1, 1], [3, 1])


def is_free_between(path: Array, graze: float) -> bool:
    """Look at the path much more finely than the engine does, at a wall that is so much thinner on all sides."""
    steps = np.linspace(0, 1, 2000)[:, None]

    def hits(qs: Array) -> bool:
        x, y = qs.T
        return bool(((x >= 1.9 + graze) & (x <= 2.1 - graze) & (y <= 3 - graze)).any())

    return not any(hits(a + steps * (b - a)) for a, b in pairwise(path))


@pytest.mark.parametrize("which", ROBOTS)
def test_every_planner_that_can_plans(which: str) -> None:
    scene = scene_of(ROBOTS[which])
    cannot = scene.planners_that_cannot()
    solved = 0
    for planner in mp.planners():
        if planner.name in cannot:
            continue
        report = scene.plan(planner.name, seed=1, iterations=300, time=None)
        if report.path is None:
            continue
        solved += 1
        certified = which in ("clearance", "all")
        # Samples are a twentieth of 1% of the extent apart, 2.9 mm: a corner may be cut by half of that.
        assert is_free_between(report.path, 0.0 if certified else 0.0015), planner.name
        assert scene.check(report), planner.name
        assert report.motion == ("certified" if certified else "discrete:1%")
        assert (report.clearance is not None) == certified, planner.name
        assert report.clearance is None or report.clearance <= min(clearance(q) for q in report.path)
    assert solved > 15


def test_one_and_many_give_the_same_path() -> None:
    one, many = (scene_of(ROBOTS[which]).plan(seed=4) for which in ("valid", "valid_many"))
    assert one.fingerprint == many.fingerprint is not None


def test_all_calls_are_reported() -> None:
    calls = 0

    def counted(q: Array) -> bool:
        nonlocal calls
        calls += 1
        return free(q)

    scene = scene_of(mp.Robot(SPACE, valid=counted))
    for seed in (1, 2):
        before = calls
        report = scene.plan(seed=seed)
        assert report.calls == calls - before > report.collision_checks > 0


def test_a_clearance_can_be_an_objective() -> None:
    report = scene_of(ROBOTS["clearance"]).plan(objective="clearance:10:0.5")
    assert report.solved and report.cost is not None and report.path_length is not None
    assert report.path_length < report.cost < 11 * report.path_length
    assert mp.Report.from_json(report.to_json()).cost == report.cost
    with pytest.raises(mp.Error, match=r"the clearance of .* is not known"):
        scene_of(ROBOTS["valid"]).plan(objective="clearance")
    assert mp.Scene("easy").plan().calls is None


def test_each_state_of_the_proof_was_asked_and_few_others() -> None:
    found_free: list[Array] = []
    asked = 0

    def kept(q: Array) -> bool:
        nonlocal asked
        asked += 1
        if free(q):
            found_free.append(q.copy())
        return free(q)

    # A twentieth of a hundredth of the diagonal.
    step = np.hypot(4, 4) / 2000
    others: list[int] = []
    for seed in range(1, 11):
        found_free.clear()
        asked = 0
        report = mp.Scene.own(mp.Robot(SPACE, valid=kept), [1, 1], [3, 1]).plan("rrt-connect", seed=seed)
        assert report.shortened and report.calls == asked
        assert report.path is not None
        states = [report.path[0]]
        for a, b in pairwise(report.path):
            parts = int(np.ceil(np.linalg.norm(b - a) / step))
            states.extend(a + (b - a) * (i / parts) for i in range(1, parts + 1))
        near = np.array(sorted(map(tuple, found_free)))
        for q in states:
            first, last = np.searchsorted(near[:, 0], [q[0] - 1e-8, q[0] + 1e-8])
            assert np.any(np.abs(near[first:last, 1] - q[1]) < 1e-8)
        others.append(asked - len(states) - report.collision_checks)
    # Those of shortening that are none of the proof.
    assert np.mean(others) < 900


def test_no_answer_outlives_a_run() -> None:
    blocked = False
    scene = scene_of(mp.Robot(SPACE, valid=lambda q: free(q) and not (blocked and q[1] > 3)))
    first = scene.plan("rrt-connect", seed=1)
    assert first.solved
    blocked = True
    assert not scene.check(first)
    assert not scene.plan("rrt-connect", seed=1, iterations=50).solved


def test_the_same_on_any_number_of_threads() -> None:
    scene = scene_of(ROBOTS["valid"])
    assert scene.plan("or-rrt", threads=1).fingerprint == scene.plan("or-rrt", threads=3).fingerprint
    alone = [scene.plan(seed=seed).fingerprint for seed in range(6)]
    many = mp.plan_many(scene, seeds=range(6), threads=3)
    assert [r.fingerprint for r in many if isinstance(r, mp.Report)] == alone


def test_periodic_numbers_go_the_shorter_way_around() -> None:
    # A clock's hand, in hours, may not be between 5 and 7.
    space = mp.Space([0, 0], [12, 1], periodic=[True, False], names=["hour", "x"])
    robot = mp.Robot(space, valid=lambda q: not 5 < q[0] < 7)
    scene = mp.Scene.own(robot, [4, 0.5], [8, 0.5])
    report = scene.plan(seed=1)
    assert report.path is not None
    assert np.allclose(report.path[[0, -1]], [[4, 0.5], [8, 0.5]])
    assert (report.path[:, 0] >= 0).all() and (report.path[:, 0] <= 12).all()
    hours = report.path[:, 0]
    assert ((hours <= 5) | (hours >= 7)).all()
    # By way of 12, not of 6.
    assert report.path_length is not None and 8 <= report.path_length < 9
    weighted = mp.Scene.own(mp.Robot(mp.Space([0, 0], [1, 1], weights=[1, 10]), valid=lambda _: True), [0, 0], [0, 1])
    assert weighted.plan().path_length == pytest.approx(10)


def test_what_is_not_free_is_said() -> None:
    scene = mp.Scene.own(ROBOTS["valid"], [1, 1], [2, 1])
    with pytest.raises(mp.Error, match="the goal is in collision") as raised:
        scene.plan()
    assert raised.value.kind == "goal-not-free"
    assert raised.value.remedy is not None and "nearest free" in raised.value.remedy
    scene = scene_of(ROBOTS["clearance"])
    assert scene.explain([2, 1]).nearest_free is not None and not scene.is_free([9, 9])
    with pytest.raises(mp.Error, match="between configurations 1 and 2"):
        scene.shorten([[1, 1], [3, 1]])
    assert "hits" in (fault := scene.check([[1, 1], [3, 1]]).faults[0]) or "comes nearer" in fault
    refuses = mp.Robot(SPACE, valid=free, verify=lambda _: False)
    with pytest.raises(mp.Error, match=r"the start is not free .*: \[1, 1\]"):
        scene_of(refuses).plan()
    with pytest.raises(mp.Error, match="no metric"):
        scene.plan(metric="manhattan")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: mp.Robot(SPACE), "0 are given"),
        (lambda: mp.Robot(SPACE, valid=free, valid_many=free_many), "2 are given"),
        (lambda: mp.Robot(SPACE, clearance=clearance), "belong together"),
        (lambda: scene_of(mp.Robot(mp.Space([0, 0], [1]), valid=free)), "shapes"),
        (lambda: scene_of(mp.Robot(mp.Space([0, 0], [1, 0]), valid=free)), "not below"),
        (lambda: scene_of(mp.Robot(mp.Space([0, 0], [4, 4], names=["x"]), valid=free)), "1 names"),
        (lambda: scene_of(mp.Robot(mp.Space([0, 0], [4, 4], weights=[1, 1, 1]), valid=free)), "do not fit"),
        (lambda: scene_of(mp.Robot(mp.Space([0, 0], [4, 4], weights=-1), valid=free)), "weight"),
        (lambda: scene_of(mp.Robot(SPACE, valid=free, resolution="much")), "resolution"),
        (lambda: scene_of(mp.Robot(SPACE, valid=free, resolution=-1)), "resolution"),
        (lambda: scene_of(mp.Robot(SPACE, clearance=clearance, displacement=displacement, tolerance=-1)).plan(), "toleran"),
        (lambda: mp.Scene.own(ROBOTS["valid"], [1, 1, 1], [3, 1]), "3 numbers"),
        (lambda: mp.Scene.own(ROBOTS["valid"], [1, 1]), "either"),
    ],
)
def test_what_is_given_wrongly_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(mp.Error, match=message):
        make()


def raising(*_: object) -> bool:
    raise LookupError("no map")


@pytest.mark.parametrize(
    ("robot", "error", "message"),
    [
        (mp.Robot(SPACE, valid=raising), LookupError, "no map"),
        (mp.Robot(SPACE, valid=free, verify=raising), LookupError, "no map"),
        (mp.Robot(SPACE, valid=lambda _: None), TypeError, "must return True or False"),  # type: ignore[arg-type, return-value]
        (mp.Robot(SPACE, valid_many=lambda qs: free_many(qs)[:0]), ValueError, "0 truth values"),
        (mp.Robot(SPACE, valid_many=lambda qs: qs), TypeError, "array of truth values"),  # type: ignore[arg-type, return-value]
        (mp.Robot(SPACE, clearance=lambda _: np.nan, displacement=displacement), ValueError, "nan"),
        (mp.Robot(SPACE, clearance=clearance, displacement=lambda a, b: -1.0), ValueError, "not negative"),
        (mp.Robot(SPACE, valid=free, distance=lambda a, b: np.nan), ValueError, "not negative"),
    ],
)
def test_an_error_of_a_function_ends_the_run(robot: mp.Robot, error: type[Exception], message: str) -> None:
    scene = scene_of(robot)
    with pytest.raises(error, match=message):
        scene.plan(time=600)
    # The next run begins anew.
    with pytest.raises(error, match=message):
        list(mp.plan_many(scene, seeds=range(100), threads=2))


def test_an_error_in_the_middle_ends_a_long_run_at_once() -> None:
    calls = 0

    def valid(q: Array) -> bool:
        nonlocal calls
        calls += 1
        if calls == 5000:
            raise LookupError("the map was moved")
        return free(q)

    with pytest.raises(LookupError, match="moved"):
        scene_of(mp.Robot(SPACE, valid=valid)).plan("rrt-star", time=600)
    assert calls == 5000
    with pytest.raises(LookupError, match="moved"):
        calls = 4900
        scene_of(mp.Robot(SPACE, valid=valid)).roadmap(mp.Options("prm", time=600, nodes=10**7))


def test_an_exception_ends_all_work_with_the_robot() -> None:
    # What goes on in another thread cannot know its answer either: it was "not free", or "not solved".
    begun, fail = threading.Barrier(2), threading.Event()

    def valid(q: Array) -> bool:
        if q[0] in (1, 2) and not fail.is_set():
            begun.wait(10)
            if q[0] == 2:
                raise ZeroDivisionError
            fail.wait(10)
        return True

    scene = mp.Scene.own(mp.Robot(mp.Space([0, 0], [4, 4]), valid=valid), start=[0.5, 2], goal=[3.5, 2])
    raised: list[str] = []

    def asked(x: float) -> None:
        try:
            scene.is_free([x, 1])
        except ZeroDivisionError:
            raised.append(str(x))
        fail.set()

    threads = [threading.Thread(target=asked, args=(x,)) for x in (1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(raised) == ["1", "2"]
    # Then all is as before.
    assert scene.is_free([1, 1]) and scene.plan().solved


def test_other_threads_run_between_the_calls() -> None:
    ticks, over = 0, threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not over.wait(0.001):
            ticks += 1

    thread = threading.Thread(target=tick)
    thread.start()
    scene_of(ROBOTS["valid"]).plan("rrt-star", time=0.5)
    over.set()
    thread.join()
    assert ticks > 10


def test_a_run_with_functions_is_cancelled() -> None:
    cancel = mp.Cancel()
    threading.Timer(0.2, cancel.cancel).start()
    began = time.perf_counter()
    scene_of(ROBOTS["valid"]).plan("rrt-star", time=600, cancel=cancel)
    # It would go on for ten minutes.
    assert time.perf_counter() - began < 60


def test_scenes_pickle_if_their_functions_do() -> None:
    scene = scene_of(ROBOTS["valid"])
    again: mp.Scene = pickle.loads(pickle.dumps(scene))
    assert again.plan().fingerprint == scene.plan().fingerprint
    assert scene.with_ends(goal=[3, 2]).goals.tolist() == [[3, 2]]


def test_scenes_have_no_pictures() -> None:
    scene = scene_of(ROBOTS["valid"])
    report = scene.plan()
    with pytest.raises(mp.Error, match="picture"):
        scene.save("scene.png", report)
    scene.save("path.csv", report)
    assert scene.read_path("path.csv").shape == (0 if report.path is None else len(report.path), 2)
    assert repr(report).startswith("<Report") and report._repr_html_() is None
    with pytest.raises(mp.Error, match="certificate"):
        scene.certificate(report)


def test_functions_are_let_go() -> None:
    class Check:
        def __call__(self, q: Array) -> bool:
            return free(q)

    import weakref

    check = Check()
    alive = weakref.ref(check)
    report = scene_of(mp.Robot(SPACE, valid=check)).plan()
    del check, report
    gc.collect()
    assert alive() is None
