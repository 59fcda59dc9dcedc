"""Bounding volumes and hulls of points, such as ``impinge.fit.obb(points)``.

Points are an (n, 3) array_like of float32 or float64, below 2^128 in magnitude. Each coordinate is
the exact real number that the float represents. Volumes are in the frame and unit of the points.
Every volume contains all points: its size is computed from the points themselves and rounded up.
Every nonempty set of points has a volume of every kind, including single points, duplicates, and
points on a line or in a plane.

Every function raises `InputError` if the points have another type or shape, if there are no points,
or if a coordinate is not finite or out of range. The error names the coordinate.
``docs/tasks/volumes.md`` compares the volumes on real meshes.

An axis-aligned box has three forms, `Aabb`, `MinWidths` and `CenterRadius`. A conversion between
them never shrinks the box. The last two can be packed into 16 or 20 bytes.

Examples
--------
>>> import impinge, numpy as np
>>> points = np.array([[0, 0, 0], [4, 0, 0], [4, 2, 0], [0, 2, 0], [2, 1, 1]], float)
>>> impinge.fit.aabb(points)
Aabb(low=array([0., 0., 0.]), high=array([4., 2., 1.]))
>>> round(impinge.fit.obb(points).volume, 9)
8.0
>>> impinge.fit.capsule(points).radius < 1.2
True
"""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike

from impinge import _impinge
from impinge._arrays import plain_cloud
from impinge._box_batch import AabbBatch
from impinge._boxes import (
    Aabb,
    AxisBox,
    CenterRadius,
    MinWidths,
    PackedBox,
    PackedCenterRadius,
    PackedMinWidths,
    aabb_of,
)
from impinge._mesh import Mesh
from impinge._scalars import chosen
from impinge._volumes import (
    Capsule,
    Hull,
    Kdop,
    Lozenge,
    Numbers,
    Obb,
    Proxies,
    Sphere,
    Volume,
    capsule_of,
    kdop_of,
    lozenge_of,
    obb_of,
    sphere_of,
)

__all__ = [
    "Aabb",
    "AabbBatch",
    "AxisBox",
    "Capsule",
    "CenterRadius",
    "Hull",
    "Kdop",
    "Lozenge",
    "MinWidths",
    "Obb",
    "PackedBox",
    "PackedCenterRadius",
    "PackedMinWidths",
    "Proxies",
    "Sphere",
    "Volume",
    "aabb",
    "capsule",
    "convex_hull",
    "kdop",
    "lozenge",
    "minimal_sphere",
    "obb",
    "proxies",
    "sphere",
]

_SPHERES = ("minimal", "mean", "box", "ritter", "principal", "refined")
_OBBS = ("least", "principal")
_KDOPS = (14, 18, 26)


def minimal_sphere(points: ArrayLike) -> Sphere:
    """Compute the smallest sphere that contains all points.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        At least one point; the result is in the frame and unit of the points.

    Returns
    -------
    Sphere
        The sphere. Its radius equals `Sphere.lower` to within rounding; no sphere that contains the
        points has a smaller radius than `Sphere.lower`.

    Raises
    ------
    InputError
        If there are no points, or if an argument is invalid (see `impinge.fit`).

    Examples
    --------
    >>> import impinge
    >>> sphere = impinge.minimal_sphere([[3, 0, 0], [-3, 0, 0], [0, 2, 0], [0, 0, 1]])
    >>> sphere.center, round(sphere.radius, 12), sphere.radius - sphere.lower < 1e-12
    (array([0., 0., 0.]), 3.0, True)
    """
    return sphere(points, "minimal")


def sphere(
    points: ArrayLike,
    method: Literal["minimal", "mean", "box", "ritter", "principal", "refined"] = "minimal",
) -> Sphere:
    """Compute a sphere that contains all points, by one of six methods.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        At least one point; the result is in the frame and unit of the points.
    method : {"minimal", "mean", "box", "ritter", "principal", "refined"}
        ``"minimal"`` is the smallest sphere, to within rounding. ``"mean"`` is centered at the mean
        of the points, ``"box"`` at the center of the axis-aligned box. ``"ritter"`` is Ritter's
        method. ``"principal"`` grows from the extreme points along the first principal axis.
        ``"refined"`` is Ritter's sphere, shrunk and grown again several times.

    Returns
    -------
    Sphere
        A sphere whose radius is rounded up, so that it contains every point.

    Raises
    ------
    InputError
        If there are no points, or if an argument is invalid (see `impinge.fit`).
    """
    return sphere_of(_fitted(points, f"{chosen(method, _SPHERES, 'method')} sphere"))


def aabb(points: ArrayLike) -> Aabb:
    """Compute the smallest axis-aligned box that contains all points, exactly.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        At least one point; the result is in the frame and unit of the points.

    Returns
    -------
    Aabb
        The box, whose corners are exact.

    Raises
    ------
    InputError
        If there are no points, or if an argument is invalid (see `impinge.fit`).
    """
    return aabb_of(_fitted(points, "aabb"))


def obb(points: ArrayLike, method: Literal["least", "principal"] = "least") -> Obb:
    """Compute an oriented box that contains all points.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        At least one point; the result is in the frame and unit of the points.
    method : {"least", "principal"}
        ``"least"`` has nearly the smallest volume: at most 6 sqrt(6) times the minimum, and mostly
        close to it. ``"principal"`` is aligned with the principal axes; it is faster, and may be
        large.

    Returns
    -------
    Obb
        A box whose half-extents are rounded up, so that it contains every point.

    Raises
    ------
    InputError
        If there are no points, or if an argument is invalid (see `impinge.fit`).
    """
    return obb_of(_fitted(points, f"{chosen(method, _OBBS, 'method')} obb"))


def capsule(points: ArrayLike) -> Capsule:
    """Compute a capsule that contains all points.

    It is the smallest of three capsules, one along each principal axis.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        At least one point; the result is in the frame and unit of the points.

    Returns
    -------
    Capsule
        A capsule whose radius is rounded up, so that it contains every point.

    Raises
    ------
    InputError
        If there are no points, or if an argument is invalid (see `impinge.fit`).
    """
    return capsule_of(_fitted(points, "capsule"))


def lozenge(points: ArrayLike) -> Lozenge:
    """Compute a lozenge that contains all points: a rectangle enlarged by a radius.

    It is the smallest by volume of six candidates: a short and a long rectangle for each principal
    axis as the thickness.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        At least one point; the result is in the frame and unit of the points.

    Returns
    -------
    Lozenge
        A lozenge whose radius is rounded up, so that it contains every point.

    Raises
    ------
    InputError
        If there are no points, or if an argument is invalid (see `impinge.fit`).
    """
    return lozenge_of(_fitted(points, "lozenge"))


def kdop(points: ArrayLike, k: Literal[14, 18, 26] = 18) -> Kdop:
    """Compute the smallest polytope with k faces in fixed directions that contains all points.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        At least one point; the result is in the frame and unit of the points.
    k : {14, 18, 26}
        Number of faces. Their normals point to the faces of a cube, and to its corners (14), its
        edges (18), or both (26).

    Returns
    -------
    Kdop
        The polytope; its planes are rounded outward, so that it contains every point.

    Raises
    ------
    InputError
        If there are no points, or if an argument is invalid (see `impinge.fit`).
    """
    return kdop_of(_fitted(points, f"{chosen(k, _KDOPS, 'k')}-dop"))


def convex_hull(points: ArrayLike) -> Hull:
    """Compute the convex hull of points, exactly.

    Flat, straight and cospherical sets of points are handled like any other.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        At least one point.

    Returns
    -------
    Hull
        The hull, as indices into `points`; ``impinge.Mesh(points, hull.faces)`` is its mesh.

    Raises
    ------
    InputError
        If there are no points, or if an argument is invalid (see `impinge.fit`).

    Examples
    --------
    >>> import impinge
    >>> points = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [1, 1, 1], [2, 0, 0]]
    >>> hull = impinge.convex_hull(points)
    >>> hull
    Hull(4 vertices, 4 faces, dimension 3)
    >>> hull.vertices
    array([0, 1, 2, 3], dtype=uint32)
    """
    return Hull(*_impinge.convex_hull(plain_cloud(points, "points")))


def proxies(mesh: Mesh) -> Proxies:
    """Return the convex hull of a mesh's surface, and a volume of each kind around it.

    If the mesh was loaded from a file with proxies (see `Mesh.bake`), these are validated and
    returned. Otherwise they are computed at the first call. Vertices without faces are ignored.

    Parameters
    ----------
    mesh : Mesh
        A mesh with at least one face.

    Returns
    -------
    Proxies
        The hull and the volumes.

    Raises
    ------
    InputError
        If the mesh is empty, or if the proxies in its file do not match it.

    Examples
    --------
    >>> import impinge
    >>> mesh = impinge.Mesh([[9, 9, 9], [0, 0, 0], [2, 0, 0], [0, 2, 0]], [[1, 2, 3]])
    >>> proxies = impinge.fit.proxies(mesh)
    >>> proxies.hull.vertices, proxies.aabb.high
    (array([1, 2, 3], dtype=uint32), array([2., 2., 0.]))
    >>> proxy = impinge.Shape.hull(mesh.vertices[proxies.hull.vertices])
    """
    hull, (aabb, sphere, capsule, lozenge, obb, *kdops) = _impinge.proxies(mesh)
    volumes = aabb_of(aabb), sphere_of(sphere), capsule_of(capsule), lozenge_of(lozenge), obb_of(obb)
    return Proxies(Hull(*hull), *volumes, *map(kdop_of, kdops))


def _fitted(points: ArrayLike, construction: str) -> Numbers:
    return _impinge.fit_volume(plain_cloud(points, "points"), construction)
