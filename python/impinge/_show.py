"""Pictures of meshes, shapes and scenes."""

from __future__ import annotations

import os
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._arrays import plain_poses
from impinge._errors import InputError
from impinge._intersections import intersecting_pairs
from impinge._mesh import Mesh
from impinge._picture import Picture, angles_of, png_path, size_of
from impinge._scalars import chosen
from impinge._scene import Scene
from impinge._shape import AnyShape


def show(
    a: AnyShape | Scene,
    b: AnyShape | None = None,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    path: str | os.PathLike[str] | None = None,
    size: tuple[int, int] = (960, 720),
    view: tuple[float, float] = (-35.0, 25.0),
    up: Literal["x", "y", "z"] = "z",
    focus: Literal["all", "contact"] = "all",
) -> Picture:
    """Render two meshes with their intersection, or a shape, two shapes, or a scene.

    Of two meshes, `a` is opaque, and `b` is transparent. Intersecting faces are red, and the curves
    in which the meshes intersect are yellow. Everything else is drawn in a few colors, with a scale
    bar and axes. Half-spaces are left out. No window is opened, and no display is needed. A
    notebook shows the returned picture.

    Parameters
    ----------
    a : Mesh, Shape or Scene
        The first mesh or shape, or a scene.
    b : Mesh or Shape, optional
        The second one. A scene is drawn alone.
    pose_a, pose_b : (4, 4) array_like, optional
        World from mesh or shape; None is the identity.
    path : str or os.PathLike, optional
        A PNG file to write the picture to.
    size : (int, int)
        Width and height in pixels, 16 to 8192 each.
    view : (float, float)
        Azimuth and elevation of the camera in degrees. The camera looks at the center, without
        perspective.
    up : {"z", "y", "x"}
        The axis of the world that points up.
    focus : {"all", "contact"}
        Whether the picture of two meshes shows all of them, or only the surroundings of their
        intersection, if there is one.

    Returns
    -------
    Picture
        The picture.

    Raises
    ------
    InputError
        If an argument has another type or shape, if the name of the file does not end in ``.png``,
        or as for `intersects`.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import impinge
    >>> floor = impinge.Mesh([[-2, -2, 0], [2, -2, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> wall = impinge.Mesh([[-1, 0, -1], [1, 0, -1], [0, 0, 1]], [[0, 1, 2]])
    >>> impinge.show(floor, wall, size=(320, 240)).size
    (320, 240)
    >>> impinge.show(impinge.Shape.sphere(1), size=(320, 240))
    Picture(320 x 240)
    """
    chosen(up, ("x", "y", "z"), "up")
    chosen(focus, ("all", "contact"), "focus")
    if path is not None:
        png_path(path)
    options = (size_of(size), angles_of(view), up)
    if isinstance(a, Mesh) and isinstance(b, Mesh):
        poses = _pose(pose_a, "pose_a"), _pose(pose_b, "pose_b")
        pairs = np.asarray(intersecting_pairs(a, b, *poses))
        picture = Picture(_impinge.picture_of_pair((a, b), poses, pairs, options, focus == "contact"))
    else:
        picture = _scene(a, b, pose_a, pose_b)._picture(*options)
    if path is not None:
        picture.save(path)
    return picture


def _scene(a: AnyShape | Scene, b: AnyShape | None, pose_a: ArrayLike | None, pose_b: ArrayLike | None) -> Scene:
    """Return the things of a picture as a scene."""
    if isinstance(a, Scene):
        for given, name in ((b, "b"), (pose_a, "pose_a"), (pose_b, "pose_b")):
            if given is not None:
                raise InputError("a scene is drawn alone", kind="option", what=name)
        return a
    parts = {"a": a} if b is None else {"a": a, "b": b}
    poses = {"a": _pose(pose_a, "pose_a"), "b": _pose(pose_b, "pose_b")}
    return Scene(parts, poses={name: poses[name] for name in parts})


def _pose(pose: ArrayLike | None, name: str) -> NDArray[np.float64]:
    matrix = np.eye(4) if pose is None else plain_poses(pose, name)
    if matrix.shape != (4, 4):
        raise InputError(f"shape {matrix.shape}, where (4, 4) is expected", kind="shape", what=name)
    return matrix
