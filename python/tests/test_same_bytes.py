"""The same bytes as the program gives."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

import mp_motion as mp

# One scene of each kind of robot, with budgets that do not depend on the clock.
KINDS = [
    "easy",
    "gempa-1",
    "maze",
    "rrs-low",
    "arm",
    "wrench",
    "docks",
    "crossing",
    "blade",
    "parking",
    "unicycle",
    "velocities",
    "accelerations",
    "flyer",
    "warehouse",
]
# Times, and what depends on where files are.
UNEQUAL = {"time_s", "finish_s", "stages", "first_s", "path_file", "picture_file", "certificate_file"}


@pytest.mark.parametrize("name", KINDS)
def test_paths_are_those_of_the_program(name: str, program: str, folder: Path) -> None:
    done = subprocess.run(
        [program, "plan", name, "--seed", "3", "--time", "100000", "--iterations", "30000", "--json", "--out", "p.csv"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode in (0, 1), done.stderr
    theirs = json.loads(done.stdout)
    scene = mp.Scene(name)
    report = scene.plan(seed=3, time=100000, iterations=30000)
    ours = json.loads(report.to_json())
    assert {k: v for k, v in ours.items() if k not in UNEQUAL} == {k: v for k, v in theirs.items() if k not in UNEQUAL}
    assert mp.Report.from_json(done.stdout).fingerprint == report.fingerprint
    if report.solved:
        scene.save("ours.csv", report)
        assert (folder / "ours.csv").read_bytes() == (folder / "p.csv").read_bytes()


def test_every_kind_of_scene_is_compared() -> None:
    def kind(name: str) -> str:
        # Arms are of one kind, however many joints they have.
        return re.sub(r"^\d+ joints", "joints", mp.Scene(name).space)

    assert {kind(name) for name in mp.scenes()} == {kind(name) for name in KINDS}


def test_certificates_pictures_and_pages_are_those_of_the_program(program: str, folder: Path) -> None:
    scene = mp.Scene("easy")
    report = scene.plan("rrt-connect", seed=2, sharp_clearance=True)
    scene.save("p.txt", report)
    (folder / "c.json").write_text(scene.certificate(report))
    args = ["plan", "easy", "--planner", "rrt-connect", "--seed", "2", "--out", "q.txt", "--certificate", "d.json"]
    subprocess.run([program, *args], check=True, capture_output=True)
    assert (folder / "p.txt").read_bytes() == (folder / "q.txt").read_bytes()
    assert (folder / "c.json").read_bytes() == (folder / "d.json").read_bytes()
    for file in ("x.html", "x.mpv", "x.glb", "x.png", "x.gif"):
        drawn = {"x.png": ["--size", "320x240"], "x.gif": ["--size", "320x240", "--seconds", "1"]}.get(file, [])
        subprocess.run([program, "render", "easy", "q.txt", "--out", f"their-{file}", *drawn], check=True, capture_output=True)
        assert report.path is not None
        theirs = (folder / f"their-{file}").read_bytes()
        if file.endswith(("mpv", "glb", "html")):
            assert scene.to_bytes(file[2:], report.path) == theirs
        else:
            # Captions differ: the program says how many configurations there are.
            scene.save(file, report.path, size=(320, 240), seconds=1)
            assert abs(len((folder / file).read_bytes()) - len(theirs)) < len(theirs) / 10
