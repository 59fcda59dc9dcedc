"""What one asks of a single mesh about points and rays, in its own frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._points import ClosestPoint, RayHit, RayHits, hits_of, scalar


class PointQueries(_impinge.MeshBase):
    """A mesh that is asked about points and rays; `Mesh` is the only one."""

    __slots__ = ()

    def closest_point(self, points: ArrayLike) -> ClosestPoint:
        """Return the points of the mesh that are nearest to given ones.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh's own frame and unit, below 2^300 in magnitude.

        Returns
        -------
        ClosestPoint
            Its fields have the leading axes of `points`. The interval from `lower` to `upper` is at most 2^-44 of the
            mesh's extent and the distance of the point from its centre, added up.

        Raises
        ------
        InputError
            If `points` has another type or shape, or a coordinate is not finite or out of range; it says which.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> near = mesh.closest_point([1, 1, 3])
        >>> near.point, near.face, round(near.distance, 9)
        (array([1., 1., 0.]), 0, 3.0)
        """
        point, lower, upper, face = _impinge.closest_point(self, points)
        upper = scalar(upper)
        return ClosestPoint(point, upper, scalar(lower), upper, scalar(face))

    def signed_distance(self, points: ArrayLike) -> float | NDArray[np.float64]:
        """Return how far points are from the surface, negative inside the mesh taken as a solid.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh's own frame and unit, below 2^128 in magnitude.

        Returns
        -------
        float or (...) float64 array
            Zero exactly on the surface, negative exactly where `contains` is true off the surface; infinite for an
            empty mesh. In magnitude as near to the true distance as `closest_point` says.

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
        return scalar(_impinge.signed_distance(self, points))  # type: ignore[no-any-return]

    def winding_number(self, points: ArrayLike) -> float | NDArray[np.float64]:
        """Return how often the mesh winds round points: 1 inside a closed one that faces outward, 0 outside.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh's own frame and unit, below 2^128 in magnitude.

        Returns
        -------
        float or (...) float64 array
            Off the surface of a closed mesh an integer, and exact; for an open one a fraction, within 1e-5 and mostly
            within 1e-13 of the true one. A face whose plane holds the point counts nothing: within a face of a closed
            mesh the number is the mean of those of both sides.

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
        return scalar(_impinge.winding_number(self, points))  # type: ignore[no-any-return]

    def contains(self, points: ArrayLike) -> bool | NDArray[np.bool_]:
        """Whether points are in the mesh taken as a solid: where it winds more than half, either way round.

        The surface counts.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh's own frame and unit, below 2^128 in magnitude.

        Returns
        -------
        bool or (...) bool array
            Exact for a closed mesh, and on the surface of any. Where an open one winds so close to half that nothing is
            proved, the point counts as contained.

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
        return scalar(_impinge.contains(self, points))  # type: ignore[no-any-return]

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> RayHit:
        """Return the first face that each ray meets, its origin included.

        Whether a ray meets a face, and which first, is decided exactly: none slips between two faces that share an
        edge. Faces are closed and have no sides.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            In the mesh's own frame and unit, below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            Of any length below 2^300 but zero. The leading axes of both broadcast as in NumPy.

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
        hit, (t, face, point) = _impinge.ray_cast(self, origins, directions)
        return RayHit(scalar(hit), scalar(t), scalar(face), point)

    def ray_cast_all(self, origins: ArrayLike, directions: ArrayLike) -> RayHit | RayHits:
        """Return every face that each ray meets, in the order in which it does and then by number.

        Parameters
        ----------
        origins, directions : (..., 3) array_like of float32 or float64
            As for `ray_cast`.

        Returns
        -------
        RayHit or RayHits
            For a single ray a `RayHit` with as many entries as there are hits; `RayHits` where there are leading axes.

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
