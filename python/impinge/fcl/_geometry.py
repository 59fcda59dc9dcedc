"""Surfaces, solids, and objects, which are geometries with a transform."""

# The names are those of python-fcl.
# ruff: noqa: N802

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._arrays import plain_numbers, plain_reals, plain_shaped
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._scalars import real, whole
from impinge._shape import Shape
from impinge.fcl._transform import Transform, quaternion_of, rotation_of

_MAX_INDEX = 2**32 - 1


class CollisionGeometry(_impinge.GeometryBase):
    """Base class of geometries: surfaces and solids in their own frame."""

    _body: tuple[Mesh | Shape, bool] | None = None
    """The mesh or shape of the queries, and whether it is solid; None before it is complete."""

    def _complete(self, thing: Mesh | Shape, *, solid: bool) -> None:
        self._set_body(thing, solid)
        self._body = thing, solid

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how to make an equal geometry."""
        return _remade, (type(self),), vars(self)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Set all attributes, and the body."""
        vars(self).update(state)
        if self._body is not None:
            self._set_body(*self._body)


def _remade(cls: type[CollisionGeometry]) -> CollisionGeometry:
    """Return a geometry without attributes."""
    return cls.__new__(cls)


class BVHModel(CollisionGeometry):
    """A surface of triangles, which are added between `beginModel` and `endModel`.

    It cannot be queried before `endModel`.
    """

    def __init__(self) -> None:
        super().__init__()
        self._vertices: list[NDArray[np.float64]] = []
        self._faces: list[NDArray[np.int64]] = []
        self._count = 0

    def num_tries_(self) -> int:
        """Return the number of triangles added so far (the name is that of python-fcl)."""
        return sum(map(len, self._faces))

    def beginModel(self, num_tris_: int = 0, num_vertices_: int = 0) -> int:
        """Start a new model without triangles, and return 0; the arguments are ignored."""
        self._vertices, self._faces, self._count, self._body = [], [], 0, None
        self._set_body(None, False)
        return 0

    def addVertex(self, x: float, y: float, z: float) -> bool:
        """Add a vertex in the frame of the model, without a triangle, and return True."""
        self._add(np.array([[real(x, "x"), real(y, "y"), real(z, "z")]]), np.zeros((0, 3), np.int64))
        return True

    def addTriangle(self, v1: ArrayLike, v2: ArrayLike, v3: ArrayLike) -> bool:
        """Add a triangle of three (3,) positions in the frame of the model, and return True."""
        self._add(_corners(v1=v1, v2=v2, v3=v3), np.array([[0, 1, 2]]))
        return True

    def addSubModel(self, verts: ArrayLike, triangles: ArrayLike) -> bool:
        """Add (n, 3) positions, in the model's frame, and (m, 3) triangles; return True.

        The indices of `triangles` refer to `verts`, and are validated by `endModel`.
        """
        faces = plain_numbers(triangles, "triangles", _MAX_INDEX).astype(np.int64)
        if faces.size % 3:
            raise InputError(f"has shape {faces.shape}; (m, 3) is expected", kind="shape", what="triangles")
        self._add(plain_reals(verts, "verts", (3,)).reshape(-1, 3), faces.reshape(-1, 3))
        return True

    def _add(self, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> None:
        self._faces.append(faces + self._count)
        self._vertices.append(vertices)
        self._count += len(vertices)

    def endModel(self) -> int:
        """Validate the triangles, build the hierarchy, and return 0.

        Raise an `InputError` if a vertex or a triangle is invalid.
        """
        vertices = np.concatenate([np.zeros((0, 3)), *self._vertices])
        faces = np.concatenate([np.zeros((0, 3), np.int64), *self._faces])
        self._complete(Mesh(vertices, faces), solid=False)
        return 0


class Box(CollisionGeometry):
    """A solid box with side lengths `x`, `y` and `z`, centered at the origin of its frame."""

    def __init__(self, x: float, y: float, z: float) -> None:
        super().__init__()
        self._side = np.array([real(x, "x"), real(y, "y"), real(z, "z")])
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        mesh = Mesh(signs * self._side / 2, [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])
        self._complete(mesh, solid=True)

    @property
    def side(self) -> NDArray[np.float64]:
        """A copy of the three side lengths along x, y and z, in the frame of the box."""
        return self._side.copy()


class Convex(CollisionGeometry):
    """A solid with (n, 3) vertices, in its own frame, and a convex surface; convexity is assumed.

    `faces` is a flat list: for each of the `num_faces` polygons the number of its corners, then the
    indices of its corners. An `InputError` is raised if the list is too short or invalid.
    """

    def __init__(self, vertices: ArrayLike, num_faces: int, faces: Iterable[int]) -> None:
        super().__init__()
        if not isinstance(faces, Iterable):
            raise InputError(f"must be a list, not {type(faces).__name__}", kind="type", what="faces")
        numbers: list[int] = plain_numbers(list(faces), "faces", _MAX_INDEX).tolist()
        num_faces = whole(num_faces, "num_faces")
        triangles: list[tuple[int, int, int]] = []
        at = 0
        for _ in range(num_faces):
            corners = numbers[at + 1 : at + 1 + numbers[at]] if at < len(numbers) else []
            if len(corners) < 3 or len(corners) != numbers[at]:
                message = f"the list ends within a polygon, or a polygon has fewer than 3 corners (at entry {at})"
                raise InputError(message, kind="shape", what="faces")
            triangles += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
            at += 1 + len(corners)
        self._num_faces = num_faces
        self._complete(Mesh(plain_reals(vertices, "vertices", (3,)), triangles), solid=True)

    @property
    def num_faces(self) -> int:
        """Number of polygons of the surface, as given, not of triangles."""
        return self._num_faces


class TriangleP(CollisionGeometry):
    """One triangle, a surface, with three (3,) corners in its own frame."""

    def __init__(self, a: ArrayLike, b: ArrayLike, c: ArrayLike) -> None:
        super().__init__()
        self._complete(Mesh(_corners(a=a, b=b, c=c), [[0, 1, 2]]), solid=False)


class CollisionObject(_impinge.ObjectBase):
    """A geometry with a transform, world from geometry; the default is the identity.

    The arguments are a `CollisionGeometry`, which several objects may share, and a `Transform`. The
    object keeps its body at the transform, so a query of an object that did not move places nothing
    again.
    """

    @property
    def geometry(self) -> CollisionGeometry:
        """The surface or solid, in its own frame."""
        geometry: CollisionGeometry = super().geometry
        return geometry

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Copy of the pose (4, 4) of the object, world from geometry."""
        return super().matrix

    @property
    def box(self) -> NDArray[np.float64]:
        """Lower and upper corners, (2, 3), of a world-frame box that contains the object.

        Infinite for a half-space; NaN if the object has no points.
        """
        return super().box

    def getTransform(self) -> Transform:
        """Return a copy of the transform, world from geometry."""
        matrix = self.matrix
        return Transform(matrix[:3, :3], matrix[:3, 3])

    def setTransform(self, tf: Transform) -> None:
        """Set the rotation and the translation, world from geometry."""
        self._set_transform(tf)

    def getTranslation(self) -> NDArray[np.float64]:
        """Return a copy of the (3,) translation, world from geometry, in world units."""
        return self.matrix[:3, 3].copy()

    def setTranslation(self, vec: ArrayLike) -> None:
        """Set the (3,) translation, world from geometry, in world units."""
        self._set_translation(vec, "T")

    def getRotation(self) -> NDArray[np.float64]:
        """Return a copy of the (3, 3) rotation matrix, world from geometry."""
        return self.matrix[:3, :3].copy()

    def setRotation(self, mat: ArrayLike) -> None:
        """Set the (3, 3) rotation matrix, world from geometry, used unchanged."""
        self._set_linear(mat, "R")

    def getQuatRotation(self) -> NDArray[np.float64]:
        """Return the rotation as a unit quaternion, rounded: real part first, at least zero."""
        return quaternion_of(self.matrix[:3, :3])

    def setQuatRotation(self, q: ArrayLike) -> None:
        """Set the rotation, world from geometry, to that of a unit quaternion, real part first.

        Raise an `InputError` unless its length is within 1e-3 of 1.
        """
        self._set_linear(rotation_of(q), "q")

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how to make an equal object."""
        return type(self), (self.geometry, self.getTransform())


def _corners(**corners: ArrayLike) -> NDArray[np.float64]:
    """Return (n, 3) positions from the arguments with these names."""
    return np.array([plain_shaped(corner, (3,), name) for name, corner in corners.items()])
