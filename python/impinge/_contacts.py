"""Where two shapes touch or overlap, as a solver of contacts wants it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge._ragged import Ragged


@dataclass(frozen=True, eq=False, repr=False)
class Contacts:
    """The contacts of two shapes, one a row: a point of each, one over the other along a normal.

    Attributes
    ----------
    normal : (k, 3) float64 array
        Of length 1, from the first shape to the second, in the world frame.
    depth : (k,) float64 array
        `upper`.
    lower, upper : (k,) float64 array
        Along the normal the first shape reaches beyond the second here by at least and at most this, in world units.
        Negative where they are apart here, as they may be where a margin was asked for. Infinite for two half-spaces
        that no motion takes apart.
    point_a, point_b : (k, 3) float64 array
        On the side of either shape, in the world frame, rounded.
    manifold : (k,) int64 array
        Contacts with one number have one normal; numbered from zero.
    ids : (k, 2, 4) uint32 array
        What the contact is of, the same from one time to the next for as long as it is there; for either shape the part
        of a compound, the kind of feature (0 a corner, 1 an edge, 2 a face) and its number, or the two corners of an
        edge.
    """

    normal: NDArray[np.float64]
    depth: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    manifold: NDArray[np.int64]
    ids: NDArray[np.uint32]

    def __len__(self) -> int:
        """Return the number of contacts."""
        return len(self.depth)

    def __getitem__(self, index: Any) -> Contacts:
        """Return views of some rows: a slice, an array of indices or a mask."""
        return Contacts(*(getattr(self, field.name)[index] for field in fields(self)))

    def __repr__(self) -> str:
        """Return the number of contacts."""
        return f"Contacts({len(self)})"


@dataclass(frozen=True, eq=False, repr=False)
class ContactRows(Ragged[Contacts]):
    """The contacts of many rows of poses, or of many pairs of bodies: uneven in number, one row's after another's.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        The contacts of row ``i``, in row-major order of the leading axes, are those from ``offsets[i]`` to
        ``offsets[i + 1]``.
    all : Contacts
        Those of all rows.
    shape : tuple of int
        The leading axes; their product is ``n``.

    Examples
    --------
    >>> import impinge
    >>> box = impinge.Shape.box([1, 1, 1])
    >>> rows = impinge.shapes.contacts(box, box, None, impinge.pose([[0, 0, 1.5], [0, 0, 3], [0, 0, 2]]))
    >>> rows
    ContactRows(shape=(3,), 8 contacts)
    >>> rows.counts, rows[0].depth
    (array([4, 0, 4]), array([0.5, 0.5, 0.5, 0.5]))
    """

    offsets: NDArray[np.int64]
    all: Contacts
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> Contacts:
        return self.all[entries]

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> ContactRows:
        return ContactRows(offsets, self.all[entries], shape)

    def __repr__(self) -> str:
        """Return the shape and the number of contacts."""
        return f"ContactRows(shape={self.shape}, {len(self.all)} contacts)"


def contact_rows(offsets: NDArray[np.int64], columns: Any, shape: tuple[int, ...]) -> ContactRows:
    """Return contacts of rows, as the extension has them."""
    manifold, normal, point_a, point_b, lower, upper, ids = columns
    return ContactRows(offsets, Contacts(normal, upper, lower, upper, point_a, point_b, manifold, ids), shape)
