"""Transforms of objects: a rotation and a translation."""

# The names are those of python-fcl.
# ruff: noqa: N802, N803

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge._arrays import plain_reals
from impinge._errors import InputError
from impinge._pose import pose


class Transform:
    """A rotation, then a translation: a pose, world from geometry.

    Made by ``Transform()``, ``Transform(other)``, ``Transform(R)``, ``Transform(q)``,
    ``Transform(t)``, ``Transform(R, t)`` or ``Transform(q, t)``. ``R`` is a (3, 3) matrix, used
    unchanged; ``q`` is a unit quaternion, real part first; ``t`` is a translation in world units.

    Attributes
    ----------
    matrix : (4, 4) float64 array
        The pose, world from geometry, for column vectors.
    """

    def __init__(self, *args: Transform | ArrayLike) -> None:
        self.matrix: NDArray[np.float64] = np.eye(4)
        if len(args) > 2:
            message = f"Transform() takes at most 2 arguments, not {len(args)}"
            raise InputError(message, kind="option", what="args")
        if len(args) == 2:
            self._rotate(plain_reals(args[0], "args", ()))
            self.setTranslation(plain_reals(args[1], "args", ()).squeeze())
        elif args and isinstance(args[0], Transform):
            self.matrix = args[0].matrix.copy()
        elif args:
            value = plain_reals(args[0], "args", ())
            if value.shape == (3,):
                self.setTranslation(value)
            else:
                self._rotate(value)

    def _rotate(self, value: NDArray[np.float64]) -> None:
        if value.shape == (4,):
            self.setQuatRotation(value)
        else:
            self.setRotation(value)

    def getRotation(self) -> NDArray[np.float64]:
        """Return a copy of the (3, 3) rotation matrix, world from geometry."""
        return self.matrix[:3, :3].copy()

    def getTranslation(self) -> NDArray[np.float64]:
        """Return a copy of the (3,) translation, world from geometry, in world units."""
        return self.matrix[:3, 3].copy()

    def getQuatRotation(self) -> NDArray[np.float64]:
        """Return the rotation as a unit quaternion, rounded: real part first, at least zero."""
        return _quaternion(self.matrix[:3, :3])

    def setRotation(self, R: ArrayLike) -> None:
        """Set the (3, 3) rotation matrix, world from geometry, used unchanged.

        Raise an `InputError` if it has another shape or is not finite.
        """
        self.matrix = pose(self.matrix[:3, 3], rotation=shaped(R, (3, 3), "R"))

    def setTranslation(self, T: ArrayLike) -> None:
        """Set the (3,) translation, world from geometry, in world units.

        Raise an `InputError` if it has another shape or is not finite.
        """
        self.matrix = pose(shaped(T, (3,), "T"), rotation=self.matrix[:3, :3])

    def setQuatRotation(self, q: ArrayLike) -> None:
        """Set the rotation, world from geometry, to that of a quaternion, real part first.

        The quaternion is normalized. Raise an `InputError` unless its length is within 1e-3 of 1.
        """
        self.matrix = pose(self.matrix[:3, 3], quat_wxyz=shaped(q, (4,), "q"))


def shaped(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    """Return a value as a finite float64 array.

    Raise an `InputError` unless it has exactly this shape and all its numbers are finite.
    """
    array = plain_reals(value, name, shape)
    if array.shape != shape:
        raise InputError(f"has shape {array.shape}; {shape} is expected", kind="shape", what=name)
    return array


def _quaternion(r: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the unit quaternion of a rotation, with a real part of at least zero.

    It is a row of the quaternion's outer product with itself: the row with the largest diagonal
    entry, normalized.
    """
    outer = np.array(
        [
            [1 + r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], 1 + r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]],
            [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], 1 - r[0, 0] + r[1, 1] - r[2, 2], r[1, 2] + r[2, 1]],
            [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1 - r[0, 0] - r[1, 1] + r[2, 2]],
        ]
    )
    row = outer[int(np.argmax(np.diagonal(outer)))]
    unit: NDArray[np.float64] = row / np.linalg.norm(row)
    return unit if unit[0] >= 0 else -unit
