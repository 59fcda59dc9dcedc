"""Many parts at once: every configuration of a robot or an assembly in one call."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping
from functools import cached_property
from itertools import combinations
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._rows import Statuses
from impinge._scalars import chosen, flag, real
from impinge._shape import AnyShape, Shape


class SceneReport:
    """Which pairs of parts were found, in each configuration.

    Attributes
    ----------
    intersects : bool or (...) bool array
        Whether any pair was found, for each configuration. An undecided pair counts as found.
    status : (...) uint8 array or None
        The `Status` of each configuration, if ``on_error="status"`` asked for one.
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
        """The p pairs of parts that were asked about, in the order of the scene."""
        places = (pair for pair in combinations(range(len(self._parts)), 2) if pair not in self._ignored)
        return tuple((self._parts[i], self._parts[j]) for i, j in places)

    @cached_property
    def first(self) -> int | NDArray[np.int64]:
        """The first pair found, for each configuration, as an index into `pairs`; -1 if there is none."""
        starts = zip(self._offsets[:-1].tolist(), self._offsets[1:].tolist(), strict=True)
        first = [self._number(self._pair(start)) if start < end else -1 for start, end in starts]
        return np.array(first, np.int64).reshape(self._shape) if self._shape else first[0]

    @cached_property
    def meets(self) -> NDArray[np.bool_] | None:
        """Whether each pair was found, (..., p); None if the check stopped at the first."""
        if self._stopped_at_first:
            return None
        meets = np.zeros((len(self._offsets) - 1, self._count), bool)
        rows = np.repeat(np.arange(len(meets)), np.diff(self._offsets))
        meets[rows, [self._number(self._pair(at)) for at in range(len(self._found))]] = True
        return meets.reshape(*self._shape, self._count)

    def names(self, configuration: int | tuple[int, ...] = ()) -> list[tuple[str, str]]:
        """Return the names of the pairs found in one configuration; the first alone if the check stopped there.

        Parameters
        ----------
        configuration : int or tuple of int
            An index into the leading axes; nothing if a single configuration was asked about.
        """
        row = int(np.arange(len(self._offsets) - 1).reshape(self._shape)[configuration])
        places = (self._pair(at) for at in range(self._offsets[row], self._offsets[row + 1]))
        return [(self._parts[i], self._parts[j]) for i, j in places]

    @property
    def worst(self) -> tuple[int, ...]:
        """The configuration in which most pairs were found, the first of these, as an index into the leading axes.

        Raises
        ------
        InputError
            If the check stopped at the first pair, or there is no configuration.
        """
        if self._stopped_at_first:
            message = "how many pairs there are is not known if the check stopped at the first"
            raise InputError(message, kind="option", what="stop", hint='ask with stop="all"')
        counts = np.diff(self._offsets)
        if counts.size == 0:
            raise InputError("there is no configuration", kind="shape", what="poses")
        return tuple(int(at) for at in np.unravel_index(int(np.argmax(counts)), self._shape))

    @property
    def _count(self) -> int:
        """How many pairs were asked about."""
        count = len(self._parts)
        return count * (count - 1) // 2 - len(self._ignored)

    def _number(self, pair: tuple[int, int]) -> int:
        """Return the index of a pair of places into `pairs`."""
        number = self._place(pair)
        return number - bisect_left(self._skipped, number)

    @cached_property
    def _skipped(self) -> list[int]:
        """The ignored pairs among all pairs."""
        return sorted(map(self._place, self._ignored))

    def _place(self, pair: tuple[int, int]) -> int:
        """Return the index of a pair of places among all pairs, ignored ones included."""
        i, j = pair
        return i * (2 * len(self._parts) - i - 1) // 2 + j - i - 1

    def _pair(self, at: int) -> tuple[int, int]:
        i, j = self._found[at].tolist()
        return i, j

    def __repr__(self) -> str:
        """Return how many configurations are clear."""
        hits = np.asarray(self.intersects)
        return f"SceneReport({hits.size} configurations, {int(hits.sum())} in collision, {self._count} pairs each)"


class Scene:
    """Named parts that are checked against each other, at many configurations in one call.

    Parameters
    ----------
    parts : mapping of str to Mesh or Shape
        The parts; one mesh or shape may serve several of them.
    ignored : iterable of (str, str), optional
        Pairs of parts that are not checked, such as neighboring links of a robot, in either order.
    solid : bool
        Whether meshes are solids, so that what lies wholly inside one intersects it.

    Raises
    ------
    InputError
        If a part is no `Mesh` or `Shape`, or `ignored` names a part that there is not.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> scene = impinge.Scene({"base": triangle, "arm": triangle, "hand": triangle}, ignored=[("arm", "hand")])
    >>> arm = impinge.pose([[0, 0, 5], [0, 0, 0]])
    >>> report = scene.check({"arm": arm, "hand": impinge.pose([0, 0, 9])}, stop="all")
    >>> report
    SceneReport(2 configurations, 1 in collision, 2 pairs each)
    >>> report.worst, report.names(report.worst)
    ((1,), [('base', 'arm')])
    """

    def __init__(
        self, parts: Mapping[str, AnyShape], *, ignored: Iterable[tuple[str, str]] = (), solid: bool = False
    ) -> None:
        if not isinstance(parts, Mapping):
            raise InputError(f"must be a mapping, not {type(parts).__name__}", kind="type", what="parts")
        self._parts = dict(parts)
        self._solid = flag(solid, "solid")
        for name, part in self._parts.items():
            if not isinstance(name, str) or not isinstance(part, Mesh | Shape):
                message = f"part {name!r} is {type(part).__name__}; names are str, parts impinge.Mesh or impinge.Shape"
                raise InputError(message, kind="type", what="parts")
        self._ignored: set[frozenset[str]] = set()
        for a, b in _pairs(ignored):
            self._ignore((a, "ignored"), (b, "ignored"))

    @property
    def parts(self) -> dict[str, AnyShape]:
        """The parts by name; a copy."""
        return dict(self._parts)

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """The pairs of names that are checked, in the order of the parts."""
        return tuple(pair for pair in combinations(self._parts, 2) if frozenset(pair) not in self._ignored)

    def ignore(self, a: str, b: str) -> None:
        """Leave the pair of these two parts out of later checks.

        Raises
        ------
        InputError
            If there is no such part.
        """
        self._ignore((a, "a"), (b, "b"))

    def _ignore(self, a: tuple[str, str], b: tuple[str, str]) -> None:
        """Leave a pair out: each a name, and the argument that it came in."""
        for name, what in (a, b):
            self._known(name, what)
        self._ignored.add(frozenset((a[0], b[0])))

    def check(
        self,
        poses: Mapping[str, ArrayLike] | None = None,
        *,
        question: Literal["intersects", "penetrates", "within"] = "intersects",
        clearance: float | None = None,
        stop: Literal["first", "all"] = "first",
        on_error: Literal["raise", "status"] = "raise",
        progress: bool = False,
    ) -> SceneReport:
        """Ask about all pairs of parts, in each configuration.

        Only pairs whose boxes are near each other are looked at, and consecutive configurations start from what the one
        before told. No answer depends on either.

        Parameters
        ----------
        poses : mapping of str to (..., 4, 4) array_like
            World from part; leading axes, the configurations, broadcast as in NumPy. A part without a pose stands where
            its own frame is the world. Pairs of parts that stand still are asked about once.
        question : {"intersects", "penetrates", "within"}
            As the verbs of these names. ``"penetrates"`` takes meshes as solids; ``"within"`` needs a clearance.
        clearance : float, optional
            In world units, not negative; only for ``"within"``.
        stop : {"first", "all"}
            Whether a configuration is done with at the first pair found, in the order of `pairs`, or all pairs are
            asked about.
        on_error : {"raise", "status"}
            What becomes of a pose that is none. ``"status"`` counts its part as near every other.
        progress : bool
            As for `intersects`.

        Returns
        -------
        SceneReport
            The same for any number of threads.

        Raises
        ------
        InputError
            If `poses` names a part that there is not, a clearance is missing or not asked for, or as for `intersects`.

        Examples
        --------
        >>> import impinge
        >>> ball = impinge.Shape.sphere(0.5)
        >>> scene = impinge.Scene({"a": ball, "b": ball})
        >>> near = scene.check({"b": impinge.pose([[1.25, 0, 0], [9, 0, 0]])}, question="within", clearance=0.5)
        >>> near.intersects
        array([ True, False])
        """
        poses = {} if poses is None else poses
        if not isinstance(poses, Mapping):
            raise InputError(f"must be a mapping, not {type(poses).__name__}", kind="type", what="poses")
        for name in poses:
            self._known(name, "poses")
        chosen(stop, ("first", "all"), "stop")
        chosen(question, ("intersects", "penetrates", "within"), "question")
        if (question == "within") != (clearance is not None):
            raise InputError('goes with question="within"', kind="option", what="clearance")
        least = 0.0 if clearance is None else real(clearance, "clearance", least=0)
        parts = [(name, part, self._solid, poses.get(name)) for name, part in self._parts.items()]
        first, ignored = stop == "first", sorted(self._ignored_places())
        answer: Any = _impinge.check_scene(parts, ignored, (question, least), first, on_error, progress)
        status: Statuses | None = None
        if on_error == "status":
            answer, status = answer
        return SceneReport(self, answer, status, stopped_at_first=first)

    def _names(self) -> list[str]:
        return list(self._parts)

    def _ignored_places(self) -> set[tuple[int, int]]:
        """Return the ignored pairs by the places of their parts, the lesser first."""
        place = {name: place for place, name in enumerate(self._parts)}
        both = (sorted(place[name] for name in pair) for pair in self._ignored if len(pair) > 1)
        return {(i, j) for i, j in both}

    def _known(self, name: str, what: str) -> None:
        if not isinstance(name, str) or name not in self._parts:
            message = f"there is no part {name!r}; there are {', '.join(map(repr, self._parts)) or 'none'}"
            raise InputError(message, kind="name", what=what)

    def __repr__(self) -> str:
        """Return the numbers of parts and pairs."""
        count = len(self._parts)
        return f"Scene({count} parts, {count * (count - 1) // 2 - len(self._ignored_places())} pairs)"


def _pairs(ignored: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    try:
        return [(a, b) for a, b in ignored]
    except (TypeError, ValueError):
        raise InputError("must be pairs of names", kind="type", what="ignored") from None
