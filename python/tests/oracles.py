"""Answers that share no code with the library: rational arithmetic, and brute force in NumPy."""

from fractions import Fraction
from itertools import combinations

import numpy as np


def oracle_pairs(a, b, pose_a=None, pose_b=None):
    """Returns every intersecting pair of faces, in rational arithmetic.

    Two triangles intersect if and only if the hull of the nine differences of their corners
    contains the origin. Then the hull of at most four affinely independent differences contains it
    (Caratheodory).
    """
    (a, faces_a), (b, faces_b) = _exact(a, pose_a), _exact(b, pose_b)
    pairs = []
    for i, face_a in enumerate(faces_a):
        for j, face_b in enumerate(faces_b):
            if _intersect([a[v] for v in face_a], [b[v] for v in face_b]):
                pairs.append((i, j))
    return np.array(pairs, np.uint32).reshape(-1, 2)


def _exact(mesh, pose):
    vertices, faces = mesh
    matrix = [[Fraction(float(x)) for x in row] for row in (np.eye(4) if pose is None else np.asarray(pose))]
    points = [[Fraction(float(x)) for x in vertex] for vertex in vertices]
    return [
        [sum(m * x for m, x in zip(row, point, strict=False)) + row[3] for row in matrix[:3]] for point in points
    ], faces


def _intersect(p, q):
    if any(
        max(x[k] for x in p) < min(x[k] for x in q) or min(x[k] for x in p) > max(x[k] for x in q) for k in range(3)
    ):
        return False
    differences = [[x - y for x, y in zip(u, v, strict=True)] for u in p for v in q]
    return any(_holds_origin(chosen) for size in (1, 2, 3, 4) for chosen in combinations(differences, size))


def _holds_origin(points):
    """Reports whether the hull of affinely independent points contains the origin.

    False if the points are dependent.
    """
    size = len(points)
    rows = [[point[k] for point in points] + [Fraction(0)] for k in range(3)] + [[Fraction(1)] * size + [Fraction(1)]]
    for column in range(size):
        pivot = next((r for r in range(column, 4) if rows[r][column]), None)
        if pivot is None:
            return False
        rows[column], rows[pivot] = rows[pivot], rows[column]
        rows[column] = [x / rows[column][column] for x in rows[column]]
        for r in range(4):
            if r != column and rows[r][column]:
                rows[r] = [x - rows[r][column] * y for x, y in zip(rows[r], rows[column], strict=True)]
    return all(row[size] >= 0 for row in rows[:size]) and all(row[size] == 0 for row in rows[size:])


def surface_distances(mesh, points):
    """Returns the distances (n, m) of n points from m faces."""
    vertices, faces = mesh
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area_squared = (normal * normal).sum(axis=-1)
    to_edges = [_to_segment(points[:, None], start, end) for start, end in ((a, b), (b, c), (c, a))]
    height = ((points[:, None] - a) * normal).sum(axis=-1)
    is_over = np.ones(height.shape, bool)
    for start, end in ((a, b), (b, c), (c, a)):
        is_over &= (np.cross(end - start, points[:, None] - start) * normal).sum(axis=-1) >= 0
    flat = area_squared == 0
    to_plane = np.abs(height) / np.sqrt(np.where(flat, 1, area_squared))
    return np.where(is_over & ~flat, to_plane, np.min(to_edges, axis=0))


def mesh_distance(a, b):
    """Returns the distance of two disjoint surfaces: of a corner and a face, or of two edges."""
    (vertices_a, faces_a), (vertices_b, faces_b) = a, b
    edges_a, edges_b = (faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2) for faces in (faces_a, faces_b))
    best = min(surface_distances(a, vertices_b).min(), surface_distances(b, vertices_a).min())
    p, q = vertices_a[edges_a[:, 0], None], vertices_b[None, edges_b[:, 0]]
    d, e = vertices_a[edges_a[:, 1], None] - p, vertices_b[None, edges_b[:, 1]] - q
    normal = np.cross(d, e)
    squared = (normal * normal).sum(axis=-1)
    safe = np.where(squared == 0, 1, squared)
    s = (np.cross(q - p, e) * normal).sum(axis=-1) / safe
    t = (np.cross(q - p, d) * normal).sum(axis=-1) / safe
    cross = (squared > 0) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    apart = np.abs(((q - p) * normal).sum(axis=-1)) / np.sqrt(safe)
    return min(best, np.where(cross, apart, np.inf).min())


def winding_numbers(mesh, points):
    """Returns the winding numbers (n,), sums of solid angles (Van Oosterom and Strackee 1983)."""
    vertices, faces = mesh
    a, b, c = (vertices[faces[:, k]] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=-1) for x in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=-1)
    dots = [(x * y).sum(axis=-1) * length for x, y, length in ((a, b, lc), (b, c, la), (c, a, lb))]
    return 2 * np.arctan2(volume, la * lb * lc + sum(dots)).sum(axis=1) / (4 * np.pi)


def _to_segment(points, start, end):
    along = end - start
    squared = (along * along).sum(axis=-1)
    t = ((points - start) * along).sum(axis=-1) / np.where(squared == 0, 1, squared)
    return np.linalg.norm(points - start - np.clip(t, 0, 1)[..., None] * along, axis=-1)
