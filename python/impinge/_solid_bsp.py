"""Space about a mesh cut into cells that are inside or outside, for many points and rays."""

from __future__ import annotations

from copy import copy
from typing import final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._mesh import Mesh
from impinge._points import RayHit, scalar


@final
class SolidBsp:
    """A BSP tree over the faces of a mesh: disjoint convex cells, each inside or outside (Thibault, Naylor 1987).

    For a mesh that stands still and points that are many: a point costs a plane for each level, and an exact winding
    number only where it is the first of its cell, or on a plane. Answers are those of the mesh, to the bit.

    Parameters
    ----------
    mesh : Mesh
        As it is now: what is done to it later does not change the tree.

    Examples
    --------
    >>> import impinge
    >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
    >>> solid = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> tree = impinge.SolidBsp(solid)
    >>> tree.contains([[1, 1, 1], [1, 1, 0], [3, 3, 3]])
    array([ True,  True, False])
    >>> tree.ray_cast([1, 1, -2], [0, 0, 1]).t
    2.0
    """

    __slots__ = ("_core", "_mesh")

    def __init__(self, mesh: Mesh) -> None:
        self._core = _impinge.SolidBspCore(mesh)
        self._mesh = copy(mesh)

    def __copy__(self) -> SolidBsp:
        """Return itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> SolidBsp:
        """Return itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Return how to make it again of its mesh."""
        return SolidBsp, (self._mesh,)

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return self._core.size()[0]

    @property
    def depth(self) -> int:
        """The most planes that a point is compared with."""
        return self._core.size()[1]

    def contains(self, points: ArrayLike) -> bool | NDArray[np.bool_]:
        """Whether points are in the mesh taken as a solid; the same as `Mesh.contains` says.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh's own frame and unit, below 2^128 in magnitude.

        Returns
        -------
        bool or (...) bool array
            Exact for a closed mesh. About an open one every point is asked for by itself, and nothing is saved.

        Raises
        ------
        InputError
            If a coordinate is not in range; it says which.
        """
        return scalar(self._core.contains(points))  # type: ignore[no-any-return]

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> RayHit:
        """Return the first face that each ray meets; the same as `Mesh.ray_cast` says.

        Parameters
        ----------
        origins, directions : (..., 3) array_like of float32 or float64
            As for `Mesh.ray_cast`.

        Returns
        -------
        RayHit
            Its fields have the leading axes.

        Raises
        ------
        InputError
            As for `Mesh.ray_cast`.
        """
        hit, (t, face, point) = self._core.ray_cast(origins, directions)
        return RayHit(scalar(hit), scalar(t), scalar(face), point)

    def __repr__(self) -> str:
        """Return the number of cells and the depth."""
        return f"<impinge.SolidBsp: {self.cells} cells, {self.depth} deep>"
