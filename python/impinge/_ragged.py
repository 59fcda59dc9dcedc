"""Results of different lengths for many rows, concatenated."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Generic, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

Row = TypeVar("Row")
"""The result for one row."""


class Ragged(ABC, Generic[Row]):
    """Results of different lengths for many rows, as a sequence over the first leading axis.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each row's entries: the entries of row ``i``, in row-major order of the leading
        axes, go from ``offsets[i]`` to ``offsets[i + 1]``.
    shape : tuple of int
        The leading axes; their product is ``n``.
    """

    offsets: NDArray[np.int64]
    shape: tuple[int, ...]

    @abstractmethod
    def _row(self, entries: slice) -> Row:
        """Return views of the given entries, which belong to one row."""

    @abstractmethod
    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> Self:
        """Return views of the entries of several rows, with the rows' own offsets and axes."""

    def __len__(self) -> int:
        """Return the length of the first leading axis."""
        return self.shape[0]

    def __getitem__(self, index: int | tuple[int, ...]) -> Row | Self:
        """Return the entries of one row as views, or of several rows if `index` has fewer items."""
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
        entries = slice(offsets[0], offsets[-1])
        return self._rows(entries, offsets - offsets[0], rest) if rest else self._row(entries)

    def __iter__(self) -> Iterator[Row | Self]:
        """Iterate over the first leading axis."""
        return (self[i] for i in range(len(self)))

    @property
    def counts(self) -> NDArray[np.int64]:
        """Number of entries of each row, an array of shape `shape`."""
        return np.diff(self.offsets).reshape(self.shape)

    def split(self) -> list[Row | Self]:
        """Return the entries of each index of the first leading axis, as a list of views."""
        return [self[i] for i in range(len(self))]
