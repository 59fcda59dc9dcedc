"""Surfaces whose vertices move along lines, and the features that touch on the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._errors import InputError

_KINDS = np.array(["vertex-face", "face-vertex", "edge-edge"])


@dataclass(frozen=True, eq=False, repr=False)
class SweptContacts:
    """Pairs of features of two surfaces that touch during a motion, sorted and unique.

    Times are from 0, the start of the motion, to 1, its end.

    Attributes
    ----------
    kinds : (n,) str array
        ``"vertex-face"`` for a vertex of the first surface and a face of the second,
        ``"face-vertex"`` for the opposite, and ``"edge-edge"`` for two edges.
    features_a, features_b : (n, 2) int64 array
        The feature of either surface: a row of the vertices or of the faces, then -1; or the rows
        of both ends of an edge, the lesser first.
    t_lower : (n,) float64 array
        Lower bound of the time of first contact of each pair: the features are apart before it.
    t_upper : (n,) float64 array
        Upper bound of that time; infinite if contact is not proved.
    """

    kinds: NDArray[np.str_]
    features_a: NDArray[np.int64]
    features_b: NDArray[np.int64]
    t_lower: NDArray[np.float64]
    t_upper: NDArray[np.float64]

    @property
    def first(self) -> float:
        """Lower bound of the time of the first contact; infinite without a contact."""
        return float(self.t_lower.min(initial=np.inf))

    def __len__(self) -> int:
        """Return the number of pairs."""
        return len(self.kinds)

    def __repr__(self) -> str:
        """Return the number of pairs and the first time."""
        return f"SweptContacts({len(self):,} pairs, first at {self.first:.6g})"


@final
class Deforming:
    """Triangles whose vertices move along lines at constant speed, from time 0 to time 1.

    Parameters
    ----------
    faces : (m, 3) array_like of int
        Rows of the vertices at the corners of each face.
    t0, t1 : (n, 3) array_like of float32 or float64
        Positions of the vertices at the start and at the end, in one frame for all surfaces.

    Raises
    ------
    InputError
        If an array has another type or shape, if a coordinate is not finite or not below 2^126 in
        magnitude, or if a face names a vertex that does not exist.

    Notes
    -----
    The method is that of Curtis and others, *Fast collision detection for deformable models using
    representative-triangles* (2008): a tree of boxes over the whole motion finds pairs of faces,
    and each vertex and edge is tested once.

    Examples
    --------
    >>> import impinge
    >>> ground = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
    >>> above = [[1, 1, 1], [1, 9, 9], [2, 9, 9]]
    >>> below = [[1, 1, -1], [1, 9, 9], [2, 9, 9]]
    >>> falling = impinge.ccd.Deforming([[0, 1, 2]], above, below)
    >>> contacts = falling.contacts(impinge.ccd.Deforming([[0, 1, 2]], ground, ground))
    >>> contacts.kinds[0].item(), contacts.features_a[0].tolist(), contacts.features_b[0].tolist()
    ('vertex-face', [0, -1], [0, -1])
    >>> round(contacts.first, 9)
    0.5
    """

    __slots__ = ("_core", "_made_of")

    def __init__(self, faces: ArrayLike, t0: ArrayLike, t1: ArrayLike) -> None:
        self._made_of = (
            _arrays.plain_faces(faces).copy(),
            _arrays.plain_points(t0, "t0").copy(),
            _arrays.plain_points(t1, "t1").copy(),
        )
        self._core = _impinge.DeformingCore(*self._made_of)

    def contacts(self, other: Deforming) -> SweptContacts:
        """Return all pairs of a vertex and a face, or of two edges, that touch during the motion.

        No contact is missed, and every pair touches unless its `t_upper` is infinite. Two surfaces
        that do not intersect at the start first touch at one of these pairs. The work is done on
        all cores; it grows with the number of pairs of faces whose boxes over the whole motion
        overlap.

        Raises
        ------
        InputError
            If the argument is not a `Deforming`.
        """
        return _contacts(self._core.contacts(_core_of(other)))

    def self_contacts(self) -> SweptContacts:
        """Return all pairs of features of this surface that touch and have no vertex in common.

        Of a vertex and a face, the vertex comes first. Otherwise as for `contacts`.
        """
        return _contacts(self._core.self_contacts())

    def __repr__(self) -> str:
        """Return the numbers of vertices and faces."""
        faces, t0, _ = self._made_of
        return f"Deforming({len(t0):,} vertices, {len(faces):,} faces)"

    def __copy__(self) -> Deforming:
        """Return the surface itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Deforming:
        """Return the surface itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arrays; unpickling builds the tree again."""
        return Deforming, self._made_of


def _core_of(value: object) -> _impinge.DeformingCore:
    if isinstance(value, Deforming):
        return value._core
    message = f"must be an impinge.ccd.Deforming, not {type(value).__qualname__}"
    raise InputError(message, kind="type", what="other")


def _contacts(
    columns: tuple[NDArray[np.uint8], NDArray[np.int64], NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]],
) -> SweptContacts:
    kinds, features_a, features_b, t_lower, t_upper = columns
    return SweptContacts(_KINDS[kinds], features_a, features_b, t_lower, t_upper)
