"""Scenes: what to plan in."""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, cast, get_args

import numpy as np
import tomli_w
from numpy.lib import recfunctions
from numpy.typing import ArrayLike, NDArray

from . import _mp, _view
from ._arguments import choice, flag, motion, number, numbers, text, whole
from ._errors import Error, Interrupted
from ._mp import Cancel
from ._names import MetricName, PlannerName
from ._own import Robot, native
from ._progress import Progress, reporter
from ._report import Column, Explanation, Finished, Report, Trajectory, Verdict, explanation, trajectory, verdict
from ._roadmap import Roadmap
from ._shapes import (
    Array,
    Attached,
    Body,
    Circle,
    Disc,
    Polygon,
    Rectangle,
    Shape,
    attached_members,
    body_members,
    plain,
    planar_members,
    pose_numbers,
    shape_members,
)
from ._viewer import Viewer

#: A file, as a name or a path.
File: TypeAlias = str | os.PathLike[str]
#: A path: its configurations in rows, or what has one.
PathRows: TypeAlias = ArrayLike | Report | Finished
#: What is done to the path that a planner found.
Finish: TypeAlias = Literal["shorten", "as-found", "relax"]
#: A number is fixed, a pair is an interval; what is not named is free. Or a place of a link: see :meth:`Scene.arm`.
FreeGoal: TypeAlias = Mapping[str, float | tuple[float, float]] | Mapping[str, Any]


@dataclass(frozen=True)
class Options:
    """How to plan: the options of :meth:`Scene.plan`, to be kept and given to many runs.

    Every option that is left out has its default; :meth:`Scene.plan` describes them.
    """

    planner: PlannerName | str | None = None
    seed: int = 1
    time: float | None = 60.0
    iterations: int | None = None
    queries: int | None = None
    nodes: int | None = None
    settings: Mapping[str, object] | None = None
    metric: MetricName | str = "default"
    motion: str = "certified"
    threads: int = 1
    finish: Finish = "shorten"
    field: str = "clearance"
    first_only: bool = False
    roadmap: File | None = None
    clearance: float = 0.0
    sharp_clearance: bool = False
    objective: str = "length"
    hybridize: int = 1

    def __post_init__(self) -> None:
        """Check each option, so that an error names it.

        Raises
        ------
        TypeError
            When an option has a wrong type.
        Error
            When its value is not possible; a ``ValueError`` too.
        """
        if self.planner is not None:
            text("planner", self.planner)
        whole("seed", self.seed)
        whole("threads", self.threads, 1)
        whole("hybridize", self.hybridize, 1)
        if self.time is not None:
            number("time", self.time, above=0)
        for name in ("iterations", "queries", "nodes"):
            if getattr(self, name) is not None:
                whole(name, getattr(self, name), 1)
        choice("metric", self.metric, get_args(MetricName))
        motion(self.motion)
        choice("finish", self.finish, get_args(Finish))
        text("field", self.field)
        text("objective", self.objective)
        number("clearance", self.clearance, least=0)
        flag("first_only", self.first_only)
        flag("sharp_clearance", self.sharp_clearance)

    def to_json(self, scene: Scene) -> str:
        """Return the request as ``mp plan --request`` reads it, with the planner that suits the scene if none is named."""
        return json.dumps(
            {
                "planner": self.planner if self.planner is not None else scene.default_planner,
                "settings": {key: _setting(value) for key, value in (self.settings or {}).items()},
                "metric": self.metric,
                "motion": self.motion,
                **({"clearance": float(self.clearance)} if self.clearance else {}),
                "budget": budget(self.time, self.iterations, self.queries, self.nodes),
                "seed": int(self.seed),
                "threads": int(self.threads),
                "finish": self.finish,
                "field": self.field,
                "first_only": bool(self.first_only),
                **({"sharp_clearance": True} if self.sharp_clearance else {}),
                **({"objective": self.objective} if self.objective != "length" else {}),
                **({"hybridize": int(self.hybridize)} if self.hybridize != 1 else {}),
                "roadmap": None if self.roadmap is None else os.fspath(self.roadmap),
            }
        )


def _setting(value: object) -> str:
    """Turn a setting into text, as the registry reads it."""
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    return str(value)


def budget(time: float | None, iterations: int | None, queries: int | None, nodes: int | None) -> dict[str, float | int | None]:
    """Return the budget of a request."""
    return {
        "time_s": None if time is None else float(time),
        "iterations": None if iterations is None else int(iterations),
        "queries": None if queries is None else int(queries),
        "nodes": None if nodes is None else int(nodes),
    }


class Scene:
    """A robot among obstacles, with a start and one or more goals.

    A scene does not change. It can be pickled, and used from several threads at a time.

    Parameters
    ----------
    name : str or path
        A file (GEMPA ``.env``, OMPL.app ``.cfg``, ``.toml``, ``.mp.json``, ``.urdf``, MJCF ``.xml``, a map ``.yaml``) or
        a shipped scene: :func:`scenes` lists them. To make a scene in code, use :meth:`rigid`, :meth:`arm`, :meth:`plane` or
        :meth:`from_dict`.

    Raises
    ------
    Error
        When there is no such scene, or a file is not valid: with file, line and remedy.

    Examples
    --------
    >>> scene = mp.Scene("easy")
    >>> scene.space, [c.name for c in scene.columns]
    ('SE3', ['x', 'y', 'z', 'alpha', 'beta', 'gamma'])
    >>> report = scene.plan(seed=7)
    >>> report.solved, report.path.shape[1]
    (True, 6)
    """

    __slots__ = ("_native", "_robot")
    _native: _mp.Scene
    _robot: Robot | None

    def __init__(self, name: File) -> None:
        self._native = _mp.Scene.find(os.fspath(name))
        self._robot = None

    # --- other ways to make one -------------------------------------------------------------------------------------

    @classmethod
    def _from(cls, native: _mp.Scene, robot: Robot | None = None) -> Scene:
        scene = cls.__new__(cls)
        scene._native, scene._robot = native, robot
        return scene

    @classmethod
    def from_dict(
        cls,
        document: Mapping[str, Any],
        *,
        files: Mapping[str, bytes | str] | None = None,
        name: str = "scene",
        folder: File = "",
    ) -> Scene:
        """Make a scene of what a scene file (``.toml``) holds, as a dictionary.

        Parameters
        ----------
        document : mapping
            The tables of the file: ``robot``, ``motion``, ``obstacle``, ``attached``, ``then``, ``moving``, ``world``. Values
            may be arrays.
        files : mapping, optional
            Contents of files that the document names. Others are read from the disk.
        name : str
            What reports call the scene.
        folder : path
            The folder to which names of files are relative.

        Raises
        ------
        Error
            When the scene is not valid: with the line of the text that the dictionary makes.

        Examples
        --------
        >>> scene = mp.Scene.from_dict({
        ...     "world": {"walls": [[0, 0], [4, 3]]},
        ...     "robot": {"disc": 0.1},
        ...     "motion": {"start": [0.5, 0.5], "goal": [3.5, 2.5]},
        ...     "obstacle": [{"rectangle": [[1.5, 0], [2, 2]]}],
        ... })
        >>> scene.plan().solved
        True
        """
        folder = os.fspath(folder)
        contents = {
            os.path.join(folder, key): value.encode() if isinstance(value, str) else bytes(value)
            for key, value in (files or {}).items()
        }
        main = os.path.join(folder, f"{name}.toml")
        contents[main] = tomli_w.dumps(plain(dict(document))).encode()
        return cls._from(_mp.Scene.from_files(main, contents, True))

    @classmethod
    def rigid(
        cls,
        robot: Shape,
        start: ArrayLike,
        goal: ArrayLike | FreeGoal | None = None,
        obstacles: Iterable[Body | Shape] = (),
        *,
        goals: Sequence[ArrayLike | FreeGoal] | None = None,
        bounds: ArrayLike | None = None,
        planar: bool = False,
        name: str = "scene",
    ) -> Scene:
        """Make a scene of a rigid body that flies freely among obstacles.

        Parameters
        ----------
        robot : Shape
            The body, about its origin.
        start : array_like, shape (6,) or (4, 4)
            ``x y z α β γ`` (m, rad), or a matrix. With `planar`, the same, where ``z β γ`` are zero.
        goal : array_like or mapping
            Such a pose; or a mapping of some of ``x``, ``y``, ``z``, ``alpha``, ``beta``, ``gamma`` to a number or an interval:
            the others are free.
        obstacles : iterable of Body or shapes
            What stands still.
        goals : sequence, optional
            In place of `goal`: any one of them.
        bounds : array_like, shape (2, 3), optional
            The lowest and the highest corner of where the origin of the robot may be, metres. By default around everything.
        planar : bool
            Whether the body moves in the plane z = 0, and turns in it. Configurations have six numbers all the same.
        name : str
            What reports call the scene.

        Examples
        --------
        >>> post = mp.Body(mp.Box(0.2, 1, 4), name="post")
        >>> scene = mp.Scene.rigid(mp.Box(0.5, 0.1, 0.1), [-1, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0], [post])
        >>> scene.plan(seed=1).solved
        True
        """
        files: dict[str, bytes] = {}
        members: dict[str, Any] = shape_members(robot, files)
        if bounds is not None:
            members["bounds"] = numbers(bounds)
        if planar:
            members["planar"] = True
        pose = _planar_pose if planar else pose_numbers
        document = {
            "robot": members,
            "motion": {"start": pose(start)} | _ends(goal, goals, pose),
            "obstacle": [body_members(body, files) for body in obstacles],
        }
        return cls.from_dict(document, files=files, name=name)

    @classmethod
    def arm(
        cls,
        urdf: File,
        start: ArrayLike | Mapping[str, float] | str,
        goal: ArrayLike | FreeGoal | str | None = None,
        obstacles: Iterable[Body | Shape] = (),
        *,
        goals: Sequence[ArrayLike | FreeGoal | str] | None = None,
        attached: Iterable[Attached] = (),
        srdf: File | Literal[False] | None = None,
        packages: File | None = None,
        base: ArrayLike | None = None,
        planar_within: ArrayLike | None = None,
        floating_within: ArrayLike | None = None,
        limits: Mapping[str, tuple[float, float]] | None = None,
        hold: Mapping[str, float] | None = None,
        group: str | None = None,
        joints: Sequence[str] | None = None,
        name: str = "scene",
    ) -> Scene:
        """Make a scene of an arm, or of a body with joints that flies freely, among obstacles.

        Parameters
        ----------
        urdf : path or str
            The robot: a file, or the text of a URDF.
        start : array_like, shape (joints,), or mapping or str
            Radians, or metres for prismatic joints, in the order of the URDF; of a base that moves, its pose comes first. Or
            the values of some joints, where the others are at zero or the limit nearest to it; or the name of a state of the
            SRDF.
        goal : array_like or mapping or str
            All joint values, or the name of a state of the SRDF; or a mapping of some to a number or an interval: the others
            are free. Or the place of a link in the world: ``{"link": "tool", "pose": pose}`` with a pose of six numbers or
            (4, 4), also with ``"free"`` (``"x"``, ``"y"``, ``"z"``, ``"all"``: what may turn) and ``"position_tolerance"`` in
            metres; or ``{"link": "tool", "position": [x, y, z]}``. A path ends at any configuration that reaches it.
        obstacles : iterable of Body or shapes
            What stands still.
        goals : sequence, optional
            In place of `goal`: any one of them.
        attached : iterable of Attached
            What links carry.
        srdf : path or str or False, optional
            Which links may touch: a file, or its text. If it is left out, one near the URDF is taken if there is one; with
            False none is.
        packages : path, optional
            The folder that ``package://`` means.
        base : array_like, shape (6,) or (4, 4), optional
            The pose of the root link.
        planar_within : array_like, shape (2, 2), optional
            The base moves in the plane z = 0: the lowest and the highest corner of where its origin may be, metres.
            Configurations begin with x, y and the angle then.
        floating_within : array_like, shape (2, 3), optional
            The base floats: the lowest and the highest corner of where its origin may be, metres.
        limits : mapping, optional
            Limits of joints in place of those of the URDF.
        hold : mapping, optional
            Joints that do not move, and where they are.
        group : str, optional
            Only the joints of this group of the SRDF move.
        joints : sequence of str, optional
            Only these joints move.
        name : str
            What reports call the scene.
        """
        files: dict[str, bytes] = {}
        robot: dict[str, Any] = {"urdf": _text_or_file(urdf, "robot.urdf", files)}
        if srdf is False:
            robot["srdf"] = False
        elif srdf is not None:
            robot["srdf"] = _text_or_file(srdf, "robot.srdf", files)
        if packages is not None:
            robot["packages"] = os.fspath(packages)
        given = {"limits": limits, "hold": hold, "group": group, "joints": joints}
        robot |= {key: plain(value) for key, value in given.items() if value is not None}
        moves = {"floating": floating_within, "planar": planar_within}
        moving = {how: within for how, within in moves.items() if within is not None}
        if len(moving) + (base is not None) > 1:
            raise Error("a base that moves has no pose", remedy="give one of `base`, `planar_within` and `floating_within`")
        for how, within in moving.items():
            robot |= {"base": how, "bounds": numbers(within)}
        if base is not None:
            robot["base"] = pose_numbers(base)
        begins = plain(start) if isinstance(start, str | Mapping) else _ordered(start)
        document = {
            "robot": robot,
            "motion": {"start": begins} | _ends(goal, goals, plain),
            "obstacle": [body_members(body, files) for body in obstacles],
            "attached": [attached_members(body, files) for body in attached],
        }
        return cls.from_dict(document, files=files, name=name)

    @classmethod
    def plane(
        cls,
        robot: Disc | Polygon,
        start: ArrayLike,
        goal: ArrayLike | FreeGoal | None = None,
        obstacles: Iterable[Rectangle | Circle | Polygon] = (),
        *,
        goals: Sequence[ArrayLike | FreeGoal] | None = None,
        walls: ArrayLike | None = None,
        bounds: ArrayLike | None = None,
        image: ArrayLike | None = None,
        scale: float | None = None,
        origin: ArrayLike | None = None,
        threshold: float | None = None,
        unknown: str | None = None,
        name: str = "scene",
    ) -> Scene:
        """Make a scene of a robot in the plane, among areas or on a map.

        Parameters
        ----------
        robot : Disc or Polygon
            A polygon turns about its origin.
        start : array_like, shape (2,) or (3,)
            x and y (m); of a polygon also the angle (rad).
        goal : array_like or mapping
            Such a configuration; or a mapping of some of ``x``, ``y``, ``yaw`` to a number or an interval: the others are free.
        obstacles : iterable of Rectangle, Circle or Polygon
            What stands still.
        goals : sequence, optional
            In place of `goal`: any one of them.
        walls : array_like, shape (2, 2), optional
            Lower left and upper right corner of walls around everything, metres.
        bounds : array_like, shape (2, 2), optional
            Where the origin of the robot may be, metres.
        image : array_like, shape (rows, columns), optional
            A map as a picture, the first row the highest: dark pixels are obstacles. Brightness from 0 to 255 (integers), or
            from 0 to 1 (floats).
        scale : float, optional
            Metres per pixel of the image.
        origin : array_like, shape (2,), optional
            The lower left corner of the image, metres.
        threshold : float, optional
            What is darker, 0 being black and 1 white, is obstacle.
        unknown : str, optional
            ``"free"`` if the robot may reach over the edges of the image; they are walls otherwise, unless `walls` says where
            those are.
        name : str
            What reports call the scene.

        Examples
        --------
        >>> room = np.full((30, 40), 255, dtype=np.uint8)
        >>> room[10:, 20] = 0
        >>> scene = mp.Scene.plane(mp.Disc(0.1), [0.5, 0.5], [3.5, 0.5], image=room, scale=0.1)
        >>> scene.plan().solved
        True
        """
        files: dict[str, bytes] = {}
        world = {"walls": walls, "bounds": bounds, "scale": scale, "origin": origin, "threshold": threshold, "unknown": unknown}
        world = {key: np.asarray(value).tolist() for key, value in world.items() if value is not None}
        if image is not None:
            files["image.pgm"] = _pgm(np.asanyarray(image))
            world["image"] = "image.pgm"
        match robot:
            case Disc(radius):
                members: dict[str, Any] = {"disc": float(radius)}
            case Polygon(corners, holes) if not len(holes):
                members = {"polygon": plain(corners)}
            case _:
                raise Error(f"{robot!r} is no robot of the plane", remedy="give a Disc, or a Polygon without holes")
        document = {
            "world": world,
            "robot": members,
            "motion": {"start": _ordered(start)} | _ends(goal, goals, plain),
            "obstacle": [planar_members(shape) for shape in obstacles],
        }
        return cls.from_dict(document, files=files, name=name)

    @classmethod
    def own(
        cls,
        robot: Robot,
        start: ArrayLike,
        goal: ArrayLike | None = None,
        *,
        goals: Sequence[ArrayLike] | None = None,
    ) -> Scene:
        """Make a scene of a robot of yours, whose checks are functions.

        All planners work but those that need meshes or a gradient; paths are shortened and verified as those of others. Such
        scenes have no pictures and no certificates, and pickle if their functions do.

        Parameters
        ----------
        robot : Robot
            The robot with its space.
        start, goal : array_like, shape (n,)
            Configurations.
        goals : sequence, optional
            In place of `goal`: any one of them.

        Examples
        --------
        >>> def clearance(q):
        ...     return np.hypot(*(q - 2)) - 1  # a disc of radius 1 m
        >>> def displacement(a, b):
        ...     return np.hypot(*(b - a))
        >>> robot = mp.Robot(mp.Space([0, 0], [4, 4]), clearance=clearance, displacement=displacement)
        >>> report = mp.Scene.own(robot, [0.5, 2], [3.5, 2]).plan("rrt-star", iterations=500)
        >>> report.solved, report.motion, report.clearance > 0
        (True, 'certified', True)
        """
        if goals is None and goal is not None:
            goals = [goal]
        elif goals is None or goal is not None:
            raise Error("there must be either `goal` or `goals`", remedy="give one of them")
        ends = [_ordered(given).tolist() for given in goals]
        return cls._from(_mp.Scene.own(native(robot), _ordered(start).tolist(), ends), robot)

    def with_ends(self, start: ArrayLike | None = None, goal: ArrayLike | None = None) -> Scene:
        """Return the same scene with another start, or with other goals.

        Parameters
        ----------
        start : array_like, shape (columns,), optional
            The configuration to start from.
        goal : array_like, shape (columns,) or (n, columns), optional
            The goal, or several, any one of which is reached. Goals that leave something free become those of :attr:`goals`.

        Examples
        --------
        >>> scene = mp.Scene("easy")
        >>> back = scene.with_ends(scene.goals[0], scene.start)
        >>> bool((back.start == scene.goals[0]).all())
        True
        """
        starts = self.start.tolist() if start is None else self._row(start)
        if goal is None:
            goals = self.goals
        elif isinstance(goal, Mapping) or np.ndim(goal) < 2:
            goals = np.array([self._row(goal)])
        else:
            goals = self._path(goal)
        return self._from(self._native.with_ends(starts, goals.tolist()), self._robot)

    def keeping(self, clearance: float) -> Scene:
        """Return the same scene, in which paths keep a clearance from obstacles.

        Planning, shortening, checking, explaining and certificates mind it. The links of an arm may be nearer to each other.

        Parameters
        ----------
        clearance : float
            Metres; zero for none.

        Examples
        --------
        >>> scene = mp.Scene("easy")
        >>> scene.keeping(0.1).check(scene.plan(clearance=0.1)).free
        True
        >>> scene.keeping(0.1).check(scene.plan()).free
        False
        """
        return self._from(self._native.keeping(number("clearance", clearance, least=0)), self._robot)

    @property
    def parts_left(self) -> int:
        """How many parts of the motion come after this one: see :meth:`next_part`."""
        return self._native.parts_left

    def next_part(self, end: ArrayLike) -> Scene | None:
        """Return the scene of the next part of the motion, in which something may be attached to a link or put down.

        Parameters
        ----------
        end : array_like, shape (numbers,)
            Where this part has ended: the last row of its path.

        Returns
        -------
        Scene or None
            None when this is the last part.

        Examples
        --------
        >>> scene = mp.Scene("carry")
        >>> paths = []
        >>> while scene is not None:
        ...     paths.append(scene.plan().path)
        ...     scene = scene.next_part(paths[-1][-1])
        >>> len(paths)
        3
        """
        native = self._native.next_part([float(x) for x in numbers(end)])
        return None if native is None else self._from(native, self._robot)

    @property
    def clearance_kept(self) -> float:
        """The clearance that paths keep from obstacles, metres: see :meth:`keeping`."""
        return self._native.clearance_kept

    # --- what it is ------------------------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """Its name."""
        return self._native.name

    @property
    def space(self) -> str:
        """The configuration space: ``SE3``, ``SE2``, ``R2``, ``6 joints``."""
        return self._native.space

    @property
    def file(self) -> str | None:
        """The file that it was read from."""
        file = self._native.file
        return None if file is None else str(file)

    @property
    def columns(self) -> tuple[Column, ...]:
        """The meaning of each number of a configuration."""
        return tuple(Column(name, unit) for name, unit in self._native.columns())

    @property
    def limits(self) -> Array:
        """The least and the largest value of each number, shape (columns, 2); infinite for angles without limits."""
        free = (-np.inf, np.inf)
        return np.array([free if pair is None else pair for pair in self._native.limits()])

    @property
    def start(self) -> Array:
        """The start configuration, shape (columns,)."""
        return self._native.start()

    @property
    def goals(self) -> Array:
        """The goal configurations, shape (n, columns)."""
        return self._native.goals()

    @property
    def notes(self) -> list[str]:
        """What was chosen for a scene whose file is a robot or a map alone."""
        return self._native.notes

    @property
    def details(self) -> dict[str, str]:
        """Further facts, for people."""
        return dict(self._native.details())

    @property
    def default_planner(self) -> str:
        """The planner that is taken when none is named."""
        return self._native.default_planner

    def planners_that_cannot(self) -> dict[str, str]:
        """Return the planners that cannot plan for this robot, each with the reason."""
        return dict(self._native.planners_that_cannot())

    def lint(self) -> list[str]:
        """Return what is wrong or odd about the scene, in sentences."""
        return self._native.lint()

    def free_share(self, samples: int = 1000) -> float:
        """Estimate the fraction of the space in which the robot is free.

        Parameters
        ----------
        samples : int
            How many configurations are tried. The same number gives the same result.
        """
        return self._native.free_share(whole("samples", samples, 1, 2**32 - 1))

    def poses(self, configuration: ArrayLike) -> Array:
        """Return the poses of the bodies of the robot at a configuration, shape (bodies, 4, 4)."""
        return self._native.poses(self._row(configuration))

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {self.space}>"

    def __reduce__(self) -> tuple[object, ...]:
        if self._robot is not None:
            return _own_again, (self._robot, self.start, self.goals)
        return _restored, self._native.state()

    # --- planning --------------------------------------------------------------------------------------------------

    def plan(
        self,
        planner: PlannerName | str | None = None,
        *,
        seed: int = 1,
        time: float | None = 60.0,
        iterations: int | None = None,
        queries: int | None = None,
        nodes: int | None = None,
        settings: Mapping[str, object] | None = None,
        metric: MetricName | str = "default",
        motion: str = "certified",
        threads: int = 1,
        finish: Finish = "shorten",
        field: str = "clearance",
        first_only: bool = False,
        roadmap: File | None = None,
        clearance: float = 0.0,
        sharp_clearance: bool = False,
        objective: str = "length",
        hybridize: int = 1,
        progress: bool | Callable[[Progress], object] = False,
        cancel: Cancel | None = None,
    ) -> Report:
        """Plan a path: search for it, shorten it, and verify it with code that shares nothing with the search.

        The same scene and options give the same path, to the bit, on any machine and number of threads, and the same as ``mp
        plan`` gives. Other threads of Python run meanwhile.

        Parameters
        ----------
        planner : str, optional
            Its name: :func:`planners` lists them. With the prefix ``or-`` independent runs race on all threads; with
            ``restart-`` it starts again when it takes too long. By default one that suits the robot.
        seed : int
            The seed of all randomness.
        time : float or None
            The budget of time, seconds. It ends a run, and changes nothing that was computed before.
        iterations, queries, nodes : int, optional
            Budgets of iterations, of collision and clearance queries, and of nodes.
        settings : mapping, optional
            Parameters of the planner by name, such as ``{"step": "10%"}``.
        metric : str
            How far apart two configurations are: :func:`metrics` lists them.
        motion : str
            How motions are checked while planning: ``certified``, or ``discrete:1%``.
        threads : int
            Threads that the planner may use. Results do not depend on it.
        finish : str
            ``shorten`` the path found, leave it ``as-found``, or ``relax`` it with a snake.
        field : str
            What pushes the path if it is relaxed: ``clearance``, ``paper``, ``risk``, ``image:FILE``.
        first_only : bool
            Whether to stop at the first path, also with an anytime planner.
        roadmap : path, optional
            The file of a roadmap, for planners that build one: read if it exists, grown, and written at the end.
        clearance : float
            What the path keeps from obstacles all along, metres; the links of an arm may be nearer to each other. Zero for what
            the scene :meth:`keeps <keeping>`.
        sharp_clearance : bool
            Whether the report has the clearance of the path as near as it can be measured, which may take as long as planning;
            otherwise it has the bound that the proof of the path gives.
        objective : str
            What the path costs: ``length``, or ``clearance:WEIGHT:RANGE``, being near obstacles too; both numbers may be left
            out. Planners that improve their paths lower it, and so does shortening; ``report.cost`` has it.
        hybridize : int
            How many paths to plan, with this seed and the next ones, and to merge into a shorter one. Each takes as long as the
            first.
        progress : bool or callable
            Called with :class:`Progress` at most ten times a second, in the calling thread; ``True`` shows a bar of ``tqdm``.
        cancel : Cancel, optional
            Ends the run when it is cancelled in another thread.

        Returns
        -------
        Report
            Not finding a path is no error: see ``report.solved`` and ``report.why``.

        Raises
        ------
        Error
            When start or goal is not free (what touches, how deep, the nearest free configuration), or an option is not valid.
        Interrupted
            After Ctrl-C; a ``KeyboardInterrupt`` with the report of what was found.

        Examples
        --------
        >>> report = mp.Scene("easy").plan("rrt-connect", seed=3, settings={"step": "10%"})
        >>> report.solved and report.clearance > 0
        True
        """
        options = Options(
            planner, seed, time, iterations, queries, nodes, settings, metric, motion, threads, finish, field,
            first_only, roadmap, clearance, sharp_clearance, objective, hybridize,
        )  # fmt: skip
        return self.plan_by(options, progress=progress, cancel=cancel)

    def plan_by(
        self,
        options: Options,
        *,
        progress: bool | Callable[[Progress], object] = False,
        cancel: Cancel | None = None,
    ) -> Report:
        """Plan as :meth:`plan` does, with options that are kept."""
        before = self._native.function_calls()
        with reporter(progress) as tell:
            parts, raised = self._native.plan(options.to_json(self), cancel, tell)
        calls = self._native.function_calls() - before
        report = Report._of(*parts, scene=self, calls=None if self._robot is None else calls)
        report._warn()
        if raised is None:
            return report
        if isinstance(raised, KeyboardInterrupt):
            raise Interrupted(report) from raised
        raise raised

    async def plan_async(
        self, options: Options | None = None, *, progress: bool | Callable[[Progress], object] = False
    ) -> Report:
        """Plan in a thread, while other tasks of the event loop run. Cancelling the task ends the run.

        Parameters
        ----------
        options : Options, optional
            How to plan.
        progress : bool or callable
            As of :meth:`plan`, but called in the thread that plans.
        """
        cancel = Cancel()
        run = asyncio.to_thread(self.plan_by, options or Options(), progress=progress, cancel=cancel)
        task = asyncio.ensure_future(run)
        try:
            return await asyncio.shield(task)
        except asyncio.CancelledError:
            cancel.cancel()
            await asyncio.wait([task])
            raise

    def routes(
        self,
        count: int,
        apart: float | str = "10%",
        options: Options | None = None,
        *,
        progress: bool | Callable[[Progress], object] = False,
        cancel: Cancel | None = None,
    ) -> list[Report]:
        """Plan several routes, each of which is found somewhere far from the others, the shortest as found first.

        Parameters
        ----------
        count : int
            How many, at most.
        apart : float or str
            How far apart, in the metric, or as a share of the extent of the space. Shortened they may be nearer: one that
            would come within half of that of another stays as it was found.
        options : Options, optional
            How to plan; the planner must be ``cyclic-rrt``, which is taken unless another is named, or build roadmaps
            with cycles.
        progress, cancel
            As of :meth:`plan`.

        Returns
        -------
        list of Report
            Without any route, one report that says why.
        """
        options = options or Options(planner="cyclic-rrt")
        whole("count", count, 1)
        with reporter(progress) as tell:
            reports, raised = self._native.routes(options.to_json(self), count, str(apart), cancel, tell)
        if raised is not None:
            raise raised
        found = [Report._of(*parts, scene=self) for parts in reports]
        found[0]._warn()
        return found

    def roadmap(
        self,
        options: Options | PlannerName | str | None = None,
        *,
        progress: bool | Callable[[Progress], object] = False,
        cancel: Cancel | None = None,
    ) -> Roadmap:
        """Build a roadmap for many queries, until its budget is used up.

        Parameters
        ----------
        options : Options or str, optional
            How to build it: a planner that builds roadmaps (``prm``, unless another is named) and a budget, best of nodes; or
            such a planner alone, for a roadmap of 2,000 nodes.
        progress, cancel
            As of :meth:`plan`.

        Examples
        --------
        >>> scene = mp.Scene("easy")
        >>> roadmap = scene.roadmap(mp.Options("prm", seed=3, nodes=3000))
        >>> roadmap.query(scene.goals[0], scene.start).solved
        True
        """
        if not isinstance(options, Options):
            options = Options(planner=options or "prm", nodes=2000)
        with reporter(progress) as tell:
            native = self._native.roadmap(options.to_json(self), cancel, tell)
        return Roadmap._from(native, self)

    def shorten(
        self,
        path: PathRows,
        *,
        seed: int = 1,
        time: float | None = 60.0,
        finish: Finish = "shorten",
        field: str = "clearance",
        progress: bool | Callable[[Progress], object] = False,
        cancel: Cancel | None = None,
    ) -> Finished:
        """Shorten or relax a path from elsewhere, between any two configurations, and verify the result.

        Parameters
        ----------
        path : array_like, shape (n, columns), or Report or Finished
            One configuration in each row.
        seed, time, finish, field, progress, cancel
            As of :meth:`plan`.

        Raises
        ------
        Error
            When the path is not free: what it hits, and where; and when it was not verified in time.

        Examples
        --------
        >>> scene = mp.Scene("easy")
        >>> found = scene.plan(finish="as-found")
        >>> scene.shorten(found).path_length < found.path_length
        True
        """
        options = Options(seed=seed, time=time, finish=finish, field=field)
        with reporter(progress) as tell:
            return Finished(*self._native.finish(options.to_json(self), self._path(path), cancel, tell), _scene=self)

    # --- checking --------------------------------------------------------------------------------------------------

    def check(self, path: PathRows) -> Verdict:
        """Verify a path from the start to a goal, with code that shares nothing with the planners.

        Parameters
        ----------
        path : array_like, shape (n, columns), or Report or Finished
            One configuration in each row.

        Returns
        -------
        Verdict
            True when the path is free all along.

        Examples
        --------
        >>> scene = mp.Scene("easy")
        >>> bool(scene.check(scene.plan())), bool(scene.check([scene.start, scene.goals[0]]))
        (True, False)
        """
        return verdict(self._native.check(self._path(path)))

    def check_trajectory(self, file: File, *, curve: str = "controller") -> Verdict:
        """Verify the curve of a trajectory of an arm, whoever made it.

        Parameters
        ----------
        file : str or path
            ``.csv`` with times, or JointTrajectory of ROS as ``.json`` or ``.yaml``, also in messages of MoveIt, or ``.mcap``.
        curve : str
            What a controller runs between points: ``controller``, as joint_trajectory_controller of ROS does, ``linear``,
            ``cubic`` or ``quintic``.

        Returns
        -------
        Verdict
            True when the curve is free, within the limits of the joints that are known, and leads from the start to a goal.
        """
        return verdict(self._native.check_trajectory(os.fspath(file), curve))

    def trajectory(
        self,
        path: PathRows,
        *,
        velocity: float = 1.0,
        acceleration: float = 1.0,
        jerk: float = 1.0,
        deviation: float = 0.1,
    ) -> Trajectory:
        """Give a path of an arm times: as fast as the limits of its joints allow, with rounded corners; and prove the curve.

        Parameters
        ----------
        path : array_like, shape (n, columns), or Report or Finished
            A path that is free.
        velocity, acceleration, jerk : float
            The part of the limits that is used. Jerk is not limited where the robot has no limits of it.
        deviation : float
            How far from corners it may pass, in radians and metres of all joints together, where that is free; 0: it stops
            at each.

        Examples
        --------
        >>> made = mp.Scene("arm-6").plan().trajectory(velocity=0.5)
        >>> bool(made.duration > 1), bool(abs(made.velocities).max() <= 0.5 * 3.1416)
        (True, True)
        """
        scales = (velocity, acceleration, jerk)
        return trajectory(self._native.time(self._path(path), scales, deviation), self)

    def _save_trajectory(self, file: File, made: Trajectory) -> None:
        name = os.fspath(file)
        rows = (made.positions, made.velocities, made.accelerations)
        self._native.write(name, self._native.trajectory_bytes(name, made.times.tolist(), *rows))

    def explain(self, configuration: ArrayLike) -> Explanation:
        """Explain a configuration: whether it is free, how near to contact, what touches, where it would be free.

        Parameters
        ----------
        configuration : array_like, shape (columns,)
        """
        return explanation(self._native.explain(self._row(configuration)))

    def is_free(self, configuration: ArrayLike) -> bool:
        """Return whether a configuration is in bounds and free of contact."""
        return self.explain(configuration).free

    def check_ends(self) -> list[str]:
        """Check that start and goals are free, and return what is odd about them.

        Raises
        ------
        Error
            When one is not free.
        """
        return self._native.check_ends()

    def certificate(self, path: PathRows) -> str:
        """Return the proof that a path is free, as JSON, which ``mp-verify-certificate`` replays.

        Parameters
        ----------
        path : array_like, shape (n, columns), or Report or Finished
            Of a report the clearance is used, half of which is proved: plan with ``sharp_clearance`` for the most.
        """
        clearance = path.clearance or 0.0 if isinstance(path, Report | Finished) else 0.0
        return self._native.certificate(self._path(path), clearance)

    def resample(self, path: PathRows, count: int) -> Array:
        """Return so many configurations at equal distances along a path, shape (count, columns), from its first to its last.

        All are on the path; its corners need not be among them. Angles without limits go on from row to row.

        Parameters
        ----------
        path : array_like, shape (n, columns), or Report or Finished
            Not of a robot that moves by inputs.
        count : int
            How many, two or more.
        """
        return self._native.resample(self._path(path), whole("count", count, 2))

    def read_path(self, file: File) -> Array:
        """Read a path from a text, CSV or JSON file, shape (n, columns)."""
        return self._native.read_path(os.fspath(file))

    def _path(self, path: PathRows) -> Array:
        if isinstance(path, Report | Finished):
            if path.path is None:
                raise Error(f"there is no path: {path}", remedy="plan with a larger budget, or another seed")
            path = path.path
        if isinstance(path, str | os.PathLike):
            raise Error(f"{os.fspath(path)!r} is a name, no path", remedy="read the file with scene.read_path(…)")
        if isinstance(path, list | tuple):
            given = cast("Sequence[Any]", path)
            if any(_table(row)[0] is not None for row in given):
                path = [self._row(row) for row in given]
        names, table = _table(path)
        rows = np.ascontiguousarray(numbers(table))
        if rows.ndim != 2:
            raise Error(f"an array of shape {rows.shape} is no path", remedy="give one configuration in each row")
        return rows if names is None else self._native.named_rows(names, rows)

    def _row(self, configuration: ArrayLike | Mapping[str, float]) -> list[float]:
        names, given = _table(configuration)
        a = numbers(given)
        if a.ndim != 1:
            raise Error(f"an array of shape {a.shape} is no configuration", remedy="give one number for each column")
        row: list[float] = (a if names is None else self._native.named_rows(names, a[None, :])[0]).tolist()
        return row

    # --- looking at it ---------------------------------------------------------------------------------------------

    def show(self, path: PathRows | None = None) -> None:
        """Open the scene in the browser, with a path if one is given; in a notebook, show it below the cell.

        Parameters
        ----------
        path : array_like, shape (n, columns), or Report or Finished, optional
        """
        _view.show(self, path)

    def view(self, path: PathRows | None = None, *, open: bool = True) -> Viewer:
        """Open the scene in a page that stays: what the program gives the viewer, the page shows while the program goes on.

        Parameters
        ----------
        path : array_like, shape (n, columns), or Report or Finished, optional
            A path to begin with.
        open : bool
            Whether the browser is opened, or in a notebook the page below the cell. Otherwise open :attr:`Viewer.address`.

        Returns
        -------
        Viewer
            What shows paths and configurations in the page, until the program ends: a script ends with :meth:`Viewer.wait`.
        """
        return Viewer(self, path, open=flag("open", open))

    def save(
        self,
        file: File,
        path: PathRows | None = None,
        *,
        size: tuple[int, int] | None = None,
        mode: str | None = None,
        camera: str | None = None,
        at: float | None = None,
        seconds: float | None = None,
    ) -> None:
        """Write the scene with a path to a file, whose ending says what it is.

        Parameters
        ----------
        file : path
            ``.html`` (a page that opens in any browser), ``.png``, ``.svg``, ``.gif``, ``.mp4``, ``.glb`` (for Blender),
            ``.mpv``; or the path alone: ``.txt``, ``.csv``, ``.json``.
        path : array_like, shape (n, columns), or Report or Finished, optional
            The path.
        size : (int, int), optional
            Width and height of a picture or film, pixels.
        mode : str, optional
            ``solid`` or ``wire``, of a picture or film.
        camera : str, optional
            From where it is seen: ``best``, ``top``, ``front``, …
        at : float, optional
            The moment of the path that a picture shows, from 0 to 1.
        seconds : float, optional
            The length of a film.
        """
        _view.save(self, file, path, (size, mode, camera, at, seconds))

    def to_bytes(self, ending: str, path: PathRows | None = None) -> bytes:
        """Return what :meth:`save` would write to a file with this ending, such as ``html`` or ``png``."""
        return _view.content(self, f"x.{ending}", path, (None, None, None, None, None))

    def _frame(self, path: PathRows | None) -> str | None:
        return None if self._robot is not None else _view.frame(self, path)

    def _picture(self, path: PathRows | None) -> bytes | None:
        return None if self._robot is not None else _view.content(self, "x.png", path, _view.SMALL)

    def _repr_html_(self) -> str | None:
        return self._frame(None)

    def _repr_png_(self) -> bytes | None:
        return self._picture(None)


def _own_again(robot: Robot, start: Array, goals: Array) -> Scene:
    """Make a scene of an own robot from a pickle."""
    return Scene.own(robot, start, goals=list(goals))


def _restored(
    shipped: str | None,
    main: str | None,
    files: dict[str, bytes],
    parts: list[list[float]],
    ends: tuple[list[float], list[list[float]]] | None,
    clearance: float = 0.0,
) -> Scene:
    """Make a scene from a pickle."""
    if shipped is not None:
        native = _mp.Scene.find(shipped)
    elif main is not None:
        native = _mp.Scene.from_files(main, files, False)
    else:
        raise Error("the scene was not made from files, and cannot be read back")
    for end in parts:
        native = native.next_part(end) or native
    return Scene._from((native if ends is None else native.with_ends(*ends)).keeping(clearance))


def _table(given: Any) -> tuple[list[str] | None, Any]:
    """Return the names of the columns of a table, or of the numbers of a row, if it has names; and its numbers.

    Tables are those of pandas, polars and pyarrow, and structured arrays of numpy; rows are those of pandas, and mappings.
    """
    if isinstance(given, Mapping):
        numbers = cast("Mapping[str, Any]", given)
        return [str(name) for name in numbers], list(numbers.values())
    fields = getattr(getattr(given, "dtype", None), "names", None)
    if fields is not None:
        return list(fields), recfunctions.structured_to_unstructured(given)
    # The columns of a table of pyarrow have no names themselves; the index of a list is a method.
    for attribute in ("column_names", "columns", "index"):
        names = getattr(given, attribute, None)
        if names is not None and not callable(names):
            return [str(name) for name in names], given
    return None, given


def _ordered(configuration: ArrayLike) -> Array:
    """Return numbers that have no names: a scene that is being made cannot match them yet."""
    names, given = _table(configuration)
    if names is not None and names != [str(i) for i in range(len(names))]:
        raise Error(f"the numbers are named: {', '.join(names)}", remedy="give them without names, in the order of the robot")
    return numbers(given)


def _planar_pose(given: ArrayLike) -> list[float]:
    """Return x, y and the angle of a pose in the plane z = 0."""
    x, y, z, alpha, beta, gamma = pose_numbers(given)
    if any(abs(left) > 1e-9 for left in (z, beta, gamma)):
        raise Error(f"the pose {x:g} {y:g} {z:g} {alpha:g} {beta:g} {gamma:g} leaves the plane", remedy="give z, β and γ as 0")
    return [x, y, alpha]


def _ends(
    goal: ArrayLike | FreeGoal | str | None,
    goals: Sequence[ArrayLike | FreeGoal | str] | None,
    numbers: Callable[[Any], Any],
) -> dict[str, Any]:
    """Return the members of `motion` for one goal or several."""

    def one(given: ArrayLike | FreeGoal | str) -> Any:
        if not isinstance(given, Mapping):
            return numbers(given)
        members: dict[str, Any] = dict(given)
        if isinstance(members.get("link"), str) and "pose" in members:
            members["pose"] = pose_numbers(members["pose"])
        return members

    if (goal is None) == (goals is None):
        raise Error("there must be either `goal` or `goals`", remedy="give one of them")
    if goals is not None:
        return {"goals": [one(given) for given in goals]}
    assert goal is not None
    return {"goal": one(goal)}


def _text_or_file(given: File, name: str, files: dict[str, bytes]) -> str:
    """Return the name of a file; a text becomes a file in memory."""
    if isinstance(given, str) and given.lstrip().startswith("<"):
        files[name] = given.encode()
        return name
    return os.fspath(given)


def _pgm(image: NDArray[Any]) -> bytes:
    """Return an array of brightness as the content of a PGM file."""
    if np.ma.is_masked(image):
        raise Error("some pixels are masked", remedy="fill them: 0 is an obstacle")
    if image.ndim != 2:
        raise Error(f"an image of shape {image.shape} is no map", remedy="give one brightness for each pixel")
    if image.dtype == np.bool_:
        raise Error("an image of truth values could mean either", remedy="give brightness: `255 * free`")
    if np.issubdtype(image.dtype, np.floating):
        if not np.all((image >= 0) & (image <= 1)):
            raise Error("brightness as floats must be from 0 to 1", remedy="divide by the largest value")
        image = np.rint(255 * image)
    elif not np.all((image >= 0) & (image <= 255)):
        raise Error("brightness as integers must be from 0 to 255", remedy="scale it")
    rows, columns = image.shape
    return f"P5\n{columns} {rows}\n255\n".encode() + image.astype(np.uint8).tobytes()
