"""Motion planning: from a scene to a verified path.

>>> import mp_motion as mp
>>> scene = mp.Scene("cubicles")
>>> report = scene.plan("rrt-connect", seed=1)
>>> report.solved
True

Units are metres, radians and seconds. The engine is written in Rust. It gives the same path as the program ``mp``, to the
bit, and other threads of Python run while it works.
"""

from ._errors import Error, InternalError, Interrupted
from ._many import plan_many
from ._mp import Cancel
from ._own import Robot, Space
from ._planners import Parameter, PlannerInfo, meta_planners, metrics, planners, scenes
from ._progress import Progress
from ._report import (
    Column,
    Contact,
    Explanation,
    Finished,
    Report,
    StageTime,
    TightCorner,
    Trajectory,
    Verdict,
)
from ._results import Results, read_results
from ._roadmap import Roadmap
from ._scene import Options, Scene
from ._shapes import (
    Attached,
    Body,
    Box,
    Capsule,
    Circle,
    Cone,
    Cylinder,
    Disc,
    HeightField,
    Hull,
    Mesh,
    Points,
    Polygon,
    Rectangle,
    Shape,
    Sphere,
    matrix_from_pose,
    pose_from_matrix,
    pose_from_rotation,
    pose_from_xyz_qxyzw,
)
from ._viewer import Viewer

__all__ = [
    "Attached",
    "Body",
    "Box",
    "Cancel",
    "Capsule",
    "Circle",
    "Column",
    "Cone",
    "Contact",
    "Cylinder",
    "Disc",
    "Error",
    "Explanation",
    "Finished",
    "HeightField",
    "Hull",
    "InternalError",
    "Interrupted",
    "Mesh",
    "Options",
    "Parameter",
    "PlannerInfo",
    "Points",
    "Polygon",
    "Progress",
    "Rectangle",
    "Report",
    "Results",
    "Roadmap",
    "Robot",
    "Scene",
    "Shape",
    "Space",
    "Sphere",
    "StageTime",
    "TightCorner",
    "Trajectory",
    "Verdict",
    "Viewer",
    "matrix_from_pose",
    "meta_planners",
    "metrics",
    "plan_many",
    "planners",
    "pose_from_matrix",
    "pose_from_rotation",
    "pose_from_xyz_qxyzw",
    "read_results",
    "scenes",
]
