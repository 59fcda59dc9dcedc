"""Meshes, of arrays or of other libraries' meshes, and what one asks of a single one."""

from __future__ import annotations

import contextlib
import os
from typing import Any, Protocol, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._errors import InputError
from impinge._inspection import Health, TreeStatistics
from impinge._origin import Origin
from impinge._points import ClosestPoint, RayHit, RayHits, hits_of, scalar


class HasTriangles(Protocol):
    """A mesh of another library, such as ``trimesh.Trimesh``."""

    @property
    def vertices(self) -> Any:
        """(n, 3) coordinates."""

    @property
    def faces(self) -> Any:
        """(m, 3) indices."""


@final
class Mesh(_impinge.MeshBase):
    """A triangle mesh with its hierarchy: judged once, for any number of questions and threads.

    A mesh is its surface, the union of its closed triangles. A triangle without area is the segment or the point that
    it spans, and counts like any other. Face ``i`` is row ``i`` of what was given.

    Parameters
    ----------
    vertices : (n, 3) array_like of float32 or float64
        Positions in the mesh's own frame and unit, below 2^128 in magnitude. A stored coordinate is the real number
        that its float is. May be of any order, alignment and byte order; it is copied, so that later writes to it
        change nothing. Lists are read as float64. Or, without `faces`, a mesh of another library with ``vertices`` and
        ``faces``, such as ``trimesh.Trimesh``.
    faces : (m, 3) array_like of integers
        Three vertices for each face, counted from zero; copied. A negative index is an error.

    Raises
    ------
    InputError
        If an array has another shape or type; if a coordinate is not finite or out of range, or a face names a vertex
        that does not exist. It says which.

    Notes
    -----
    Building takes O(n log n) on all cores, without the interpreter's lock.

    A mesh pickles by its vertices and faces; with protocol 5 they may travel out of band, without a copy. The hierarchy
    is built anew where it is loaded. Many workers share one hierarchy where each loads what `bake` wrote.

    Examples
    --------
    >>> import numpy as np, impinge
    >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> mesh
    Mesh(3 vertices, 1 faces)
    >>> mesh.faces
    array([[0, 1, 2]], dtype=uint32)
    """

    __slots__ = ("_origin",)
    _origin: Origin | None

    def __new__(cls, vertices: ArrayLike | HasTriangles, faces: ArrayLike | None = None) -> Mesh:
        """Judge the arrays and build the hierarchy."""
        positions: Any = vertices
        if faces is None:
            if not (hasattr(positions, "vertices") and hasattr(positions, "faces")):
                message = f"faces are missing, and {type(vertices).__name__} has no vertices and faces of its own"
                raise InputError(message, kind="type", what="faces")
            positions, faces = positions.vertices, positions.faces
        self = super().__new__(cls, _arrays.plain_cloud(positions, "vertices"), _arrays.plain_faces(faces))
        self._origin = None
        return self

    @property
    def vertices(self) -> NDArray[np.float32] | NDArray[np.float64]:
        """(n, 3) positions in the mesh's own frame, read-only, of the type that was given; copied at the first use."""
        return super().vertices

    @property
    def faces(self) -> NDArray[np.uint32]:
        """(m, 3) indices of vertices, read-only; copied at the first use."""
        return super().faces

    @property
    def memory(self) -> int:
        """Bytes of the mesh and its hierarchy, the copies behind `vertices` and `faces` aside."""
        return super().memory

    @property
    def origin(self) -> Origin | None:
        """Where the faces come from, if the mesh was loaded from a file."""
        return self._origin

    @property
    def is_closed(self) -> bool:
        """Whether every edge is run through as often one way as the other, so that inside and outside are exact.

        Edges are named by the positions of their ends. Takes O(n log n) the first time.
        """
        return super().is_closed

    def health(self) -> Health:
        """Look for everything that a mesh may suffer from, in O(n log n).

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> opened = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2]])
        >>> opened.health().open_edges, opened.is_closed
        (3, False)
        """
        return Health(**_impinge.health(self))

    def tree_statistics(self) -> TreeStatistics:
        """Return what can be read off the hierarchy."""
        return TreeStatistics(**_impinge.tree_statistics(self))

    def refit(self, vertices: ArrayLike) -> None:
        """Move the vertices; the faces stay as they are.

        The hierarchy keeps its shape and takes in the new places, several times quicker than it is built. Calls that
        run meanwhile are answered about the mesh as it was. No answer depends on the shape; how much slower the
        questions have become is `aging`, and `rebuild` makes them quick again.

        Parameters
        ----------
        vertices : (n, 3) array_like of float32 or float64
            As many as before, in the mesh's own frame.

        Raises
        ------
        InputError
            If an array has another shape or type, or a coordinate is not finite or out of range. The mesh is then as it
            was.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> mesh.refit([[0, 0, 5], [1, 0, 5], [0, 1, 5]])
        >>> mesh.vertices[0], mesh.aging
        (array([0., 0., 5.]), 1.0)
        """
        self.move_vertices(_arrays.plain_cloud(vertices, "vertices"))

    def refitted(self, vertices: ArrayLike) -> Mesh:
        """Return another mesh of the same faces with its vertices moved; this one stays as it is.

        Parameters
        ----------
        vertices : (n, 3) array_like of float32 or float64
            As for `refit`.

        Returns
        -------
        Mesh
            Its hierarchy has the shape of this one's.

        Raises
        ------
        InputError
            As for `refit`.
        """
        moved = super().__new__(Mesh, _arrays.plain_cloud(vertices, "vertices"), self)
        moved._origin = self._origin
        return moved

    @property
    def aging(self) -> float:
        """What a question costs in the hierarchy by the surface area heuristic, over what it did when it was built.

        It is 1 for a new one. Above 1.5 or so, `rebuild` pays for itself within some dozens of questions.
        """
        return super().aging

    def rebuild(self) -> None:
        """Build the hierarchy anew from where the vertices are. No answer changes."""
        super().rebuild()

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
        """Whether points are in the mesh taken as a solid: where it winds more than half; the surface counts.

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
            Of any length but zero. The leading axes of both broadcast as in NumPy.

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

    def bake(self, path: str | os.PathLike[str]) -> None:
        """Write the mesh with its hierarchy to a file that `impinge.load` opens where it lies, without building.

        The file is mapped, not read: processes that load it share its pages, so that workers share one hierarchy. Baked
        into ``/dev/shm`` it stays in memory. It must not be written to while it is in use; baking to the same path
        again puts another file in its place, and leaves those who use the old one alone.

        Parameters
        ----------
        path : str or os.PathLike
            A path that ends in ``.impinge``. What `origin` says is kept.

        Raises
        ------
        InputError
            If it ends in something else.
        OSError
            If it cannot be written.

        Examples
        --------
        >>> import impinge, pathlib, tempfile
        >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     mesh.bake(pathlib.Path(folder) / "triangle.impinge")
        ...     impinge.intersects(impinge.load(pathlib.Path(folder) / "triangle.impinge"), mesh)
        True
        """
        path = os.fspath(path)
        if not path.lower().endswith(".impinge"):
            raise InputError(f"{path!r} does not end in .impinge", kind="option", what="path")
        count = self.face_count
        polygons, part_of, parts, unit = list(range(count)), [0] * count, [""], None
        if self._origin is not None:
            polygons, part_of = self._origin.polygons.tolist(), self._origin.part_of.tolist()
            parts, unit = list(self._origin.parts), self._origin.unit
        beside = f"{path}.{os.getpid()}.tmp"
        try:
            _impinge.bake(self, beside, (polygons, part_of, parts, unit))
            os.replace(beside, path)
        finally:
            with contextlib.suppress(FileNotFoundError):
                os.remove(beside)

    def __repr__(self) -> str:
        """Return the numbers of vertices and faces."""
        return f"Mesh({self.vertex_count:,} vertices, {self.face_count:,} faces)"

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arrays, out of band where the protocol allows it."""
        return _rebuilt, (self.vertices, self.faces, self._origin)


def _rebuilt(vertices: ArrayLike, faces: ArrayLike, origin: Origin | None) -> Mesh:
    mesh = Mesh(vertices, faces)
    mesh._origin = origin
    return mesh
