"""Meshes as the objects of `impinge.trimesh.CollisionManager`."""

from __future__ import annotations

import contextlib
import weakref
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from impinge import fcl
from impinge._errors import InputError
from impinge._mesh import HasTriangles, Mesh


class _Geometry(fcl.CollisionGeometry):
    """A mesh as a geometry."""

    def __init__(self, mesh: Mesh, *, solid: bool) -> None:
        self._complete(mesh, solid=solid)


_KNOWN: dict[int, tuple[weakref.ref[Any], _Geometry]] = {}
"""Geometries of meshes of other libraries that are alive, by the identities of the meshes. They are
used again if the mesh still has the same vertices and faces."""


def _geometry_of(mesh: HasTriangles | Mesh) -> _Geometry:
    """Return a mesh as a geometry: the last one of this mesh, if the mesh did not change."""
    if isinstance(mesh, Mesh):
        return _Geometry(mesh, solid=False)
    solid, identity = bool(getattr(mesh, "is_convex", False)), id(mesh)
    known = _KNOWN.get(identity)
    if known is not None and known[0]() is mesh and known[1]._is_of(mesh.vertices, mesh.faces, solid):
        return known[1]
    made = _Geometry(Mesh(mesh), solid=solid)
    with contextlib.suppress(TypeError):  # an object without weak references is converted each time
        _KNOWN[identity] = weakref.ref(mesh, lambda _: _KNOWN.pop(identity, None)), made
    return made


def object_of(mesh: HasTriangles | Mesh, transform: ArrayLike | None) -> fcl.CollisionObject:
    """Return an object of a mesh, at a transform (4, 4) or at the identity."""
    made = fcl.CollisionObject(_geometry_of(mesh))
    if transform is not None:
        set_matrix(made, transform)
    return made


def set_matrix(own: fcl.CollisionObject, transform: ArrayLike) -> None:
    """Set the transform of an object, (4, 4), world from geometry.

    Raise an `InputError` if it has another shape or is not finite.
    """
    if np.shape(transform) != (4, 4):
        raise InputError("transform must be (4,4)!", kind="shape", what="transform")
    own._set_matrix(transform, "transform")
