"""Finds the parts of scenes that run into each other, and how deep."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from impinge._clash_report import ClashReport
from impinge._engine import engine
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._scalars import flag, path_of, real
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
        The previous report, or the file to which it was written as JSON. Statuses carry over from
        it, and `ClashReport.gone` lists what is gone.
    contacts : bool
        Whether pairs that touch are listed, too.
    volume : bool
        Whether to compute the volume of the material that two parts share.
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
    answer = engine(on).clash(
        [(label, _parts(scene), list(scene._ignored_places())) for label, scene in labeled.items()],
        _unit(labeled),
        (_length(tolerance, "tolerance"), _length(clearance, "clearance")),
        (flag(between, "between"), flag(contacts, "contacts"), flag(volume, "volume")),
        (_rules(rules), [previous.to_json()] if isinstance(previous, ClashReport) else _path(previous, "previous")),
        progress,
    )
    return ClashReport(answer)


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


def _parts(scene: Scene) -> list[Any]:
    """Return names, meshes or shapes, poses and details of the parts."""
    poses = scene.poses
    details = {name: scene.details(name) for name in poses}
    return [
        (name, part, poses[name], (details[name].key, details[name].type, list(details[name].path)))
        for name, part in scene.parts.items()
    ]


def _unit(labeled: dict[str, Scene]) -> str | None:
    """Return the unit that all loaded meshes share, or None if none has one."""
    units: dict[str, str] = {}
    for label, scene in labeled.items():
        for part in scene.parts.values():
            if isinstance(part, Mesh) and part.origin is not None and part.origin.unit is not None:
                units.setdefault(part.origin.unit, label)
    if len(units) > 1:
        message = "have different units: " + ", ".join(f"{label!r} is in {unit}" for unit, label in units.items())
        raise InputError(message, kind="unit", what="scenes", hint="pass one unit= to load_scene for all of them")
    return next(iter(units), None)


def _length(value: Any, name: str) -> float | str | None:
    return value if value is None or isinstance(value, str) else real(value, name, minimum=0)


def _rules(rules: Any) -> list[str] | str | None:
    return [rules] if isinstance(rules, str) and "\n" in rules else _path(rules, "rules")


def _path(value: Any, name: str) -> str | None:
    return None if value is None else path_of(value, name)
