"""Tests whether two meshes or shapes intersect, and lists the faces and curves in which they do.

To add a query on two things, add a function here or in ``_distances.py``, its implementation in
``crates/impinge-python/src``, and its name in ``__init__.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._engine import engine
from impinge._mesh import Mesh
from impinge._pairs import Pairs
from impinge._rows import Booleans, Pose, RaiseOptions, Solid, Statuses, StatusOptions, with_status
from impinge._scalars import whole
from impinge._shape import AnyShape

if TYPE_CHECKING:
    from impinge.cluster import Cluster


@overload
def intersects(a: AnyShape, b: AnyShape, *, solid: Solid = False) -> bool: ...
@overload
def intersects(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    **rows: Unpack[RaiseOptions],
) -> Booleans: ...
@overload
def intersects(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    **rows: Unpack[StatusOptions],
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
    on: Cluster | None = None,
) -> Any:
    """Report whether two meshes or shapes have a point in common; touching counts.

    Meshes, boxes, triangles, hulls and half-spaces are decided exactly for the real numbers that
    their coordinates and poses denote: there is no tolerance, and the scale does not matter.
    Pairs of these with spheres and capsules are decided exactly too, if the poses are exactly
    orthogonal. Other round shapes count as intersecting if they touch to within rounding; their
    status is then ``Status.UNDECIDED``.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things. A mesh is its surface, unless `solid` makes it a solid.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh or shape, for column vectors: any invertible affine map, or a rigid motion
        within 1e-4 for round shapes. None is the identity. Leading axes broadcast as in NumPy:
        ``(n, 4, 4)`` against ``(4, 4)`` or ``(n, 4, 4)`` gives n answers, ``(n, 1, 4, 4)`` against
        ``(m, 4, 4)`` gives n x m.
    solid : {False, True, "a", "b"}
        Which meshes are solids: neither, both, or one. A solid is the surface and all points with a
        winding number above 1/2 in magnitude, so a body that lies inside a solid without touching
        its surface intersects it. The answer is exact if the solid mesh is closed
        (`Mesh.is_closed`). If it is open and the inside cannot be decided, the answer is True.
        Shapes ignore this option.
    on_error : {"raise", "status"}
        How to treat an invalid pose. ``"raise"`` raises an error. ``"status"`` returns True for its
        row, the safe answer, and also returns the `Status` of each row.
    progress : bool
        Whether to show the number of finished rows in one line of stderr during the call.
    on : impinge.cluster.Cluster, optional
        The cluster that divides the rows among its nodes, from `impinge.cluster.ray`. The answer is
        the same. Without it, the call runs on the threads of this process.

    Returns
    -------
    bool or (...) bool array
        True if the two intersect. With ``on_error="status"`` a tuple of this and a uint8 array of
        the same shape, the status of each row.

    Raises
    ------
    InputError
        If an argument has an unsupported type or shape, or if a pose is not finite, not affine,
        singular or out of range. All poses are validated before any work; the error names the row.

    Notes
    -----
    The search stops at the first intersecting pair of triangles. Many poses are distributed over
    all cores (see `threads`), with the interpreter's lock released. Ctrl-C interrupts the call.

    Examples
    --------
    >>> import impinge, numpy as np
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> impinge.intersects(triangle, triangle, pose_b=impinge.pose([1, 0, 0]))
    True
    >>> impinge.intersects(triangle, triangle, pose_b=impinge.pose([[1, 0, 0], [1 + 1e-15, 0, 0]]))
    array([ True, False])

    A small tetrahedron inside a large one intersects it only if the large one is solid:

    >>> corners = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], float)
    >>> large = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> inside = impinge.pose([1, 1, 1], rotation=np.eye(3) / 10)
    >>> [impinge.intersects(large, large, None, inside, solid=solid) for solid in (False, "a", "b", True)]
    [False, True, False, True]
    """
    return engine(on).intersects((a, b, pose_a, pose_b, solid, on_error, progress))


@overload
def penetrates(a: AnyShape, b: AnyShape) -> bool: ...
@overload
def penetrates(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[RaiseOptions]
) -> Booleans: ...
@overload
def penetrates(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[StatusOptions]
) -> tuple[Booleans, Statuses]: ...
def penetrates(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
    on: Cluster | None = None,
) -> Any:
    """Report whether the interiors of two meshes or shapes intersect; touching does not count.

    Parts of an assembly touch at every joint. Use this function to find the parts that collide.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things. A mesh is treated as a solid: its surface and all points with a winding
        number above 1/2 in magnitude.
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
        True if the interiors intersect, and also if this is undecided: if a mesh is open near the
        other one, if it intersects itself at an intersection with the other one, or if the bounds
        on the depth of two shapes include zero. With ``on_error="status"`` a tuple of this and a
        uint8 array, in which ``Status.UNDECIDED`` marks undecided answers. All other answers are
        exact.

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
    return engine(on).penetrates((a, b, pose_a, pose_b, False, on_error, progress))


class LimitedPairs(NamedTuple):
    """The first intersecting pairs of faces in sorted order, up to a limit for each pose."""

    pairs: NDArray[np.uint32] | Pairs
    """Face indices (face of a, face of b), sorted, (k, 2); `Pairs` if the poses have leading
    axes."""
    truncated: Booleans
    """Whether a pose has more pairs than were returned; an array if the poses have leading axes."""


@overload
def intersecting_pairs(a: Mesh, b: Mesh, *, limit: None = None) -> NDArray[np.uint32]: ...
@overload
def intersecting_pairs(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, *, limit: None = None, **rows: Unpack[RaiseOptions]
) -> NDArray[np.uint32] | Pairs: ...
@overload
def intersecting_pairs(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, *, limit: int, **rows: Unpack[RaiseOptions]
) -> LimitedPairs: ...
@overload
def intersecting_pairs(
    a: Mesh,
    b: Mesh,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    limit: int | None = None,
    **rows: Unpack[StatusOptions],
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
    on: Cluster | None = None,
) -> Any:
    """Return all pairs of faces, one of each mesh, that have a point in common; decided exactly.

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    limit : int, optional
        Maximum number of pairs to return for each pose: the first ones in sorted order. The result
        then also reports whether there are more.
    on_error : {"raise", "status"}
        How to treat an invalid pose. ``"status"`` returns no pairs for its row, and also returns
        the `Status` of each row. Check the status: for an invalid pose, an empty result does not
        mean that the meshes are apart.
    progress : bool
        As for `intersects`.
    on : impinge.cluster.Cluster, optional
        As for `intersects`.

    Returns
    -------
    (k, 2) uint32 array or Pairs
        Face indices (face of a, face of b), sorted by the first, then by the second, without
        duplicates. `Pairs` if the poses have leading axes. With a `limit` a `LimitedPairs`: a tuple
        of the pairs and whether there are more. With ``on_error="status"`` a tuple of this and the
        status of each row.

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
    max_pairs = None if limit is None else whole(limit, "limit")
    answer = engine(on).intersecting_pairs((a, b, pose_a, pose_b, False, on_error, progress), max_pairs)

    def convert(found: Any) -> NDArray[np.uint32] | Pairs | LimitedPairs:
        if len(found) == _SINGLE:
            pairs, truncated = found
        else:
            offsets, rows, shape, truncated = found
            pairs = Pairs(offsets, rows, tuple(shape))
        return pairs if limit is None else LimitedPairs(pairs, truncated)

    return with_status(answer, on_error, convert)


_SINGLE = 2
"""Length of the extension's result for a single pose: the pairs, and whether there are more."""


@overload
def intersection_curves(a: Mesh, b: Mesh) -> list[NDArray[np.float64]]: ...
@overload
def intersection_curves(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[RaiseOptions]
) -> list[Any]: ...
@overload
def intersection_curves(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[StatusOptions]
) -> tuple[list[Any], Statuses]: ...
def intersection_curves(
    a: Mesh,
    b: Mesh,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
    on: Cluster | None = None,
) -> Any:
    """Return the curves in which two surfaces intersect.

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh, as for `intersects`.
    on_error : {"raise", "status"}
        How to treat an invalid pose. ``"status"`` returns no curves for its row, and also returns
        the `Status` of each row. Check the status: for an invalid pose, an empty result does not
        mean that the meshes are apart.
    progress : bool
        As for `intersects`.
    on : impinge.cluster.Cluster, optional
        As for `intersects`.

    Returns
    -------
    list of (n, 3) float64 arrays
        Polylines in the world frame and unit. A polyline is closed if its first row equals its
        last. After the polylines comes one array with a single row for each isolated point in which
        the surfaces touch. The pieces and their connections are exact, and each coordinate is the
        true one, rounded. Coplanar faces that intersect have no curve of their own. If the poses
        have leading axes, the result is a nested list with one level for each axis. With
        ``on_error="status"`` a tuple of this and the status of each row.

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
    return engine(on).intersection_curves((a, b, pose_a, pose_b, False, on_error, progress))


def self_intersecting_pairs(mesh: Mesh) -> NDArray[np.uint32]:
    """Return all pairs of faces of one mesh that intersect beyond their shared corners and edge.

    Two faces always intersect in the hull of the positions that they share; such a contact is not
    reported. If they also intersect or overlap anywhere else, the pair is reported. Corners are
    shared if their positions are equal, whatever their indices. The result is exact.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    (k, 2) uint32 array
        Pairs with the smaller face index first; sorted, without duplicates.

    Raises
    ------
    InputError
        If `mesh` is not a `Mesh`.

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
