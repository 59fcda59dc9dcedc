"""Pictures of two meshes and of their intersection."""

from __future__ import annotations

import os
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from impinge import _impinge
from impinge._arrays import plain_poses
from impinge._errors import InputError
from impinge._intersections import intersecting_pairs
from impinge._mesh import Mesh
from impinge._picture import Picture, png_path, validate_view
from impinge._scalars import chosen


def show(
    a: Mesh,
    b: Mesh,
    pose_a: ArrayLike | None = None,
    pose_b: ArrayLike | None = None,
    *,
    path: str | os.PathLike[str] | None = None,
    size: tuple[int, int] = (960, 720),
    view: tuple[float, float] = (-35.0, 25.0),
    up: Literal["y", "z"] = "z",
    focus: Literal["all", "contact"] = "all",
) -> Picture:
    """Render two meshes, their intersecting faces, and the curves in which they intersect.

    `a` is opaque, and `b` is transparent. Intersecting faces are red, curves are yellow. No window
    is opened, and no display is needed. A notebook shows the returned picture.

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (4, 4) array_like, optional
        World from mesh; None is the identity.
    path : str or os.PathLike, optional
        A PNG file to write the picture to.
    size : (int, int)
        Width and height in pixels, 16 to 8192 each.
    view : (float, float)
        Azimuth and elevation of the camera in degrees. The camera looks at the center, without
        perspective.
    up : {"z", "y"}
        The axis of the world that points up.
    focus : {"all", "contact"}
        Whether the picture shows both meshes, or only the surroundings of their intersection, if
        there is one.

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
    """
    validate_view(size, view, up)
    chosen(focus, ("all", "contact"), "focus")
    if path is not None:
        png_path(path)
    poses = [
        np.eye(4) if pose is None else plain_poses(pose, name)
        for pose, name in ((pose_a, "pose_a"), (pose_b, "pose_b"))
    ]
    for pose, name in zip(poses, ("pose_a", "pose_b"), strict=True):
        if pose.shape != (4, 4):
            raise InputError(f"shape {pose.shape}, where (4, 4) is expected", kind="shape", what=name)
    pairs = np.asarray(intersecting_pairs(a, b, *poses))
    options = ([int(pixels) for pixels in size], [float(angle) for angle in view], up == "y", focus == "contact")
    picture = Picture(_impinge.picture_of_pair((a, b), tuple(poses), pairs, options))
    if path is not None:
        picture.save(path)
    return picture
