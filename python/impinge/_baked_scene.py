"""Folders with a baked scene: the meshes in one file that is mapped, and a list of the parts.

The file ``meshes`` has the baked meshes one after the other, each at a multiple of 64. The file
``parts.ndjson`` has one JSON object in each line: first the version, then meshes with their places,
parts, and pairs that are ignored. A part names its mesh by its number.
"""

from __future__ import annotations

import json
import mmap
import os
from collections.abc import Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from impinge import _impinge
from impinge._baked import opened
from impinge._details import Details
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._origin import Origin
from impinge._stored import Stored, header_of, provenance_of

if TYPE_CHECKING:
    from impinge._scene import Scene

_MESHES, _PARTS = "meshes", "parts.ndjson"
_ALIGNMENT = 64
_VERSION = 1


def is_baked_scene(path: str) -> bool:
    """Report whether a path is that of a folder with a baked scene."""
    return os.path.isfile(os.path.join(path, _PARTS))


def bake_scene(scene: Scene, folder: str) -> None:
    """Add the parts of a scene to a folder; see `Scene.bake`."""
    for name, part in scene.parts.items():
        if not isinstance(part, Mesh):
            message = f"part {name!r} is {type(part).__name__}; only meshes can be baked"
            raise InputError(message, kind="type", what="parts")
    os.makedirs(folder, exist_ok=True)
    listed = os.path.join(folder, _PARTS)
    records = list(_records(listed)) if is_baked_scene(folder) else []
    names = {record["part"] for record in records if "part" in record}
    for name in scene.parts:
        if name in names:
            hint = "bake into another folder, or rename the part"
            raise InputError(f"the folder has a part {name!r} already", kind="name", what="parts", hint=hint)
    if any(record["solid"] != scene._solid for record in records[:1]):
        raise InputError("must be that of the scene in the folder", kind="option", what="solid")
    first = sum("mesh" in record for record in records)
    if not records:
        records.append({"version": _VERSION, "solid": scene._solid})
    numbers: dict[int, int] = {}
    with open(os.path.join(folder, _MESHES), "ab") as file:
        for name, part in scene.parts.items():
            if id(part) not in numbers:
                numbers[id(part)] = first + len(numbers)
                records.append({"mesh": numbers[id(part)], **_written(part, file)})
            records.append({"part": name, "of": numbers[id(part)], **_about(scene, name)})
        file.flush()
        os.fsync(file.fileno())
    order = list(scene.parts)
    records += [{"ignored": pair} for pair in sorted(sorted((order[i], order[j])) for i, j in scene._ignored)]
    _replace(listed, "".join(json.dumps(record) + "\n" for record in records))


def _written(mesh: Any, file: Any) -> dict[str, Any]:
    """Append a baked mesh to a file, and return its place."""
    file.seek(0, os.SEEK_END)
    file.write(bytes(-file.tell() % _ALIGNMENT))
    start = file.tell()
    content = _impinge.to_baked(mesh, mesh._origin_data(), False)
    file.write(content)
    return {"start": start, "size": len(content), "format": mesh.origin.format if mesh.origin else None}


def _about(scene: Scene, name: str) -> dict[str, Any]:
    """Return the pose and the details of a part."""
    details, pose = scene.details(name), scene.poses[name]
    about: dict[str, Any] = {}
    if not np.array_equal(pose, np.eye(4)):
        about["pose"] = pose.ravel().tolist()
    if details != Details():
        about["details"] = [details.key, details.type, list(details.path), dict(details.extras)]
    return about


def _replace(path: str, text: str) -> None:
    """Write a file at once: a reader finds the old content or the new one."""
    temporary = f"{path}.{os.getpid()}.tmp"
    try:
        with open(temporary, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            os.remove(temporary)
        raise


def _records(path: str) -> Iterator[dict[str, Any]]:
    """Iterate over the objects in the lines of the list of parts, the version first."""
    with open(path, "rb") as file:
        for number, line in enumerate(file, 1):
            try:
                record = json.loads(line)
                if not isinstance(record, dict):
                    raise ValueError("not an object")
            except (ValueError, RecursionError) as error:
                raise _damaged(path, number, str(error)) from None
            if number == 1 and record.get("version") != _VERSION:
                message = f"version {record.get('version')} of baked scenes is not supported"
                raise InputError(message, kind="unsupported", what=path, where=None, hint="bake the scene again")
            yield record


def _damaged(path: str, line: int, message: str) -> InputError:
    message = f"the list of parts is damaged: {message}"
    return InputError(message, kind="corrupt", what=path, where=f"line {line}", hint="bake the scene again")


class BakedScene:
    """Content of a folder with a baked scene.

    Parameters
    ----------
    folder : str
        Path of the folder.

    Attributes
    ----------
    parts, poses, details, ignored, solid
        Arguments of `Scene`.
    """

    def __init__(self, folder: str) -> None:
        self.parts: dict[str, Mesh] = {}
        self.poses: dict[str, Any] = {}
        self.details: dict[str, Details] = {}
        self.ignored: list[tuple[str, str]] = []
        self.solid = False
        self._path = os.path.abspath(os.path.join(folder, _MESHES))
        self._meshes: list[Mesh] = []
        listed = os.path.join(folder, _PARTS)
        content = _mapped(self._path)
        for number, record in enumerate(_records(listed), 1):
            try:
                self._read(record, content)
            except (KeyError, TypeError, AttributeError, ValueError, IndexError, OverflowError) as error:
                if isinstance(error, InputError):
                    raise
                raise _damaged(listed, number, f"{type(error).__name__}: {error}") from None

    def _read(self, record: dict[str, Any], content: memoryview) -> None:
        if "mesh" in record:
            self._meshes.append(self._mesh(content, record["start"], record["size"], record["format"]))
        elif "part" in record:
            name = record["part"]
            name.encode()  # raises an error if it has half of a surrogate pair
            if not 0 <= record["of"] < len(self._meshes) or name in self.parts:
                raise ValueError("a part names no mesh, or its name is taken")
            self.parts[name] = self._meshes[record["of"]]
            if "pose" in record:
                self.poses[name] = np.array(record["pose"], np.float64).reshape(4, 4)
            if "details" in record:
                key, kind, path, extras = record["details"]
                self.details[name] = Details(key, kind, tuple(path), extras)
        elif "ignored" in record:
            a, b = record["ignored"]
            self.ignored.append((a, b))
        else:
            self.solid = record["solid"]

    def _mesh(self, content: memoryview, start: int, size: int, form: str | None) -> Mesh:
        """Return the mesh at a place in the mapped file."""
        baked = content[start : start + size]
        try:
            model = opened(baked)
        except InputError as error:
            where, hint = f"byte {start}", "bake the scene again"
            raise InputError(str(error), kind=error.kind, what=self._path, where=where, hint=hint) from None
        origin = None
        if form is not None:
            origin = Origin(self._path, form, model.unit, *provenance_of(baked), tuple(model.parts))
        mesh = Mesh._of(model, origin)
        mesh._stored = Stored(self._path, start, size, header_of(baked))
        return mesh


def _mapped(path: str) -> memoryview:
    """Return the content of a file, which the system reads when it is accessed."""
    with open(path, "rb") as file:
        if os.fstat(file.fileno()).st_size == 0:
            return memoryview(b"")
        return memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
