"""Shapes: spheres, capsules, boxes and their like, hulls, half-spaces, meshes and compounds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._points import RayHit, scalar
from impinge._scalars import flag, real


@final
class Shape(_impinge.ShapeBase):
    """A shape in its own frame, made by one of its constructors: `sphere`, `capsule`, `box`, `hull` and others.

    Lengths are in the shape's own unit, finite, not negative and below 2^128. A shape never changes, and costs no more
    than a few numbers to keep; many bodies and threads may share one. It pickles by what it was made of; a copy is the
    shape itself.

    Boxes, triangles, hulls, half-spaces and meshes may be put into any affine pose; what is round wants a rigid one
    within 1e-4.

    Examples
    --------
    >>> import impinge
    >>> impinge.Shape.capsule([0, 0, -1], [0, 0, 1], 0.5)
    Shape.capsule([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.5)
    >>> impinge.Shape.capsule([0, 0, -1], [0, 0, 1], 0.5).bounds
    array([[-0.5, -0.5, -1.5],
           [ 0.5,  0.5,  1.5]])
    """

    __slots__ = ("_made_of",)
    _made_of: tuple[str, Any, list[float]]

    def __new__(cls) -> Shape:
        """Raise: shapes are made by the constructors of their kinds."""
        raise InputError(
            "Shape() itself makes nothing", kind="option", what="Shape", hint="Shape.sphere(...) and others do"
        )

    @classmethod
    def _of(cls, kind: str, source: Any, numbers: list[float]) -> Shape:
        made: Shape = _impinge.ShapeBase.__new__(cls, kind, source, numbers)
        made._made_of = kind, source, numbers
        return made

    @classmethod
    def sphere(cls, radius: float, center: ArrayLike = (0, 0, 0)) -> Shape:
        """Return the ball about a center; a radius of zero makes it that point.

        Parameters
        ----------
        radius : float
            At least zero.
        center : (3,) array_like of float32 or float64
            In the shape's own frame.

        Raises
        ------
        InputError
            If a number is not in range.
        """
        return cls._of("sphere", _points(center, "center", 1), [real(radius, "radius")])

    @classmethod
    def capsule(cls, start: ArrayLike, end: ArrayLike, radius: float) -> Shape:
        """Return all points within a radius of a segment, whose ends may be equal.

        Parameters
        ----------
        start, end : (3,) array_like of float32 or float64
            The ends of the segment, in the shape's own frame.
        radius : float
            At least zero.

        Raises
        ------
        InputError
            If a number is not in range.
        """
        ends = np.concatenate([_points(start, "start", 1), _points(end, "end", 1)])
        return cls._of("capsule", ends, [real(radius, "radius")])

    @classmethod
    def box(cls, half_extents: ArrayLike) -> Shape:
        """Return the box about the origin that reaches as far along each axis as its half-extent says.

        Parameters
        ----------
        half_extents : (3,) array_like of float32 or float64
            At least zero.

        Raises
        ------
        InputError
            If a number is not in range.
        """
        return cls._of("box", None, _three(half_extents, "half_extents"))

    @classmethod
    def cylinder(cls, half_height: float, radius: float) -> Shape:
        """Return the cylinder about the z axis, from ``-half_height`` to ``half_height``.

        Parameters
        ----------
        half_height, radius : float
            At least zero.

        Raises
        ------
        InputError
            If a number is not in range.
        """
        return cls._of("cylinder", None, [real(half_height, "half_height"), real(radius, "radius")])

    @classmethod
    def cone(cls, half_height: float, radius: float) -> Shape:
        """Return the cone about the z axis with its base at ``-half_height`` and its tip at ``half_height``.

        Parameters
        ----------
        half_height, radius : float
            At least zero; the radius is that of the base.

        Raises
        ------
        InputError
            If a number is not in range.
        """
        return cls._of("cone", None, [real(half_height, "half_height"), real(radius, "radius")])

    @classmethod
    def ellipsoid(cls, half_axes: ArrayLike) -> Shape:
        """Return the ellipsoid about the origin with its axes along those of the frame.

        Parameters
        ----------
        half_axes : (3,) array_like of float32 or float64
            Half the lengths of its axes, at least zero.

        Raises
        ------
        InputError
            If a number is not in range.
        """
        return cls._of("ellipsoid", None, _three(half_axes, "half_axes"))

    @classmethod
    def triangle(cls, corners: ArrayLike) -> Shape:
        """Return a triangle, which may have no area.

        Parameters
        ----------
        corners : (3, 3) array_like of float32 or float64
            In the shape's own frame.

        Raises
        ------
        InputError
            If a number is not in range.
        """
        return cls._of("triangle", _points(corners, "corners", 3), [])

    @classmethod
    def half_space(cls, normal: ArrayLike, level: float = 0.0) -> Shape:
        """Return all points x with ``normal @ x <= level``: a floor, if the normal points up.

        Parameters
        ----------
        normal : (3,) array_like of float32 or float64
            Of a length from 2^-600 on.
        level : float
            Times the length of the normal.

        Raises
        ------
        InputError
            If a number is not in range, or the normal is zero.
        """
        return cls._of("half_space", _points(normal, "normal", 1), [real(level, "level")])

    @classmethod
    def hull(cls, points: ArrayLike) -> Shape:
        """Return the convex hull of points, which may be flat, a segment or a point.

        Parameters
        ----------
        points : (n, 3) array_like of float32 or float64
            In the shape's own frame; at least one.

        Raises
        ------
        InputError
            If there are none, or a number is not in range.
        """
        return cls._of("hull", _points(points, "points", None), [])

    @classmethod
    def mesh(cls, mesh: Mesh, *, solid: bool = False) -> Shape:
        """Return a mesh as a shape: its surface or, if it is `solid`, all about which it winds more than half.

        The shape keeps the mesh as it is now: a later `Mesh.refit` does not reach it.

        Parameters
        ----------
        mesh : Mesh
            Shared, not copied.
        solid : bool
            Whether the inside belongs to it.

        Raises
        ------
        InputError
            If an argument is none of these.
        """
        still = mesh._as_it_is() if isinstance(mesh, Mesh) else mesh
        return cls._of("solid" if flag(solid, "solid") else "mesh", still, [])

    @classmethod
    def compound(cls, parts: Iterable[tuple[Shape | Mesh, ArrayLike | None]]) -> Shape:
        """Return all of some shapes as one.

        Parameters
        ----------
        parts : iterable of (Shape or Mesh, (4, 4) array_like or None)
            The shapes, each with its pose in the frame of the compound. The parts of a compound among them count one by
            one where contacts number them.

        Raises
        ------
        InputError
            If there are none, or a pose is none.

        Examples
        --------
        >>> import impinge
        >>> end, bar = impinge.Shape.sphere(0.5), impinge.Shape.box([1, 0.125, 0.125])
        >>> left, right = impinge.pose([[-1, 0, 0], [1, 0, 0]])
        >>> dumbbell = impinge.Shape.compound([(end, left), (bar, None), (end, right)])
        >>> dumbbell
        Shape.compound(3 parts)
        >>> far = impinge.distance(dumbbell, impinge.Shape.sphere(0.125), None, impinge.pose([0, 0, 0.5]))
        >>> round(far.distance, 9)
        0.25
        """
        return cls._of("compound", _parts(parts), [])

    @property
    def kind(self) -> str:
        """The name of the constructor."""
        kind = self._made_of[0]
        return "mesh" if kind == "solid" else kind

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """(2, 3) lower and upper corner of a box that holds the shape in its own frame; None where none does."""
        box = super().local_box()
        return None if box is None else np.array(box)

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> RayHit:
        """Return where rays first meet the shape; at their origins, where these are in it.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            In the shape's own frame and unit, below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            Of a length from 2^-600 to 2^300. The leading axes of both broadcast as in NumPy.

        Returns
        -------
        RayHit
            Its fields have the leading axes. Whether convex shapes are met is decided as `impinge.intersects`
            is; ``t`` is within 2^-36 of their sizes, cones' within 2^-23, over the cosine of the angle at which they
            are met. ``face`` is -1 for all but meshes, and where the ray starts in a solid one.

        Raises
        ------
        InputError
            If an array has another type or shape, a number is not in range or a direction is zero; it says which.

        Examples
        --------
        >>> import impinge
        >>> impinge.Shape.sphere(1).ray_cast([[-3, 0, 0], [0, 0, 0], [-3, 2, 0]], [2, 0, 0]).t.round(9)
        array([ 1.,  0., inf])
        """
        hit, t, face, point = _impinge.shape_ray_cast(self, origins, directions)
        return RayHit(scalar(hit), scalar(t), scalar(face), point)

    def __repr__(self) -> str:
        """Return the constructor and, where they are few, its arguments."""
        kind, source, numbers = self._made_of
        if kind in ("mesh", "solid"):
            return f"Shape.mesh({source!r}, solid={kind == 'solid'})"
        if kind in ("hull", "compound"):
            return f"Shape.{kind}({len(source)} {'points' if kind == 'hull' else 'parts'})"
        values = [str(row.tolist()) for row in source] if source is not None and kind != "sphere" else []
        if kind in ("box", "ellipsoid"):
            return f"Shape.{kind}({numbers})"
        if kind == "sphere" and source.any():
            return f"Shape.sphere({numbers[0]:g}, center={source[0].tolist()})"
        return f"Shape.{kind}({', '.join(values + [f'{number:g}' for number in numbers])})"

    def __copy__(self) -> Shape:
        """Return the shape, which never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Shape:
        """Return the shape, which never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle what it was made of."""
        return Shape._of, self._made_of


AnyShape: TypeAlias = Shape | Mesh
"""What the verbs on shapes take; a mesh is its surface."""


def settled(shape: AnyShape) -> AnyShape:
    """Return what never changes: of a mesh its surface as it is now."""
    return Shape.mesh(shape) if isinstance(shape, Mesh) else shape


def _points(value: ArrayLike, name: str, count: int | None) -> NDArray[np.float64]:
    """Return a (k, 3) copy of some points, which are `count`; a single one may come as (3,)."""
    points = np.array(_arrays.plain_points(value, name))
    if count == 1 and points.shape == (3,):
        points = points[None]
    if points.ndim != 2 or (count is not None and len(points) != count):
        wanted = "(3,)" if count == 1 else f"({'n' if count is None else count}, 3)"
        raise InputError(f"shape {np.shape(value)}, where {wanted} is expected", kind="shape", what=name)
    points.setflags(write=False)
    return points


def _three(value: ArrayLike, name: str) -> list[float]:
    numbers: list[float] = _points(value, name, 1)[0].tolist()
    return numbers


def _parts(
    parts: Iterable[tuple[Shape | Mesh, ArrayLike | None]],
) -> list[tuple[Shape | Mesh, NDArray[np.float64] | None]]:
    """Return a list of copies of the parts."""
    try:
        pairs = [(shape, pose) for shape, pose in parts]
    except (TypeError, ValueError):
        message = "must be pairs of a shape and a pose"
        raise InputError(message, kind="type", what="parts") from None
    copied = []
    for row, (shape, pose) in enumerate(pairs):
        copied.append((settled(shape), None if pose is None else np.array(_arrays.plain_poses(pose, f"parts[{row}]"))))
    return copied
