"""What a world answers: what a step changed, what rays meet, which bodies are somewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impinge._ragged import Ragged


@dataclass(frozen=True)
class Work:
    """How much work a step was, in counts that depend on nothing but the bodies.

    Attributes
    ----------
    changed : int
        Bodies that changed.
    gained, lost : int
        Pairs of boxes that came to overlap, and that ceased to.
    examined : int
        Pairs of shapes that were looked at.
    candidates : int
        Pairs of boxes that overlap now.
    """

    changed: int
    gained: int
    lost: int
    examined: int
    candidates: int


@dataclass(frozen=True, eq=False, repr=False)
class Step:
    """What changed at a step; pairs are sorted by the bodies' tags, then by handles.

    Attributes
    ----------
    began : (k, 2) uint64 array
        Handles of the pairs that meet now and did not before.
    ended : (k, 2) uint64 array
        Those of pairs that met before and do not now; a body that was removed is named by its stale handle.
    persisting : (k, 2) uint64 array or None
        Those of pairs that met before and still do, where they were asked for.
    work : Work
        What the step had to do.
    """

    began: NDArray[np.uint64]
    ended: NDArray[np.uint64]
    persisting: NDArray[np.uint64] | None
    work: Work

    def __repr__(self) -> str:
        """Return how many pairs began and ended."""
        stay = "" if self.persisting is None else f", {len(self.persisting)} persisting"
        return f"Step({len(self.began)} began, {len(self.ended)} ended{stay})"


@dataclass(frozen=True, eq=False, repr=False)
class Bodies(Ragged[NDArray[np.uint64]]):
    """The bodies that were found for each of many questions, one's after another's.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Those of question ``i``, in row-major order of the leading axes, are ``handles[offsets[i]:offsets[i + 1]]``.
    handles : (k,) uint64 array
        For each question sorted by tags, then by themselves.
    shape : tuple of int
        The leading axes of the questions; their product is ``n``.

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


@dataclass(frozen=True, eq=False)
class BodyRayHit:
    """Where rays meet bodies; numbers where a single one was cast.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether the ray meets a body.
    t : float or (...) float64 array
        In units of the direction's length, zero where the ray starts in a shape; infinite where nothing is met.
    body : int or (...) uint64 array
        The handle of the body; 0, which no body has, where nothing is met.
    point : (..., 3) float64 array
        The point, in the world frame, rounded; zero where nothing is met.
    face : int or (...) int64 array
        The face of a mesh; -1 where there is none.
    """

    hit: bool | NDArray[np.bool_]
    t: float | NDArray[np.float64]
    body: int | NDArray[np.uint64]
    point: NDArray[np.float64]
    face: int | NDArray[np.int64]


@dataclass(frozen=True, eq=False, repr=False)
class BodyRayHits(Ragged[BodyRayHit]):
    """Every body that each of many rays meets, one ray's hits after another's.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        The hits of ray ``i``, in row-major order of the leading axes, are those from ``offsets[i]`` to
        ``offsets[i + 1]``; for each ray in the order in which it meets them.
    t, body, point, face : (k,) or (k, 3) arrays
        As those of `BodyRayHit`.
    shape : tuple of int
        The leading axes of the rays; their product is ``n``.
    """

    offsets: NDArray[np.int64]
    t: NDArray[np.float64]
    body: NDArray[np.uint64]
    point: NDArray[np.float64]
    face: NDArray[np.int64]
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> BodyRayHit:
        return body_hits_of(self.t[entries], self.body[entries], self.point[entries], self.face[entries])

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> BodyRayHits:
        columns = self.t[entries], self.body[entries], self.point[entries], self.face[entries]
        return BodyRayHits(offsets, *columns, shape)

    def __repr__(self) -> str:
        """Return the shape and the number of hits."""
        return f"BodyRayHits(shape={self.shape}, {len(self.t)} hits)"


def body_hits_of(
    t: NDArray[np.float64], body: NDArray[np.uint64], point: NDArray[np.float64], face: NDArray[np.int64]
) -> BodyRayHit:
    """Return what one ray meets: arrays of as many entries as there are hits."""
    return BodyRayHit(np.ones(len(t), bool), t, body, point, face)
