"""Repair of meshes, and its reports."""

import itertools

import impinge
import numpy as np
import pytest

CORNERS = np.array(list(itertools.product((0.0, 10.0), repeat=3)))
FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip
CUBE = impinge.Mesh(CORNERS, FACES)


def test_orienting_closes_a_cube_with_three_turned_sides():
    turned = FACES.copy()
    rows = [0, 1, 4, 5, 8, 9]
    turned[rows] = turned[rows][:, ::-1]
    mesh = impinge.Mesh(CORNERS, turned)
    inner = impinge.Mesh((CORNERS - 5) / 10 + 5, FACES)
    assert mesh.health().misoriented_edges > 0
    assert not mesh.is_closed
    repaired, repair = mesh.repaired(orient=True)
    assert repair.turned_faces.tolist() == rows
    assert repaired.is_closed
    assert repaired.contains([5, 5, 5])
    assert impinge.intersects(repaired, inner, solid=True)
    assert not impinge.penetrates(repaired, CUBE, pose_b=impinge.pose([19, 0, 0]))
    assert not mesh.is_closed  # the original is unchanged
    assert len(repaired.repaired(orient=True)[1].turned_faces) == 0


def test_welding_at_the_closing_tolerance_closes_a_cracked_cube():
    soup = CORNERS[FACES].reshape(-1, 3)
    soup[np.random.default_rng(5).random(36) < 0.3] += 2.7e-16
    soup = soup + np.random.default_rng(6).uniform(-1e-9, 1e-9, soup.shape)
    cracked = impinge.Mesh(soup, np.arange(36).reshape(-1, 3))
    tolerance = cracked.closing_tolerance()
    assert tolerance is not None
    assert tolerance <= 1e-8
    repaired, repair = cracked.repaired(weld=tolerance, orient=True)
    assert repaired.is_closed
    assert 0 < repair.greatest_move <= tolerance
    assert np.array_equal(repaired.faces, cracked.faces)
    moved = np.flatnonzero((repaired.vertices != cracked.vertices).any(axis=1))
    assert moved.tolist() == repair.welded_vertices.tolist()
    assert CUBE.closing_tolerance() is None
    assert "28 vertices welded by at most" in repr(repair)


def test_invalid_options_raise_an_error():
    for weld, kind in ((-1.0, "negative"), (float("nan"), "non-finite"), (float("inf"), "non-finite"), ("1", "type")):
        with pytest.raises(impinge.InputError) as error:
            CUBE.repaired(weld=weld)
        assert (error.value.kind, error.value.what) == (kind, "weld")
    with pytest.raises(impinge.InputError):
        CUBE.repaired(orient=1)
