"""Poses from translations and rotations."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge._arrays import plain_reals
from impinge._errors import InputError

_TOLERANCE = 1e-3
"""Maximum deviation of a quaternion's length from 1. Quaternions printed with three decimal digits
pass; one that was never normalized is rejected."""


def pose(
    t: ArrayLike = (0.0, 0.0, 0.0),
    *,
    quat_wxyz: ArrayLike | None = None,
    quat_xyzw: ArrayLike | None = None,
    rpy: ArrayLike | None = None,
    rotation: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Return the pose, world from local, that rotates and then translates.

    All arguments may have leading axes, which broadcast as in NumPy.

    Parameters
    ----------
    t : (..., 3) array_like
        The translation, in world units.
    quat_wxyz, quat_xyzw : (..., 4) array_like, optional
        A unit quaternion, real part first or last. Its length must be within 1e-3 of 1; the
        quaternion is normalized. Half and quarter turns about the axes are exact.
    rpy : (..., 3) array_like, optional
        Roll, pitch and yaw in radians, as in URDF: rotations about the fixed x, y and z axes, in
        that order.
    rotation : (..., 3, 3) array_like, optional
        The linear part itself, rows first, for column vectors. It is used unchanged, and may scale
        or shear.

    Returns
    -------
    (..., 4, 4) float64 array
        Rows first, for column vectors: ``world = pose @ [x, y, z, 1]``.

    Raises
    ------
    InputError
        If more than one rotation is given, if an argument has another shape or is not finite, or if
        a quaternion does not have unit length.

    Examples
    --------
    >>> import impinge
    >>> impinge.pose([1, 2, 3], quat_wxyz=[0, 0, 0, 1])
    array([[-1.,  0.,  0.,  1.],
           [ 0., -1.,  0.,  2.],
           [ 0.,  0.,  1.,  3.],
           [ 0.,  0.,  0.,  1.]])
    """
    given = {"quat_wxyz": quat_wxyz, "quat_xyzw": quat_xyzw, "rpy": rpy, "rotation": rotation}
    chosen = {name: value for name, value in given.items() if value is not None}
    if len(chosen) > 1:
        message = f"{' and '.join(chosen)} are both given; pass one rotation at most"
        raise InputError(message, kind="option", what=next(iter(chosen)))
    translation = plain_reals(t, "t", (3,))
    if quat_wxyz is not None:
        linear = _of_quaternion(plain_reals(quat_wxyz, "quat_wxyz", (4,)), "quat_wxyz")
    elif quat_xyzw is not None:
        linear = _of_quaternion(np.roll(plain_reals(quat_xyzw, "quat_xyzw", (4,)), 1, axis=-1), "quat_xyzw")
    elif rpy is not None:
        linear = _of_angles(plain_reals(rpy, "rpy", (3,)))
    elif rotation is not None:
        linear = plain_reals(rotation, "rotation", (3, 3))
    else:
        linear = np.eye(3)
    try:
        lead = np.broadcast_shapes(translation.shape[:-1], linear.shape[:-2])
    except ValueError:
        message = f"leading axes {translation.shape[:-1]} do not broadcast with {linear.shape[:-2]}, the rotation's"
        raise InputError(message, kind="shape", what="t") from None
    made = np.zeros((*lead, 4, 4))
    made[..., :3, :3] = linear
    made[..., :3, 3] = translation
    made[..., 3, 3] = 1.0
    return made


def _of_quaternion(wxyz: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    squared = (wxyz * wxyz).sum(axis=-1)
    length = np.sqrt(squared)
    broken = np.argwhere(np.abs(length - 1.0) > _TOLERANCE)
    if len(broken):
        at = tuple(map(int, broken[0]))
        message = f"the quaternion has length {length[at]:.6g}, not 1"
        raise InputError(message, kind="not-unit-quaternion", what=name, where=at, hint="normalize it")
    w, x, y, z = np.moveaxis(wxyz, -1, 0)
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    rotation: NDArray[np.float64] = np.moveaxis(np.array(rows), (0, 1), (-2, -1)) / squared[..., None, None]
    rotation += 0.0  # replaces negative zeros with positive ones
    return rotation


def _of_angles(rpy: NDArray[np.float64]) -> NDArray[np.float64]:
    (sr, sp, sy), (cr, cp, cy) = np.moveaxis(np.sin(rpy), -1, 0), np.moveaxis(np.cos(rpy), -1, 0)
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
