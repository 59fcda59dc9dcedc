"""Cuts the sweeps of two things into tasks, by rows of motions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from impinge import _impinge
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._motion import Motion
from impinge.cluster._calls import Call, Rows, column, snapshots
from impinge.cluster._parcels import Parcels

_WORK_OF_SWEEP = 512
"""Estimated work of a row in rows of `intersects`."""


class Sweeps(Call):
    """The times of impact of two things in many motions, cut into runs of motions.

    Parameters
    ----------
    moving : tuple
        The two things, their motions, and the options `solid` and `progress`.
    rest : tuple
        Other arguments.
    axes : sequence of int
        Leading axes of the answer.
    """

    function = "sweeps"
    what = "time_of_impact"

    def __init__(self, moving: tuple[Any, ...], rest: tuple[Any, ...], axes: Sequence[int]) -> None:
        a, b, motion_a, motion_b, self._solid, _ = moving
        self._rest = rest
        self.parts = snapshots([a, b])
        self.names = ("a", "b")
        self.parcels = Parcels(self.parts, range(2))
        made_of = [() if motion is None else motion._made_of for motion in (motion_a, motion_b)]
        self._length = len(made_of[0])
        self._rows = Rows(axes, [*made_of[0], *made_of[1]], _WORK_OF_SWEEP)
        self.count = self._rows.runs

    def parts_of(self, task: int) -> Sequence[int]:
        """Return the two things; the same thing twice is one part."""
        return (0,) if self.parts[0] is self.parts[1] else (0, 1)

    def arguments_of(self, task: int) -> tuple[Any, ...]:
        """Return the arrays that the motions of a task are made of, and the options."""
        arrays = self._rows.of(task)
        return (arrays[: self._length], arrays[self._length :]), self._solid, self._rest

    def _input(self) -> tuple[Any, ...]:
        return self.parts_of(0), self._length, self._solid, self._rest, self._rows.axes, *self._rows.arrays

    def merged(self, answers: Mapping[int, Any]) -> Any:
        """Return the times, the places and the features of all rows."""
        if not self._rows.axes:
            return answers[0]
        columns = zip(*(answers[task] for task in range(self.count)), strict=True)
        return tuple(column(parts, self._rows.axes) for parts in columns)


def leading_axes(moving: tuple[Any, ...]) -> tuple[int, ...]:
    """Validate the arguments of a sweep, and return the leading axes of its answers.

    The extension validates them in sweeps without rows, or of empty meshes. They take no time.
    """
    a, b, motion_a, motion_b, solid, progress = moving
    still = Motion(np.zeros((0, 4, 4)), None)
    no_rows = [still if motion is None or isinstance(motion, Motion) else motion for motion in (motion_a, motion_b)]
    _sweep(a, b, *no_rows, solid, progress)
    nothing = Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    lower, *_ = _sweep(nothing, nothing, motion_a, motion_b, False, False)
    for thing, motion in ((a, motion_a), (b, motion_b)):
        # Any motion is valid for a mesh, and the identity is valid for any shape.
        if motion is not None and not isinstance(thing, Mesh):
            try:
                _impinge.leading_axes((thing, nothing, motion.at(0.0), None, False, "raise", False))
            except InputError:
                _sweep(*moving)  # raises the error of a local call
    axes: tuple[int, ...] = lower.shape
    return axes


def _sweep(*moving: Any) -> tuple[Any, ...]:
    times: tuple[Any, ...] = _impinge.time_of_impact(moving, 0.0, False)
    return times
