"""Pairs of parts that a check of a scene found, in each configuration."""

from __future__ import annotations

from bisect import bisect_left
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from impinge._errors import InputError
from impinge._rows import Statuses

if TYPE_CHECKING:
    from impinge._scene import Scene


class SceneReport:
    """Pairs of parts that `Scene.check` found in each configuration.

    A pair is found if the question of the check was answered with yes, or was left undecided.

    Attributes
    ----------
    intersects : bool or (...) bool array
        For each configuration, whether any pair was found, whatever the question was.
    status : (...) uint8 array or None
        The `Status` of each configuration with ``on_error="status"``, otherwise None.
    """

    intersects: bool | NDArray[np.bool_]
    status: Statuses | None

    def __init__(self, scene: Scene, answer: Any, status: Statuses | None, *, stopped_at_first: bool) -> None:
        shape, self._offsets, self._found = answer
        self._parts = scene._names()
        self._ignored = scene._ignored_places()
        self._shape = tuple(shape)
        self._stopped_at_first = stopped_at_first
        hits = (np.diff(self._offsets) > 0).reshape(self._shape)
        self.intersects = hits if self._shape else bool(hits)
        self.status = status

    @cached_property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """The p checked pairs of parts, in the order of the scene."""
        ignored = set(map(tuple, self._ignored.tolist()))
        places = (pair for pair in combinations(range(len(self._parts)), 2) if pair not in ignored)
        return tuple((self._parts[i], self._parts[j]) for i, j in places)

    @cached_property
    def first(self) -> int | NDArray[np.int64]:
        """For each configuration, the smallest index into `pairs` of a pair found; -1 if none."""
        starts = zip(self._offsets[:-1].tolist(), self._offsets[1:].tolist(), strict=True)
        first = [self._number(self._pair(start)) if start < end else -1 for start, end in starts]
        return np.array(first, np.int64).reshape(self._shape) if self._shape else first[0]

    @cached_property
    def meets(self) -> NDArray[np.bool_] | None:
        """For each configuration, whether each of the p `pairs` was found, (..., p).

        None if the check stopped at the first pair.
        """
        if self._stopped_at_first:
            return None
        meets = np.zeros((len(self._offsets) - 1, self._count), bool)
        rows = np.repeat(np.arange(len(meets)), np.diff(self._offsets))
        meets[rows, [self._number(self._pair(at)) for at in range(len(self._found))]] = True
        return meets.reshape(*self._shape, self._count)

    def names(self, configuration: int | tuple[int, ...] = ()) -> list[tuple[str, str]]:
        """Return the names of the pairs found in one configuration.

        If the check stopped at the first pair, only that pair is returned.

        Parameters
        ----------
        configuration : int or tuple of int
            Index into the leading axes; omit it if there is a single configuration.
        """
        row = int(np.arange(len(self._offsets) - 1).reshape(self._shape)[configuration])
        places = (self._pair(at) for at in range(self._offsets[row], self._offsets[row + 1]))
        return [(self._parts[i], self._parts[j]) for i, j in places]

    @property
    def worst(self) -> tuple[int, ...]:
        """The configuration with the most pairs found, as an index into the leading axes.

        If several have as many, it is the first of them.

        Raises
        ------
        InputError
            If the check stopped at the first pair, or if there is no configuration.
        """
        if self._stopped_at_first:
            message = "the number of pairs is unknown, because the check stopped at the first"
            raise InputError(message, kind="option", what="stop", hint='call check with stop="all"')
        counts = np.diff(self._offsets)
        if counts.size == 0:
            raise InputError("there is no configuration", kind="shape", what="poses")
        return tuple(int(at) for at in np.unravel_index(int(np.argmax(counts)), self._shape))

    @property
    def _count(self) -> int:
        """Number of checked pairs."""
        count = len(self._parts)
        return count * (count - 1) // 2 - len(self._ignored)

    def _number(self, pair: tuple[int, int]) -> int:
        """Return the index into `pairs` of a pair of part indices."""
        number = self._place(pair)
        return number - bisect_left(self._skipped, number)

    @cached_property
    def _skipped(self) -> list[int]:
        """Indices of the ignored pairs among all pairs, ascending."""
        return [self._place((i, j)) for i, j in self._ignored.tolist()]

    def _place(self, pair: tuple[int, int]) -> int:
        """Return the index of a pair of part indices among all pairs, ignored pairs included."""
        i, j = pair
        return i * (2 * len(self._parts) - i - 1) // 2 + j - i - 1

    def _pair(self, at: int) -> tuple[int, int]:
        i, j = self._found[at].tolist()
        return i, j

    def __repr__(self) -> str:
        """Return the number of configurations, and the number in collision."""
        hits = np.asarray(self.intersects)
        return f"SceneReport({hits.size} configurations, {int(hits.sum())} in collision, {self._count} pairs each)"
