"""Solids that are no meshes: spheres, capsules, cylinders, cones, ellipsoids, half-spaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _bodies
from impinge._arrays import plain_reals
from impinge._errors import InputError
from impinge._scalars import real
from impinge._shape import Shape
from impinge.fcl._geometry import CollisionGeometry


class _Solid(CollisionGeometry):
    def __init__(self, shape: Shape) -> None:
        super().__init__()
        self._body = _bodies.Body.of_shape(shape)


class Sphere(_Solid):
    """A ball about the origin."""

    def __init__(self, radius: float) -> None:
        self.radius = real(radius, "radius")
        super().__init__(Shape.sphere(self.radius))


class Capsule(_Solid):
    """All within a radius of the segment along z, of length `lz`, that the origin is in the middle of."""

    def __init__(self, radius: float, lz: float) -> None:
        self.radius, self.lz = real(radius, "radius"), real(lz, "lz")
        super().__init__(Shape.capsule([0, 0, -self.lz / 2], [0, 0, self.lz / 2], self.radius))


class Cylinder(_Solid):
    """A cylinder along z, of length `lz`, that the origin is in the middle of."""

    def __init__(self, radius: float, lz: float) -> None:
        self.radius, self.lz = real(radius, "radius"), real(lz, "lz")
        super().__init__(Shape.cylinder(self.lz / 2, self.radius))


class Cone(_Solid):
    """A cone along z, of height `lz`, its base at ``-lz / 2`` and its tip at ``lz / 2``."""

    def __init__(self, radius: float, lz: float) -> None:
        self.radius, self.lz = real(radius, "radius"), real(lz, "lz")
        super().__init__(Shape.cone(self.lz / 2, self.radius))


class Ellipsoid(_Solid):
    """An ellipsoid about the origin with these half-lengths of its axes."""

    def __init__(self, x: float, y: float, z: float) -> None:
        self.radii: NDArray[np.float64] = np.array([real(x, "x"), real(y, "y"), real(z, "z")])
        super().__init__(Shape.ellipsoid(self.radii))


class Halfspace(_Solid):
    """All points x with ``n @ x <= d``, once both are divided by the length of `n`."""

    def __init__(self, n: ArrayLike, d: float) -> None:
        normal, level = plain_reals(n, "n", (3,)), real(d, "d")
        length = float(np.linalg.norm(normal))
        if normal.shape != (3,) or not 0 < length < np.inf:
            raise InputError(f"{n!r} is no direction", kind="shape", what="n")
        super().__init__(Shape.half_space(normal / length, level / length))
        self.n, self.d = normal / length, level / length
