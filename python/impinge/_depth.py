"""Measures how much material two meshes or shapes share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge._engine import engine
from impinge._rows import Booleans, Pose, RaiseOptions, Statuses, StatusOptions, with_status
from impinge._scalars import real
from impinge._shape import AnyShape

if TYPE_CHECKING:
    from impinge.cluster import Cluster


@dataclass(frozen=True, eq=False)
class Depth:
    """Depth of the material that two solids share; arrays if the poses have leading axes.

    Attributes
    ----------
    lower, upper : float or (...) float64 array
        Proved bounds of the depth, in world units; zero if `a` and `b` are apart. For an open mesh
        they follow from winding numbers, and the status of the row is ``Status.UNDECIDED``.
    point : (..., 3) float64 array
        A point in both solids that has at least the depth `lower`, in the world frame; zero if
        `lower` is zero.
    """

    lower: float | NDArray[np.float64]
    upper: float | NDArray[np.float64]
    point: NDArray[np.float64]


@overload
def depth(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[RaiseOptions]
) -> Depth: ...
@overload
def depth(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[StatusOptions]
) -> tuple[Depth, Statuses]: ...
def depth(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
    on: Cluster | None = None,
) -> Any:
    """Compute how much material two meshes or shapes share.

    It is the greatest depth of a common point: its distance from the surface of one of the two
    solids, whichever is farther. The depth is zero if the solids only touch, and also if one fits
    exactly into an opening of the other. `penetration` answers another question, how far to move
    a solid out, and is never less.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things. A mesh is treated as a solid: its surface and all points with a winding
        number above 1/2 in magnitude.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh or shape, as for `intersects`.
    on_error : {"raise", "status"}
        As for `intersects`. For an invalid pose the bounds are zero and infinity.
    progress : bool
        As for `intersects`.
    on : impinge.cluster.Cluster, optional
        As for `intersects`.

    Returns
    -------
    Depth
        The fields have the leading axes of the poses. For two meshes the bounds are close: their
        width is at most 1/1024 of the depth plus about 2^-39 of the size of the solids, unless
        16,384 cells do not suffice. Other shapes have wider bounds.

    Raises
    ------
    InputError
        If an argument is invalid; the error names the row and the entry.

    Examples
    --------
    >>> import impinge
    >>> corners = [[0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8]]
    >>> part = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> found = impinge.depth(part, part, None, impinge.pose([[0.5, 0.5, -7.5], [0.5, 0.5, -9]]))
    >>> found.upper.round(9), bool(0.499 < found.lower[0] <= 0.5)
    (array([0.5, 0. ]), True)
    """
    answer = engine(on).depth((a, b, pose_a, pose_b, False, on_error, progress))
    return with_status(answer, on_error, lambda columns: Depth(*columns))


@overload
def deeper(a: AnyShape, b: AnyShape, threshold: float) -> bool: ...
@overload
def deeper(
    a: AnyShape,
    b: AnyShape,
    threshold: float,
    pose_a: Pose = None,
    pose_b: Pose = None,
    **rows: Unpack[RaiseOptions],
) -> Booleans: ...
@overload
def deeper(
    a: AnyShape,
    b: AnyShape,
    threshold: float,
    pose_a: Pose = None,
    pose_b: Pose = None,
    **rows: Unpack[StatusOptions],
) -> tuple[Booleans, Statuses]: ...
def deeper(
    a: AnyShape,
    b: AnyShape,
    threshold: float,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
    on: Cluster | None = None,
) -> Any:
    """Report whether two meshes or shapes share material deeper than a threshold.

    The answer is that of `depth`, and costs much less. An undecided answer counts as True: the
    depth differs from the threshold by less than rounding, or too many cells would be needed.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things, as for `depth`.
    threshold : float
        Depth in world units, at least zero. With zero the question is that of `penetrates`.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh or shape, as for `intersects`.
    on_error : {"raise", "status"}
        As for `intersects`: a row with an invalid pose gets True, the safe answer.
    progress : bool
        As for `intersects`.
    on : impinge.cluster.Cluster, optional
        As for `intersects`.

    Returns
    -------
    bool or (...) bool array
        True if the two share material deeper than the threshold. With ``on_error="status"`` a tuple
        of this and a uint8 array of the same shape, the status of each row.

    Raises
    ------
    InputError
        If `threshold` is negative or not a number, or as for `intersects`.

    Examples
    --------
    >>> import impinge
    >>> corners = [[0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8]]
    >>> part = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> above = impinge.pose([0.5, 0.5, -7.5])
    >>> [impinge.deeper(part, part, threshold, None, above) for threshold in (0.125, 0.5)]
    [True, False]
    """
    limit = real(threshold, "threshold", minimum=0)
    return engine(on).deeper((a, b, pose_a, pose_b, False, on_error, progress), limit)
