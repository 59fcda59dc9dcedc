"""What a mesh may suffer from, its repair, and how good its hierarchy is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Health:
    """Counts of what is odd about a mesh; all are exact. None of it changes an answer about the surface.

    Vertices with equal coordinates are one point here, whatever their indices.

    Attributes
    ----------
    degenerate_faces : int
        Faces without area: segments and points.
    duplicate_faces : int
        Faces with the same three points as an earlier one, in any order.
    duplicate_vertices : int
        Vertices at the same point as an earlier one.
    unused_vertices : int
        Vertices that no face has.
    open_edges : int
        Edges between two points that one face has.
    non_manifold_edges : int
        Edges that more than two faces have.
    misoriented_edges : int
        Edges that two faces have, both in the same direction: one of the faces is inside out.
    components : int
        Pieces, each of all faces that are linked by points in common.
    double_coordinates : int
        Coordinates that single precision cannot hold.
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
    """What `Mesh.repaired` changed, and what it found and left. All arrays are ascending.

    Attributes
    ----------
    welded_vertices : (k,) uint32 array
        Vertices that were moved to the position of an earlier one.
    greatest_move : float
        The greatest distance by which a vertex was moved.
    turned_faces : (k,) uint32 array
        Faces whose second and third corner were swapped.
    one_sided_faces : (k,) uint32 array
        Faces of sheets that have only one side, as a Möbius strip has. They are left as they were.
    degenerate_faces : (k,) uint32 array
        Faces without area after the repair. They are left.
    duplicate_faces : (k,) uint32 array
        Faces with the same three points as an earlier one after the repair. They are left.
    """

    welded_vertices: NDArray[np.uint32]
    greatest_move: float
    turned_faces: NDArray[np.uint32]
    one_sided_faces: NDArray[np.uint32]
    degenerate_faces: NDArray[np.uint32]
    duplicate_faces: NDArray[np.uint32]

    def __repr__(self) -> str:
        """Return how many there are of each."""
        return (
            f"Repair({len(self.welded_vertices)} vertices welded by at most {self.greatest_move:.3g}, "
            f"{len(self.turned_faces)} faces turned, {len(self.one_sided_faces)} one-sided, "
            f"{len(self.degenerate_faces)} without area, {len(self.duplicate_faces)} duplicates)"
        )


@dataclass(frozen=True)
class TreeStatistics:
    """What can be read off the hierarchy that queries descend; areas are ratios, and so do not depend on the unit.

    Attributes
    ----------
    inner, leaves : int
        Nodes of either kind.
    depth : int
        Steps from the root to the deepest leaf.
    sah : float
        The expected number of nodes that something small inside the root's box meets: all areas over that of the root.
    overlap : float
        How much of an inner node's area two of its children have in common; 0 where no children overlap.
    node_fill, leaf_fill : float
        The share of the places for children, and for faces, that are taken.
    bytes : int
        What the nodes take.
    """

    inner: int
    leaves: int
    depth: int
    sah: float
    overlap: float
    node_fill: float
    leaf_fill: float
    bytes: int
