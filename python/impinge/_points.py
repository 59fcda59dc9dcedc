"""Where points are to a mesh, and where rays meet it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge._ragged import Ragged


@dataclass(frozen=True, eq=False)
class ClosestPoint:
    """The points of a mesh that are nearest to given ones; numbers where a single one was given.

    Attributes
    ----------
    point : (..., 3) float64 array
        The nearest point, in the mesh's own frame, rounded; zero where the mesh is empty.
    distance : float or (...) float64 array
        `upper`.
    lower, upper : float or (...) float64 array
        The true distance lies between them, in the mesh's unit; infinite where the mesh is empty.
    face : int or (...) int64 array
        The face that the point is on, the first of those that are equally near; -1 where the mesh is empty.
    """

    point: NDArray[np.float64]
    distance: float | NDArray[np.float64]
    lower: float | NDArray[np.float64]
    upper: float | NDArray[np.float64]
    face: int | NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class RayHit:
    """Where rays meet a mesh; numbers where a single one was cast.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether the ray meets the mesh.
    t : float or (...) float64 array
        In units of the direction's length, within 2^-40 of itself of the true one; infinite where nothing is met.
    face : int or (...) int64 array
        The face that is met, the first of those that are met in one point; -1 where none is.
    point : (..., 3) float64 array
        The point, in the mesh's own frame, rounded; zero where nothing is met. Of a ray so short that `t` is the
        largest float, the point there.
    """

    hit: bool | NDArray[np.bool_]
    t: float | NDArray[np.float64]
    face: int | NDArray[np.int64]
    point: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class RayHits(Ragged[RayHit]):
    """Everything that each of many rays meets, one ray's hits after another's.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        The hits of ray ``i``, in row-major order of the leading axes, are those from ``offsets[i]`` to
        ``offsets[i + 1]``; for each ray in the order in which it meets them.
    t : (k,) float64 array
        Where, in units of the directions' lengths.
    face : (k,) int64 array
        The faces that are met.
    point : (k, 3) float64 array
        The points, in the mesh's own frame, rounded.
    shape : tuple of int
        The leading axes of the rays; their product is ``n``.

    Examples
    --------
    >>> import impinge
    >>> mesh = impinge.Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 1], [4, 0, 1], [0, 4, 1]], [[0, 1, 2], [3, 4, 5]])
    >>> hits = mesh.ray_cast_all([[1, 1, -1], [9, 9, -1]], [0, 0, 1])
    >>> hits
    RayHits(shape=(2,), 2 hits)
    >>> hits[0].t, hits[0].face
    (array([1., 2.]), array([0, 1]))
    """

    offsets: NDArray[np.int64]
    t: NDArray[np.float64]
    face: NDArray[np.int64]
    point: NDArray[np.float64]
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> RayHit:
        return hits_of(self.t[entries], self.face[entries], self.point[entries])

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> RayHits:
        return RayHits(offsets, self.t[entries], self.face[entries], self.point[entries], shape)

    def __repr__(self) -> str:
        """Return the shape and the number of hits."""
        return f"RayHits(shape={self.shape}, {len(self.t)} hits)"


def hits_of(t: NDArray[np.float64], face: NDArray[np.int64], point: NDArray[np.float64]) -> RayHit:
    """Return what one ray meets: arrays of as many entries as there are hits."""
    return RayHit(np.ones(len(t), bool), t, face, point)


def scalar(column: NDArray[Any]) -> Any:
    """Return a plain number in place of an array without axes."""
    return column if column.ndim else column.item()
