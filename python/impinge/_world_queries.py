"""Queries on a world: rays, and the bodies in boxes, at points and in the way of shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._handles import ALL_LAYERS, mask
from impinge._points import scalar
from impinge._scalars import real
from impinge._shape import AnyShape
from impinge._world_answers import Bodies, BodyRayHit, BodyRayHits, body_hits_of


class WorldQueries:
    """Base class of `World` with the queries that do not change it."""

    __slots__ = ("_core",)
    _core: _impinge.WorldCore

    def ray_cast(
        self, origins: ArrayLike, directions: ArrayLike, *, reach: float = np.inf, layers: int = ALL_LAYERS
    ) -> BodyRayHit:
        """Return the first body that each ray hits: by smallest `t`, then by tag, then by handle.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            In the world frame, below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            In the world frame, with a length from 2^-600 to 2^300. The leading axes of both
            broadcast as in NumPy.
        reach : float
            Maximum ray parameter, in units of the directions' lengths; at least zero.
        layers : int
            Layers to search, as 32 bits; bodies on other layers are ignored.

        Returns
        -------
        BodyRayHit
            The fields have the leading axes.

        Raises
        ------
        InputError
            If a number is out of range or a direction is zero; the error names the entry.

        Examples
        --------
        >>> import impinge
        >>> world = impinge.World()
        >>> balls = world.insert(impinge.Shape.sphere(1), impinge.pose([[5, 0, 0], [9, 0, 0]]))
        >>> hit = world.ray_cast([0, 0, 0], [2, 0, 0])
        >>> hit.body == int(balls[0]), round(hit.t, 9)
        (True, 2.0)
        """
        rays = origins, directions, real(reach, "reach", minimum=0)
        hit, (t, body, point, face) = _impinge.world_ray_cast(self._core, rays, mask(layers, "layers"))
        return BodyRayHit(scalar(hit), scalar(t), scalar(body), point, scalar(face))

    def ray_cast_all(
        self, origins: ArrayLike, directions: ArrayLike, *, reach: float = np.inf, layers: int = ALL_LAYERS
    ) -> BodyRayHit | BodyRayHits:
        """Return all bodies that each ray hits, in order along the ray, each at its first hit.

        Parameters
        ----------
        origins, directions, reach, layers
            As for `ray_cast`.

        Returns
        -------
        BodyRayHit or BodyRayHits
            For a single ray a `BodyRayHit` with one entry for each hit; `BodyRayHits` if there are
            leading axes.

        Raises
        ------
        InputError
            As for `ray_cast`.
        """
        rays = origins, directions, real(reach, "reach", minimum=0)
        offsets, columns, shape = _impinge.world_ray_cast_all(self._core, rays, mask(layers, "layers"))
        t, body, point, face = columns
        return BodyRayHits(offsets, t, body, point, face, tuple(shape)) if shape else body_hits_of(t, body, point, face)

    def overlapping(
        self, shape: AnyShape, pose: ArrayLike | None = None, *, layers: int = ALL_LAYERS
    ) -> NDArray[np.uint64] | Bodies:
        """Return the bodies that a shape intersects, without inserting it into the world.

        Undecided bodies are included, as with `impinge.intersects`.

        Parameters
        ----------
        shape : Shape or Mesh
            The shape to test. A mesh is its surface.
        pose : (..., 4, 4) array_like of float32 or float64, optional
            World from shape; None is the identity.
        layers : int
            Layers to search, as 32 bits; bodies on other layers are ignored.

        Returns
        -------
        (k,) uint64 array or Bodies
            Handles, sorted by tag, then by handle; `Bodies` if the pose has leading axes.

        Raises
        ------
        InputError
            If an argument is invalid.
        """
        return _bodies(_impinge.world_overlapping(self._core, shape, pose, mask(layers, "layers")))

    def in_boxes(self, low: ArrayLike, high: ArrayLike, *, layers: int = ALL_LAYERS) -> NDArray[np.uint64] | Bodies:
        """Return the bodies whose boxes overlap given boxes.

        It is fast, but the bodies themselves need not overlap the given boxes. Touching counts.

        Parameters
        ----------
        low, high : (..., 3) array_like of float32 or float64
            Lower and upper corners in the world frame, below 2^128 in magnitude. Leading axes
            broadcast as in NumPy.
        layers : int
            As for `overlapping`.

        Returns
        -------
        (k,) uint64 array or Bodies
            As for `overlapping`.

        Raises
        ------
        InputError
            If a number is out of range, or if an upper corner is below a lower one.
        """
        return _bodies(_impinge.world_in_boxes(self._core, low, high, mask(layers, "layers")))

    def at_points(self, points: ArrayLike, *, layers: int = ALL_LAYERS) -> NDArray[np.uint64] | Bodies:
        """Return the bodies that contain points; a surface mesh contains the points on it.

        Undecided bodies are included, as with `overlapping`.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the world frame, below 2^128 in magnitude.
        layers : int
            As for `overlapping`.

        Returns
        -------
        (k,) uint64 array or Bodies
            As for `overlapping`.

        Raises
        ------
        InputError
            If a number is out of range.
        """
        return _bodies(_impinge.world_at_points(self._core, points, mask(layers, "layers")))


def _bodies(answer: Any) -> NDArray[np.uint64] | Bodies:
    offsets, bodies, shape = answer
    return Bodies(offsets, bodies, tuple(shape)) if shape else bodies
