"""Meshes as the drop-in modules see them: surfaces, or convex solids, with boxes for a broad phase."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._mesh import Mesh
from impinge._queries import intersecting_pairs, intersects

_FAR = 2.0**100
"""A coordinate beyond every body, in mesh units; what is larger than that is not found to hold another body."""

_PADDING = 1e-12
"""Of the magnitudes that are added up in a box: more than their rounding errors, so that no box is too small."""

CONTAINED = np.array([[-1, -1]])
"""The pair that stands for a body inside a solid whose surface it does not touch: no faces."""


class Body:
    """A mesh, and whether its inside belongs to it; a solid must be convex."""

    def __init__(self, mesh: Mesh, *, solid: bool) -> None:
        self.mesh = mesh
        self.solid = solid

    @cached_property
    def box(self) -> NDArray[np.float64]:
        """Centre and half extents, (2, 3), in the mesh's own frame; NaN where there is no vertex."""
        vertices = self.mesh.vertices
        if len(vertices) == 0:
            return np.full((2, 3), np.nan)
        low, high = vertices.min(axis=0).astype(float), vertices.max(axis=0).astype(float)
        return np.stack([low / 2 + high / 2, high / 2 - low / 2])

    def box_at(self, pose: NDArray[np.float64]) -> NDArray[np.float64]:
        """Lower and upper corner, (2, 3), of a box in the world that holds the posed mesh."""
        centre, half = self.box
        linear, translation = pose[:3, :3], pose[:3, 3]
        middle = linear @ centre + translation
        reach = np.abs(linear) @ half
        reach += _PADDING * (np.abs(linear) @ (np.abs(centre) + half) + np.abs(translation))
        return np.stack([middle - reach, middle + reach])

    @cached_property
    def corners(self) -> NDArray[np.int64]:
        """One vertex of each connected component of the surface."""
        label = np.arange(len(self.mesh.vertices))
        faces = self.mesh.faces.astype(np.int64)
        while True:
            least = label[faces].min(axis=1)
            lower = label.copy()
            np.minimum.at(lower, faces.ravel(), np.repeat(least, 3))
            lower = lower[lower]  # twice as far in each round
            if np.array_equal(lower, label):
                return np.unique(label[faces])
            label = lower

    @cached_property
    def whiskers(self) -> tuple[tuple[Mesh, Mesh], ...]:
        """For each component two segments, from one of its corners far along the x axis either way."""
        made = []
        for corner in self.mesh.vertices[self.corners].astype(float):
            ends = [[sign * _FAR, corner[1], corner[2]] for sign in (-1.0, 1.0)]
            made.append(tuple(Mesh(np.array([corner, end]), [[0, 1, 1]]) for end in ends))
        return tuple((left, right) for left, right in made)


def overlaps(boxes: NDArray[np.float64], box: NDArray[np.float64]) -> NDArray[np.intp]:
    """Which of (n, 2, 3) boxes may overlap one (2, 3) box."""
    apart = (boxes[:, 0] > box[1]) | (boxes[:, 1] < box[0])
    return np.flatnonzero(~apart.any(axis=1))


def collide(a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64]) -> bool:
    """Whether two bodies have a point in common."""
    return bool(intersects(a.mesh, b.mesh, pose_a, pose_b)) or _is_contained(a, b, pose_a, pose_b)


def contacts(
    a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64], limit: int
) -> NDArray[np.int64]:
    """(k, 2) pairs of faces in contact, at most `limit`; `CONTAINED` where one is inside the other."""
    pairs = np.asarray(intersecting_pairs(a.mesh, b.mesh, pose_a, pose_b, limit=limit)).astype(np.int64)
    if len(pairs) == 0 and limit > 0 and _is_contained(a, b, pose_a, pose_b):
        return CONTAINED
    return pairs


def contact_points(
    a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64], pairs: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(k, 3) points of the world, one that each pair of `contacts` has in common."""
    if np.array_equal(pairs, CONTAINED):
        inner, pose = (a, pose_a) if _is_inside(a, b, pose_a, pose_b) else (b, pose_b)
        return (_placed(inner.mesh.vertices[:1], pose))[:1]
    points, coplanar = _impinge.contact_points(a.mesh, b.mesh, pose_a, pose_b, pairs.astype(np.uint32))
    for row in np.flatnonzero(coplanar):
        on_a = _placed(a.mesh.vertices[a.mesh.faces[pairs[row, 0]]], pose_a)
        on_b = _placed(b.mesh.vertices[b.mesh.faces[pairs[row, 1]]], pose_b)
        points[row] = _common_point(on_a, on_b)
    return points


def _placed(points: NDArray[np.floating], pose: NDArray[np.float64]) -> NDArray[np.float64]:
    placed: NDArray[np.float64] = points.astype(float) @ pose[:3, :3].T + pose[:3, 3]
    return placed


def _is_contained(a: Body, b: Body, pose_a: NDArray[np.float64], pose_b: NDArray[np.float64]) -> bool:
    return _is_inside(a, b, pose_a, pose_b) or _is_inside(b, a, pose_b, pose_a)


def _is_inside(inner: Body, outer: Body, pose_inner: NDArray[np.float64], pose_outer: NDArray[np.float64]) -> bool:
    """Whether a component of `inner`, whose surface `outer`'s does not meet, lies inside the convex `outer`.

    A point is inside a convex surface just where both halves of a line through it meet the surface.
    """
    if not outer.solid:
        return False
    low, high = outer.box_at(pose_outer)
    box = inner.box_at(pose_inner)
    if not ((box[0] <= high) & (box[1] >= low)).all():
        return False
    return any(
        intersects(left, outer.mesh, pose_inner, pose_outer) and intersects(right, outer.mesh, pose_inner, pose_outer)
        for left, right in inner.whiskers
    )


def _common_point(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a point that two triangles of one plane share: the mean corner of their overlap, rounded."""
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
        if not clipped:  # rounded away: the corner of what was left that is nearest to the edge
            clipped = [polygon[int(np.argmax(heights))]]
        polygon = clipped
    mean: NDArray[np.float64] = np.mean(polygon, axis=0)
    return mean
