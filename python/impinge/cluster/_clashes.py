"""Cuts a search for clashes into tasks, by pairs of parts that are near each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge import _arrays, _impinge
from impinge.cluster._calls import Call, snapshots
from impinge.cluster._parcels import Parcels
from impinge.cluster._scenes import cut, distinct, faces, ranks

Scene = tuple[str, list[tuple[str, Any, Any, Any]], NDArray[np.uint32]]
"""Scene as the extension takes it: its label, the name, thing, pose and details of each part, and
pairs of parts that are ignored."""

Flags = tuple[bool, bool, bool, bool]
"""Whether only parts of different scenes are compared, whether contacts are listed, whether volumes
are computed, and whether curves are traced."""

ClashQuestion = tuple[list[Scene], tuple[str | None, str], tuple[Any, Any], Flags, tuple[Any, Any]]
"""Question as the extension takes it: the scenes, their unit and the axis that points up, the
tolerance and the clearance, the flags, and the rules and the previous report."""

_COLUMNS = 17
"""Number of columns of a finding."""

_COST = 64
"""Estimated cost of a pair in pairs of `Scene.check`, which have no depths."""


class ClashPairs(Call):
    """The pairs of a search for clashes, cut into runs of pairs at one place."""

    function = "clash_pairs"
    what = "pairs"

    def __init__(self, question: ClashQuestion) -> None:
        scenes, _, _, flags, _ = question
        pairs, asked, boxes = _impinge.clash_candidates(question)
        parts = [part for _, parts, _ in scenes for part in parts]
        self.names = [name for name, *_ in parts]
        self.parts = snapshots([thing for _, thing, *_ in parts])
        self._poses = np.empty((len(parts), 4, 4))
        for at, (name, _, pose, _) in enumerate(parts):
            self._poses[at] = np.eye(4) if pose is None else _arrays.plain_poses(pose, name).reshape(4, 4)
        self._order = np.argsort(ranks(boxes), kind="stable")
        self._pairs, self._asked = pairs[self._order], asked[self._order]
        self._listed = flags[1:3]  # curves are traced later, for the report
        self._ends = cut(self._pairs, np.array([_COST * faces(part) for part in self.parts], np.int64))
        self.count = len(self._ends) - 1
        self.parcels = Parcels(self.parts, list(dict.fromkeys(self._pairs.ravel().tolist())))

    def _run(self, task: int) -> slice:
        return slice(self._ends[task], self._ends[task + 1])

    def _numbers(self, task: int) -> list[int]:
        numbers: list[int] = np.unique(self._pairs[self._run(task)]).tolist()
        return numbers

    def parts_of(self, task: int) -> Sequence[int]:
        """Return the distinct parts of the pairs."""
        numbers = self._numbers(task)
        return [numbers[at] for at in distinct([self.parts[at] for at in numbers])[0]]

    def arguments_of(self, task: int) -> tuple[Any, ...]:
        """Return the pairs of a task with their questions, and the poses of their parts."""
        numbers, run = self._numbers(task), self._run(task)
        local = np.searchsorted(numbers, self._pairs[run]).astype(np.uint32)
        _, which = distinct([self.parts[at] for at in numbers])
        return (which, self._poses[numbers]), local, self._asked[run], self._listed

    def _input(self) -> tuple[Any, ...]:
        which = distinct([self.parts[at] for at in dict.fromkeys(self._pairs.ravel().tolist())])[1]
        return which, self._listed, self._pairs, self._asked, self._ends, self._poses

    def merged(self, answers: Mapping[int, Any]) -> NDArray[np.float64]:
        """Return the findings of all pairs, in the order of the search."""
        findings = np.empty((len(self._pairs), _COLUMNS))
        for task in range(self.count):
            findings[self._order[self._run(task)]] = answers[task]
        return findings
