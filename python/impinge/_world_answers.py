"""Results of a world: changes at a step, hits of rays and moving shapes, and found bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from impinge._distances import Distance
from impinge._motion import Impact
from impinge._ragged import Ragged


@dataclass(frozen=True)
class Work:
    """Amount of work in a step, as counts that do not depend on threads or on the machine.

    Attributes
    ----------
    changed : int
        Number of bodies that were inserted, moved or otherwise changed since the previous step.
    gained, lost : int
        Numbers of pairs of boxes that started and stopped overlapping.
    examined : int
        Number of pairs of shapes that were tested.
    candidates : int
        Number of pairs of boxes that overlap now.
    """

    changed: int
    gained: int
    lost: int
    examined: int
    candidates: int


@dataclass(frozen=True, eq=False, repr=False)
class Step:
    """Pairs that began or stopped intersecting at a step, sorted by tag, then by handle.

    Attributes
    ----------
    began : (k, 2) uint64 array
        Handles of the pairs that intersect now and did not before.
    ended : (k, 2) uint64 array
        Handles of the pairs that intersected before and do not now. A removed body has its stale
        handle here.
    persisting : (k, 2) uint64 array or None
        Handles of the pairs that intersected before and still do; None if the caller did not ask
        for them.
    work : Work
        Amount of work in the step.
    """

    began: NDArray[np.uint64]
    ended: NDArray[np.uint64]
    persisting: NDArray[np.uint64] | None
    work: Work

    def __repr__(self) -> str:
        """Return the numbers of pairs."""
        persisting = "" if self.persisting is None else f", {len(self.persisting)} persisting"
        return f"Step({len(self.began)} began, {len(self.ended)} ended{persisting})"


@dataclass(frozen=True, eq=False, repr=False)
class Bodies(Ragged[NDArray[np.uint64]]):
    """Handles of the bodies that each of many queries found, concatenated query by query.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each query's bodies: the bodies of query ``i``, in row-major order of the leading
        axes, are ``handles[offsets[i]:offsets[i + 1]]``.
    handles : (k,) uint64 array
        Handles of the bodies, for each query sorted by tag, then by handle.
    shape : tuple of int
        The leading axes of the queries; their product is ``n``.

    Examples
    --------
    >>> import impinge
    >>> world = impinge.World()
    >>> ball = world.insert(impinge.Shape.sphere(1))
    >>> world.at_points([[0, 0, 0.5], [0, 0, 1.5]]).counts
    array([1, 0])
    """

    offsets: NDArray[np.int64]
    handles: NDArray[np.uint64]
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> NDArray[np.uint64]:
        return self.handles[entries]

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> Bodies:
        return Bodies(offsets, self.handles[entries], shape)

    def __repr__(self) -> str:
        """Return the shape and the number of bodies."""
        return f"Bodies(shape={self.shape}, {len(self.handles)} found)"


RayColumns: TypeAlias = tuple[
    NDArray[np.float64],
    NDArray[np.uint64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.int64],
    NDArray[np.int64],
]
"""Columns of ray hits: `t`, `body`, `point`, `normal`, `part` and `face`."""


@dataclass(frozen=True, eq=False)
class BodyRayHit:
    """Hits of rays on bodies of a world; plain numbers for the first hit of a single ray.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether the ray hits a body.
    t : float or (...) float64 array
        Ray parameter of the hit, in units of the direction's length; zero if the ray starts inside
        a shape, infinite if it misses. It is as accurate as `Shape.ray_cast`; for a mesh, as
        `Mesh.ray_cast` with the ray rounded in the mesh frame.
    body : int or (...) uint64 array
        Handle of the body; 0, which is never a handle, if the ray misses.
    point : (..., 3) float64 array
        Point of the hit in the world frame, rounded; zero if the ray misses.
    normal : (..., 3) float64 array
        Outward unit normal of the surface there, in the world frame. A mesh that is not solid and a
        flat shape have two sides: their normal is on the side that the ray comes from. NaN if the
        ray misses, if it starts inside a shape or on it, and if the face has no area. For faces,
        half-spaces, polytopes, spheres and capsules at rigid poses it is within 2^-36 of the exact
        normal, for other round shapes within 2^-12. At an edge it is that of one of the sides, or
        of a plane between them.
    part : int or (...) int64 array
        Index of the part that is hit, 0 if the body is not a compound; -1 if the ray misses.
    face : int or (...) int64 array
        Index of the face of the mesh that is hit; -1 if no mesh is hit, or if the ray starts inside
        a solid mesh.
    """

    hit: bool | NDArray[np.bool_]
    t: float | NDArray[np.float64]
    body: int | NDArray[np.uint64]
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    part: int | NDArray[np.int64]
    face: int | NDArray[np.int64]


@dataclass(frozen=True, eq=False, repr=False)
class BodyRayHits(Ragged[BodyRayHit]):
    """All bodies that each of many rays hits, each at its first hit, concatenated ray by ray.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each ray's hits: the hits of ray ``i``, in row-major order of the leading axes, go
        from ``offsets[i]`` to ``offsets[i + 1]``. The hits of a ray are in the order along the ray.
    t, body, point, normal, part, face : (k,) or (k, 3) arrays
        As in `BodyRayHit`.
    shape : tuple of int
        The leading axes of the rays; their product is ``n``.
    """

    offsets: NDArray[np.int64]
    t: NDArray[np.float64]
    body: NDArray[np.uint64]
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    part: NDArray[np.int64]
    face: NDArray[np.int64]
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> BodyRayHit:
        return body_hits_of(*self._columns(entries))

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> BodyRayHits:
        return BodyRayHits(offsets, *self._columns(entries), shape)

    def _columns(self, entries: slice) -> RayColumns:
        place = self.t[entries], self.body[entries], self.point[entries]
        return *place, self.normal[entries], self.part[entries], self.face[entries]

    def __repr__(self) -> str:
        """Return the shape and the number of hits."""
        return f"BodyRayHits(shape={self.shape}, {len(self.t)} hits)"


def body_hits_of(*columns: *RayColumns) -> BodyRayHit:
    """Return all hits of one ray, given as the columns of `BodyRayHit` after `hit`."""
    return BodyRayHit(np.ones(len(columns[0]), bool), *columns)


@dataclass(frozen=True, eq=False)
class BodyImpact:
    """Impacts of a moving shape on bodies of a world; plain numbers for the first of one motion.

    Attributes
    ----------
    body : int or (...) uint64 array
        Handle of the body; 0, which is never a handle, if the shape touches none.
    impact : Impact
        Time and place, as from `impinge.time_of_impact` with the shape as the first body and this
        body, at rest, as the second. Without a body its times are infinite.
    """

    body: int | NDArray[np.uint64]
    impact: Impact


@dataclass(frozen=True, eq=False, repr=False)
class BodyImpacts(Ragged[BodyImpact]):
    """All bodies that a shape touches on each of many motions, concatenated motion by motion.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each motion's impacts: the impacts of motion ``i``, in row-major order of the
        leading axes, go from ``offsets[i]`` to ``offsets[i + 1]``. They are sorted by time.
    body : (k,) uint64 array
        Handles of the bodies.
    impact : Impact
        First impact on each body, with arrays of ``k`` entries.
    shape : tuple of int
        The leading axes of the motions; their product is ``n``.
    """

    offsets: NDArray[np.int64]
    body: NDArray[np.uint64]
    impact: Impact
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> BodyImpact:
        return BodyImpact(self.body[entries], self._impacts(entries))

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> BodyImpacts:
        return BodyImpacts(offsets, self.body[entries], self._impacts(entries), shape)

    def _impacts(self, entries: slice) -> Impact:
        impact = self.impact
        columns: tuple[Any, ...] = (impact.hit, impact.t_lower, impact.t_upper)
        columns += (impact.point, impact.normal, impact.parts, impact.faces)
        return Impact(*(column[entries] for column in columns))

    def __repr__(self) -> str:
        """Return the shape and the number of impacts."""
        return f"BodyImpacts(shape={self.shape}, {len(self.body)} impacts)"


@dataclass(frozen=True, eq=False)
class BodyDistance:
    """The body of a world that is nearest to a shape; plain numbers for a single pose.

    Attributes
    ----------
    body : int or (...) uint64 array
        Handle of the body; 0, which is never a handle, if none is within the limit.
    distance : Distance
        Its distance, as from `impinge.distance` with the shape as the first thing. Without a body
        it is infinite.
    """

    body: int | NDArray[np.uint64]
    distance: Distance
