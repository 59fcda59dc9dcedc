"""Bounding volumes and hulls of points: ``impinge.fit.obb(points)``.

Points are an (n, 3) array_like of float32 or float64, of which every number is the real one that it is, below 2^128 in
magnitude. Every volume holds all of them: its size is rounded up last of all, from the points themselves. Any set but
the empty one has a volume of every kind: one point, duplicates, points on a line or in a plane.

Every function raises `InputError` where points have another type or shape, where there are none, or where one is not
finite or out of range; it says which. ``docs/volumes.md`` compares the volumes on real meshes.

An axis-aligned box has three forms, `Aabb`, `MinWidths` and `CenterRadius`. They convert into each other without ever
shrinking, and the last two may be packed into 16 or 20 bytes.

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
    """Return the smallest sphere that holds all points.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        The points.

    Returns
    -------
    Sphere
        With a radius within rounding of `Sphere.lower`, which no sphere that holds the points can go below.

    Raises
    ------
    InputError
        As the module says.

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
    """Return a sphere that holds all points, by one of six constructions.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        The points.
    method : {"minimal", "mean", "box", "ritter", "principal", "refined"}
        The smallest one; that about the mean; that about the centre of the axis-aligned box; Ritter's; that which grows
        from the extremes along the first principal axis; Ritter's, shrunk and grown again.

    Returns
    -------
    Sphere

    Raises
    ------
    InputError
        As the module says, or if there is no such method.
    """
    return sphere_of(_fitted(points, f"{chosen(method, _SPHERES, 'method')} sphere"))


def aabb(points: ArrayLike) -> Aabb:
    """Return the least axis-aligned box of points, exactly.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        The points.

    Returns
    -------
    Aabb

    Raises
    ------
    InputError
        As the module says.
    """
    return aabb_of(_fitted(points, "aabb"))


def obb(points: ArrayLike, method: Literal["least", "principal"] = "least") -> Obb:
    """Return an oriented box that holds all points.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        The points.
    method : {"least", "principal"}
        One of nearly the least volume, at most 6 root 6 of the least one's and mostly close to it; or that along the
        principal axes, which is quicker and may be large.

    Returns
    -------
    Obb

    Raises
    ------
    InputError
        As the module says, or if there is no such method.
    """
    return obb_of(_fitted(points, f"{chosen(method, _OBBS, 'method')} obb"))


def capsule(points: ArrayLike) -> Capsule:
    """Return a capsule that holds all points: the smallest of those along the three principal axes.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        The points.

    Returns
    -------
    Capsule

    Raises
    ------
    InputError
        As the module says.
    """
    return capsule_of(_fitted(points, "capsule"))


def lozenge(points: ArrayLike) -> Lozenge:
    """Return a lozenge, a rectangle with a radius, that holds all points: the smallest along the principal axes.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        The points.

    Returns
    -------
    Lozenge

    Raises
    ------
    InputError
        As the module says.
    """
    return lozenge_of(_fitted(points, "lozenge"))


def kdop(points: ArrayLike, k: Literal[14, 18, 26] = 18) -> Kdop:
    """Return the least polytope with k faces in fixed directions that holds all points.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        The points.
    k : {14, 18, 26}
        The six faces of a cube, and its corners, its edges, or both.

    Returns
    -------
    Kdop

    Raises
    ------
    InputError
        As the module says, or if there is no such k.
    """
    return kdop_of(_fitted(points, f"{chosen(k, _KDOPS, 'k')}-dop"))


def convex_hull(points: ArrayLike) -> Hull:
    """Return the convex hull of points, exactly: flat, straight and cospherical sets have theirs like others.

    Parameters
    ----------
    points : (n, 3) array_like of float32 or float64
        The points.

    Returns
    -------
    Hull
        Of indices into `points`; ``impinge.Mesh(points, hull.faces)`` is its mesh.

    Raises
    ------
    InputError
        As the module says.

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
    """Return the convex hull of a mesh's surface, and a volume of each kind about it.

    Those that `Mesh.bake` wrote beside the mesh, proved to be its own, where it was loaded with them; else they are
    made when first asked for. Vertices that no face has do not count.

    Parameters
    ----------
    mesh : Mesh
        With a face at least.

    Returns
    -------
    Proxies

    Raises
    ------
    InputError
        If the mesh is empty, or comes from a file with other proxies than its own.

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
