"""Queries on points and rays against a single mesh, in the mesh frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._handles import handles_of
from impinge._points import ClosestPoint, RayHit, RayHits, hits_of


class PointQueries(_impinge.MeshBase):
    """Base class of `Mesh` with the queries on points and rays."""

    __slots__ = ()

    def closest_point(self, points: ArrayLike) -> ClosestPoint:
        """Return the points of the mesh that are nearest to given points.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh frame and unit, below 2^300 in magnitude.

        Returns
        -------
        ClosestPoint
            The fields have the leading axes of `points`. The width of the interval from `lower` to
            `upper` is at most 2^-44 of the sum of the mesh's extent and the distance of the point
            from the mesh's center.

        Raises
        ------
        InputError
            If `points` has another type or shape, or if a coordinate is not finite or out of range;
            the error names the coordinate.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> near = mesh.closest_point([1, 1, 3])
        >>> near.point, near.face, round(near.distance, 9)
        (array([1., 1., 0.]), 0, 3.0)
        """
        point, lower, upper, face = _impinge.closest_point(self, points)
        return ClosestPoint(point, upper, lower, upper, face)

    def signed_distance(self, points: ArrayLike) -> float | NDArray[np.float64]:
        """Return the distance of points from the surface, negative inside the mesh as a solid.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh frame and unit, below 2^128 in magnitude.

        Returns
        -------
        float or (...) float64 array
            In the unit of the mesh. Zero if and only if the point is on the surface; negative if
            and only if it is off the surface and `contains` returns True; infinite if the mesh is
            empty. The magnitude is as accurate as the distance of `closest_point`.

        Raises
        ------
        InputError
            As for `closest_point`.

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> solid = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        >>> solid.signed_distance([[1, 1, 0.5], [1, 1, 0], [1, 1, -2]]).round(9)
        array([-0.5,  0. ,  2. ])
        """
        return _impinge.signed_distance(self, points)

    def winding_number(self, points: ArrayLike) -> float | NDArray[np.float64]:
        """Return the winding number of the mesh around each point: how often the mesh encloses it.

        A closed mesh with outward faces has winding number 1 inside and 0 outside.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh frame and unit, below 2^128 in magnitude.

        Returns
        -------
        float or (...) float64 array
            An exact integer for a closed mesh and a point off its surface. A fraction for an open
            mesh, with an error of at most 1e-5 and mostly below 1e-13. A face whose plane contains
            the point contributes zero: on a face of a closed mesh the result is the mean of the
            numbers on both sides.

        Raises
        ------
        InputError
            As for `closest_point`.

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> solid = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        >>> solid.winding_number([[1, 1, 1], [5, 5, 5]])
        array([1., 0.])
        """
        return _impinge.winding_number(self, points)

    def contains(self, points: ArrayLike) -> bool | NDArray[np.bool_]:
        """Report whether points are inside the mesh as a solid, or on its surface.

        A point is inside if its winding number is above 1/2 in magnitude.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh frame and unit, below 2^128 in magnitude.

        Returns
        -------
        bool or (...) bool array
            Exact for a closed mesh, and for points on the surface of any mesh. For an open mesh, a
            point whose winding number is too close to 1/2 to be decided counts as contained.

        Raises
        ------
        InputError
            As for `closest_point`.

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> solid = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        >>> solid.contains([[1, 1, 0], [1, 1, -1e-300]])
        array([ True, False])
        """
        return _impinge.contains(self, points)

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> RayHit:
        """Return the first face that each ray hits; the origin is part of the ray.

        Whether a ray hits a face, and which face it hits first, is decided exactly: no ray slips
        between two faces that share an edge. Faces are closed and have two sides.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            In the mesh frame and unit, below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            In the mesh frame, with any nonzero length below 2^300. The leading axes of both
            broadcast as in NumPy.

        Returns
        -------
        RayHit
            Its fields have the leading axes.

        Raises
        ------
        InputError
            As for `closest_point`, or if a direction is zero.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> mesh.ray_cast([1, 1, 3], [0, 0, -2])
        RayHit(hit=True, t=1.5, face=0, point=array([1., 1., 0.]))
        >>> mesh.ray_cast([[1, 1, 3], [9, 9, 3]], [0, 0, -2]).t
        array([1.5, inf])
        """
        hit, columns = _impinge.ray_cast(self, origins, directions)
        return RayHit(hit, *columns)

    def face_normals(self, faces: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return the unit normals of faces, in the mesh frame.

        A normal is on the side from which the corners of the face are in counterclockwise order.

        Parameters
        ----------
        faces : int or (...) array_like of integers, optional
            Indices of faces, for example those that rays hit; None is all faces.

        Returns
        -------
        (..., 3) float64 array
            Each normal is within 2^-38 of the exact one; NaN for a face without area.

        Raises
        ------
        InputError
            If there is no such face; the error names the entry.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> mesh.face_normals(mesh.ray_cast([1, 1, 3], [0, 0, -2]).face)
        array([0., 0., 1.])
        """
        numbers, lead = handles_of(np.arange(len(self.faces)) if faces is None else faces, "faces")
        return _impinge.face_normals(self, numbers).reshape(*lead, 3)

    def ray_cast_all(self, origins: ArrayLike, directions: ArrayLike) -> RayHit | RayHits:
        """Return every face that each ray hits, in order along the ray, then by face index.

        Hits and their order are exact, as for `ray_cast`.

        Parameters
        ----------
        origins, directions : (..., 3) array_like of float32 or float64
            As for `ray_cast`.

        Returns
        -------
        RayHit or RayHits
            For a single ray a `RayHit` with one entry for each hit; `RayHits` if there are leading
            axes.

        Raises
        ------
        InputError
            As for `ray_cast`.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]], [[0, 1, 2], [1, 3, 2]])
        >>> mesh.ray_cast_all([2, 2, 3], [0, 0, -1]).face
        array([0, 1])
        """
        offsets, (t, face, point), shape = _impinge.ray_cast_all(self, origins, directions)
        return RayHits(offsets, t, face, point, tuple(shape)) if shape else hits_of(t, face, point)
