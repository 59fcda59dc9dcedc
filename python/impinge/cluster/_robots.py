"""Cuts a question about many configurations or motions of a robot into tasks, by rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from impinge import _arrays
from impinge.cluster._calls import Call, joined, run_of, snapshots
from impinge.cluster._parcels import Parcels
from impinge.cluster._robot_contents import contents_of
from impinge.cluster._scenes import Part, distinct
from impinge.cluster._worker import Placed

if TYPE_CHECKING:
    from impinge._robot import Robot

_WORK_OF_ROW = {"robot_check": 8, "robot_clearance": 64, "robot_motions": 128}
"""Estimated work of a row of a function in rows of `intersects`, for each 8 links and parts."""


class RobotRows(Call):
    """A question about many configurations or motions, cut into runs of rows.

    Parameters
    ----------
    function : str
        Function of the extension.
    robot : Robot
        The robot.
    rows : sequence of arrays
        Arrays with one row for each configuration or motion.
    obstacles : list of Part
        Obstacles of the robot.
    rest : tuple
        Other arguments.
    """

    def __init__(
        self,
        function: str,
        robot: Robot,
        rows: Sequence[NDArray[np.float64]],
        obstacles: Sequence[Part],
        rest: tuple[Any, ...],
    ) -> None:
        self.function = function
        self.what = "motions" if function == "robot_motions" else "configurations"
        things: Sequence[Any] = snapshots([part for _, part, *_ in obstacles])
        self.parts = [robot, *things]  # type: ignore[list-item]  # a robot travels like a shape
        self.names = ["the robot", *(name for name, *_ in obstacles)]
        self._distinct, self._which = distinct(self.parts)
        self.parcels = Parcels(self.parts, self._distinct)
        self._solid = any(solid for _, _, solid, _ in obstacles)
        self._poses = [
            None if pose is None else _arrays.plain_poses(pose, f"poses[{name!r}]") for name, _, _, pose in obstacles
        ]
        self._robot, self._rows, self._rest = contents_of(robot), rows, rest
        work = _WORK_OF_ROW[function] * max((len(robot.links) + len(obstacles)) // 8, 1)
        self._run, self.count = run_of(len(rows[0]), work, 8 * max(sum(row.shape[1] for row in rows), 1))

    def parts_of(self, task: int) -> Sequence[int]:
        """Return the robot and all obstacles."""
        return self._distinct

    def arguments_of(self, task: int) -> tuple[Any, ...]:
        """Return the rows of a task and the other arguments."""
        start = task * self._run
        rows = [row[start : start + self._run] for row in self._rows]
        return self._robot, rows, Placed(self._which[1:], self._poses, self._solid), self._rest

    def _input(self) -> tuple[Any, ...]:
        return self._robot, self._which, self._solid, self._rest, *self._rows, *self._poses

    def merged(self, answers: Mapping[int, Any]) -> Any:
        """Return the answers of all rows."""
        some = [answers[task] for task in range(self.count)]
        if self.function == "robot_check":
            return joined(some)
        if self.function == "robot_clearance":
            return tuple(np.concatenate(column) for column in zip(*some, strict=True))
        verdicts, certificates = zip(*some, strict=True)
        return tuple(np.concatenate(column) for column in zip(*verdicts, strict=True)), joined(certificates)
