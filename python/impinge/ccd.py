"""Continuous collision of vertices that move along lines: of single features and whole surfaces.

Each corner moves along its own line at constant velocity, from time 0 to time 1. Simulations of
cloth and other deformable bodies use these queries.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._deforming import Deforming, SweptContacts
from impinge._points import scalar

__all__ = ["Deforming", "SweptContacts", "edge_edge", "vertex_face"]


def vertex_face(t0: ArrayLike, t1: ArrayLike) -> float | NDArray[np.float64]:
    """Compute the time at which moving vertices first touch moving faces.

    Parameters
    ----------
    t0, t1 : (..., 4, 3) array_like of float32 or float64
        The vertex, then the three corners of the face, at time 0 and at time 1 of a linear motion.
        All are in one frame, with coordinates below 2^128 in magnitude. The leading axes of both
        broadcast as in NumPy.

    Returns
    -------
    float or (...) float64 array
        A time in [0, 1] that is never later than the true first contact, and within 2^-30 of it if
        contact is proved. Infinite if and only if contact is disproved. Features that touch at the
        start give 0.

    Raises
    ------
    InputError
        If an array has another shape or type, or if a coordinate is not finite or out of range; the
        error names the coordinate.

    Examples
    --------
    >>> import impinge
    >>> face = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> round(impinge.ccd.vertex_face([[0.2, 0.2, 1], *face], [[0.2, 0.2, -1], *face]), 9)
    0.5
    >>> impinge.ccd.vertex_face([[0.2, 0.2, 1], *face], [[0.2, 0.2, 1e-300], *face])
    inf
    """
    return _first(_impinge.vertex_face(t0, t1))


def edge_edge(t0: ArrayLike, t1: ArrayLike) -> float | NDArray[np.float64]:
    """Compute the time at which moving edges first touch.

    Parameters
    ----------
    t0, t1 : (..., 4, 3) array_like of float32 or float64
        The two ends of one edge, then the two ends of the other, at time 0 and at time 1 of a
        linear motion; otherwise as for `vertex_face`.

    Returns
    -------
    float or (...) float64 array
        As for `vertex_face`.

    Raises
    ------
    InputError
        As for `vertex_face`.

    Examples
    --------
    >>> import impinge
    >>> t0 = [[-1, 0, 1], [1, 0, 1], [0, -1, 0], [0, 1, 0]]
    >>> t1 = [[-1, 0, -3], [1, 0, -3], [0, -1, 0], [0, 1, 0]]
    >>> round(impinge.ccd.edge_edge(t0, t1), 9)
    0.25
    """
    return _first(_impinge.edge_edge(t0, t1))


def _first(bounds: tuple[NDArray[np.float64], NDArray[np.float64]]) -> float | NDArray[np.float64]:
    return scalar(bounds[0])  # type: ignore[no-any-return]
