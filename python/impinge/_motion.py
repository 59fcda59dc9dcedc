"""Motions of rigid bodies, and when two bodies that move first touch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._errors import InputError
from impinge._points import scalar
from impinge._rows import Solid
from impinge._scalars import real
from impinge._shape import AnyShape


@final
class Motion(_impinge.MotionBase):
    """Where a rigid body is at each time from 0 to 1; or many such motions, in the leading axes of its arrays.

    From one pose to another the origin of the body's frame moves evenly along a line, and the body turns evenly about
    it by the least angle. `Motion.screw` makes any other even motion.

    Parameters
    ----------
    pose_t0, pose_t1 : (..., 4, 4) array_like of float32 or float64, or None
        World from body at the start and at the end; None is the identity. Where their linear parts differ, both must be
        rigid within 1e-4. The leading axes of both broadcast as in NumPy.

    Raises
    ------
    InputError
        If a pose is none, or not rigid; it says which.

    Examples
    --------
    >>> import impinge
    >>> motion = impinge.Motion(impinge.pose([0, 0, 0]), impinge.pose([4, 0, 0]))
    >>> motion.at(0.25)[:3, 3]
    array([1., 0., 0.])
    """

    __slots__ = ("_made_of",)
    _made_of: tuple[NDArray[np.float64] | None, ...]
    """Two poses; or a pose, both velocities and the pivot, if there is one."""

    def __new__(cls, pose_t0: ArrayLike | None, pose_t1: ArrayLike | None) -> Motion:
        """Judge the poses."""
        start, end = _pose(pose_t0, "pose_t0"), _pose(pose_t1, "pose_t1")
        lead = _common({"pose_t0": start.shape[:-2], "pose_t1": end.shape[:-2]})
        self = super().__new__(cls, _broadcast(start, lead, 2), _broadcast(end, lead, 2), None)
        self._made_of = start.copy(), end.copy()
        return self

    @classmethod
    def screw(
        cls, pose_t0: ArrayLike | None, linear: ArrayLike, angular: ArrayLike, pivot: ArrayLike | None = None
    ) -> Motion:
        """Return the motion of a body that turns evenly about an axis, which moves evenly itself; any number of turns.

        Parameters
        ----------
        pose_t0 : (..., 4, 4) array_like of float32 or float64, or None
            World from body at the start.
        linear : (..., 3) array_like of float32 or float64
            How far the pivot moves in the whole time, in the world frame.
        angular : (..., 3) array_like of float32 or float64
            How far the body turns in the whole time: the axis, times the angle in radians, at most 2^20.
        pivot : (..., 3) array_like of float32 or float64, optional
            A point of the axis at the start, in the world frame; the origin of the body's frame where it is not given.

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
        """Return the poses at a time, (..., 4, 4); exactly the first at 0, and at the nearer end outside of [0, 1].

        Raises
        ------
        InputError
            If the time is no number.
        """
        return self.poses_at(real(t, "t"))

    def __repr__(self) -> str:
        """Return how many motions these are."""
        return f"Motion(shape={tuple(self.shape)})" if self.shape else "Motion()"

    def __copy__(self) -> Motion:
        """Return the motion, which never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Motion:
        """Return the motion, which never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle what it was made of."""
        return (Motion if len(self._made_of) == _POSES else Motion.screw), self._made_of


_POSES = 2
"""What a motion from pose to pose is made of."""


@dataclass(frozen=True, eq=False)
class Impact:
    """When two bodies first touch; arrays where the motions have leading axes.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether contact is to be reckoned with: it is proved, or not disproved.
    t_lower : float or (...) float64 array
        Nothing touches before this time; infinite where contact is disproved for all of [0, 1], and only there.
    t_upper : float or (...) float64 array
        Something touches no later than this; infinite where that is not proved.
    """

    hit: bool | NDArray[np.bool_]
    t_lower: float | NDArray[np.float64]
    t_upper: float | NDArray[np.float64]


def time_of_impact(
    a: AnyShape,
    b: AnyShape,
    motion_a: Motion | None = None,
    motion_b: Motion | None = None,
    *,
    solid: Solid = False,
    progress: bool = False,
) -> Impact:
    """Return when two meshes or shapes that move rigidly first touch.

    Those that touch or overlap at the start give 0; those that pass through each other within the time are
    found.

    Parameters
    ----------
    a, b : Mesh or Shape
        The two things.
    motion_a, motion_b : Motion, optional
        None is a body that rests at the origin. The leading axes of both broadcast as in NumPy.
    solid : {False, True, "a", "b"}
        As for `intersects`: what starts inside a solid touches it at the start.
    progress : bool
        As for `intersects`.

    Returns
    -------
    Impact
        Its fields gain the leading axes of the motions.

    Raises
    ------
    InputError
        If an argument is of another type, leading axes do not broadcast, or a motion starts at a pose that is not
        rigid, of a round shape.

    Notes
    -----
    By conservative advancement over proved distances: nothing touches before `t_lower`, where the two are nearer to
    each other than 2^-37 of their sizes, or the bounded number of steps was spent. `t_upper` is a time at which they
    intersect.

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
    """
    lower, upper = _impinge.time_of_impact((a, b, motion_a, motion_b, solid, progress))
    return Impact(scalar(lower < np.inf), scalar(lower), scalar(upper))


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
