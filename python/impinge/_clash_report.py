"""The report of a search for clashes."""

from __future__ import annotations

import html
import json
import math
import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._errors import InputError
from impinge._scalars import chosen, path_of


@dataclass(frozen=True)
class ClashPart:
    """A part as reports name it.

    Attributes
    ----------
    scene : str
        Label of the scene.
    key : str
        Identity of the part in its scene: the key of its details, or its name.
    name, type : str
        Name of the part, and its type, for example ``"IfcWall"``; the type may be empty.
    path : tuple of str
        Names of the groups that contain the part, the outermost first.
    """

    scene: str
    key: str
    name: str
    type: str = ""
    path: tuple[str, ...] = ()


@dataclass(frozen=True)
class Clash:
    """A pair of parts that a report lists. Lengths are in the unit of the scenes.

    Attributes
    ----------
    id : str
        Identity, which stays the same from one report to the next.
    kind : {"contained", "clash", "undecided", "contact", "clearance"}
        Kind of the pair. An undecided pair counts as a clash.
    a, b : ClashPart
        The two parts.
    depth : (float, float) or None
        Lower and upper bound of the depth; the upper one is infinite if it is not known.
    gap : (float, float) or None
        Lower and upper bound of the gap of a pair within the clearance.
    volume : (float, float) or None
        Lower and upper bound of the volume of the common material, if it was asked for.
    point : (float, float, float) or None
        Point that shows where the parts meet, in the world frame.
    normal : (float, float, float) or None
        Direction of length 1 in which `b` leaves `a` near the point, or faces it across the gap.
    faces : (int, int) or None
        The nearest faces of `a` and `b` to the point, if both are meshes.
    box : pair of (float, float, float) or None
        Lower and upper corner of the box where the boxes of the parts overlap, or of the box
        between them.
    status : {"new", "active", "reviewed", "approved"}
        State of the clash, which carries over from the previous report.
    proved : bool
        Whether the kind is proved.
    why : str or None
        Reason why the kind is not proved.
    inner : {"a", "b"} or None
        The part of a contained pair that lies inside the other.
    rule, severity, note : str or None
        Name of the rule, the severity that it states, and the remark of the previous report.
    accepted : float or None
        Depth or gap at which the clash was reviewed or approved.
    sentence : str
        What happens, such as ``"pipe 'P-12' enters wall 'W-3' by 36 mm"``.
    """

    id: str
    kind: str
    a: ClashPart
    b: ClashPart
    depth: tuple[float, float] | None
    gap: tuple[float, float] | None
    volume: tuple[float, float] | None
    point: tuple[float, float, float] | None
    normal: tuple[float, float, float] | None
    faces: tuple[int, int] | None
    box: tuple[tuple[float, float, float], tuple[float, float, float]] | None
    status: str
    proved: bool
    why: str | None
    inner: str | None
    rule: str | None
    severity: str | None
    note: str | None
    accepted: float | None
    sentence: str


@dataclass(frozen=True)
class ClashDuplicates:
    """Parts that are the same shape in the same place.

    Attributes
    ----------
    id, status : str
        As for `Clash`.
    parts : tuple of ClashPart
        The parts, two or more.
    """

    id: str
    status: str
    parts: tuple[ClashPart, ...]


@dataclass(frozen=True)
class ClashGroup:
    """Clashes that belong together.

    Attributes
    ----------
    shared : tuple of str
        What the clashes share: a part as ``"label/key"``, or the types or labels of both parts.
    clashes : tuple of Clash
        The clashes, the worst first.
    sentence : str
        The number of clashes, and the worst of them.
    """

    shared: tuple[str, ...]
    clashes: tuple[Clash, ...]
    sentence: str


@dataclass(frozen=True)
class ClashDiff:
    """Identities of clashes and duplicates of two reports, each sorted.

    Attributes
    ----------
    new, known, gone : tuple of str
        Identities that only the newer report has, that both have, and that only the older one has.
    """

    new: tuple[str, ...]
    known: tuple[str, ...]
    gone: tuple[str, ...]


class ClashReport:
    """The clashes that `clash` found, the worst first. It is a sequence of `Clash`.

    Attributes
    ----------
    counts : dict of str to int
        Number of pairs of each kind. ``"candidates"`` are the pairs whose boxes are near each
        other, of which ``"unchecked"`` and ``"ignored"`` ones were not compared.
    """

    counts: dict[str, int]

    def __init__(self, answer: dict[str, Any]) -> None:
        self.counts = dict(answer["counts"])
        self._json: str = answer["json"]
        self._csv: str = answer["csv"]
        self._sentences: list[str] = answer["sentences"]
        self._groups: dict[str, Any] = dict(answer["groups"])
        self._page: _impinge.ClashPage | str = answer["page"]

    def __getstate__(self) -> dict[str, Any]:
        """Return the state with the page instead of the scenes."""
        return {**self.__dict__, "_page": self.to_html()}

    @cached_property
    def _all(self) -> dict[str, Any]:
        """The JSON object."""
        found: dict[str, Any] = json.loads(self._json)
        return found

    @cached_property
    def _clashes(self) -> tuple[Clash, ...]:
        rows = zip(self._all["clashes"], self._sentences, strict=True)
        return tuple(_clash(row, sentence) for row, sentence in rows)

    def __len__(self) -> int:
        """Return the number of clashes, without duplicates."""
        return len(self._sentences)

    def __iter__(self) -> Iterator[Clash]:
        """Iterate over the clashes, the worst first."""
        return iter(self._clashes)

    def __getitem__(self, at: int) -> Clash:
        """Return the clash with an index."""
        return self._clashes[at]

    @property
    def decades(self) -> tuple[tuple[float, float, int], ...]:
        """For each decade of depth that is not empty: its least depth, its end and its pairs."""
        return tuple((row["from"], row["to"], row["pairs"]) for row in self._all["decades"])

    @property
    def tolerance(self) -> float:
        """The tolerance that was asked for, or the default, in the unit of the scenes."""
        return float(self._all["asked"]["tolerance"])

    @property
    def duplicates(self) -> tuple[ClashDuplicates, ...]:
        """Sets of duplicates."""
        rows = self._all["duplicates"]
        return tuple(ClashDuplicates(row["id"], row["status"], tuple(map(_part, row["parts"]))) for row in rows)

    @property
    def gone(self) -> tuple[str, ...] | None:
        """Identities of the previous report that no longer exist; None without a previous one."""
        return tuple(row["id"] for row in self._all["gone"]) if "gone" in self._all else None

    @property
    def a(self) -> NDArray[np.str_]:
        """Key of the first part of each clash, (k,)."""
        return _texts(each.a.key for each in self)

    @property
    def b(self) -> NDArray[np.str_]:
        """Key of the second part of each clash, (k,)."""
        return _texts(each.b.key for each in self)

    @property
    def kind(self) -> NDArray[np.str_]:
        """Kind of each clash, (k,)."""
        return _texts(each.kind for each in self)

    @property
    def depth(self) -> NDArray[np.float64]:
        """Lower and upper bound of each depth, (k, 2); NaN for a clash without one."""
        return _numbers((each.depth for each in self), 2)

    @property
    def gap(self) -> NDArray[np.float64]:
        """Lower and upper bound of each gap, (k, 2); NaN for a clash without one."""
        return _numbers((each.gap for each in self), 2)

    @property
    def point(self) -> NDArray[np.float64]:
        """Point where the parts of each clash meet, (k, 3); NaN for a clash without one."""
        return _numbers((each.point for each in self), 3)

    @property
    def box(self) -> NDArray[np.float64]:
        """Lower and upper corner of the box of each clash, (k, 2, 3); NaN for unbounded parts."""
        flat = (None if each.box is None else each.box[0] + each.box[1] for each in self)
        return _numbers(flat, 6).reshape(-1, 2, 3)

    def groups(self, by: Literal["part", "type", "scene"] = "part") -> tuple[ClashGroup, ...]:
        """Return the clashes in groups, the largest first.

        Parameters
        ----------
        by : {"part", "type", "scene"}
            ``"part"``: the part with the most clashes takes all of them, then the part with the
            most of those that are left, and so on. ``"type"`` and ``"scene"``: by the types of both
            parts, or the labels of their scenes.
        """
        rows = self._groups[chosen(by, ("part", "type", "scene"), "by")]
        clashes = self._clashes
        return tuple(ClashGroup(tuple(shared), tuple(clashes[i] for i in at), text) for shared, at, text in rows)

    def diff(self, old: ClashReport) -> ClashDiff:
        """Compare the identities of clashes and duplicates with those of an older report.

        Parameters
        ----------
        old : ClashReport
            The older report. The labels of its scenes must be the same.
        """
        if not isinstance(old, ClashReport):
            raise InputError(f"must be an impinge.ClashReport, not {type(old).__name__}", kind="type", what="old")
        now, before = self._ids, old._ids
        new, known, gone = (tuple(sorted(ids)) for ids in (now - before, now & before, before - now))
        return ClashDiff(new, known, gone)

    @property
    def _ids(self) -> set[str]:
        return {row["id"] for row in self._all["clashes"] + self._all["duplicates"]}

    def to_json(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return the report as one JSON object of schema ``impinge.clash/1``; also write it.

        Parameters
        ----------
        path : str or os.PathLike, optional
            The file to write. `clash` reads it as `previous`.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        return _written(self._json, path)

    def to_csv(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return the report as CSV, with one row a clash; also write it.

        Parameters
        ----------
        path : str or os.PathLike, optional
            The file to write.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        return _written(self._csv, path)

    def to_html(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return a page that shows the report in a browser, without a network; also write it.

        Parameters
        ----------
        path : str or os.PathLike, optional
            The file to write.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        return _written(self._page if isinstance(self._page, str) else self._page.html(), path)

    def _repr_html_(self) -> str:
        """Return the page for a notebook."""
        page = html.escape(self.to_html())
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 640px; border: 0" title="{self!r}"></iframe>'

    def frame(self) -> dict[str, NDArray[Any]]:
        """Return the clashes as columns of a table, for example for ``pandas.DataFrame``."""
        sides = {"a": [each.a for each in self], "b": [each.b for each in self]}
        fields = ("scene", "key", "type", "name")
        parts = {f"{side}_{of}": _texts(getattr(p, of) for p in some) for side, some in sides.items() for of in fields}
        bounds = {"depth": self.depth, "gap": self.gap}
        ends = {f"{of}_{end}": rows[:, at] for of, rows in bounds.items() for at, end in enumerate(("lower", "upper"))}
        texts = ("id", "kind", "status", "rule", "severity")
        return {
            **{of: _texts(getattr(each, of) or "" for each in self) for of in texts},
            **ends,
            **dict(zip("xyz", self.point.T, strict=True)),
            **parts,
            "proved": np.array([each.proved for each in self], bool),
            "why": _texts(each.why or "" for each in self),
        }

    def __repr__(self) -> str:
        """Return the number of clashes of each kind, and of duplicate sets."""
        found = Counter(row["kind"] for row in self._all["clashes"])
        found["duplicate"] = len(self._all["duplicates"])
        return f"ClashReport({', '.join(f'{count} {kind}' for kind, count in found.items() if count) or 'clear'})"


def _part(row: dict[str, Any]) -> ClashPart:
    return ClashPart(row["scene"], row["key"], row["name"], row.get("type", ""), tuple(row.get("path", ())))


def _clash(row: dict[str, Any], sentence: str) -> Clash:
    fields: dict[str, Any] = {of: row[of] for of in ("id", "kind", "status", "proved")}
    fields |= {of: row.get(of) for of in ("why", "inner", "rule", "severity", "note", "accepted")}
    fields |= {of: _part(row[of]) for of in ("a", "b")}
    fields |= {of: _interval(row.get(of)) for of in ("depth", "gap", "volume")}
    fields |= {of: tuple(row[of]) if of in row else None for of in ("point", "normal", "faces")}
    fields["box"] = tuple(map(tuple, row["box"])) if "box" in row else None
    return Clash(sentence=sentence, **fields)


def _interval(bounds: list[float | None] | None) -> tuple[float, float] | None:
    """Return bounds; an upper bound that is not known becomes infinite."""
    if bounds is None:
        return None
    lower, upper = bounds
    return (lower or 0.0, math.inf if upper is None else upper)


def _texts(values: Any) -> NDArray[np.str_]:
    return np.array(list(values), np.str_)


def _numbers(rows: Any, width: int) -> NDArray[np.float64]:
    missing = (math.nan,) * width
    return np.array([missing if row is None else row for row in rows], np.float64).reshape(-1, width)


def _written(text: str, path: str | os.PathLike[str] | None) -> str:
    """Return a text. If there is a path, write it to that file first."""
    if path is not None:
        Path(path_of(path, "path")).write_text(text, encoding="utf-8", newline="")
    return text
