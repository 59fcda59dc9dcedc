"""Base classes of all partitions: the queries, and the updates of partitions with moving boxes."""

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

KEY_LIMIT = 2**32 - 1
"""Exclusive upper bound of keys."""

NO_BOXES = np.zeros((0, 3))


class Options(NamedTuple):
    """Options of a partition, without its boxes."""

    kind: str
    size: tuple[float, str] = (0.0, "low")
    """Edge of a cell or margin of a leaf, and the name of that argument."""
    space: NDArray[np.float64] | None = None
    """Corners (2, 3) of the region that cells cover."""


class Partition:
    """Base class of all partitions: axis-aligned boxes in one frame, each with an integer key.

    `impinge.partition` lists the kinds, which all return the same answers. Overlaps are exact,
    touching counts, and a point is a box without extent.
    """

    __slots__ = ("_core", "_options")
    _core: _impinge.PartitionCore
    _options: Options

    def _make(self, options: Options, low: ArrayLike, high: ArrayLike | None, reach: int = 0) -> None:
        """Insert the boxes; keys below `reach` were used before."""
        self._options = options
        self._core = _impinge.PartitionCore(options.kind, low, high, options.size, options.space, reach)

    def __len__(self) -> int:
        """Return the number of boxes."""
        return self._core.len()

    def __repr__(self) -> str:
        """Return the kind and the number of boxes."""
        return f"<impinge.partition.{type(self).__name__}: {len(self)} boxes>"

    def __copy__(self) -> Self:
        """Return an independent partition; data is shared until one of the two changes."""
        copied = object.__new__(type(self))
        copied._core, copied._options = self._core.copy(), self._options
        return copied

    def __deepcopy__(self, memo: object) -> Self:
        """Return the same as `copy.copy`, which shares nothing mutable."""
        return self.__copy__()

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the kind, the options, the keys and the boxes."""
        keys = self.keys
        return _restored, (type(self), self._options, self._core.reach(), keys, self.boxes(keys))

    @property
    def keys(self) -> NDArray[np.uint32]:
        """Keys of all boxes, ascending."""
        return self._core.keys()

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """Lower and upper corners (2, 3) of a box around all boxes; None if there are no boxes.

        They are in the frame of the boxes. The box may be too large after boxes were removed.
        """
        return self._core.bounds()

    @property
    def cells(self) -> Literal["disjoint", "loose", "volumes", "order"]:
        """How the partition subdivides space.

        ``"disjoint"``: no two cells of one level share an inner point. ``"loose"``: cells are
        enlarged until each box fits into one. ``"volumes"``: the cells are volumes around boxes,
        and may overlap. ``"order"``: there are no cells; boxes are only sorted along axes.
        """
        return self._core.cells()

    def boxes(self, keys: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return the boxes with given keys.

        Parameters
        ----------
        keys : (n,) array_like of integers, optional
            The keys. Without them, all boxes are returned, by ascending keys.

        Returns
        -------
        (n, 2, 3) float64 array
            Lower and upper corners of the boxes, exactly as they were inserted or last moved.

        Raises
        ------
        InputError
            If there is no box with a key; the error names the entry.
        """
        return self._core.boxes(self.keys if keys is None else _keys(keys, "keys"))

    def overlapping(self, low: ArrayLike, high: ArrayLike | None = None) -> NDArray[np.uint32] | Keys:
        """Return the keys of the boxes that overlap given boxes or points; touching counts.

        Parameters
        ----------
        low, high : (..., 3) array_like of float32 or float64
            Lower and upper corners in the frame of the boxes, below 2^320 in magnitude; leading
            axes broadcast as in NumPy. Without `high`, the queries are points.

        Returns
        -------
        (k,) uint32 array or Keys
            Keys, ascending; `Keys` if there are leading axes.

        Raises
        ------
        InputError
            If a number is out of range, or if an upper corner is below a lower one; the error names
            the entry.

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
        """Return the first box that each ray enters; at equal `t`, the one with the smallest key.

        No box that a ray enters is missed. A ray that misses a box by a relative distance of 2^-50
        may count as entering it.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            In the frame of the boxes, below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            In the frame of the boxes, with a length from 2^-600 to 2^300. The leading axes of both
            broadcast as in NumPy.
        reach : float
            Maximum ray parameter, in units of the directions' lengths; at least zero.

        Returns
        -------
        BoxHit
            The fields have the leading axes.

        Raises
        ------
        InputError
            If a number is out of range or a direction is zero; the error names the entry.

        Examples
        --------
        >>> import impinge
        >>> tree = impinge.partition.BoxTree([[0, 0, 0], [2, 0, 0]], [[1, 1, 1], [3, 1, 1]])
        >>> hit = tree.ray_cast([5, 0.5, 0.5], [-1, 0, 0])
        >>> hit.key, round(hit.t, 9)
        (1, 2.0)
        """
        t, key = _impinge.partition_ray_cast(self._core, origins, directions, real(reach, "reach", minimum=0))
        return BoxHit(scalar(t), scalar(key))

    def ray_cast_all(self, origins: ArrayLike, directions: ArrayLike, *, reach: float = np.inf) -> BoxHit | BoxHits:
        """Return every box that each ray enters, in order along the ray and then by key.

        Parameters
        ----------
        origins, directions, reach
            As for `ray_cast`.

        Returns
        -------
        BoxHit or BoxHits
            For a single ray a `BoxHit` with one entry for each box; `BoxHits` if there are leading
            axes.

        Raises
        ------
        InputError
            As for `ray_cast`.
        """
        offsets, t, key, shape = _impinge.partition_ray_cast_all(
            self._core, origins, directions, real(reach, "reach", minimum=0)
        )
        return BoxHits(offsets, t, key, tuple(shape)) if shape else BoxHit(t, key)

    def nearest(self, points: ArrayLike, count: int = 1) -> Nearest:
        """Return the `count` boxes that are nearest to each point.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the frame of the boxes, below 2^320 in magnitude.
        count : int
            Number of boxes for each point, at least zero.

        Returns
        -------
        Nearest
            The fields have the leading axes and one axis of length `count`.

        Raises
        ------
        InputError
            If a number is out of range, or if `count` is not an integer of at least zero.

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
        """Return the keys of all pairs of overlapping boxes, (k, 2), sorted; touching counts.

        The smaller key of a pair is first.
        """
        return _impinge.partition_pairs(self._core)

    def pairs_with(self, other: Partition) -> NDArray[np.uint32]:
        """Return all overlapping pairs of a box of this partition and a box of another partition.

        The result holds keys, (k, 2), with the key in this partition first, and is sorted. Both
        partitions must be in the same frame. Touching counts.

        Raises
        ------
        InputError
            If `other` is not a partition.
        """
        if not isinstance(other, Partition):
            raise InputError(f"must be a partition, not {type(other).__name__}", kind="type", what="other")
        return _impinge.partition_pairs_with(self._core, other._core)


class DynamicPartition(Partition):
    """A partition whose boxes can be inserted, moved and removed."""

    __slots__ = ()

    def step(
        self, keys: ArrayLike, low: ArrayLike, high: ArrayLike | None = None, *, removed: ArrayLike = ()
    ) -> Changes:
        """Insert, move and remove boxes, and return the pairs that changed.

        Parameters
        ----------
        keys : (n,) array_like of integers
            Keys of the boxes to move, or to insert if there is no box with the key. If a key occurs
            several times, its last box is used. Memory grows with the largest key, so use dense
            keys: a key of at least 2^20 is rejected if it is 16 times the number of boxes.
        low, high : (n, 3) array_like of float32 or float64
            New lower and upper corners, in the frame of the boxes, below 2^320 in magnitude.
            Without `high`, boxes are points.
        removed : (m,) array_like of integers
            Keys of existing boxes to remove.

        Returns
        -------
        Changes
            The pairs that began to overlap, and those that no longer do.

        Raises
        ------
        InputError
            If an argument is invalid. Nothing is changed then.

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


def _restored(
    kind: type[Partition], options: Options, reach: int, keys: NDArray[np.uint32], boxes: NDArray[np.float64]
) -> Partition:
    """Return a partition of the given boxes; kinds that cannot move use the keys 0, 1, 2, ..."""
    again, (low, high) = object.__new__(kind), (boxes[:, 0], boxes[:, 1])
    if isinstance(again, DynamicPartition):
        again._make(options, NO_BOXES, None, reach)
        again.step(keys, low, high)
    else:
        again._make(options, low, high)
    return again


def _keys(keys: ArrayLike, name: str) -> NDArray[np.uint32]:
    return plain_numbers(keys, name, KEY_LIMIT - 1).reshape(-1).astype(np.uint32)
