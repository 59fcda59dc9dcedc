"""The pairs of faces of many poses in two arrays."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Pairs:
    """Pairs of faces for each of many poses: rows of uneven number, one after another.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        The pairs of pose ``i``, in row-major order of the leading axes, are ``rows[offsets[i]:offsets[i + 1]]``.
    rows : (k, 2) uint32 array
        (Face of a, face of b); for each pose sorted and without duplicates.
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

    def __len__(self) -> int:
        """Return the length of the first leading axis."""
        return self.shape[0]

    def __getitem__(self, index: int | tuple[int, ...]) -> NDArray[np.uint32] | Pairs:
        """Return the (k, 2) pairs of one pose; the `Pairs` of the axes that are left where `index` is shorter."""
        place = index if isinstance(index, tuple) else (index,)
        if len(place) > len(self.shape):
            raise IndexError(f"{len(place)} indices for {len(self.shape)} leading axes")
        first = 0
        for at, extent in zip(place, self.shape, strict=False):
            if not -extent <= at < extent:
                raise IndexError(f"index {at} is out of bounds for an axis of length {extent}")
            first = first * extent + at % extent
        rest = self.shape[len(place) :]
        count = int(np.prod(rest, dtype=np.int64))
        offsets = self.offsets[first * count : (first + 1) * count + 1]
        rows = self.rows[offsets[0] : offsets[-1]]
        return Pairs(offsets - offsets[0], rows, rest) if rest else rows

    def __iter__(self) -> Iterator[NDArray[np.uint32] | Pairs]:
        """Iterate over the first leading axis."""
        return (self[i] for i in range(len(self)))

    @property
    def counts(self) -> NDArray[np.int64]:
        """How many pairs each pose has; an array of the shape `shape`."""
        return np.diff(self.offsets).reshape(self.shape)

    def split(self) -> list[NDArray[np.uint32] | Pairs]:
        """Return what each entry of the first leading axis has, as a list of views."""
        return list(self)

    def __repr__(self) -> str:
        """Return the shape and the number of pairs."""
        return f"Pairs(shape={self.shape}, {len(self.rows)} pairs)"
