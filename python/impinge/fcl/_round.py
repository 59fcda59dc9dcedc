"""Solids without meshes: spheres, capsules, cylinders, cones, ellipsoids and half-spaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge._arrays import plain_reals
from impinge._errors import InputError
from impinge._scalars import real
from impinge._shape import Shape
from impinge.fcl._geometry import CollisionGeometry


class _Solid(CollisionGeometry):
    def __init__(self, shape: Shape) -> None:
        super().__init__()
        self._complete(shape, solid=True)


class Sphere(_Solid):
    """A solid sphere with a radius of at least zero, centered at the origin of its frame."""

    def __init__(self, radius: float) -> None:
        self.radius = real(radius, "radius")
        super().__init__(Shape.sphere(self.radius))


class Capsule(_Solid):
    """A capsule: all points within `radius` of a centered segment of length `lz` along z."""

    def __init__(self, radius: float, lz: float) -> None:
        self.radius, self.lz = real(radius, "radius"), real(lz, "lz")
        super().__init__(Shape.capsule([0, 0, -self.lz / 2], [0, 0, self.lz / 2], self.radius))


class Cylinder(_Solid):
    """A solid cylinder of `radius` and length `lz` along z, centered at the origin of its frame."""

    def __init__(self, radius: float, lz: float) -> None:
        self.radius, self.lz = real(radius, "radius"), real(lz, "lz")
        super().__init__(Shape.cylinder(self.lz / 2, self.radius))


class Cone(_Solid):
    """A solid cone of height `lz` along z: base of `radius` at ``-lz / 2``, tip at ``lz / 2``."""

    def __init__(self, radius: float, lz: float) -> None:
        self.radius, self.lz = real(radius, "radius"), real(lz, "lz")
        super().__init__(Shape.cone(self.lz / 2, self.radius))


class Ellipsoid(_Solid):
    """A solid ellipsoid with half-axes `x`, `y` and `z`, centered at the origin of its frame.

    The attribute `radii` holds the three half-axes.
    """

    def __init__(self, x: float, y: float, z: float) -> None:
        self.radii: NDArray[np.float64] = np.array([real(x, "x"), real(y, "y"), real(z, "z")])
        super().__init__(Shape.ellipsoid(self.radii))


class Halfspace(_Solid):
    """The half-space of all points x, in its own frame, with ``n @ x <= d``.

    The attributes `n` and `d` are the arguments, divided by the length of `n`. An `InputError` is
    raised if `n` is zero or not finite.
    """

    def __init__(self, n: ArrayLike, d: float) -> None:
        normal, level = plain_reals(n, "n", (3,)), real(d, "d")
        length = float(np.linalg.norm(normal))
        if normal.shape != (3,) or not 0 < length < np.inf:
            raise InputError(f"must be a finite nonzero (3,) vector, not {n!r}", kind="shape", what="n")
        super().__init__(Shape.half_space(normal / length, level / length))
        self.n, self.d = normal / length, level / length
