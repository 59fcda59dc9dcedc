"""Clashes of open parts against a second oracle: sampled points and their winding numbers.

The winding numbers are summed here, face by face, and the engine finds clashes by cells. So the two
have no common step.
"""

import itertools

import impinge
import numpy as np
import pytest
from test_clash_buildings import scene

TOLERANCE = 0.002

POINTS = 1500
"""Number of points that are sampled in the common box of a pair."""

SURE = 0.05
"""Difference from 1/2 above which a winding number tells inside from outside here."""

AROUND = [np.array(way) / np.linalg.norm(way) for way in itertools.product((-1, 0, 1), repeat=3) if any(way)]


def winding_numbers(mesh, points):
    """Sum the solid angles of all faces (van Oosterom and Strackee 1983)."""
    corners = np.asarray(mesh.vertices, float)[mesh.faces]
    numbers = np.zeros(len(points))
    for chunk in np.array_split(np.arange(len(points)), max(1, len(points) * len(corners) // 400_000)):
        a, b, c = (corners[None, :, k] - points[chunk, None] for k in range(3))
        x, y, z = (np.linalg.norm(v, axis=2) for v in (a, b, c))
        volume = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
        dots = (np.einsum("ijk,ijk->ij", p, q) for p, q in ((a, b), (b, c), (c, a)))
        ab, bc, ca = dots
        numbers[chunk] = np.arctan2(volume, x * y * z + ab * z + bc * x + ca * y).sum(axis=1) / (2 * np.pi)
    return np.abs(numbers)


def is_in(mesh, point):
    """Tell whether a point is inside a mesh or on its surface, where the winding number jumps."""
    return winding_numbers(mesh, point)[0] > 0.5 - 1e-6 or mesh.closest_point(point).upper[0] < 1e-9


def is_sampled_deeper(meshes, box, depth, rng):
    """Tell whether a sampled point is in both solids, and all around it is in one of them."""
    points = rng.uniform(box[0], box[1], (POINTS, 3))
    for mesh in meshes:
        points = points[winding_numbers(mesh, points) > 0.5 + SURE]
    for mesh in meshes:
        far = points[mesh.closest_point(points).lower > depth] if len(points) else points
        for point in far[:10]:
            around = point + depth * np.array(AROUND)
            if (winding_numbers(mesh, around) > 0.5 + SURE).all():
                return True
    return False


def test_open_parts_of_a_building_clash_where_samples_do():
    building = scene("duplex", np.float64)
    parts = dict(building.parts)
    report = impinge.clash(building, tolerance=TOLERANCE, contacts=True)
    rng = np.random.default_rng(5)
    shown, flush, agreed, missed = 0, 0, 0, []
    for each in report:
        meshes = [parts[each.a.name], parts[each.b.name]]
        if all(mesh.is_closed for mesh in meshes):
            continue
        if each.kind == "clash":
            # The witness lies in both solids, as deep as the report says.
            point = np.array([each.point])
            assert all(is_in(mesh, point) for mesh in meshes), each
            distance = max(mesh.closest_point(point).upper[0] for mesh in meshes)
            assert distance >= each.depth[0] * (1 - 1e-9), each
            shown += 1
        elif each.kind == "contact":
            low, high = np.reshape(each.box, (2, 3))
            # A part ends at its box, though the winding number of an open one may swell beyond it.
            if (high - low).min() <= 2 * TOLERANCE:
                flush += 1
            # Twice the tolerance leaves room for the gaps between samples.
            elif is_sampled_deeper(meshes, (low, high), 2 * TOLERANCE, rng):
                missed.append((each.a.name, each.b.name))
            else:
                agreed += 1
    assert shown > 50
    assert flush > 20
    assert agreed > 8
    assert not missed


def test_the_second_oracle_winds_once_around_a_tetrahedron():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    mesh = impinge.Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    assert winding_numbers(mesh, np.array([[0.1, 0.1, 0.1], [2.0, 0.5, 0.5]])) == pytest.approx([1, 0])
