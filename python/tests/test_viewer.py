"""The page that stays open."""

from __future__ import annotations

import http.client
import json
import threading
import time
import urllib.request
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.error import HTTPError
from urllib.parse import urlsplit

import pytest

import mp_motion as mp
from mp_motion._viewer import Page

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture
def scene() -> mp.Scene:
    return mp.Scene("easy")


@pytest.fixture
def viewer(scene: mp.Scene) -> Iterator[mp.Viewer]:
    with scene.view(open=False) as viewer:
        yield viewer


class Tab:
    """A tab of a browser that shows the page."""

    def __init__(self, viewer: mp.Viewer) -> None:
        parts = urlsplit(viewer.address)
        self.connection = http.client.HTTPConnection(parts.netloc, timeout=60)
        self.connection.request("GET", f"{parts.path}shown")
        self.stream = self.connection.getresponse()
        assert self.stream.status == 200

    def next(self) -> dict[str, Any] | None:
        """Return the head of the next message; ``None`` at the end."""
        while True:
            length = self.stream.read(4)
            if not length:
                return None
            message = self.stream.read(int.from_bytes(length, "little"))
            if message:
                assert message[:4] == b"MPV1"
                end = 8 + int.from_bytes(message[4:8], "little")
                head: dict[str, Any] = json.loads(message[8:end])
                return head

    def path(self) -> tuple[str, bool, int]:
        """Return the name of the next path, whether it is free, and how many numbers its configurations are."""
        message = self.next()
        assert message is not None
        path = message["path"]
        return path["name"], path["verified"], path["rows"]["count"]

    def close(self) -> None:
        self.stream.close()
        self.connection.close()


def refused(address: str, host: str | None = None) -> int:
    request = urllib.request.Request(address, headers={} if host is None else {"Host": host})
    with pytest.raises(HTTPError) as error:
        urllib.request.urlopen(request, timeout=60)
    error.value.close()
    return error.value.code


def test_a_page_shows_what_it_is_given(scene: mp.Scene, viewer: mp.Viewer) -> None:
    with urllib.request.urlopen(viewer.address, timeout=60) as answer:
        page = answer.read().decode()
    assert 'name="mp-session" content="shown"' in page and 'id="scene"' in page
    tab = Tab(viewer)
    report = scene.plan("rrt-connect", seed=1)
    viewer.show(report, name="first")
    name, verified, numbers = tab.path()
    assert report.path is not None
    assert (name, verified) == ("first", True) and numbers >= report.path.size
    start = scene.start
    viewer.move(start)
    assert tab.path() == ("configuration", True, len(start))
    # Straight through the wall.
    viewer.show([start, scene.goals[0]])
    assert tab.path()[:2] == ("path", False)
    # A tab that is opened later shows all of it, the last one last.
    viewer.show(report, name="first")
    assert tab.path()[0] == "first"
    late = Tab(viewer)
    assert [late.path()[0] for _ in range(3)] == ["configuration", "path", "first"]
    for each in (tab, late):
        each.close()


def test_of_many_moves_a_slow_page_gets_the_newest(scene: mp.Scene, viewer: mp.Viewer) -> None:
    rows = scene.plan("rrt-connect", seed=1).resample(300)
    tab = Tab(viewer)
    viewer.show(rows, name="last")
    for row in rows:
        viewer.move(row)
    seen = 0
    viewer.show(rows[-1:], name="end")
    while tab.path()[0] != "end":
        seen += 1
    assert 0 < seen <= len(rows) + 1
    tab.close()


def test_waiting_ends_when_no_tab_is_left(viewer: mp.Viewer) -> None:
    waiting = threading.Thread(target=viewer.wait)
    waiting.start()
    waiting.join(0.5)
    assert waiting.is_alive()
    tabs = [Tab(viewer), Tab(viewer)]
    tabs[0].close()
    waiting.join(0.5)
    assert waiting.is_alive()
    tabs[1].close()
    waiting.join(60)
    assert not waiting.is_alive()


def test_a_page_is_told_of_the_end(scene: mp.Scene) -> None:
    viewer = scene.view(scene.plan("rrt-connect", seed=1), open=False)
    tab = Tab(viewer)
    viewer.close()
    assert tab.next() is None
    with pytest.raises(mp.Error, match="the viewer is closed"):
        viewer.move(scene.start)
    with pytest.raises(mp.Error, match="the viewer is closed"):
        viewer.show([scene.start])
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(viewer.address, timeout=60)


def test_nobody_else_sees_the_scene(viewer: mp.Viewer) -> None:
    parts = urlsplit(viewer.address)
    origin = f"http://{parts.netloc}"
    assert parts.hostname == "127.0.0.1"
    assert refused(f"{origin}/") == 403
    assert refused(f"{origin}/{'x' * 32}/shown") == 403
    assert refused(viewer.address, host=f"somewhere.example:{parts.port}") == 403
    assert refused(f"{viewer.address}elsewhere") == 404


def test_the_browser_is_given_an_address_that_works_once(scene: mp.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []

    def browser(address: str) -> bool:
        opened.append(address)
        return True

    monkeypatch.setattr("webbrowser.open", browser)
    with scene.view() as viewer:
        assert viewer.address not in opened
        with urllib.request.urlopen(opened[0], timeout=60) as answer:
            assert answer.url == viewer.address
        assert refused(opened[0]) == 403


def test_without_a_browser_the_address_is_said(scene: mp.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_browser(_address: str) -> bool:
        return False

    monkeypatch.setattr("webbrowser.open", no_browser)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        viewer = scene.view()
    with viewer:
        assert viewer.address in str(caught[0].message)
        assert viewer.address in repr(viewer) and viewer.address in viewer._repr_html_()


def test_a_robot_of_ones_own_has_no_page() -> None:
    robot = mp.Robot(mp.Space([0, 0], [4, 4]), valid=lambda _: True)
    with pytest.raises(mp.Error, match="has no picture"):
        mp.Scene.own(robot, start=[0.5, 2], goal=[3.5, 2]).view()


def test_what_was_shown_last_is_last(scene: mp.Scene, viewer: mp.Viewer) -> None:
    row = scene.start
    for name in ("a", "b", "a"):
        viewer.show([row], name=name)
    tab = Tab(viewer)
    assert [tab.path()[0] for _ in range(2)] == ["b", "a"]
    tab.close()
    # So it is for a page that has taken nothing meanwhile.
    page = Page({})
    for name, message in (("a", b"1"), ("b", b"2"), ("a", b"3")):
        page.put(name, message)
    assert page.take() == [b"2", b"3"]
    page.close()
    assert page.take() is None


def test_bad_input_is_refused(scene: mp.Scene, viewer: mp.Viewer) -> None:
    with pytest.raises(mp.Error, match="6"):
        viewer.move([0.0, 1.0])
    for unknown in (float("nan"), float("inf")):
        with pytest.raises(mp.Error, match="finite"):
            viewer.move([unknown, *scene.start[1:]])
    for file in ("path.txt", Path("path.txt")):
        with pytest.raises(mp.Error, match="read_path"):
            viewer.show(file)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="name"):
        viewer.show([scene.start], name=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="open"):
        scene.view(open=1)  # type: ignore[arg-type]
    started = time.monotonic()
    with pytest.raises(mp.Error, match="there is no path"):
        viewer.show(scene.plan("rrt-connect", seed=1, iterations=1))
    assert time.monotonic() - started < 60
