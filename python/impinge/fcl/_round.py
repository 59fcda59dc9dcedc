"""Solids that are no meshes: spheres, capsules, cylinders, cones, ellipsoids, half-spaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _bodies
from impinge._errors import InputError
from impinge._shape import Shape
from impinge.fcl._geometry import CollisionGeometry


class _Solid(CollisionGeometry):
    def __init__(self, shape: Shape) -> None:
        super().__init__()
        self._body = _bodies.Body.of_shape(shape)


class Sphere(_Solid):
    """A ball about the origin."""

    def __init__(self, radius: float) -> None:
        super().__init__(Shape.sphere(radius))
        self.radius = float(radius)


class Capsule(_Solid):
    """All within a radius of the segment along z, of length `lz`, that the origin is in the middle of."""

    def __init__(self, radius: float, lz: float) -> None:
        super().__init__(Shape.capsule([0, 0, -lz / 2], [0, 0, lz / 2], radius))
        self.radius, self.lz = float(radius), float(lz)


class Cylinder(_Solid):
    """A cylinder along z, of length `lz`, that the origin is in the middle of."""

    def __init__(self, radius: float, lz: float) -> None:
        super().__init__(Shape.cylinder(lz / 2, radius))
        self.radius, self.lz = float(radius), float(lz)


class Cone(_Solid):
    """A cone along z, of height `lz`, its base at ``-lz / 2`` and its tip at ``lz / 2``."""

    def __init__(self, radius: float, lz: float) -> None:
        super().__init__(Shape.cone(lz / 2, radius))
        self.radius, self.lz = float(radius), float(lz)


class Ellipsoid(_Solid):
    """An ellipsoid about the origin with these half-lengths of its axes."""

    def __init__(self, x: float, y: float, z: float) -> None:
        super().__init__(Shape.ellipsoid([x, y, z]))
        self.radii: NDArray[np.float64] = np.array([x, y, z], float)


class Halfspace(_Solid):
    """All points x with ``n @ x <= d``, once both are divided by the length of `n`."""

    def __init__(self, n: ArrayLike, d: float) -> None:
        normal = np.asarray(n, float)
        length = float(np.linalg.norm(normal))
        if normal.shape != (3,) or not 0 < length < np.inf:
            raise InputError(f"{n!r} is no direction", kind="shape", what="n")
        super().__init__(Shape.half_space(normal / length, d / length))
        self.n, self.d = normal / length, d / length
