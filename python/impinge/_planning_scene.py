"""Loads the obstacles of a planning scene of MoveIt."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping

from impinge import _impinge
from impinge._errors import InputError, LoadWarning
from impinge._robot_arguments import text
from impinge._scalars import path_of, whole
from impinge._scene import Scene
from impinge._shape import Shape


def load_planning_scene(
    path: str | os.PathLike[str],
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
    frame: str | None = None,
    *,
    max_bytes: int | None = None,
    max_triangles: int | None = None,
) -> Scene:
    r"""Load the obstacles of a planning scene of MoveIt, for `Robot.check`.

    The file is the message ``moveit_msgs/PlanningScene`` in YAML, or a ``.scene`` file of MoveIt's
    editor. An object is the union of its boxes, spheres, cylinders, cones and meshes. Closed meshes
    are solids. Lengths are in meters.

    Parameters
    ----------
    path : str or os.PathLike
        The file, whose extension is ``.yaml``, ``.yml`` or ``.scene``.
    packages : mapping of str to str or os.PathLike, optional
        Folders of the packages that ``package://`` URIs of meshes name, as for `Robot.load`.
    frame : str, optional
        Name of the frame of the scene: the root link of the robot. An object of another frame is
        placed by the ``fixed_frame_transforms`` of the file. If these do not have its frame, the
        frame must be that of all such objects, and is taken for the frame of the scene.
    max_bytes, max_triangles : int, optional
        As for `load`, for each file.

    Returns
    -------
    Scene
        Parts have the names and the order of the objects. A shape of the scene pickles the path of
        the file.

    Raises
    ------
    OSError
        If the file cannot be read.
    InputError
        If the file is invalid; if a mesh is missing, ambiguous or invalid; or if a shape is not
        supported, such as a plane or an octomap. The error names the line and the object.

    Warns
    -----
    LoadWarning
        If something was skipped or guessed, or if a mesh is open.

    Examples
    --------
    >>> import impinge, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "cell.yaml"
    ...     shelf = "{id: shelf, primitives: [{type: box, dimensions: [1, 0.5, 0.04]}]}"
    ...     _ = path.write_text(f"world: {{collision_objects: [{shelf}]}}")
    ...     scene = impinge.load_planning_scene(path)
    >>> list(scene.parts)
    ['shelf']
    """
    path = os.path.abspath(path_of(path, "path"))
    given = {} if packages is None else packages
    if not isinstance(given, Mapping):
        raise InputError(f"must be a mapping, not {type(given).__name__}", kind="type", what="packages")
    folders = [(text(name, "packages"), os.path.abspath(path_of(at, "packages"))) for name, at in given.items()]
    name = None if frame is None else text(frame, "frame")
    limits = [(max_bytes, "max_bytes"), (max_triangles, "max_triangles")]
    checked = [None if limit is None else whole(limit, what) for limit, what in limits]
    file = _impinge.PlanningSceneFile(path, folders, name, checked[0], checked[1])
    for message in file.warnings:
        warnings.warn(message, LoadWarning, stacklevel=2)
    parts = {part: Shape._of("obstacle", file, [at]) for at, part in enumerate(file.names)}
    return Scene(parts, poses=dict(zip(parts, file.poses, strict=True)))
