"""The rows of a report of clashes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any


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
    curves : tuple of tuple of (float, float, float), or None
        Polylines in which the surfaces of the parts intersect, if they were asked for, as
        `intersection_curves` returns them. None if a part is not a mesh, or if there is a gap.
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
    curves: tuple[tuple[tuple[float, float, float], ...], ...] | None
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


def part_of(row: dict[str, Any]) -> ClashPart:
    return ClashPart(row["scene"], row["key"], row["name"], row.get("type", ""), tuple(row.get("path", ())))


def clash_of(row: dict[str, Any], sentence: str) -> Clash:
    fields: dict[str, Any] = {of: row[of] for of in ("id", "kind", "status", "proved")}
    fields |= {of: row.get(of) for of in ("why", "inner", "rule", "severity", "note", "accepted")}
    fields |= {of: part_of(row[of]) for of in ("a", "b")}
    fields |= {of: _interval(row.get(of)) for of in ("depth", "gap", "volume")}
    fields |= {of: tuple(row[of]) if of in row else None for of in ("point", "normal", "faces")}
    lines = row.get("curves")
    fields["curves"] = None if lines is None else tuple(tuple(map(tuple, line)) for line in lines)
    fields["box"] = tuple(map(tuple, row["box"])) if "box" in row else None
    return Clash(sentence=sentence, **fields)


def _interval(bounds: list[float | None] | None) -> tuple[float, float] | None:
    """Return bounds; an upper bound that is not known becomes infinite."""
    if bounds is None:
        return None
    lower, upper = bounds
    return (lower or 0.0, math.inf if upper is None else upper)
