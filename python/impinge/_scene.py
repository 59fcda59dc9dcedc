"""Many meshes at once: every configuration of a robot or an assembly in one call."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._rows import Statuses
from impinge._scalars import chosen


@dataclass(frozen=True, eq=False, repr=False)
class SceneReport:
    """Which pairs of parts meet, in each configuration.

    Attributes
    ----------
    pairs : tuple of (str, str)
        The p pairs of parts that were asked about, in the order of the scene.
    intersects : bool or (...) bool array
        Whether any pair meets, for each configuration.
    first : int or (...) int64 array
        The first pair that meets, as an index into `pairs`; -1 where none does.
    meets : (..., p) bool array or None
        Whether each pair meets; None where the check stopped at the first.
    status : (...) uint8 array or None
        The `Status` of each configuration, where ``on_error="status"`` asked for one.
    """

    pairs: tuple[tuple[str, str], ...]
    intersects: bool | NDArray[np.bool_]
    first: int | NDArray[np.int64]
    meets: NDArray[np.bool_] | None
    status: Statuses | None

    def names(self, configuration: int | tuple[int, ...] = ()) -> list[tuple[str, str]]:
        """Return the names of the pairs that meet in one configuration; the first alone where the check stopped there.

        Parameters
        ----------
        configuration : int or tuple of int
            An index into the leading axes; nothing where a single configuration was asked about.
        """
        if self.meets is not None:
            return [self.pairs[pair] for pair in np.flatnonzero(self.meets[configuration])]
        first = int(np.asarray(self.first)[configuration])
        return [self.pairs[first]] if first >= 0 else []

    @property
    def worst(self) -> tuple[int, ...]:
        """The configuration in which most pairs meet, the first of these, as an index into the leading axes.

        Raises
        ------
        InputError
            If the check stopped at the first pair, or there is no configuration.
        """
        if self.meets is None:
            message = "how many pairs meet is not known where the check stopped at the first"
            raise InputError(message, kind="option", what="stop", hint='ask with stop="all"')
        counts = self.meets.sum(axis=-1)
        if counts.size == 0:
            raise InputError("there is no configuration", kind="shape", what="poses")
        return tuple(int(at) for at in np.unravel_index(int(np.argmax(counts)), counts.shape))

    def __repr__(self) -> str:
        """Return how many configurations are clear."""
        hits = np.asarray(self.intersects)
        return f"SceneReport({hits.size} configurations, {int(hits.sum())} in collision, {len(self.pairs)} pairs each)"


class Scene:
    """Named meshes that are checked against each other, at many configurations in one call.

    Parameters
    ----------
    parts : mapping of str to Mesh
        The parts; one mesh may serve several of them.
    ignored : iterable of (str, str), optional
        Pairs of parts that are not checked, such as neighbouring links of a robot, in either order.

    Raises
    ------
    InputError
        If a part is no `Mesh`, or `ignored` names a part that there is not.

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

    def __init__(self, parts: Mapping[str, Mesh], *, ignored: Iterable[tuple[str, str]] = ()) -> None:
        if not isinstance(parts, Mapping):
            raise InputError(f"must be a mapping, not {type(parts).__name__}", kind="type", what="parts")
        self._parts = dict(parts)
        for name, mesh in self._parts.items():
            if not isinstance(name, str) or not isinstance(mesh, Mesh):
                message = f"part {name!r} is {type(mesh).__name__}; names are str, parts impinge.Mesh"
                raise InputError(message, kind="type", what="parts")
        self._ignored: set[frozenset[str]] = set()
        for a, b in _pairs(ignored):
            self._ignore((a, "ignored"), (b, "ignored"))

    @property
    def parts(self) -> dict[str, Mesh]:
        """The parts by name; a copy."""
        return dict(self._parts)

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """The pairs of names that are checked, in the order of the parts."""
        kept = (pair for pair in combinations(self._parts, 2) if frozenset(pair) not in self._ignored)
        return tuple(kept)

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
        stop: Literal["first", "all"] = "first",
        on_error: Literal["raise", "status"] = "raise",
        progress: bool = False,
    ) -> SceneReport:
        """Ask which parts meet, in each configuration.

        Parameters
        ----------
        poses : mapping of str to (..., 4, 4) array_like
            World from part; leading axes, the configurations, broadcast as in NumPy. A part without a pose stands where
            its own frame is the world. Pairs of parts that stand still are asked about once.
        stop : {"first", "all"}
            Whether a configuration is done with at the first pair that meets, in the order of `pairs`, or all pairs are
            asked about.
        on_error : {"raise", "status"}
            What becomes of a pose that is none. ``"status"`` counts its part as meeting every other.
        progress : bool
            As for `intersects`.

        Returns
        -------
        SceneReport
            The same for any number of threads.

        Raises
        ------
        InputError
            If `poses` names a part that there is not, or as for `intersects`.
        """
        poses = {} if poses is None else poses
        if not isinstance(poses, Mapping):
            raise InputError(f"must be a mapping, not {type(poses).__name__}", kind="type", what="poses")
        for name in poses:
            self._known(name, "poses")
        chosen(stop, ("first", "all"), "stop")
        names = list(self._parts)
        parts = [(name, mesh, poses.get(name)) for name, mesh in self._parts.items()]
        places = [(names.index(a), names.index(b)) for a, b in self.pairs]
        answer: Any = _impinge.check_scene(parts, places, stop == "first", on_error, progress)
        status: Statuses | None = None
        if on_error == "status":
            answer, status = answer
        meets: NDArray[np.bool_] | None = None
        if stop == "first":
            first = answer
        else:
            meets = answer
            none = np.full(answer.shape[:-1], -1)
            first = np.where(answer.any(axis=-1), answer.argmax(axis=-1), none) if places else none
        hit = first >= 0
        if first.ndim == 0:
            return SceneReport(self.pairs, bool(hit), int(first), meets, status)
        return SceneReport(self.pairs, hit, first, meets, status)

    def _known(self, name: str, what: str) -> None:
        if not isinstance(name, str) or name not in self._parts:
            message = f"there is no part {name!r}; there are {', '.join(map(repr, self._parts)) or 'none'}"
            raise InputError(message, kind="name", what=what)

    def __repr__(self) -> str:
        """Return the numbers of parts and pairs."""
        return f"Scene({len(self._parts)} parts, {len(self.pairs)} pairs)"


def _pairs(ignored: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    try:
        return [(a, b) for a, b in ignored]
    except (TypeError, ValueError):
        raise InputError("must be pairs of names", kind="type", what="ignored") from None
