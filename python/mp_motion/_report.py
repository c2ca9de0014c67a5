"""Results: plain data."""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from ._shapes import Array

if TYPE_CHECKING:
    import pandas as pd

    from ._scene import File, Scene


def at_least(bound: float) -> str:
    """Return a lower bound in three digits, which are never more than it is."""
    near = f"{bound:.3g}"
    return near if float(near) <= bound else f"{bound - 0.5 * 10.0 ** (math.floor(math.log10(bound)) - 2):.3g}"


@dataclass(frozen=True)
class Column:
    """The meaning of one number of a configuration.

    Attributes
    ----------
    name : str
        ``x``, ``yaw``, or the name of a joint.
    unit : str
        ``m``, ``rad``, ``s``, …
    """

    name: str
    unit: str


@dataclass(frozen=True)
class StageTime:
    """A stage of a run, and how long it took.

    Attributes
    ----------
    stage : str
        ``loading``, ``planning``, ``relaxing``, ``shortening`` or ``verifying``.
    time_s : float
        Seconds.
    ended_by : str or None
        What ended it before it was done.
    """

    stage: str
    time_s: float
    ended_by: str | None


class InScene:
    """A path that knows its scene, and shows itself there: in a notebook as the last line of a cell."""

    _scene: Scene | None

    def __getstate__(self) -> dict[str, Any]:
        # A scene is much larger than its path.
        return self.__dict__ | {"_scene": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)

    def _repr_html_(self) -> str | None:
        return None if self._scene is None else self._scene._frame(self._itself())

    def _repr_png_(self) -> bytes | None:
        return None if self._scene is None else self._scene._picture(self._itself())

    def show(self) -> None:
        """Open the scene with the path in the browser; in a notebook, below the cell.

        Raises
        ------
        ValueError
            When it was read back without its scene: then use ``scene.show(path)``.
        """
        self._of_scene().show(self._itself())

    def resample(self, count: int) -> Array:
        """Return so many configurations at equal distances along the path: see :meth:`Scene.resample`.

        Examples
        --------
        >>> report = mp.Scene("easy").plan()
        >>> report.resample(50).shape
        (50, 6)
        """
        return self._of_scene().resample(self._itself(), count)

    def save(self, file: File) -> None:
        """Write the path, a picture, a film or a page: see :meth:`Scene.save`.

        Raises
        ------
        ValueError
            When it was read back without its scene: then use ``scene.save(file, path)``.
        """
        self._of_scene().save(file, self._itself())

    def trajectory(
        self, *, velocity: float = 1.0, acceleration: float = 1.0, jerk: float = 1.0, deviation: float = 0.1
    ) -> Trajectory:
        """Give the path of an arm times, and prove the curve that a controller runs: see :meth:`Scene.trajectory`."""
        pace = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk, "deviation": deviation}
        return self._of_scene().trajectory(self._itself(), **pace)

    def _itself(self) -> Report | Finished:
        assert isinstance(self, Report | Finished)
        return self

    def _of_scene(self) -> Scene:
        if self._scene is None:
            raise ValueError("the path has come without its scene: use scene.show(path), scene.save(file, path)")
        return self._scene


@dataclass(frozen=True, eq=False, repr=False)
class Report(InScene):
    """The result of a run. Lengths are in the metric of the space, clearances in metres, times in seconds.

    Attributes
    ----------
    scene : str
        The name of the scene.
    scene_file : str or None
        Its file.
    space : str
        The configuration space: ``SE3``, ``SE2``, ``R2``, ``6 joints``.
    solved : bool
        Whether a path was found, and passed the independent verifier.
    path : ndarray, shape (n, len(columns)), or None
        The path: one configuration in each row, the start first. It is read-only; ``path.copy()`` is not.
    columns : tuple of Column
        The meaning of each number of a configuration.
    stopped_by, why : str or None
        What ended a run without a path: in a word, in a sentence.
    planner, metric, motion : str
        The planner, the metric, and how motions were checked while planning.
    seed : int
        The seed.
    iterations, nodes, motion_checks, collision_checks, rejected : int
        Counts of the search.
    edges, components : int or None
        Of a roadmap.
    time_s, finish_s : float
        The time of planning alone, and of shortening and verifying.
    stages : tuple of StageTime
        What was done when.
    first_s, first_length, first_path
        When an anytime planner found its first path, its length, and the path.
    path_length_found, path_length : float or None
        The length of the path as it was found, and as it is.
    clearance : float or None
        A lower bound on the clearance along the path, metres.
    clearance_kept : float
        The clearance from obstacles that was asked for, metres; zero for none.
    cost : float or None
        What the path costs, where the objective was not its length.
    won : str or None
        Of the planner ``auto``, the search that has found the path.
    roadmap_error : str or None
        Why the file of the roadmap was not written at the end, which is a warning too.
    shortened : bool
        Whether the path was shortened.
    fingerprint : str or None
        A hash of the numbers of the path: with the same hash two paths are the same, to the bit.
    calls : int or None
        Of a robot of your own, how often its functions were called, shortening and verifying included. Not in the JSON form.
    """

    scene: str
    scene_file: str | None
    space: str
    solved: bool
    verified: bool
    stopped_by: str | None
    why: str | None
    planner: str
    metric: str
    motion: str
    seed: int
    iterations: int
    nodes: int
    edges: int | None
    components: int | None
    motion_checks: int
    collision_checks: int
    rejected: int
    time_s: float
    finish_s: float
    stages: tuple[StageTime, ...]
    first_s: float | None
    first_length: float | None
    first_path: Array | None
    path_length_found: float | None
    path_length: float | None
    clearance: float | None
    shortened: bool
    fingerprint: str | None
    columns: tuple[Column, ...]
    path: Array | None
    version: int
    path_file: str | None = None
    picture_file: str | None = None
    certificate_file: str | None = None
    roadmap_error: str | None = None
    clearance_kept: float = 0.0
    cost: float | None = None
    won: str | None = None
    calls: int | None = None
    _scene: Scene | None = field(default=None)

    @classmethod
    def _of(
        cls, text: str, path: Array | None, first_path: Array | None, scene: Scene | None, calls: int | None = None
    ) -> Report:
        members: dict[str, Any] = json.loads(text)
        members["columns"] = tuple(Column(**column) for column in members["columns"])
        members["stages"] = tuple(StageTime(**stage) for stage in members["stages"])
        members["path"], members["first_path"] = path, first_path
        for rows in (path, first_path):
            if rows is not None:
                # The other members are of these numbers.
                rows.flags.writeable = False
        return cls(**members, calls=calls, _scene=scene)

    def _warn(self) -> None:
        if self.roadmap_error is not None:
            warnings.warn(f"the roadmap was not kept: {self.roadmap_error}", RuntimeWarning, stacklevel=3)

    @classmethod
    def from_json(cls, text: str) -> Report:
        """Read a report back from the JSON form that :meth:`to_json` and ``mp plan --json`` write."""
        members: dict[str, Any] = json.loads(text)
        rows = [members.pop(name, None) for name in ("path", "first_path")]
        path, first = (None if r is None else np.array(r, dtype=np.float64) for r in rows)
        return cls._of(json.dumps(members), path, first, None)

    def to_dict(self) -> dict[str, Any]:
        """Plain data, with lists in place of arrays: what ``mp plan --json`` prints."""
        members: dict[str, Any] = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in ("_scene", "calls")}
        if self.clearance_kept == 0.0:
            del members["clearance_kept"]
        for name in ("cost", "won", "roadmap_error"):
            if members[name] is None:
                del members[name]
        members["columns"] = [vars(column) for column in self.columns]
        members["stages"] = [vars(stage) for stage in self.stages]
        for name in ("path", "first_path"):
            rows: Array | None = members[name]
            members[name] = None if rows is None else rows.tolist()
        return members

    def to_json(self) -> str:
        """One line of JSON, as ``mp plan --json`` prints it."""
        return json.dumps(self.to_dict())

    def to_pandas(self) -> pd.DataFrame:
        """Return the path as a table with a column for each number, named with its unit.

        Raises
        ------
        ValueError
            When there is no path.
        """
        import pandas as pd

        if self.path is None:
            raise ValueError(f"there is no path: {self.why}")
        return pd.DataFrame(self.path, columns=[f"{c.name} ({c.unit})" for c in self.columns])

    def __str__(self) -> str:
        if self.path is None:
            return f"{self.scene}: not solved by {self.planner}, seed {self.seed}: {self.why}"
        clearance = "" if self.clearance is None else f", clearance at least {at_least(self.clearance)} m"
        return (
            f"{self.scene}: solved in {1e3 * self.time_s:.1f} ms by {self.planner}, seed {self.seed}; "
            f"{len(self.path)} configurations, length {self.path_length:.4g}{clearance}"
        )

    def __repr__(self) -> str:
        return f"<Report {self}>"


@dataclass(frozen=True, eq=False)
class Finished(InScene):
    """A path that was shortened and verified.

    Attributes
    ----------
    path : ndarray, shape (n, columns)
        The path.
    path_length : float
        In the metric of the space.
    clearance : float or None
        A lower bound along the path, metres, where one is known.
    shortened : bool
        Whether it is another path than the given one.
    """

    path: Array
    path_length: float
    clearance: float | None
    shortened: bool
    _scene: Scene | None = field(default=None, repr=False)


@dataclass(frozen=True)
class TightCorner:
    """A corner of a path that had to be rounded less than was allowed, for the curve to be free.

    Attributes
    ----------
    configuration : int
        The number of the configuration of the path, from 1.
    time : float
        When the trajectory is there, seconds.
    deviation : float
        How far from it the trajectory passes, in radians and metres of all joints together; 0 where it stops.
    """

    configuration: int
    time: float
    deviation: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A path with times, whose curve is proved free.

    Attributes
    ----------
    columns : tuple of Column
        Name and unit of each joint.
    times : ndarray, shape (n,)
        Seconds.
    positions, velocities : ndarray, shape (n, joints)
        Radians or metres, and these per second.
    accelerations : ndarray, shape (n, joints), or (0, joints) where jerk is not limited
        Radians or metres per second squared.
    curve : str
        The curve between the points, which has all that both have: ``cubic``, or ``quintic`` with accelerations.
    clearance : float
        A lower bound along the curve from its proof, metres; ``inf`` where there is nothing to hit.
    tightened : tuple of TightCorner
        Corners that were rounded less than was allowed.
    notes : tuple of str
        Which limits were taken where none are known.
    """

    columns: tuple[Column, ...]
    times: Array
    positions: Array
    velocities: Array
    accelerations: Array
    curve: str
    clearance: float
    tightened: tuple[TightCorner, ...]
    notes: tuple[str, ...]
    _scene: Scene = field(repr=False)

    @property
    def duration(self) -> float:
        """How long it takes, seconds."""
        return float(self.times[-1] - self.times[0])

    def save(self, file: File) -> None:
        """Write it as ``.csv``, as JointTrajectory of ROS in ``.json`` or ``.yaml``, or as a recording in ``.mcap``."""
        self._scene._save_trajectory(file, self)

    def to_pandas(self) -> pd.DataFrame:
        """Return it as a table: the time, then positions, velocities and accelerations of joints, named with units."""
        import pandas as pd

        names = [f"{c.name} ({c.unit})" for c in self.columns]
        names += [f"{c.name}_velocity ({c.unit}/s)" for c in self.columns]
        rows = [self.positions, self.velocities]
        if len(self.accelerations):
            names += [f"{c.name}_acceleration ({c.unit}/s²)" for c in self.columns]
            rows.append(self.accelerations)
        table = pd.DataFrame(np.hstack(rows), columns=names)
        table.insert(0, "time (s)", self.times)
        return table


def trajectory(text: str, scene: Scene) -> Trajectory:
    """Make a trajectory of its JSON form."""
    m: dict[str, Any] = json.loads(text)
    names = ("times", "positions", "velocities", "accelerations")
    rows = {name: np.array(m[name], dtype=np.float64) for name in names}
    rows["accelerations"] = rows["accelerations"].reshape(-1, len(scene.columns))
    return Trajectory(
        columns=tuple(scene.columns),
        **rows,
        curve=m["curve"],
        clearance=float("inf") if m["clearance"] is None else m["clearance"],
        tightened=tuple(TightCorner(**corner) for corner in m["tightened"]),
        notes=tuple(m["notes"]),
        _scene=scene,
    )


@dataclass(frozen=True)
class Verdict:
    """The result of checking a path.

    Attributes
    ----------
    scene : str
        The name of the scene.
    free : bool
        Whether the path is free all along, and leads from the start of the scene to a goal.
    configurations : int
        The number of configurations.
    path_length : float
        In the metric of the space.
    clearance : float
        A lower bound along the path, metres; 0 when it is not free, or none is known, ``inf`` where there is nothing to hit.
    faults : tuple of str
        What is wrong. Empty when the path is free.
    trajectory : dict or None
        Of a trajectory ``duration``, ``curve``, ``least_at``, ``collides_at`` and ``limits``, which
        docs/formats/report.md describes.
    """

    scene: str
    free: bool
    configurations: int
    path_length: float
    clearance: float
    faults: tuple[str, ...]
    clearance_kept: float = 0.0
    trajectory: dict[str, Any] | None = None

    def __bool__(self) -> bool:
        return self.free


@dataclass(frozen=True)
class Contact:
    """A contact.

    Attributes
    ----------
    part : str or None
        The part of the robot that touches, if the robot has several.
    other : str
        What it touches.
    with_itself : bool
        Whether `other` is a part of the robot.
    depth : float or None
        An estimate of the depth, metres.
    """

    part: str | None
    other: str
    with_itself: bool
    depth: float | None


@dataclass(frozen=True)
class Explanation:
    """Why a configuration is free or not.

    Attributes
    ----------
    free : bool
        Whether it is in bounds, and not in contact.
    in_bounds : bool
        Whether it is within the bounds of the space.
    clearance : float
        A lower bound on the distance to contact, metres; zero in collision, and where none is known, ``inf`` where there is
        nothing to hit.
    touching : tuple of Contact
        What touches what.
    fault : str or None
        What is wrong, to follow the words "the configuration is".
    nearest_free : ndarray or None
        A free configuration nearby, for one that is not free.
    """

    free: bool
    in_bounds: bool
    clearance: float
    touching: tuple[Contact, ...]
    fault: str | None
    nearest_free: Array | None

    def __bool__(self) -> bool:
        return self.free


def verdict(text: str) -> Verdict:
    """Make a verdict of its JSON form."""
    m: dict[str, Any] = json.loads(text)
    return Verdict(
        scene=m["scene"],
        free=m["free"],
        configurations=m["configurations"],
        path_length=_number(m["path_length"]),
        clearance=_number(m["clearance"]),
        faults=tuple(m["faults"]),
        clearance_kept=m.get("clearance_kept", 0.0),
        trajectory=m.get("trajectory"),
    )


def explanation(text: str) -> Explanation:
    """Make an explanation of its JSON form."""
    m: dict[str, Any] = json.loads(text)
    nearest = m["nearest_free"]
    return Explanation(
        free=m["free"],
        in_bounds=m["in_bounds"],
        clearance=_number(m["clearance"]),
        touching=tuple(Contact(**touch) for touch in m["touching"]),
        fault=m["fault"],
        nearest_free=None if nearest is None else np.array(nearest, dtype=np.float64),
    )


def _number(value: float | None) -> float:
    """JSON has no infinity: nothing is near."""
    return float("inf") if value is None else value
