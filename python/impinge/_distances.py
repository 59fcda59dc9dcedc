"""Measures how far apart two meshes or shapes are, and tests whether they keep a clearance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge._engine import engine
from impinge._rows import Booleans, Pose, RaiseOptions, Solid, Statuses, StatusOptions, with_status
from impinge._scalars import real
from impinge._shape import AnyShape

if TYPE_CHECKING:
    from impinge.cluster import Cluster


@dataclass(frozen=True, eq=False)
class Distance:
    """Distance of two things with proved bounds; arrays if the poses have leading axes.

    Attributes
    ----------
    distance : float or (...) float64 array
        In world units: zero if and only if the two intersect or this is undecided; otherwise
        `upper`.
    lower, upper : float or (...) float64 array
        Bounds of the true distance, in world units. Infinite if a mesh is empty; both 0 in a row
        with an invalid pose.
    point_a, point_b : (..., 3) float64 array
        Nearest points in the world frame, rounded. Zero if there are none: a mesh is empty, a pose
        is invalid, or one mesh lies inside the other, a solid, without touching its surface.
    face_a, face_b : int or (...) int64 array
        Indices of the faces that contain the nearest points; -1 if there are none, or if one of the
        two is not a mesh. If several pairs are equally near, the one with the smallest `face_a`,
        then the smallest `face_b`, is returned. If the meshes intersect, a pair of intersecting
        faces is returned, which depends on how the hierarchies were built.
    """

    distance: float | NDArray[np.float64]
    lower: float | NDArray[np.float64]
    upper: float | NDArray[np.float64]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    face_a: int | NDArray[np.int64]
    face_b: int | NDArray[np.int64]


@overload
def distance(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    **rows: Unpack[RaiseOptions],
) -> Distance: ...
@overload
def distance(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    **rows: Unpack[StatusOptions],
) -> tuple[Distance, Statuses]: ...
def distance(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
    on: Cluster | None = None,
) -> Any:
    """Compute the distance of two meshes or shapes, and their nearest points.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh or shape, as for `intersects`.
    solid : {False, True, "a", "b"}
        As for `intersects`: the distance is zero if and only if `intersects` with the same `solid`
        returns True.
    on_error : {"raise", "status"}
        How to treat an invalid pose. ``"status"`` gives its row the safe answer: both bounds 0, and
        no nearest points or faces. It also returns the `Status` of each row; check it.
    progress : bool
        As for `intersects`.
    on : impinge.cluster.Cluster, optional
        As for `intersects`.

    Returns
    -------
    Distance
        The fields have the leading axes of the poses. The width of the interval from `lower` to
        `upper` is at most 2^-44 of the diagonal of the box that contains both meshes. For boxes,
        triangles, hulls and half-spaces it is at most 2^-36 of the distance. For round shapes it is
        about 2^-40 of the sizes, or up to 2^-23 if several points of a cylinder, a cone or an
        ellipsoid are equally near. With ``on_error="status"`` a tuple of this and the status of
        each row.

    Raises
    ------
    InputError
        As for `intersects`.

    Notes
    -----
    The search for each pose starts from the nearest faces of the previous pose. Consecutive poses
    of a motion are therefore faster than the same poses in random order. The result does not depend
    on the order.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> far = impinge.distance(triangle, triangle, pose_b=impinge.pose([[0, 0, 2], [0, 0, 0]]))
    >>> far.distance.round(9)
    array([2., 0.])
    """
    answer = engine(on).distance((a, b, pose_a, pose_b, solid, on_error, progress))
    return with_status(answer, on_error, lambda columns: Distance(*columns))


@overload
def within(a: AnyShape, b: AnyShape, clearance: float, *, solid: Solid = False) -> bool: ...
@overload
def within(
    a: AnyShape,
    b: AnyShape,
    clearance: float,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    **rows: Unpack[RaiseOptions],
) -> Booleans: ...
@overload
def within(
    a: AnyShape,
    b: AnyShape,
    clearance: float,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    **rows: Unpack[StatusOptions],
) -> tuple[Booleans, Statuses]: ...
def within(
    a: AnyShape,
    b: AnyShape,
    clearance: float,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
    on: Cluster | None = None,
) -> Any:
    """Report whether two meshes or shapes are at most a clearance apart, decided exactly.

    The test is as exact as `intersects`.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things. An empty mesh is not within any clearance.
    clearance : float
        Maximum distance in world units, at least zero. A distance equal to the clearance counts.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh or shape, as for `intersects`.
    solid : {False, True, "a", "b"}
        As for `intersects`: a body inside a solid is within any clearance of it.
    on_error : {"raise", "status"}
        As for `intersects`: a row with an invalid pose gets True, the safe answer.
    progress : bool
        As for `intersects`.
    on : impinge.cluster.Cluster, optional
        As for `intersects`.

    Returns
    -------
    bool or (...) bool array
        True if the two are within the clearance. With ``on_error="status"`` a tuple of this and a
        uint8 array of the same shape, the status of each row.

    Raises
    ------
    InputError
        If `clearance` is negative or not a number, or as for `intersects`.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> impinge.within(triangle, triangle, 0.5, pose_b=impinge.pose([[0, 0, 0.5], [0, 0, 0.5 + 1e-15]]))
    array([ True, False])
    """
    return engine(on).within((a, b, pose_a, pose_b, solid, on_error, progress), real(clearance, "clearance", minimum=0))
