"""Joints of robots that are made of parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from numpy.typing import ArrayLike

from impinge._errors import InputError
from impinge._scalars import chosen, real

JointKind: TypeAlias = Literal["fixed", "revolute", "continuous", "prismatic", "planar", "floating"]

_KINDS = ("fixed", "revolute", "continuous", "prismatic", "planar", "floating")


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint between two links of a robot, for `Robot.from_parts`.

    Attributes
    ----------
    name : str
        Name, which no other joint of the robot has.
    parent, child : str
        Names of the two links.
    kind : {"fixed", "revolute", "continuous", "prismatic", "planar", "floating"}
        How the child moves: not at all; about the axis, with or without limits; along the axis; in
        the plane across the axis and about it (``x``, ``y``, ``theta``); or freely (``x``, ``y``,
        ``z``, and a quaternion ``qx``, ``qy``, ``qz``, ``qw``).
    origin : (4, 4) array_like or None
        Parent from joint: where the child is when its coordinates are zero. None is the identity.
    axis : tuple of float
        Axis in the frame of the joint, of any length but zero.
    limits : tuple of float or None
        Lower and upper limit, in radians or units of length. None is no limit.
    mimic : tuple of (str, float, float) or None
        Joint that this joint follows, a multiplier and an offset.

    Examples
    --------
    >>> import impinge
    >>> impinge.Joint("slide", "base", "carriage", "prismatic", axis=(0, 0, 1), limits=(0, 0.5)).kind
    'prismatic'
    """

    name: str
    parent: str
    child: str
    kind: JointKind = "fixed"
    origin: ArrayLike | None = None
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    limits: tuple[float, float] | None = None
    mimic: tuple[str, float, float] | None = None

    def _row(self) -> tuple[Any, ...]:
        """Return the joint as the extension takes it."""
        what = f"joint {self.name!r}"
        chosen(self.kind, _KINDS, f"{what}: kind")
        for value in (self.name, self.parent, self.child):
            if not isinstance(value, str):
                raise InputError(f"names must be str, not {type(value).__name__}", kind="type", what=what)
        try:
            x, y, z = self.axis
            axis = [real(x, what), real(y, what), real(z, what)]
            limits = None if self.limits is None else [real(x, what) for x in self.limits]
            mimic = (
                None if self.mimic is None else (self.mimic[0], real(self.mimic[1], what), real(self.mimic[2], what))
            )
            if limits is not None and len(limits) != 2:
                raise ValueError
        except (TypeError, ValueError, IndexError) as error:
            if isinstance(error, InputError):
                raise
            message = "the axis has 3 numbers, limits have 2, and mimic is a name with 2 numbers"
            raise InputError(message, kind="type", what=what) from None
        return (self.name, self.kind, self.parent, self.child, self.origin, axis, limits, mimic)
