"""Meshes of files."""

from __future__ import annotations

import os
import warnings

from impinge import _impinge
from impinge._errors import LoadWarning
from impinge._mesh import Mesh
from impinge._origin import Origin


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
