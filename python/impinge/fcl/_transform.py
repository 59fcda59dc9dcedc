"""Transforms of objects: a rotation and a translation."""

# The names are those of python-fcl.
# ruff: noqa: N802, N803

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._arrays import plain_reals, plain_shaped
from impinge._errors import InputError
from impinge._pose import pose


class Transform(_impinge.TransformBase):
    """A rotation, then a translation: a pose, world from geometry.

    Made by ``Transform()``, ``Transform(other)``, ``Transform(R)``, ``Transform(q)``,
    ``Transform(t)``, ``Transform(R, t)`` or ``Transform(q, t)``. ``R`` is a (3, 3) matrix, used
    unchanged; ``q`` is a unit quaternion, real part first; ``t`` is a translation in world units.
    """

    def __init__(self, *args: Transform | ArrayLike) -> None:
        if self._read(args):
            return
        if len(args) > 2:
            message = f"Transform() takes at most 2 arguments, not {len(args)}"
            raise InputError(message, kind="option", what="args")
        value = plain_reals(args[0], "args", ())
        if len(args) == 1 and value.shape == (3,):
            self.setTranslation(value)
            return
        if value.shape == (4,):
            self.setQuatRotation(value)
        else:
            self.setRotation(value)
        if len(args) == 2:
            self.setTranslation(plain_reals(args[1], "args", ()).squeeze())

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Copy of the pose, (4, 4), world from geometry, for column vectors."""
        return super().matrix

    def getRotation(self) -> NDArray[np.float64]:
        """Return a copy of the (3, 3) rotation matrix, world from geometry."""
        return self.matrix[:3, :3].copy()

    def getTranslation(self) -> NDArray[np.float64]:
        """Return a copy of the (3,) translation, world from geometry, in world units."""
        return self.matrix[:3, 3].copy()

    def getQuatRotation(self) -> NDArray[np.float64]:
        """Return the rotation as a unit quaternion, rounded: real part first, at least zero."""
        return quaternion_of(self.matrix[:3, :3])

    def setRotation(self, R: ArrayLike) -> None:
        """Set the (3, 3) rotation matrix, world from geometry, used unchanged.

        Raise an `InputError` if it has another shape or is not finite.
        """
        self._set_linear(R, "R")

    def setTranslation(self, T: ArrayLike) -> None:
        """Set the (3,) translation, world from geometry, in world units.

        Raise an `InputError` if it has another shape or is not finite.
        """
        self._set_translation(T, "T")

    def setQuatRotation(self, q: ArrayLike) -> None:
        """Set the rotation, world from geometry, to that of a quaternion, real part first.

        The quaternion is normalized. Raise an `InputError` unless its length is within 1e-3 of 1.
        """
        self._set_linear(rotation_of(q), "q")

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how to make an equal transform."""
        return type(self), (self.getRotation(), self.getTranslation())


def rotation_of(q: ArrayLike) -> NDArray[np.float64]:
    """Return the (3, 3) rotation of a quaternion with the real part first.

    Raise an `InputError` unless its length is within 1e-3 of 1.
    """
    return pose(quat_wxyz=plain_shaped(q, (4,), "q"))[:3, :3]


def quaternion_of(r: NDArray[np.float64]) -> NDArray[np.float64]:
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
