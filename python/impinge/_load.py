"""Meshes of files."""

from __future__ import annotations

import os
import warnings

import numpy as np

from impinge import _impinge
from impinge._errors import InputError, LoadWarning
from impinge._mesh import Mesh
from impinge._origin import Origin, origin_of
from impinge._scalars import path_of
from impinge._scene import Scene


def load(path: str | os.PathLike[str], unit: str | None = None) -> Mesh:
    r"""Load all triangles of an OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA or baked file as one mesh.

    Numbers keep the precision of the file: f32 stays float32, text is read as the nearest float64. Polygons become
    triangles; `Mesh.origin` says which face is of which polygon and part. A file that `Mesh.bake` or ``impinge bake``
    wrote is opened where it lies, unless its unit has to be converted: it is mapped and proved to be a mesh, not built.
    So is memory that processes share and that has a path, ``/dev/shm/...``; like such a file, it must not be written to
    while it is in use.

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
        If something in the file was left out, or it has no faces.

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
    model = _model(path, unit)
    return Mesh._of(model, origin_of(model, path))


def load_scene(path: str | os.PathLike[str], unit: str | None = None) -> Scene:
    r"""Load the parts of a file as a scene of named meshes, each where the file has it.

    Parameters
    ----------
    path : str or os.PathLike
        As for `load`.
    unit : {"um", "mm", "cm", "in", "ft", "m"}, optional
        As for `load`.

    Returns
    -------
    Scene
        Parts are named as in the file, in its order; where a name is missing or taken, by a number after it. What the
        file poses is posed once and for all: all meshes are in the file's frame, and each instance of a shape is a mesh
        of its own. ``scene.parts[name].origin`` says which polygons the faces are of.

    Raises
    ------
    OSError, InputError
        As for `load`.

    Warns
    -----
    LoadWarning
        If something in the file was left out, or it has no faces.

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
    model = _model(path, unit)
    vertices, faces, part_of, sources = model.vertices, model.faces, model.part_of, model.sources
    order = np.argsort(part_of, kind="stable")
    ends = np.searchsorted(part_of[order], np.arange(len(model.parts) + 1))
    parts: dict[str, Mesh] = {}
    for number, given in enumerate(model.parts):
        rows = order[ends[number] : ends[number + 1]]
        used, corners = np.unique(faces[rows], return_inverse=True)
        mesh = Mesh(vertices[used], corners.reshape(-1, 3))
        name = _free_name(given, number, parts)
        mesh._origin = Origin(path, model.format, model.unit, sources[rows], np.zeros(len(rows), np.uint32), (name,))
        parts[name] = mesh
    return Scene(parts)


def _free_name(given: str, number: int, taken: dict[str, Mesh]) -> str:
    name, count = given or f"part {number}", 2
    while name in taken:
        name, count = f"{given or f'part {number}'} ({count})", count + 1
    return name


def _model(path: str, unit: str | None) -> _impinge.Model:
    """Read a file, with a warning, at the caller of the caller, for all that was left out."""
    if unit is not None and not isinstance(unit, str):
        raise InputError(f"must be a str, not {type(unit).__name__}", kind="unit", what="unit")
    model = _impinge.Model(path, unit)
    for warning in model.warnings:
        warnings.warn(f"{path}: {warning}", LoadWarning, stacklevel=3)
    if len(model.part_of) == 0:
        warnings.warn(f"{path}: the mesh has no faces, so it meets nothing", LoadWarning, stacklevel=3)
    return model
