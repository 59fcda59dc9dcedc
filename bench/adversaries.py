"""Meshes that are hard for hierarchies of boxes: surfaces that nearly coincide, and slivers."""

import numpy as np
from torus_knot import torus_knot

# Height of the bumps, relative to the radius of the sphere. A sphere without bumps would coincide
# with its rotated copy.
BUMP = 0.05
SHRUNK = 1e-3  # scale of the knot among the slivers, which cross a unit box
SLIVER = (0.003, 0.002, 0.0)  # short edge of each sliver


def bumpy_sphere(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return float64 vertices (k, 3) and int32 faces (12 * n * n, 3) of a bumpy sphere.

    Its radius is about 1. It is a cube whose sides are grids of n by n quads, projected onto the
    sphere.
    """
    grid = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n + 1))
    x, y = (side.ravel() for side in np.meshgrid(grid, grid, indexing="ij"))
    one = np.ones_like(x)
    sides = [(x, y, one), (y, x, -one), (one, x, y), (-one, y, x), (y, one, x), (x, -one, y)]
    vertices = np.concatenate([np.stack(side, axis=-1) for side in sides])
    vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)

    row, column = (side.ravel() for side in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    corner = row * (n + 1) + column
    halves = [(corner, corner + n + 1, corner + n + 2), (corner, corner + n + 2, corner + 1)]
    of_a_side = [np.stack(half, axis=-1) for half in halves]
    faces = np.concatenate([half + side * (n + 1) ** 2 for side in range(6) for half in of_a_side])

    px, py, pz = vertices.T
    radius = 1.0 + BUMP * np.sin(7.0 * px) * np.sin(9.0 * py) * np.sin(8.0 * pz)
    return vertices * radius[:, None], faces.astype(np.int32)


def stadium(nu: int, nv: int, slivers: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and faces of a tiny torus knot of nu by nv quads among long random slivers.

    The knot is in the middle of a unit box that the slivers cross. Its size is `SHRUNK` times that
    of the usual knot. Equal arguments give equal meshes.
    """
    vertices, faces = torus_knot(nu, nv)
    rng = np.random.default_rng(7)
    starts, ends = rng.random((slivers, 3)), rng.random((slivers, 3))
    corners = np.stack([starts, ends, ends + SLIVER], axis=1).reshape(-1, 3)
    added = len(vertices) + np.arange(3 * slivers, dtype=np.int32).reshape(-1, 3)
    return np.concatenate([vertices * SHRUNK + 0.5, corners]), np.concatenate([faces, added])


def rod(facets: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and faces of a rod along x, of length 20 and radius 1, without end caps.

    Each facet consists of two slivers, each as long as the rod.
    """
    angle = 2.0 * np.pi * np.arange(facets) / facets
    ends = [np.stack([np.full(facets, x), np.cos(angle), np.sin(angle)], axis=-1) for x in (-10.0, 10.0)]
    low = np.arange(facets, dtype=np.int32)
    high, beside = low + facets, np.roll(low, -1)
    return np.concatenate(ends), np.concatenate(
        [np.stack([low, high, beside + facets], axis=-1), np.stack([low, beside + facets, beside], axis=-1)]
    )
