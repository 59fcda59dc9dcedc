"""What all partitions answer, and what is done to those whose boxes move."""

from __future__ import annotations

from typing import Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._arrays import plain_numbers
from impinge._errors import InputError
from impinge._partition_answers import BoxHit, BoxHits, Changes, Keys, Nearest
from impinge._points import scalar
from impinge._scalars import real, whole

MOST_KEYS = 2**32 - 1
"""Keys are below this."""

NO_BOXES = np.zeros((0, 3))


class Options(NamedTuple):
    """What a partition is, its boxes aside."""

    kind: str
    size: tuple[float, str] = (0.0, "low")
    """The edge of a cell or the margin of a leaf, and what the argument is called."""
    space: NDArray[np.float64] | None = None
    """(2, 3) corners of what cells are laid over."""


class Partition:
    """Boxes under keys, and where they are; `impinge.partition` has the kinds.

    Every kind gives the same answers. They are exact, touching counts, and a point is a box without an extent.
    """

    __slots__ = ("_core", "_options")
    _core: _impinge.PartitionCore
    _options: Options

    def _make(self, options: Options, low: ArrayLike, high: ArrayLike | None, reach: int = 0) -> None:
        """Hold these boxes; keys below `reach` were used before."""
        self._options = options
        self._core = _impinge.PartitionCore(options.kind, low, high, options.size, options.space, reach)

    def __len__(self) -> int:
        """Return how many boxes there are."""
        return self._core.len()

    def __repr__(self) -> str:
        """Return the kind and the number of boxes."""
        return f"<impinge.partition.{type(self).__name__}: {len(self)} boxes>"

    def __copy__(self) -> Self:
        """Return a partition of its own with the same boxes; cheap until one of the two changes."""
        copied = object.__new__(type(self))
        copied._core, copied._options = self._core.copy(), self._options
        return copied

    def __deepcopy__(self, memo: object) -> Self:
        """Return what `copy.copy` does, which shares nothing that changes."""
        return self.__copy__()

    def __reduce__(self) -> tuple[object, ...]:
        """Return how to put the boxes together again."""
        keys = self.keys
        return _again, (type(self), self._options, self._core.reach(), keys, self.boxes(keys))

    @property
    def keys(self) -> NDArray[np.uint32]:
        """The keys of all boxes, ascending."""
        return self._core.keys()

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """Corners, (2, 3), of a box about all, which may be too large after some went; none where there are none."""
        return self._core.bounds()

    @property
    def cells(self) -> Literal["disjoint", "loose", "volumes", "order"]:
        """What the kind does to space.

        Cells that share no inner point (``"disjoint"``), cells that are enlarged until each box fits into one
        (``"loose"``), volumes about boxes, which may overlap (``"volumes"``), or no cells but the order of the boxes
        along axes (``"order"``).
        """
        return self._core.cells()

    def boxes(self, keys: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return the boxes of keys.

        Parameters
        ----------
        keys : (n,) array_like of integers, optional
            All, by ascending keys, where they are not given.

        Returns
        -------
        (n, 2, 3) float64 array
            Lower and upper corners.

        Raises
        ------
        InputError
            If there is no box of a key; it says which.
        """
        return self._core.boxes(self.keys if keys is None else _keys(keys, "keys"))

    def overlapping(self, low: ArrayLike, high: ArrayLike | None = None) -> NDArray[np.uint32] | Keys:
        """Return the boxes that meet given ones.

        Parameters
        ----------
        low, high : (..., 3) array_like of float32 or float64
            Lower and upper corners, below 2^320 in magnitude; leading axes broadcast as in NumPy. Points where `high`
            is not given.

        Returns
        -------
        (k,) uint32 array or Keys
            Keys, ascending; `Keys` where there are leading axes.

        Raises
        ------
        InputError
            If a number is not in range, or an upper corner is below a lower one; it says which.

        Examples
        --------
        >>> import impinge
        >>> tree = impinge.partition.BoxTree([[0, 0, 0], [2, 0, 0]], [[1, 1, 1], [3, 1, 1]])
        >>> tree.overlapping([1, 0, 0], [2, 1, 1])
        array([0, 1], dtype=uint32)
        >>> tree.overlapping([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5]]).counts
        array([1, 0])
        """
        offsets, keys, shape = _impinge.partition_overlapping(self._core, low, high)
        return Keys(offsets, keys, tuple(shape)) if shape else keys

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike, *, reach: float = np.inf) -> BoxHit:
        """Return the first box that each ray enters; of several at one place the one with the least key.

        A ray that passes a box by 2^-50 of the way may count as entering it; none that enters one is missed.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            Below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            Of a length from 2^-600 to 2^300. The leading axes of both broadcast as in NumPy.
        reach : float
            How far, in units of the directions' lengths.

        Returns
        -------
        BoxHit
            Its fields have the leading axes.

        Raises
        ------
        InputError
            If a number is not in range or a direction is zero; it says which.

        Examples
        --------
        >>> import impinge
        >>> tree = impinge.partition.BoxTree([[0, 0, 0], [2, 0, 0]], [[1, 1, 1], [3, 1, 1]])
        >>> hit = tree.ray_cast([5, 0.5, 0.5], [-1, 0, 0])
        >>> hit.key, round(hit.t, 9)
        (1, 2.0)
        """
        t, key = _impinge.partition_ray_cast(self._core, origins, directions, real(reach, "reach", least=0))
        return BoxHit(scalar(t), scalar(key))

    def ray_cast_all(self, origins: ArrayLike, directions: ArrayLike, *, reach: float = np.inf) -> BoxHit | BoxHits:
        """Return every box that each ray enters, by where it does and then by key.

        Parameters
        ----------
        origins, directions, reach
            As for `ray_cast`.

        Returns
        -------
        BoxHit or BoxHits
            For a single ray a `BoxHit` with as many entries as there are boxes.

        Raises
        ------
        InputError
            As for `ray_cast`.
        """
        offsets, t, key, shape = _impinge.partition_ray_cast_all(
            self._core, origins, directions, real(reach, "reach", least=0)
        )
        return BoxHits(offsets, t, key, tuple(shape)) if shape else BoxHit(t, key)

    def nearest(self, points: ArrayLike, count: int = 1) -> Nearest:
        """Return the boxes that are nearest to points.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            Below 2^320 in magnitude.
        count : int
            How many for each.

        Returns
        -------
        Nearest
            Its fields have the leading axes and one of length `count`.

        Raises
        ------
        InputError
            If a number is not in range, or `count` no whole number.

        Examples
        --------
        >>> import impinge
        >>> tree = impinge.partition.KdTree([[0, 0, 0], [4, 0, 0], [9, 0, 0]])
        >>> near = tree.nearest([5, 0, 0], 2)
        >>> near.key, near.distance
        (array([1, 2]), array([1., 4.]))
        """
        return Nearest(*_impinge.partition_nearest(self._core, points, whole(count, "count")))

    def pairs(self) -> NDArray[np.uint32]:
        """Return all pairs of boxes that meet, (k, 2), sorted, the lesser key first."""
        return _impinge.partition_pairs(self._core)

    def pairs_with(self, other: Partition) -> NDArray[np.uint32]:
        """Return all pairs of a box of this partition and one of the other that meet, (k, 2), in this order, sorted.

        Raises
        ------
        InputError
            If `other` is no partition.
        """
        if not isinstance(other, Partition):
            raise InputError(f"must be a partition, not {type(other).__name__}", kind="type", what="other")
        return _impinge.partition_pairs_with(self._core, other._core)


class DynamicPartition(Partition):
    """A partition whose boxes come, go and move."""

    __slots__ = ()

    def step(
        self, keys: ArrayLike, low: ArrayLike, high: ArrayLike | None = None, *, removed: ArrayLike = ()
    ) -> Changes:
        """Put boxes where they are now, take others away, and return which pairs that changed.

        Parameters
        ----------
        keys : (n,) array_like of integers
            Of the boxes that move, or come where there is none of that key; of several of one key the last holds.
            Memory grows with the greatest key, so that they are to be dense: a key from 2^20 on that is 16 times the
            number of boxes is refused.
        low, high : (n, 3) array_like of float32 or float64
            Their places, as for `overlapping`.
        removed : (m,) array_like of integers
            Keys of boxes that go, which were there before.

        Returns
        -------
        Changes
            The pairs that began and that ended.

        Raises
        ------
        InputError
            If an argument is none of the above; nothing was moved then.

        Examples
        --------
        >>> import impinge
        >>> grid = impinge.partition.HashedGrid(2, [[0, 0, 0], [9, 0, 0]], [[1, 1, 1], [10, 1, 1]])
        >>> grid.step([1, 2], [[1, 0, 0], [5, 5, 5]], [[2, 1, 1], [6, 6, 6]]).began
        array([[0, 1]], dtype=uint32)
        >>> grid.step([], [], removed=[0]).ended
        array([[0, 1]], dtype=uint32)
        """
        is_empty = low.size == 0 if isinstance(low, np.ndarray) else isinstance(low, list | tuple) and not low
        places = NO_BOXES if is_empty else low
        return Changes(*self._core.step(_keys(keys, "keys"), places, high, _keys(removed, "removed")))


def _again(
    kind: type[Partition], options: Options, reach: int, keys: NDArray[np.uint32], boxes: NDArray[np.float64]
) -> Partition:
    """Return a partition of these boxes; what cannot move has the keys 0, 1, 2, ..."""
    again, (low, high) = object.__new__(kind), (boxes[:, 0], boxes[:, 1])
    if isinstance(again, DynamicPartition):
        again._make(options, NO_BOXES, None, reach)
        again.step(keys, low, high)
    else:
        again._make(options, low, high)
    return again


def _keys(keys: ArrayLike, name: str) -> NDArray[np.uint32]:
    return plain_numbers(keys, name, MOST_KEYS - 1).reshape(-1).astype(np.uint32)
