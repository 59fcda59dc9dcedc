"""Meshes and poses for the tests."""

import numpy as np

TRIANGLE = (np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))


def cube(low=-0.5, high=0.5):
    """Returns (8, 3) vertices and (12, 3) faces of a cube."""
    vertices = np.array([[x, y, z] for x in (low, high) for y in (low, high) for z in (low, high)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])


def torus(along=40, around=20, radius=1.0, tube=0.35):
    """Returns vertices and faces of a closed torus about the z axis."""
    u, v = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    a, b = 2 * np.pi * u / along, 2 * np.pi * v / around
    reach = radius + tube * np.cos(b)
    vertices = np.stack([reach * np.cos(a), reach * np.sin(a), tube * np.sin(b)], axis=-1).reshape(-1, 3)
    at = lambda i, j: ((u + i) % along * around + (v + j) % around).ravel()  # noqa: E731
    halves = [(at(0, 0), at(1, 0), at(1, 1)), (at(0, 0), at(1, 1), at(0, 1))]
    return vertices, np.stack([np.stack(half, axis=-1) for half in halves], axis=1).reshape(-1, 3)


def random_poses(count, reach, seed):
    """Returns rigid poses (count, 4, 4) with translations within `reach` along each axis."""
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
