"""Pictures of two meshes and of their intersection."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge._arrays import plain_poses
from impinge._canvas import Canvas
from impinge._errors import InputError
from impinge._intersections import intersecting_pairs, intersection_curves
from impinge._mesh import Mesh
from impinge._scalars import chosen, real, whole

if TYPE_CHECKING:
    from PIL.Image import Image

_COLORS = np.array([[201.0, 185.0, 170.0], [92.0, 132.0, 176.0]])  # RGB of a, opaque, and of b, transparent
_HIT_COLORS = np.array([[222.0, 92.0, 70.0], [196.0, 60.0, 120.0]])  # RGB of intersecting faces of a and of b
_CURVE_COLOR = np.array([255.0, 176.0, 0.0])  # RGB of the intersection curves
_OPACITY = 0.5  # opacity of b
_SAMPLES = 2  # rendered pixels for each pixel of the picture, along each side
_MARGIN = 1.08  # size of the picture, relative to its content
_CURVE_RADIUS = 1.6  # radius of a curve, in pixels of the picture


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
) -> Image:
    """Render two meshes, their intersecting faces, and the curves in which they intersect.

    `a` is opaque, and `b` is transparent. Intersecting faces are red, curves are yellow. No window
    is opened, and no display is needed. A notebook shows the returned picture; ``.show()`` opens a
    viewer. Requires Pillow (``pip install impinge[show]``).

    Parameters
    ----------
    a, b : Mesh
        The meshes.
    pose_a, pose_b : (4, 4) array_like, optional
        World from mesh; None is the identity.
    path : str or os.PathLike, optional
        A file to write the picture to, in the format of its extension.
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
    PIL.Image.Image
        The picture.

    Raises
    ------
    InputError
        If an argument has another type or shape, or as for `intersects`.
    ModuleNotFoundError
        If Pillow is not installed.

    Notes
    -----
    A million triangles take several seconds.

    Examples
    --------
    >>> import impinge
    >>> floor = impinge.Mesh([[-2, -2, 0], [2, -2, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> wall = impinge.Mesh([[-1, 0, -1], [1, 0, -1], [0, 0, 1]], [[0, 1, 2]])
    >>> impinge.show(floor, wall, size=(320, 240)).size
    (320, 240)
    """
    from PIL import Image  # noqa: PLC0415 (an optional dependency)

    _validate(size, view, up, focus)
    poses = [
        np.eye(4) if pose is None else plain_poses(pose, name)
        for pose, name in ((pose_a, "pose_a"), (pose_b, "pose_b"))
    ]
    for pose, name in zip(poses, ("pose_a", "pose_b"), strict=True):
        if pose.shape != (4, 4):
            raise InputError(f"shape {pose.shape}, where (4, 4) is expected", kind="shape", what=name)
    pairs = np.asarray(intersecting_pairs(a, b, *poses))
    curves: list[NDArray[np.float64]] = intersection_curves(a, b, *poses)
    bodies = [_corners(mesh, pose) for mesh, pose in zip((a, b), poses, strict=True)]

    width, height = (_SAMPLES * pixels for pixels in size)
    turn = _camera(view, up)
    near = [body[np.unique(pairs[:, side])] for side, body in enumerate(bodies)]
    shown = near if focus == "contact" and len(pairs) else bodies
    points = np.concatenate([corners.reshape(-1, 3) for corners in shown] + [np.zeros((0, 3))]) @ turn.T
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.ones(3))
    margin = _MARGIN * (2 if focus == "contact" else 1)
    extent = np.maximum(high - low, 1e-9 * np.abs(points).max(initial=1e-300))
    scale = min(width / extent[0], height / extent[1]) / margin
    middle = low / 2 + high / 2

    def to_pixels(world: NDArray[np.float64]) -> NDArray[np.float64]:
        placed: NDArray[np.float64] = (world @ turn.T - middle) * [scale, -scale, scale] + [width / 2, height / 2, 0]
        return placed

    canvas, transparent = Canvas(width, height), Canvas(width, height)
    for side, layer in ((0, canvas), (1, transparent)):
        colors = np.tile(_COLORS[side], (len(bodies[side]), 1))
        colors[np.unique(pairs[:, side])] = _HIT_COLORS[side]
        layer.triangles(to_pixels(bodies[side]), colors)
    tubes = [to_pixels(curve) for curve in curves]
    for tube in tubes:  # curves behind b, visible through it
        canvas.tube(tube, _CURVE_RADIUS * _SAMPLES, _CURVE_COLOR)
    canvas.blend(transparent, _OPACITY)
    for tube in tubes:
        canvas.tube(tube, _CURVE_RADIUS * _SAMPLES, _CURVE_COLOR)
    picture = Image.fromarray(canvas.pixels(_SAMPLES))
    if path is not None:
        picture.save(path)
    return picture


def _validate(size: tuple[int, int], view: tuple[float, float], up: str, focus: str) -> None:
    for name, value, known in (("up", up, ("y", "z")), ("focus", focus, ("all", "contact"))):
        chosen(value, known, name)
    for name, pair in (("size", size), ("view", view)):
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise InputError(f"must be two numbers, not {type(pair).__name__}", kind="shape", what=name)
    for pixels in size:
        whole(pixels, "size", minimum=16, maximum=8192)
    if np.isinf([real(angle, "view") for angle in view]).any():
        raise InputError("an angle is infinite", kind="non-finite", what="view")


def _corners(mesh: Mesh, pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the corners of the faces in the world frame, (m, 3, 3), rounded."""
    placed: NDArray[np.float64] = (mesh.vertices.astype(float) @ pose[:3, :3].T + pose[:3, 3])[mesh.faces]
    return placed


def _camera(view: tuple[float, float], up: str) -> NDArray[np.float64]:
    """Return the rotation from the world to a frame with x right, y up and z towards the viewer."""
    azimuth, elevation = np.deg2rad(view)
    (sa, ca), (se, ce) = (np.sin(azimuth), np.cos(azimuth)), (np.sin(elevation), np.cos(elevation))
    upright = np.eye(3) if up == "y" else np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    walk = np.array([[ca, 0, -sa], [0, 1, 0], [sa, 0, ca]])
    climb = np.array([[1.0, 0, 0], [0, ce, -se], [0, se, ce]])
    turn: NDArray[np.float64] = climb @ walk @ upright
    return turn
