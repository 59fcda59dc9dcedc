"""Cuts a call into tasks, and merges their answers to the answer of the call.

The cut depends on the arguments of the call alone, never on the cluster, and answers are merged in
the order of the tasks. So the answer is the same on any number of nodes, and a checkpoint of one
cluster can be used on another.
"""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge import _arrays
from impinge._impinge import __version__
from impinge._mesh import Mesh
from impinge._shape import AnyShape
from impinge.cluster._parcels import Parcels

_TARGET_TASKS = 256
"""Number of tasks of a call, if its tasks are then larger than the smallest and smaller than the
largest. With fewer, processors are idle at the end. With more, the cost of Ray, some milliseconds
for each task, is a larger part of the call."""

_FACES_OF_SHARE = 1 << 16
"""Number of faces of two meshes for each share of their search at one pose. With more, there are
too few tasks for all processors. With fewer, Ray's cost of a task and the descent to the first
subtree are a larger part of a task."""

_MIN_WORK, _MAX_WORK = 1 << 16, 1 << 22
"""Minimum and maximum of the estimated work of a task, in rows of `intersects`. A row takes one or
two microseconds. With a smaller minimum, Ray's cost is more than a tenth of the smallest task. The
largest task takes about six seconds. If its node ends, the task is computed again, so a larger
maximum wastes more time."""

_BYTES_OF_POSES = 8 << 20
"""Maximum size of the poses of a task in bytes, if it has more than one row. Two tasks for each
processor are with Ray, so larger ones fill the object store. Smaller ones make more tasks."""

_BYTES_OF_POSE = 128
"""Size of a pose in bytes."""

_WORK_OF_ROW = {
    "contacts_of": 128,
    "deeper": 256,
    "depth": 1024,
    "distance": 8,
    "intersecting_pairs": 8,
    "intersection_curves": 16,
    "penetrates": 8,
    "penetration": 512,
}
"""Estimated work of a row of a function in rows of `intersects`, if it is more."""


class Call(ABC):
    """A call that is cut into tasks.

    Attributes
    ----------
    what : str
        Name of the call in error messages and in Ray's dashboard.
    count : int
        Number of tasks.
    names, parts : sequences
        Names of all parts, and the parts.
    parcels : Parcels
        Bytes of the parts.
    function : str
        Name of the function of the worker that answers a task.
    """

    what: str
    count: int
    names: Sequence[str]
    parts: Sequence[AnyShape]
    parcels: Parcels
    function: str

    @abstractmethod
    def parts_of(self, task: int) -> Sequence[int]:
        """Return the indices of the distinct parts that a task needs."""

    @abstractmethod
    def arguments_of(self, task: int) -> tuple[Any, ...]:
        """Return the arguments of a task after the parts."""

    @abstractmethod
    def merged(self, answers: Mapping[int, Any]) -> Any:
        """Return the answer of the call from those of its tasks, as the extension returns it."""

    @abstractmethod
    def _input(self) -> tuple[Any, ...]:
        """Return all values besides the parts on which the answers depend."""

    def fingerprint(self) -> str:
        """Return a hash of all values on which the answers of the tasks depend."""
        sha = hashlib.sha256()
        for item in (__version__, self.function, self.count, *self.parcels.digests(), *self._input()):
            content = np.ascontiguousarray(item) if isinstance(item, np.ndarray) else None
            text = repr(item) if content is None else f"{content.dtype.str}{content.shape}"
            sha.update(f"{len(text)} {text}".encode())
            if content is not None:
                sha.update(content.data)
        return sha.hexdigest()


def snapshots(parts: Sequence[AnyShape]) -> list[AnyShape]:
    """Return the parts in their current state, which later refits do not change."""
    return [part._snapshot() if isinstance(part, Mesh) else part for part in parts]


def run_of(count: int, work: int, size: int) -> tuple[int, int]:
    """Return the number of rows of a run, and the number of runs.

    `work` is the estimated work of a row, and `size` the number of bytes that are sent for it.
    """
    even = -(-count // _TARGET_TASKS)
    maximum = min(_MAX_WORK // work, _BYTES_OF_POSES // size)
    run = max(min(max(even, _MIN_WORK // work), maximum), 1)
    return run, max(-(-count // run), 1)


class Rows:
    """Rows of arrays, such as the poses of several things, cut into runs.

    Parameters
    ----------
    axes : sequence of int
        Leading axes of the answer.
    arrays : sequence of array or None
        Arrays whose leading axes broadcast to those of the answer. An item of an array is a pose,
        (4, 4), or a vector, (3,).
    work : int
        Estimated work of a row, in rows of `intersects`.
    """

    def __init__(self, axes: Sequence[int], arrays: Sequence[NDArray[np.float64] | None], work: int) -> None:
        self.axes, self.arrays = tuple(axes), list(arrays)
        self._count = int(np.prod(self.axes, dtype=np.int64))
        sizes = [8 * prod(_item_of(array)) for array in arrays if array is not None and _leading(array) != 1]
        self._run, self.runs = run_of(self._count, work, max(sum(sizes), _BYTES_OF_POSE))

    def of(self, run: int) -> list[NDArray[np.float64] | None]:
        """Return the items of each array in one run.

        An array with one item keeps it, without axes if the answer has none.
        """
        start = run * self._run
        rows = slice(start, min(start + self._run, self._count))
        return [None if array is None else self._of(array, rows) for array in self.arrays]

    def _of(self, array: NDArray[np.float64], run: slice) -> NDArray[np.float64]:
        item = _item_of(array)
        own = array.shape[: array.ndim - len(item)]
        if not self.axes:
            return array
        if _leading(array) == 1:
            return array.reshape(1, *item)
        if own == self.axes:
            return array.reshape(-1, *item)[run]  # a view, which is sent without another copy
        rows = np.arange(run.start, run.stop)
        places = np.unravel_index(rows, self.axes)[len(self.axes) - len(own) :]
        index = tuple(np.zeros_like(at) if length == 1 else at for at, length in zip(places, own, strict=True))
        picked: NDArray[np.float64] = array[index]
        return picked


def _item_of(array: NDArray[np.float64]) -> tuple[int, ...]:
    """Return the shape of an item: (4, 4) for poses, (3,) for vectors."""
    return array.shape[-1:] if array.shape[-1] == 3 else array.shape[-2:]


def _leading(array: NDArray[np.float64]) -> int:
    """Return the number of items of an array."""
    return prod(array.shape[: array.ndim - len(_item_of(array))])


def poses_of(poses: Mapping[str, Any]) -> list[NDArray[np.float64] | None]:
    """Return the poses of each thing as an array, by the names of their arguments."""
    return [None if each is None else _arrays.plain_poses(each, name) for name, each in poses.items()]


class VerbCall(Call):
    """A query of two things at many poses."""

    function = "rows"

    def __init__(self, verb: str, asked: tuple[Any, ...], rest: tuple[Any, ...], axes: Sequence[int]) -> None:
        a, b, pose_a, pose_b, self._solid, self._on_error, _ = asked
        self._verb, self._rest = verb, rest
        self.what = verb.removesuffix("_of")
        self.parts = snapshots([a, b])
        self.names = ("a", "b")
        self.parcels = Parcels(self.parts, range(2))
        self._rows = Rows(axes, poses_of({"pose_a": pose_a, "pose_b": pose_b}), _WORK_OF_ROW.get(verb, 1))
        self.count = self._rows.runs

    def parts_of(self, task: int) -> Sequence[int]:
        """Return the two things; the same thing twice is one part."""
        return (0,) if self.parts[0] is self.parts[1] else (0, 1)

    def arguments_of(self, task: int) -> tuple[Any, ...]:
        """Return the verb, the poses of the rows and the options."""
        return self._verb, tuple(self._rows.of(task)), (self._solid, self._on_error), self._rest

    def _input(self) -> tuple[Any, ...]:
        which = self.parts_of(0)
        return self._verb, which, self._rest, self._solid, self._on_error, self._rows.axes, *self._rows.arrays

    def merged(self, answers: Mapping[int, Any]) -> Any:
        """Return the answers of all rows."""
        if not self._rows.axes:
            return answers[0]
        all_answers = [answers[task] for task in range(self.count)]
        if self._on_error != "status":
            return self._merged(all_answers)
        status = np.concatenate([status for _, status in all_answers])
        return self._merged([answer for answer, _ in all_answers]), status.reshape(self._rows.axes)

    def _merged(self, answers: list[Any]) -> Any:
        axes = self._rows.axes
        if self._verb == "intersecting_pairs":
            offsets, rows, _, truncated = zip(*answers, strict=True)
            return ragged(offsets), np.concatenate(rows), list(axes), column(truncated, axes)
        if self._verb == "contacts_of":
            places, *columns = joined([(offsets, *columns) for _, (offsets, columns) in answers])
            return list(axes), (places, tuple(columns))
        if self._verb == "intersection_curves":
            return nested([row for rows in answers for row in rows], axes)
        if isinstance(answers[0], tuple):
            return tuple(column(parts, axes) for parts in zip(*answers, strict=True))
        return column(answers, axes)


class ShareCall(Call):
    """The intersecting pairs of faces of two large meshes at one pose, cut by subtrees of one."""

    function = "share"
    what = "pairs of faces"

    def __init__(self, asked: tuple[Any, ...]) -> None:
        a, b, pose_a, pose_b, *_ = asked
        self.parts = snapshots([a, b])
        self.names = ("a", "b")
        self.parcels = Parcels(self.parts, range(2))
        named = {"pose_a": pose_a, "pose_b": pose_b}
        self._poses = tuple(None if pose is None else _arrays.plain_poses(pose, name) for name, pose in named.items())
        self.count = min(max((a.face_count + b.face_count) // _FACES_OF_SHARE, 1), _TARGET_TASKS)

    def parts_of(self, task: int) -> Sequence[int]:
        """Return the two meshes; the same mesh twice is one part."""
        return (0,) if self.parts[0] is self.parts[1] else (0, 1)

    def arguments_of(self, task: int) -> tuple[Any, ...]:
        """Return the poses, and the number of the share."""
        return self._poses, task, self.count

    def _input(self) -> tuple[Any, ...]:
        return self.parts_of(0), *self._poses

    def merged(self, answers: Mapping[int, Any]) -> Any:
        """Return the pairs of all shares, and that there are no more."""
        return in_order([answers[task] for task in range(self.count)]), False


def column(parts: Sequence[NDArray[Any]], axes: tuple[int, ...]) -> NDArray[Any]:
    """Return the rows of several arrays as one array with some leading axes."""
    rows = np.concatenate(parts)
    return rows.reshape(axes + rows.shape[1:])


def nested(rows: list[Any], axes: tuple[int, ...]) -> list[Any]:
    """Return rows as nested lists, with one level for each axis."""
    for axis in range(len(axes) - 1, 0, -1):
        length = axes[axis]
        rows = [rows[at * length : (at + 1) * length] for at in range(prod(axes[:axis]))]
    return rows


def in_order(pairs: Sequence[NDArray[np.uint32]]) -> NDArray[np.uint32]:
    """Return the pairs of several lists, sorted."""
    joined = np.concatenate([np.zeros((0, 2), np.uint32), *pairs])
    return joined[np.lexsort((joined[:, 1], joined[:, 0]))]


def ragged(offsets: Sequence[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Return the offsets of concatenated lists of entries from those of each list."""
    counts = np.concatenate([np.diff(each) for each in offsets])
    return np.concatenate([np.zeros(1, np.int64), np.cumsum(counts, dtype=np.int64)])


def joined(lists: Sequence[tuple[NDArray[Any], ...]]) -> tuple[NDArray[Any], ...]:
    """Return lists of entries of all rows: their offsets, and the columns of the entries."""
    offsets, *columns = zip(*lists, strict=True)
    return ragged(offsets), *(np.concatenate(parts) for parts in columns)
