"""Meshes, of arrays or of other libraries' meshes, and what one asks of a single one."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Literal, Protocol, final, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._errors import InputError
from impinge._inspection import Health, Repair, TreeStatistics
from impinge._mesh_points import PointQueries
from impinge._origin import Origin, origin_of
from impinge._scalars import chosen, flag, path_of, real

if TYPE_CHECKING:
    from typing_extensions import Buffer

BuilderName = Literal["auto", "morton", "median", "binned-sah", "sweep-sah", "ploc", "insertion", "reinsertion"]
"""How a hierarchy is built."""


class HasTriangles(Protocol):
    """A mesh of another library, such as ``trimesh.Trimesh``."""

    @property
    def vertices(self) -> Any:
        """(n, 3) coordinates."""

    @property
    def faces(self) -> Any:
        """(m, 3) indices."""


@final
class Mesh(PointQueries):
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

    A copy (`copy.copy`, `copy.deepcopy`) shares all there is, and goes its own way when either is refitted. A mesh
    pickles by its vertices and faces; with protocol 5 they may travel out of band, without a copy. The hierarchy is
    built anew where it is loaded. Many workers share one hierarchy where each loads what `bake` wrote.

    Examples
    --------
    >>> import numpy as np, impinge
    >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> mesh
    Mesh(3 vertices, 1 faces)
    >>> mesh.faces
    array([[0, 1, 2]], dtype=uint32)
    """

    __slots__ = ("_origin", "_still")
    _origin: Origin | None
    _still: Mesh | None
    """A copy of the mesh as it is now, for whoever wants it never to change; none where nobody asked for one."""

    def __new__(cls, vertices: ArrayLike | HasTriangles, faces: ArrayLike | None = None) -> Mesh:
        """Judge the arrays and build the hierarchy."""
        positions: Any = vertices
        if faces is None:
            if not (hasattr(positions, "vertices") and hasattr(positions, "faces")):
                message = f"faces are missing, and {type(vertices).__name__} has no vertices and faces of its own"
                raise InputError(message, kind="type", what="faces")
            positions, faces = positions.vertices, positions.faces
        self = super().__new__(cls, _arrays.plain_cloud(positions, "vertices"), _arrays.plain_faces(faces))
        self._origin = self._still = None
        return self

    @classmethod
    def _of(cls, source: _impinge.Model | _impinge.MeshBase, origin: Origin | None) -> Mesh:
        """Return the mesh that a file holds, or that shares all of another one."""
        made: Mesh = _impinge.MeshBase.__new__(cls, source, None)
        made._origin, made._still = origin, None
        return made

    @classmethod
    def from_baked(cls, baked: Buffer) -> Mesh:
        """Return the mesh that `to_baked` made bytes of, with its hierarchy: proved to be one, not built.

        Parameters
        ----------
        baked : bytes or any object with a buffer of bytes
            ``memoryview``, ``mmap.mmap``, the ``buf`` of a ``multiprocessing.shared_memory.SharedMemory``: exactly the
            bytes, in one piece. They are copied, once, to where they are aligned; what becomes of them later does not
            reach the mesh. What is in a file, or in shared memory that has a path, `impinge.load` opens without a copy.

        Raises
        ------
        InputError
            If they are no baked mesh, or were spoiled on the way.
        BufferError, TypeError
            If the object has no buffer, or not one of bytes in one piece.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> impinge.Mesh.from_baked(mesh.to_baked())
        Mesh(3 vertices, 1 faces)
        """
        view = memoryview(baked)
        model = _impinge.Model.of_baked(view if (view.format, view.ndim) == ("B", 1) else view.cast("B"))
        return cls._of(model, origin_of(model, ""))

    @property
    def vertices(self) -> NDArray[np.float32] | NDArray[np.float64]:
        """(n, 3) positions in the mesh's own frame, read-only; copied at the first use.

        Of the type that was given; of a baked mesh float32 where that holds them all, with the same numbers.
        """
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

    def repaired(self, *, weld: float = 0.0, orient: bool = False) -> tuple[Mesh, Repair]:
        """Return this mesh, repaired, and what was changed. Vertices and faces keep their numbers.

        Parameters
        ----------
        weld : float, default 0.0
            How far a vertex may be moved to meet the nearest earlier one that has stayed, in the unit of the mesh.
        orient : bool, default False
            Whether faces are turned so that neighbors agree on a side. Linked faces get the side that at least three
            quarters of their area have, or else the side with which they enclose a positive volume, or else the side
            that most of their area has. If all of them then enclose a negative volume, all are turned.

        Raises
        ------
        InputError
            If the tolerance is negative, NaN or infinite.

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> mesh = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 2, 3], [1, 2, 3]])  # the third is turned
        >>> repaired, repair = mesh.repaired(orient=True)
        >>> repair
        Repair(0 vertices welded by at most 0, 1 faces turned, 0 one-sided, 0 without area, 0 duplicates)
        >>> mesh.is_closed, repaired.is_closed
        (False, True)
        """
        made, report = _impinge.repaired(self, real(weld, "weld", least=0.0), flag(orient, "orient"))
        return Mesh._of(made, self._origin), Repair(**report)

    def closing_tolerance(self) -> float | None:
        """Return a tolerance at which welding closes every open edge, in O(n log n).

        It is the least that does of 10^-16 to 10^-4 of the size of the mesh, rounded up to a power of ten, or None.

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
        """Return what can be read off the hierarchy."""
        return TreeStatistics(**_impinge.tree_statistics(self))

    def refit(self, vertices: ArrayLike) -> None:
        """Move the vertices; the faces stay as they are.

        The hierarchy keeps its shape and takes in the new places, several times quicker than it is built. Calls that
        run meanwhile are answered about the mesh as it was. No answer depends on the shape, beyond what `rebuild` says;
        how much slower the questions have become is `aging`, and `rebuild` makes them quick again.

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
        self._still = None

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
        moved._origin, moved._still = self._origin, None
        return moved

    @property
    def aging(self) -> float:
        """What a question costs in the hierarchy by the surface area heuristic, over what it did when it was built.

        It is 1 for a new one. Above 1.5 or so, `rebuild` pays for itself within some dozens of questions.
        """
        return super().aging

    def rebuild(self, builder: BuilderName = "auto") -> None:
        """Build the hierarchy anew from where the vertices are.

        No answer changes, but which of the faces that meet `distance` names where meshes intersect, and winding numbers
        of open meshes within their error.

        Parameters
        ----------
        builder : str, default "auto"
            How: ``"auto"``, as a new mesh is built, takes ``"sweep-sah"`` for up to 8,192 faces, ``"binned-sah"`` for
            up to 131,072 and ``"morton"``, which builds five times as fast, for more. ``"binned-sah"`` is for a large
            mesh that is asked often: it takes some 0.4 microseconds a face, and questions take up to several times less
            where faces are uneven. The others, ``"median"``, ``"ploc"``, ``"insertion"`` and ``"reinsertion"``, are
            there to be compared.

        Raises
        ------
        InputError
            If it is none of these.

        Examples
        --------
        >>> import impinge
        >>> mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> mesh.rebuild("binned-sah")
        >>> mesh.aging
        1.0
        """
        super().rebuild(chosen(builder, get_args(BuilderName), "builder"))

    def bake(self, path: str | os.PathLike[str], *, proxies: bool = False) -> None:
        """Write the mesh with its hierarchy to a file that `impinge.load` opens where it lies, without building.

        The file is mapped, not read: processes that load it share its pages, so that workers share one hierarchy. Baked
        into ``/dev/shm`` it stays in memory. It must not be written to while it is in use; baking to the same path
        again puts another file in its place, and leaves those who use the old one alone.

        Parameters
        ----------
        path : str or os.PathLike
            A path that ends in ``.impinge``. What `origin` says is kept.
        proxies : bool
            Whether the convex hull and the bounding volumes are written, too, for `impinge.fit.proxies`.

        Raises
        ------
        InputError
            If it ends in something else, or proxies are wanted of a mesh from a file with other ones than its own.
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
        path = path_of(path, "path")
        if not path.lower().endswith(".impinge"):
            raise InputError(f"{path!r} does not end in .impinge", kind="option", what="path")
        _impinge.bake(self, path, self._about(), flag(proxies, "proxies"))

    def to_baked(self, *, proxies: bool = False) -> bytes:
        """Return the bytes that `bake` would write, for `from_baked` or for memory that processes share.

        Examples
        --------
        Workers that map one hierarchy, without a file and on Linux; each opens it by the path that it has there::

            baked = mesh.to_baked()
            shared = multiprocessing.shared_memory.SharedMemory(create=True, size=len(baked))
            shared.buf[:] = baked
            impinge.load(f"/dev/shm/{shared.name}")
        """
        return _impinge.to_baked(self, self._about(), flag(proxies, "proxies"))

    def _about(self) -> tuple[list[int], list[int], list[str], str | None]:
        """Where the faces come from, as the extension takes it."""
        if self._origin is None:
            return list(range(self.face_count)), [0] * self.face_count, [""], None
        origin = self._origin
        return origin.polygons.tolist(), origin.part_of.tolist(), list(origin.parts), origin.unit

    def _as_it_is(self) -> Mesh:
        """Return a mesh that shares all of this one as it is now, and that nobody changes; the same until a refit."""
        still = self._still
        if still is None:
            still = self._still = Mesh._of(self, self._origin)
        return still

    def __repr__(self) -> str:
        """Return the numbers of vertices and faces."""
        return f"Mesh({self.vertex_count:,} vertices, {self.face_count:,} faces)"

    def __copy__(self) -> Mesh:
        """Return a mesh that shares all of this one, until either is refitted."""
        return Mesh._of(self, self._origin)

    def __deepcopy__(self, memo: object) -> Mesh:
        """Return a mesh that shares all of this one, until either is refitted: what they share never changes."""
        return Mesh._of(self, self._origin)

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arrays, out of band where the protocol allows it."""
        return _rebuilt, (self.vertices, self.faces, self._origin)


def _rebuilt(vertices: ArrayLike, faces: ArrayLike, origin: Origin | None) -> Mesh:
    mesh = Mesh(vertices, faces)
    mesh._origin = origin
    return mesh
