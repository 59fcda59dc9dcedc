"""Whether two objects collide, and their contacts."""

# The names are python-fcl's.
# ruff: noqa: N802

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from impinge import _bodies
from impinge._scalars import whole
from impinge.fcl._geometry import CollisionGeometry, CollisionObject


class Contact:
    """Two faces that meet.

    Attributes
    ----------
    o1, o2 : CollisionGeometry
        The geometries.
    b1, b2 : int
        Their faces; -1 for both where one body is inside the other.
    pos : (3,) float64 array
        A point of the world that both have in common, rounded; only with ``enable_contact``, as what follows.
    normal : (3,) float64 array
        Of length 1, in the world, from the first object to the second: the shortest way to part two solids; of
        surfaces that of the region in which they go through each other. The faces of surfaces are taken to turn left
        seen from outside.
    penetration_depth : float
        How deep the objects are in each other along the normal, here or in this region; at least zero.
    """

    def __init__(self, o1: CollisionGeometry, o2: CollisionGeometry, b1: int, b2: int) -> None:
        self.o1, self.o2, self.b1, self.b2 = o1, o2, b1, b2
        self.pos: NDArray[np.float64]
        self.normal: NDArray[np.float64]
        self.penetration_depth: float


class CollisionRequest:
    """How many contacts are wanted, and whether their positions, normals and depths are.

    The normals of surfaces take as long as all their pairs, however few contacts are wanted.
    """

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
    most = whole(request.num_max_contacts, "num_max_contacts")
    pairs = _bodies.contacts(a, b, o1.matrix, o2.matrix, most)
    found = [Contact(o1.geometry, o2.geometry, int(b1), int(b2)) for b1, b2 in pairs]
    if request.enable_contact and found:
        points = _bodies.contact_points(a, b, o1.matrix, o2.matrix, pairs)
        normals, depths = _bodies.contact_normals(a, b, o1.matrix, o2.matrix, pairs)
        for contact, point, normal, depth in zip(found, points, normals, depths.tolist(), strict=True):
            contact.pos, contact.normal, contact.penetration_depth = point, normal, depth
    result.contacts += found
    result.is_collision = result.is_collision or bool(found)
    return len(found)


def defaultCollisionCallback(o1: CollisionObject, o2: CollisionObject, cdata: CollisionData) -> bool:
    """Collide two objects; return whether the manager may stop: as many contacts as requested are there."""
    if not cdata.done:
        collide(o1, o2, cdata.request, cdata.result)
        cdata.done = cdata.result.is_collision and len(cdata.result.contacts) >= cdata.request.num_max_contacts
    return cdata.done
