from __future__ import annotations

import dataclasses
import inspect
import json
import math
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mp_motion as mp
from mp_motion import _mp

from .names import FILE, text

POST = mp.Body(mp.Box(0.2, 1, 4), name="post")


def test_the_names_are_those_of_the_registry() -> None:
    assert text() == FILE.read_text(), "run python python/tests/names.py"


def test_options_have_the_defaults_of_the_engine() -> None:
    scene = mp.Scene("easy")
    assert json.loads(mp.Options().to_json(scene)) == json.loads(_mp.default_request())
    of_plan = inspect.signature(mp.Scene.plan).parameters
    for field in dataclasses.fields(mp.Options):
        assert of_plan[field.name].default == field.default, field.name


def test_poses_are_converted_both_ways() -> None:
    rng = np.random.default_rng(1)
    for _ in range(200):
        rotation, position = Rotation.random(rng=rng), rng.normal(size=3)
        pose = mp.pose_from_rotation(position, rotation)
        matrix = mp.matrix_from_pose(pose)
        assert np.allclose(matrix[:3, :3], rotation.as_matrix()) and np.allclose(matrix[:3, 3], position)
        assert np.allclose(pose[3:], rotation.as_euler("ZYX"))
        assert np.allclose(mp.pose_from_xyz_qxyzw([*position, *rotation.as_quat()]), pose)
        assert np.allclose(mp.matrix_from_pose(mp.pose_from_matrix(matrix)), matrix)
    up = mp.matrix_from_pose([0, 0, 0, 0.3, math.pi / 2, 0.2])
    assert np.allclose(mp.matrix_from_pose(mp.pose_from_matrix(up)), up)


def test_poses_are_those_of_the_engine() -> None:
    scene = mp.Scene("easy")
    row = [0.1, -0.2, 0.3, 0.4, -0.5, 0.6]
    assert np.allclose(scene.poses(row)[0], mp.matrix_from_pose(row))


@pytest.mark.parametrize("pose", [np.eye(3), np.zeros((4, 4)), np.diag([1, 1, -1, 1]), np.diag([2, 2, 2, 1])])
def test_what_is_no_pose_is_refused(pose: np.ndarray) -> None:
    with pytest.raises(mp.Error, match=r"pose|rigid"):
        mp.Scene.rigid(mp.Box(1, 1, 1), pose, pose)


@dataclasses.dataclass
class MeshOfOthers:
    """As those of trimesh are."""

    vertices: Any
    faces: Any


def test_meshes_have_the_same_bits() -> None:
    rng = np.random.default_rng(2)
    vertices = rng.normal(size=(4, 3))
    mesh = mp.Mesh(vertices, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    start, goal = [-9, 0, 0, 0, 0, 0], [9, 0, 0, 1, 0, 0]
    scene = mp.Scene.rigid(mesh, start, goal, [mp.Body(mesh, name="rock")])
    report = scene.plan(seed=4)
    assert report.solved and scene.check(report)
    again = mp.Scene.rigid(mp.Mesh(mesh.vertices, mesh.triangles), start, goal, [mp.Body(mesh, np.eye(4), "rock")])
    assert again.plan(seed=4).fingerprint == report.fingerprint
    other = MeshOfOthers(mesh.vertices, mesh.triangles)
    again = mp.Scene.rigid(other, start, goal, [mp.Body(other, np.eye(4), "rock")])
    assert again.plan(seed=4).fingerprint == report.fingerprint


@pytest.mark.parametrize(
    ("vertices", "triangles"),
    [
        ([[0, 0, 0]], [[0, 0, 1]]),
        ([[0, 0, 0]], [[-1, 0, 0]]),
        ([[0, 0]], [[0, 0, 0]]),
        ([[0, 0, 0]], [[0, 0]]),
        ([[math.nan, 0, 0]] * 3, [[0, 1, 2]]),
        ([[0, 0, 0]] * 3, [[0, 1, 1.5]]),
        ([[0, 0, 0]] * 3, [[0, 1, math.nan]]),
        ([[0, 0, 0]] * 3, [[False, True, True]]),
    ],
)
def test_what_is_no_mesh_is_refused(vertices: list[list[float]], triangles: list[list[float]]) -> None:
    with pytest.raises(mp.Error) as raised:
        mp.Scene.rigid(mp.Mesh(vertices, triangles), [0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0])
    assert raised.value.remedy


def test_shapes_goals_and_bounds() -> None:
    shapes: list[mp.Shape | mp.Body] = [mp.Sphere(0.2), mp.Body(mp.Cylinder(0.1, 1), [0, 1, 0, 0, 0, 0]), POST]
    bounds = [[-2, -2, -2], [2, 2, 2]]
    scene = mp.Scene.rigid(
        mp.Sphere(0.1),
        [-1, 0, 0, 0, 0, 0],
        goals=[{"x": 1.5, "y": (-1, 1)}, [1, 1, 1, 0, 0, 0]],
        obstacles=shapes,
        bounds=bounds,
    )
    assert scene.limits[:3].tolist() == np.transpose(bounds).tolist()
    report = scene.plan(seed=1)
    assert report.path is not None and scene.check(report)
    end = report.path[-1]
    assert abs(end[0] - 1.5) < 1e-6 or np.allclose(end, [1, 1, 1, 0, 0, 0], atol=1e-6)


@pytest.mark.parametrize(
    ("shape", "inside"),
    [
        (mp.Box(1, 1, 1), [0.4, 0, 0]),
        (mp.Capsule(0.3, 1), [0, 0, 0.7]),
        (mp.Cone(0.5, 1), [0, 0, 0.3]),
        (mp.Hull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), [0.2, 0.2, 0.2]),
        (mp.Points([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]], 0.2), [0.5, 0, 0.1]),
        (mp.HeightField([[0, 0, 1], [0, 0, 1]], (0.5, 1)), [0.4, 0, 0.5]),
    ],
)
def test_what_is_inside_of_a_shape_collides(shape: mp.Shape, inside: list[float]) -> None:
    start, goal, bounds = [0, 0, 5, 0, 0, 0], [1, 0, 5, 0, 0, 0], [[-9, -9, -9], [9, 9, 9]]
    scene = mp.Scene.rigid(mp.Sphere(0.01), start, goal, obstacles=[shape], bounds=bounds)
    assert scene.is_free([2, 2, 2, 0, 0, 0]) and not scene.is_free([*inside, 0, 0, 0])
    # As a robot, it has the small ball inside.
    there = [0, 0, 1]
    ball = mp.Body(mp.Sphere(0.01), [*(a + b for a, b in zip(inside, there, strict=True)), 0, 0, 0])
    assert not mp.Scene.rigid(shape, start, goal, obstacles=[ball], bounds=bounds).is_free([*there, 0, 0, 0])


def test_clouds_are_thinned_and_lost_points_left_out() -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform([-0.01, -1, -1], [0.01, 1, 1], (100_000, 3)).astype(np.float32)
    points[::1000] = np.nan
    bounds = [[-2, -2, -2], [2, 2, 2]]
    cloud = mp.Body(mp.Points(points, 0.02, cell=0.02), [0.5, 0, 0, 0, 0, 0], name="scan")
    scene = mp.Scene.rigid(mp.Sphere(0.1), [0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0], obstacles=[cloud], bounds=bounds)
    assert scene.is_free([0.3, 0, 0, 0, 0, 0]) and not scene.is_free([0.45, 0.5, 0.5, 0, 0, 0])
    report = scene.plan(seed=1)
    assert report.path is not None and scene.check(report)
    with pytest.raises(mp.Error, match="none of 2 points has finite coordinates"):
        mp.Scene.rigid(mp.Points([[np.nan] * 3] * 2, 0.1), [0] * 6, [1, 0, 0, 0, 0, 0])


@pytest.mark.parametrize("shape", [mp.Hull([0, 0, 0]), mp.Points([[0, 0], [1, 0]], 0.1), mp.HeightField([1, 2], (1, 1))])
def test_shapes_of_other_arrays_are_refused(shape: mp.Shape) -> None:
    with pytest.raises(mp.Error, match="have the shape"):
        mp.Scene.rigid(shape, [0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0])


def test_arrays_that_are_more_than_their_real_parts_are_refused() -> None:
    scene = mp.Scene("easy")
    ends = np.array([scene.start, scene.goals[0]])
    masked = np.ma.masked_array(ends, mask=[[True] + [False] * 5, [False] * 6])
    ground = mp.HeightField(np.ma.masked_equal([[0.0, -9999.0], [0.0, 0.0]], -9999.0), (1, 1))
    for odd in (masked, ends + 1j, ends > 0):
        with pytest.raises(mp.Error, match=r"masked|metres"):
            scene.check(odd)
        with pytest.raises(mp.Error, match=r"masked|metres"):
            scene.is_free(odd[0])
    with pytest.raises(mp.Error, match="masked"):
        mp.Scene.rigid(mp.Box(1, 1, 1), ends[0], ends[1], obstacles=[ground])
    # Whatever numbers they are of, and wherever they are in memory.
    whole = mp.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.array([[0.0, 1.0, 2.0]])).triangles
    assert whole.tolist() == [[0, 1, 2]]
    path = scene.plan(seed=1).path
    assert path is not None
    for same in (np.asfortranarray(path), np.repeat(path, 2, axis=0)[::2], path[::-1][::-1], path.astype(">f8")):
        assert scene.check(same).clearance == scene.check(path).clearance


def test_worlds_of_the_plane() -> None:
    square = mp.Polygon([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)])
    obstacles: list[mp.Rectangle | mp.Circle | mp.Polygon] = [
        mp.Rectangle((1, 0), (1.2, 1.5)),
        mp.Circle(2, 1.5, 0.3),
        mp.Polygon([(3, 0), (3.2, 0), (3.1, 1)], name="spike"),
    ]
    scene = mp.Scene.plane(square, [0.5, 0.5, 0], [3.5, 0.5, 1], obstacles, walls=[[0, 0], [4, 2]])
    report = scene.plan(seed=1)
    assert report.solved
    assert any("spike" in touch.other for touch in scene.explain([3.1, 0.2, 0]).touching)


def test_images_are_read_as_they_are_seen() -> None:
    dark = np.full((20, 40), 1.0)
    dark[:10, 20] = 0
    scene = mp.Scene.plane(mp.Disc(0.05), [0.5, 1.5], [3.5, 1.5], image=dark, scale=0.1)
    assert not scene.is_free([2.05, 1.5]) and scene.is_free([2.05, 0.5])
    assert (
        mp.Scene.plane(mp.Disc(0.05), [0.5, 1.5], [3.5, 1.5], image=np.uint8(255 * dark), scale=0.1).plan(seed=1).fingerprint
        == scene.plan(seed=1).fingerprint
    )
    for image in (dark > 0, 300 * dark, np.int64(300 * dark), np.zeros((2, 2, 3))):
        with pytest.raises(mp.Error):
            mp.Scene.plane(mp.Disc(0.05), [0.5, 1.5], [3.5, 1.5], image=image, scale=0.1)


URDF = """<robot name="two">
  <link name="base"/><link name="upper"><collision><geometry><box size="0.1 0.1 1"/></geometry>
    <origin xyz="0 0 0.5"/></collision></link>
  <link name="lower"><collision><geometry><box size="0.1 0.1 1"/></geometry><origin xyz="0 0 0.5"/></collision></link>
  <joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="b" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/></joint>
</robot>"""


def test_arms_from_text_and_from_files(folder: Path) -> None:
    table = mp.Body(mp.Box(0.3, 0.3, 0.3), [1.2, 0, 1.2, 0, 0, 0], "table")
    scene = mp.Scene.arm(URDF, [0, 0], [1.2, 0.4], [table], limits={"a": (-1.5, 1.5)})
    assert [c.name for c in scene.columns] == ["a", "b"] and scene.limits.tolist() == [[-1.5, 1.5], [-math.inf, math.inf]]
    report = scene.plan(seed=1)
    assert report.solved
    (folder / "two.urdf").write_text(URDF)
    other = mp.Scene.arm(folder / "two.urdf", [0, 0], [1.2, 0.4], [table], limits={"a": (-1.5, 1.5)})
    assert other.plan(seed=1).fingerprint == report.fingerprint
    free = mp.Scene.arm(URDF, [0, 0], {"a": 1.2}, [table])
    assert free.plan(seed=1).solved
    # The end of the second bar, one metre up and one to the side; then also pointing to the side, by a matrix.
    tip = URDF.replace(
        "</robot>",
        '<link name="tip"/><joint name="c" type="fixed"><parent link="lower"/>'
        '<child link="tip"/><origin xyz="0 0 1"/></joint></robot>',
    )
    reached = mp.Scene.arm(tip, [0, 0], {"link": "tip", "position": [1, 0, 1]}, srdf=False).plan(seed=1)
    assert reached.solved and reached.path is not None
    a, b = reached.path[-1]
    assert np.allclose([math.sin(a) + math.sin(a + b), math.cos(a) + math.cos(a + b)], [1, 1], atol=1e-8)
    pose = np.eye(4)
    pose[:3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    pose[:3, 3] = [1, 0, 1]
    turned = mp.Scene.arm(tip, [0, 0], {"link": "tip", "pose": pose}).plan(seed=1)
    assert turned.path is not None and np.allclose(turned.path[-1], [0, math.pi / 2], atol=1e-8)
    high = mp.Scene.arm(URDF, [0, 0], [1.2, 0.4], base=[0, 0, 5, 0, 0, 0])
    assert np.allclose(high.poses([0, 0])[:, 2, 3].max(), 6)
    floating = mp.Scene.arm(
        URDF,
        [0] * 8,
        [1, 0, 0, 0, 0, 0, 0.1, 0.1],
        floating_within=[[-3] * 3, [3] * 3],
        obstacles=[mp.Body(mp.Box(0.1, 0.1, 0.1), [0.5, 0, 3, 0, 0, 0])],
    )
    assert floating.plan(seed=1).solved


def test_bodies_in_the_plane() -> None:
    post = mp.Body(mp.Box(0.1, 1, 1))
    box, bounds = mp.Box(0.2, 0.2, 0.2), [[-2, -2, -1], [2, 2, 1]]
    flat = mp.Scene.rigid(
        box, [-1, 0, 0, 0.5, 0, 0], mp.matrix_from_pose([1, 0, 0, 0, 0, 0]), [post], planar=True, bounds=bounds
    )
    report = flat.plan(seed=1)
    assert report.path is not None and np.allclose(report.path[[0, -1]], [[-1.0, 0, 0, 0.5, 0, 0], [1.0, 0, 0, 0, 0, 0]])
    assert flat.is_free([-1, 0, 0, 0, 0, 0]) and not flat.is_free([-1, 0, 0.1, 0, 0, 0])
    free = mp.Scene.rigid(box, [-1, 0, 0, 0, 0, 0], goals=[{"x": 1}], planar=True, bounds=bounds)
    assert free.plan(seed=1).solved
    with pytest.raises(mp.Error, match="leaves the plane"):
        mp.Scene.rigid(box, [-1, 0, 0.1, 0, 0, 0], [1, 0, 0, 0, 0, 0], planar=True)
    with pytest.raises(mp.Error, match="leaves the plane"):
        flat.with_ends([-1, 0, 0, 0, 0.1, 0])


SRDF = """<robot name="two"><group name="first"><joint name="a"/></group>
  <group_state name="up" group="first"><joint name="a" value="0.1"/></group_state></robot>"""


def test_arms_of_which_not_all_moves_and_that_carry_something() -> None:
    held = mp.Scene.arm(URDF, {"b": 0.2}, "up", srdf=SRDF, group="first")
    assert [c.name for c in held.columns] == ["a"] and np.allclose(held.goals, [[0.1]])
    also = mp.Scene.arm(URDF, [0], [1], hold={"a": np.float64(0.3)})
    assert [c.name for c in also.columns] == ["b"]
    assert [c.name for c in mp.Scene.arm(URDF, [0], [1], joints=["b"]).columns] == ["b"]
    plank = mp.Attached(mp.Box(0.02, 1, 0.02), "lower", [0, 0, 1.02, 0, 0, 0], "plank", may_touch=["upper"])
    post = mp.Body(mp.Box(0.1, 0.1, 3), [0, 0.4, 2, 0, 0, 0], "post")
    assert mp.Scene.arm(URDF, [0, 0], [1, 0.4], [post]).is_free([0, 0])
    scene = mp.Scene.arm(URDF, [1, 0.4], [1.2, 0.4], [post], attached=[plank])
    assert not scene.is_free([0, 0]) and scene.plan(seed=1).solved
    driving = mp.Scene.arm(URDF, [-1, 0, 0, 0.5, 0], [1, 0, 0, 0.5, 0], [post], planar_within=[[-2, -2], [2, 2]])
    assert [c.name for c in driving.columns] == ["x", "y", "theta", "a", "b"] and driving.plan(seed=1).solved
    with pytest.raises(mp.Error, match="no pose"):
        mp.Scene.arm(URDF, [0] * 5, [1] * 5, base=[0] * 6, planar_within=[[-2, -2], [2, 2]])
    robots = [{"name": "left", "urdf": "two.urdf"}, {"name": "right", "urdf": "two.urdf", "base": [0, 3, 0, 0, 0, 0]}]
    both = mp.Scene.from_dict(
        {"robot": robots, "motion": {"start": [0, 0, 0, 0], "goal": {"left/a": 1, "right/b": 1}}}, files={"two.urdf": URDF}
    )
    assert [c.name for c in both.columns] == ["left/a", "left/b", "right/a", "right/b"]


def test_motions_of_several_parts() -> None:
    scene = mp.Scene("carry")
    assert scene.parts_left == 2
    first = scene.plan(seed=1)
    assert first.path is not None
    second = scene.next_part(first.path[-1])
    assert second is not None and second.parts_left == 1 and np.array_equal(second.start, first.path[-1])
    report = second.plan(seed=1)
    again = pickle.loads(pickle.dumps(second))
    assert again.plan(seed=1).fingerprint == report.fingerprint and again.parts_left == 1
    assert report.path is not None
    third = second.next_part(report.path[-1])
    assert third is not None and third.next_part(third.start) is None
    with pytest.raises(mp.Error):
        scene.next_part([0.0])


@pytest.mark.parametrize("name", ["easy", "arm", "rrs-low", "wrench", "parking", "crossing"])
def test_scenes_and_reports_pickle(name: str) -> None:
    scene = mp.Scene(name)
    report = scene.plan(seed=5, iterations=2000)
    again = pickle.loads(pickle.dumps(scene))
    assert again.plan(seed=5, iterations=2000).fingerprint == report.fingerprint
    read = pickle.loads(pickle.dumps(report))
    assert read.to_json() == report.to_json()
    turned = scene.with_ends(scene.goals[0], scene.start) if name != "parking" else scene
    assert (pickle.loads(pickle.dumps(turned)).start == turned.start).all()


def test_scenes_from_files_pickle_with_their_files(folder: Path) -> None:
    (folder / "sub").mkdir()
    (folder / "two.urdf").write_text(URDF)
    (folder / "sub" / "scene.toml").write_text('[robot]\nurdf = "../two.urdf"\n[motion]\nstart = [0, 0]\ngoal = [1, 1]\n')
    scene = mp.Scene("sub/scene.toml")
    pickled = pickle.dumps(scene)
    made = pickle.dumps(mp.Scene.arm(folder / "two.urdf", [0, 0], [1, 1]))
    (folder / "two.urdf").unlink()
    (folder / "sub" / "scene.toml").unlink()
    assert pickle.loads(pickled).plan(seed=1).fingerprint == scene.plan(seed=1).fingerprint
    assert pickle.loads(made).plan(seed=1).solved
    with pytest.raises(mp.Error, match="no scene"):
        mp.Scene("sub/scene.toml")


def test_errors_say_where_and_what_to_do(folder: Path) -> None:
    with pytest.raises(mp.Error) as raised:
        mp.Scene("cubicels")
    assert "did you mean `cubicles`?" in str(raised.value.remedy)
    (folder / "bad.toml").write_text('[world]\nwalls = [[0, 0], [4, 3]]\n[robot]\ndisc = "big"\n')
    with pytest.raises(mp.Error) as raised:
        mp.Scene("bad.toml")
    error = pickle.loads(pickle.dumps(raised.value))
    assert (error.file, error.line) == ("bad.toml", 4) and str(error) == str(raised.value)
    with pytest.raises(mp.Error, match="rrt-conect"):
        mp.Scene("easy").plan("rrt-conect")
    with pytest.raises(mp.Error, match="stepp"):
        mp.Scene("easy").plan(settings={"stepp": 1})
    blocked = mp.Scene.rigid(mp.Box(0.5, 0.1, 0.1), [0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0], [POST])
    with pytest.raises(mp.Error, match="post") as raised:
        blocked.plan()
    assert "free" in str(raised.value.remedy)
    explained = blocked.explain([0, 0, 0, 0, 0, 0])
    assert not explained and explained.touching[0].other == "post" and explained.nearest_free is not None
    assert blocked.explain(explained.nearest_free).free


def test_no_input_is_overwritten(folder: Path) -> None:
    (folder / "two.urdf").write_text(URDF)
    (folder / "scene.toml").write_text('[robot]\nurdf = "two.urdf"\n[motion]\nstart = [0, 0]\ngoal = [1, 1]\n')
    (folder / "link.png").symlink_to(folder / "two.urdf")
    scene = mp.Scene("scene.toml")
    with pytest.raises(mp.Error, match="file of the scene"):
        scene.save("link.png", scene.plan())
    assert (folder / "two.urdf").read_text() == URDF


def test_what_may_hold_is_shown() -> None:
    scene = mp.Scene("easy")
    assert scene.notes == [] and "touch each other" in scene.lint()[0] and 0.5 < scene.free_share(200) < 1
    assert "backward" in mp.Scene("parking").planners_that_cannot()["rrt-connect"]
    page = scene.plan()._repr_html_()
    assert page is not None and page.startswith("<iframe") and "easy" in page
    picture = scene.plan()._repr_png_()
    assert picture is not None and picture.startswith(b"\x89PNG")
    shortened = scene.shorten(scene.plan(finish="as-found"))
    page = shortened._repr_html_()
    assert page is not None and page.startswith("<iframe") and scene.check(shortened)
    assert pickle.loads(pickle.dumps(shortened))._repr_html_() is None
    assert repr(scene) == "<Scene easy: SE3>" and repr(scene.plan()).startswith("<Report easy: solved")


def test_the_page_is_there_when_the_program_has_ended(folder: Path) -> None:
    script = "import mp_motion as mp; mp.Scene('easy').plan().show()"
    environment = os.environ | {"BROWSER": "echo %s", "TMPDIR": str(folder)}
    done = subprocess.run([sys.executable, "-c", script], env=environment, check=True, capture_output=True, text=True)
    page = Path(unquote(urlparse(done.stdout.strip()).path))
    assert page.parent == folder and page.suffix == ".html" and "<script" in page.read_text()


@pytest.mark.parametrize(
    ("name", "value", "kind"),
    [
        ("seed", 1.9, TypeError),
        ("seed", "1", TypeError),
        ("seed", True, TypeError),
        ("seed", -1, ValueError),
        ("seed", 2**70, ValueError),
        ("threads", -1, ValueError),
        ("threads", 1.5, TypeError),
        ("time", math.nan, ValueError),
        ("time", -1, ValueError),
        ("time", "1", TypeError),
        ("iterations", 1.5, TypeError),
        ("iterations", -3, ValueError),
        ("nodes", True, TypeError),
        ("queries", 0, ValueError),
        ("finish", "shortn", ValueError),
        ("metric", "euclid", ValueError),
        ("motion", "discreet", ValueError),
        ("clearance", math.inf, ValueError),
        ("clearance", -1, ValueError),
        ("first_only", 1, TypeError),
        ("planner", 7, TypeError),
    ],
)
def test_wrong_arguments_are_named(name: str, value: object, kind: type[Exception]) -> None:
    """An error names the argument, and is of the customary kind, before anything is planned."""
    for make in (mp.Options, mp.Scene("easy").plan):
        wrong: Any = {name: value}
        with pytest.raises(kind, match=name) as raised:
            make(**wrong)
        assert "line 1" not in str(raised.value)
        assert isinstance(raised.value, mp.Error) == (kind is ValueError)


def test_errors_are_of_the_customary_kinds(tmp_path: Path) -> None:
    """Errors are also what other libraries raise, and no folder is made."""
    scene = mp.Scene("easy")
    with pytest.raises(ValueError, match="rrtt"):
        scene.plan("rrtt")
    with pytest.raises(FileNotFoundError, match="nowhere"):
        mp.Scene("nowhere")
    broken = tmp_path / "broken.toml"
    broken.write_text("[robot]\nurdf =")
    with pytest.raises(OSError, match="broken") as raised:
        mp.Scene(broken)
    assert isinstance(raised.value, mp.Error)
    assert isinstance(pickle.loads(pickle.dumps(raised.value)), OSError)
    with pytest.raises(FileNotFoundError):
        scene.save(tmp_path / "there" / "scene.html")
    assert not (tmp_path / "there").exists()
    with pytest.raises(TypeError, match="count"):
        scene.routes(1.5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="bound"):
        mp.Space([0], [math.nan])
    assert scene.roadmap("prm").nodes == 2000


def test_paths_are_resampled() -> None:
    """Configurations at equal distances, on the path, and free."""
    scene = mp.Scene("arm")
    report = scene.plan(seed=1)
    assert report.path is not None
    rows = report.resample(200)
    assert rows.shape == (200, 6)
    assert np.array_equal(rows[0], report.path[0])
    assert np.allclose(rows[-1], report.path[-1], atol=1e-12)
    steps = np.linalg.norm(np.diff(rows, axis=0), axis=1)
    assert steps.max() < 1.01 * np.median(steps)
    assert all(scene.is_free(row) for row in rows)
    with pytest.raises(ValueError, match="count"):
        report.resample(1)
    parking = mp.Scene("parking")
    with pytest.raises(mp.Error, match="inputs"):
        parking.resample(np.zeros((2, len(parking.columns))), 5)


def test_paths_of_arms_get_times(tmp_path: Path) -> None:
    scene = mp.Scene("arm-6")
    made = scene.plan().trajectory(velocity=0.5, deviation=0.05)
    assert made.curve == "cubic" and made.clearance > 0 and np.all(np.diff(made.times) > 0)
    assert abs(made.velocities).max() <= 0.5 * 3.1416 and not made.velocities[[0, -1]].any()
    assert any("acceleration" in note for note in made.notes)
    for name in ("t.csv", "t.json", "t.yaml"):
        made.save(tmp_path / name)
        verdict = scene.check_trajectory(tmp_path / name)
        assert verdict and verdict.trajectory is not None, verdict
        assert abs(verdict.trajectory["duration"] - made.duration) < 1e-12
        # Without velocities it is another curve.
        assert scene.check_trajectory(tmp_path / name, curve="linear").trajectory["curve"] == "linear"  # type: ignore[index]
    message = json.loads((tmp_path / "t.json").read_text())
    assert message["joint_names"] == [c.name for c in made.columns]
    # The joints in another order, as others write them.
    order = list(reversed(range(len(made.columns))))
    message["joint_names"] = [message["joint_names"][i] for i in order]
    for point in message["points"]:
        for key in ("positions", "velocities"):
            point[key] = [point[key][i] for i in order]
    (tmp_path / "other.json").write_text(json.dumps({"joint_trajectory": message}))
    assert scene.check_trajectory(tmp_path / "other.json")
    message["joint_names"][0] = "elbow_of_another"
    (tmp_path / "other.json").write_text(json.dumps(message))
    with pytest.raises(mp.Error, match="elbow_of_another"):
        scene.check_trajectory(tmp_path / "other.json")
    assert next(iter(made.to_pandas().columns)) == "time (s)"
    with pytest.raises(mp.Error, match="no trajectories"):
        mp.Scene("easy").plan().trajectory()


#: An arm of one joint, which jerk limits.
SLIDE = """<robot name="slide"><link name="rail"/>
<link name="cart"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
<joint name="x" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""


def test_jerk_is_limited(tmp_path: Path) -> None:
    (tmp_path / "slide.urdf").write_text(SLIDE)
    task = '[robot]\nurdf = "slide.urdf"\nmax_acceleration = 2\nmax_jerk = 5\n[motion]\nstart = [0]\ngoal = [1]\n'
    (tmp_path / "slide.toml").write_text(task)
    scene = mp.Scene(tmp_path / "slide.toml")
    path = [[0.0], [1.0]]
    made = scene.trajectory(path)
    # d / v + v / a + a / j.
    assert made.curve == "quintic" and abs(made.duration - (1 + 0.5 + 0.4)) < 1e-3
    assert made.accelerations.shape == made.positions.shape and scene.trajectory(path, jerk=0.5).duration > made.duration
    assert list(made.to_pandas().columns)[-1] == "x_acceleration (m/s²)"
    made.save(tmp_path / "t.csv")
    assert scene.check_trajectory(tmp_path / "t.csv")


def test_recordings_are_those_of_other_programs(tmp_path: Path) -> None:
    from mcap.reader import make_reader
    from mcap.writer import CompressionType
    from mcap_ros2.reader import read_ros2_messages
    from mcap_ros2.writer import Writer
    from rosbags.typesys import Stores, get_typestore
    from ruamel.yaml import YAML

    scene = mp.Scene("arm-6")
    made = scene.plan().trajectory()
    names = [c.name for c in scene.columns]
    file = tmp_path / "t.mcap"
    made.save(file)
    # By the package that brings the definitions of messages from the file.
    read = [(m.channel.topic, m.ros_msg) for m in read_ros2_messages(str(file))]
    (message,) = [m for topic, m in read if topic == "/joint_trajectory"]
    assert message.joint_names == names
    assert [p.positions for p in message.points] == made.positions.tolist()
    times = [p.time_from_start.sec + p.time_from_start.nanosec / 1e9 for p in message.points]
    assert np.allclose(times, made.times, atol=1e-12, rtol=0)
    states = [m for topic, m in read if topic == "/joint_states"]
    frames = [m for topic, m in read if topic == "/tf"]
    assert len(states) == len(frames) == int(np.ceil(made.duration * 50 - 1e-9)) + 1
    assert states[-1].position == made.positions[-1].tolist()
    # And by one that has its own: the same bytes come back.
    store = get_typestore(Stores.ROS2_HUMBLE)
    with file.open("rb") as opened:
        for schema, _, raw in make_reader(opened).iter_messages():
            assert schema is not None
            decoded = store.deserialize_cdr(raw.data, schema.name)
            assert bytes(store.serialize_cdr(decoded, schema.name)) == raw.data, schema.name
    # The text forms have the members of the message, and no others.
    for name in ("t.json", "t.yaml"):
        made.save(tmp_path / name)
        reader: Any = YAML(typ="safe")
        told = reader.load(tmp_path / name)
        kinds = ["trajectory_msgs/msg/JointTrajectory", "trajectory_msgs/msg/JointTrajectoryPoint", "std_msgs/msg/Header"]
        trajectory, point, head = (store.types[kind] for kind in kinds)
        time, duration = (store.types[f"builtin_interfaces/msg/{kind}"] for kind in ("Time", "Duration"))
        points: Any = [
            point(**{k: duration(**v) if k == "time_from_start" else np.array(v, dtype=np.float64) for k, v in p.items()})
            for p in told["points"]
        ]
        header = head(stamp=time(sec=0, nanosec=0), frame_id="")
        whole = trajectory(header=header, joint_names=told["joint_names"], points=points)
        again: Any = store.deserialize_cdr(store.serialize_cdr(whole, trajectory.__msgtype__), trajectory.__msgtype__)
        assert [p.positions.tolist() for p in again.points] == made.positions.tolist()
    # States of joints as others record them, packed or not, in another order.
    definition = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" + "=" * 80
    definition += "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + "=" * 80
    definition += "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
    for compression in (CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD):
        with (tmp_path / "states.mcap").open("wb") as opened:
            writer: Any = Writer(opened, compression=compression)
            schema_of_states = writer.register_msgdef("sensor_msgs/msg/JointState", definition)
            for state in states:
                nanoseconds = 1_700_000_000_000_000_000 + state.header.stamp.sec * 10**9 + state.header.stamp.nanosec
                stamp = {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}
                body = {"header": {"stamp": stamp, "frame_id": ""}, "name": names[::-1], "position": state.position[::-1]}
                writer.write_message("/joint_states", schema_of_states, {**body, "velocity": [], "effort": []}, nanoseconds)
            writer.finish()
        verdict = scene.check_trajectory(tmp_path / "states.mcap")
        assert verdict.trajectory is not None and verdict.trajectory["collides_at"] is None
        assert verdict.trajectory["curve"] == "linear" and abs(verdict.trajectory["duration"] - made.duration) < 1e-6
