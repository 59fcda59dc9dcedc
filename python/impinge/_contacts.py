"""Where two meshes or shapes touch or overlap, as a solver of contacts wants it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._ragged import Ragged
from impinge._rows import Pose, Raising, Solid, Stating, Statuses, beside_status
from impinge._scalars import real, whole
from impinge._shape import AnyShape


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
    >>> rows = impinge.contacts(box, box, None, impinge.pose([[0, 0, 1.5], [0, 0, 3], [0, 0, 2]]))
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


@overload
def contacts(
    a: AnyShape,
    b: AnyShape,
    pose_a: None = None,
    pose_b: None = None,
    *,
    solid: Solid = False,
    margin: float = 0.0,
    most_points: int = 4,
    **rows: Unpack[Raising],
) -> Contacts: ...
@overload
def contacts(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    margin: float = 0.0,
    most_points: int = 4,
    **rows: Unpack[Raising],
) -> Contacts | ContactRows: ...
@overload
def contacts(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    margin: float = 0.0,
    most_points: int = 4,
    **rows: Unpack[Stating],
) -> tuple[Contacts | ContactRows, Statuses]: ...
def contacts(
    a: AnyShape,
    b: AnyShape,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    solid: Solid = False,
    margin: float = 0.0,
    most_points: int = 4,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Return the contacts of two meshes or shapes; none exactly where they are not within the margin.

    Parameters
    ----------
    a, b, pose_a, pose_b, solid, on_error, progress
        As for `intersects`. There is nothing to say of rows with a bad pose.
    margin : float
        Points that are at most this far apart are contacts too, in world units.
    most_points : int
        How many contacts with one normal there may be, at least one: the deepest, and those that span the most.

    Returns
    -------
    Contacts or ContactRows
        `Contacts` where a single pose was asked about. Two convex shapes have one normal, what is not convex one for
        each region of contact. Normals of round shapes are those of `penetration` to within 2^-12; cylinders, cones and
        ellipsoids have up to eight points, which may be less deep than others beside them by 2^-13 of the size.

    Raises
    ------
    InputError
        As for `intersects`, or if an option is not in range.

    Examples
    --------
    >>> import impinge
    >>> crate = impinge.Shape.box([0.5, 0.5, 0.5])
    >>> touch = impinge.contacts(crate, crate, None, impinge.pose([0.25, 0.25, 0.75]))
    >>> len(touch), touch.normal[0], touch.depth
    (4, array([0., 0., 1.]), array([0.25, 0.25, 0.25, 0.25]))
    """
    margin, most_points = real(margin, "margin", least=0), whole(most_points, "most_points", least=1)

    def made(columns: Any) -> Contacts | ContactRows:
        shape, (offsets, all_of_them) = columns
        rows = contact_rows(offsets, all_of_them, tuple(shape))
        return rows if rows.shape else rows.all

    question = (a, b, pose_a, pose_b, solid, on_error, progress)
    return beside_status(_impinge.contacts_of(question, margin, most_points), on_error, made)
