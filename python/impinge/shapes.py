"""What one asks of two shapes: spheres, capsules, boxes, cylinders, cones, ellipsoids, hulls, half-spaces, meshes.

Each verb takes two of `impinge.Shape` or `impinge.Mesh`, which is its surface, and poses whose leading axes broadcast
as those of the verbs on meshes do. What is said of boxes, triangles, hulls, half-spaces and meshes is the truth about
their real images under the given poses, and so it is of spheres and capsules among these where poses are exactly
orthogonal. Of all else a boolean is the truth wherever floats prove it; what touches to within rounding counts as a
hit, and its status is `impinge.Status.UNDECIDED`.

>>> import impinge
>>> ball, floor = impinge.Shape.sphere(1), impinge.Shape.half_space([0, 0, 1])
>>> heights = impinge.pose([[0, 0, 2], [0, 0, 1], [0, 0, 0.5]])
>>> impinge.shapes.intersects(ball, floor, heights)
array([False,  True,  True])
>>> impinge.shapes.penetration(ball, floor, heights).depth.round(9)
array([0. , 0. , 0.5])
"""

from __future__ import annotations

from typing import Any, Literal, Unpack, overload

import numpy as np

from impinge import _impinge
from impinge._contacts import ContactRows, Contacts, contact_rows
from impinge._motion import Impact, Motion
from impinge._points import scalar
from impinge._rows import Booleans, Pose, Raising, Stating, Statuses, beside_status
from impinge._scalars import real, whole
from impinge._shape import AnyShape
from impinge._shape_answers import Penetration, ShapeDistance, penetration_of, shape_distance_of

__all__ = [
    "ContactRows",
    "Contacts",
    "Penetration",
    "ShapeDistance",
    "contacts",
    "distance",
    "intersects",
    "penetration",
    "time_of_impact",
    "within",
]


@overload
def intersects(a: AnyShape, b: AnyShape, pose_a: None = None, pose_b: None = None, **rows: Unpack[Raising]) -> bool: ...
@overload
def intersects(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Raising]
) -> Booleans: ...
@overload
def intersects(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Stating]
) -> tuple[Booleans, Statuses]: ...
def intersects(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Whether two shapes have a point in common; touching counts.

    Parameters
    ----------
    a, b : Shape or Mesh
        The shapes; a mesh is its surface.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from shape; None is the identity. Leading axes broadcast as in NumPy.
    on_error : {"raise", "status"}
        What becomes of a pose that is none, or not rigid where a shape is round. ``"status"`` answers its rows with
        True and returns a status for each row; it also says which answers are undecided.
    progress : bool
        As for `impinge.intersects`.

    Returns
    -------
    bool or (...) bool array
        With ``on_error="status"`` beside a (...) uint8 array of `Status`.

    Raises
    ------
    InputError
        If an argument is none of the above; it says which row and entry.

    Examples
    --------
    >>> import impinge
    >>> pill, crate = impinge.Shape.capsule([0, 0, -1], [0, 0, 1], 0.5), impinge.Shape.box([1, 1, 1])
    >>> impinge.shapes.intersects(crate, pill, pose_b=impinge.pose([1.5, 0, 0]))
    True
    """
    return _impinge.shapes_intersect((a, b, pose_a, pose_b, on_error, progress))


@overload
def within(
    a: AnyShape, b: AnyShape, clearance: float, pose_a: None = None, pose_b: None = None, **rows: Unpack[Raising]
) -> bool: ...
@overload
def within(
    a: AnyShape, b: AnyShape, clearance: float, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Raising]
) -> Booleans: ...
@overload
def within(
    a: AnyShape, b: AnyShape, clearance: float, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Stating]
) -> tuple[Booleans, Statuses]: ...
def within(
    a: AnyShape,
    b: AnyShape,
    clearance: float,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Whether two shapes come within a clearance of each other: closer than it, or equal to it.

    Parameters
    ----------
    a, b : Shape or Mesh
        As for `intersects`.
    clearance : float
        In world units. Nothing is within a negative one.
    pose_a, pose_b, on_error, progress
        As for `intersects`.

    Returns
    -------
    bool or (...) bool array
        Decided as `intersects` is.

    Raises
    ------
    InputError
        As for `intersects`, or if the clearance is no number.
    """
    return _impinge.shapes_within((a, b, pose_a, pose_b, on_error, progress), real(clearance, "clearance"))


@overload
def distance(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Raising]
) -> ShapeDistance: ...
@overload
def distance(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Stating]
) -> tuple[ShapeDistance, Statuses]: ...
def distance(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Return how far apart two shapes are.

    Parameters
    ----------
    a, b, pose_a, pose_b, on_error, progress
        As for `intersects`. Rows with a bad pose have distance zero.

    Returns
    -------
    ShapeDistance
        Its bounds are at most 2^-36 of the distance apart for boxes, triangles, hulls and half-spaces, and about 2^-40
        of the sizes for what is round; up to 2^-23 where a cylinder, a cone or an ellipsoid is turned so that several
        of its points are as near.

    Raises
    ------
    InputError
        As for `intersects`.

    Examples
    --------
    >>> import impinge
    >>> box, ball = impinge.Shape.box([1, 1, 1]), impinge.Shape.sphere(1)
    >>> round(impinge.shapes.distance(box, ball, None, impinge.pose([4, 0, 0])).distance, 9)
    2.0
    """
    answer = _impinge.shape_distance((a, b, pose_a, pose_b, on_error, progress))
    return beside_status(answer, on_error, shape_distance_of)


@overload
def penetration(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Raising]
) -> Penetration: ...
@overload
def penetration(
    a: AnyShape, b: AnyShape, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Stating]
) -> tuple[Penetration, Statuses]: ...
def penetration(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Return how deep two shapes are in each other: the shortest way to take them apart.

    Parameters
    ----------
    a, b, pose_a, pose_b, on_error, progress
        As for `intersects`. Nothing is proved about rows with a bad pose: their depth is from zero to infinity.

    Returns
    -------
    Penetration
        Of two convex shapes its bounds are close; of meshes and compounds the way is searched for, and `upper` takes
        them apart in any case.

    Raises
    ------
    InputError
        As for `intersects`.

    Examples
    --------
    >>> import impinge
    >>> box, ball = impinge.Shape.box([1, 1, 1]), impinge.Shape.sphere(1)
    >>> deep = impinge.shapes.penetration(box, ball, None, impinge.pose([1.5, 0, 0]))
    >>> round(deep.depth, 9), deep.normal
    (0.5, array([1., 0., 0.]))
    """
    answer = _impinge.shape_penetration((a, b, pose_a, pose_b, on_error, progress))
    return beside_status(answer, on_error, penetration_of)


@overload
def contacts(
    a: AnyShape,
    b: AnyShape,
    pose_a: None = None,
    pose_b: None = None,
    *,
    margin: float = 0.0,
    most_points: int = 4,
    **rows: Unpack[Raising],
) -> Contacts: ...
@overload
def contacts(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    margin: float = 0.0,
    most_points: int = 4,
    **rows: Unpack[Raising],
) -> Contacts | ContactRows: ...
@overload
def contacts(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    margin: float = 0.0,
    most_points: int = 4,
    **rows: Unpack[Stating],
) -> tuple[Contacts | ContactRows, Statuses]: ...
def contacts(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    margin: float = 0.0,
    most_points: int = 4,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Return the contacts of two shapes; none exactly where they are not within the margin.

    Parameters
    ----------
    a, b, pose_a, pose_b, on_error, progress
        As for `intersects`. There is nothing to say of rows with a bad pose.
    margin : float
        Points that are at most this far apart are contacts too, in world units.
    most_points : int
        How many contacts with one normal there may be, at least one: the deepest, and those that span the most.

    Returns
    -------
    Contacts or ContactRows
        `Contacts` where a single pose was asked about. Two convex shapes have one normal, what is not convex one for
        each region of contact. Normals of round shapes are those of `penetration` to within 2^-12; cylinders, cones and
        ellipsoids have up to eight points, which may be less deep than others beside them by 2^-13 of the size.

    Raises
    ------
    InputError
        As for `intersects`, or if an option is not in range.

    Examples
    --------
    >>> import impinge
    >>> crate = impinge.Shape.box([0.5, 0.5, 0.5])
    >>> touch = impinge.shapes.contacts(crate, crate, None, impinge.pose([0.25, 0.25, 0.75]))
    >>> len(touch), touch.normal[0], touch.depth
    (4, array([0., 0., 1.]), array([0.25, 0.25, 0.25, 0.25]))
    """
    margin, most_points = real(margin, "margin", least=0), whole(most_points, "most_points", least=1)

    def made(columns: Any) -> Contacts | ContactRows:
        shape, (offsets, all_of_them) = columns
        rows = contact_rows(offsets, all_of_them, tuple(shape))
        return rows if rows.shape else rows.all

    question = (a, b, pose_a, pose_b, on_error, progress)
    return beside_status(_impinge.shape_contacts(question, margin, most_points), on_error, made)


def time_of_impact(
    a: AnyShape,
    b: AnyShape,
    motion_a: Motion | None = None,
    motion_b: Motion | None = None,
    *,
    progress: bool = False,
) -> Impact:
    """Return when two shapes that move first touch.

    Parameters
    ----------
    a, b : Shape or Mesh
        As for `intersects`.
    motion_a, motion_b : Motion, optional
        None rests where its own frame is the world. Leading axes broadcast as in NumPy.
    progress : bool
        As for `intersects`.

    Returns
    -------
    Impact
        Never later than the true first contact.

    Raises
    ------
    InputError
        If an argument is none of the above, or a motion starts at a pose that is not rigid, of a round shape.

    Examples
    --------
    >>> import impinge
    >>> ball, floor = impinge.Shape.sphere(0.5), impinge.Shape.half_space([0, 0, 1])
    >>> fall = impinge.Motion(impinge.pose([0, 0, 2.5]), impinge.pose([0, 0, -1.5]))
    >>> round(impinge.shapes.time_of_impact(ball, floor, fall).t_lower, 6)
    0.5
    """
    t_lower, t_upper = _impinge.shape_time_of_impact((a, b, motion_a, motion_b, progress))
    t_lower, t_upper = scalar(t_lower), scalar(t_upper)
    return Impact(t_lower < np.inf, t_lower, t_upper)
