"""Places of baked meshes in files, so that other processes can map them."""

from __future__ import annotations

import errno
import mmap
import os
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

_MAGIC = b"impinge\n"
_FIXED, _ENTRY = 64, 24
"""Size in bytes of the header of a baked mesh without its table, and of an entry of the table."""

_SOURCES, _PART_OF = 5, 6
"""Numbers of the sections with the polygon and the part of each face."""


@dataclass(frozen=True)
class Stored:
    """Place of a baked mesh in a file, and its header, which tells whether it is still there."""

    path: str
    """Absolute path of the file."""
    start: int
    """Offset of the first byte in the file."""
    size: int
    """Number of bytes."""
    header: bytes
    """Header of the baked mesh, with the length and the checksum of each of its sections."""

    def is_there(self) -> bool:
        """Report whether the file still has a baked mesh with this header at this place."""
        try:
            with _regular(self.path) as file:
                file.seek(self.start)
                return file.read(len(self.header)) == self.header
        except OSError:
            return False

    def mapped(self) -> memoryview:
        """Return the bytes of the baked mesh, which the system reads when they are accessed.

        Raises
        ------
        OSError
            If the file cannot be mapped.
        ValueError
            If the file ends before the mesh, or has another one at this place.
        """
        before = self.start % mmap.ALLOCATIONGRANULARITY
        with _regular(self.path) as file:
            if os.fstat(file.fileno()).st_size < self.start + self.size:
                raise ValueError("the file is shorter")
            length = before + self.size
            content = mmap.mmap(file.fileno(), length, access=mmap.ACCESS_READ, offset=self.start - before)
        view = memoryview(content)[before:]
        if view[: len(self.header)] != self.header:
            raise ValueError("the file has another mesh")
        return view


def stored_at(path: str) -> Stored | None:
    """Return the place of the baked mesh that is a whole file, or None for another file."""
    try:
        with _regular(path) as file:
            header = header_of(file.read(_FIXED + _ENTRY * 256))
            size = os.fstat(file.fileno()).st_size
    except OSError:
        return None
    return Stored(os.path.abspath(path), 0, size, header) if header else None


def _regular(path: str) -> BinaryIO:
    """Open a regular file. Opening a pipe would wait for a writer."""
    if not os.path.isfile(path):
        raise FileNotFoundError(errno.ENOENT, "there is no such regular file", path)
    return open(path, "rb")


def header_of(baked: bytes | memoryview) -> bytes:
    """Return the header of a baked mesh with its table; empty if the bytes are no baked mesh."""
    if len(baked) < _FIXED or bytes(baked[: len(_MAGIC)]) != _MAGIC:
        return b""
    sections = int.from_bytes(baked[28:32], "little")
    return bytes(baked[: _FIXED + _ENTRY * sections])


def provenance_of(baked: memoryview) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
    """Return the polygon and the part of each face of a valid baked mesh, as views of its bytes."""

    def section(number: int) -> NDArray[np.uint32]:
        entry = _FIXED + _ENTRY * number
        start, length = (int.from_bytes(baked[at : at + 8], "little") for at in (entry + 8, entry + 16))
        return np.frombuffer(baked, "<u4", length // 4, start)

    return section(_SOURCES), section(_PART_OF)
