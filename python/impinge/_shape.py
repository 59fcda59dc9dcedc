"""Shapes: convex solids such as spheres and boxes, hulls, half-spaces, meshes and compounds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._decomposition import ConvexParts
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._points import RayHit
from impinge._scalars import flag, real


@final
class Shape(_impinge.ShapeBase):
    """A shape in its own frame, made by a constructor such as `sphere`, `capsule`, `box` or `hull`.

    Lengths are in the unit of the shape, finite, at least zero and below 2^128. A shape is
    immutable and takes only a few numbers to store. Bodies and threads may share one. It
    pickles its constructor's arguments; a copy is the shape itself.

    Boxes, triangles, hulls, half-spaces and meshes accept any affine pose. Round shapes require a
    pose that is rigid within 1e-4.

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
        """Raise an error: use the constructor of a kind of shape."""
        hint = "use a constructor such as Shape.sphere(...)"
        raise InputError("Shape() does not make a shape", kind="option", what="Shape", hint=hint)

    @classmethod
    def _of(cls, kind: str, source: Any, numbers: list[float]) -> Shape:
        made: Shape = _impinge.ShapeBase.__new__(cls, kind, source, numbers)
        made._made_of = kind, source, numbers
        return made

    @classmethod
    def sphere(cls, radius: float, center: ArrayLike = (0, 0, 0)) -> Shape:
        """Return a solid sphere; a radius of zero makes it a point.

        Parameters
        ----------
        radius : float
            In the unit of the shape, at least zero.
        center : (3,) array_like of float32 or float64
            In the frame of the shape.

        Raises
        ------
        InputError
            If a number is out of range.
        """
        return cls._of("sphere", _points(center, "center", 1), [real(radius, "radius")])

    @classmethod
    def capsule(cls, start: ArrayLike, end: ArrayLike, radius: float) -> Shape:
        """Return a capsule: all points within a radius of a segment, whose ends may be equal.

        Parameters
        ----------
        start, end : (3,) array_like of float32 or float64
            Ends of the segment, in the frame of the shape.
        radius : float
            In the unit of the shape, at least zero.

        Raises
        ------
        InputError
            If a number is out of range.
        """
        ends = np.concatenate([_points(start, "start", 1), _points(end, "end", 1)])
        return cls._of("capsule", ends, [real(radius, "radius")])

    @classmethod
    def tapered_capsule(cls, start: ArrayLike, end: ArrayLike, radii: tuple[float, float]) -> Shape:
        """Return a tapered capsule: the convex hull of two spheres, such as an upper arm.

        If one sphere contains the other, the shape is the larger sphere.

        Parameters
        ----------
        start, end : (3,) array_like of float32 or float64
            Centers of the spheres, in the frame of the shape. They may be equal.
        radii : (float, float)
            Radii at the start and at the end, in the unit of the shape, at least zero.

        Raises
        ------
        InputError
            If a number is out of range.

        Examples
        --------
        >>> import impinge
        >>> impinge.Shape.tapered_capsule([0, 0, 0], [0, 0, 2], [0.5, 0.25]).bounds
        array([[-0.5 , -0.5 , -0.5 ],
               [ 0.5 ,  0.5 ,  2.25]])
        """
        ends = np.concatenate([_points(start, "start", 1), _points(end, "end", 1)])
        return cls._of("tapered_capsule", ends, _pair(radii, "radii"))

    @classmethod
    def box(cls, half_extents: ArrayLike) -> Shape:
        """Return a solid box centered at the origin, aligned with the axes.

        Parameters
        ----------
        half_extents : (3,) array_like of float32 or float64
            Half the lengths along the axes, in the unit of the shape, at least zero.

        Raises
        ------
        InputError
            If a number is out of range.
        """
        return cls._of("box", None, _three(half_extents, "half_extents"))

    @classmethod
    def cylinder(cls, half_height: float, radius: float) -> Shape:
        """Return a solid cylinder about the z axis, from ``-half_height`` to ``half_height``.

        Parameters
        ----------
        half_height, radius : float
            In the unit of the shape, at least zero.

        Raises
        ------
        InputError
            If a number is out of range.
        """
        return cls._of("cylinder", None, [real(half_height, "half_height"), real(radius, "radius")])

    @classmethod
    def cone(cls, half_height: float, radius: float) -> Shape:
        """Return a solid cone about the z axis: base at ``-half_height``, tip at ``half_height``.

        Parameters
        ----------
        half_height, radius : float
            Half the height and the radius of the base, in the unit of the shape, at least zero.

        Raises
        ------
        InputError
            If a number is out of range.
        """
        return cls._of("cone", None, [real(half_height, "half_height"), real(radius, "radius")])

    @classmethod
    def ellipsoid(cls, half_axes: ArrayLike) -> Shape:
        """Return a solid ellipsoid centered at the origin, aligned with the axes.

        Parameters
        ----------
        half_axes : (3,) array_like of float32 or float64
            Half the lengths along the axes, in the unit of the shape, at least zero.

        Raises
        ------
        InputError
            If a number is out of range.
        """
        return cls._of("ellipsoid", None, _three(half_axes, "half_axes"))

    @classmethod
    def triangle(cls, corners: ArrayLike) -> Shape:
        """Return a triangle, which may have no area.

        Parameters
        ----------
        corners : (3, 3) array_like of float32 or float64
            In the frame of the shape.

        Raises
        ------
        InputError
            If a number is out of range.
        """
        return cls._of("triangle", _points(corners, "corners", 3), [])

    @classmethod
    def half_space(cls, normal: ArrayLike, level: float = 0.0) -> Shape:
        """Return the half-space of all points x with ``normal @ x <= level``, such as a floor.

        Parameters
        ----------
        normal : (3,) array_like of float32 or float64
            Normal out of the half-space, in the frame of the shape, with a length of at least
            2^-600. It points up for a floor.
        level : float
            Distance of the plane from the origin along the normal, times the length of the normal,
            in the unit of the shape.

        Raises
        ------
        InputError
            If a number is out of range, or if the normal is zero.
        """
        return cls._of("half_space", _points(normal, "normal", 1), [real(level, "level")])

    @classmethod
    def hull(cls, points: ArrayLike) -> Shape:
        """Return the convex hull of points, which may be flat, a segment or a point.

        Parameters
        ----------
        points : (n, 3) array_like of float32 or float64
            At least one point, in the frame of the shape.

        Raises
        ------
        InputError
            If there are no points, or if a number is out of range.
        """
        return cls._of("hull", _points(points, "points", None), [])

    @classmethod
    def mesh(cls, mesh: Mesh, *, solid: bool = False) -> Shape:
        """Return a mesh as a shape: its surface or, if `solid` is set, the solid that it bounds.

        A solid is the surface and all points with a winding number above 1/2 in magnitude. The
        shape keeps the current state of the mesh: a later `Mesh.refit` does not affect it.

        Parameters
        ----------
        mesh : Mesh
            Shared, not copied.
        solid : bool
            Whether the inside belongs to the shape.

        Raises
        ------
        InputError
            If an argument has the wrong type.
        """
        snapshot = mesh._snapshot() if isinstance(mesh, Mesh) else mesh
        return cls._of("solid" if flag(solid, "solid") else "mesh", snapshot, [])

    @classmethod
    def height_field(
        cls, heights: ArrayLike, spacing: tuple[float, float] = (1.0, 1.0), *, holes: ArrayLike | None = None
    ) -> Shape:
        """Return terrain: a grid of heights, with two triangles for each cell that are not stored.

        The point of row r and column c has x = c * spacing[0], y = r * spacing[1] and its height as
        z. The cell between the points (r, c) and (r + 1, c + 1) has the number
        n = r * (columns - 1) + c. The diagonal from the first of these points to the other divides
        it into face 2 n, on the side of larger x, and face 2 n + 1. The field is the surface of its
        faces, like a mesh that is not solid: it has no inside.

        Parameters
        ----------
        heights : (rows, columns) array_like of float
            At least two rows and two columns, rounded to single precision. In the unit of the
            shape.
        spacing : (float, float)
            Distances of neighboring points along x and along y, above zero.
        holes : (rows - 1, columns - 1) array_like of bool or None
            True for cells without faces.

        Raises
        ------
        InputError
            If an argument has the wrong shape or type, or if a number is out of range.

        Notes
        -----
        A field takes 4 bytes for each height, 0.15 bytes for each cell, and 1 bit for each cell if
        there are holes.

        Examples
        --------
        >>> import impinge
        >>> import numpy as np
        >>> hill = impinge.Shape.height_field(np.array([[0, 0, 0], [0, 1, 0], [0, 0, 0]]))
        >>> impinge.intersects(hill, impinge.Shape.sphere(0.5), pose_b=impinge.pose([1, 1, 1.5]))
        True
        >>> hill.ray_cast([1.25, 1.0, 5.0], [0, 0, -1]).point
        array([1.25, 1.  , 0.75])
        """
        rows = _arrays.plain_heights(heights, "heights")
        rows.setflags(write=False)
        gaps = None
        if holes is not None:
            gaps = _arrays.plain_flags(holes, "holes", (rows.shape[0] - 1, rows.shape[1] - 1))
            gaps.setflags(write=False)
        return cls._of("height_field", (rows, gaps), _pair(spacing, "spacing"))

    @classmethod
    def compound(cls, parts: Iterable[tuple[Shape | Mesh, ArrayLike | None]]) -> Shape:
        """Return the union of several shapes as one shape.

        The pose of a part in the world is the product of the compound's pose and the part's own
        pose, rounded. Answers about a compound are answers about its parts at these poses.

        Parameters
        ----------
        parts : iterable of (Shape or Mesh, (4, 4) array_like or None)
            The shapes, each with its pose, compound from part; None is the identity. A part that is
            itself a compound is replaced by its own parts, each with its own index in contacts.

        Raises
        ------
        InputError
            If there are no parts, if there are more than 2^20 parts, those of nested compounds
            included, or if a pose, or a product of poses, is invalid.

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

    def rounded(self, radius: float) -> Shape:
        """Return the shape grown by a radius on all sides: all points within the radius of it.

        Edges and corners become round, and radii of spheres and capsules add up. To keep the outer
        size of a box, make its half-extents shorter by the radius first.

        Parameters
        ----------
        radius : float
            In the unit of the shape, at least zero.

        Returns
        -------
        Shape
            A shape of the kind ``"rounded"``. It requires a rigid pose unless the radius is zero.

        Raises
        ------
        InputError
            If the radius is out of range, or if the shape is a half-space, a mesh, a height
            field or a compound.

        Examples
        --------
        >>> import impinge
        >>> die = impinge.Shape.box([0.75, 0.75, 0.75]).rounded(0.25)
        >>> die
        Shape.box([0.75, 0.75, 0.75]).rounded(0.25)
        >>> die.ray_cast([5, 0, 0], [-1, 0, 0]).point.round(9)
        array([1., 0., 0.])
        """
        return Shape._of("rounded", self, [real(radius, "radius")])

    @classmethod
    def of_parts(cls, parts: ConvexParts) -> Shape:
        """Return the compound of convex parts, from `Mesh.convex_parts`, in their order."""
        return cls.compound((cls.hull(part.vertices), None) for part in parts.parts)

    @property
    def kind(self) -> str:
        """Name of the method that made the shape, such as ``"sphere"``."""
        kind = self._made_of[0]
        return "mesh" if kind == "solid" else kind

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """Lower and upper corners (2, 3) of a box that contains the shape, in the shape's frame.

        None if the shape is unbounded or empty.
        """
        box = super().local_box()
        return None if box is None else np.array(box)

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> RayHit:
        """Return the first hit of each ray on the shape; its origin if that is inside the shape.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            In the frame and unit of the shape, below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            In the frame of the shape, with a length from 2^-600 to 2^300. The leading axes of both
            broadcast as in NumPy.

        Returns
        -------
        RayHit
            The fields have the leading axes. For convex shapes, a hit is decided as exactly as by
            `impinge.intersects`. The error of ``t`` is at most 2^-36 of the size of the shape, or
            2^-23 for cones, divided by the cosine of the angle of incidence. ``face`` is -1 unless
            the shape is a mesh, and also if the ray starts inside a solid mesh.

        Raises
        ------
        InputError
            If an array has another type or shape, if a number is out of range, or if a direction is
            zero; the error names the entry.

        Examples
        --------
        >>> import impinge
        >>> impinge.Shape.sphere(1).ray_cast([[-3, 0, 0], [0, 0, 0], [-3, 2, 0]], [2, 0, 0]).t.round(9)
        array([ 1.,  0., inf])
        """
        return RayHit(*_impinge.shape_ray_cast(self, origins, directions))

    def __repr__(self) -> str:
        """Return the constructor, with its arguments if there are few."""
        kind, source, numbers = self._made_of
        if kind in ("mesh", "solid"):
            return f"Shape.mesh({source!r}, solid={kind == 'solid'})"
        if kind == "rounded":
            return f"{source!r}.rounded({numbers[0]:g})"
        return f"Shape.{kind}({', '.join(_shown(kind, source, numbers))})"

    def __copy__(self) -> Shape:
        """Return the shape itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Shape:
        """Return the shape itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the constructor's arguments."""
        return Shape._of, self._made_of


AnyShape: TypeAlias = Shape | Mesh
"""A shape, or a mesh, which stands for its surface."""


def snapshot_of(shape: AnyShape) -> AnyShape:
    """Return an immutable shape: for a mesh, its surface in its current state."""
    return Shape.mesh(shape) if isinstance(shape, Mesh) else shape


def _points(value: ArrayLike, name: str, count: int | None) -> NDArray[np.float64]:
    """Return a read-only (k, 3) copy of `count` points; a single point may have shape (3,)."""
    points = np.array(_arrays.plain_points(value, name))
    if count == 1 and points.shape == (3,):
        points = points[None]
    if points.ndim != 2 or (count is not None and len(points) != count):
        wanted = "(3,)" if count == 1 else f"({'n' if count is None else count}, 3)"
        raise InputError(f"has shape {np.shape(value)}; {wanted} is expected", kind="shape", what=name)
    points.setflags(write=False)
    return points


def _three(value: ArrayLike, name: str) -> list[float]:
    numbers: list[float] = _points(value, name, 1)[0].tolist()
    return numbers


def _pair(value: tuple[float, float], name: str) -> list[float]:
    """Return two numbers as a list."""
    numbers = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(numbers, (tuple, list)) or len(numbers) != 2:
        raise InputError("must be two numbers", kind="shape", what=name)
    return [real(number, name) for number in numbers]


def _shown(kind: str, source: Any, numbers: list[float]) -> list[str]:
    """Return the arguments of a constructor as text, or the number of points or parts."""
    if kind in ("hull", "compound"):
        return [f"{len(source)} {'points' if kind == 'hull' else 'parts'}"]
    if kind == "height_field":
        return [f"{' x '.join(map(str, source[0].shape))} heights", f"spacing={tuple(numbers)}"]
    if kind in ("box", "ellipsoid"):
        return [str(numbers)]
    if kind == "sphere":
        return [f"{numbers[0]:g}", *([f"center={source[0].tolist()}"] if source.any() else [])]
    rows = [] if source is None else [str(row.tolist()) for row in source]
    return rows + ([str(numbers)] if kind == "tapered_capsule" else [f"{number:g}" for number in numbers])


def _parts(
    parts: Iterable[tuple[Shape | Mesh, ArrayLike | None]],
) -> list[tuple[Shape | Mesh, NDArray[np.float64] | None]]:
    """Return the parts with immutable shapes and copied poses."""
    try:
        pairs = [(shape, pose) for shape, pose in parts]
    except (TypeError, ValueError):
        message = "must be pairs of a shape and a pose"
        raise InputError(message, kind="type", what="parts") from None
    copied = []
    for row, (shape, pose) in enumerate(pairs):
        copied.append(
            (snapshot_of(shape), None if pose is None else np.array(_arrays.plain_poses(pose, f"parts[{row}]")))
        )
    return copied
