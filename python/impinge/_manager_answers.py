"""Contacts and distances that `impinge.trimesh.CollisionManager` returns."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge


class ContactData:
    """Two faces in contact, or two bodies of which one is inside the other.

    The points, normals and depths of all contacts of an answer are computed when the first of them
    is read. Later changes of the manager do not affect them.

    Attributes
    ----------
    names : set of str
        Names of the two objects; ``"__external"`` for an object that is in no manager.
    point : (3,) float64 array
        A common point of both faces, or of both bodies, in the world frame, rounded.
    normal : (3,) float64 array
        Unit vector in the world frame, from the mesh of this manager to the other one, or from the
        mesh that was added first to the other one.
    depth : float
        In world units, at least zero. Two convex bodies, or a body inside another one: the upper
        bound of `impinge.penetration`. Otherwise: the depth of the region in which the surfaces
        penetrate each other, rounded. It is not the depth of the two faces.
    """

    __slots__ = ("_row", "_rows")
    _rows: Contacts
    _row: int

    def __init__(self, rows: Contacts, row: int) -> None:
        self._rows, self._row = rows, row

    @property
    def names(self) -> set[Hashable]:
        """The names of the two objects."""
        return set(self._rows.names_of(self._row))

    @property
    def point(self) -> NDArray[np.float64]:
        """A common point, (3,)."""
        point: NDArray[np.float64] = self._rows.details()[0][self._row]
        return point

    @property
    def normal(self) -> NDArray[np.float64]:
        """The unit normal, (3,)."""
        normal: NDArray[np.float64] = self._rows.details()[1][self._row]
        return normal

    @property
    def depth(self) -> float:
        """The depth."""
        return float(self._rows.details()[2][self._row])

    def index(self, name: Hashable) -> int:
        """Return the face in contact of the object with this name, as an index into its faces.

        It is -1 if one object is inside the other. Raise a `KeyError` for another name.
        """
        faces: list[int] = self._rows.faces[self._row].tolist()
        return dict(zip(self._rows.names_of(self._row), faces, strict=True))[name]

    def __repr__(self) -> str:
        """Return the names, the point and the depth."""
        return f"ContactData({sorted(map(str, self.names))}, point={self.point.tolist()}, depth={self.depth:.6g})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how to make an equal contact, without the others."""
        row = slice(self._row, self._row + 1)
        faces = np.zeros(1, np.int64), self._rows.faces[row]
        details = [column[row] for column in self._rows.details()]
        return type(self), (Contacts([self._rows.names_of(self._row)], faces, details), 0)


class Contacts:
    """Columns of contacts. Those of points, normals and depths are computed at the first use."""

    __slots__ = ("_details", "_found", "faces", "pairs", "pairs_of_rows")

    def __init__(
        self,
        pairs: list[tuple[Hashable, Hashable]],
        faces: Sequence[NDArray[np.int64]],
        details: Sequence[NDArray[np.float64]] | _impinge.ManagerContacts,
    ) -> None:
        self.pairs = pairs
        self.pairs_of_rows: NDArray[np.int64]
        self.faces: NDArray[np.int64]
        self.pairs_of_rows, self.faces = faces
        self._found = details if isinstance(details, _impinge.ManagerContacts) else None
        self._details = None if isinstance(details, _impinge.ManagerContacts) else details

    def names_of(self, row: int) -> tuple[Hashable, Hashable]:
        return self.pairs[int(self.pairs_of_rows[row])]

    def details(self) -> Sequence[NDArray[np.float64]]:
        """Return the points and the normals, (k, 3), and the depths, (k,), of all contacts."""
        if self._details is None:
            assert self._found is not None
            self._details, self._found = self._found.details(), None
        return self._details


class DistanceData:
    """Distance of two objects, and their nearest points.

    Attributes
    ----------
    names : set of str
        Names of the two objects; ``"__external"`` for an object that is in no manager.
    distance : float
        In world units: the upper bound of `impinge.distance`. Minus the depth if two convex bodies
        overlap, -1 if a convex body and a surface collide, and 0 if two surfaces intersect.
    """

    def __init__(
        self,
        names: tuple[Hashable, Hashable],
        distance: float,
        faces: tuple[int, int],
        points: NDArray[np.float64],
    ) -> None:
        self.names = set(names)
        self.distance = distance
        self._faces: dict[Hashable, int] = dict(zip(names, faces, strict=True))
        self._points: dict[Hashable, NDArray[np.float64]] = dict(zip(names, points, strict=True))

    def index(self, name: Hashable) -> int:
        """Return the nearest face of the object with this name, as an index into its faces.

        It is -1 if the object is convex, or is a surface inside a convex one. Raise a `KeyError`
        for another name.
        """
        return self._faces[name]

    def point(self, name: Hashable) -> NDArray[np.float64]:
        """Return the nearest point, (3,), of the object with this name, in the world frame.

        It is rounded. It is zero if a convex object and a surface collide, and the deepest point if
        two convex objects overlap. Raise a `KeyError` for another name.
        """
        return self._points[name]
