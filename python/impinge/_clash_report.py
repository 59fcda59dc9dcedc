"""The report of a search for clashes."""

from __future__ import annotations

import html
import json
import math
import os
from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._clash_rows import Clash, ClashDiff, ClashDuplicates, ClashGroup, clash_of, part_of
from impinge._errors import InputError
from impinge._picture import Picture, png_path, size_of
from impinge._scalars import chosen, path_of


class ClashReport:
    """The clashes that `clash` found, the worst first. It is a sequence of `Clash`.

    Attributes
    ----------
    counts : dict of str to int
        Number of pairs of each kind. ``"candidates"`` are the pairs whose boxes are near each
        other, of which ``"unchecked"`` and ``"ignored"`` ones were not compared.
    """

    counts: dict[str, int]

    def __init__(self, answer: dict[str, Any], date: int) -> None:
        self.counts = dict(answer["counts"])
        self._json: str = answer["json"]
        self._csv: str = answer["csv"]
        self._sentences: list[str] = answer["sentences"]
        self._groups: dict[str, Any] = dict(answer["groups"])
        self._files: _impinge.ClashFiles | str = answer["files"]
        self._date = date

    def __getstate__(self) -> dict[str, Any]:
        """Return the state with the page instead of the scenes."""
        return {**self.__dict__, "_files": self.to_html()}

    @cached_property
    def _all(self) -> dict[str, Any]:
        """The JSON object."""
        found: dict[str, Any] = json.loads(self._json)
        return found

    @cached_property
    def _clashes(self) -> tuple[Clash, ...]:
        rows = zip(self._all["clashes"], self._sentences, strict=True)
        return tuple(clash_of(row, sentence) for row, sentence in rows)

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
        return tuple(ClashDuplicates(row["id"], row["status"], tuple(map(part_of, row["parts"]))) for row in rows)

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
    def volume(self) -> NDArray[np.float64]:
        """Lower and upper bound of each common volume, (k, 2); NaN for a clash without one."""
        return _numbers((each.volume for each in self), 2)

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
        return _written(self._files if isinstance(self._files, str) else self._files.html(), path)

    def to_bcf(
        self, path: str | os.PathLike[str], version: Literal["2.1", "3.0"] = "2.1", *, date: datetime | None = None
    ) -> None:
        """Write the clashes as topics of a BCF file, with viewpoints and pictures.

        The topics are the groups of ``groups("part")``, and the sets of duplicates. `clash` reads
        the file as `previous`, also after another program changed statuses.

        Parameters
        ----------
        path : str or os.PathLike
            The file, whose name ends in ``.bcfzip`` or ``.bcf``.
        version : {"2.1", "3.0"}
            Version of BCF.
        date : datetime.datetime, optional
            Date of the topics. By default it is that of the newest file of the scenes, or the
            start of 1970 if they were not loaded. The environment variable ``SOURCE_DATE_EPOCH``
            replaces the default. No clock is read, so that the same scenes give the same bytes.

        Raises
        ------
        InputError
            If the name has another extension, the scenes state no unit (BCF is in meters), or the
            report was unpickled, which leaves its scenes behind.
        OSError
            If the file cannot be written.
        """
        text = path_of(path, "path")
        if Path(text).suffix.lower() not in (".bcfzip", ".bcf"):
            raise InputError(f"{text!r} does not end in .bcfzip or .bcf", kind="unsupported-format", what="path")
        chosen(version, ("2.1", "3.0"), "version")
        if date is not None and not isinstance(date, datetime):
            raise InputError(f"must be a datetime, not {type(date).__name__}", kind="type", what="date")
        seconds = self._date if date is None else int(date.timestamp())
        Path(text).write_bytes(self._with_scenes().bcf(version, seconds))

    def picture(
        self,
        clash: Clash | ClashDuplicates | str,
        *,
        path: str | os.PathLike[str] | None = None,
        size: tuple[int, int] = (960, 720),
    ) -> Picture:
        """Draw a clash: two parts in color among ghosts, and the curves in which they intersect.

        The first part is blue and the second is orange. The direction is one from which the contact
        is visible.

        Parameters
        ----------
        clash : Clash, ClashDuplicates or str
            An item of this report, or its identity.
        path : str or os.PathLike, optional
            A PNG file to write the picture to.
        size : (int, int)
            Width and height in pixels, 16 to 8192 each.

        Returns
        -------
        Picture
            The picture, which a notebook shows.

        Raises
        ------
        InputError
            If the report has no such item, a part of it is unbounded, an argument is invalid, or
            the report was unpickled, which leaves its scenes behind.
        OSError
            If the file cannot be written.
        """
        known = clash if isinstance(clash, str) else getattr(clash, "id", None)
        if not isinstance(known, str):
            message = f"must be an impinge.Clash, impinge.ClashDuplicates or an identity, not {type(clash).__name__}"
            raise InputError(message, kind="type", what="clash")
        if known not in self._ids:
            raise InputError(f"the report has no item {known!r}", kind="name", what="clash")
        if path is not None:
            png_path(path)
        pixels = self._with_scenes().picture(known, size_of(size))
        if pixels is None:
            raise InputError(f"a part of {known!r} is unbounded", kind="unbounded", what="clash")
        picture = Picture(pixels)
        if path is not None:
            picture.save(path)
        return picture

    def _with_scenes(self) -> _impinge.ClashFiles:
        if isinstance(self._files, str):
            message = "was unpickled, and a pickle does not have the scenes"
            raise InputError(message, kind="state", what="report", hint="call clash again, or draw before you pickle")
        return self._files

    def _repr_html_(self) -> str:
        """Return the page for a notebook."""
        page = html.escape(self.to_html())
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 640px; border: 0" title="{self!r}"></iframe>'

    def frame(self) -> dict[str, NDArray[Any]]:
        """Return the clashes as columns of a table, for example for ``pandas.DataFrame``."""
        sides = {"a": [each.a for each in self], "b": [each.b for each in self]}
        fields = ("scene", "key", "type", "name")
        parts = {f"{side}_{of}": _texts(getattr(p, of) for p in some) for side, some in sides.items() for of in fields}
        bounds = {"depth": self.depth, "gap": self.gap, "volume": self.volume}
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
