"""Bounding volumes of `impinge.fit`. Each volume contains all points that it was made from."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from impinge._boxes import Aabb

Numbers: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]
"""A volume as the extension returns it: rows of three numbers, and single numbers."""


@dataclass(frozen=True, eq=False)
class Volume:
    """Base class of all volumes; a volume is in the frame and unit of its points.

    Attributes
    ----------
    volume : float
        Enclosed volume in cubic units, rounded.
    surface_area : float
        Surface area in square units, rounded. For a flat volume, both sides count.
    """

    volume: float = field(repr=False, kw_only=True)
    surface_area: float = field(repr=False, kw_only=True)


@dataclass(frozen=True, eq=False)
class Sphere(Volume):
    """A sphere that contains all points that it was made from.

    Attributes
    ----------
    center : (3,) float64 array
        Center of the sphere, in the frame of the points.
    radius : float
        Radius, rounded up, so that every point is inside.
    lower : float
        Lower bound of the radius: no sphere that contains the points is smaller. Zero if unknown.
    """

    center: NDArray[np.float64]
    radius: float
    lower: float


@dataclass(frozen=True, eq=False)
class Obb(Volume):
    """An oriented box: the points ``center + t @ axes`` with ``abs(t) <= half_extents``.

    Attributes
    ----------
    center : (3,) float64 array
        Center of the box, in the frame of the points.
    axes : (3, 3) float64 array
        Directions of the edges in the frame of the points: a unit vector in each row, orthogonal to
        the others to within rounding.
    half_extents : (3,) float64 array
        Half the lengths along the axes, rounded up.
    volume_lower : float
        Lower bound of the volume: no convex set that contains the points is smaller. Zero if
        unknown.
    """

    center: NDArray[np.float64]
    axes: NDArray[np.float64]
    half_extents: NDArray[np.float64]
    volume_lower: float


@dataclass(frozen=True, eq=False)
class Capsule(Volume):
    """A capsule: the points within a radius of a segment.

    Attributes
    ----------
    start, end : (3,) float64 array
        Ends of the segment, in the frame of the points; they may be equal.
    radius : float
        Radius, rounded up.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    radius: float


@dataclass(frozen=True, eq=False)
class Lozenge(Volume):
    """A lozenge: the points within a radius of a rectangle.

    Attributes
    ----------
    corner : (3,) float64 array
        A corner of the rectangle, in the frame of the points.
    edges : (2, 3) float64 array
        The two edges of the rectangle from `corner`, one for each row.
    radius : float
        Radius, rounded up.
    """

    corner: NDArray[np.float64]
    edges: NDArray[np.float64]
    radius: float


@dataclass(frozen=True, eq=False)
class Kdop(Volume):
    """A k-DOP, bounded by pairs of parallel planes: all x with ``low <= directions @ x <= high``.

    Attributes
    ----------
    directions : (k / 2, 3) float64 array
        Normals of the planes, with entries -1, 0 and 1; not of unit length.
    low, high : (k / 2,) float64 array
        Minimum and maximum of ``direction @ point`` over the points, rounded outward.
    """

    directions: NDArray[np.float64] = field(repr=False)
    low: NDArray[np.float64]
    high: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Hull:
    """The convex hull of points, as indices into the points; exact.

    Attributes
    ----------
    vertices : (h,) uint32 array
        Ascending indices of the points that are not in the hull of the others. Of equal points, the
        first is used.
    faces : (f, 3) uint32 array
        Triangles of the boundary, as indices into the points, counterclockwise as seen from
        outside. A flat hull has faces on both sides. A hull that is a point or a segment has no
        faces.
    dimension : int
        0 for a point, 1 for a segment, 2 for a polygon, 3 for a polyhedron.
    """

    vertices: NDArray[np.uint32]
    faces: NDArray[np.uint32]
    dimension: int

    def __repr__(self) -> str:
        """Return the numbers of vertices and faces."""
        return f"Hull({len(self.vertices):,} vertices, {len(self.faces):,} faces, dimension {self.dimension})"


@dataclass(frozen=True, eq=False, repr=False)
class Proxies:
    """Simple volumes around a mesh: its convex hull, and one volume of each kind.

    Attributes
    ----------
    hull : Hull
        Convex hull, as indices into the mesh's vertices; exact.
    aabb : Aabb
        Axis-aligned box.
    sphere : Sphere
        Smallest sphere, to within rounding; its `lower` is 0.
    capsule : Capsule
        As from `impinge.fit.capsule`.
    lozenge : Lozenge
        As from `impinge.fit.lozenge`.
    obb : Obb
        As from `impinge.fit.obb`; its `volume_lower` is 0.
    kdop14, kdop18, kdop26 : Kdop
        k-DOPs with 14, 18 and 26 faces.
    """

    hull: Hull
    aabb: Aabb
    sphere: Sphere
    capsule: Capsule
    lozenge: Lozenge
    obb: Obb
    kdop14: Kdop
    kdop18: Kdop
    kdop26: Kdop

    def __repr__(self) -> str:
        """Return the sizes of the hull."""
        return f"Proxies({self.hull!r})"


def sphere_of(numbers: Numbers) -> Sphere:
    """Return a sphere from its center, radius and lower bound."""
    (center,), (radius, lower), sizes = _sized(numbers)
    return Sphere(center, float(radius), float(lower), **sizes)


def obb_of(numbers: Numbers) -> Obb:
    """Return an oriented box from its center, axes, half-extents and lower bound of its volume."""
    rows, (lower,), sizes = _sized(numbers)
    return Obb(rows[0], rows[1:4], rows[4], float(lower), **sizes)


def capsule_of(numbers: Numbers) -> Capsule:
    """Return a capsule from its ends and radius."""
    (start, end), (radius,), sizes = _sized(numbers)
    return Capsule(start, end, float(radius), **sizes)


def lozenge_of(numbers: Numbers) -> Lozenge:
    """Return a lozenge from a corner, two edges and its radius."""
    rows, (radius,), sizes = _sized(numbers)
    return Lozenge(rows[0], rows[1:], float(radius), **sizes)


def kdop_of(numbers: Numbers) -> Kdop:
    """Return a k-DOP from its directions and the extents along them."""
    rows, extents, sizes = _sized(numbers)
    return Kdop(rows, extents[: len(rows)], extents[len(rows) :], **sizes)


def _sized(numbers: Numbers) -> tuple[NDArray[np.float64], NDArray[np.float64], dict[str, float]]:
    """Return the rows, the single numbers, and the fields that all volumes have."""
    rows, singles = numbers
    return rows, singles[:-2], {"volume": float(singles[-2]), "surface_area": float(singles[-1])}
