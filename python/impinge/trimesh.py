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

from collections.abc import Callable, Hashable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from impinge import _impinge, fcl
from impinge._arrays import plain_faces
from impinge._errors import InputError
from impinge._manager_answers import ContactData, Contacts, DistanceData
from impinge._manager_meshes import object_of, set_matrix
from impinge._mesh import HasTriangles, Mesh

__all__ = ["CollisionManager", "ContactData", "DistanceData", "mesh_to_BVH", "mesh_to_convex", "scene_to_collision"]

_EXTERNAL = "__external"
"""Name of a mesh in contact data that is in no manager."""


_Answer = bool | tuple[Any, ...]
_Distance = float | tuple[Any, ...]


class CollisionManager(_impinge.ManagerBase):
    """Named meshes that are queried together, as with trimesh's class of this name.

    Every collision query returns whether there is a collision. If `return_names` or `return_data`
    is set, it returns a tuple of this, the set of the names that collide, and a list of
    `ContactData` for every contact, in this order.

    The manager keeps a tree over the boxes of the meshes. A mesh that moves is marked, and the next
    query moves its box.
    """

    def __init__(self) -> None:
        self._objects: dict[Hashable, tuple[int, fcl.CollisionObject]] = {}
        """Keys and objects by their names."""
        self._names: dict[int, Hashable] = {}
        """Names by keys."""

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
        made = object_of(mesh, transform)
        self._add(name, made)
        return made

    def _add(self, name: Hashable, made: fcl.CollisionObject) -> None:
        replaced = self._objects.get(name)
        key = self._insert(made, None if replaced is None else replaced[0])
        self._objects[name], self._names[key] = (key, made), name

    def remove_object(self, name: Hashable) -> None:
        """Remove a mesh. Raise a `ValueError` if there is no mesh with this name."""
        key, _ = self._named(name)
        self._remove(key)
        del self._objects[name], self._names[key]

    def set_transform(self, name: Hashable, transform: ArrayLike) -> None:
        """Set the transform of a mesh, (4, 4), world from mesh.

        Raise a `ValueError` if there is no mesh with this name.
        """
        _, own = self._named(name)
        set_matrix(own, transform)

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
        other = object_of(mesh, transform)
        return self._collisions(other, {0: _EXTERNAL}, _first, return_names, return_data)

    def in_collision_internal(self, return_names: bool = False, return_data: bool = False) -> _Answer:
        """Report whether any two meshes of the manager collide; touching counts.

        If requested, the pairs of names that collide, each in alphabetical order, and a list of
        `ContactData` follow.
        """
        return self._collisions(None, self._names, _alphabetical, return_names, return_data)

    def in_collision_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> _Answer:
        """Report whether any mesh collides with a mesh of another manager; touching counts.

        If requested, the pairs of names that collide, the name in this manager first, and a list of
        `ContactData` follow.
        """
        return self._collisions(other_manager, other_manager._names, _in_order, return_names, return_data)

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
        other = object_of(mesh, transform)
        return self._minimum_distance(
            _impinge.manager_nearest(self, other, None), {0: _EXTERNAL}, _first, return_name, return_data
        )

    def min_distance_internal(
        self, name: Hashable = None, return_names: bool = False, return_data: bool = False
    ) -> _Distance:
        """Return the minimum distance of any two meshes of the manager, or of one from all others.

        The result is as for `min_distance_single`; infinite if there are no two meshes. If
        requested, the names of the nearest two meshes, in alphabetical order, and a `DistanceData`
        follow. Raise a `ValueError` if there is no mesh with the given name.
        """
        if name is None:
            found, others = _impinge.manager_nearest(self, None, None), self._names
        else:
            key, own = self._named(name)
            found, others = _impinge.manager_nearest(self, own, key), {0: name}
        return self._minimum_distance(found, others, _alphabetical, return_names, return_data)

    def min_distance_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> _Distance:
        """Return the minimum distance of any mesh from any mesh of another manager.

        The result is as for `min_distance_single`; infinite if a manager is empty. If requested,
        the names of the nearest two meshes, the name in this manager first, and a `DistanceData`
        follow.
        """
        found = _impinge.manager_nearest(self, other_manager, None)
        return self._minimum_distance(found, other_manager._names, _in_order, return_names, return_data)

    def _named(self, name: Hashable) -> tuple[int, fcl.CollisionObject]:
        found = self._objects.get(name)
        if found is None:
            raise InputError(f"{name} not in collision manager!", kind="name", what="name")
        return found

    def _collisions(
        self,
        other: CollisionManager | fcl.CollisionObject | None,
        other_names: dict[int, Hashable],
        convert_names: Callable[[tuple[Any, Any]], object],
        return_names: bool,
        return_data: bool,
    ) -> _Answer:
        """Return whether any pair collides, and, if requested, names and contacts.

        Pairs are those within this manager, or those with `other`, whose names are `other_names`.
        `convert_names` converts the names of a pair to the form that the caller returns.
        """
        if not (return_names or return_data):
            return _impinge.manager_any(self, other) is not None
        found = _impinge.manager_contacts(self, other) if return_data else None
        keys = _impinge.manager_pairs(self, other) if found is None else found.pairs()
        own_names = self._names
        pairs = [(own_names[a], other_names[b]) for a, b in keys]
        chosen: list[Any] = [bool(pairs)]
        if return_names:
            chosen.append(set(map(convert_names, pairs)))
        if found is not None:
            rows = Contacts(pairs, found.faces(), found)
            chosen.append([ContactData(rows, row) for row in range(len(rows.faces))])
        return tuple(chosen)

    def _minimum_distance(
        self,
        found: tuple[Any, ...] | None,
        other_names: dict[int, Hashable],
        convert_names: Callable[[tuple[Any, Any]], object],
        return_names: bool,
        return_data: bool,
    ) -> _Distance:
        """Return the minimum distance, and, if requested, names and data.

        `found` is the nearest pair, the first key of this manager and the second key of the other;
        None if the distance is infinite. The other arguments are those of `_collisions`.
        """
        if found is None:
            return (np.inf, *[None] * (return_names + return_data)) if return_names or return_data else np.inf
        (a, b), distance, faces, points = found
        if not (return_names or return_data):
            return float(distance)
        names = self._names[a], other_names[b]
        chosen: list[Any] = [distance]
        if return_names:
            chosen.append(convert_names(names))
        if return_data:
            chosen.append(DistanceData(names, distance, faces, points))
        return tuple(chosen)

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how to make an equal manager."""
        return type(self), (), [(name, own) for name, (_, own) in self._objects.items()]

    def __setstate__(self, named: list[tuple[Hashable, fcl.CollisionObject]]) -> None:
        """Add the objects."""
        for name, own in named:
            self._add(name, own)


def _first(names: tuple[Any, Any]) -> object:
    return names[0]


def _in_order(names: tuple[Any, Any]) -> tuple[Any, Any]:
    return names


def _alphabetical(names: tuple[Any, Any]) -> tuple[Any, Any]:
    a, b = names
    return (b, a) if b < a else names


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
