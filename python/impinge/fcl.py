"""A stand-in for the part of python-fcl that collides: ``from impinge import fcl`` in place of ``import fcl``.

Names, arguments and conventions are python-fcl's: a `BVHModel` is a surface, a `Box` and a `Convex` are solids, which
meet what lies inside them. Answers are impinge's: exact, without false or missing contacts, each pair of faces once.

What differs: a contact has its objects, faces and position, but no normal and no depth yet; two bodies one of which is
inside the other, their surfaces apart, have one contact without faces (-1). Spheres, capsules, cones and other round
shapes, distances and continuous collision are not there yet.

Examples
--------
>>> from impinge import fcl
>>> request, result = fcl.CollisionRequest(num_max_contacts=100), fcl.CollisionResult()
>>> small, large = fcl.CollisionObject(fcl.Box(1, 1, 1)), fcl.CollisionObject(fcl.Box(4, 4, 4))
>>> fcl.collide(small, large, request, result)
1
>>> small.setTranslation([2.5, 0, 0])
>>> fcl.collide(small, large, request) > 1
True
>>> small.setTranslation([2.6, 0, 0])
>>> fcl.collide(small, large)
0
"""

# The names are python-fcl's.
# ruff: noqa: N802, N803

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _bodies
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._pose import pose

__all__ = [
    "BVHModel",
    "Box",
    "CollisionData",
    "CollisionGeometry",
    "CollisionObject",
    "CollisionRequest",
    "CollisionResult",
    "Contact",
    "Convex",
    "DynamicAABBTreeCollisionManager",
    "Transform",
    "TriangleP",
    "collide",
    "defaultCollisionCallback",
]


class Transform:
    """A rotation and a translation: ``Transform()``, ``(other)``, ``(R)``, ``(q)``, ``(t)``, ``(R, t)``, ``(q, t)``.

    ``R`` is a (3, 3) matrix, used as given; ``q`` a unit quaternion, real part first; ``t`` a translation.
    """

    def __init__(self, *args: Transform | ArrayLike) -> None:
        self.matrix: NDArray[np.float64] = np.eye(4)
        if len(args) > 2:
            raise InputError("too many arguments to Transform()", kind="option", what="args")
        if len(args) == 2:
            self._rotate(np.asarray(args[0], float))
            self.setTranslation(np.asarray(args[1], float).squeeze())
        elif args and isinstance(args[0], Transform):
            self.matrix = args[0].matrix.copy()
        elif args:
            value = np.asarray(args[0], float)
            if value.shape == (3,):
                self.setTranslation(value)
            else:
                self._rotate(value)

    def _rotate(self, value: NDArray[np.float64]) -> None:
        if value.shape == (4,):
            self.setQuatRotation(value)
        else:
            self.setRotation(value)

    def getRotation(self) -> NDArray[np.float64]:
        """Return the (3, 3) matrix."""
        return self.matrix[:3, :3].copy()

    def getTranslation(self) -> NDArray[np.float64]:
        """Return the (3,) translation."""
        return self.matrix[:3, 3].copy()

    def getQuatRotation(self) -> NDArray[np.float64]:
        """Return the unit quaternion, real part first."""
        return _quaternion(self.matrix[:3, :3])

    def setRotation(self, R: ArrayLike) -> None:
        """Set the (3, 3) matrix."""
        self.matrix = pose(self.matrix[:3, 3], rotation=_shaped(R, (3, 3), "R"))

    def setTranslation(self, T: ArrayLike) -> None:
        """Set the (3,) translation."""
        self.matrix = pose(_shaped(T, (3,), "T"), rotation=self.matrix[:3, :3])

    def setQuatRotation(self, q: ArrayLike) -> None:
        """Set the rotation to that of a unit quaternion, real part first."""
        self.matrix = pose(self.matrix[:3, 3], quat_wxyz=_shaped(q, (4,), "q"))


class CollisionGeometry:
    """What has a shape of its own, wherever it stands."""

    def __init__(self) -> None:
        self._body: _bodies.Body | None = None

    @property
    def body(self) -> _bodies.Body:
        """The shape."""
        if self._body is None:
            raise InputError(f"{type(self).__name__} is not finished: endModel() is missing", kind="input", what="geom")
        return self._body


class BVHModel(CollisionGeometry):
    """A surface of triangles, given between `beginModel` and `endModel`."""

    def __init__(self) -> None:
        super().__init__()
        self._vertices: list[NDArray[np.float64]] = []
        self._faces: list[NDArray[np.int64]] = []
        self._count = 0

    def num_tries_(self) -> int:
        """Return the number of triangles (the name is python-fcl's)."""
        return sum(map(len, self._faces))

    def beginModel(self, num_tris_: int = 0, num_vertices_: int = 0) -> int:
        """Begin anew; the numbers are hints that are not needed."""
        self._vertices, self._faces, self._count, self._body = [], [], 0, None
        return 0

    def addVertex(self, x: float, y: float, z: float) -> bool:
        """Add a vertex."""
        self._add(np.array([[x, y, z]], float), np.zeros((0, 3), np.int64))
        return True

    def addTriangle(self, v1: ArrayLike, v2: ArrayLike, v3: ArrayLike) -> bool:
        """Add a triangle of three positions."""
        self._add(np.array([v1, v2, v3], float), np.array([[0, 1, 2]]))
        return True

    def addSubModel(self, verts: ArrayLike, triangles: ArrayLike) -> bool:
        """Add (n, 3) positions and (m, 3) triangles of them."""
        self._add(np.asarray(verts, float).reshape(-1, 3), np.asarray(triangles, np.int64).reshape(-1, 3))
        return True

    def _add(self, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> None:
        self._faces.append(faces + self._count)
        self._vertices.append(vertices)
        self._count += len(vertices)

    def endModel(self) -> int:
        """Judge what was added and build the hierarchy; return 0."""
        vertices = np.concatenate([np.zeros((0, 3)), *self._vertices])
        faces = np.concatenate([np.zeros((0, 3), np.int64), *self._faces])
        self._body = _bodies.Body(Mesh(vertices, faces), solid=False)
        return 0


class Box(CollisionGeometry):
    """A solid box about the origin, with these side lengths."""

    def __init__(self, x: float, y: float, z: float) -> None:
        super().__init__()
        self._side = np.array([x, y, z], float)
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        mesh = Mesh(signs * self._side / 2, [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])
        self._body = _bodies.Body(mesh, solid=True)

    @property
    def side(self) -> NDArray[np.float64]:
        """The three side lengths."""
        return self._side.copy()


class Convex(CollisionGeometry):
    """A solid of (n, 3) vertices whose surface is convex.

    `faces` is one flat list: for each of the `num_faces` polygons the number of its corners, then these.
    """

    def __init__(self, vertices: ArrayLike, num_faces: int, faces: Iterable[int]) -> None:
        super().__init__()
        numbers = [int(number) for number in faces]
        triangles: list[tuple[int, int, int]] = []
        at = 0
        for _ in range(num_faces):
            corners = numbers[at + 1 : at + 1 + numbers[at]] if at < len(numbers) else []
            if len(corners) < 3 or len(corners) != numbers[at]:
                message = "the list ends within a polygon, or one has too few corners"
                raise InputError(message, kind="shape", what="faces")
            triangles += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
            at += 1 + len(corners)
        self._num_faces = num_faces
        self._body = _bodies.Body(Mesh(np.asarray(vertices, float), triangles), solid=True)

    @property
    def num_faces(self) -> int:
        """The number of polygons."""
        return self._num_faces


class TriangleP(CollisionGeometry):
    """One triangle."""

    def __init__(self, a: ArrayLike, b: ArrayLike, c: ArrayLike) -> None:
        super().__init__()
        self._body = _bodies.Body(Mesh(np.array([a, b, c], float), [[0, 1, 2]]), solid=False)


class CollisionObject:
    """A geometry and where it stands."""

    def __init__(self, geom: CollisionGeometry, tf: Transform | None = None) -> None:
        if not isinstance(geom, CollisionGeometry):
            message = f"must be a geometry of impinge.fcl, not {type(geom).__name__}"
            raise InputError(message, kind="type", what="geom")
        self.geometry = geom
        self._transform = Transform() if tf is None else Transform(tf)

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The (4, 4) pose, world from geometry."""
        return self._transform.matrix

    @property
    def box(self) -> NDArray[np.float64]:
        """Lower and upper corner, (2, 3), of a box in the world that holds the object."""
        return self.geometry.body.box_at(self.matrix)

    def getTransform(self) -> Transform:
        """Return a copy of the transform."""
        return Transform(self._transform)

    def setTransform(self, tf: Transform) -> None:
        """Set rotation and translation."""
        self._transform = Transform(tf)

    def getTranslation(self) -> NDArray[np.float64]:
        """Return the (3,) translation."""
        return self._transform.getTranslation()

    def setTranslation(self, vec: ArrayLike) -> None:
        """Set the (3,) translation."""
        self._transform.setTranslation(vec)

    def getRotation(self) -> NDArray[np.float64]:
        """Return the (3, 3) matrix."""
        return self._transform.getRotation()

    def setRotation(self, mat: ArrayLike) -> None:
        """Set the (3, 3) matrix."""
        self._transform.setRotation(mat)

    def getQuatRotation(self) -> NDArray[np.float64]:
        """Return the unit quaternion, real part first."""
        return self._transform.getQuatRotation()

    def setQuatRotation(self, q: ArrayLike) -> None:
        """Set the rotation to that of a unit quaternion, real part first."""
        self._transform.setQuatRotation(q)


class Contact:
    """Two faces that meet.

    Attributes
    ----------
    o1, o2 : CollisionGeometry
        The geometries.
    b1, b2 : int
        Their faces; -1 for both where one body is inside the other.
    pos : (3,) float64 array
        A point of the world that both have in common, rounded; only with ``enable_contact``.
    """

    def __init__(self, o1: CollisionGeometry, o2: CollisionGeometry, b1: int, b2: int) -> None:
        self.o1, self.o2, self.b1, self.b2 = o1, o2, b1, b2
        self.pos: NDArray[np.float64]


class CollisionRequest:
    """How many contacts are wanted, and whether their positions are."""

    def __init__(self, num_max_contacts: int = 1, enable_contact: bool = False) -> None:
        self.num_max_contacts = num_max_contacts
        self.enable_contact = enable_contact


class CollisionResult:
    """Whether anything collided so far, and the contacts."""

    def __init__(self) -> None:
        self.is_collision = False
        self.contacts: list[Contact] = []


class CollisionData:
    """What a callback of a manager is handed: the request, the result, and whether all is done."""

    def __init__(self, request: CollisionRequest | None = None, result: CollisionResult | None = None) -> None:
        self.request = CollisionRequest() if request is None else request
        self.result = CollisionResult() if result is None else result
        self.done = False


def collide(
    o1: CollisionObject,
    o2: CollisionObject,
    request: CollisionRequest | None = None,
    result: CollisionResult | None = None,
) -> int:
    """Add the contacts of two objects to the result, at most as many as requested, and return how many these are."""
    request = CollisionRequest() if request is None else request
    result = CollisionResult() if result is None else result
    a, b = o1.geometry.body, o2.geometry.body
    pairs = _bodies.contacts(a, b, o1.matrix, o2.matrix, request.num_max_contacts)
    found = [Contact(o1.geometry, o2.geometry, int(b1), int(b2)) for b1, b2 in pairs]
    if request.enable_contact and found:
        points = _bodies.contact_points(a, b, o1.matrix, o2.matrix, pairs)
        for contact, point in zip(found, points, strict=True):
            contact.pos = point
    result.contacts += found
    result.is_collision = result.is_collision or bool(found)
    return len(found)


def defaultCollisionCallback(o1: CollisionObject, o2: CollisionObject, cdata: CollisionData) -> bool:
    """Collide two objects; return whether the manager may stop: as many contacts as requested are there."""
    if not cdata.done:
        collide(o1, o2, cdata.request, cdata.result)
        cdata.done = cdata.result.is_collision and len(cdata.result.contacts) >= cdata.request.num_max_contacts
    return cdata.done


Callback = Callable[[CollisionObject, CollisionObject, Any], bool]


class DynamicAABBTreeCollisionManager:
    """Many objects, of which those whose boxes overlap are handed to a callback, in the order of registration."""

    def __init__(self) -> None:
        self._objects: list[CollisionObject] = []

    def registerObjects(self, other_objs: Sequence[CollisionObject]) -> None:
        """Add objects."""
        self._objects += other_objs

    def registerObject(self, obj: CollisionObject) -> None:
        """Add an object."""
        self._objects.append(obj)

    def unregisterObject(self, obj: CollisionObject) -> None:
        """Remove an object, if it is there."""
        self._objects = [own for own in self._objects if own is not obj]

    def setup(self) -> None:
        """Do nothing: boxes are looked up when asked about."""

    def update(self, arg: object = None) -> None:
        """Do nothing: boxes are looked up when asked about."""

    def clear(self) -> None:
        """Remove all objects."""
        self._objects.clear()

    def getObjects(self) -> list[CollisionObject]:
        """Return the objects."""
        return list(self._objects)

    def size(self) -> int:
        """Return the number of objects."""
        return len(self._objects)

    def empty(self) -> bool:
        """Return whether there are none."""
        return not self._objects

    def collide(self, *args: Any) -> None:
        """Hand pairs of objects to ``callback(o1, o2, cdata)`` until it returns True.

        ``collide(cdata, callback)`` asks within the manager, ``collide(other, cdata, callback)`` against an object or
        another manager.
        """
        if len(args) == 2:
            self._collide_within(*args)
        elif len(args) == 3 and isinstance(args[0], DynamicAABBTreeCollisionManager):
            self._collide_with(args[0]._objects, args[1], args[2])
        elif len(args) == 3 and isinstance(args[0], CollisionObject):
            self._collide_with([args[0]], args[1], args[2])
        else:
            message = "wants (cdata, callback), (manager, cdata, callback) or (object, cdata, callback)"
            raise InputError(message, kind="type", what="args")

    def _boxes(self) -> NDArray[np.float64]:
        return np.array([own.box for own in self._objects]).reshape(-1, 2, 3)

    def _collide_within(self, cdata: object, callback: Callback) -> None:
        boxes = self._boxes()
        for i, own in enumerate(self._objects):
            for j in _bodies.overlaps(boxes[i + 1 :], boxes[i]):
                if callback(own, self._objects[i + 1 + j], cdata):
                    return

    def _collide_with(self, others: list[CollisionObject], cdata: object, callback: Callback) -> None:
        boxes = self._boxes()
        for other in others:
            for i in _bodies.overlaps(boxes, other.box):
                if callback(self._objects[i], other, cdata):
                    return


def _shaped(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    array = np.asarray(value, float)
    if array.shape != shape:
        raise InputError(f"shape {array.shape}, where {shape} is expected", kind="shape", what=name)
    return array


def _quaternion(r: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the unit quaternion of a rotation: the row of its outer product with the largest diagonal entry."""
    outer = np.array(
        [
            [1 + r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], 1 + r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]],
            [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], 1 - r[0, 0] + r[1, 1] - r[2, 2], r[1, 2] + r[2, 1]],
            [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1 - r[0, 0] - r[1, 1] + r[2, 2]],
        ]
    )
    row = outer[int(np.argmax(np.diagonal(outer)))]
    unit: NDArray[np.float64] = row / np.linalg.norm(row)
    return unit if unit[0] >= 0 else -unit
