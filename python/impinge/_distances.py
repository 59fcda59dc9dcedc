"""How far apart two meshes or shapes are, and whether they keep a clearance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._points import scalar
from impinge._rows import Booleans, Pose, Raising, Solid, Stating, Statuses, beside_status
from impinge._scalars import real
from impinge._shape import AnyShape


@dataclass(frozen=True, eq=False)
class Distance:
    """How far apart two things are, with what was proved about it; arrays if the poses have leading axes.

    Attributes
    ----------
    distance : float or (...) float64 array
        Zero exactly if the two intersect, else `upper`.
    lower, upper : float or (...) float64 array
        The true distance lies between them, in world units. Infinite if a mesh is empty.
    point_a, point_b : (..., 3) float64 array
        Nearest points in the world frame, rounded; zero if there are none: a mesh is empty, a pose bad, or one mesh
        inside the other one, a solid, without touching its surface.
    face_a, face_b : int or (...) int64 array
        The faces that they are on; -1 if there are none, or one of the two is no
        mesh. Among faces that are equally
        near the least by `face_a`, then by `face_b`; if the meshes intersect two that do, which depend on how the
        hierarchies were built.
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
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, *, solid: Solid = False, **rows: Unpack[Raising]
) -> Distance: ...
@overload
def distance(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, *, solid: Solid = False, **rows: Unpack[Stating]
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
) -> Any:
    """Return how far apart two meshes or shapes are, and where.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    solid : {False, True, "a", "b"}
        As for `intersects`: the distance is zero exactly where that, with the same `solid`, is true.
    on_error : {"raise", "status"}
        What becomes of a pose that is none. ``"status"`` answers its rows with distance 0, the safe answer, without
        faces, and returns the `Status` of each row beside the answers.
    progress : bool
        As for `intersects`.

    Returns
    -------
    Distance
        Its fields gain the leading axes of the poses. The interval from `lower` to `upper` is at most 2^-44 of the
        diagonal of the box that holds both meshes, and 2^-36 of the distance for boxes, triangles, hulls and
        half-spaces. For round shapes it is about 2^-40 of the sizes, and up to 2^-23 if a cylinder, a cone or an
        ellipsoid is turned so that several of its points are as near.

    Raises
    ------
    InputError
        As for `intersects`.

    Notes
    -----
    The search for a pose starts from the faces that were nearest in the one before it, so consecutive poses of a motion
    are faster than the same ones shuffled. No answer depends on it.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> far = impinge.distance(triangle, triangle, pose_b=impinge.pose([[0, 0, 2], [0, 0, 0]]))
    >>> far.distance.round(9)
    array([2., 0.])
    """
    return beside_status(_impinge.distance((a, b, pose_a, pose_b, solid, on_error, progress)), on_error, _made)


def _made(columns: tuple[NDArray[Any], ...]) -> Distance:
    """Plain numbers in place of arrays without axes; points stay arrays."""
    return Distance(*map(scalar, columns))


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
    **rows: Unpack[Raising],
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
    **rows: Unpack[Stating],
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
) -> Any:
    """Whether two meshes or shapes come within a clearance of each other: closer than it or equal to it.

    Decided exactly, as `intersects` is.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things; an empty mesh is within no clearance.
    clearance : float
        In world units, not negative.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    solid : {False, True, "a", "b"}
        As for `intersects`: what is inside a solid is within any clearance of it.
    on_error : {"raise", "status"}
        As for `intersects`; the safe answer is True.
    progress : bool
        As for `intersects`.

    Returns
    -------
    bool or (...) bool array
        With ``on_error="status"`` a tuple of that and a uint8 array of the same shape.

    Raises
    ------
    InputError
        If `clearance` is negative or no number, or as for `intersects`.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> impinge.within(triangle, triangle, 0.5, pose_b=impinge.pose([[0, 0, 0.5], [0, 0, 0.5 + 1e-15]]))
    array([ True, False])
    """
    return _impinge.within((a, b, pose_a, pose_b, solid, on_error, progress), real(clearance, "clearance", least=0))
