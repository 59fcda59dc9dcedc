"""Collision of two objects, and their contacts."""

# The names are those of python-fcl.
# ruff: noqa: N802

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge.fcl._geometry import CollisionGeometry, CollisionObject


class Contact:
    """Two faces in contact, or two geometries of which one is inside the other or has no mesh.

    Attributes
    ----------
    o1, o2 : CollisionGeometry
        The geometries of the first and the second object.
    b1, b2 : int
        Faces in contact, as indices into the faces of `o1` and `o2`; -1 for both if one body is
        inside the other or has no mesh.
    pos : (3,) float64 array
        A common point of both geometries in the world frame, rounded. `pos`, `normal` and
        `penetration_depth` exist only with ``enable_contact``.
    normal : (3,) float64 array
        Unit vector in the world frame, from the first object to the second. For two solids it is
        the shortest way to separate them. For surfaces it is the normal of the region in which they
        penetrate each other; faces are assumed to be counterclockwise as seen from outside.
    penetration_depth : float
        In world units, at least zero. For two solids, or a body inside a solid: the upper bound of
        `impinge.penetration`. With a geometry that is not a mesh: the upper bound at this contact.
        Otherwise: the depth of the region in which the surfaces penetrate each other, rounded.
    """

    __slots__ = ("b1", "b2", "normal", "o1", "o2", "penetration_depth", "pos")

    def __init__(
        self,
        o1: CollisionGeometry,
        o2: CollisionGeometry,
        faces: tuple[int, int],
        details: tuple[NDArray[np.float64], NDArray[np.float64], float] | None = None,
    ) -> None:
        self.o1, self.o2 = o1, o2
        self.b1, self.b2 = faces
        if details is not None:
            self.pos, self.normal, self.penetration_depth = details

    def __repr__(self) -> str:
        """Return the classes of the geometries and the faces."""
        return f"Contact({type(self.o1).__name__}, {type(self.o2).__name__}, b1={self.b1}, b2={self.b2})"


class CollisionRequest:
    """Options of `collide`.

    Computing the normals of surfaces takes as long as finding all their pairs, even if few contacts
    are requested.

    Attributes
    ----------
    num_max_contacts : int
        Maximum number of contacts that a call adds.
    enable_contact : bool
        Whether to compute the positions, normals and depths of contacts.
    """

    def __init__(self, num_max_contacts: int = 1, enable_contact: bool = False) -> None:
        self.num_max_contacts = num_max_contacts
        self.enable_contact = enable_contact


class CollisionResult:
    """Contacts that calls of `collide` added.

    Attributes
    ----------
    is_collision : bool
        Whether any contact was found so far.
    contacts : list of Contact
        The contacts found so far.
    """

    def __init__(self) -> None:
        self.is_collision = False
        self.contacts: list[Contact] = []


class CollisionData:
    """Data for `defaultCollisionCallback`.

    Attributes
    ----------
    request : CollisionRequest
        Options of `collide`.
    result : CollisionResult
        The contacts found so far.
    done : bool
        Whether the requested number of contacts was found, so that the manager may stop.
    """

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
    """Add the contacts of two objects to the result, and return the number of added contacts.

    The request limits the number of contacts. The number is 0 if and only if the objects do not
    collide, or if the limit is 0. Touching counts. The search for a single contact stops at the
    first pair of faces that intersects. More contacts are the first in the order of the faces.
    Raise an `InputError` if the limit is invalid.
    """
    if request is None:
        found = _impinge.fcl_collide(o1, o2, 1, False)
    else:
        found = _impinge.fcl_collide(o1, o2, request.num_max_contacts, bool(request.enable_contact))
    if found is None:
        return 0
    if result is not None:
        a, b = o1.geometry, o2.geometry
        result.contacts += [Contact(a, b, *row) for row in found]
        result.is_collision = True
    return len(found)


def defaultCollisionCallback(o1: CollisionObject, o2: CollisionObject, cdata: CollisionData) -> bool:
    """Add the contacts of two objects to `cdata.result`, and return whether the manager may stop.

    It may stop if the number of contacts that `cdata.request` asks for was found.
    """
    if not cdata.done:
        collide(o1, o2, cdata.request, cdata.result)
        cdata.done = cdata.result.is_collision and len(cdata.result.contacts) >= cdata.request.num_max_contacts
    return cdata.done
