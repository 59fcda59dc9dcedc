"""Whether two meshes or shapes intersect, and where.

A new verb on two things is a function here or in ``_distances.py``, one in ``crates/impinge-python/src``, and its name
in ``__init__.py``.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._mesh import Mesh
from impinge._pairs import Pairs
from impinge._rows import Booleans, Pose, Raising, Solid, Stating, Statuses, beside_status
from impinge._scalars import whole
from impinge._shape import AnyShape


@overload
def intersects(a: AnyShape, b: AnyShape, *, solid: Solid = False) -> bool: ...
@overload
def intersects(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, *, solid: Solid = False, **rows: Unpack[Raising]
) -> Booleans: ...
@overload
def intersects(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, *, solid: Solid = False, **rows: Unpack[Stating]
) -> tuple[Booleans, Statuses]: ...
def intersects(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Whether two meshes or shapes have a point in common; touching counts.

    The answer about meshes, boxes, triangles, hulls and half-spaces is the truth about their real images under the
    given maps: no tolerance, no scale. So it is for spheres and capsules among these, if their poses are exactly
    orthogonal. Other round shapes that touch to within rounding count as a hit, with ``Status.UNDECIDED``.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things. A mesh is its surface unless `solid` says otherwise.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, for column vectors; any invertible affine map, for round shapes a rotation and a translation.
        None is the identity. Leading axes broadcast as in NumPy:
        ``(n, 4, 4)`` against ``(4, 4)`` or ``(n, 4, 4)`` gives n answers, ``(n, 1, 4, 4)`` against ``(m, 4, 4)`` gives
        n x m.
    solid : {False, True, "a", "b"}
        Neither mesh, both, or one of them is not its surface alone but all about which it winds more than half, so that
        what lies wholly inside intersects it. A shape is what it was made to be. Exact where that mesh is closed
        (`Mesh.is_closed`); where nothing is proved about the inside of an open one, what is in question counts as
        inside.
    on_error : {"raise", "status"}
        What becomes of a pose that is none. ``"status"`` answers its rows True, the safe answer, and returns the
        `Status` of each row beside the answers.
    progress : bool
        Whether a line of stderr says how many rows are answered while the call lasts.

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
    >>> import impinge, numpy as np
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> impinge.intersects(triangle, triangle, pose_b=impinge.pose([1, 0, 0]))
    True
    >>> impinge.intersects(triangle, triangle, pose_b=impinge.pose([[1, 0, 0], [1 + 1e-15, 0, 0]]))
    array([ True, False])

    A small tetrahedron inside a large one meets it only if that is solid:

    >>> corners = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], float)
    >>> large = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> inside = impinge.pose([1, 1, 1], rotation=np.eye(3) / 10)
    >>> [impinge.intersects(large, large, None, inside, solid=solid) for solid in (False, "a", "b", True)]
    [False, True, False, True]
    """
    return _impinge.intersects((a, b, pose_a, pose_b, solid, on_error, progress))


@overload
def penetrates(a: AnyShape, b: AnyShape) -> bool: ...
@overload
def penetrates(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Raising]
) -> Booleans: ...
@overload
def penetrates(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Stating]
) -> tuple[Booleans, Statuses]: ...
def penetrates(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Whether the interiors of two meshes or shapes intersect, which touching is not.

    Parts of an assembly touch everywhere; only where this is true do they clash.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things. A mesh is taken as a solid: all about which it winds more than half.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    on_error : {"raise", "status"}
        What becomes of a pose that is none, as for `intersects`. The status also says which answers are undecided.
    progress : bool
        As for `intersects`.

    Returns
    -------
    bool or (...) bool array
        True also if it is undecided: a mesh is open near the other one, or meets itself where it meets that, or the
        depth of two shapes is zero to within its bounds. With ``on_error="status"`` a tuple of that and of a uint8
        array, in which ``Status.UNDECIDED`` marks these. Otherwise the answer is exact.

    Raises
    ------
    InputError
        As for `intersects`.

    Examples
    --------
    >>> import impinge, numpy as np
    >>> corners = np.array([[0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8]], float)
    >>> part = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> poses = impinge.pose([[8, 0, 0], [7, 0, 0]])
    >>> impinge.intersects(part, part, None, poses)
    array([ True,  True])
    >>> impinge.penetrates(part, part, None, poses)
    array([False,  True])
    """
    return _impinge.penetrates((a, b, pose_a, pose_b, False, on_error, progress))


class LimitedPairs(NamedTuple):
    """The first pairs of faces, where a limit was set."""

    pairs: NDArray[np.uint32] | Pairs
    """The first pairs of each pose in their order."""
    truncated: Booleans
    """Whether there are more than these, for each pose."""


@overload
def intersecting_pairs(a: Mesh, b: Mesh, *, limit: None = None) -> NDArray[np.uint32]: ...
@overload
def intersecting_pairs(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, *, limit: None = None, **rows: Unpack[Raising]
) -> NDArray[np.uint32] | Pairs: ...
@overload
def intersecting_pairs(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, *, limit: int, **rows: Unpack[Raising]
) -> LimitedPairs: ...
@overload
def intersecting_pairs(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, *, limit: int | None = None, **rows: Unpack[Stating]
) -> tuple[NDArray[np.uint32] | Pairs | LimitedPairs, Statuses]: ...
def intersecting_pairs(
    a: Mesh,
    b: Mesh,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    limit: int | None = None,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Every pair of faces that have a point in common.

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    limit : int, optional
        The most pairs to return for a pose: the first ones in the order of the answer. The answer then says whether
        there are more.
    on_error : {"raise", "status"}
        What becomes of a pose that is none. ``"status"`` gives its rows no pairs and returns the `Status` of each row
        beside the answers: pairs without ``Status.OK`` say nothing.
    progress : bool
        As for `intersects`.

    Returns
    -------
    (k, 2) uint32 array or Pairs
        (Face of a, face of b), sorted by the first, then the second, without duplicates; `Pairs` if the poses have
        leading axes. With a `limit` a `LimitedPairs`: a tuple of these and whether there are more.

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
    >>> pairs, truncated = impinge.intersecting_pairs(square, square, pose_b=impinge.pose([1, 0, 0]), limit=2)
    >>> len(pairs), truncated
    (2, True)
    """
    most = None if limit is None else whole(limit, "limit")
    answer = _impinge.intersecting_pairs((a, b, pose_a, pose_b, False, on_error, progress), most)

    def made(found: Any) -> NDArray[np.uint32] | Pairs | LimitedPairs:
        if len(found) == _SINGLE:
            pairs, truncated = found
        else:
            offsets, rows, shape, truncated = found
            pairs = Pairs(offsets, rows, tuple(shape))
        return pairs if limit is None else LimitedPairs(pairs, truncated)

    return beside_status(answer, on_error, made)


_SINGLE = 2
"""What the extension returns of a single pose: pairs, and whether there are more."""


@overload
def intersection_curves(a: Mesh, b: Mesh) -> list[NDArray[np.float64]]: ...
@overload
def intersection_curves(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Raising]
) -> list[Any]: ...
@overload
def intersection_curves(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Stating]
) -> tuple[list[Any], Statuses]: ...
def intersection_curves(
    a: Mesh,
    b: Mesh,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
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
    progress : bool
        As for `intersects`.

    Returns
    -------
    list of (n, 3) float64 arrays
        Polylines in the world frame and unit, closed if the first row equals the last. After them comes an array of
        one row for each point in which the surfaces touch without a curve. Which pieces there are and how they link up
        is exact, and each coordinate is the true one, rounded. Pairs of faces that meet within one plane have no curve
        of their own. If the poses have leading axes, these are lists of such lists, one level for each axis.

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
    return _impinge.intersection_curves((a, b, pose_a, pose_b, False, on_error, progress))


def self_intersecting_pairs(mesh: Mesh) -> NDArray[np.uint32]:
    """Every pair of faces of one mesh that meet in more than the hull of the positions that they share.

    Faces that share a corner or an edge always meet there, which is not reported; that they go through each other or
    lie on each other elsewhere is. Equal positions are shared, whatever the indices. Exact.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    (k, 2) uint32 array
        The lesser face first; sorted, without duplicates.

    Raises
    ------
    InputError
        If `mesh` is none.

    Examples
    --------
    >>> import impinge
    >>> corners = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 2, 0], [0.5, 0.5, -1], [1.5, 1.5, -1], [1, 1, 1]]
    >>> impinge.self_intersecting_pairs(impinge.Mesh(corners, [[0, 1, 2], [1, 3, 2], [4, 5, 6]]))
    array([[0, 2],
           [1, 2]], dtype=uint32)
    """
    pairs: NDArray[np.uint32] = _impinge.self_intersecting_pairs(mesh)
    return pairs
