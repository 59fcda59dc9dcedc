"""Meshes from arrays, files or other libraries, and the queries on a single mesh."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Literal, Protocol, final, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._baked import opened
from impinge._decomposition import ConvexPart, ConvexParts
from impinge._errors import InputError
from impinge._inspection import Health, Repair, TreeStatistics
from impinge._mesh_points import PointQueries
from impinge._origin import Origin, origin_of
from impinge._scalars import chosen, flag, path_of, real, whole
from impinge._stored import Stored

if TYPE_CHECKING:
    from typing_extensions import Buffer

BuilderName = Literal["auto", "morton", "median", "binned-sah", "sweep-sah", "ploc", "insertion", "reinsertion"]
"""Names of the algorithms that build a hierarchy."""


class HasTriangles(Protocol):
    """A mesh of another library, such as ``trimesh.Trimesh``."""

    @property
    def vertices(self) -> Any:
        """Positions of the vertices, (n, 3)."""

    @property
    def faces(self) -> Any:
        """Vertex indices of the faces, (m, 3)."""


@final
class Mesh(PointQueries):
    """A triangle mesh with its hierarchy: validated once, for any number of queries and threads.

    A mesh is a surface: the union of its closed triangles. A triangle without area is a segment or
    a point, and counts like any other. Face ``i`` is row ``i`` of `faces`.

    Parameters
    ----------
    vertices : (n, 3) array_like of float32 or float64
        Positions in the mesh frame and unit, below 2^128 in magnitude; copied. Each coordinate is
        the exact real number that the float represents. Lists are read as float64. Without `faces`,
        a mesh of another library that has ``vertices`` and ``faces``, such as ``trimesh.Trimesh``.
    faces : (m, 3) array_like of integers
        Three vertex indices for each face, counted from zero; copied. A negative index is an error.

    Raises
    ------
    InputError
        If an array has another shape or type, if a coordinate is not finite or out of range, or if
        a face uses a vertex that does not exist. The error names the entry.

    Notes
    -----
    Building takes O(n log n) time on all cores, with the interpreter's lock released. A copy
    (`copy.copy`, `copy.deepcopy`) shares all data until one of the two is refitted. A mesh pickles
    its vertices and faces, out of band with protocol 5. Unpickling builds the hierarchy again; to
    share one between processes, `bake` it and load the file in each process.

    Examples
    --------
    >>> import numpy as np, impinge
    >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> mesh
    Mesh(3 vertices, 1 faces)
    >>> mesh.faces
    array([[0, 1, 2]], dtype=uint32)
    """

    __slots__ = ("_cached_snapshot", "_origin", "_stored")
    _origin: Origin | None
    _cached_snapshot: Mesh | None
    """Result of `_snapshot`; None before the first call and after a change."""
    _stored: Stored | None
    """Place of the mesh in a file that it was loaded from; None after a change."""

    def __new__(cls, vertices: ArrayLike | HasTriangles, faces: ArrayLike | None = None) -> Mesh:
        """Validate the arrays and build the hierarchy."""
        positions: Any = vertices
        if faces is None:
            if not (hasattr(positions, "vertices") and hasattr(positions, "faces")):
                message = f"faces are missing, and {type(vertices).__name__} has no attributes vertices and faces"
                raise InputError(message, kind="type", what="faces")
            positions, faces = positions.vertices, positions.faces
        self = super().__new__(cls, _arrays.plain_cloud(positions, "vertices"), _arrays.plain_faces(faces))
        self._origin = self._cached_snapshot = self._stored = None
        return self

    @classmethod
    def _of(cls, source: _impinge.Model | _impinge.MeshBase, origin: Origin | None) -> Mesh:
        """Return the mesh of a file, or a mesh that shares all data of another one."""
        made: Mesh = _impinge.MeshBase.__new__(cls, source, None)
        made._origin, made._cached_snapshot = origin, None
        # A change of the source clears the place first. So the place belongs to the shared state.
        made._stored = source._stored if isinstance(source, Mesh) else None
        return made

    @classmethod
    def from_baked(cls, baked: Buffer) -> Mesh:
        """Return the mesh that `to_baked` turned into bytes; its hierarchy is validated, not built.

        Parameters
        ----------
        baked : bytes or any object with a buffer of bytes
            It must hold exactly the baked bytes, contiguous. They are used in place and kept alive
            if the object and all that it is a view of are read-only, and they start at a multiple
            of 64; do not write to them by other means. Otherwise they are copied once.

        Raises
        ------
        InputError
            If the bytes are not a baked mesh, or are corrupt.
        BufferError, TypeError
            If the object has no buffer, or not a contiguous one of bytes.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> impinge.Mesh.from_baked(mesh.to_baked())
        Mesh(3 vertices, 1 faces)
        """
        model = opened(baked)
        return cls._of(model, origin_of(model, ""))

    @property
    def vertices(self) -> NDArray[np.float32] | NDArray[np.float64]:
        """Positions (n, 3) in the mesh frame and unit, read-only; copied on first use.

        The type is that of the input. A baked mesh has float32 if that is exact.
        """
        return super().vertices

    @property
    def faces(self) -> NDArray[np.uint32]:
        """Three vertex indices for each face, (m, 3), read-only; copied on first use."""
        return super().faces

    @property
    def memory(self) -> int:
        """Size of the mesh and its hierarchy in bytes, without arrays that were copied from it."""
        return super().memory

    @property
    def origin(self) -> Origin | None:
        """Where the faces come from, if the mesh was loaded from a file; otherwise None."""
        return self._origin

    @property
    def is_closed(self) -> bool:
        """Report whether each edge is used equally often in both directions.

        Answers about the inside are then exact. Edges are identified by the positions of their
        ends. The first call takes O(n log n) time.
        """
        return super().is_closed

    def health(self) -> Health:
        """Count the defects of the mesh, in O(n log n) time.

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> opened = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2]])
        >>> opened.health().open_edges, opened.is_closed
        (3, False)
        """
        return Health(**_impinge.health(self))

    def repaired(self, *, weld: float = 0.0, orient: bool = False) -> tuple[Mesh, Repair]:
        """Return a repaired copy, and a report. Vertices and faces keep their indices.

        Parameters
        ----------
        weld : float, default 0.0
            Maximum distance, in the unit of the mesh, by which a vertex is moved: to the nearest
            earlier vertex that has not moved. Zero moves no vertex.
        orient : bool, default False
            Whether to turn faces so that neighbors agree on the orientation. Linked faces take the
            orientation that at least 3/4 of their area have; otherwise, if closed, the one that
            encloses a positive volume; otherwise that of most of their area. If all closed groups
            together then enclose a negative volume, these groups are turned.

        Raises
        ------
        InputError
            If `weld` is negative, NaN or infinite.

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> mesh = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 2, 3], [1, 2, 3]])  # one face is inside out
        >>> repaired, repair = mesh.repaired(orient=True)
        >>> repair
        Repair(0 vertices welded by at most 0, 1 faces turned, 0 one-sided, 0 without area, 0 duplicates)
        >>> mesh.is_closed, repaired.is_closed
        (False, True)
        """
        return self._repaired(real(weld, "weld", minimum=0.0), flag(orient, "orient"))

    def _repaired(self, weld: float | None, orient: bool) -> tuple[Mesh, Repair]:
        """Return a repaired copy; without a distance, vertices are welded to close the mesh."""
        made, report = _impinge.repaired(self, weld, orient)
        return Mesh._of(made, self._origin), Repair(**report)

    def convex_parts(self, *, concavity: float | None = None, max_parts: int = 64) -> ConvexParts:
        """Divide the solid of the mesh into convex parts, for programs that need convex shapes.

        The hulls of the parts cover the solid, and no point of a hull is farther from the solid
        than the `concavity` of the answer; both are proved. A convex mesh is one part, its hull.
        Hulls may overlap.

        Parameters
        ----------
        concavity : float, optional
            Maximum distance that a hull may reach outside the solid, in the unit of the mesh. The
            default is 1/40 of the largest extent of the mesh along an axis.
        max_parts : int, default 64
            Maximum number of parts, from 1 to 16,384.

        Returns
        -------
        ConvexParts
            If there are too few parts for the concavity, `is_within` is False.

        Raises
        ------
        InputError
            If the mesh is open or has no faces, or if an argument is out of range.

        Notes
        -----
        The method is that of Wei and others, *Approximate convex decomposition for 3D meshes with
        collision-aware concavity and tree search* (SIGGRAPH 2022): planes cut the worst part until
        all are good, and parts are merged again. Bounds are proved instead of sampled.

        Examples
        --------
        >>> import impinge, numpy as np
        >>> box = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
        >>> faces = impinge.convex_hull(box).faces
        >>> angle = impinge.Mesh(np.vstack([box * [3, 1, 1], box * [1, 3, 1]]), np.vstack([faces, faces + 8]))
        >>> parts = angle.convex_parts(concavity=0.1)
        >>> len(parts), parts.is_within
        (2, True)
        >>> impinge.Shape.of_parts(parts)
        Shape.compound(2 parts)
        """
        wanted = None if concavity is None else real(concavity, "concavity", minimum=0.0)
        found, is_within = _impinge.convex_parts(self, wanted, whole(max_parts, "max_parts"))
        return ConvexParts(tuple(ConvexPart(*part) for part in found), is_within)

    def closing_tolerance(self) -> float | None:
        """Return a tolerance at which welding closes every open edge, in O(n log n) time.

        It is in the unit of the mesh: the smallest of 10^-16, 10^-15, up to 10^-4 times the largest
        extent, rounded up to a power of ten. None if none of them closes all edges, if no edge is
        open, or if there are more than 131,072 open edges.

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 2e-7, 1]]
        >>> cracked = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 4]])
        >>> cracked.closing_tolerance()
        1e-06
        >>> cracked.repaired(weld=1e-6)[0].is_closed
        True
        """
        return _impinge.closing_tolerance(self)

    def tree_statistics(self) -> TreeStatistics:
        """Measure the size and the quality of the mesh's hierarchy."""
        return TreeStatistics(**_impinge.tree_statistics(self))

    def refit(self, vertices: ArrayLike) -> None:
        """Move the vertices; the faces stay the same.

        The hierarchy keeps its structure and updates its boxes, several times faster than a
        rebuild. Calls that run at the same time use the mesh as it was. If `aging` shows that
        queries became slow, call `rebuild`.

        Parameters
        ----------
        vertices : (n, 3) array_like of float32 or float64
            New positions in the mesh frame and unit, one for each existing vertex.

        Raises
        ------
        InputError
            If the array has another shape or type, or a coordinate is not finite or out of range;
            the mesh does not change then.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> mesh.refit([[0, 0, 5], [1, 0, 5], [0, 1, 5]])
        >>> mesh.vertices[0], mesh.aging
        (array([0., 0., 5.]), 1.0)
        """
        positions = _arrays.plain_cloud(vertices, "vertices")
        self._stored = None
        self.move_vertices(positions)
        self._cached_snapshot = None

    def refitted(self, vertices: ArrayLike) -> Mesh:
        """Return a mesh with the same faces and moved vertices; this mesh does not change.

        Parameters
        ----------
        vertices : (n, 3) array_like of float32 or float64
            As for `refit`.

        Returns
        -------
        Mesh
            Its hierarchy has the same structure as the hierarchy of this mesh.

        Raises
        ------
        InputError
            As for `refit`.
        """
        moved = super().__new__(Mesh, _arrays.plain_cloud(vertices, "vertices"), self)
        moved._origin, moved._cached_snapshot, moved._stored = self._origin, None, None
        return moved

    @property
    def aging(self) -> float:
        """Expected cost of a query, divided by that after the last build (surface area heuristic).

        Above about 1.5, `rebuild` pays off within a few dozen queries.
        """
        return super().aging

    def rebuild(self, builder: BuilderName = "auto") -> None:
        """Build the hierarchy again from the current vertices.

        Answers stay the same, except for the pair of intersecting faces that `distance` returns,
        and for winding numbers of open meshes, which vary within their error.

        Parameters
        ----------
        builder : str, default "auto"
            Algorithm. ``"auto"``, the default of new meshes, uses ``"sweep-sah"`` for up to 8,192
            faces, ``"binned-sah"`` for up to 131,072, and ``"morton"``, which builds 5 times as
            fast, for more. For a large mesh with many queries use ``"binned-sah"``: it takes about
            0.4 microseconds for each face, and queries are several times faster if face sizes vary.
            ``"median"``, ``"ploc"``, ``"insertion"`` and ``"reinsertion"`` are for comparison.

        Raises
        ------
        InputError
            If there is no such builder.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> mesh.rebuild("binned-sah")
        >>> mesh.aging
        1.0
        """
        name = chosen(builder, get_args(BuilderName), "builder")
        self._stored = None
        super().rebuild(name)
        self._cached_snapshot = None

    def bake(self, path: str | os.PathLike[str], *, proxies: bool = False) -> None:
        """Write the mesh with its hierarchy to a file that `impinge.load` maps without building.

        Processes that load the file share one hierarchy. A file in ``/dev/shm`` stays in memory.
        Do not write to a file in use; baking to its path again replaces it for later users only.

        Parameters
        ----------
        path : str or os.PathLike
            A path that ends in ``.impinge``. The data of `origin` is kept.
        proxies : bool
            Whether to write also the convex hull and volumes of `impinge.fit.proxies`.

        Raises
        ------
        InputError
            If the path has another extension, or if proxies from the mesh's file do not match it.
        OSError
            If the file cannot be written.

        Examples
        --------
        >>> import impinge, pathlib, tempfile
        >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     mesh.bake(pathlib.Path(folder) / "triangle.impinge")
        ...     impinge.intersects(impinge.load(pathlib.Path(folder) / "triangle.impinge"), mesh)
        True
        """
        path = path_of(path, "path")
        if not path.lower().endswith(".impinge"):
            raise InputError(f"{path!r} does not end in .impinge", kind="option", what="path")
        _impinge.bake(self, path, self._origin_data(), flag(proxies, "proxies"))

    def to_baked(self, *, proxies: bool = False) -> bytes:
        """Return the bytes that `bake` writes (`proxies` as there), for `from_baked` or sharing.

        Examples
        --------
        Processes on Linux that share one hierarchy without a file; each loads it by its path::

            baked = mesh.to_baked()
            shared = multiprocessing.shared_memory.SharedMemory(create=True, size=len(baked))
            shared.buf[:] = baked
            impinge.load(f"/dev/shm/{shared.name}")
        """
        return _impinge.to_baked(self, self._origin_data(), flag(proxies, "proxies"))

    def _origin_data(self) -> tuple[list[int], list[int], list[str], str | None] | None:
        """Return the data of `origin` in the form that the extension takes."""
        if (origin := self._origin) is None:
            return None
        return origin.polygons.tolist(), origin.part_of.tolist(), list(origin.parts), origin.unit

    def _snapshot(self) -> Mesh:
        """Return a copy of the mesh as it is now that is never refitted; cached until a refit."""
        snapshot = self._cached_snapshot
        if snapshot is None:
            snapshot = self._cached_snapshot = Mesh._of(self, self._origin)
        return snapshot

    def __repr__(self) -> str:
        """Return the numbers of vertices and faces."""
        return f"Mesh({self.vertex_count:,} vertices, {self.face_count:,} faces)"

    def __copy__(self) -> Mesh:
        """Return a mesh that shares all data with this one until either is refitted."""
        return Mesh._of(self, self._origin)

    def __deepcopy__(self, memo: object) -> Mesh:
        """Return a copy as `copy.copy` does."""
        return Mesh._of(self, self._origin)

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arrays, out of band if the protocol supports it."""
        return _rebuilt, (self.vertices, self.faces, self._origin)


def _rebuilt(vertices: ArrayLike, faces: ArrayLike, origin: Origin | None) -> Mesh:
    mesh = Mesh(vertices, faces)
    mesh._origin = origin
    return mesh
