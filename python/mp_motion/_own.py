"""Robots whose checks are functions of yours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arguments import number
from ._errors import RequestError
from ._shapes import Array

#: Whether a configuration is free.
Valid: TypeAlias = Callable[[Array], bool]
#: Which of many configurations are free.
ValidMany: TypeAlias = Callable[[Array], NDArray[np.bool_]]
#: A number for one configuration.
OfOne: TypeAlias = Callable[[Array], float]
#: A number for two configurations.
OfTwo: TypeAlias = Callable[[Array, Array], float]


@dataclass(frozen=True, eq=False)
class Space:
    """Where a robot of yours moves: numbers within bounds, some of which may be periodic.

    Parameters
    ----------
    low, high : array_like, shape (n,)
        The bounds of each number.
    periodic : array_like of bool, shape (n,) or ()
        Whether ``high`` is the same as ``low``: then motions take the shorter way around.
    weights : array_like, shape (n,) or ()
        The distance is the Euclidean norm of the differences, each times its weight.
    names : sequence of str, optional
        By default ``q1``, ``q2``, …
    units : str or sequence of str
        One for all numbers, or one for each.

    Examples
    --------
    >>> space = mp.Space([0, 0, -np.pi], [4, 3, np.pi], periodic=[False, False, True], names=["x", "y", "yaw"])
    """

    low: ArrayLike
    high: ArrayLike
    periodic: ArrayLike = False
    weights: ArrayLike = 1.0
    names: Sequence[str] | None = None
    units: str | Sequence[str] = ""

    def __post_init__(self) -> None:
        self._columns(len(self._bounds()[0]))

    def _bounds(self) -> tuple[Array, Array]:
        low, high = (np.atleast_1d(np.asarray(end, dtype=np.float64)) for end in (self.low, self.high))
        if low.ndim != 1 or low.shape != high.shape:
            raise RequestError(
                f"the bounds of a space have shapes {low.shape} and {high.shape}",
                remedy="give as many highest as lowest values",
            )
        if not (np.all(np.isfinite(low)) and np.all(np.isfinite(high)) and np.all(low < high)):
            raise RequestError("a bound of a space is not finite, or not below the other", remedy="give finite `low` < `high`")
        return low, high

    def _columns(self, count: int) -> list[tuple[str, str]]:
        names = [f"q{i + 1}" for i in range(count)] if self.names is None else list(self.names)
        units = [self.units] * count if isinstance(self.units, str) else list(self.units)
        if len(names) != count or len(units) != count:
            raise RequestError(
                f"{len(names)} names and {len(units)} units for {count} numbers", remedy="give one for each number"
            )
        return list(zip(names, units, strict=True))


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot of yours: a space, and functions that say when a configuration is free.

    The functions are called from threads of the engine, one at a time, with arrays of shape (n,). An exception that one raises
    ends the run, and comes out of the method that was called, and of those that other threads have called meanwhile with this
    robot.

    Parameters
    ----------
    space : Space
        Where it moves.
    valid : callable, optional
        ``valid(q) -> bool``: whether a configuration is free. Motions are tested every `resolution`.
    valid_many : callable, optional
        ``valid_many(qs) -> array of bool``: which of many configurations, shape (m, n), are free. In place of `valid`; much
        faster with numpy.
    clearance : callable, optional
        ``clearance(q) -> float``: a lower bound on the distance (m) to the nearest obstacle, not above zero in contact. In
        place of `valid`, together with `displacement`: then motions are proved free, however thin a wall is.
    displacement : callable, optional
        ``displacement(a, b) -> float``: an upper bound on the length (m) of the way of any point of the robot from one
        configuration to another.
    distance : callable, optional
        ``distance(a, b) -> float``: what planners take for near, in place of the distance of the space. Neighbours are then
        found by a linear search. Lengths of paths in reports are those of the space.
    verify : callable, optional
        ``verify(q) -> bool``: a second check, that shares no code with the first, with which finished paths are verified. By
        default they are verified with the first one, by other code.
    resolution : float or str
        How far apart configurations are tested while planning, in the distance of the space or as a part of its extent;
        finished paths are tested at a twentieth of that.
    tolerance : float
        The clearance (m) that is told from contact.
    name : str
        What reports call the scene.

    Examples
    --------
    >>> space = mp.Space([0, 0], [4, 4])
    >>> robot = mp.Robot(space, valid=lambda q: np.hypot(*(q - 2)) > 1)
    >>> report = mp.Scene.own(robot, start=[0.5, 2], goal=[3.5, 2]).plan()
    >>> report.solved, report.motion, report.clearance
    (True, 'discrete:1%', None)
    """

    space: Space
    valid: Valid | None = None
    valid_many: ValidMany | None = None
    clearance: OfOne | None = None
    displacement: OfTwo | None = None
    distance: OfTwo | None = None
    verify: Valid | None = None
    resolution: float | str = "1%"
    tolerance: float = 1e-3
    name: str = "robot"

    def __post_init__(self) -> None:
        number("tolerance", self.tolerance, above=0)
        if (self.clearance is None) != (self.displacement is None):
            raise RequestError(
                "`clearance` and `displacement` belong together",
                remedy="give both, and motions are proved free; or give `valid` alone",
            )
        given = [check for check in (self.valid, self.valid_many, self.clearance) if check is not None]
        if len(given) != 1:
            raise RequestError(
                f"a robot has one check, and {len(given)} are given",
                remedy="give `valid`, or `valid_many`, or `clearance` with `displacement`",
            )


@dataclass(frozen=True, eq=False)
class NativeRobot:
    """A robot as the native half reads it."""

    name: str
    columns: list[tuple[str, str]]
    low: list[float]
    high: list[float]
    periodic: list[bool]
    weights: list[float]
    valid: Valid | None
    valid_many: ValidMany | None
    clearance: OfOne | None
    displacement: OfTwo | None
    distance: OfTwo | None
    verify: Valid | None
    resolution: str
    tolerance: float


def native(robot: Robot) -> NativeRobot:
    """Return the robot with its defaults filled in."""
    low, high = robot.space._bounds()
    try:
        periodic: list[bool] = np.broadcast_to(np.asarray(robot.space.periodic, dtype=np.bool_), low.shape).tolist()
        weights: list[float] = np.broadcast_to(np.asarray(robot.space.weights, dtype=np.float64), low.shape).tolist()
    except ValueError as e:
        raise RequestError(
            f"`periodic` or `weights` do not fit {len(low)} numbers: {e}", remedy="give one for each, or one for all"
        ) from e
    return NativeRobot(
        robot.name, robot.space._columns(len(low)), low.tolist(), high.tolist(), periodic, weights,
        robot.valid, robot.valid_many, robot.clearance, robot.displacement, robot.distance, robot.verify,
        str(robot.resolution), float(robot.tolerance),
    )  # fmt: skip
