"""Arguments, checked where they are given: errors name them."""

from __future__ import annotations

import math
import operator
import re
from numbers import Real
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import Error, RequestError

#: Numbers of the engine have 64 bits.
MOST = 2**64 - 1


def whole(name: str, value: Any, least: int = 0, most: int = MOST) -> int:
    """Return a whole number, `least` or more."""
    if isinstance(value, bool | np.bool_):
        raise TypeError(f"`{name}` must be a whole number, not {value!r}")
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"`{name}` must be a whole number, not {value!r} ({type(value).__name__})") from None
    if not least <= number <= most:
        bounds = f"{least} or more" if number < least else f"at most {most}"
        raise RequestError(f"`{name}` must be {bounds}, not {number}", kind="request")
    return number


def number(name: str, value: Any, *, above: float | None = None, least: float = -math.inf) -> float:
    """Return a finite number, larger than `above`, `least` or more."""
    shown = f"{value!r} ({type(value).__name__})"
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise TypeError(f"`{name}` must be a number, not {shown}")
    given = float(cast("float", value))
    if not math.isfinite(given) or given < least or (above is not None and given <= above):
        which = f" above {above:g}" if above is not None else "" if least == -math.inf else f" from {least:g} on"
        raise RequestError(f"`{name}` must be a finite number{which}, not {given}", kind="request")
    return given


def numbers(given: ArrayLike) -> NDArray[np.float64]:
    """Return an array of real numbers, none of which is masked."""
    array = np.asanyarray(given)
    if np.ma.is_masked(array):
        raise Error("some numbers are masked", remedy="fill them, or leave them out")
    if array.dtype.kind in "bcmM":
        raise Error(f"an array of {array.dtype} has no metres or radians", remedy="give real numbers")
    return np.asarray(array, dtype=np.float64)


def flag(name: str, value: Any) -> bool:
    """Return True or False."""
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"`{name}` must be True or False, not {value!r} ({type(value).__name__})")
    return bool(cast("bool", value))


def text(name: str, value: Any) -> str:
    """Return a text."""
    if not isinstance(value, str):
        raise TypeError(f"`{name}` must be a text, not {value!r} ({type(value).__name__})")
    return value


def choice(name: str, value: Any, known: tuple[str, ...]) -> str:
    """Return one of the texts that are known."""
    if text(name, value) not in known:
        raise RequestError(f"there is no {name} {value!r}", kind="request", remedy=f"there are {', '.join(known)}")
    return str(value)


def motion(value: Any) -> str:
    """Return how motions are checked."""
    if text("motion", value) != "certified" and not re.fullmatch(r"discrete:[0-9.e+-]+%?", value):
        remedy = "give `certified`, or `discrete:` and a distance or a share, such as discrete:1%"
        raise RequestError(f"`motion` is {value!r}", kind="request", remedy=remedy)
    return str(value)
