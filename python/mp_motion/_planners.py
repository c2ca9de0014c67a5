"""The planners by name, as the registry of the engine lists them."""

from __future__ import annotations

from dataclasses import dataclass

from . import _mp


@dataclass(frozen=True)
class Parameter:
    """A parameter of a planner.

    Attributes
    ----------
    name : str
        Its name in ``settings``.
    range, default : str
        The values allowed, and the default.
    doc : str
        What it does.
    """

    name: str
    range: str
    default: str
    doc: str


@dataclass(frozen=True)
class PlannerInfo:
    """A planner.

    Attributes
    ----------
    name : str
        Its name; for a meta-planner, the prefix before the name of another.
    summary : str
        What it is, and when to use it.
    citation : str
        Its paper.
    parameters : tuple of Parameter
        Its parameters.
    aliases : tuple of str
        Its other names.
    builds_roadmap : bool
        Whether it builds a roadmap, which answers many queries.
    """

    name: str
    summary: str
    citation: str
    parameters: tuple[Parameter, ...]
    aliases: tuple[str, ...] = ()
    builds_roadmap: bool = False


def planners() -> list[PlannerInfo]:
    """List the planners by name.

    Examples
    --------
    >>> [p.name for p in mp.planners() if p.name.startswith("rrt-con")]
    ['rrt-connect', 'rrt-con-ext', 'rrt-con-con']
    """
    return [
        PlannerInfo(name, summary, citation, tuple(Parameter(*p) for p in parameters), tuple(aliases), roadmap)
        for name, summary, citation, parameters, aliases, roadmap in _mp.planners()
    ]


def meta_planners() -> list[PlannerInfo]:
    """List the meta-planners, whose names are prefixes: ``or-rrt-connect`` runs ``rrt-connect`` in a race.

    Examples
    --------
    >>> [p.name for p in mp.meta_planners()]
    ['or-', 'shared-', 'restart-']
    """
    return [
        PlannerInfo(prefix, summary, citation, tuple(Parameter(*p) for p in parameters))
        for prefix, summary, citation, parameters in _mp.meta_planners()
    ]


def metrics() -> dict[str, str]:
    """Return the metrics by name, each with its formula (metres; θ in radians)."""
    return dict(_mp.metrics())


def scenes() -> list[str]:
    """List the names of the scenes that come with the package.

    Examples
    --------
    >>> "cubicles" in mp.scenes()
    True
    """
    return _mp.shipped()
