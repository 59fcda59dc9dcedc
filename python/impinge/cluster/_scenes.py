"""Cuts the check of a scene into tasks: by pairs of one configuration, or by configurations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge import _arrays
from impinge._errors import Status
from impinge._mesh import Mesh
from impinge.cluster._calls import Call, Rows, in_order, poses_of, ragged, snapshots
from impinge.cluster._parcels import Parcels
from impinge.cluster._worker import Placed

Part = tuple[str, Any, bool, Any]
"""Part of a scene as the extension takes it: name, mesh or shape, whether it is a solid, poses."""

_COST_OF_PAIR = 512
"""Estimated cost of a pair of parts besides their faces, in faces."""

_MIN_COST, _MAX_COST = 1 << 17, 1 << 23
"""Minimum and maximum of the estimated cost of a task, in faces. The smallest task takes several
times as long as Ray needs for a task. If its node ends, a task is computed again, so a larger
maximum wastes more time."""

_MAX_FACES = 1 << 14
"""Maximum number of faces of a part that count for the largest task. Queries visit few faces of a
large mesh, so a task of many large parts would be too small otherwise."""

_TARGET_TASKS = 1 << 10
"""Number of tasks of a check, if its tasks are then larger than the smallest and smaller than the
largest. With fewer, processors are idle at the end. With more, Ray's cost is a larger part."""

_WORK_OF_MOVING = 8
"""Estimated work of a configuration for each part that moves, in rows of `intersects`."""

_BITS = 16
"""Number of bits for each axis of a place along the space-filling curve. Three axes fit into the 64
bits of an integer."""


class SceneRows(Call):
    """Many configurations of a scene, cut into runs of configurations."""

    function = "scene_rows"
    what = "configurations"

    def __init__(
        self,
        parts: Sequence[Part],
        ignored: NDArray[np.uint32],
        options: tuple[tuple[str, float], bool, str],
        axes: Sequence[int],
    ) -> None:
        self.names = [name for name, *_ in parts]
        self.parts = snapshots([part for _, part, *_ in parts])
        self._distinct, self._which = distinct(self.parts)
        self._solid = any(solid for _, _, solid, _ in parts)
        self._ignored, self._options = ignored, options
        self.parcels = Parcels(self.parts, self._distinct)
        placed = poses_of({f"poses[{name!r}]": poses for name, _, _, poses in parts})
        moving = sum(poses is not None and poses.ndim > 2 for poses in placed)
        self._rows = Rows(axes, placed, _WORK_OF_MOVING * max(moving, 1))
        self.count = self._rows.runs

    def parts_of(self, task: int) -> Sequence[int]:
        """Return all parts."""
        return self._distinct

    def arguments_of(self, task: int) -> tuple[Any, ...]:
        """Return the poses of the parts in the configurations of a task, and the options."""
        poses: list[Any] = self._rows.of(task)
        fixed = [at for at, pose in enumerate(poses) if pose is not None and pose.size == 16]
        stacked = np.stack([poses[at] for at in fixed]) if fixed else None
        for index, at in enumerate(fixed):
            poses[at] = index
        return Placed(self._which, poses, self._solid, stacked), self._ignored, self._options

    def _input(self) -> tuple[Any, ...]:
        return self._which, self._solid, self._ignored, self._options, self._rows.axes, *self._rows.arrays

    def merged(self, answers: Mapping[int, Any]) -> Any:
        """Return the pairs that were found in all configurations."""
        if not self._rows.axes:
            return answers[0]
        all_answers = [answers[task] for task in range(self.count)]
        if self._options[-1] != "status":
            return self._merged(all_answers)
        status = np.concatenate([status for _, status in all_answers])
        return self._merged([answer for answer, _ in all_answers]), status.reshape(self._rows.axes)

    def _merged(self, answers: list[Any]) -> Any:
        _, offsets, pairs = zip(*answers, strict=True)
        return list(self._rows.axes), ragged(offsets), np.concatenate(pairs)


class ScenePairs(Call):
    """One configuration of a scene, cut into runs of pairs of parts that are near each other.

    A run has pairs at one place, so that it needs few parts, and its estimated cost is bounded.
    """

    function = "scene_pairs"
    what = "pairs"

    def __init__(
        self,
        parts: Sequence[Part],
        question: tuple[str, float],
        on_error: str,
        axes: Sequence[int],
        broad_phase: tuple[int, NDArray[np.uint32], NDArray[np.float64]],
    ) -> None:
        self._status, pairs, boxes = broad_phase
        self.names = [name for name, *_ in parts]
        self.parts = snapshots([part for _, part, *_ in parts])
        self._solid = any(solid for _, _, solid, _ in parts)
        self._poses = np.empty((len(parts), 4, 4))
        for at, (name, _, _, poses) in enumerate(parts):
            self._poses[at] = np.eye(4) if poses is None else _arrays.plain_poses(poses, name).reshape(4, 4)
        self._question, self._on_error, self._axes = question, on_error, list(axes)
        rank = ranks(boxes)
        order = np.sort(rank[pairs], axis=1)
        self._pairs = pairs[np.lexsort((order[:, 1], order[:, 0]))]
        self._ends = cut(self._pairs, np.array([faces(part) for part in self.parts], np.int64), _MAX_FACES)
        self.count = len(self._ends) - 1
        self.parcels = Parcels(self.parts, list(dict.fromkeys(self._pairs.ravel().tolist())))

    def _run(self, task: int) -> NDArray[np.uint32]:
        return self._pairs[self._ends[task] : self._ends[task + 1]]

    def parts_of(self, task: int) -> Sequence[int]:
        """Return the distinct parts of the pairs."""
        numbers = self._numbers(task)
        return [numbers[at] for at in distinct([self.parts[at] for at in numbers])[0]]

    def _numbers(self, task: int) -> list[int]:
        numbers: list[int] = np.unique(self._run(task)).tolist()
        return numbers

    def arguments_of(self, task: int) -> tuple[Any, ...]:
        """Return the pairs of a task, and the poses of their parts."""
        numbers = self._numbers(task)
        local = np.searchsorted(numbers, self._run(task)).astype(np.uint32)
        _, which = distinct([self.parts[at] for at in numbers])
        return Placed(which, self._poses[numbers], self._solid), np.array(numbers, np.uint32), local, self._question

    def _input(self) -> tuple[Any, ...]:
        which = distinct([self.parts[at] for at in dict.fromkeys(self._pairs.ravel().tolist())])[1]
        return which, self._solid, self._question, self._pairs, self._ends, self._poses

    def merged(self, answers: Mapping[int, Any]) -> Any:
        """Return the pairs that were found; those of missing tasks are absent."""
        some = [answers[task] for task in sorted(answers)]
        pairs = in_order([found for found, _ in some])
        answer = self._axes, np.array([0, len(pairs)], np.int64), pairs
        if self._on_error != "status":
            return answer
        is_undecided = any(undecided.any() for _, undecided in some)
        status = self._status or (int(Status.UNDECIDED) if is_undecided else 0)
        return answer, np.full(self._axes, status, np.uint8)


def distinct(parts: Sequence[Any]) -> tuple[list[int], list[int]]:
    """Return the indices of distinct objects, and for each object its index among those."""
    places: dict[int, int] = {}
    which = [places.setdefault(id(part), len(places)) for part in parts]
    firsts: dict[int, int] = {}
    for at, place in enumerate(which):
        firsts.setdefault(place, at)
    return list(firsts.values()), which


def faces(part: Any) -> int:
    """Return the number of faces of a mesh, and one for a shape."""
    return part.face_count if isinstance(part, Mesh) else 1


def ranks(boxes: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the places of boxes along a space-filling curve. Infinite boxes are last."""
    centers = 0.5 * boxes[:, :3] + 0.5 * boxes[:, 3:]
    bounded = np.isfinite(centers).all(axis=1)
    codes = np.full(len(boxes), 1 << (3 * _BITS), np.int64)
    if bounded.any():
        low, high = centers[bounded].min(axis=0), centers[bounded].max(axis=0)
        size = np.where(high > low, high - low, 1.0)
        steps = ((centers[bounded] - low) / size * (2**_BITS - 1)).astype(np.int64)
        codes[bounded] = sum(
            ((steps[:, axis] >> bit) & 1) << (3 * bit + axis) for bit in range(_BITS) for axis in range(3)
        )
    rank = np.empty(len(boxes), np.int64)
    rank[np.argsort(codes, kind="stable")] = np.arange(len(boxes))
    return rank


def cut(pairs: NDArray[np.uint32], costs_of_parts: NDArray[np.int64], max_cost: int | None = None) -> NDArray[np.int64]:
    """Return the ends of runs of pairs whose estimated costs are about equal, with a leading 0.

    `max_cost` is the maximum cost of a part that counts for the largest task.
    """
    costs = costs_of_parts[pairs].sum(axis=1) + _COST_OF_PAIR
    limited = np.minimum(costs_of_parts, max_cost)[pairs].sum(axis=1) + _COST_OF_PAIR if max_cost else costs
    share = max(int(costs.sum()) // max(_TARGET_TASKS, int(limited.sum()) // _MAX_COST), _MIN_COST)
    runs = (np.cumsum(costs) - costs) // share
    ends = np.flatnonzero(np.diff(runs)) + 1
    return np.concatenate([[0], ends, [len(pairs)]]).astype(np.int64) if len(pairs) else np.zeros(1, np.int64)
