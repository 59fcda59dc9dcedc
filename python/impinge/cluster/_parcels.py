"""Sends parts to the nodes: as bytes, each in the object store once, or as places in shared files.

Parts travel as bytes in parcels. If a mesh was loaded from a baked file in a folder that all nodes
share, it travels as its place in the file, which each worker maps.
"""

from __future__ import annotations

import hashlib
import os
import pickle
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from impinge import _impinge
from impinge._mesh import Mesh
from impinge._shape import AnyShape
from impinge._stored import Stored
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
        All parts. An object that occurs several times is packed once.
    order : iterable of int
        Indices of the parts that are packed. Parts that are used together should be neighbors.
    """

    def __init__(self, parts: Sequence[AnyShape], order: Iterable[int]) -> None:
        self._parts = list({id(parts[at]): parts[at] for at in order}.values())
        self.arrange(None)

    def arrange(self, shared: str | None) -> None:
        """Decide which parts travel as places in files, and divide the others into parcels.

        Parameters
        ----------
        shared : str, optional
            Path of the folder that all nodes have.
        """
        self._stored: dict[int, Stored] = {}
        """Places of parts in shared files, by the identity of the part."""
        self._of: dict[int, tuple[int, int]] = {}
        """Parcel of each other part, by the identity of its object, and the index in the parcel."""
        self._contents: list[list[AnyShape]] = []
        self._slots: dict[int, list[Slot]] = {}
        filled = 0
        for part in self._parts:
            stored = _stored_in(shared, part)
            if stored is not None:
                self._stored[id(part)] = stored
                continue
            size = _estimated_size(part)
            if not self._contents or filled + size > _PARCEL_BYTES:
                self._contents.append([])
                filled = 0
            filled += size
            self._of[id(part)] = len(self._contents) - 1, len(self._contents[-1])
            self._contents[-1].append(part)

    def stored(self, part: AnyShape) -> Stored | None:
        """Return the place of a part in a shared file, or None if it travels in a parcel."""
        return self._stored.get(id(part))

    def numbers_of(self, parts: Iterable[AnyShape]) -> list[int]:
        """Return the numbers of the parcels with some parts, in ascending order."""
        return sorted({self._of[id(part)][0] for part in parts if id(part) in self._of})

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
        """Return a hash of each part; this makes all parcels once."""
        for number in range(len(self._contents)):
            if number not in self._slots:
                self.packed(number)
        places = [self._stored.get(id(part)) for part in self._parts]
        return [
            self.slot_of(part).digest if place is None else place.header
            for part, place in zip(self._parts, places, strict=True)
        ]


def _stored_in(shared: str | None, part: AnyShape) -> Stored | None:
    """Return the place of a mesh in a file of the shared folder, if the file is still the same."""
    stored = part._stored if isinstance(part, Mesh) else None
    if shared is None or stored is None or not stored.path.startswith(os.path.join(shared, "")):
        return None
    return stored if stored.is_there() else None


def _estimated_size(part: AnyShape) -> int:
    """Return about the number of bytes of a part, without making them."""
    return part.memory if isinstance(part, Mesh) else 0


def _bytes_of(part: AnyShape) -> bytes:
    if isinstance(part, Mesh):
        return _impinge.to_baked(part, None, False)
    return pickle.dumps(part, protocol=5)
