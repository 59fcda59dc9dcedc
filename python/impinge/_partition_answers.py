"""What a partition answers: which boxes are somewhere, what rays enter, what is near, what a step changed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impinge._ragged import Ragged


@dataclass(frozen=True, eq=False, repr=False)
class Keys(Ragged[NDArray[np.uint32]]):
    """The boxes that were found for each of many questions, one's after another's.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Those of question ``i``, in row-major order of the leading axes, are ``keys[offsets[i]:offsets[i + 1]]``.
    keys : (k,) uint32 array
        Ascending for each question.
    shape : tuple of int
        The leading axes of the questions; their product is ``n``.
    """

    offsets: NDArray[np.int64]
    keys: NDArray[np.uint32]
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> NDArray[np.uint32]:
        return self.keys[entries]

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> Keys:
        return Keys(offsets, self.keys[entries], shape)

    def __repr__(self) -> str:
        """Return the shape and the number of boxes."""
        return f"Keys(shape={self.shape}, {len(self.keys)} found)"


@dataclass(frozen=True, eq=False)
class BoxHit:
    """Which boxes rays enter; numbers where a single ray was cast and its first box asked for.

    Attributes
    ----------
    t : float or (...) float64 array
        Where the ray enters, in units of the direction's length, zero where it starts inside; infinite where no box is
        met. Never later than the true place, and within 2^-49 of itself of it.
    key : int or (...) int64 array
        The box; -1 where none is met.
    """

    t: float | NDArray[np.float64]
    key: int | NDArray[np.int64]


@dataclass(frozen=True, eq=False, repr=False)
class BoxHits(Ragged[BoxHit]):
    """Every box that each of many rays enters, one ray's after another's.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        The boxes of ray ``i``, in row-major order of the leading axes, are those from ``offsets[i]`` to
        ``offsets[i + 1]``; for each ray by `t` and then by key.
    t : (k,) float64 array
        As in `BoxHit`.
    key : (k,) int64 array
        The boxes.
    shape : tuple of int
        The leading axes of the rays; their product is ``n``.
    """

    offsets: NDArray[np.int64]
    t: NDArray[np.float64]
    key: NDArray[np.int64]
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> BoxHit:
        return BoxHit(self.t[entries], self.key[entries])

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> BoxHits:
        return BoxHits(offsets, self.t[entries], self.key[entries], shape)

    def __repr__(self) -> str:
        """Return the shape and the number of boxes."""
        return f"BoxHits(shape={self.shape}, {len(self.t)} hits)"


@dataclass(frozen=True, eq=False)
class Nearest:
    """The boxes that are nearest to points, by distance and then by key.

    Attributes
    ----------
    key : (..., count) int64 array
        The boxes; -1 where there are not so many.
    distance : (..., count) float64 array
        From the point to the box, zero inside; within 2^-50 of itself of the true one, infinite where `key` is -1.
    """

    key: NDArray[np.int64]
    distance: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Changes:
    """Which pairs of boxes a step changed; sorted, the lesser key first.

    Attributes
    ----------
    began : (k, 2) uint32 array
        Pairs that meet now and did not before.
    ended : (k, 2) uint32 array
        Pairs that met before and do not now.
    """

    began: NDArray[np.uint32]
    ended: NDArray[np.uint32]

    def __repr__(self) -> str:
        """Return how many pairs began and ended."""
        return f"Changes({len(self.began)} began, {len(self.ended)} ended)"
