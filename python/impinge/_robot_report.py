"""The collisions that a robot has in many configurations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge._errors import InputError


class RobotReport:
    """Collisions that `Robot.check` found in each configuration.

    Attributes
    ----------
    collides : bool or (...) bool array
        For each configuration, whether any pair collides, or is too near. Undecided pairs count.
    undecided : bool or (...) bool array
        For each configuration, whether a pair that was found is undecided: round shapes touch to
        within rounding, so that nothing was proved.
    """

    collides: bool | NDArray[np.bool_]
    undecided: bool | NDArray[np.bool_]

    def __init__(self, answer: Any, shape: tuple[int, ...], names: tuple[str, ...], *, stopped_at_first: bool) -> None:
        self._offsets, self._found, undecided = answer
        self._shape, self._names, self._stopped_at_first = shape, names, stopped_at_first
        counts = np.diff(self._offsets)
        rows = np.repeat(np.arange(len(counts)), counts)
        unproved = np.zeros(len(counts), bool)
        unproved[rows[undecided]] = True
        hits = (counts > 0).reshape(shape)
        self.collides = hits if shape else bool(hits)
        self.undecided = unproved.reshape(shape) if shape else bool(unproved[0])

    @property
    def first(self) -> Any:
        """For each configuration, the names of the first pair found; None if it is free.

        A tuple or None for a single configuration, and otherwise an object array of these.
        """
        first = np.empty(len(self._offsets) - 1, object)
        for row, (start, end) in enumerate(zip(self._offsets[:-1].tolist(), self._offsets[1:].tolist(), strict=True)):
            first[row] = self._pair(start) if start < end else None
        return first.reshape(self._shape) if self._shape else first[0]

    def names(self, configuration: int | tuple[int, ...] = ()) -> list[tuple[str, str]]:
        """Return the names of the pairs found in one configuration.

        Each is a link, and what it collides with: another link, or a part of the scene. If the
        check stopped at the first pair, only that pair is returned.

        Parameters
        ----------
        configuration : int or tuple of int
            Index into the leading axes; omit it if there is a single configuration.
        """
        row = int(np.arange(len(self._offsets) - 1).reshape(self._shape)[configuration])
        return [self._pair(at) for at in range(self._offsets[row], self._offsets[row + 1])]

    def counts(self) -> dict[tuple[str, str], int]:
        """Return for each pair found the number of configurations, the largest first.

        Raises
        ------
        InputError
            If the check stopped at the first pair of each configuration.
        """
        if self._stopped_at_first:
            message = "the numbers are unknown, because the check stopped at the first pair"
            raise InputError(message, kind="option", what="stop", hint='call check with stop="all"')
        pairs, counts = np.unique(self._found, axis=0, return_counts=True)
        order = np.argsort(-counts, kind="stable")
        return {(self._names[a], self._names[b]): int(counts[at]) for at in order for a, b in [pairs[at].tolist()]}

    def _pair(self, at: int) -> tuple[str, str]:
        link, other = self._found[at].tolist()
        return self._names[link], self._names[other]

    def __repr__(self) -> str:
        """Return the number of configurations, and the number in collision."""
        hits = np.asarray(self.collides)
        return f"RobotReport({hits.size} configurations, {int(hits.sum())} in collision)"
