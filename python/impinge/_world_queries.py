"""Queries on a world: rays, moving shapes, distances, and the bodies in boxes and at points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._distances import Distance
from impinge._errors import InputError
from impinge._handles import ALL_LAYERS, handles_of, mask
from impinge._motion import Impact, Motion
from impinge._points import scalar
from impinge._scalars import flag, real
from impinge._shape import AnyShape
from impinge._world_answers import (
    Bodies,
    BodyDistance,
    BodyImpact,
    BodyImpacts,
    BodyRayHit,
    BodyRayHits,
    body_hits_of,
)


class WorldQueries:
    """Base class of `World` with the queries that do not change it."""

    __slots__ = ("_core",)
    _core: _impinge.WorldCore

    def ray_cast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        reach: float = np.inf,
        layers: int = ALL_LAYERS,
        cull_back_faces: bool = False,
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
        cull_back_faces : bool
            Whether rays pass through the backs of faces of meshes that are not solid. The front of
            a face is the side from which its corners are in counterclockwise order in the mesh
            frame. Faces that contain the ray's direction, and faces without area, are passed too.

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
        rays = origins, directions, real(reach, "reach", minimum=0), flag(cull_back_faces, "cull_back_faces")
        hit, columns = _impinge.world_ray_cast(self._core, rays, mask(layers, "layers"))
        return BodyRayHit(scalar(hit), *map(scalar, columns))

    def ray_cast_all(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        reach: float = np.inf,
        layers: int = ALL_LAYERS,
        cull_back_faces: bool = False,
    ) -> BodyRayHit | BodyRayHits:
        """Return all bodies that each ray hits, in order along the ray, each at its first hit.

        Parameters
        ----------
        origins, directions, reach, layers, cull_back_faces
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
        rays = origins, directions, real(reach, "reach", minimum=0), flag(cull_back_faces, "cull_back_faces")
        offsets, columns, shape = _impinge.world_ray_cast_all(self._core, rays, mask(layers, "layers"))
        t, body, point, normal, part, face = columns
        if shape:
            return BodyRayHits(offsets, t, body, point, normal, part, face, tuple(shape))
        return body_hits_of(t, body, point, normal, part, face)

    def shape_cast(
        self,
        shape: AnyShape,
        motion: Motion,
        *,
        clearance: float = 0.0,
        ignore_touch: bool = False,
        layers: int = ALL_LAYERS,
    ) -> BodyImpact:
        """Return the first body that a moving shape touches: by `t_lower`, then tag, then handle.

        Bodies stand still. Nothing touches the shape before `t_lower`. An impact whose `t_upper` is
        infinite is undecided.

        Parameters
        ----------
        shape : Mesh or Shape
            The moving thing; it is not inserted into the world.
        motion : Motion
            World from shape at times 0 to 1; one motion or many.
        clearance, ignore_touch
            As for `impinge.time_of_impact`.
        layers : int
            As for `ray_cast`.

        Returns
        -------
        BodyImpact
            The fields have the leading axes of the motion.

        Raises
        ------
        InputError
            If an argument is invalid, or if the motion of a round shape is at a pose that is not
            rigid.

        Examples
        --------
        >>> import impinge
        >>> world = impinge.World()
        >>> walls = world.insert(impinge.Shape.box([0.5, 4, 4]), impinge.pose([[4.5, 0, 0], [9.5, 0, 0]]))
        >>> path = impinge.Motion(None, impinge.pose([12, 0, 0]))
        >>> hit = world.shape_cast(impinge.Shape.sphere(1), path)
        >>> hit.body == int(walls[0]), round(hit.impact.t_lower, 9), hit.impact.normal
        (True, 0.25, array([1., 0., 0.]))
        """
        moving = shape, motion, real(clearance, "clearance", minimum=0), flag(ignore_touch, "ignore_touch")
        body, columns = _impinge.world_shape_cast(self._core, moving, mask(layers, "layers"))
        return BodyImpact(scalar(body), _impact(columns))

    def shape_cast_all(
        self,
        shape: AnyShape,
        motion: Motion,
        *,
        clearance: float = 0.0,
        ignore_touch: bool = False,
        layers: int = ALL_LAYERS,
    ) -> BodyImpact | BodyImpacts:
        """Return all bodies that a moving shape touches, in order of time, each at first impact.

        Parameters
        ----------
        shape, motion, clearance, ignore_touch, layers
            As for `shape_cast`.

        Returns
        -------
        BodyImpact or BodyImpacts
            For a single motion a `BodyImpact` with one entry for each body; `BodyImpacts` if the
            motion has leading axes.

        Raises
        ------
        InputError
            As for `shape_cast`.
        """
        moving = shape, motion, real(clearance, "clearance", minimum=0), flag(ignore_touch, "ignore_touch")
        offsets, (body, columns), lead = _impinge.world_shape_cast_all(self._core, moving, mask(layers, "layers"))
        impact = _impact(columns)
        return BodyImpacts(offsets, body, impact, tuple(lead)) if lead else BodyImpact(body, impact)

    def nearest(
        self,
        shape: AnyShape,
        pose: ArrayLike | None = None,
        *,
        limit: float = np.inf,
        layers: int = ALL_LAYERS,
    ) -> BodyDistance:
        """Return the body that is nearest to a shape: by `upper`, then by tag, then by handle.

        All bodies that intersect the shape have distance zero.

        Parameters
        ----------
        shape : Mesh or Shape
            The thing; it is not inserted into the world.
        pose : (..., 4, 4) array_like of float32 or float64, optional
            World from shape; None is the identity.
        limit : float
            Distance in world units beyond which bodies are ignored; at least zero.
        layers : int
            As for `ray_cast`.

        Returns
        -------
        BodyDistance
            The fields have the leading axes of the pose.

        Raises
        ------
        InputError
            If an argument is invalid.

        Examples
        --------
        >>> import impinge
        >>> world = impinge.World()
        >>> balls = world.insert(impinge.Shape.sphere(1), impinge.pose([[4, 0, 0], [-5, 0, 0]]))
        >>> near = world.nearest(impinge.Shape.sphere(0))
        >>> near.body == int(balls[0]), round(near.distance.upper, 9)
        (True, 3.0)
        """
        probe = shape, np.eye(4) if pose is None else pose
        found = _impinge.world_nearest(self._core, probe, real(limit, "limit", minimum=0), mask(layers, "layers"))
        return BodyDistance(scalar(found[0]), Distance(*found[1]))

    def within(
        self, shape: AnyShape, clearance: float, pose: ArrayLike | None = None, *, layers: int = ALL_LAYERS
    ) -> NDArray[np.uint64] | Bodies:
        """Return the bodies whose distance from a shape is at most a clearance.

        The decision is that of `impinge.within`: exact for meshes, boxes, triangles, hulls and
        half-spaces. Undecided bodies are included.

        Parameters
        ----------
        shape, pose, layers
            As for `nearest`.
        clearance : float
            Distance in world units, at least zero.

        Returns
        -------
        (k,) uint64 array or Bodies
            As for `overlapping`.

        Raises
        ------
        InputError
            If an argument is invalid.
        """
        probe = shape, np.eye(4) if pose is None else pose
        within = real(clearance, "clearance", minimum=0)
        return _bodies(_impinge.world_within(self._core, probe, within, mask(layers, "layers")))

    def distances(self, pairs: ArrayLike) -> Distance:
        """Return the distances of pairs of bodies at their current poses.

        Parameters
        ----------
        pairs : (..., 2) array_like of integers
            Handles of two bodies in each row, for example the rows of `pairs`.

        Returns
        -------
        Distance
            As from `impinge.distance`, with the leading axes of `pairs`.

        Raises
        ------
        InputError
            If a handle is stale, or if the last axis is not 2 long.
        """
        handles, lead = handles_of(pairs, "pairs")
        if lead[-1:] != (2,):
            raise InputError(f"has shape {lead}; the last axis must be 2 long", kind="shape", what="pairs")
        columns = _impinge.world_distances(self._core, handles)
        return Distance(*(scalar(column.reshape((*lead[:-1], *column.shape[1:]))) for column in columns))

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


def _impact(columns: Any) -> Impact:
    lower, upper, point, normal, parts, faces = columns
    hit = np.asarray(lower) < np.inf
    return Impact(scalar(hit), scalar(lower), scalar(upper), point, normal, parts, faces)


def _bodies(answer: Any) -> NDArray[np.uint64] | Bodies:
    offsets, bodies, shape = answer
    return Bodies(offsets, bodies, tuple(shape)) if shape else bodies
