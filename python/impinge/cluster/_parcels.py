"""Packs parts as bytes, so that each is in the object store once, however many tasks use it."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from impinge import _impinge
from impinge._mesh import Mesh
from impinge._shape import AnyShape
from impinge.cluster._worker import Parcel

_PARCEL_BYTES = 8 << 20
"""Size in bytes at which a parcel is full. Larger parcels bring more parts to a node than its tasks
need. Smaller ones make more objects, each of which costs Ray about a millisecond."""

_ALIGNMENT = 64
"""Alignment of a baked mesh that is used in place, in bytes."""


@dataclass(frozen=True)
class Slot:
    """Place of a part in the parcels of a call."""

    digest: bytes
    is_mesh: bool
    parcel: int
    start: int
    size: int


class Parcels:
    """The distinct parts of a call in parcels, which are made when they are needed.

    Parameters
    ----------
    parts : sequence of Mesh or Shape
        All parts; equal objects are packed once.
    order : iterable of int
        Indices of the parts that are packed, those that are used together close to each other.
    """

    def __init__(self, parts: Sequence[AnyShape], order: Iterable[int]) -> None:
        self._of: dict[int, tuple[int, int]] = {}
        """Parcel of each part, by the identity of its object, and the index in the parcel."""
        self._contents: list[list[AnyShape]] = []
        self._slots: dict[int, list[Slot]] = {}
        filled = 0
        for at in order:
            part = parts[at]
            if id(part) in self._of:
                continue
            size = _estimated_size(part)
            if not self._contents or filled + size > _PARCEL_BYTES:
                self._contents.append([])
                filled = 0
            filled += size
            self._of[id(part)] = len(self._contents) - 1, len(self._contents[-1])
            self._contents[-1].append(part)

    def parcel_of(self, part: AnyShape) -> int:
        """Return the number of the parcel with a part."""
        return self._of[id(part)][0]

    def slot_of(self, part: AnyShape) -> Slot:
        """Return the place of a part. Its parcel must have been packed before."""
        parcel, at = self._of[id(part)]
        return self._slots[parcel][at]

    def packed(self, number: int) -> Parcel:
        """Return the bytes of a parcel."""
        contents = [_bytes_of(part) for part in self._contents[number]]
        starts = np.cumsum([0] + [-(-len(content) // _ALIGNMENT) * _ALIGNMENT for content in contents])
        parcel = np.zeros(starts[-1], np.uint8)
        self._slots[number] = []
        for part, content, start in zip(self._contents[number], contents, starts.tolist(), strict=False):
            parcel[start : start + len(content)] = np.frombuffer(content, np.uint8)
            digest = hashlib.sha256(content).digest()
            self._slots[number].append(Slot(digest, isinstance(part, Mesh), number, start, len(content)))
        return parcel

    def digests(self) -> list[bytes]:
        """Return the SHA-256 of each packed part; this makes all parcels once."""
        for number in range(len(self._contents)):
            if number not in self._slots:
                self.packed(number)
        return [slot.digest for number in range(len(self._contents)) for slot in self._slots[number]]


def _estimated_size(part: AnyShape) -> int:
    """Return about the number of bytes of a part, without making them."""
    return part.memory if isinstance(part, Mesh) else 0


def _bytes_of(part: AnyShape) -> bytes:
    if isinstance(part, Mesh):
        return _impinge.to_baked(part, None, False)
    return pickle.dumps(part, protocol=5)
