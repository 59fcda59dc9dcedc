"""A drop-in replacement for ``trimesh.collision``: import ``CollisionManager`` from here instead.

Method names, arguments and return values are those of trimesh. A mesh that trimesh finds convex is
a solid, which intersects anything inside it; any other mesh is a surface. Answers are those of
impinge: they are exact, and every pair of faces is reported once, without a limit on contacts.
Transforms keep double precision.

Differences from trimesh: the normal and depth of a contact are those of the two convex bodies, the
shortest way to separate them, or those of the region in which two surfaces penetrate each other.
They are not those of two triangles. If a body lies inside a convex one and their surfaces do not
intersect, there is one contact without faces (-1). The distance of two overlapping convex bodies is
minus their depth. The distance of two other colliding bodies is -1 if one of them is convex, and 0
if neither is.

Examples
--------
>>> import impinge
>>> from impinge.trimesh import CollisionManager
>>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> manager = CollisionManager()
>>> _ = manager.add_object("here", triangle)
>>> _ = manager.add_object("there", triangle, impinge.pose([5, 0, 0]))
>>> manager.in_collision_single(triangle, impinge.pose([4, 0, 0]), return_names=True)
(True, {'there'})
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _bodies, fcl
from impinge._arrays import plain_faces, plain_reals
from impinge._errors import InputError
from impinge._mesh import HasTriangles, Mesh
from impinge.fcl._manager import nearest_first

__all__ = ["CollisionManager", "ContactData", "DistanceData", "mesh_to_BVH", "mesh_to_convex", "scene_to_collision"]

_EXTERNAL = "__external"
"""Name of a mesh in contact data that is in no manager."""


class ContactData:
    """Two faces in contact, or two bodies of which one is inside the other.

    Attributes
    ----------
    names : set of str
        Names of the two objects; ``"__external"`` for an object that is in no manager.
    point : (3,) float64 array
        A common point of both faces, or of both bodies, in the world frame, rounded.
    normal : (3,) float64 array
        Unit vector in the world frame, from the mesh of this manager to the other one, or from the
        mesh that was added first to the other one.
    depth : float
        In world units, at least zero. Two convex bodies, or a body inside another one: the upper
        bound of `impinge.penetration`. Otherwise: the depth of the region in which the surfaces
        penetrate each other, rounded. It is not the depth of the two faces.
    """

    def __init__(self, names: tuple[Hashable, Hashable], contact: fcl.Contact) -> None:
        self.names = set(names)
        self._faces = {names[0]: contact.b1, names[1]: contact.b2}
        self.point, self.normal, self.depth = contact.pos, contact.normal, contact.penetration_depth

    def index(self, name: Hashable) -> int:
        """Return the face in contact of the object with this name, as an index into its faces.

        It is -1 if one object is inside the other. Raise a `KeyError` for another name.
        """
        return self._faces[name]


class DistanceData:
    """Distance of two objects, and their nearest points.

    Attributes
    ----------
    names : set of str
        Names of the two objects; ``"__external"`` for an object that is in no manager.
    distance : float
        In world units: the upper bound of `impinge.distance`. Minus the depth if two convex bodies
        overlap, -1 if a convex body and a surface collide, and 0 if two surfaces intersect.
    """

    def __init__(self, names: tuple[Hashable, Hashable], result: fcl.DistanceResult) -> None:
        self.names = set(names)
        self.distance = result.min_distance
        self._faces = {names[0]: result.b1, names[1]: result.b2}
        self._points = dict(zip(names, result.nearest_points, strict=True))

    def index(self, name: Hashable) -> int:
        """Return the nearest face of the object with this name, as an index into its faces.

        It is -1 if the object is convex, or is a surface inside a convex one. Raise a `KeyError`
        for another name.
        """
        return self._faces[name]

    def point(self, name: Hashable) -> NDArray[np.float64]:
        """Return the nearest point, (3,), of the object with this name, in the world frame.

        It is rounded. It is zero if a convex object and a surface collide, and the deepest point if
        two convex objects overlap. Raise a `KeyError` for another name.
        """
        return self._points[name]


_Named = tuple[Hashable, fcl.CollisionObject]
_Answer = bool | tuple[Any, ...]
_Distance = float | tuple[Any, ...]


class CollisionManager:
    """Named meshes that are queried together, as with trimesh's class of this name.

    Every collision query returns whether there is a collision. If `return_names` or `return_data`
    is set, it returns a tuple of this, the set of the names that collide, and a list of
    `ContactData` for every contact, in this order.
    """

    def __init__(self) -> None:
        self._objects: dict[Hashable, fcl.CollisionObject] = {}

    def add_object(
        self, name: Hashable, mesh: HasTriangles | Mesh, transform: ArrayLike | None = None
    ) -> fcl.CollisionObject:
        """Add a mesh, or replace the mesh with the same name.

        Parameters
        ----------
        name : str
            Name of the object.
        mesh : trimesh.Trimesh or Mesh
            A mesh whose ``is_convex`` is true is a solid.
        transform : (4, 4) array_like, optional
            World from mesh; the default is the identity.

        Returns
        -------
        impinge.fcl.CollisionObject
            The object that the manager stores under the name.

        Raises
        ------
        InputError
            If the mesh or the transform is invalid.
        """
        made = _object(mesh, transform)
        self._objects[name] = made
        return made

    def remove_object(self, name: Hashable) -> None:
        """Remove a mesh. Raise a `ValueError` if there is no mesh with this name."""
        del self._objects[self._check_name(name)]

    def set_transform(self, name: Hashable, transform: ArrayLike) -> None:
        """Set the transform of a mesh, (4, 4), world from mesh.

        Raise a `ValueError` if there is no mesh with this name.
        """
        self._objects[self._check_name(name)].setTransform(_transform(transform))

    def in_collision_single(
        self,
        mesh: HasTriangles | Mesh,
        transform: ArrayLike | None = None,
        return_names: bool = False,
        return_data: bool = False,
    ) -> _Answer:
        """Report whether a mesh collides with any mesh of the manager; touching counts.

        `transform` is world from mesh. If requested, the names of the colliding meshes of the
        manager and a list of `ContactData` follow.
        """
        other = (_EXTERNAL, _object(mesh, transform))
        pairs = [((name, own), other) for name, own in self._objects.items()]
        return _collisions(pairs, lambda names: names[0], return_names, return_data)

    def in_collision_internal(self, return_names: bool = False, return_data: bool = False) -> _Answer:
        """Report whether any two meshes of the manager collide; touching counts.

        If requested, the pairs of names that collide, each in alphabetical order, and a list of
        `ContactData` follow.
        """
        pairs = combinations(self._objects.items(), 2)
        return _collisions(pairs, lambda names: tuple(sorted(names)), return_names, return_data)

    def in_collision_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> _Answer:
        """Report whether any mesh collides with a mesh of another manager; touching counts.

        If requested, the pairs of names that collide, the name in this manager first, and a list of
        `ContactData` follow.
        """
        pairs = product(self._objects.items(), other_manager._objects.items())
        return _collisions(pairs, lambda names: names, return_names, return_data)

    def min_distance_single(
        self,
        mesh: HasTriangles | Mesh,
        transform: ArrayLike | None = None,
        return_name: bool = False,
        return_data: bool = False,
    ) -> _Distance:
        """Return the minimum distance of a mesh from the meshes of the manager, in world units.

        It is infinite if the manager is empty. Intersecting surfaces have distance 0. A solid (a
        convex mesh) that collides with a surface gives -1, and two solids that overlap give minus
        the depth. `transform` is world from mesh. If requested, the name of the nearest mesh in the
        manager and a `DistanceData` follow, or None twice if the distance is infinite.
        """
        other = (_EXTERNAL, _object(mesh, transform))
        pairs = [((name, own), other) for name, own in self._objects.items()]
        return _minimum_distance(pairs, lambda names: names[0], return_name, return_data)

    def min_distance_internal(
        self, name: Hashable = None, return_names: bool = False, return_data: bool = False
    ) -> _Distance:
        """Return the minimum distance of any two meshes of the manager, or of one from all others.

        The result is as for `min_distance_single`; infinite if there are no two meshes. If
        requested, the names of the nearest two meshes, in alphabetical order, and a `DistanceData`
        follow. Raise a `ValueError` if there is no mesh with the given name.
        """
        pairs = list(combinations(self._objects.items(), 2))
        if name is not None:
            self._check_name(name)
            pairs = [pair for pair in pairs if name in (pair[0][0], pair[1][0])]
        return _minimum_distance(pairs, lambda names: tuple(sorted(names)), return_names, return_data)

    def min_distance_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> _Distance:
        """Return the minimum distance of any mesh from any mesh of another manager.

        The result is as for `min_distance_single`; infinite if a manager is empty. If requested,
        the names of the nearest two meshes, the name in this manager first, and a `DistanceData`
        follow.
        """
        pairs = list(product(self._objects.items(), other_manager._objects.items()))
        return _minimum_distance(pairs, lambda names: names, return_names, return_data)

    def _check_name(self, name: Hashable) -> Hashable:
        if name not in self._objects:
            raise InputError(f"{name} not in collision manager!", kind="name", what="name")
        return name


def mesh_to_BVH(mesh: HasTriangles) -> fcl.BVHModel:  # noqa: N802
    """Return the surface of a mesh as a `BVHModel` of `impinge.fcl`, in the mesh frame."""
    model = fcl.BVHModel()
    model.beginModel(len(mesh.faces), len(mesh.vertices))
    model.addSubModel(mesh.vertices, mesh.faces)
    model.endModel()
    return model


def mesh_to_convex(mesh: HasTriangles) -> fcl.Convex:
    """Return a convex mesh as a solid geometry of `impinge.fcl`; convexity is not checked."""
    faces = np.asarray(plain_faces(mesh.faces), np.int64)
    return fcl.Convex(mesh.vertices, len(faces), np.insert(faces, 0, 3, axis=1).ravel().tolist())


def scene_to_collision(scene: Any) -> tuple[CollisionManager, dict[Hashable, fcl.CollisionObject]]:
    """Return a manager with the meshes of a ``trimesh.Scene``, and a dict of its objects.

    The name of an object is that of its node in the scene.
    """
    manager = CollisionManager()
    objects = {}
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        objects[node] = manager.add_object(node, scene.geometry[geometry], transform)
    return manager, objects


class _Geometry(fcl.CollisionGeometry):
    """A mesh as a geometry, without copying it."""

    def __init__(self, body: _bodies.Body) -> None:
        super().__init__()
        self._body = body


def _object(mesh: HasTriangles | Mesh, transform: ArrayLike | None) -> fcl.CollisionObject:
    solid = bool(getattr(mesh, "is_convex", False))
    body = _bodies.Body(mesh if isinstance(mesh, Mesh) else Mesh(mesh), solid=solid)
    return fcl.CollisionObject(_Geometry(body), None if transform is None else _transform(transform))


def _transform(transform: ArrayLike) -> fcl.Transform:
    matrix = plain_reals(transform, "transform", ())
    if matrix.shape != (4, 4):
        raise InputError("transform must be (4,4)!", kind="shape", what="transform")
    return fcl.Transform(matrix[:3, :3], matrix[:3, 3])


def _collisions(
    pairs: Iterable[tuple[_Named, _Named]],
    convert_names: Callable[[tuple[Any, Any]], object],
    return_names: bool,
    return_data: bool,
) -> _Answer:
    """Return whether any of the pairs collides, and, if requested, names and contacts.

    `convert_names` converts the names of a colliding pair to the form that the caller returns.
    """
    names: set[object] = set()
    data: list[ContactData] = []
    hit = False
    boxes: dict[int, NDArray[np.float64]] = {}
    for (name_a, a), (name_b, b) in pairs:
        low_a, high_a = boxes.setdefault(id(a), a.box)
        low_b, high_b = boxes.setdefault(id(b), b.box)
        if not ((low_a <= high_b) & (low_b <= high_a)).all():
            continue
        if not _bodies.collide(a.geometry.body, b.geometry.body, a.matrix, b.matrix):
            continue
        if return_data:
            result = fcl.CollisionResult()
            fcl.collide(a, b, fcl.CollisionRequest(np.iinfo(np.int64).max, enable_contact=True), result)
            data += [ContactData((name_a, name_b), contact) for contact in result.contacts]
        hit = True
        names.add(convert_names((name_a, name_b)))
        if not (return_names or return_data):
            break
    chosen = [hit, *([names] if return_names else []), *([data] if return_data else [])]
    return hit if len(chosen) == 1 else tuple(chosen)


def _minimum_distance(
    pairs: Sequence[tuple[_Named, _Named]],
    convert_names: Callable[[tuple[Any, Any]], object],
    return_names: bool,
    return_data: bool,
) -> _Distance:
    """Return the minimum distance of the pairs, and, if requested, names and data.

    The distance is infinite if there are no pairs. `convert_names` converts the names of the
    nearest pair to the form that the caller returns.
    """
    request = fcl.DistanceRequest(enable_nearest_points=return_data, enable_signed_distance=True)
    best: tuple[tuple[Hashable, Hashable] | None, fcl.DistanceResult] = (None, fcl.DistanceResult())
    named = {(id(a), id(b)): (name_a, name_b) for (name_a, a), (name_b, b) in pairs}

    def measure(o1: fcl.CollisionObject, o2: fcl.CollisionObject, minimum: float) -> tuple[bool, float]:
        nonlocal best
        result = fcl.DistanceResult()
        if fcl.distance(o1, o2, request, result) < minimum:
            best = named[id(o1), id(o2)], result
        return False, best[1].min_distance

    nearest_first([(a, b) for (_, a), (_, b) in pairs], measure)
    names, result = best
    data = None if names is None else DistanceData(names, result)
    chosen = [convert_names(names) if names else None] if return_names else []
    chosen += [data] if return_data else []
    return (result.min_distance, *chosen) if chosen else result.min_distance
