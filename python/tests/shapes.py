"""Meshes for the tests, and an oracle that shares no code with the library."""

from fractions import Fraction
from itertools import combinations

import numpy as np

TRIANGLE = (np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))


def cube(low=-0.5, high=0.5):
    """(8, 3) vertices and (12, 3) faces."""
    vertices = np.array([[x, y, z] for x in (low, high) for y in (low, high) for z in (low, high)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])


def torus(along=40, around=20, radius=1.0, tube=0.35):
    """A closed torus about the z axis."""
    u, v = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    a, b = 2 * np.pi * u / along, 2 * np.pi * v / around
    reach = radius + tube * np.cos(b)
    vertices = np.stack([reach * np.cos(a), reach * np.sin(a), tube * np.sin(b)], axis=-1).reshape(-1, 3)
    at = lambda i, j: ((u + i) % along * around + (v + j) % around).ravel()  # noqa: E731
    halves = [(at(0, 0), at(1, 0), at(1, 1)), (at(0, 0), at(1, 1), at(0, 1))]
    return vertices, np.stack([np.stack(half, axis=-1) for half in halves], axis=1).reshape(-1, 3)


def random_poses(count, reach, seed):
    """(count, 4, 4) rigid poses with translations within `reach`."""
    rng = np.random.default_rng(seed)
    quaternions = rng.normal(size=(count, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    w, x, y, z = quaternions.T
    poses = np.zeros((count, 4, 4))
    poses[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=-1)
    poses[:, 1, :3] = np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=-1)
    poses[:, 2, :3] = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1)
    poses[:, :3, 3] = rng.uniform(-reach, reach, size=(count, 3))
    poses[:, 3, 3] = 1
    return poses


def oracle_pairs(a, b, pose_a=None, pose_b=None):
    """Every meeting pair of faces, in rational arithmetic.

    Two triangles meet just where the origin lies in the hull of the nine differences of their corners, and then it lies
    in that of at most four of these that are independent (Caratheodory).
    """
    (a, faces_a), (b, faces_b) = _exact(a, pose_a), _exact(b, pose_b)
    pairs = []
    for i, face_a in enumerate(faces_a):
        for j, face_b in enumerate(faces_b):
            if _meet([a[v] for v in face_a], [b[v] for v in face_b]):
                pairs.append((i, j))
    return np.array(pairs, np.uint32).reshape(-1, 2)


def _exact(mesh, pose):
    vertices, faces = mesh
    matrix = [[Fraction(float(x)) for x in row] for row in (np.eye(4) if pose is None else np.asarray(pose))]
    points = [[Fraction(float(x)) for x in vertex] for vertex in vertices]
    return [
        [sum(m * x for m, x in zip(row, point, strict=False)) + row[3] for row in matrix[:3]] for point in points
    ], faces


def _meet(p, q):
    if any(
        max(x[k] for x in p) < min(x[k] for x in q) or min(x[k] for x in p) > max(x[k] for x in q) for k in range(3)
    ):
        return False
    differences = [[x - y for x, y in zip(u, v, strict=True)] for u in p for v in q]
    return any(_holds_origin(chosen) for size in (1, 2, 3, 4) for chosen in combinations(differences, size))


def _holds_origin(points):
    """Whether weights >= 0 with sum 1 take independent points to the origin; False for dependent ones."""
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
