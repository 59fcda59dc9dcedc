"""How deep two meshes or shapes are in each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._points import scalar
from impinge._rows import Pose, Raising, Stating, Statuses, beside_status
from impinge._shape import AnyShape


@dataclass(frozen=True, eq=False)
class Penetration:
    """How deep two things are in each other, with what was proved about it; arrays where the poses have leading axes.

    Attributes
    ----------
    depth : float or (...) float64 array
        `upper`; zero if the two are apart, and if they touch.
    lower, upper : float or (...) float64 array
        No translation shorter than `lower` takes their interiors apart; moving the second by `upper` along the normal
        does. In world units; infinite where nothing does.
    normal : (..., 3) float64 array
        Of length 1, from the first to the second, in the world frame; zero where they are apart.
    point_a, point_b : (..., 3) float64 array
        The points of either that are deepest in the other, in the world frame, rounded; zero where they are
        apart.
    hit : bool or (...) bool array
        Whether they intersect.
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
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Raising]
) -> Penetration: ...
@overload
def penetration(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Stating]
) -> tuple[Penetration, Statuses]: ...
def penetration(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Return how deep two meshes or shapes are in each other: a short way to take them apart.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things. A mesh is taken as a solid: all about which it winds more than half.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh; None is the identity. Leading axes broadcast as in NumPy.
    on_error : {"raise", "status"}
        As for `intersects`. Nothing is proved about rows with a bad pose: their depth is from zero to infinity.
    progress : bool
        As for `intersects`.

    Returns
    -------
    Penetration
        Moving `b` by `upper` along the normal takes the interiors apart, nothing shorter than `lower` does. Zero if
        they touch or are apart. Of two convex shapes the bounds are close. For meshes and compounds the shortest way is
        searched for, in some hundred distances a row.

    Raises
    ------
    InputError
        If an argument is none of the above; it says which row and entry.

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
    answer = _impinge.penetration((a, b, pose_a, pose_b, False, on_error, progress))
    return beside_status(answer, on_error, _made)


def _made(columns: Any) -> Penetration:
    """Return what the extension has in columns: plain numbers in place of arrays without axes."""
    hit, lower, upper, normal, point_a, point_b = columns
    upper = scalar(upper)
    return Penetration(upper, scalar(lower), upper, normal, point_a, point_b, scalar(hit))
