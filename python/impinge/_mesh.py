"""Meshes: of arrays, of other libraries' meshes, of files."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from typing import Any, Protocol, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._errors import InputError, LoadWarning


class HasTriangles(Protocol):
    """A mesh of another library, such as ``trimesh.Trimesh``."""

    @property
    def vertices(self) -> Any:
        """(n, 3) coordinates."""

    @property
    def faces(self) -> Any:
        """(m, 3) indices."""


@dataclass(frozen=True, eq=False)
class Origin:
    """Where the faces of a mesh from a file come from.

    Attributes
    ----------
    path : str
        The file.
    format : str
        The format that it turned out to have.
    unit : str or None
        The unit of the vertices, ``"mm"``, where one is known.
    polygons : (m,) uint32 array
        The polygon of the file, counted from zero, that each face is a part of.
    part_of : (m,) uint32 array
        The part that each face belongs to, as an index into `parts`.
    parts : tuple of str
        The names of the parts; empty text where the file gives none.
    """

    path: str
    format: str
    unit: str | None
    polygons: NDArray[np.uint32]
    part_of: NDArray[np.uint32]
    parts: tuple[str, ...]

    def __repr__(self) -> str:
        """Return all but the arrays."""
        return f"Origin({self.path!r}, {self.format}, unit={self.unit!r}, {len(self.parts)} parts)"


@final
class Mesh(_impinge.MeshBase):
    """A triangle mesh with its hierarchy: judged once, immutable, for any number of questions and threads.

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
    is built anew where it is loaded.

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
        self = super().__new__(cls, _arrays.plain_vertices(positions), _arrays.plain_faces(faces))
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


def load(path: str | os.PathLike[str], unit: str | None = None) -> Mesh:
    r"""Load all triangles of an OBJ, STL, PLY, OFF, glTF, GLB or 3MF file as one mesh.

    Numbers keep the precision of the file: f32 stays float32, text is read as the nearest float64. Polygons become
    triangles; `Mesh.origin` says which face is of which polygon and part.

    Parameters
    ----------
    path : str or os.PathLike
        The file.
    unit : {"um", "mm", "cm", "in", "ft", "m"}, optional
        The unit that the vertices are wanted in. A file that states another is converted, each coordinate rounded
        once, or twice where neither unit is a whole number of the other; one that states none is taken to be in it.
        Without, vertices are as in the file.

    Returns
    -------
    Mesh
        In the file's frame.

    Raises
    ------
    OSError
        If the file cannot be read; `FileNotFoundError` where there is none.
    InputError
        If its content is broken; it says in which line, byte or entry.

    Warns
    -----
    LoadWarning
        If something in the file was left out.

    Examples
    --------
    >>> import impinge, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "square.obj"
    ...     _ = path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    ...     square = impinge.load(path)
    >>> square
    Mesh(4 vertices, 2 faces)
    >>> square.origin.polygons
    array([0, 0], dtype=uint32)
    """
    path = os.fspath(path)
    model = _impinge.Model(path, unit)
    for warning in model.warnings:
        warnings.warn(f"{path}: {warning}", LoadWarning, stacklevel=2)
    mesh: Mesh = _impinge.MeshBase.__new__(Mesh, model, None)
    mesh._origin = Origin(path, model.format, model.unit, model.sources, model.part_of, tuple(model.parts))
    return mesh
