"""BSP trees over the faces of a mesh return bitwise the same answers as the mesh."""

import impinge
import numpy as np
import pytest
from shapes import TRIANGLE, cube, torus

SOLIDS = {"cube": cube(), "torus": torus(), "open": (torus()[0], torus()[1][:-60]), "triangle": TRIANGLE}


@pytest.mark.parametrize("solid", SOLIDS.values(), ids=SOLIDS)
def test_points_and_rays_equal_those_of_the_mesh(solid):
    rng = np.random.default_rng(5)
    mesh = impinge.Mesh(*solid)
    tree = impinge.SolidBsp(mesh)
    vertices, faces = mesh.vertices.astype(float), mesh.faces
    middles = vertices[faces].mean(axis=1)
    points = np.concatenate([vertices, middles, rng.integers(-4, 5, (150, 3)) / 4, rng.uniform(-1.5, 1.5, (150, 3))])
    assert np.array_equal(tree.contains(points), mesh.contains(points))
    assert np.array_equal(tree.contains(points), mesh.contains(points)), "cells that are labelled say the same"
    assert tree.contains(points[:6].reshape(2, 3, 3)).shape == (2, 3)
    assert tree.contains(vertices[0]) is True
    origins = rng.integers(-8, 9, (300, 3)) / 4
    aims = np.concatenate([vertices, middles, origins[:100] + np.eye(3)[2]])
    directions = aims[rng.integers(0, len(aims), 300)] - origins
    directions[~directions.any(axis=1)] = [0, 1, 0]
    own, expected = tree.ray_cast(origins, directions), mesh.ray_cast(origins, directions)
    for name in ("hit", "t", "face", "point"):
        assert np.array_equal(getattr(own, name), getattr(expected, name))
    assert 15 < expected.hit.sum() < 300


def test_a_refit_of_the_mesh_does_not_change_the_tree():
    vertices, faces = cube()
    mesh = impinge.Mesh(vertices, faces)
    tree = impinge.SolidBsp(mesh)
    mesh.refit(np.asarray(vertices) + 9)
    assert tree.contains([0.0, 0, 0]) is True
    assert mesh.contains([0.0, 0, 0]) is False
    assert tree.cells > 6
    assert 3 <= tree.depth <= 12
    assert repr(tree) == f"<impinge.SolidBsp: {tree.cells} cells, {tree.depth} deep>"


def test_invalid_arguments_raise_an_error():
    tree = impinge.SolidBsp(impinge.Mesh(*cube()))
    with pytest.raises(impinge.InputError) as raised:
        tree.contains([[0, 0, 0], [0, 0, np.inf]])
    assert (raised.value.what, raised.value.where) == ("points", (1,))
    with pytest.raises(impinge.InputError):
        impinge.SolidBsp("cube")
