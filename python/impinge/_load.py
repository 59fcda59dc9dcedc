"""Loads meshes and scenes from files."""

from __future__ import annotations

import os
import warnings

import numpy as np

from impinge import _impinge
from impinge._errors import InputError, LoadWarning
from impinge._mesh import Mesh
from impinge._origin import Origin, origin_of
from impinge._scalars import path_of, whole
from impinge._scene import Scene


def load(
    path: str | os.PathLike[str],
    unit: str | None = None,
    *,
    max_bytes: int | None = None,
    max_triangles: int | None = None,
) -> Mesh:
    r"""Load all triangles of a mesh file as one mesh.

    The formats are OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA and baked meshes. Numbers keep the
    precision of the file: f32 becomes float32, and text is read as the nearest float64. Polygons
    are triangulated; `Mesh.origin` returns the polygon and the part of each face.

    A file written by `Mesh.bake` or ``impinge bake`` is memory-mapped and validated, not built,
    unless its unit has to be converted. This includes shared memory that has a path,
    ``/dev/shm/...``. Do not write to a mapped file while it is in use.

    Parameters
    ----------
    path : str or os.PathLike
        The file.
    unit : {"um", "mm", "cm", "in", "ft", "m"}, optional
        Unit of the returned vertices. If the file states another unit, coordinates are converted.
        Each is rounded once, or twice if neither unit is an integer multiple of the other. A file
        that states no unit is assumed to use this one. Without `unit`, vertices are not converted.
    max_bytes : int, optional
        Maximum number of bytes of the file, of the content that it unpacks to, and of all files
        that it refers to, each. Without it, only unpacked content is limited: to 64 MiB plus 64
        times the size of the packed file.
    max_triangles : int, optional
        Maximum number of triangles, counted over all instances. Without it, the limit is 2^31. In
        files with instances it is 16 triangles per byte of the file, at least 2^20 and at most
        2^24, or 4 per byte if that is more.

    Returns
    -------
    Mesh
        In the frame of the file, with vertices in the given unit or in that of the file.

    Raises
    ------
    OSError
        If the file cannot be read or is not a regular file; `FileNotFoundError` if it does not
        exist.
    InputError
        If the content is invalid; the error names the line, byte or entry. If a limit is exceeded,
        `InputError.kind` is ``"too-many"``.

    Warns
    -----
    LoadWarning
        If a part of the file was skipped, or if the mesh has no faces.

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
    path = path_of(path, "path")
    model = _model(path, unit, max_bytes, max_triangles)
    return Mesh._of(model, origin_of(model, path))


def load_scene(
    path: str | os.PathLike[str],
    unit: str | None = None,
    *,
    max_bytes: int | None = None,
    max_triangles: int | None = None,
) -> Scene:
    r"""Load the parts of a file as a scene of named meshes, all in the frame of the file.

    Parameters
    ----------
    path : str or os.PathLike
        As for `load`.
    unit : {"um", "mm", "cm", "in", "ft", "m"}, optional
        As for `load`.
    max_bytes, max_triangles : int, optional
        As for `load`.

    Returns
    -------
    Scene
        Parts have the names and the order of the file. If a name is missing or already used, a
        number is added. All meshes are in the frame of the file, in the given unit: transforms in
        the file are applied once, and each instance of a shape becomes a mesh of its own.
        ``scene.parts[name].origin`` returns the polygons of the faces.

    Raises
    ------
    OSError, InputError
        As for `load`.

    Warns
    -----
    LoadWarning
        If a part of the file was skipped, or if the file has no faces.

    Examples
    --------
    >>> import impinge, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "two.obj"
    ...     vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    ...     _ = path.write_text(vertices + "o floor\nf 1 2 3\no wall\nf 1 2 4\n")
    ...     scene = impinge.load_scene(path)
    >>> scene, scene.check().names()
    (Scene(2 parts, 1 pairs), [('floor', 'wall')])
    """
    path = path_of(path, "path")
    model = _model(path, unit, max_bytes, max_triangles)
    vertices, faces, part_of, sources = model.vertices, model.faces, model.part_of, model.sources
    order = np.argsort(part_of, kind="stable")
    ends = np.searchsorted(part_of[order], np.arange(len(model.parts) + 1))
    parts: dict[str, Mesh] = {}
    for number, given in enumerate(model.parts):
        rows = order[ends[number] : ends[number + 1]]
        used, corners = np.unique(faces[rows], return_inverse=True)
        mesh = Mesh(vertices[used], corners.reshape(-1, 3))
        name = _unique_name(given, number, parts)
        mesh._origin = Origin(path, model.format, model.unit, sources[rows], np.zeros(len(rows), np.uint32), (name,))
        parts[name] = mesh
    return Scene(parts)


def _unique_name(given: str, number: int, taken: dict[str, Mesh]) -> str:
    name, count = given or f"part {number}", 2
    while name in taken:
        name, count = f"{given or f'part {number}'} ({count})", count + 1
    return name


def _model(path: str, unit: str | None, max_bytes: int | None, max_triangles: int | None) -> _impinge.Model:
    """Read a file; for each part that was skipped, warn at the caller of the public function."""
    if unit is not None and not isinstance(unit, str):
        raise InputError(f"must be a str, not {type(unit).__name__}", kind="unit", what="unit")
    limits = {"max_bytes": max_bytes, "max_triangles": max_triangles}
    checked = {name: None if limit is None else whole(limit, name) for name, limit in limits.items()}
    model = _impinge.Model(path, unit, **checked)
    for warning in model.warnings:
        warnings.warn(f"{path}: {warning}", LoadWarning, stacklevel=3)
    if len(model.part_of) == 0:
        warnings.warn(f"{path}: the mesh has no faces, so it intersects nothing", LoadWarning, stacklevel=3)
    return model
