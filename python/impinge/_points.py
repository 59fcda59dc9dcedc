"""Results of queries on points and rays against one mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge._ragged import Ragged


@dataclass(frozen=True, eq=False)
class ClosestPoint:
    """Points of a mesh that are nearest to given points; plain numbers for a single point.

    Attributes
    ----------
    point : (..., 3) float64 array
        Nearest point in the mesh frame, rounded; zero if the mesh is empty.
    distance : float or (...) float64 array
        Distance to the nearest point, equal to `upper`.
    lower, upper : float or (...) float64 array
        Proved bounds of the distance, in the unit of the mesh; infinite if the mesh is empty.
    face : int or (...) int64 array
        Index of the face that contains the nearest point, the first if several are equally near;
        -1 if the mesh is empty.
    """

    point: NDArray[np.float64]
    distance: float | NDArray[np.float64]
    lower: float | NDArray[np.float64]
    upper: float | NDArray[np.float64]
    face: int | NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class RayHit:
    """Hits of rays on a mesh or shape; plain numbers for the first hit of a single ray.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether the ray hits the mesh or shape.
    t : float or (...) float64 array
        Ray parameter of the hit, in units of the direction's length; infinite if the ray misses.
        For a mesh the relative error is at most 2^-40; for a shape see `Shape.ray_cast`.
    face : int or (...) int64 array
        Index of the face that is hit, the first if several are hit in one point; -1 if the ray
        misses, or if no face of a mesh is hit.
    point : (..., 3) float64 array
        Point of the hit in the frame of the mesh or shape, rounded; zero if the ray misses. If the
        direction is so short that `t` is the largest float, the point of the ray at that `t`.
    """

    hit: bool | NDArray[np.bool_]
    t: float | NDArray[np.float64]
    face: int | NDArray[np.int64]
    point: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class RayHits(Ragged[RayHit]):
    """All hits of many rays on a mesh, concatenated ray by ray.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each ray's hits: the hits of ray ``i``, in row-major order of the leading axes, go
        from ``offsets[i]`` to ``offsets[i + 1]``. The hits of a ray are in the order along the ray.
    t : (k,) float64 array
        Ray parameters of the hits, as in `RayHit`.
    face : (k,) int64 array
        Indices of the faces that are hit.
    point : (k, 3) float64 array
        Points of the hits in the mesh frame, rounded.
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
    """Return all hits of one ray: arrays with one entry for each hit."""
    return RayHit(np.ones(len(t), bool), t, face, point)


def scalar(column: NDArray[Any]) -> Any:
    """Return a plain number if `column` is a 0-dimensional array, otherwise `column`."""
    return column if column.ndim else column.item()
