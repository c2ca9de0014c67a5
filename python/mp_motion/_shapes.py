"""Shapes, bodies and poses, for scenes that are made in Python."""

from __future__ import annotations

import io
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _mp
from ._arguments import numbers
from ._errors import Error

Array: TypeAlias = NDArray[np.float64]


def pose_from_matrix(matrix: ArrayLike) -> Array:
    """Turn a 4×4 matrix into the six numbers of a pose.

    Parameters
    ----------
    matrix : array_like, shape (4, 4)
        A rigid transformation: a rotation and a translation (m).

    Returns
    -------
    ndarray, shape (6,)
        ``x y z α β γ``: metres, then yaw about Z, pitch about Y and roll about X in radians;
        the rotation is ``Rz(α) Ry(β) Rx(γ)``.

    Examples
    --------
    >>> mp.pose_from_matrix([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]).round(4).tolist()
    [1.0, 2.0, 3.0, 1.5708, 0.0, 0.0]
    """
    m = numbers(matrix)
    if m.shape != (4, 4):
        raise Error(f"a matrix of shape {m.shape} is no pose", remedy="give one of shape (4, 4)")
    r = m[:3, :3]
    rigid = np.allclose(r @ r.T, np.eye(3), atol=1e-6) and np.linalg.det(r) > 0
    if not rigid or not np.allclose(m[3], [0, 0, 0, 1]):
        raise Error(
            "the matrix is no rigid transformation",
            remedy="its upper left 3×3 must be a rotation, and its last row 0 0 0 1",
        )
    beta = math.atan2(0.0 - r[2, 0], math.hypot(r[0, 0], r[1, 0]))
    if math.hypot(r[0, 0], r[1, 0]) < 1e-9:
        # Straight up or down: yaw and roll are about the same axis.
        alpha, gamma = math.atan2(-r[0, 1], r[1, 1]), 0.0
    else:
        alpha, gamma = math.atan2(r[1, 0], r[0, 0]), math.atan2(r[2, 1], r[2, 2])
    return np.array([*m[:3, 3], alpha, beta, gamma])


def matrix_from_pose(pose: ArrayLike) -> Array:
    """Turn the six numbers ``x y z α β γ`` of a pose into a 4×4 matrix.

    Parameters
    ----------
    pose : array_like, shape (6,)
        Metres and radians, as :func:`pose_from_matrix` returns them.

    Returns
    -------
    ndarray, shape (4, 4)

    Examples
    --------
    >>> mp.matrix_from_pose([1, 2, 3, 0, 0, 0])[:3, 3].tolist()
    [1.0, 2.0, 3.0]
    """
    x, y, z, alpha, beta, gamma = (float(v) for v in numbers(pose).reshape(6))
    ca, cb, cg = math.cos(alpha), math.cos(beta), math.cos(gamma)
    sa, sb, sg = math.sin(alpha), math.sin(beta), math.sin(gamma)
    return np.array(
        [
            [ca * cb, ca * sb * sg - sa * cg, ca * sb * cg + sa * sg, x],
            [sa * cb, sa * sb * sg + ca * cg, sa * sb * cg - ca * sg, y],
            [-sb, cb * sg, cb * cg, z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def pose_from_xyz_qxyzw(pose: ArrayLike) -> Array:
    """Turn a position and a quaternion, the scalar last, into the six numbers of a pose.

    Parameters
    ----------
    pose : array_like, shape (7,)
        ``x y z qx qy qz qw``. The quaternion may have any length but zero.

    Returns
    -------
    ndarray, shape (6,)

    Examples
    --------
    >>> mp.pose_from_xyz_qxyzw([1, 2, 3, 0, 0, 0, 1]).tolist()
    [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]
    """
    v = numbers(pose)
    if v.shape != (7,):
        raise Error(f"an array of shape {v.shape} is no pose", remedy="give x y z qx qy qz qw")
    norm = float(np.linalg.norm(v[3:]))
    if not norm > 0:
        raise Error("the quaternion is zero", remedy="give x y z qx qy qz qw")
    x, y, z, w = v[3:] / norm
    m = np.eye(4)
    m[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    m[:3, 3] = v[:3]
    return pose_from_matrix(m)


def pose_from_rotation(position: ArrayLike, rotation: Any) -> Array:
    """Turn a position and a ``scipy.spatial.transform.Rotation`` into the six numbers of a pose.

    Parameters
    ----------
    position : array_like, shape (3,)
        Metres.
    rotation : scipy.spatial.transform.Rotation
        A single rotation.

    Returns
    -------
    ndarray, shape (6,)
    """
    m = np.eye(4)
    m[:3, :3] = rotation.as_matrix()
    m[:3, 3] = numbers(position)
    return pose_from_matrix(m)


def pose_numbers(given: ArrayLike) -> list[float]:
    """Six numbers of a pose that is given as six numbers or as a 4×4 matrix."""
    a = numbers(given)
    if a.shape == (4, 4):
        a = pose_from_matrix(a)
    if a.shape != (6,):
        raise Error(
            f"an array of shape {a.shape} is no pose",
            remedy="give x y z α β γ or a 4×4 matrix; for quaternions see pose_from_xyz_qxyzw",
        )
    return [float(v) for v in a]


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh. It need not be closed.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Metres.
    triangles : array_like of int, shape (m, 3)
        Indices of vertices.
    solid : bool
        Whether it has an inside, as boxes, spheres and cylinders have. It must be closed then.

    Examples
    --------
    >>> mp.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    Mesh(3 vertices, 1 triangles)
    """

    vertices: Array
    triangles: NDArray[np.uint32]
    solid: bool

    def __init__(self, vertices: ArrayLike, triangles: ArrayLike, *, solid: bool = False) -> None:
        v = np.array(numbers(vertices), order="C")
        t = np.asarray(triangles)
        if v.ndim != 2 or v.shape[1] != 3:
            raise Error(f"vertices have the shape {v.shape}", remedy="give an array of shape (n, 3)")
        if t.ndim != 2 or t.shape[1] != 3:
            raise Error(f"triangles have the shape {t.shape}", remedy="give an array of shape (m, 3)")
        if t.dtype.kind not in "iuf" or (t != np.rint(t)).any():
            raise Error(f"triangles of {t.dtype} are no indices of vertices", remedy="give whole numbers")
        if t.size and (t.min() < 0 or t.max() >= len(v)):
            raise Error(
                f"a triangle names vertex {t.min() if t.min() < 0 else t.max()}, of {len(v)}",
                remedy="indices of vertices begin with 0",
            )
        object.__setattr__(self, "vertices", v)
        object.__setattr__(self, "triangles", np.array(t, dtype=np.uint32, order="C"))
        object.__setattr__(self, "solid", solid)

    @classmethod
    def load(cls, file: str | os.PathLike[str], *, solid: bool = False) -> Mesh:
        """Read a mesh: OFF, OBJ, STL, COLLADA, PLY or GEMPA text, by the ending of the file.

        Parameters
        ----------
        file : path
            The file.
        solid : bool
            Whether it has an inside.

        Raises
        ------
        Error
            When it cannot be read or is not valid, with file and line.
        """
        vertices, triangles = _mp.read_mesh(file)
        return cls(vertices, triangles, solid=solid)

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.triangles)} triangles)"


@dataclass(frozen=True)
class Box:
    """A box about its origin.

    Parameters
    ----------
    x, y, z : float
        The lengths of its sides, metres.
    """

    x: float
    y: float
    z: float


@dataclass(frozen=True)
class Sphere:
    """A sphere about its origin. Planning takes a mesh that contains it, larger by at most 2%.

    Parameters
    ----------
    radius : float
        Metres.
    """

    radius: float


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about Z. Planning takes a mesh that contains it, larger by at most 0.5%.

    Parameters
    ----------
    radius, height : float
        Metres.
    """

    radius: float
    height: float


@dataclass(frozen=True)
class Capsule:
    """All points near a segment of the axis Z. Planning takes a mesh that contains it, larger by at most 1%.

    Parameters
    ----------
    radius : float
        Metres.
    length : float
        Of the segment, metres: the capsule is longer by two radii.
    """

    radius: float
    length: float


@dataclass(frozen=True)
class Cone:
    """A cone about Z, apex up. Planning takes a mesh that contains it, larger by at most 0.5%.

    Parameters
    ----------
    radius, height : float
        Metres.
    """

    radius: float
    height: float


@dataclass(frozen=True, eq=False)
class Hull:
    """The convex hull of points.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Metres; at most 10,000, not all in one plane.
    """

    points: ArrayLike


@dataclass(frozen=True, eq=False)
class Points:
    """Points, such as those of a depth camera, each with a ball around it.

    Of the points in a cell of a grid one is kept, with a ball that contains those of the others. Points that are not finite are
    left out.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Metres.
    radius : float
        Of the balls, metres.
    cell : float, optional
        The side of a cell, metres. By default half of the radius.
    """

    points: ArrayLike
    radius: float
    cell: float | None = None


@dataclass(frozen=True, eq=False)
class HeightField:
    """Ground of varying height over a grid that is centred on the origin.

    Parameters
    ----------
    heights : array_like, shape (ny, nx)
        Metres: a row for each y, from the least.
    cell : (float, float)
        The lengths of a cell in x and y, metres.
    bottom : float, optional
        How far down the ground reaches, metres. By default as far below the lowest height as a cell is long.
    """

    heights: ArrayLike
    cell: tuple[float, float]
    bottom: float | None = None


class OtherMesh(Protocol):
    """A mesh of another library, such as ``trimesh.Trimesh``: a surface, as files of meshes are."""

    @property
    def vertices(self) -> Any:
        """Array_like, shape (n, 3), metres."""

    @property
    def faces(self) -> Any:
        """Array_like of int, shape (m, 3): triangles."""


Shape: TypeAlias = Mesh | OtherMesh | Box | Sphere | Cylinder | Capsule | Cone | Hull | Points | HeightField


@dataclass(frozen=True, eq=False)
class Body:
    """An obstacle: a shape at a pose.

    Parameters
    ----------
    shape : Mesh, Box, Sphere, Cylinder, Capsule, Cone, Hull, Points, HeightField or trimesh.Trimesh
        Its shape.
    pose : array_like, shape (6,) or (4, 4)
        Where it is: ``x y z α β γ`` (m, rad) or a matrix. By default the origin.
    name : str, optional
        What messages call it.
    """

    shape: Shape
    pose: ArrayLike = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    name: str | None = None


@dataclass(frozen=True)
class Attached:
    """A body that a link of an arm carries.

    Parameters
    ----------
    shape : Mesh, Box, Sphere, Cylinder, Capsule, Cone, Hull, Points, HeightField or trimesh.Trimesh
        Its shape.
    link : str
        The link that carries it.
    pose : array_like, shape (6,) or (4, 4)
        Where it is in the frame of the link: ``x y z α β γ`` (m, rad) or a matrix. By default the origin.
    name : str, optional
        What messages call it, and goals.
    may_touch : sequence of str
        Links that it may touch, such as the fingers that hold it.
    """

    shape: Shape
    link: str
    pose: ArrayLike = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    name: str | None = None
    may_touch: Sequence[str] = ()


@dataclass(frozen=True)
class Disc:
    """A disc in the plane, as a robot.

    Parameters
    ----------
    radius : float
        Metres.
    """

    radius: float


@dataclass(frozen=True)
class Rectangle:
    """A rectangle in the plane, as an obstacle.

    Parameters
    ----------
    low, high : (float, float)
        Two opposite corners, metres.
    """

    low: tuple[float, float]
    high: tuple[float, float]
    name: str | None = None


@dataclass(frozen=True)
class Circle:
    """A circle in the plane, as an obstacle. Planning takes a polygon that contains it, larger by at most 0.5%.

    Parameters
    ----------
    x, y, radius : float
        Metres.
    """

    x: float
    y: float
    radius: float
    name: str | None = None


@dataclass(frozen=True)
class Polygon:
    """A polygon in the plane, as an obstacle or as a robot, which turns about its origin.

    Parameters
    ----------
    corners : sequence of (float, float)
        Metres. The last corner is joined to the first.
    holes : sequence of polygons, optional
        Rings inside, of obstacles.
    """

    corners: Sequence[tuple[float, float]]
    holes: Sequence[Sequence[tuple[float, float]]] = field(default=())
    name: str | None = None


def shape_members(shape: Shape, files: dict[str, bytes]) -> dict[str, Any]:
    """Members of a shape in a scene file. Meshes and points go into `files`."""
    match shape:
        case Box(x, y, z):
            return {"box": [float(x), float(y), float(z)]}
        case Sphere(radius):
            return {"sphere": float(radius)}
        case Cylinder(radius, height):
            return {"cylinder": [float(radius), float(height)]}
        case Capsule(radius, length):
            return {"capsule": [float(radius), float(length)]}
        case Cone(radius, height):
            return {"cone": [float(radius), float(height)]}
        case Hull():
            return {"hull": _rows(shape.points, "points")}
        case Points():
            name, content = f"points-{len(files) + 1}.npy", io.BytesIO()
            np.save(content, _array(shape.points, "points"), allow_pickle=False)
            files[name] = content.getvalue()
            cell = {} if shape.cell is None else {"cell": float(shape.cell)}
            return {"points": {"radius": float(shape.radius), "file": name} | cell}
        case HeightField():
            heights = numbers(shape.heights)
            if heights.ndim != 2:
                raise Error(f"heights have the shape {heights.shape}", remedy="give an array of shape (ny, nx)")
            bottom = {} if shape.bottom is None else {"bottom": float(shape.bottom)}
            return {"height_field": {"cell": [float(c) for c in shape.cell], "heights": heights.tolist()} | bottom}
        case Mesh():
            name = f"mesh-{len(files) + 1}.off"
            files[name] = _mp.mesh_off(shape.vertices, shape.triangles)
            return {"mesh": name} | ({"solid": True} if shape.solid else {})
        case object(vertices=vertices, faces=faces):
            return shape_members(Mesh(vertices, faces), files)
        case _:
            pass
    raise Error(
        f"{shape!r} is no shape",
        remedy="give a Mesh, a Box, a Sphere, a Cylinder, a Capsule, a Cone, a Hull, Points or a HeightField",
    )


def _rows(points: ArrayLike, what: str) -> list[list[float]]:
    return [[float(v) for v in row] for row in _array(points, what)]


def _array(points: ArrayLike, what: str) -> Array:
    rows = np.ascontiguousarray(numbers(points))
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise Error(f"{what} have the shape {rows.shape}", remedy="give an array of shape (n, 3)")
    return rows


def body_members(body: Body | Shape, files: dict[str, bytes]) -> dict[str, Any]:
    """Members of an obstacle in a scene file. Meshes go into `files`."""
    body = body if isinstance(body, Body) else Body(body)
    name = {} if body.name is None else {"name": body.name}
    return name | shape_members(body.shape, files) | {"pose": pose_numbers(body.pose)}


def attached_members(body: Attached, files: dict[str, bytes]) -> dict[str, Any]:
    """Members of what a link carries in a scene file. Meshes go into `files`."""
    members = body_members(Body(body.shape, body.pose, body.name), files)
    return members | {"link": body.link, "may_touch": list(body.may_touch)}


def planar_members(shape: Rectangle | Circle | Polygon) -> dict[str, Any]:
    """Members of an obstacle of the plane in a scene file."""
    name = {} if shape.name is None else {"name": shape.name}
    match shape:
        case Rectangle(low, high):
            return name | {"rectangle": plain([low, high])}
        case Circle(x, y, radius):
            return name | {"circle": plain([x, y, radius])}
        case Polygon(corners, holes):
            return name | {"polygon": plain(corners)} | ({"holes": plain(holes)} if len(holes) else {})
    raise Error(f"{shape!r} is no obstacle of the plane", remedy="give a Rectangle, a Circle or a Polygon")


def plain(value: Any) -> Any:
    """Turn arrays and numbers of numpy, also within, into those of Python."""
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return _plain_members(value)  # pyright: ignore[reportUnknownArgumentType]
    if isinstance(value, list | tuple):
        return [plain(item) for item in cast("Sequence[Any]", value)]
    if isinstance(value, os.PathLike):
        return os.fspath(cast("os.PathLike[str]", value))
    return value


def _plain_members(members: Mapping[Any, Any]) -> dict[str, Any]:
    return {str(key): plain(item) for key, item in members.items() if item is not None}
