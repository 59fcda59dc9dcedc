"""A BSP tree of the space around a mesh, for many queries on points and rays."""

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
    """A BSP tree over the faces of a mesh: disjoint convex cells, each inside or outside.

    The method is that of Thibault and Naylor (1987). Use it for a mesh that does not move and many
    points. A point costs one comparison with a plane for each level. An exact winding number is
    computed only for the first point in a cell, and for points on a plane. Answers are bitwise
    equal to those of the mesh.

    Parameters
    ----------
    mesh : Mesh
        The mesh in its current state: later changes to it do not affect the tree.

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
        """Return the tree itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> SolidBsp:
        """Return the tree itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the mesh; unpickling builds the tree again."""
        return SolidBsp, (self._mesh,)

    @property
    def cells(self) -> int:
        """Number of convex cells."""
        return self._core.size()[0]

    @property
    def depth(self) -> int:
        """Maximum number of planes that a point is compared with."""
        return self._core.size()[1]

    def contains(self, points: ArrayLike) -> bool | NDArray[np.bool_]:
        """Report whether points are inside the mesh as a solid, or on it, as `Mesh.contains` does.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the mesh frame and unit, below 2^128 in magnitude.

        Returns
        -------
        bool or (...) bool array
            Exact for a closed mesh. For an open mesh every point is computed separately, so the
            tree saves no time.

        Raises
        ------
        InputError
            If a coordinate is out of range; the error names it.
        """
        return scalar(self._core.contains(points))  # type: ignore[no-any-return]

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> RayHit:
        """Return the first face that each ray hits; the result equals that of `Mesh.ray_cast`.

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
        hit, columns = self._core.ray_cast(origins, directions)
        return RayHit(hit, *columns)

    def __repr__(self) -> str:
        """Return the number of cells and the depth."""
        return f"<impinge.SolidBsp: {self.cells} cells, {self.depth} deep>"
