"""How far apart two shapes are, and how deep they are in each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge._points import scalar


@dataclass(frozen=True, eq=False)
class ShapeDistance:
    """How far apart two shapes are, with what was proved about it; arrays where the poses have leading axes.

    Attributes
    ----------
    distance : float or (...) float64 array
        Zero exactly where they intersect, else `upper`.
    lower, upper : float or (...) float64 array
        The true distance lies between them, in world units; infinite where a shape is an empty mesh.
    point_a, point_b : (..., 3) float64 array
        Nearest points in the world frame, rounded; zero where there are none.
    """

    distance: float | NDArray[np.float64]
    lower: float | NDArray[np.float64]
    upper: float | NDArray[np.float64]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Penetration:
    """How deep two shapes are in each other, with what was proved about it; arrays where the poses have leading axes.

    Attributes
    ----------
    depth : float or (...) float64 array
        `upper`; zero where the shapes are apart, and where they touch.
    lower, upper : float or (...) float64 array
        No translation shorter than `lower` takes their interiors apart; moving the second by `upper` along the normal
        does. In world units; infinite where nothing does.
    normal : (..., 3) float64 array
        Of length 1, from the first shape to the second, in the world frame; zero where they are apart.
    point_a, point_b : (..., 3) float64 array
        The points of either shape that are deepest in the other, in the world frame, rounded; zero where they are
        apart.
    hit : bool or (...) bool array
        Whether they intersect.
    """

    depth: float | NDArray[np.float64]
    lower: float | NDArray[np.float64]
    upper: float | NDArray[np.float64]
    normal: NDArray[np.float64]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    hit: bool | NDArray[np.bool_]


def shape_distance_of(columns: Any) -> ShapeDistance:
    """Return what the extension has in columns: plain numbers in place of arrays without axes."""
    value, lower, upper, point_a, point_b = columns
    return ShapeDistance(scalar(value), scalar(lower), scalar(upper), point_a, point_b)


def penetration_of(columns: Any) -> Penetration:
    """Return what the extension has in columns: plain numbers in place of arrays without axes."""
    hit, lower, upper, normal, point_a, point_b = columns
    upper = scalar(upper)
    return Penetration(upper, scalar(lower), upper, normal, point_a, point_b, scalar(hit))
