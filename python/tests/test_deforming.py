"""Surfaces whose vertices move along lines: all contacts, and never late."""

from __future__ import annotations

import copy
import pickle

import impinge
import numpy as np
import pytest
from impinge.ccd import Deforming
from numpy.typing import NDArray

TRIANGLE = [[0, 1, 2]]
GROUND = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], float)


def random_surface(rng: np.random.Generator) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Return faces over a few vertices of a lattice, at both ends of a motion."""
    faces = rng.integers(0, 6, (4, 3))
    return faces, rng.integers(-4, 5, (6, 3)).astype(float), rng.integers(-4, 5, (6, 3)).astype(float)


def test_a_falling_vertex_touches_the_ground_at_the_known_time() -> None:
    t0, t1 = [[1, 1, 3], [1, 9, 9], [2, 9, 9]], [[1, 1, -1], [1, 9, 9], [2, 9, 9]]
    contacts = Deforming(TRIANGLE, t0, t1).contacts(Deforming(TRIANGLE, GROUND, GROUND))
    found = list(zip(contacts.kinds, contacts.features_a.tolist(), contacts.features_b.tolist(), strict=True))
    assert ("vertex-face", [0, -1], [0, -1]) in found
    assert contacts.first <= 0.75 <= contacts.t_upper[0]
    assert contacts.t_upper[0] - contacts.first < 1e-8
    swapped = Deforming(TRIANGLE, GROUND, GROUND).contacts(Deforming(TRIANGLE, t0, t1))
    assert "face-vertex" in swapped.kinds
    assert swapped.first == contacts.first


def test_contacts_are_those_of_all_pairs_of_features() -> None:
    rng = np.random.default_rng(3)
    counted = 0
    for _ in range(80):
        (faces_a, a0, a1), (faces_b, b0, b1) = random_surface(rng), random_surface(rng)
        contacts = Deforming(faces_a, a0, a1).contacts(Deforming(faces_b, b0, b1))
        found = {
            (int(vertex), int(face)): t
            for kind, (vertex, _), (face, _), t in zip(
                contacts.kinds, contacts.features_a, contacts.features_b, contacts.t_lower, strict=True
            )
            if kind == "vertex-face"
        }
        for vertex in np.unique(faces_a):
            for face, corners in enumerate(faces_b):
                at = [np.vstack([a[vertex], b[corners]]) for a, b in ((a0, b0), (a1, b1))]
                expected = impinge.ccd.vertex_face(*at)
                assert found.get((int(vertex), face), np.inf) == expected
                counted += expected < np.inf
    assert counted > 50


def test_no_contact_is_later_than_samples_of_the_motion_show() -> None:
    rng = np.random.default_rng(4)
    steps = np.linspace(0, 1, 65)
    hits = 0
    for _ in range(60):
        (faces_a, a0, a1), (faces_b, b0, b1) = random_surface(rng), random_surface(rng)
        at = [(impinge.Mesh(a0 + t * (a1 - a0), faces_a), impinge.Mesh(b0 + t * (b1 - b0), faces_b)) for t in steps]
        touching = [impinge.intersects(a, b) for a, b in at]
        if touching[0]:
            continue  # surfaces that intersect at the start need no feature to touch
        contacts = Deforming(faces_a, a0, a1).contacts(Deforming(faces_b, b0, b1))
        if any(touching):
            hits += 1
            assert contacts.first <= steps[touching.index(True)]
    assert hits > 5


def test_a_fold_touches_itself() -> None:
    faces = [[0, 1, 2], [3, 4, 5]]
    other = np.array([[1, 1, 1], [1, 9, 9], [2, 9, 9]], float)
    moved = other - [[0, 0, 2], [0, 0, 0], [0, 0, 0]]
    surface = Deforming(faces, np.vstack([GROUND, other]), np.vstack([GROUND, moved]))
    contacts = surface.self_contacts()
    assert contacts.first <= 0.5 <= contacts.t_upper.min()
    assert len(Deforming(faces, np.vstack([GROUND, other]), np.vstack([GROUND, other])).self_contacts()) == 0


def test_a_surface_keeps_its_arrays() -> None:
    t1 = GROUND + 1
    surface = Deforming(TRIANGLE, GROUND, t1)
    expected = surface.contacts(surface).t_lower.tolist()
    t1[:] = 99
    for same in (surface, copy.copy(surface), copy.deepcopy(surface), pickle.loads(pickle.dumps(surface))):
        assert same.contacts(same).t_lower.tolist() == expected
    assert repr(surface) == "Deforming(3 vertices, 1 faces)"


@pytest.mark.parametrize(
    ("faces", "t0", "t1", "kind", "what"),
    [
        (TRIANGLE, GROUND[:2], GROUND, "shape", "t1"),
        ([[0, 1, 3]], GROUND, GROUND, "index-out-of-bounds", "faces"),
        (TRIANGLE, GROUND * np.nan, GROUND, "non-finite", "t0"),
        (TRIANGLE, GROUND, GROUND + 1e300, "out-of-range", "t1"),
        (TRIANGLE, GROUND[0], GROUND, "shape", "t0"),
    ],
)
def test_invalid_arrays_are_refused(
    faces: list[list[int]], t0: NDArray[np.float64], t1: NDArray[np.float64], kind: str, what: str
) -> None:
    with pytest.raises(impinge.InputError) as caught:
        Deforming(faces, t0, t1)
    assert (caught.value.kind, caught.value.what) == (kind, what)


def test_other_things_are_refused() -> None:
    with pytest.raises(impinge.InputError, match=r"impinge\.ccd\.Deforming"):
        Deforming(TRIANGLE, GROUND, GROUND).contacts(impinge.Mesh(GROUND, TRIANGLE))  # type: ignore[arg-type]
