"""Motions of rigid bodies, and the time at which two moving bodies first touch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._engine import engine
from impinge._errors import InputError
from impinge._points import scalar
from impinge._rows import Solid
from impinge._scalars import flag, real
from impinge._shape import AnyShape

if TYPE_CHECKING:
    from impinge.cluster import Cluster


@final
class Motion(_impinge.MotionBase):
    """Poses of a rigid body from time 0 to time 1; or many such motions, in leading axes.

    Between two poses the origin of the body's frame moves along a line at constant velocity, and
    the body rotates about it by the smallest angle at constant angular velocity. Use `Motion.screw`
    for any other motion with constant velocities.

    Parameters
    ----------
    pose_t0, pose_t1 : (..., 4, 4) array_like of float32 or float64, or None
        World from body at the start and at the end; None is the identity. If their linear parts
        differ, both poses must be rigid within 1e-4. The leading axes of both broadcast as in
        NumPy.

    Raises
    ------
    InputError
        If a pose is invalid or not rigid; the error names the pose.

    Examples
    --------
    >>> import impinge
    >>> motion = impinge.Motion(impinge.pose([0, 0, 0]), impinge.pose([4, 0, 0]))
    >>> motion.at(0.25)[:3, 3]
    array([1., 0., 0.])
    """

    __slots__ = ("_made_of",)
    _made_of: tuple[NDArray[np.float64] | None, ...]
    """Constructor arguments: two poses; or a pose, both velocities and the pivot or None."""

    def __new__(cls, pose_t0: ArrayLike | None, pose_t1: ArrayLike | None) -> Motion:
        """Validate the poses."""
        start, end = _pose(pose_t0, "pose_t0"), _pose(pose_t1, "pose_t1")
        lead = _common({"pose_t0": start.shape[:-2], "pose_t1": end.shape[:-2]})
        self = super().__new__(cls, _broadcast(start, lead, 2), _broadcast(end, lead, 2), None)
        self._made_of = start.copy(), end.copy()
        return self

    @classmethod
    def screw(
        cls, pose_t0: ArrayLike | None, linear: ArrayLike, angular: ArrayLike, pivot: ArrayLike | None = None
    ) -> Motion:
        """Return a motion that rotates about a moving axis, both at constant velocity.

        The body may make any number of turns.

        Parameters
        ----------
        pose_t0 : (..., 4, 4) array_like of float32 or float64, or None
            World from body at the start.
        linear : (..., 3) array_like of float32 or float64
            Translation of the pivot from time 0 to time 1, in world units, in the world frame.
        angular : (..., 3) array_like of float32 or float64
            Rotation of the body from time 0 to time 1, in the world frame: the unit axis times the
            angle in radians, at most 2^20.
        pivot : (..., 3) array_like of float32 or float64, optional
            A point of the axis at the start, in the world frame. The default is the origin of the
            body's frame.

        Returns
        -------
        Motion
            The leading axes of all arrays broadcast as in NumPy.

        Raises
        ------
        InputError
            As for `Motion`, or if a vector is not finite or out of range.

        Examples
        --------
        >>> import numpy as np, impinge
        >>> half_turn = impinge.Motion.screw(None, [0, 0, 0], [0, 0, np.pi], pivot=[1, 0, 0])
        >>> round(float(half_turn.at(1.0)[0, 3]), 9)
        2.0
        """
        start = _pose(pose_t0, "pose_t0")
        vectors = {
            "linear": _arrays.plain_points(linear, "linear"),
            "angular": _arrays.plain_points(angular, "angular"),
        }
        if pivot is not None:
            vectors["pivot"] = _arrays.plain_points(pivot, "pivot")
        lead = _common({"pose_t0": start.shape[:-2], **{name: vector.shape[:-1] for name, vector in vectors.items()}})
        spread = {name: _broadcast(vector, lead, 1) for name, vector in vectors.items()}
        screw = (spread["linear"], spread["angular"], spread.get("pivot"))
        self = super().__new__(cls, _broadcast(start, lead, 2), None, screw)
        pivots = vectors["pivot"].copy() if pivot is not None else None
        self._made_of = start.copy(), vectors["linear"].copy(), vectors["angular"].copy(), pivots
        return self

    def at(self, t: float) -> NDArray[np.float64]:
        """Return the poses at a time from 0 to 1, world from body, (..., 4, 4), rounded.

        At time 0 the result is exactly the first pose. A time outside of [0, 1] gives the pose at
        the nearer end.

        Raises
        ------
        InputError
            If the time is not a number.
        """
        return self.poses_at(real(t, "t"))

    def __repr__(self) -> str:
        """Return the leading axes, if there are any."""
        return f"Motion(shape={tuple(self.shape)})" if self.shape else "Motion()"

    def __copy__(self) -> Motion:
        """Return the motion, which never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Motion:
        """Return the motion, which never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the constructor arguments."""
        return constructor(self._made_of), self._made_of


_POSES = 2
"""Number of constructor arguments of a motion between two poses."""


def constructor(made_of: Sequence[Any]) -> Callable[..., Motion]:
    """Return the constructor of a motion with some arguments."""
    return Motion if len(made_of) == _POSES else Motion.screw


@dataclass(frozen=True, eq=False)
class Impact:
    """Time at which two bodies first touch; arrays if the motions have leading axes.

    Times are from 0, the start of the motions, to 1, their end.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether contact is possible: False only if it is disproved for all of [0, 1].
    t_lower : float or (...) float64 array
        Lower bound in [0, 1]: the bodies are apart before this time. Infinite if and only if `hit`
        is False.
    t_upper : float or (...) float64 array
        Upper bound in [0, 1]: the bodies touch no later than this time. Infinite if contact is not
        proved.
    point : (..., 3) float64 array
        Point at which the bodies first touch, in the world frame at the time `t_lower`. NaN if they
        do not touch, if they touch at the start (`contacts` has these contacts), or if the limit on
        the work was reached.
    normal : (..., 3) float64 array
        Unit normal there, from the first body to the second; NaN if there is no point.
    parts : (..., 2) int64 array
        Part of each body that touches, 0 if it is not a compound; -1 if there is no point.
    faces : (..., 2) int64 array
        Face of each body that touches; -1 if its part is not a mesh, or if there is no point.
    """

    hit: bool | NDArray[np.bool_]
    t_lower: float | NDArray[np.float64]
    t_upper: float | NDArray[np.float64]
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    parts: NDArray[np.int64]
    faces: NDArray[np.int64]


def time_of_impact(
    a: AnyShape,
    b: AnyShape,
    motion_a: Motion | None = None,
    motion_b: Motion | None = None,
    *,
    solid: Solid = False,
    clearance: float = 0.0,
    ignore_touch: bool = False,
    progress: bool = False,
    on: Cluster | None = None,
) -> Impact:
    """Compute the time at which two meshes or shapes in rigid motion first touch.

    Bodies that touch or overlap at the start give 0. Bodies that pass through each other between
    time 0 and time 1 are found.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things.
    motion_a, motion_b : Motion, optional
        World from body at times 0 to 1. None is a body at rest at the identity. The leading axes
        of both broadcast as in NumPy.
    solid : {False, True, "a", "b"}
        As for `intersects`: a body that starts inside a solid touches it at the start.
    clearance : float
        Distance in world units at which the bodies count as touching.
    ignore_touch : bool
        Whether the bodies may touch. Contact then counts only once they reach into each other, or
        come nearer than the clearance. So bodies that touch at the start may part or slide along
        each other. If a solid mesh touches a shape at the start, that counts as contact.
    progress : bool
        As for `intersects`.
    on : impinge.cluster.Cluster, optional
        As for `intersects`; the rows of motions are divided.

    Returns
    -------
    Impact
        The fields have the leading axes of the motions.

    Raises
    ------
    InputError
        If an argument has an unsupported type, if leading axes do not broadcast, or if the motion
        of a round shape starts at a pose that is not rigid.

    Notes
    -----
    The algorithm halves time and divides both bodies, until planes prove their pieces apart. It
    stops at `t_lower` if the two are nearer to each other than 2^-37 of their sizes, or if the
    limit on the work is reached. At `t_upper` they intersect.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> through = impinge.Motion(impinge.pose([0, 0, 3]), impinge.pose([[0, 0, -1], [0, 0, 1]]))
    >>> impinge.time_of_impact(triangle, triangle, motion_b=through).t_lower.round(6)
    array([0.75,  inf])
    >>> ball, floor = impinge.Shape.sphere(0.5), impinge.Shape.half_space([0, 0, 1])
    >>> fall = impinge.Motion(impinge.pose([0, 0, 2.5]), impinge.pose([0, 0, -1.5]))
    >>> round(impinge.time_of_impact(ball, floor, fall).t_lower, 6)
    0.5
    >>> impinge.time_of_impact(ball, floor, fall).normal
    array([ 0.,  0., -1.])
    >>> slide = impinge.Motion(impinge.pose([0, 0, 0.5]), impinge.pose([9, 0, 0.5]))
    >>> impinge.time_of_impact(ball, floor, slide, ignore_touch=True).hit
    False
    """
    least = real(clearance, "clearance", minimum=0)
    moving = (a, b, motion_a, motion_b, solid, progress)
    found = engine(on).time_of_impact(moving, least, flag(ignore_touch, "ignore_touch"))
    lower, upper, point, normal, parts, faces = found
    return Impact(scalar(lower < np.inf), scalar(lower), scalar(upper), point, normal, parts, faces)


def _pose(pose: ArrayLike | None, name: str) -> NDArray[np.float64]:
    return np.eye(4) if pose is None else _arrays.plain_poses(pose, name)


def _common(shapes: dict[str, tuple[int, ...]]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        named = ", ".join(f"{shape} of {name}" for name, shape in shapes.items())
        message = f"leading axes do not broadcast: {named}"
        raise InputError(message, kind="shape", what=list(shapes)[-1]) from None


def _broadcast(array: NDArray[np.float64], lead: tuple[int, ...], core: int) -> NDArray[np.float64]:
    shape = (*lead, *array.shape[array.ndim - core :])
    return np.ascontiguousarray(np.broadcast_to(array, shape))
