"""Bodies of the drop-in modules `impinge.trimesh` and `impinge.fcl`: surfaces or convex solids."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

import impinge
from impinge import _impinge
from impinge._contacts import Contacts
from impinge._distances import distance
from impinge._intersections import intersecting_pairs, intersects, penetrates
from impinge._mesh import Mesh
from impinge._rows import Solid
from impinge._shape import Shape

_PADDING = 1e-12
"""Padding of boxes, relative to the magnitudes of the terms that make up a corner. It exceeds the
rounding errors of the corners, so that no box is too small."""

CONTAINED = np.array([[-1, -1]])
"""Result of `contacts` if one body lies inside the other, which is solid, and their surfaces do not
intersect. -1 means no face."""


class Body:
    """One of: the surface of a mesh, a convex mesh as a solid, or a solid shape without a mesh.

    Attributes
    ----------
    mesh : Mesh
        The mesh, in the body frame; empty if the body has none.
    solid : bool
        Whether the points inside belong to the body.
    """

    def __init__(self, mesh: Mesh, *, solid: bool, round_shape: Shape | None = None) -> None:
        self.mesh = mesh
        self.solid = solid
        self._round = round_shape

    @classmethod
    def of_shape(cls, shape: Shape) -> Body:
        """Return a convex solid without a mesh."""
        return cls(Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)), solid=True, round_shape=shape)

    @property
    def is_mesh(self) -> bool:
        """Report whether the body has a mesh, and therefore faces."""
        return self._round is None

    @cached_property
    def shape(self) -> Shape:
        """The body as a shape in the body frame; a convex solid mesh becomes its hull."""
        if self._round is not None:
            return self._round
        return Shape.hull(self.mesh.vertices) if self.solid else Shape.mesh(self.mesh)

    @cached_property
    def box(self) -> NDArray[np.float64]:
        """Center and half-extents (2, 3), rounded, of a box around the body in the body frame.

        NaN if the body has no points, or is a half-space.
        """
        bounds = None if self._round is None else self._round.bounds
        points: NDArray[Any] = self.mesh.vertices if bounds is None else bounds
        if len(points) == 0:
            return np.full((2, 3), np.nan)
        low, high = points.min(axis=0).astype(float), points.max(axis=0).astype(float)
        return np.stack([low / 2 + high / 2, high / 2 - low / 2])

    def box_at(self, pose: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return lower and upper corners (2, 3) of a world-frame box that contains the posed body.

        Infinite for a half-space; NaN if the body has no points.
        """
        if self._round is not None and self._round.bounds is None:
            return np.array([[-np.inf] * 3, [np.inf] * 3])
        center, half = self.box
        linear, translation = pose[:3, :3], pose[:3, 3]
        middle = linear @ center + translation
        reach = np.abs(linear) @ half
        reach += _PADDING * (np.abs(linear) @ (np.abs(center) + half) + np.abs(translation))
        return np.stack([middle - reach, middle + reach])


@dataclass(frozen=True)
class Separation:
    """Distance of two bodies, or minus the penetration depth of two solids; see `separation`.

    Attributes
    ----------
    value : float
        Distance, or minus the depth, in world units; -1 if a depth is not computed.
    points : list of two (3,) float64 arrays
        Nearest or deepest point of each body in the world frame, rounded; zero if there are none.
    faces : (int, int)
        Nearest face of each body, as an index into its mesh's faces; -1 if there is none.
    """

    value: float
    points: list[NDArray[np.float64]]
    faces: tuple[int, int]


def separation(
    a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64], *, signed: bool
) -> Separation:
    """Measure the distance of two bodies, in world units, by the conventions of FCL.

    The value is -1 if at least one body is solid and they collide. If `signed` is set and both are
    solid, it is minus the penetration depth instead. It is 0 for two solids that only touch, and
    for two surfaces that intersect. Distance and depth are the upper bounds of `impinge.distance`
    and `impinge.penetration`. Faces are -1 for a solid, and for a body inside one. Points are zero
    if there are none. Poses are world from body.
    """
    if not (a.is_mesh and b.is_mesh):
        return _of_shapes(a, b, pose_a, pose_b, signed=signed)
    far = distance(a.mesh, b.mesh, pose_a, pose_b, solid=solids(a, b))
    faces = (-1 if a.solid else int(far.face_a), -1 if b.solid else int(far.face_b))
    value, none = float(far.distance), [np.zeros(3), np.zeros(3)]
    if value > 0 or not (a.solid or b.solid):
        return Separation(value, [far.point_a, far.point_b], faces)
    if a.solid and b.solid and not penetrates(a.mesh, b.mesh, pose_a, pose_b):
        return Separation(0.0, [far.point_a, far.point_b], faces)
    if a.solid and b.solid and signed:
        deep = impinge.penetration(a.shape, b.shape, pose_a, pose_b)
        return Separation(-float(deep.depth), [deep.point_a, deep.point_b], faces)
    return Separation(-1.0, none, faces)


def _of_shapes(
    a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64], *, signed: bool
) -> Separation:
    """Measure as `separation` does, if at least one body has no mesh."""
    far = impinge.distance(a.shape, b.shape, pose_a, pose_b)
    value = float(far.distance)
    if value == 0 and a.solid and b.solid:
        deep = impinge.penetration(a.shape, b.shape, pose_a, pose_b)
        if deep.depth > 0 and signed:
            return Separation(-float(deep.depth), [deep.point_a, deep.point_b], (-1, -1))
        value = -1.0 if deep.lower > 0 else 0.0
    elif value == 0:
        value = -1.0
    return Separation(value, [far.point_a, far.point_b] if value >= 0 else [np.zeros(3), np.zeros(3)], (-1, -1))


def gap(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Return a lower bound of the distance between two (2, 3) boxes of lower and upper corners.

    Both are in one frame. It is 0 if the boxes overlap, and NaN if a corner is NaN.
    """
    between = np.maximum(np.maximum(a[0] - b[1], b[0] - a[1]), 0)
    return float(np.linalg.norm(between)) * (1 - _PADDING)


def overlaps(boxes: NDArray[np.float64], box: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the indices of those of (n, 2, 3) boxes that overlap one (2, 3) box, ascending.

    All are in one frame. Touching counts, and NaN overlaps everything.
    """
    apart = (boxes[:, 0] > box[1]) | (boxes[:, 1] < box[0])
    return np.flatnonzero(~apart.any(axis=1))


def solids(a: Body, b: Body) -> Solid:
    """Return which of two bodies are solid, as the `solid` argument of the queries."""
    if a.solid == b.solid:
        return a.solid
    return "a" if a.solid else "b"


def collide(a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64]) -> bool:
    """Report whether two bodies have a point in common; undecided counts as True.

    Poses are world from body. The test is as exact as `impinge.intersects`.
    """
    if not (a.is_mesh and b.is_mesh):
        return impinge.intersects(a.shape, b.shape, pose_a, pose_b) is True
    return intersects(a.mesh, b.mesh, pose_a, pose_b, solid=solids(a, b)) is True


def contacts(
    a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64], limit: int
) -> NDArray[np.int64]:
    """Return at most `limit` pairs of faces in contact, as indices (face of a, face of b), (k, 2).

    The result is `CONTAINED` if one body is inside the other and no faces intersect. If a body has
    no mesh, the result has a row of -1 for each contact, the deepest first.
    """
    if not (a.is_mesh and b.is_mesh):
        return np.full((min(limit, len(_contacts_by_depth(a, b, pose_a, pose_b))), 2), -1)
    pairs = np.asarray(intersecting_pairs(a.mesh, b.mesh, pose_a, pose_b, limit=limit).pairs).astype(np.int64)
    if len(pairs) == 0 and limit > 0 and collide(a, b, pose_a, pose_b):
        return CONTAINED
    return pairs


def _contacts_by_depth(a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64]) -> Contacts:
    """Return the contacts of two bodies, at least one of them without a mesh, the deepest first."""
    found = impinge.contacts(a.shape, b.shape, pose_a, pose_b)
    found = found if isinstance(found, Contacts) else found.all
    return found[np.argsort(-found.depth, kind="stable")]


def contact_points(
    a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64], pairs: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return a common point of the two bodies for each row of `pairs`, the result of `contacts`.

    Points are (k, 3), in the world frame, rounded.
    """
    if not (a.is_mesh and b.is_mesh):
        found = _contacts_by_depth(a, b, pose_a, pose_b)[: len(pairs)]
        middle: NDArray[np.float64] = found.point_a / 2 + found.point_b / 2
        return middle
    if np.array_equal(pairs, CONTAINED):
        inside_b = b.solid and intersects(a.mesh, b.mesh, pose_a, pose_b, solid="b")
        return _inner_point(a, b, pose_a, pose_b) if inside_b else _inner_point(b, a, pose_b, pose_a)
    question = (a.mesh, b.mesh, pose_a, pose_b, False, "raise", False)
    points, coplanar = _impinge.contact_points(question, pairs.astype(np.uint32))
    for row in np.flatnonzero(coplanar):
        on_a = _transformed(a.mesh.vertices[a.mesh.faces[pairs[row, 0]]], pose_a)
        on_b = _transformed(b.mesh.vertices[b.mesh.faces[pairs[row, 1]]], pose_b)
        points[row] = _common_point(on_a, on_b)
    return points


def contact_normals(
    a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64], pairs: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return unit normals from `a` to `b`, (k, 3), and depths along them, (k,), for pairs of faces.

    Normals are in the world frame and depths in world units, at least zero. `pairs` is the result
    of `contacts`. Two convex solids, or a body inside a solid, have a single normal and depth, the
    shortest way to separate them. A contact with a shape that has no mesh has its own normal and
    depth. Other pairs have the normal and depth of the region in which the surfaces penetrate each
    other.
    """
    if not (a.is_mesh and b.is_mesh):
        found = _contacts_by_depth(a, b, pose_a, pose_b)[: len(pairs)]
        return found.normal, np.maximum(found.depth, 0)
    if (a.solid and b.solid) or np.array_equal(pairs, CONTAINED):
        deep = impinge.penetration(a.shape, b.shape, pose_a, pose_b)
        return np.tile(deep.normal, (len(pairs), 1)), np.full(len(pairs), deep.depth)
    return _impinge.contact_normals((a.mesh, b.mesh, pose_a, pose_b, False, "raise", False), pairs.astype(np.uint32))


def _transformed(points: NDArray[np.floating], pose: NDArray[np.float64]) -> NDArray[np.float64]:
    placed: NDArray[np.float64] = points.astype(float) @ pose[:3, :3].T + pose[:3, 3]
    return placed


def _inner_point(
    inner: Body, outer: Body, pose_inner: NDArray[np.float64], pose_outer: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a vertex of `inner` that lies in the solid `outer`, (1, 3), in the world frame.

    At least one connected component of `inner` must be inside `outer`.
    """
    placed = _transformed(inner.mesh.vertices, pose_inner)
    seen_from_outer = np.linalg.solve(pose_outer[:3, :3], (placed - pose_outer[:3, 3]).T).T
    first = int(np.argmax(outer.mesh.contains(seen_from_outer)))
    return placed[first : first + 1]


def _common_point(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a common point of two coplanar triangles: their overlap's mean corner, rounded."""
    normal = np.cross(b[1] - b[0], b[2] - b[0])
    if not normal.any():
        normal = np.cross(a[1] - a[0], a[2] - a[0])
    polygon = list(a)
    for k in range(3):
        start, inward = b[k], np.cross(normal, b[(k + 1) % 3] - b[k])
        heights = [float(inward @ (point - start)) for point in polygon]
        clipped = []
        for i, (point, height) in enumerate(zip(polygon, heights, strict=True)):
            before, lower = polygon[i - 1], heights[i - 1]
            if (height < 0) != (lower < 0):
                clipped.append(before + (point - before) * (lower / (lower - height)))
            if height >= 0:
                clipped.append(point)
        if not clipped:  # lost to rounding: use the remaining corner nearest to the edge
            clipped = [polygon[int(np.argmax(heights))]]
        polygon = clipped
    mean: NDArray[np.float64] = np.mean(polygon, axis=0)
    return mean
