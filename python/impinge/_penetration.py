"""Measures how deep two meshes or shapes penetrate each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge._engine import engine
from impinge._rows import Pose, RaiseOptions, Statuses, StatusOptions, with_status
from impinge._shape import AnyShape

if TYPE_CHECKING:
    from impinge.cluster import Cluster


@dataclass(frozen=True, eq=False)
class Penetration:
    """Penetration depth of two meshes or shapes; arrays if the poses have leading axes.

    Attributes
    ----------
    depth : float or (...) float64 array
        Penetration depth in world units, equal to `upper`; zero if `a` and `b` are apart.
    lower, upper : float or (...) float64 array
        Proved bounds of the penetration depth, in world units; zero if `a` and `b` are apart.
        Moving `b` by `upper` along the normal separates the interiors; no translation shorter than
        `lower` does. `upper` is infinite if no such translation is known.
    normal : (..., 3) float64 array
        Unit vector from `a` to `b`, in the world frame; zero if they are apart.
    point_a, point_b : (..., 3) float64 array
        The point of `a` that is deepest in `b`, and the point of `b` that is deepest in `a`, in the
        world frame, rounded; zero if they are apart.
    hit : bool or (...) bool array
        Whether `a` and `b` intersect; True if that is undecided.
    """

    depth: float | NDArray[np.float64]
    lower: float | NDArray[np.float64]
    upper: float | NDArray[np.float64]
    normal: NDArray[np.float64]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    hit: bool | NDArray[np.bool_]


@overload
def penetration(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[RaiseOptions]
) -> Penetration: ...
@overload
def penetration(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[StatusOptions]
) -> tuple[Penetration, Statuses]: ...
def penetration(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
    on: Cluster | None = None,
) -> Any:
    """Compute how deep two meshes or shapes penetrate each other, and how to separate them.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things. A mesh is treated as a solid: its surface and all points with a winding
        number above 1/2 in magnitude.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh or shape; None is the identity. Leading axes broadcast as in NumPy.
    on_error : {"raise", "status"}
        As for `intersects`. For an invalid pose the bounds are zero and infinity, the vectors are
        zero, and `hit` is True.
    progress : bool
        As for `intersects`.
    on : impinge.cluster.Cluster, optional
        As for `intersects`.

    Returns
    -------
    Penetration
        The fields have the leading axes of the poses. The bounds are close for two convex shapes.
        For meshes and compounds the shortest translation is found by a search that costs about a
        hundred distance queries for each row.

    Raises
    ------
    InputError
        If an argument is invalid; the error names the row and the entry.

    Examples
    --------
    >>> import impinge
    >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
    >>> solid = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> deep = impinge.penetration(solid, solid, None, impinge.pose([0, 0, 3.5]))
    >>> bool(deep.lower <= 0.5 / 3**0.5 * (1 + 1e-6) and deep.hit)
    True
    >>> box, ball = impinge.Shape.box([1, 1, 1]), impinge.Shape.sphere(1)
    >>> deep = impinge.penetration(box, ball, None, impinge.pose([1.5, 0, 0]))
    >>> round(deep.depth, 9), deep.normal
    (0.5, array([1., 0., 0.]))
    """
    answer = engine(on).penetration((a, b, pose_a, pose_b, False, on_error, progress))
    return with_status(answer, on_error, _penetration_of)


def _penetration_of(columns: Any) -> Penetration:
    hit, lower, upper, normal, point_a, point_b = columns
    return Penetration(upper, lower, upper, normal, point_a, point_b, hit)
