"""The mesh of the headline benchmark, a closed bumpy tube around a torus knot, as a PLY file."""

from pathlib import Path

import numpy as np

# The knot winds P times around the axis of the torus while it passes Q times through its hole.
P, Q = 2, 3
TORUS_RADIUS = 2.0  # radius of the circle that the knot winds around, at a distance of 1
TUBE_RADIUS = 0.4  # thin enough that the tube does not intersect itself
BUMP = 0.03  # height of the bumps, relative to the radius of the tube; without them, rows are regular
BUMPS_ALONG, BUMPS_ROUND = 40, 6  # numbers of bumps along the knot and around its tube


def torus_knot(nu: int, nv: int, tube_radius: float = TUBE_RADIUS) -> tuple[np.ndarray, np.ndarray]:
    """Return (nu * nv, 3) float64 vertices and (2 * nu * nv, 3) int32 faces of a torus knot.

    It has nu quads along the knot and nv around its tube. The mesh is closed. Its faces are
    clockwise as seen from outside.
    """
    u = np.linspace(0.0, 2.0 * np.pi, nu, endpoint=False)
    v = np.linspace(0.0, 2.0 * np.pi, nv, endpoint=False)
    center = _center(u)

    # A frame along the tube: the tangent is a central difference, and the normal points away from
    # the axis of the torus.
    step = 1e-4
    tangent = _unit(_center(u + step) - _center(u - step))
    outward = _unit(center * [1.0, 1.0, 0.0])
    normal = _unit(outward - np.sum(outward * tangent, axis=1, keepdims=True) * tangent)
    binormal = np.cross(tangent, normal)

    radius = tube_radius * (1.0 + BUMP * np.sin(BUMPS_ALONG * u)[:, None] * np.sin(BUMPS_ROUND * v)[None, :])
    across = np.cos(v)[None, :, None] * normal[:, None] + np.sin(v)[None, :, None] * binormal[:, None]
    vertices = center[:, None] + radius[..., None] * across
    return vertices.reshape(-1, 3), _faces(nu, nv)


def write_ply(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Write (n, 3) vertices, float32 or float64, and (m, 3) faces as a binary PLY file."""
    name, code = {4: ("float", "<f4"), 8: ("double", "<f8")}[vertices.itemsize]
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty {name} x\nproperty {name} y\nproperty {name} z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    rows["count"] = 3
    rows["corners"] = faces
    path.write_bytes(header.encode("ascii") + vertices.astype(code).tobytes() + rows.tobytes())


def _center(u: np.ndarray) -> np.ndarray:
    from_axis = TORUS_RADIUS + np.cos(Q * u)
    return np.stack([from_axis * np.cos(P * u), from_axis * np.sin(P * u), np.sin(Q * u)], axis=-1)


def _unit(rows: np.ndarray) -> np.ndarray:
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def _faces(nu: int, nv: int) -> np.ndarray:
    i = np.arange(nu)[:, None]
    j = np.arange(nv)[None, :]
    i_next, j_next = (i + 1) % nu, (j + 1) % nv
    a, b = i * nv + j, i_next * nv + j
    c, d = i_next * nv + j_next, i * nv + j_next
    lower = np.stack([a, b, c], axis=-1).reshape(-1, 3)
    upper = np.stack([a, c, d], axis=-1).reshape(-1, 3)
    return np.concatenate([lower, upper]).astype(np.int32)
