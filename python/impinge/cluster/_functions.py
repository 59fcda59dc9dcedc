"""Functions with the names, arguments and results of the extension, which run on a cluster."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._mesh import Mesh
from impinge.cluster._calls import Call, ShareCall, VerbCall
from impinge.cluster._clashes import ClashPairs, ClashQuestion
from impinge.cluster._robots import RobotRows
from impinge.cluster._scenes import Part, ScenePairs, SceneRows
from impinge.cluster._sweeps import Sweeps, leading_axes

if TYPE_CHECKING:
    from impinge._robot import Robot


class Functions:
    """Functions that cut their call into tasks and run them.

    Arguments are validated here first, by the extension, so errors are those of a local call.

    Parameters
    ----------
    answer : callable
        Runs a call, optionally with a line of progress, and returns its answer.
    """

    def __init__(self, answer: Callable[[Call, bool], Any]) -> None:
        self._answer = answer

    def intersects(self, asked: tuple[Any, ...]) -> Any:
        """Report whether two things intersect, for each row."""
        return self._rows("intersects", asked)

    def penetrates(self, asked: tuple[Any, ...]) -> Any:
        """Report whether the interiors of two things intersect, for each row."""
        return self._rows("penetrates", asked)

    def within(self, asked: tuple[Any, ...], clearance: float) -> Any:
        """Report whether two things are at most a clearance apart, for each row."""
        return self._rows("within", asked, clearance)

    def distance(self, asked: tuple[Any, ...]) -> Any:
        """Return the distance of two things for each row."""
        return self._rows("distance", asked)

    def penetration(self, asked: tuple[Any, ...]) -> Any:
        """Return the penetration of two things for each row."""
        return self._rows("penetration", asked)

    def depth(self, asked: tuple[Any, ...]) -> Any:
        """Return the depth of the material that two things share, for each row."""
        return self._rows("depth", asked)

    def deeper(self, asked: tuple[Any, ...], threshold: float) -> Any:
        """Report whether two things share material deeper than a threshold, for each row."""
        return self._rows("deeper", asked, threshold)

    def contacts_of(self, asked: tuple[Any, ...], margin: float, most_points: int) -> Any:
        """Return the contacts of two things for each row."""
        return self._rows("contacts_of", asked, margin, most_points)

    def intersection_curves(self, asked: tuple[Any, ...]) -> Any:
        """Return the curves in which two meshes intersect, for each row."""
        return self._rows("intersection_curves", asked)

    def time_of_impact(self, moving: tuple[Any, ...], clearance: float, ignore_touch: bool) -> Any:
        """Return the times at which two things touch first, for each row of motions."""
        axes = leading_axes(moving)
        return self._answer(Sweeps(moving, (clearance, ignore_touch), axes), moving[-1])

    def intersecting_pairs(self, asked: tuple[Any, ...], limit: int | None) -> Any:
        """Return the pairs of faces of two meshes that intersect, for each row.

        If there is one row, the search is cut into shares.
        """
        a, b, *_, on_error, progress = asked
        are_meshes = isinstance(a, Mesh) and isinstance(b, Mesh)
        if are_meshes and limit is None and on_error == "raise" and not _impinge.leading_axes(asked):
            call = ShareCall(asked)
            if call.count > 1:
                return self._answer(call, progress)
        return self._rows("intersecting_pairs", asked, limit)

    def _rows(self, verb: str, asked: tuple[Any, ...], *rest: Any) -> Any:
        axes = _impinge.leading_axes(asked)
        return self._answer(VerbCall(verb, asked, rest, axes), asked[-1])

    def check_scene(  # noqa: PLR0917 (the arguments of the extension)
        self,
        parts: list[Part],
        ignored: NDArray[np.uint32],
        question: tuple[str, float],
        first: bool,
        on_error: str,
        progress: bool,
    ) -> Any:
        """Return the pairs of parts that are found in each configuration of a scene.

        One configuration is cut by its pairs, if all of them are wanted. Otherwise the
        configurations are divided.
        """
        call = scene_call(parts, ignored, question, first, on_error)
        return self._answer(call, progress)

    def robot_check(  # noqa: PLR0917 (the arguments of the extension)
        self,
        robot: Robot,
        q: NDArray[np.float64],
        first: bool,
        paddings: tuple[float, list[float]],
        parts: list[Part],
        ignored: list[tuple[int, int]],
        progress: bool,
    ) -> Any:
        """Return the collisions of a robot in each configuration."""
        robot._core.check_rows(q)
        _impinge.robot_check(robot._core, q[:0], first, paddings, parts, ignored, False)
        return self._answer(RobotRows("robot_check", robot, [q], parts, (first, paddings, ignored)), progress)

    def robot_clearance(  # noqa: PLR0917 (the arguments of the extension)
        self,
        robot: Robot,
        q: NDArray[np.float64],
        limit: float,
        parts: list[Part],
        ignored: list[tuple[int, int]],
        progress: bool,
    ) -> Any:
        """Return the clearance of each configuration of a robot."""
        robot._core.check_rows(q)
        _impinge.robot_clearance(robot._core, q[:0], limit, parts, ignored, False)
        return self._answer(RobotRows("robot_clearance", robot, [q], parts, (limit, ignored)), progress)

    def robot_motions(  # noqa: PLR0917 (the arguments of the extension)
        self,
        robot: Robot,
        ends: tuple[NDArray[np.float64], NDArray[np.float64]],
        surroundings: tuple[Any, list[Part], list[tuple[int, int]]],
        max_steps: int,
        keeps_certificate: bool,
        progress: bool,
    ) -> Any:
        """Return the verdict about each motion of a robot."""
        for q in ends:
            robot._core.check_rows(q)
        none = ends[0][:0], ends[1][:0]
        _impinge.robot_motions(robot._core, none, surroundings, max_steps, keeps_certificate, False)
        clearances, parts, ignored = surroundings
        rest = clearances, ignored, max_steps, keeps_certificate
        return self._answer(RobotRows("robot_motions", robot, ends, parts, rest), progress)

    def clash(self, question: ClashQuestion, progress: bool) -> Any:
        """Return the report about the clashes of some scenes."""
        findings = self._answer(ClashPairs(question), progress)
        return _impinge.clash_report(question, findings)


def scene_call(
    parts: list[Part], ignored: NDArray[np.uint32], question: tuple[str, float], first: bool, on_error: str
) -> SceneRows | ScenePairs:
    """Return the call that checks a scene."""
    axes, broad_phase = _impinge.scene_candidates(parts, ignored, question, on_error)
    if broad_phase is not None and not first:
        return ScenePairs(parts, question, on_error, axes, broad_phase)
    return SceneRows(parts, ignored, (question, first, on_error), axes)
