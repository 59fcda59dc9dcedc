"""Bounding volumes, as `impinge.fit` returns them. Every one holds all the points that it was made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from impinge._boxes import Aabb

Numbers: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]
"""A volume as the extension has it: rows of three numbers, and single numbers."""


@dataclass(frozen=True, eq=False)
class Volume:
    """What every volume has.

    Attributes
    ----------
    volume : float
        What it encloses, in cubic units, rounded.
    surface_area : float
        In square units, rounded; both sides of what is flat.
    """

    volume: float = field(repr=False, kw_only=True)
    surface_area: float = field(repr=False, kw_only=True)


@dataclass(frozen=True, eq=False)
class Sphere(Volume):
    """A sphere.

    Attributes
    ----------
    center : (3,) float64 array
        Its centre.
    radius : float
        Rounded up, so that every point is inside.
    lower : float
        No sphere that holds the points has a smaller radius.
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
        Its centre.
    axes : (3, 3) float64 array
        Three unit vectors at right angles, one a row.
    half_extents : (3,) float64 array
        Half the lengths along the axes, rounded up.
    volume_lower : float
        No convex set that holds the points has a smaller volume; zero where nothing better is known.
    """

    center: NDArray[np.float64]
    axes: NDArray[np.float64]
    half_extents: NDArray[np.float64]
    volume_lower: float


@dataclass(frozen=True, eq=False)
class Capsule(Volume):
    """The points within a radius of a segment.

    Attributes
    ----------
    start, end : (3,) float64 array
        The ends of the segment, which may be one point.
    radius : float
        Rounded up.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    radius: float


@dataclass(frozen=True, eq=False)
class Lozenge(Volume):
    """The points within a radius of a rectangle.

    Attributes
    ----------
    corner : (3,) float64 array
        A corner of the rectangle.
    edges : (2, 3) float64 array
        The two edges from there, one a row.
    radius : float
        Rounded up.
    """

    corner: NDArray[np.float64]
    edges: NDArray[np.float64]
    radius: float


@dataclass(frozen=True, eq=False)
class Kdop(Volume):
    """A polytope of parallel pairs of faces: the points x with ``low <= directions @ x <= high``.

    Attributes
    ----------
    directions : (k / 2, 3) float64 array
        Of entries -1, 0 and 1, not of unit length.
    low, high : (k / 2,) float64 array
        The least and greatest extent along each, rounded outward.
    """

    directions: NDArray[np.float64] = field(repr=False)
    low: NDArray[np.float64]
    high: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Hull:
    """The convex hull of points; exact.

    Attributes
    ----------
    vertices : (h,) uint32 array
        The points that are not in the hull of the others, as ascending indices into the points; of equal points the
        first.
    faces : (f, 3) uint32 array
        The boundary as triangles of indices into the points, counterclockwise seen from outside. A flat hull has both
        its sides; one that is a point or a segment has none.
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
    """What may stand for a mesh: its convex hull, and a volume of each kind about it.

    Attributes
    ----------
    hull : Hull
        Of indices into the mesh's vertices; exact.
    aabb : Aabb
        The axis-aligned box.
    sphere : Sphere
        The smallest one, but for rounding; its `lower` is 0.
    capsule : Capsule
        That of `impinge.fit.capsule`.
    lozenge : Lozenge
        That of `impinge.fit.lozenge`.
    obb : Obb
        That of `impinge.fit.obb`; its `volume_lower` is 0.
    kdop14, kdop18, kdop26 : Kdop
        Polytopes of so many faces.
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
        """Return what the hull is."""
        return f"Proxies({self.hull!r})"


def sphere_of(numbers: Numbers) -> Sphere:
    """Return the sphere of its centre, its radius and the lower bound."""
    (center,), (radius, lower), sizes = _sized(numbers)
    return Sphere(center, float(radius), float(lower), **sizes)


def obb_of(numbers: Numbers) -> Obb:
    """Return the box of its centre, axes and half-extents, and the lower bound."""
    rows, (lower,), sizes = _sized(numbers)
    return Obb(rows[0], rows[1:4], rows[4], float(lower), **sizes)


def capsule_of(numbers: Numbers) -> Capsule:
    """Return the capsule of its ends and its radius."""
    (start, end), (radius,), sizes = _sized(numbers)
    return Capsule(start, end, float(radius), **sizes)


def lozenge_of(numbers: Numbers) -> Lozenge:
    """Return the lozenge of a corner, two edges and its radius."""
    rows, (radius,), sizes = _sized(numbers)
    return Lozenge(rows[0], rows[1:], float(radius), **sizes)


def kdop_of(numbers: Numbers) -> Kdop:
    """Return the polytope of its directions and the extents along them."""
    rows, extents, sizes = _sized(numbers)
    return Kdop(rows, extents[: len(rows)], extents[len(rows) :], **sizes)


def _sized(numbers: Numbers) -> tuple[NDArray[np.float64], NDArray[np.float64], dict[str, float]]:
    """Return rows of three numbers, single numbers, and what every volume has."""
    rows, singles = numbers
    return rows, singles[:-2], {"volume": float(singles[-2]), "surface_area": float(singles[-1])}
