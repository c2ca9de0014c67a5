"""Names for type checkers, from the registry of the engine: tests/names.py writes this file."""

from typing import Literal, TypeAlias

PlannerName: TypeAlias = Literal[
    "add-rrt",
    "aorrtc",
    "bi-rrt",
    "bridge-prm",
    "cvp-rrt",
    "cyclic-rrt",
    "dd-rrt",
    "gaussian-prm",
    "informed-rrt-star",
    "lazy-prm",
    "mvb-rrt",
    "obprm",
    "obrrt",
    "obstacle-geometry-prm",
    "prm",
    "prm-star",
    "rc-rrt",
    "regional-prm",
    "rrs",
    "rrs-connect",
    "rrt",
    "rrt-con-con",
    "rrt-con-ext",
    "rrt-connect",
    "rrt-inputs",
    "rrt-star",
    "rsrt",
    "t-rrt",
    "utility-rrt",
    "visibility-prm",
]
MetricName: TypeAlias = Literal[
    "default",
    "euclidean",
    "scaled",
    "manhattan",
    "max-displacement",
    "swept-volume",
]
