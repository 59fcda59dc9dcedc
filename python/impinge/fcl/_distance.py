"""How far apart two objects are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from impinge import _bodies, _distances
from impinge._intersections import penetrates
from impinge.fcl._geometry import CollisionGeometry, CollisionObject


class DistanceRequest:
    """Whether the nearest points are wanted."""

    def __init__(self, enable_nearest_points: bool = False) -> None:
        self.enable_nearest_points = enable_nearest_points


class DistanceResult:
    """The least distance so far, and where it is.

    Attributes
    ----------
    min_distance : float
        In world units; -1 where one of two bodies is solid and they collide. Infinite at first.
    nearest_points : list of two (3,) float64 arrays
        On either object, in the world, rounded; zero where they collide, or were not requested.
    o1, o2 : CollisionGeometry or None
        The geometries.
    b1, b2 : int
        Their faces; -1 for a solid, and for what is inside one.
    """

    def __init__(self) -> None:
        self.min_distance = np.inf
        self.nearest_points: list[NDArray[np.float64]] = [np.zeros(3), np.zeros(3)]
        self.o1: CollisionGeometry | None = None
        self.o2: CollisionGeometry | None = None
        self.b1 = self.b2 = -1


def distance(
    o1: CollisionObject,
    o2: CollisionObject,
    request: DistanceRequest | None = None,
    result: DistanceResult | None = None,
) -> float:
    """Return the distance of two objects, and keep it in the result if it is less than what is there.

    Two surfaces that meet have distance 0. Where one is solid and they collide it is -1; two solids that only touch
    have 0.
    """
    request = DistanceRequest() if request is None else request
    result = DistanceResult() if result is None else result
    a, b = o1.geometry.body, o2.geometry.body
    far = _distances.distance(a.mesh, b.mesh, o1.matrix, o2.matrix, solid=_bodies.solids(a, b))
    value = float(far.distance)
    if value == 0 and (a.solid or b.solid):
        only_touch = a.solid and b.solid and not penetrates(a.mesh, b.mesh, o1.matrix, o2.matrix)
        value = 0.0 if only_touch else -1.0
    if value < result.min_distance:
        result.min_distance, result.o1, result.o2 = value, o1.geometry, o2.geometry
        result.b1, result.b2 = (-1 if body.solid else int(face) for body, face in ((a, far.face_a), (b, far.face_b)))
        wanted = request.enable_nearest_points and value >= 0
        result.nearest_points = [far.point_a, far.point_b] if wanted else [np.zeros(3), np.zeros(3)]
    return value
