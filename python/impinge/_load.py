"""Loads meshes and scenes from files."""

from __future__ import annotations

import os
import warnings

import numpy as np
from numpy.typing import ArrayLike

from impinge import _arrays, _impinge
from impinge._baked_scene import BakedScene, is_baked_scene
from impinge._details import Details
from impinge._errors import InputError, LoadWarning
from impinge._mesh import Mesh
from impinge._origin import Origin, origin_of
from impinge._scalars import path_of, whole
from impinge._scene import Scene
from impinge._stored import stored_at


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
    # The header is read before the file. So it differs from that of a file that replaces it.
    stored = stored_at(path) if unit is None and path.lower().endswith(".impinge") else None
    model = _model(path, unit, max_bytes, max_triangles)
    mesh = Mesh._of(model, origin_of(model, path))
    mesh._stored = stored
    return mesh


def load_scene(
    path: str | os.PathLike[str],
    unit: str | None = None,
    *,
    file_unit: str | None = None,
    names: str | os.PathLike[str] | None = None,
    origin: ArrayLike | None = None,
    max_bytes: int | None = None,
    max_triangles: int | None = None,
) -> Scene:
    r"""Load the parts of a file as a scene: meshes, which parts share, with poses and details.

    Each mesh of a glTF file is built once, in its own frame, however many parts share it. A part of
    another format has a mesh of its own in the frame of the scene, and the identity as its pose.

    Parameters
    ----------
    path : str or os.PathLike
        As for `load`; or a folder that `Scene.bake` wrote, without other arguments. Its meshes are
        mapped and validated, not built, so they may be larger than memory.
    unit : {"um", "mm", "cm", "in", "ft", "m"}, optional
        As for `load`.
    file_unit : {"um", "mm", "cm", "in", "ft", "m"}, optional
        Unit of the numbers in the file, in place of the one that it states, such as "mm" for a glTF
        file in millimeters, although glTF is in meters.
    names : str or os.PathLike, optional
        A JSON file with keys, types and names of nodes:
        ``{"elements": [{"node": ..., "guid": ..., "type": ..., "name": ...}]}``. Further fields of
        an element become extras.
    origin : (3,) array_like, optional
        Point that becomes the origin of the scene, in the frame of the file and in `unit`. It is
        subtracted in double precision, before any coordinate is rounded. So a model in UTM
        coordinates keeps its millimeters.
    max_bytes, max_triangles : int, optional
        As for `load`. Each mesh counts once.

    Returns
    -------
    Scene
        Parts have the names and the order of the file. If a name is missing or already used, a
        number is added. ``scene.poses[name]`` places a part, and ``scene.details(name)`` returns
        its key, type, path and extras. The key is the ``guid`` in the file of names, else
        ``GlobalId``, ``globalId``, ``guid`` or ``id`` in the extras of the node, else the second
        half of a name like ``IfcWall|2O2Fr$t4X7Zf8NOew3FNr2``, else the names of the nodes around
        the part and its own name, joined by ``/``. Parts with equal keys get ``#2`` and so on, in
        the order of their places. ``scene.parts[name].origin`` returns the polygons of the faces.

    Raises
    ------
    OSError, InputError
        As for `load`, and if the file of names or the origin is invalid.

    Warns
    -----
    LoadWarning
        If a part of the file was skipped, if the file has no faces, or if the file of names names
        nodes that the scene lacks.

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
    >>> scene.details("wall").key
    'wall'
    """
    path = path_of(path, "path")
    if is_baked_scene(path):
        others = {"unit": unit, "names": names, "origin": origin}
        return _baked_scene(path, {**others, "max_bytes": max_bytes, "max_triangles": max_triangles})
    point = None if origin is None else _arrays.plain_shaped(origin, (3,), "origin").tolist()
    sidecar = None if names is None else path_of(names, "names")
    units = (_unit(unit), _unit(file_unit))
    file = _impinge.SceneFile(path, units, point, sidecar, **_limits(max_bytes, max_triangles))
    _warn(path, file.warnings, is_empty=not file.names)
    meshes: dict[int, Mesh] = {}
    shared = file.meshes
    for name, number in zip(file.names, file.mesh_of, strict=True):
        if number not in meshes:
            base, polygons = shared[number]
            part_of = np.zeros(len(polygons), np.uint32)
            meshes[number] = Mesh._of(base, Origin(path, file.format, file.unit, polygons, part_of, (name,)))
    parts = {name: meshes[number] for name, number in zip(file.names, file.mesh_of, strict=True)}
    about = (Details(key, kind, tuple(path), dict(extras)) for key, kind, path, extras in file.details)
    poses = dict(zip(parts, file.poses, strict=True))
    return Scene(parts, poses=poses, details=dict(zip(parts, about, strict=True)))


def _baked_scene(folder: str, others: dict[str, object]) -> Scene:
    """Return the scene in a folder, for which no other argument may be given."""
    for name, value in others.items():
        if value is not None:
            message = "does not apply to a folder that Scene.bake wrote"
            raise InputError(message, kind="option", what=name, hint="pass it when the original file is loaded")
    made = BakedScene(folder)
    return Scene(made.parts, poses=made.poses, details=made.details, ignored=made.ignored, solid=made.solid)


def _model(path: str, unit: str | None, max_bytes: int | None, max_triangles: int | None) -> _impinge.Model:
    """Read a file; for each part that was skipped, warn at the caller of the public function."""
    model = _impinge.Model(path, _unit(unit), **_limits(max_bytes, max_triangles))
    _warn(path, model.warnings, is_empty=len(model.part_of) == 0, level=4)
    return model


def _unit(unit: str | None) -> str | None:
    if unit is not None and not isinstance(unit, str):
        raise InputError(f"must be a str, not {type(unit).__name__}", kind="unit", what="unit")
    return unit


def _limits(max_bytes: int | None, max_triangles: int | None) -> dict[str, int | None]:
    limits = {"max_bytes": max_bytes, "max_triangles": max_triangles}
    return {name: None if limit is None else whole(limit, name) for name, limit in limits.items()}


def _warn(path: str, found: list[str], *, is_empty: bool, level: int = 3) -> None:
    """Warn of skipped content and of a file without faces, at the caller of the public function."""
    for warning in found:
        warnings.warn(f"{path}: {warning}", LoadWarning, stacklevel=level)
    if is_empty:
        warnings.warn(f"{path}: the mesh has no faces, so it intersects nothing", LoadWarning, stacklevel=level)
