"""Answers against the corpus of known cases, and against rational arithmetic."""

import tomllib
from pathlib import Path

import impinge
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import oracle_pairs
from shapes import cube, torus

CASES = Path(__file__).resolve().parents[2] / "cases"
CORNERS = {"cuboid", "tetrahedron"}


def _generated(generator):
    ((name, numbers),) = generator.items()
    if name == "tetrahedron":
        return np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    vertices, faces = cube(0, 1)
    return np.where(vertices > 0, numbers["high"], numbers["low"]).astype(float), faces


def _read():
    """Yields cases with inline meshes, and with generated ones if face numbers do not matter."""
    for path in sorted(CASES.glob("*.toml")):
        with path.open("rb") as file:
            corpus = tomllib.load(file)
        for case in corpus.get("case", []):
            entries = [corpus["mesh"][case[side]] for side in "ab"]
            plain = all("vertices" in e or e["generator"].keys() <= CORNERS for e in entries)
            inline = all("vertices" in e for e in entries)
            if plain and (inline or "intersects" in case or case.get("pair_count") == 0):
                yield pytest.param(case, entries, id=case["id"])


def _mesh(entry):
    vertices, faces = (entry["vertices"], entry["faces"]) if "vertices" in entry else _generated(entry["generator"])
    dtype = np.float32 if entry.get("precision") == "f32" else np.float64
    vertices = np.array(vertices, float).reshape(-1, 3) * entry.get("scale", 1.0)
    return impinge.Mesh(vertices.astype(dtype), faces)


def _pose(entry):
    pose = np.eye(4)
    if entry is not None and np.ndim(entry) == 1:
        pose[:3, 3] = entry
    elif entry is not None:
        pose[:3] = entry
    return pose


ANSWERED = list(_read())


def test_most_cases_of_the_corpus_are_read():
    assert len(ANSWERED) >= 60


@pytest.mark.parametrize(("case", "entries"), ANSWERED)
def test_pairs_equal_the_known_answers_of_the_corpus(case, entries):
    a, b = map(_mesh, entries)
    poses = [_pose(case.get("pose_a")), _pose(case.get("pose_b"))]
    pairs = impinge.intersecting_pairs(a, b, *poses)
    if "intersects" in case:
        assert (len(pairs) > 0) == case["intersects"]
    if "pairs" in case:
        assert pairs.tolist() == case["pairs"]
    if "pair_count" in case:
        assert len(pairs) == case["pair_count"]
    assert impinge.intersects(a, b, *poses) == (len(pairs) > 0)
    swapped = impinge.intersecting_pairs(b, a, *poses[::-1])
    assert sorted(swapped[:, ::-1].tolist()) == pairs.tolist()


def _read_distances():
    """Yields distances of inline meshes and cuboids, whose vertices equal those of the corpus."""
    with (CASES / "distances.toml").open("rb") as file:
        corpus = tomllib.load(file)
    for case in corpus["distance"]:
        entries = [corpus["mesh"][case[side]] for side in "ab"]
        if all("vertices" in e or e["generator"].keys() <= CORNERS for e in entries):
            yield pytest.param(case, entries, id=case["id"])


DISTANCES = list(_read_distances())


def test_most_distances_of_the_corpus_are_read():
    assert len(DISTANCES) >= 18


@pytest.mark.parametrize(("case", "entries"), DISTANCES)
def test_distance_bounds_contain_the_known_distances(case, entries):
    a, b = map(_mesh, entries)
    poses = [_pose(case.get("pose_a")), _pose(case.get("pose_b"))]
    far, tolerance = impinge.distance(a, b, *poses), case.get("tolerance", 0)
    assert far.lower - tolerance <= case["distance"] <= far.upper + tolerance
    assert far.distance == far.upper
    swapped = impinge.distance(b, a, *poses[::-1])
    assert (swapped.lower, swapped.upper) == (far.lower, far.upper)
    assert impinge.within(a, b, far.upper, *poses)
    if far.lower > 0:
        assert not impinge.within(a, b, np.nextafter(far.lower, 0), *poses)
        assert not impinge.intersects(a, b, *poses)
    else:
        assert impinge.intersects(a, b, *poses)


corner = st.integers(-2, 2).map(lambda i: i / 2)
triangles = st.lists(st.tuples(*[corner] * 9), min_size=1, max_size=2)
entry = st.sampled_from([-1.0, -0.5, 0.0, 0.1, 0.5, 1.0, 2.0])


@settings(max_examples=25)
@given(a=triangles, b=triangles, linear=st.tuples(*[entry] * 9), translation=st.tuples(*[entry] * 3))
def test_pairs_of_small_meshes_equal_rational_arithmetic(a, b, linear, translation):
    meshes = [(np.array(m).reshape(-1, 3), np.arange(3 * len(m)).reshape(-1, 3)) for m in (a, b)]
    pose = np.eye(4)
    pose[:3, :3] = np.reshape(linear, (3, 3))
    pose[:3, 3] = translation
    built = [impinge.Mesh(*mesh) for mesh in meshes]
    for world_from_b in (None, pose):
        try:
            pairs = impinge.intersecting_pairs(*built, pose_b=world_from_b)
        except impinge.InputError as error:
            assert error.kind == "singular"
            assert abs(np.linalg.det(pose[:3, :3])) < 1e-12
            continue
        assert np.array_equal(pairs, oracle_pairs(*meshes, pose_b=world_from_b))


def test_the_oracle_distinguishes_touching_from_missing():
    here = (np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    for offset, meets in ((1.0, True), (np.nextafter(1.0, 2.0), False)):
        pose = impinge.pose([offset, 0, 0])
        assert (len(oracle_pairs(here, here, pose_b=pose)) > 0) == meets


def test_isolated_contact_points_are_curves_of_one_row():
    corner = [0.0146, 0.175, 0]
    a = impinge.Mesh([[8.0606e-03, 0.175, 8.0606e-03], corner, [0.0154, 0.175, 0.0154]], [[0, 1, 2]])
    b = impinge.Mesh([corner, [0.024625, 0.16399, 0], [0.0099918, 0.16476, 0]], [[0, 1, 2]])
    [point] = impinge.intersection_curves(a, b)
    assert point.tolist() == [corner]


def test_curves_are_closed_and_lie_on_both_surfaces():
    a, b = impinge.Mesh(*torus()), impinge.Mesh(*torus(44, 18))
    pose = impinge.pose([0.4, 0.05, 0.03], rpy=[1.5, 0.1, 0.2])
    curves = impinge.intersection_curves(a, b, pose_b=pose)
    assert len(curves) >= 2
    for curve in curves:
        assert curve.dtype == np.float64
        assert curve.shape[1] == 3
        assert np.array_equal(curve[0], curve[-1])
        local = (curve - pose[:3, 3]) @ pose[:3, :3]
        for points in (curve, local):  # facets deviate from a tube of radius 0.35
            tube = np.hypot(np.hypot(points[:, 0], points[:, 1]) - 1.0, points[:, 2])
            assert ((tube > 0.335) & (tube < 0.356)).all()
