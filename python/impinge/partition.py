"""Space partitioning: data structures that find boxes by position.

A partition stores axis-aligned boxes of one frame under keys. The boxes of the constructor have the
keys 0, 1, 2, ... All kinds return the same answers. They differ in speed, and in how they subdivide
space (`Partition.cells`):

====================  ==================================  ==========  ==============================
kind                  space                               boxes move  suited to
====================  ==================================  ==========  ==============================
`BoxTree`             volumes that may overlap            yes         any input
`UniformGrid`         disjoint cells in a block           yes         similar sizes, bounded space
`HashedGrid`          disjoint cells, unbounded           yes         similar sizes, unbounded space
`HierarchicalGrid`    disjoint cells of many sizes        yes         mixed sizes, few boxes move
`Octree`              disjoint nested cubes               yes         uneven density
`LooseOctree`         loose nested cubes                  yes         uneven density, mixed sizes
`KdTree`              disjoint cells                      no          points, nearest queries
`BspTree`             disjoint cells, planes of boxes     no          rooms, walls
`SweepOneAxis`        order along one axis                yes         few boxes, long scenes
`SweepThreeAxes`      order along each axis               yes         boxes that move little
====================  ==================================  ==========  ==============================

If you only need the overlapping pairs, `pairs` computes them without a stored structure; it is the
fastest way if most boxes moved. A `World` chooses among these kinds automatically.
``docs/tasks/partitions.md`` compares their speed.

Lower and upper corners, `low` and `high`, are (n, 3) array_like of float32 or float64, below 2^320
in magnitude. Without `high`, boxes are points. Calls with many queries use all cores, with the
interpreter's lock released. A query uses the boxes that were there when it began.

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
    """Return all pairs of overlapping boxes, by a sweep of columns without a stored structure.

    The method is that of Tracy, Buss and Woods (2009).

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64
        Lower and upper corners of the boxes, in one frame. Without `high`, boxes are points.

    Returns
    -------
    (k, 2) uint32 array
        Row indices of the two boxes of each pair, the smaller first; sorted by the first, then by
        the second. Exact; touching counts.

    Raises
    ------
    InputError
        If a number is out of range, or if an upper corner is below a lower one; the error names the
        entry.
    """
    return _impinge.box_pairs(low, high)


@final
class BoxTree(DynamicPartition):
    """A bounding volume hierarchy of boxes: a good choice for most inputs.

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64, optional
        Lower and upper corners of the boxes to insert first, in one frame. Without `high`, boxes
        are points.
    margin : float
        Distance by which a leaf extends beyond its box on every side, in the unit of the boxes, at
        least zero. A box that moves less than this stays in its leaf.

    Raises
    ------
    InputError
        If an argument is invalid.
    """

    __slots__ = ()

    def __init__(self, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None, *, margin: float = 0.0) -> None:
        self._make(Options("box_tree", (real(margin, "margin", minimum=0), "margin")), low, high)


@final
class UniformGrid(DynamicPartition):
    """A grid of equal cubes in a block. Boxes outside of the block are in the cells at its border.

    Parameters
    ----------
    space : (2, 3) array_like of float32 or float64
        Lower and upper corner of the block, in the frame of the boxes.
    cell : float
        Edge length of a cell in the unit of the boxes, above zero; about twice that of a box is a
        good choice. The grid may have at most 2^24 cells.
    low, high : (n, 3) array_like of float32 or float64, optional
        Lower and upper corners of the boxes to insert first, in one frame. Without `high`, boxes
        are points.

    Raises
    ------
    InputError
        If an argument is invalid.
    """

    __slots__ = ()

    def __init__(self, space: ArrayLike, cell: float, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("uniform_grid", (real(cell, "cell"), "cell"), _corners(space)), low, high)


@final
class HashedGrid(DynamicPartition):
    """A grid of equal cubes in unbounded space, found by hashing.

    Parameters
    ----------
    cell : float
        Edge length of a cell in the unit of the boxes, above zero; about twice that of a box is a
        good choice.
    low, high : (n, 3) array_like of float32 or float64, optional
        Lower and upper corners of the boxes to insert first, in one frame. Without `high`, boxes
        are points.

    Raises
    ------
    InputError
        If an argument is invalid.
    """

    __slots__ = ()

    def __init__(self, cell: float, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("hashed_grid", (real(cell, "cell"), "cell")), low, high)


@final
class HierarchicalGrid(DynamicPartition):
    """Hashed grids of cubes of many sizes; each box is in cells of about its size.

    It is fast if sizes vary and few boxes move.

    Parameters
    ----------
    cell : float
        Edge length of the smallest cells, in the unit of the boxes, above zero. It should be
        slightly larger than most boxes, or than the smallest common size.
    low, high : (n, 3) array_like of float32 or float64, optional
        Lower and upper corners of the boxes to insert first, in one frame. Without `high`, boxes
        are points.

    Raises
    ------
    InputError
        If an argument is invalid.
    """

    __slots__ = ()

    def __init__(self, cell: float, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("hierarchical_grid", (real(cell, "cell"), "cell")), low, high)


@final
class Octree(DynamicPartition):
    """An octree: each box is in the smallest cube that contains it.

    Cubes of one level share no inner point. A box across the middle of a cube stays in that cube,
    however small it is; `LooseOctree` avoids this.

    Parameters
    ----------
    space : (2, 3) array_like of float32 or float64
        Lower and upper corner of the region that the root covers, in the frame of the boxes. Boxes
        outside are in the root.
    low, high : (n, 3) array_like of float32 or float64, optional
        Lower and upper corners of the boxes to insert first, in one frame. Without `high`, boxes
        are points.

    Raises
    ------
    InputError
        If an argument is invalid.
    """

    __slots__ = ()

    def __init__(self, space: ArrayLike, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("octree", space=_corners(space)), low, high)


@final
class LooseOctree(DynamicPartition):
    """A loose octree, whose cubes are enlarged to twice their width.

    So every box fits into a cube of about its size, wherever it is. The method is that of Ulrich
    (2000).

    Parameters
    ----------
    space : (2, 3) array_like of float32 or float64
        Lower and upper corner of the region that the root covers, in the frame of the boxes. Boxes
        outside are in the root.
    low, high : (n, 3) array_like of float32 or float64, optional
        Lower and upper corners of the boxes to insert first, in one frame. Without `high`, boxes
        are points.

    Raises
    ------
    InputError
        If an argument is invalid.
    """

    __slots__ = ()

    def __init__(self, space: ArrayLike, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("loose_octree", space=_corners(space)), low, high)


@final
class SweepOneAxis(DynamicPartition):
    """Boxes sorted by their ends along one axis; the order is kept from step to step.

    Parameters
    ----------
    axis : {"x", "y", "z"}
        The axis to sort along. The best choice is the axis along which the boxes are farthest
        apart.
    low, high : (n, 3) array_like of float32 or float64, optional
        Lower and upper corners of the boxes to insert first, in one frame. Without `high`, boxes
        are points.

    Raises
    ------
    InputError
        If an argument is invalid.
    """

    __slots__ = ()

    def __init__(self, axis: Literal["x", "y", "z"], low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options(f"sweep_{chosen(axis, ('x', 'y', 'z'), 'axis')}"), low, high)


@final
class SweepThreeAxes(DynamicPartition):
    """Boxes sorted by their ends along all axes; order and pairs are kept from step to step.

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64, optional
        Lower and upper corners of the boxes to insert first, in one frame. Without `high`, boxes
        are points.

    Raises
    ------
    InputError
        If a number is out of range, or if an upper corner is below a lower one.
    """

    __slots__ = ()

    def __init__(self, low: ArrayLike = NO_BOXES, high: ArrayLike | None = None) -> None:
        self._make(Options("three_axes"), low, high)


@final
class KdTree(Partition):
    """A k-d tree, whose cells are split by axis-aligned planes.

    It suits points, and queries of nearest boxes. Each box is in every cell that it overlaps.

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64
        Lower and upper corners of the boxes, in one frame. Without `high`, boxes are points.

    Raises
    ------
    InputError
        If a number is out of range, or if an upper corner is below a lower one.
    """

    __slots__ = ()

    def __init__(self, low: ArrayLike, high: ArrayLike | None = None) -> None:
        self._make(Options("kd_tree"), low, high)


@final
class BspTree(Partition):
    """A BSP tree, whose cells are split by planes of the faces of boxes, between boxes if possible.

    It suits rooms and walls.

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64
        Lower and upper corners of the boxes, in one frame. Without `high`, boxes are points.

    Raises
    ------
    InputError
        If a number is out of range, or if an upper corner is below a lower one.
    """

    __slots__ = ()

    def __init__(self, low: ArrayLike, high: ArrayLike | None = None) -> None:
        self._make(Options("bsp_tree"), low, high)


def _corners(space: ArrayLike) -> NDArray[np.float64]:
    corners = plain_points(space, "space")
    if corners.shape != (2, 3):
        message = f"has shape {corners.shape}; (2, 3) is expected: a lower and an upper corner"
        raise InputError(message, kind="shape", what="space")
    return corners.copy()
