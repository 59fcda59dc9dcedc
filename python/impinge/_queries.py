"""The questions one asks of two meshes.

A new verb is a function here, one in ``crates/impinge-python/src/verbs.rs``, and its name in ``__init__.py``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._pairs import Pairs

Statuses: TypeAlias = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Distance:
    """How far apart two surfaces are, with what was proved about it; arrays where the poses have leading axes.

    Attributes
    ----------
    distance : float or (...) float64 array
        `upper`.
    lower, upper : float or (...) float64 array
        The true distance lies between them, in world units. Zero exactly where the surfaces intersect, infinite where
        one of them is empty.
    point_a, point_b : (..., 3) float64 array
        Nearest points in the world frame, rounded; zero where there are none.
    face_a, face_b : int or (...) int64 array
        The faces that they are on; -1 where a mesh is empty, or a pose bad.
    """

    distance: float | NDArray[np.float64]
    lower: float | NDArray[np.float64]
    upper: float | NDArray[np.float64]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    face_a: int | NDArray[np.int64]
    face_b: int | NDArray[np.int64]


@overload
def intersects(a: Mesh, b: Mesh) -> bool: ...
@overload
def intersects(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["raise"] = "raise",
) -> bool | NDArray[np.bool_]: ...
@overload
def intersects(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["status"],
) -> tuple[bool | NDArray[np.bool_], Statuses]: ...
def intersects(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
) -> Any:
    """Whether the surfaces of two meshes have a point in common; touching counts.

    The answer is the truth about the real images of the closed triangles under the given maps: no tolerance, no scale.

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, for column vectors; any invertible affine map. Leading axes broadcast as in NumPy:
        ``(n, 4, 4)`` against ``(4, 4)`` or ``(n, 4, 4)`` gives n answers, ``(n, 1, 4, 4)`` against ``(m, 4, 4)`` gives
        n x m.
    on_error : {"raise", "status"}
        What becomes of a pose that is none. ``"status"`` answers its rows True, the safe answer, and returns the
        `Status` of each row beside the answers.

    Returns
    -------
    bool or (...) bool array
        With ``on_error="status"`` a tuple of that and a uint8 array of the same shape.

    Raises
    ------
    InputError
        If an argument has another type or shape, or a pose is not finite, not affine, singular or out of range; before
        any work, naming the row.

    Notes
    -----
    Stops at the first pair of triangles found. Many poses are shared out to all cores (see `threads`), without the
    interpreter's lock; Ctrl-C ends the wait.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> impinge.intersects(triangle, triangle, pose_b=impinge.pose([1, 0, 0]))
    True
    >>> impinge.intersects(triangle, triangle, pose_b=impinge.pose([[1, 0, 0], [1 + 1e-15, 0, 0]]))
    array([ True, False])
    """
    return _impinge.intersects(a, b, pose_a, pose_b, on_error)


@overload
def intersecting_pairs(a: Mesh, b: Mesh, *, limit: int | None = None) -> NDArray[np.uint32]: ...
@overload
def intersecting_pairs(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    limit: int | None = None,
    on_error: Literal["raise"] = "raise",
) -> NDArray[np.uint32] | Pairs: ...
@overload
def intersecting_pairs(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    limit: int | None = None,
    on_error: Literal["status"],
) -> tuple[NDArray[np.uint32] | Pairs, Statuses]: ...
def intersecting_pairs(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    limit: int | None = None,
    on_error: Literal["raise", "status"] = "raise",
) -> Any:
    """Every pair of faces that have a point in common.

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    limit : int, optional
        The most pairs to return for a pose: the first ones in the order of the answer. Where a pose has as many, there
        may be more.
    on_error : {"raise", "status"}
        What becomes of a pose that is none. ``"status"`` gives its rows no pairs and returns the `Status` of each row
        beside the answers: pairs without ``Status.OK`` say nothing.

    Returns
    -------
    (k, 2) uint32 array or Pairs
        (Face of a, face of b), sorted by the first, then the second, without duplicates; `Pairs` where the poses have
        leading axes.

    Raises
    ------
    InputError
        As for `intersects`.

    Examples
    --------
    >>> import impinge
    >>> square = impinge.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> impinge.intersecting_pairs(square, square, pose_b=impinge.pose([1, 0, 0]))
    array([[0, 0],
           [0, 1],
           [1, 1]], dtype=uint32)
    """
    if limit is not None and (isinstance(limit, bool) or not isinstance(limit, int | np.integer) or limit < 0):
        raise InputError(f"must be a whole number or None, not {limit!r}", kind="option", what="limit")
    answer = _impinge.intersecting_pairs(a, b, pose_a, pose_b, limit, on_error)
    if on_error == "status":
        return _pairs(answer[0]), answer[1]
    return _pairs(answer)


def _pairs(answer: Any) -> NDArray[np.uint32] | Pairs:
    return Pairs(answer[0], answer[1], tuple(answer[2])) if isinstance(answer, tuple) else answer


@overload
def intersection_curves(a: Mesh, b: Mesh) -> list[NDArray[np.float64]]: ...
@overload
def intersection_curves(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["raise"] = "raise",
) -> list[Any]: ...
@overload
def intersection_curves(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["status"],
) -> tuple[list[Any], Statuses]: ...
def intersection_curves(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
) -> Any:
    """Return the curves in which two surfaces meet.

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    on_error : {"raise", "status"}
        What becomes of a pose that is none. ``"status"`` gives its rows no curves and returns the `Status` of each row
        beside the answers: curves without ``Status.OK`` say nothing.

    Returns
    -------
    list of (n, 3) float64 arrays
        Polylines in the world frame and unit; closed where the first row equals the last. Which pieces there are and
        how they link up is exact, and each coordinate is the true one, rounded. Pairs of faces that meet within one
        plane have no curve of their own. Where the poses have leading axes, lists of such lists, one level for each.

    Raises
    ------
    InputError
        As for `intersects`.

    Examples
    --------
    >>> import impinge
    >>> floor = impinge.Mesh([[-2, -2, 0], [2, -2, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> wall = impinge.Mesh([[-1, 0, -1], [1, 0, -1], [0, 0, 1]], [[0, 1, 2]])
    >>> [curve] = impinge.intersection_curves(floor, wall)
    >>> curve[:, 0]
    array([-0.5,  0.5])
    """
    return _impinge.intersection_curves(a, b, pose_a, pose_b, on_error)


@overload
def distance(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["raise"] = "raise",
) -> Distance: ...
@overload
def distance(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["status"],
) -> tuple[Distance, Statuses]: ...
def distance(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
) -> Any:
    """Return how far apart two surfaces are, and where.

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    on_error : {"raise", "status"}
        What becomes of a pose that is none. ``"status"`` answers its rows with distance 0, the safe answer, without
        faces, and returns the `Status` of each row beside the answers.

    Returns
    -------
    Distance
        Its fields gain the leading axes of the poses. The interval from `lower` to `upper` is at most 2^-44 of the
        diagonal of the box that holds both meshes.

    Raises
    ------
    InputError
        As for `intersects`.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> far = impinge.distance(triangle, triangle, pose_b=impinge.pose([[0, 0, 2], [0, 0, 0]]))
    >>> far.distance.round(9)
    array([2., 0.])
    """
    answer = _impinge.distance(a, b, pose_a, pose_b, on_error)
    if on_error == "status":
        return _distance(answer[0]), answer[1]
    return _distance(answer)


def _distance(columns: tuple[NDArray[Any], ...]) -> Distance:
    """Plain numbers in place of arrays without axes; points stay arrays."""
    distance, lower, upper, point_a, point_b, face_a, face_b = (
        column if column.ndim or at in (3, 4) else column.item() for at, column in enumerate(columns)
    )
    return Distance(distance, lower, upper, point_a, point_b, face_a, face_b)


@overload
def within(a: Mesh, b: Mesh, clearance: float) -> bool: ...
@overload
def within(
    a: Mesh,
    b: Mesh,
    clearance: float,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["raise"] = "raise",
) -> bool | NDArray[np.bool_]: ...
@overload
def within(
    a: Mesh,
    b: Mesh,
    clearance: float,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["status"],
) -> tuple[bool | NDArray[np.bool_], Statuses]: ...
def within(
    a: Mesh,
    b: Mesh,
    clearance: float,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
) -> Any:
    """Whether two surfaces come within a clearance of each other: closer than it or equal to it, decided exactly.

    Parameters
    ----------
    a, b : Mesh
        The meshes; an empty one is within no clearance.
    clearance : float
        In world units, not negative.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    on_error : {"raise", "status"}
        As for `intersects`; the safe answer is True.

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
    if isinstance(clearance, bool) or not isinstance(clearance, float | int | np.floating) or not clearance >= 0:
        raise InputError(f"must be a number of at least 0, not {clearance!r}", kind="option", what="clearance")
    return _impinge.within(a, b, float(clearance), pose_a, pose_b, on_error)
