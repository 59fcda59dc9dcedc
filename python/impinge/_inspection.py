"""Reports on a mesh: its defects, its repair, and the quality of its hierarchy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Health:
    """Numbers of defects of a mesh, all exact. Defects do not affect answers about the surface.

    Vertices with equal coordinates count as one point here, whatever their indices.

    Attributes
    ----------
    degenerate_faces : int
        Number of faces without area: segments and points.
    duplicate_faces : int
        Number of faces with the same three points as an earlier face, in any order.
    duplicate_vertices : int
        Number of vertices at the same point as an earlier vertex.
    unused_vertices : int
        Number of vertices that no face uses.
    open_edges : int
        Number of edges between two different points that belong to a single face.
    non_manifold_edges : int
        Number of edges that belong to more than two faces.
    misoriented_edges : int
        Number of edges that two faces use in the same direction, so that one of the faces is inside
        out.
    components : int
        Number of connected components: sets of faces that are linked by common corner points.
    double_coordinates : int
        Number of coordinates that single precision cannot represent.
    """

    degenerate_faces: int
    duplicate_faces: int
    duplicate_vertices: int
    unused_vertices: int
    open_edges: int
    non_manifold_edges: int
    misoriented_edges: int
    components: int
    double_coordinates: int


@dataclass(frozen=True, eq=False)
class Repair:
    """Changes made by `Mesh.repaired`, and the defects that are left.

    Arrays hold indices of vertices or faces, ascending.

    Attributes
    ----------
    welded_vertices : (k,) uint32 array
        Indices of vertices that were moved to the position of an earlier vertex.
    greatest_move : float
        Maximum distance by which a vertex was moved, in the unit of the mesh.
    turned_faces : (k,) uint32 array
        Indices of faces whose orientation was reversed, by a swap of the second and third corners.
    one_sided_faces : (k,) uint32 array
        Indices of faces of one-sided sheets, such as a Möbius strip; not changed.
    degenerate_faces : (k,) uint32 array
        Indices of faces without area after the repair; not changed.
    duplicate_faces : (k,) uint32 array
        Indices of faces with the same three points as an earlier face after the repair; not
        changed.
    """

    welded_vertices: NDArray[np.uint32]
    greatest_move: float
    turned_faces: NDArray[np.uint32]
    one_sided_faces: NDArray[np.uint32]
    degenerate_faces: NDArray[np.uint32]
    duplicate_faces: NDArray[np.uint32]

    def __repr__(self) -> str:
        """Return the numbers of changes and of defects that are left."""
        return (
            f"Repair({len(self.welded_vertices)} vertices welded by at most {self.greatest_move:.3g}, "
            f"{len(self.turned_faces)} faces turned, {len(self.one_sided_faces)} one-sided, "
            f"{len(self.degenerate_faces)} without area, {len(self.duplicate_faces)} duplicates)"
        )


@dataclass(frozen=True)
class TreeStatistics:
    """Size and quality of the hierarchy of a mesh. Areas are ratios, independent of the unit.

    Attributes
    ----------
    inner, leaves : int
        Numbers of inner nodes and of leaves.
    depth : int
        Number of steps from the root to the deepest leaf.
    sah : float
        Expected number of nodes that a small object inside the root's box overlaps: the sum of the
        surface areas of all boxes, divided by that of the root's box. Lower is faster; 0 if the
        root's box has no area.
    overlap : float
        Surface areas that pairs of children have in common, summed over all inner nodes and divided
        by the sum of the areas of the inner nodes; 0 if no children overlap.
    node_fill, leaf_fill : float
        Share of the slots that are used, from 0 to 1: of child slots in inner nodes, and of face
        slots in leaves.
    bytes : int
        Size of the nodes in bytes.
    """

    inner: int
    leaves: int
    depth: int
    sah: float
    overlap: float
    node_fill: float
    leaf_fill: float
    bytes: int
