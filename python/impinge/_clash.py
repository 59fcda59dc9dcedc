"""Finds the parts of scenes that run into each other, and how deep."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

from impinge._clash_report import ClashReport
from impinge._engine import engine
from impinge._errors import InputError
from impinge._parts import origins, parts_of, unit_of, up_of
from impinge._scalars import chosen, flag, path_of, real
from impinge._scene import Scene

if TYPE_CHECKING:
    from impinge.cluster import Cluster

_LABEL = "scene"
"""Label of a scene that has none."""


def clash(
    scenes: Scene | Mapping[str, Scene],
    *,
    between: bool = False,
    tolerance: float | str | None = None,
    clearance: float | str | None = None,
    rules: str | os.PathLike[str] | None = None,
    previous: ClashReport | str | os.PathLike[str] | None = None,
    contacts: bool = False,
    volume: bool = False,
    curves: bool = False,
    up: Literal["x", "y", "z"] | None = None,
    progress: bool = False,
    on: Cluster | None = None,
) -> ClashReport:
    """Find the parts of scenes that run into each other, and how deep.

    Parts are solids, whatever the scene says. Each pair of parts has one kind: duplicate,
    contained, clash, contact, clearance or clear. Pairs that a scene ignores are not checked.

    Parameters
    ----------
    scenes : Scene or mapping of str to Scene
        The scenes by label. The label belongs to the identity of each clash. Without a mapping it
        is ``"scene"``.
    between : bool
        Whether only parts of different scenes are compared.
    tolerance : float or str, optional
        Depth up to which parts may overlap, in the unit of the scenes, or a text like ``"2mm"``. By
        default it is that of the rules, 0.1 mm, or a millionth of the size of the scenes if their
        unit is not known. The default is at least 16 units in the last place of the largest float32
        coordinate.
    clearance : float or str, optional
        Gap that pairs must have; pairs with a smaller one are listed.
    rules : str or os.PathLike, optional
        A file of sets, rules, ignores and accepted clashes: ``.toml``, a ``.csv`` matrix of groups,
        or the ``.json`` clash sets of IfcClash. A str of more than one line is the text of a TOML
        file.
    previous : ClashReport, str or os.PathLike, optional
        The previous report, or the file to which it was written as JSON or BCF. Statuses carry over
        from it, and `ClashReport.gone` lists what is gone.
    contacts : bool
        Whether pairs that touch are listed, too.
    volume : bool
        Whether to compute the volume of the material that two parts share.
    curves : bool
        Whether to trace the curves in which the surfaces of two parts intersect. With `on` they are
        traced by the threads of this process.
    up : {"x", "y", "z"}, optional
        The axis of the scenes that points up in pictures, pages and BCF. By default it is y if a
        mesh was loaded from glTF, and z otherwise.
    progress : bool
        Whether to show the number of finished pairs in one line of stderr during the call. The
        pairs are searched a second time for it.
    on : impinge.cluster.Cluster, optional
        Cluster on which the pairs are compared; by default the threads of this process. The report
        is the same, byte for byte.

    Returns
    -------
    ClashReport
        It is the same for any number of threads and any order of parts and scenes.

    Raises
    ------
    OSError
        If a file cannot be read.
    InputError
        If an argument is invalid; if scenes have different units; if a file is not one of rules or
        a report, in which case the error names the line; or if a rule names an unknown set, or one
        without parts.

    See Also
    --------
    depth : The depth of one pair.

    Examples
    --------
    >>> import impinge
    >>> corners = [[0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8]]
    >>> solid = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> scene = impinge.Scene({"floor": solid, "roof": solid}, poses={"roof": impinge.pose([0.5, 0.5, -7.5])})
    >>> report = impinge.clash(scene, tolerance=0.01)
    >>> report
    ClashReport(1 clash)
    >>> [(each.kind, each.a.name, each.b.name) for each in report]
    [('clash', 'floor', 'roof')]
    """
    labeled = _labeled(scenes)
    if flag(between, "between") and len(labeled) < 2:
        message = "compares parts of different scenes, and there is one scene"
        raise InputError(message, kind="option", what="between", hint="pass a mapping of labels to scenes")
    question = (
        [(label, parts_of(scene), scene._ignored_places()) for label, scene in labeled.items()],
        (unit_of(labeled), up_of(labeled) if up is None else chosen(up, ("x", "y", "z"), "up")),
        (_length(tolerance, "tolerance"), _length(clearance, "clearance")),
        (flag(between, "between"), flag(contacts, "contacts"), flag(volume, "volume"), flag(curves, "curves")),
        (_rules(rules), [previous.to_json()] if isinstance(previous, ClashReport) else _path(previous, "previous")),
    )
    return ClashReport(engine(on).clash(question, progress), _date(labeled))


def _labeled(scenes: Any) -> dict[str, Scene]:
    """Return scenes by label."""
    labeled = {_LABEL: scenes} if isinstance(scenes, Scene) else scenes
    if not isinstance(labeled, Mapping):
        message = f"must be an impinge.Scene or a mapping of labels to scenes, not {type(scenes).__name__}"
        raise InputError(message, kind="type", what="scenes")
    for label, scene in labeled.items():
        if not isinstance(label, str) or not isinstance(scene, Scene):
            message = f"scene {label!r} is {type(scene).__name__}; pass str labels and impinge.Scene"
            raise InputError(message, kind="type", what="scenes")
    return dict(labeled)


def _date(labeled: Mapping[str, Scene]) -> int:
    """Return the date of the newest file in seconds since 1970, or the one that is set."""
    stated = os.environ.get("SOURCE_DATE_EPOCH", "")
    if stated.lstrip("-").isdecimal():
        return int(stated)
    paths = {origin.path for _, origin in origins(labeled) if origin.path}
    return max((int(os.path.getmtime(path)) for path in paths if os.path.exists(path)), default=0)


def _length(value: Any, name: str) -> float | str | None:
    return value if value is None or isinstance(value, str) else real(value, name, minimum=0)


def _rules(rules: Any) -> list[str] | str | None:
    return [rules] if isinstance(rules, str) and "\n" in rules else _path(rules, "rules")


def _path(value: Any, name: str) -> str | None:
    return None if value is None else path_of(value, name)
