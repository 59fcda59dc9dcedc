"""Convex parts of solids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, repr=False)
class ConvexPart:
    """A convex part of a solid: a hull in the frame of the mesh.

    Attributes
    ----------
    vertices : (n, 3) float64 array
        Positions of the vertices.
    faces : (m, 3) uint32 array
        Triangles of the boundary, as rows of `vertices`, counterclockwise as seen from outside.
    concavity_lower, concavity_upper : float
        Bounds on the largest distance of a point of the hull from the solid, in the unit of the
        mesh; proved.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.uint32]
    concavity_lower: float
    concavity_upper: float

    def __repr__(self) -> str:
        """Return the number of vertices and the bound."""
        return f"ConvexPart({len(self.vertices)} vertices, concavity <= {self.concavity_upper:.3g})"


@dataclass(frozen=True, eq=False, repr=False)
class ConvexParts:
    """Convex parts that cover a solid, from `Mesh.convex_parts`.

    Attributes
    ----------
    parts : tuple of ConvexPart
        The parts. Each point of the solid is in one of them.
    is_within : bool
        Whether `concavity` is at most the one that was asked for. If not, `max_parts` was too
        small.
    """

    parts: tuple[ConvexPart, ...]
    is_within: bool

    @property
    def concavity(self) -> float:
        """Proved bound: no point of a hull is farther than this from the solid."""
        return max(part.concavity_upper for part in self.parts)

    def __len__(self) -> int:
        """Return the number of parts."""
        return len(self.parts)

    def __repr__(self) -> str:
        """Return the number of parts and the bound."""
        return f"ConvexParts({len(self.parts)} parts, concavity <= {self.concavity:.3g})"
