"""Contacts of two meshes or shapes that touch or overlap, as input for a contact solver."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Literal, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from impinge._engine import engine
from impinge._notebook import table
from impinge._ragged import Ragged
from impinge._rows import Pose, RaiseOptions, Solid, Statuses, StatusOptions, with_status
from impinge._scalars import real, whole
from impinge._shape import AnyShape

if TYPE_CHECKING:
    from impinge.cluster import Cluster


@dataclass(frozen=True, eq=False, repr=False)
class Contacts:
    """Contacts of two shapes, one for each row: a point on each shape, and a common normal.

    Attributes
    ----------
    normal : (k, 3) float64 array
        Unit vectors from the first shape to the second, in the world frame.
    depth : (k,) float64 array
        Penetration depth at this contact: equal to `upper`.
    lower, upper : (k,) float64 array
        Bounds of the penetration depth at this contact along the normal, in world units. Negative
        if the shapes are apart here, which requires a positive margin. Infinite for two half-spaces
        that no motion separates.
    point_a, point_b : (k, 3) float64 array
        Points on the first and on the second shape, in the world frame, rounded.
    manifold : (k,) int64 array
        Index of the contact's manifold, counted from zero in each row of poses. All contacts of one
        manifold have the same normal.
    ids : (k, 2, 4) uint32 array
        Features in contact, which stay the same from call to call as long as the contact persists.
        For each shape four numbers: the part of a compound, the kind of feature (0 corner, 1 edge,
        2 face), and two indices. An edge has two corners; a corner or face has its index and 0.
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
        """Return views of some rows, given as a slice, an array of indices or a mask."""
        return Contacts(*(getattr(self, field.name)[index] for field in fields(self)))

    def __repr__(self) -> str:
        """Return the number of contacts."""
        return f"Contacts({len(self)})"

    def _repr_html_(self) -> str:
        """Return the first contacts as a table for a notebook."""
        shown = ("lower", "upper", "normal", "point_a", "point_b", "manifold")
        return table(repr(self), {name: getattr(self, name) for name in shown})


@dataclass(frozen=True, eq=False, repr=False)
class ContactRows(Ragged[Contacts]):
    """Contacts of many rows of poses or of many pairs of bodies, concatenated row by row.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each row's contacts: the contacts of row ``i``, in row-major order of the leading
        axes, go from ``offsets[i]`` to ``offsets[i + 1]``.
    all : Contacts
        The contacts of all rows.
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

    def _repr_html_(self) -> str:
        """Return the first contacts as a table for a notebook."""
        rows = np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))
        return table(
            repr(self), {"row": rows, "depth": self.all.depth, "normal": self.all.normal, "point_a": self.all.point_a}
        )


def contact_rows(offsets: NDArray[np.int64], columns: Any, shape: tuple[int, ...]) -> ContactRows:
    """Return the contacts of many rows from the extension's columns."""
    return ContactRows(offsets, _contacts_of(columns), shape)


def _contacts_of(columns: Any) -> Contacts:
    manifold, normal, point_a, point_b, lower, upper, ids = columns
    contacts = object.__new__(Contacts)
    # The constructor of a frozen dataclass sets its fields one by one, which takes twice as long.
    vars(contacts).update(
        normal=normal,
        depth=upper,
        lower=lower,
        upper=upper,
        point_a=point_a,
        point_b=point_b,
        manifold=manifold,
        ids=ids,
    )
    return contacts


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
    **rows: Unpack[RaiseOptions],
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
    **rows: Unpack[RaiseOptions],
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
    **rows: Unpack[StatusOptions],
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
    on: Cluster | None = None,
) -> Any:
    """Compute the contacts of two meshes or shapes that touch, overlap, or are within a margin.

    The result is empty if and only if the two are farther apart than the margin.

    Parameters
    ----------
    a, b, pose_a, pose_b, solid, on_error, progress, on
        As for `intersects`. A row with an invalid pose has no contacts; check its status.
    margin : float
        Maximum distance, in world units, at which points still count as contacts; at least zero.
    most_points : int
        Maximum number of contacts with one normal, at least one: the deepest contact, the farthest
        from it, and then those that add the most area.

    Returns
    -------
    Contacts or ContactRows
        `Contacts` for a single pose. Two convex shapes have one normal; other shapes have one for
        each region of contact. The normals of round shapes equal those of `penetration` to within
        2^-12. Cylinders, cones and ellipsoids have up to eight points, which may be shallower than
        neighboring points by 2^-13 of the size. With ``on_error="status"`` a tuple of the contacts
        and the status of each row.

    Raises
    ------
    InputError
        As for `intersects`, or if an option is out of range.

    Examples
    --------
    >>> import impinge
    >>> crate = impinge.Shape.box([0.5, 0.5, 0.5])
    >>> touch = impinge.contacts(crate, crate, None, impinge.pose([0.25, 0.25, 0.75]))
    >>> len(touch), touch.normal[0], touch.depth
    (4, array([0., 0., 1.]), array([0.25, 0.25, 0.25, 0.25]))
    """
    margin, most_points = real(margin, "margin", minimum=0), whole(most_points, "most_points", minimum=1)

    def convert(columns: Any) -> Contacts | ContactRows:
        shape, (offsets, all_of_them) = columns
        return contact_rows(offsets, all_of_them, tuple(shape)) if shape else _contacts_of(all_of_them)

    question = (a, b, pose_a, pose_b, solid, on_error, progress)
    return with_status(engine(on).contacts_of(question, margin, most_points), on_error, convert)
