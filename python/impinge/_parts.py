"""The parts of scenes as the extension takes them, and the facts that their files state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._origin import Origin

if TYPE_CHECKING:
    from impinge._scene import Scene


def parts_of(scene: Scene) -> list[Any]:
    """Return names, meshes or shapes, poses and details of the parts of a scene."""
    poses = scene.poses
    details = {name: scene.details(name) for name in poses}
    return [
        (name, part, poses[name], (details[name].key, details[name].type, list(details[name].path)))
        for name, part in scene.parts.items()
    ]


def unit_of(labeled: Mapping[str, Scene]) -> str | None:
    """Return the unit that all loaded meshes share, or None if none has one."""
    units: dict[str, str] = {}
    for label, origin in origins(labeled):
        if origin.unit is not None:
            units.setdefault(origin.unit, label)
    if len(units) > 1:
        message = "have different units: " + ", ".join(f"{label!r} is in {unit}" for unit, label in units.items())
        raise InputError(message, kind="unit", what="scenes", hint="pass one unit= to load_scene for all of them")
    return next(iter(units), None)


def up_of(labeled: Mapping[str, Scene]) -> str:
    """Return the axis that points up by the formats of the files."""
    return "y" if any(origin.format in ("glTF", "GLB") for _, origin in origins(labeled)) else "z"


def origins(labeled: Mapping[str, Scene]) -> Iterator[tuple[str, Origin]]:
    """Iterate over the origins of loaded meshes, with the labels of their scenes."""
    for label, scene in labeled.items():
        for part in scene.parts.values():
            if isinstance(part, Mesh) and part.origin is not None:
                yield label, part.origin
