"""The part of a call that runs on a node: makes the parts of a task, and answers its question.

A task is pure: it reads its arguments and returns its answer. Ray may therefore run it again.
"""

from __future__ import annotations

import os
import pickle
import platform
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._baked import opened
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._motion import constructor
from impinge._shape import AnyShape
from impinge._stored import Stored
from impinge._threads import threads
from impinge.cluster._robot_contents import contents_of

Parcel = NDArray[np.uint8]
"""Bytes of several parts, as they are in the object store."""

_MAX_CACHED_BYTES = 1 << 28
"""Maximum size in bytes of the parts that a worker keeps for later tasks, besides those of the last
task. A part that is kept is not validated again, and its parcel stays in memory."""

_BYTES_OF_MAPPED = 1 << 20
"""Size in bytes that a part in a mapped file counts for, because the system may drop its pages. It
limits the number of files that a worker keeps open."""


@dataclass(frozen=True)
class Place:
    """Place of the bytes of a part in a parcel."""

    name: str
    """Name of the part, for error messages."""
    digest: bytes
    """SHA-256 of the bytes."""
    is_mesh: bool
    """Whether the bytes are a baked mesh. Otherwise they are a pickled shape."""
    parcel: int
    """Index of the parcel among those of the task."""
    start: int
    """Offset of the first byte in the parcel."""
    size: int
    """Number of bytes."""


@dataclass(frozen=True)
class StoredPlace:
    """Place of the bytes of a part in a file that all nodes share."""

    name: str
    """Name of the part, for error messages."""
    stored: Stored
    """Place of the baked mesh in the file, and its header."""


@dataclass(frozen=True)
class Use:
    """Memory and files that a task used."""

    node: str
    """Machine, and process number of the program of Ray that started the worker."""
    process: int
    """Process number of the worker."""
    memory: int
    """Private memory of the worker at the end of the task in bytes, without mapped files and the
    object store. It is 0 on systems other than Linux."""
    mapped: int
    """Number of bytes of files that the task mapped."""


class VersionError(RuntimeError):
    """Raised by a worker that has another version of impinge than the process that called it."""


def answer(
    version: str,
    function: str,
    places: list[Place | StoredPlace],
    arguments: tuple[Any, ...],
    *parcels: Parcel,
) -> tuple[Any, Use]:
    """Return the answer of one task, and what it used.

    Parameters
    ----------
    version : str
        Version of impinge of the process that asks.
    function : str
        Name of a function of this module, as in `_FUNCTIONS`.
    places : list of Place or StoredPlace
        Parts of the task.
    arguments : tuple
        Arguments of the function after the parts.
    parcels : arrays of bytes
        The parcels that contain the parts.
    """
    if version != _impinge.__version__:
        message = f"the caller has impinge {version}, and a worker has {_impinge.__version__}"
        raise VersionError(f"{message}: install the same version on each node")
    before = _parts.mapped
    with threads(1):  # Ray gives a task one processor
        parts = _parts.of(places, parcels)
        found = _FUNCTIONS[function](parts, *arguments)
    node = f"{platform.node()}, raylet {os.getppid()}"
    return found, Use(node, os.getpid(), private_memory(), _parts.mapped - before)


def rows(
    parts: list[AnyShape], verb: str, poses: tuple[Any, Any], options: tuple[Any, ...], rest: tuple[Any, ...]
) -> Any:
    """Return the answers of a query of two things for some rows."""
    solid, on_error = options
    return getattr(_impinge, verb)((parts[0], parts[-1], *poses, solid, on_error, False), *rest)


def sweeps(parts: list[AnyShape], made_of: tuple[Any, Any], solid: Any, rest: tuple[Any, ...]) -> Any:
    """Return the times of impact of two things in some motions.

    `made_of` has the arguments from which the motions are made. It is empty for a body at rest.
    """
    motions = [constructor(arguments)(*arguments) if arguments else None for arguments in made_of]
    return _impinge.time_of_impact((parts[0], parts[-1], *motions, solid, False), *rest)


def share(parts: list[AnyShape], poses: tuple[Any, Any], number: int, count: int) -> Any:
    """Return the pairs of faces of one share of the search of two meshes."""
    return _impinge.intersecting_pairs_in((parts[0], parts[-1], *poses, False, "raise", False), number, count)


@dataclass(frozen=True)
class Placed:
    """Parts of a scene in their order."""

    which: list[int]
    """For each part, its index among the distinct parts of the task."""
    poses: Any
    """For each part, its poses, or None, or the index of its pose in `fixed`; or an array of one
    pose for each part."""
    solid: bool
    """Whether meshes are solids."""
    fixed: NDArray[np.float64] | None = None
    """Poses of parts that do not move, in one array, which is sent faster than many."""

    def of(self, parts: list[AnyShape]) -> list[tuple[str, Any, bool, Any]]:
        """Return the parts in the form that the extension takes."""
        numbered = enumerate(zip(self.which, self.poses, strict=True))
        return [(str(at), parts[part], self.solid, self._pose(pose)) for at, (part, pose) in numbered]

    def _pose(self, pose: Any) -> Any:
        return self.fixed[pose] if isinstance(pose, int) and self.fixed is not None else pose


def scene_rows(
    parts: list[AnyShape], placed: Placed, ignored: NDArray[np.uint32], options: tuple[Any, bool, str]
) -> Any:
    """Return the pairs that are found in some configurations of a scene."""
    question, first, on_error = options
    return _impinge.check_scene(placed.of(parts), ignored, question, first, on_error, False)


def scene_pairs(
    parts: list[AnyShape],
    placed: Placed,
    numbers: NDArray[np.uint32],
    pairs: NDArray[np.uint32],
    question: tuple[str, float],
) -> Any:
    """Return those of some pairs of parts that are found, by the numbers of the parts in the scene.

    The second array marks the pairs that are undecided.
    """
    found, undecided = _impinge.check_pairs(placed.of(parts), pairs, question)
    return numbers[found], undecided


def clash_pairs(
    parts: list[AnyShape],
    places: tuple[list[int], NDArray[np.float64]],
    pairs: NDArray[np.uint32],
    asked: NDArray[np.float64],
    listed: tuple[bool, bool],
) -> Any:
    """Return the findings of some pairs of parts, for the tolerance and the clearance of each.

    `places` has the index of each part among the distinct parts of the task, and its pose. `listed`
    tells whether contacts are listed, and whether volumes are computed.
    """
    placed = [(parts[part], pose) for part, pose in zip(*places, strict=True)]
    return _impinge.clash_pairs(placed, pairs, asked, listed)


def robot_check(parts: list[Any], content: str, rows: list[Any], placed: Placed, rest: tuple[Any, ...]) -> Any:
    """Return the collisions of a robot, the first part, in some configurations."""
    first, paddings, ignored = rest
    core, obstacles = _core(parts, content), placed.of(parts)
    return _impinge.robot_check(core, rows[0], first, paddings, obstacles, ignored, False)


def robot_clearance(parts: list[Any], content: str, rows: list[Any], placed: Placed, rest: tuple[Any, ...]) -> Any:
    """Return the clearances of a robot, the first part, in some configurations."""
    limit, ignored = rest
    return _impinge.robot_clearance(_core(parts, content), rows[0], limit, placed.of(parts), ignored, False)


def robot_motions(parts: list[Any], content: str, rows: list[Any], placed: Placed, rest: tuple[Any, ...]) -> Any:
    """Return the verdicts about some motions of a robot, the first part."""
    clearances, ignored, max_steps, keeps_certificate = rest
    surroundings = clearances, placed.of(parts), ignored
    ends = rows[0], rows[1]
    return _impinge.robot_motions(_core(parts, content), ends, surroundings, max_steps, keeps_certificate, False)


def _core(parts: list[Any], content: str) -> _impinge.RobotCore:
    """Return the robot of a task, which must be that of the caller."""
    robot = parts[0]
    if contents_of(robot) != content:
        message = f"the files of {robot!r} on a worker are not those of the caller"
        raise InputError(message, kind="robot", what="robot", hint="give each node the same files at the same paths")
    core: _impinge.RobotCore = robot._core
    return core


_FUNCTIONS: dict[str, Any] = {
    "robot_check": robot_check,
    "robot_clearance": robot_clearance,
    "robot_motions": robot_motions,
    "rows": rows,
    "share": share,
    "sweeps": sweeps,
    "scene_rows": scene_rows,
    "scene_pairs": scene_pairs,
    "clash_pairs": clash_pairs,
}


class _Parts:
    """Parts that this process has made, the last used last.

    Attributes
    ----------
    mapped : int
        Number of bytes of all files that were mapped.
    """

    def __init__(self) -> None:
        self._kept: OrderedDict[bytes, tuple[int, AnyShape]] = OrderedDict()
        self._bytes = 0
        self.mapped = 0

    def of(self, places: list[Place | StoredPlace], parcels: tuple[Parcel, ...]) -> list[AnyShape]:
        """Return the parts at some places."""
        parts = [self._part(place, parcels) for place in places]
        while self._bytes > _MAX_CACHED_BYTES and len(self._kept) > len(places):
            _, (size, _) = self._kept.popitem(last=False)
            self._bytes -= size
        return parts

    def _part(self, place: Place | StoredPlace, parcels: tuple[Parcel, ...]) -> AnyShape:
        key = place.stored.header if isinstance(place, StoredPlace) else place.digest
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key][1]
        part: AnyShape
        if isinstance(place, StoredPlace):
            size, part = _BYTES_OF_MAPPED, _mapped(place)
            self.mapped += place.stored.size
        else:
            size, part = place.size, _made(place, parcels[place.parcel][place.start : place.start + place.size])
        self._kept[key] = size, part
        self._bytes += size
        return part


def _made(place: Place, content: Parcel) -> AnyShape:
    if not place.is_mesh:
        shape: AnyShape = pickle.loads(content.data)
        return shape
    try:
        return Mesh._of(opened(content.data), None)  # without the origin of its faces
    except InputError as error:
        message = f"part {place.name!r} did not reach the worker as it was sent: {error}"
        raise InputError(message, kind=error.kind, what="parts", hint="run the call again") from None


def _mapped(place: StoredPlace) -> Mesh:
    """Return the mesh in a file, which must be the file of the caller."""
    file = f"part {place.name!r} in the file {place.stored.path!r} on a worker"
    try:
        return Mesh._of(opened(place.stored.mapped()), None)
    except InputError as error:
        message = f"{file} is damaged: {error}"
        raise InputError(message, kind=error.kind, what="parts", hint="bake the part again") from None
    except (OSError, ValueError) as error:
        message = f"{file} is not that of the caller: {error}"
        hint = "give each node the same files at the same paths, or call impinge.cluster.ray without shared="
        raise InputError(message, kind="changed", what="parts", hint=hint) from None


def private_memory() -> int:
    """Return the number of bytes of memory that belong to this process alone.

    Mapped files and the object store are not counted. The result is 0 on systems other than Linux.
    """
    try:
        with open("/proc/self/status", encoding="ascii") as status:
            return next((int(line.split()[1]) << 10 for line in status if line.startswith("RssAnon:")), 0)
    except OSError:
        return 0


_parts = _Parts()
