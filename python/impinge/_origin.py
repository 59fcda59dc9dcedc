"""Origin of the faces of a mesh that was loaded from a file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge


@dataclass(frozen=True, eq=False)
class Origin:
    """Where the faces of a loaded mesh come from: file, format and unit, polygons and parts.

    Attributes
    ----------
    path : str
        Path of the file; empty for a mesh that was read from bytes.
    format : str
        Name of the file format that was detected.
    unit : str or None
        Unit of the vertices, such as ``"mm"``, if known.
    polygons : (m,) uint32 array
        For each face, the index of the polygon that it is a piece of. Polygons are counted from
        zero through the whole file.
    part_of : (m,) uint32 array
        For each face, the index into `parts` of the part that it belongs to.
    parts : tuple of str
        Names of the parts that have faces; a name is empty if the file gives none.
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
    """Return where the faces of a loaded model come from: its polygons, parts, unit and file."""
    return Origin(path, model.format, model.unit, model.sources, model.part_of, tuple(model.parts))
