"""Origin of the faces of a mesh that was loaded from a file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge


@dataclass(frozen=True, eq=False)
class Origin:
    """Origin of the faces of a mesh that was loaded from a file.

    Attributes
    ----------
    path : str
        Path of the file; empty for a mesh that was read from bytes.
    format : str
        Name of the file format that was detected.
    unit : str or None
        Unit of the vertices, such as ``"mm"``, if known.
    polygons : (m,) uint32 array
        For each face, the index of the polygon in the file that it is a part of, counted from zero.
    part_of : (m,) uint32 array
        For each face, the index into `parts` of the part that it belongs to.
    parts : tuple of str
        Names of the parts; empty if the file has none.
    """

    path: str
    format: str
    unit: str | None
    polygons: NDArray[np.uint32]
    part_of: NDArray[np.uint32]
    parts: tuple[str, ...]

    def __repr__(self) -> str:
        """Return all fields except the arrays."""
        return f"Origin({self.path!r}, {self.format}, unit={self.unit!r}, {len(self.parts)} parts)"


def origin_of(model: _impinge.Model, path: str) -> Origin:
    """Return the origin of the faces of a loaded model."""
    return Origin(path, model.format, model.unit, model.sources, model.part_of, tuple(model.parts))
