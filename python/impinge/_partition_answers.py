"""Results of a partition: boxes in regions, on rays and near points, and the changes at a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impinge._ragged import Ragged


@dataclass(frozen=True, eq=False, repr=False)
class Keys(Ragged[NDArray[np.uint32]]):
    """Keys of the boxes that each of many queries found, concatenated query by query.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each query's boxes: the boxes of query ``i``, in row-major order of the leading
        axes, are ``keys[offsets[i]:offsets[i + 1]]``.
    keys : (k,) uint32 array
        Keys of the boxes, ascending for each query.
    shape : tuple of int
        The leading axes of the queries; their product is ``n``.
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
    """The first box that each ray enters, as plain numbers for one ray; or all boxes of one ray.

    Attributes
    ----------
    t : float or (...) float64 array
        Ray parameter of the entry, in units of the direction's length. Zero if the ray starts
        inside, infinite if it enters no box. Never greater than the true value, with a relative
        error of at most 2^-49.
    key : int or (...) int64 array
        Key of the box; -1 if the ray enters no box.
    """

    t: float | NDArray[np.float64]
    key: int | NDArray[np.int64]


@dataclass(frozen=True, eq=False, repr=False)
class BoxHits(Ragged[BoxHit]):
    """All boxes that each of many rays enters, concatenated ray by ray.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each ray's boxes: the boxes of ray ``i``, in row-major order of the leading axes,
        go from ``offsets[i]`` to ``offsets[i + 1]``. The boxes of a ray are sorted by `t`, then by
        key.
    t : (k,) float64 array
        Ray parameters of the entries, as in `BoxHit`.
    key : (k,) int64 array
        Keys of the boxes.
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
    """For each point the boxes that are nearest to it, sorted by distance, then by key.

    Attributes
    ----------
    key : (..., count) int64 array
        Keys of the boxes; -1 if there are fewer than `count` boxes.
    distance : (..., count) float64 array
        Distance from the point to the box, in the unit of the boxes, with a relative error of at
        most 2^-50; zero inside, infinite if `key` is -1.
    """

    key: NDArray[np.int64]
    distance: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Changes:
    """Pairs of boxes that began or stopped overlapping in a step; sorted, the smaller key first.

    Attributes
    ----------
    began : (k, 2) uint32 array
        Keys of the pairs that overlap now and did not before.
    ended : (k, 2) uint32 array
        Keys of the pairs that overlapped before and do not now; a removed box ends its pairs.
    """

    began: NDArray[np.uint32]
    ended: NDArray[np.uint32]

    def __repr__(self) -> str:
        """Return the numbers of pairs that began and ended."""
        return f"Changes({len(self.began)} began, {len(self.ended)} ended)"
