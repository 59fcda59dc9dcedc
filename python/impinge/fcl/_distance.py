"""Distance of two objects."""

# The names are those of python-fcl.
# ruff: noqa: N802

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge.fcl._geometry import CollisionGeometry, CollisionObject


class DistanceRequest:
    """Options of `distance`.

    Attributes
    ----------
    enable_nearest_points : bool
        Whether to return nearest points.
    enable_signed_distance : bool
        Whether two solids that overlap have minus their penetration depth as distance, instead of
        -1.
    """

    def __init__(self, enable_nearest_points: bool = False, enable_signed_distance: bool = False) -> None:
        self.enable_nearest_points = enable_nearest_points
        self.enable_signed_distance = enable_signed_distance


_DEFAULT = DistanceRequest()
"""Request of a call without one."""


class DistanceResult:
    """Minimum distance of all pairs measured so far, and the nearest points of that pair.

    Attributes
    ----------
    min_distance : float
        In world units: the upper bound of `impinge.distance`. If at least one body is solid and
        they collide, it is -1, or minus the depth of two solids if signed distances are requested.
        Infinite at first.
    nearest_points : list of two (3,) float64 arrays
        Nearest points on the two objects in the world frame, rounded; the deepest points if
        `min_distance` is minus a depth. Zero if it is -1, or if the points were not requested.
    o1, o2 : CollisionGeometry or None
        The geometries of the two objects; None at first.
    b1, b2 : int
        Nearest faces, as indices into the faces of `o1` and `o2`; -1 for a solid, and for a body
        inside one.
    """

    def __init__(self) -> None:
        self.min_distance = np.inf
        self._points: NDArray[np.float64] | None = None
        self.o1: CollisionGeometry | None = None
        self.o2: CollisionGeometry | None = None
        self.b1 = self.b2 = -1

    @property
    def nearest_points(self) -> list[NDArray[np.float64]]:
        """The nearest points of the two objects, (3,) each."""
        return [np.zeros(3), np.zeros(3)] if self._points is None else list(self._points)


class DistanceData:
    """Data for `defaultDistanceCallback`.

    Attributes
    ----------
    request : DistanceRequest
        Options of `distance`.
    result : DistanceResult
        The minimum distance so far, and its nearest points.
    done : bool
        Whether the manager may stop; set by the caller.
    """

    def __init__(self, request: DistanceRequest | None = None, result: DistanceResult | None = None) -> None:
        self.request = DistanceRequest() if request is None else request
        self.result = DistanceResult() if result is None else result
        self.done = False


def distance(
    o1: CollisionObject,
    o2: CollisionObject,
    request: DistanceRequest | None = None,
    result: DistanceResult | None = None,
) -> float:
    """Return the distance of two objects in world units; store it in the result if a new minimum.

    It is the upper bound of `impinge.distance`, and infinite if a mesh is empty. Two surfaces that
    intersect have distance 0. If at least one body is solid and they collide, the distance is -1.
    With ``enable_signed_distance`` and two solids, it is minus their penetration depth. Two solids
    that only touch have distance 0.
    """
    if request is None:
        request = _DEFAULT
    signed, wanted = bool(request.enable_signed_distance), bool(request.enable_nearest_points)
    value, b1, b2, points = _impinge.fcl_distance(o1, o2, signed, wanted)
    if result is not None and value < result.min_distance:
        result.min_distance, result.o1, result.o2 = value, o1.geometry, o2.geometry
        result.b1, result.b2 = b1, b2
        result._points = points
    return value


def defaultDistanceCallback(
    o1: CollisionObject, o2: CollisionObject, cdata: DistanceData, dist: float
) -> tuple[bool, float]:
    """Measure two objects; return whether the manager may stop, and the minimum distance so far.

    The minimum is stored in ``cdata.result``, with the same meaning as in `distance`; `dist` is not
    used. The callback never allows the manager to stop early, unless ``cdata.done`` is set.
    """
    if not cdata.done:
        distance(o1, o2, cdata.request, cdata.result)
    return cdata.done, cdata.result.min_distance
