"""Space partitioning: which of many boxes are where.

A partition holds axis-aligned boxes under keys: those that it is made of have the keys 0, 1, 2, ... All kinds answer
the same questions with the same answers, and differ in what they cost and in what they do to space (`Partition.cells`):

=====================  ======================================================  ============  ===========================
kind                   space                                                   boxes move    made for
=====================  ======================================================  ============  ===========================
`BoxTree`              volumes that may overlap                                yes           anything
`UniformGrid`          disjoint cells in a block                               yes           like sizes, known space
`HashedGrid`           disjoint cells without an end                           yes           like sizes anywhere
`HierarchicalGrid`     disjoint cells of many sizes                            yes           unlike sizes, few that move
`Octree`               disjoint cubes in cubes                                 yes           dense here and empty there
`LooseOctree`          loose cubes in cubes                                    yes           the same, unlike sizes
`KdTree`               disjoint cells                                          no            points, and what is nearest
`BspTree`              disjoint cells by the boxes' own planes                 no            rooms, walls
`SweepOneAxis`         an order along an axis                                  yes           few boxes, long scenes
`SweepThreeAxes`       an order along each axis                                yes           boxes that move little
=====================  ======================================================  ============  ===========================

Where all that is wanted is which boxes meet, `pairs` finds it from nothing, quickest of all where most boxes moved. A
`World` chooses among these by itself; ``docs/partition.md`` says what each costs.

Corners are (n, 3) array_like of float32 or float64, below 2^320 in magnitude; where `high` is not given, boxes are
points. Calls that ask many questions use all cores, with Python's lock released. A call that asks finishes on the boxes
that were there when it began.

Examples
--------
>>> import impinge, numpy as np
>>> low = np.array([[0, 0, 0], [1, 0, 0], [5, 5, 5]], float)
>>> impinge.partition.pairs(low, low + 1)
array([[0, 1]], dtype=uint32)
>>> octree = impinge.partition.LooseOctree([[0, 0, 0], [8, 8, 8]], low, low + 1)
>>> octree.step([2], [[0.5, 0.5, 0.5]], [[1.5, 1.5, 1.5]])
Changes(2 began, 0 ended)
>>> octree.pairs().tolist()
[[0, 1], [0, 2], [1, 2]]
"""

from __future__ import annotations

from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._arrays import plain_points
from impinge._errors import InputError
from impinge._partition import NO_BOXES, DynamicPartition, Options, Partition
from impinge._partition_answers import BoxHit, BoxHits, Changes, Keys, Nearest
from impinge._scalars import chosen, real

__all__ = [
    "BoxHit",
    "BoxHits",
    "BoxTree",
    "BspTree",
    "Changes",
    "DynamicPartition",
    "HashedGrid",
    "HierarchicalGrid",
    "KdTree",
    "Keys",
    "LooseOctree",
    "Nearest",
    "Octree",
    "Partition",
    "SweepOneAxis",
    "SweepThreeAxes",
    "UniformGrid",
    "pairs",
]


def pairs(low: ArrayLike, high: ArrayLike | None = None) -> NDArray[np.uint32]:
    """Return all pairs of boxes that meet, by a sweep of columns from nothing (Tracy, Buss, Woods 2009).

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64
        Corners; points where `high` is not given.

    Returns
    -------
    (k, 2) uint32 array
        Rows of boxes, sorted, the lesser first. Exact; touching counts.

    Raises
    ------
    InputError
        If a number is not in range, or an upper corner is below a lower one; it says which.
    """
    return _impinge.box_pairs(low, high)


@final
class BoxTree(DynamicPartition):
    """A tree of boxes about boxes: the kind with the fewest surprises.

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64, optional
        Corners.
    margin : float
        By how much leaves are larger than their boxes on every side, so that a box that moves less stays in its leaf.

    Raises
    ------
    InputError
        If an argument is none of these.
    """

    __slots__ = ()

    def __init__(self, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None, *, margin: float = 0.0) -> None:
        self._make(Options("box_tree", (real(margin, "margin", least=0), "margin")), low, high)


@final
class UniformGrid(DynamicPartition):
    """Cells of one size in a block; boxes outside of it are in the cells at its border.

    Parameters
    ----------
    space : (2, 3) array_like of float32 or float64
        The corners of the block.
    cell : float
        The edge of a cell; about twice the boxes' are a good choice. There may be 2^24 cells.
    low, high : (n, 3) array_like of float32 or float64, optional
        Corners.

    Raises
    ------
    InputError
        If an argument is none of these.
    """

    __slots__ = ()

    def __init__(self, space: ArrayLike, cell: float, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("uniform_grid", (real(cell, "cell"), "cell"), _corners(space)), low, high)


@final
class HashedGrid(DynamicPartition):
    """Cells of one size without an end, found by hashing.

    Parameters
    ----------
    cell : float
        The edge of a cell; about twice the boxes' are a good choice.
    low, high : (n, 3) array_like of float32 or float64, optional
        Corners.

    Raises
    ------
    InputError
        If an argument is none of these.
    """

    __slots__ = ()

    def __init__(self, cell: float, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("hashed_grid", (real(cell, "cell"), "cell")), low, high)


@final
class HierarchicalGrid(DynamicPartition):
    """Hashed cells of many sizes, each box in a cell of its size: quick where sizes differ and few boxes move.

    Parameters
    ----------
    cell : float
        The edge of the least cells: a little more than most boxes have, or than the smallest of which there are many.
    low, high : (n, 3) array_like of float32 or float64, optional
        Corners.

    Raises
    ------
    InputError
        If an argument is none of these.
    """

    __slots__ = ()

    def __init__(self, cell: float, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("hierarchical_grid", (real(cell, "cell"), "cell")), low, high)


@final
class Octree(DynamicPartition):
    """Cubes in cubes that share no inner point, each box in the smallest that holds it.

    A box across the middle of a cube stays in it however small it is; `LooseOctree` is the cure.

    Parameters
    ----------
    space : (2, 3) array_like of float32 or float64
        Corners of what the root is laid over; boxes outside are in the root.
    low, high : (n, 3) array_like of float32 or float64, optional
        Corners.

    Raises
    ------
    InputError
        If an argument is none of these.
    """

    __slots__ = ()

    def __init__(self, space: ArrayLike, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("octree", space=_corners(space)), low, high)


@final
class LooseOctree(DynamicPartition):
    """Cubes in cubes that are twice as wide as their places, so that a box is as deep as it is small (Ulrich 2000).

    Parameters
    ----------
    space : (2, 3) array_like of float32 or float64
        Corners of what the root is laid over; boxes outside are in the root.
    low, high : (n, 3) array_like of float32 or float64, optional
        Corners.

    Raises
    ------
    InputError
        If an argument is none of these.
    """

    __slots__ = ()

    def __init__(self, space: ArrayLike, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("loose_octree", space=_corners(space)), low, high)


@final
class SweepOneAxis(DynamicPartition):
    """Boxes in the order of their ends along one axis, kept from step to step.

    Parameters
    ----------
    axis : {"x", "y", "z"}
        Along which they lie apart most.
    low, high : (n, 3) array_like of float32 or float64, optional
        Corners.

    Raises
    ------
    InputError
        If an argument is none of these.
    """

    __slots__ = ()

    def __init__(self, axis: Literal["x", "y", "z"], low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options(f"sweep_{chosen(axis, ('x', 'y', 'z'), 'axis')}"), low, high)


@final
class SweepThreeAxes(DynamicPartition):
    """Boxes in the order of their ends along all axes, and the pairs that meet, kept from step to step.

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64, optional
        Corners.

    Raises
    ------
    InputError
        If a number is not in range, or an upper corner is below a lower one.
    """

    __slots__ = ()

    def __init__(self, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("three_axes"), low, high)


@final
class KdTree(Partition):
    """Planes across the axes, each box in every cell that it reaches into: for points, and what is nearest to them.

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64
        Corners; points where `high` is not given.

    Raises
    ------
    InputError
        If a number is not in range, or an upper corner is below a lower one.
    """

    __slots__ = ()

    def __init__(self, low: ArrayLike, high: ArrayLike | None = None) -> None:
        self._make(Options("kd_tree"), low, high)


@final
class BspTree(Partition):
    """Planes of the boxes' own faces, which pass between them where they can: for rooms and walls.

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64
        Corners; points where `high` is not given.

    Raises
    ------
    InputError
        If a number is not in range, or an upper corner is below a lower one.
    """

    __slots__ = ()

    def __init__(self, low: ArrayLike, high: ArrayLike | None = None) -> None:
        self._make(Options("bsp_tree"), low, high)


def _corners(space: ArrayLike) -> NDArray[np.float64]:
    corners = plain_points(space, "space")
    if corners.shape != (2, 3):
        message = f"shape {corners.shape}, where (2, 3) is expected: a lower and an upper corner"
        raise InputError(message, kind="shape", what="space")
    return corners.copy()
