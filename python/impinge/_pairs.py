"""Pairs of faces for many poses, in two arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impinge._ragged import Ragged


@dataclass(frozen=True, eq=False, repr=False)
class Pairs(Ragged[NDArray[np.uint32]]):
    """Pairs of intersecting faces for each of many poses, concatenated pose by pose.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each pose's pairs: the pairs of pose ``i``, in row-major order of the leading axes,
        are ``rows[offsets[i]:offsets[i + 1]]``.
    rows : (k, 2) uint32 array
        Indices of a face of mesh a and a face of mesh b; for each pose sorted, without duplicates.
    shape : tuple of int
        The leading axes of the poses; their product is ``n``.

    Examples
    --------
    >>> import numpy as np, impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> poses = impinge.pose([[0, 0, 0], [0, 0, 1], [1, 0, 0]])
    >>> pairs = impinge.intersecting_pairs(triangle, triangle, poses)
    >>> pairs
    Pairs(shape=(3,), 2 pairs)
    >>> pairs.counts
    array([1, 0, 1])
    >>> pairs[2]
    array([[0, 0]], dtype=uint32)
    """

    offsets: NDArray[np.int64]
    rows: NDArray[np.uint32]
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> NDArray[np.uint32]:
        return self.rows[entries]

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> Pairs:
        return Pairs(offsets, self.rows[entries], shape)

    def __repr__(self) -> str:
        """Return the shape and the number of pairs."""
        return f"Pairs(shape={self.shape}, {len(self.rows)} pairs)"
