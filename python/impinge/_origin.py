"""Where the faces of a mesh from a file come from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge


@dataclass(frozen=True, eq=False)
class Origin:
    """Where the faces of a mesh from a file come from.

    Attributes
    ----------
    path : str
        The file; empty for a mesh of bytes.
    format : str
        The format that it turned out to have.
    unit : str or None
        The unit of the vertices, ``"mm"``, where one is known.
    polygons : (m,) uint32 array
        The polygon of the file, counted from zero, that each face is a part of.
    part_of : (m,) uint32 array
        The part that each face belongs to, as an index into `parts`.
    parts : tuple of str
        The names of the parts; empty text where the file gives none.
    """

    path: str
    format: str
    unit: str | None
    polygons: NDArray[np.uint32]
    part_of: NDArray[np.uint32]
    parts: tuple[str, ...]

    def __repr__(self) -> str:
        """Return all but the arrays."""
        return f"Origin({self.path!r}, {self.format}, unit={self.unit!r}, {len(self.parts)} parts)"


def origin_of(model: _impinge.Model, path: str) -> Origin:
    """Return where the faces of a model come from."""
    return Origin(path, model.format, model.unit, model.sources, model.part_of, tuple(model.parts))
