"""Distances and clearances against closed forms, brute force and loops."""

import impinge
import numpy as np
import pytest
from oracles import mesh_distance
from shapes import cube, random_poses, torus

CUBE, TORUS = impinge.Mesh(*cube()), impinge.Mesh(*torus())


def test_distances_of_boxes_equal_the_closed_form():
    offsets = np.array([[3, 0, 0], [0, -4, 0], [4, 5, 0], [2, 3, 3], [1, 0, 0], [0.5, 0.5, 0.5]])
    gaps = np.maximum(np.abs(offsets) - 1, 0)
    far = impinge.distance(CUBE, CUBE, pose_b=impinge.pose(offsets))
    expected = np.linalg.norm(gaps, axis=1)
    assert np.allclose(far.distance, expected, rtol=0, atol=1e-12)
    assert (far.lower <= expected + 1e-15).all()
    assert (far.upper - far.lower < 1e-12).all()
    assert np.array_equal(far.distance, far.upper)
    assert (far.distance == 0).tolist() == [False] * 4 + [True] * 2
    between = np.linalg.norm(far.point_a - far.point_b, axis=1)
    assert np.allclose(between, expected, rtol=0, atol=1e-12)


def test_a_call_equals_a_loop():
    poses = random_poses(40, 3.0, 2)
    far = impinge.distance(TORUS, CUBE, poses)
    hits = impinge.intersects(TORUS, CUBE, poses)
    assert 0.05 < hits.mean() < 0.9
    assert np.array_equal(far.distance == 0, hits)
    for i, pose in enumerate(poses):
        alone = impinge.distance(TORUS, CUBE, pose)
        assert isinstance(alone.distance, float)
        assert isinstance(alone.face_a, int)
        for field in ("distance", "lower", "upper", "point_a", "point_b", "face_a", "face_b"):
            assert np.array_equal(getattr(far, field)[i], getattr(alone, field))
    for clearance in (0, 0.3, 1.0, np.inf):
        near = impinge.within(TORUS, CUBE, clearance, poses)
        assert near[far.upper <= clearance].all()
        assert not near[far.lower > clearance].any()
        assert near.tolist() == [impinge.within(TORUS, CUBE, clearance, pose) for pose in poses]


def test_distances_equal_brute_force():
    poses = random_poses(25, 3.0, 6)
    small = torus(9, 6)
    far = impinge.distance(impinge.Mesh(*small), CUBE, poses)
    for i, pose in enumerate(poses):
        placed = (small[0] @ pose[:3, :3].T + pose[:3, 3], small[1])
        if far.distance[i] > 0:
            assert abs(far.distance[i] - mesh_distance(placed, cube())) < 1e-12
    assert 5 < (far.distance > 0).sum() < 25


def test_the_order_of_poses_does_not_change_distances():
    """Each search starts from the faces of the last one; this changes neither answers nor ties."""
    steps = np.linspace(0, 1, 300)[:, None]
    motion = impinge.pose(steps * [4.0, 0.5, 0], rpy=steps * [0.0, 0.2, 3.0])
    motion[:100, :3, :3] = np.eye(3)  # parallel faces are equally near: ties
    order = np.random.default_rng(4).permutation(len(motion))
    for mesh in (CUBE, TORUS):
        along, shuffled = impinge.distance(CUBE, mesh, None, motion), impinge.distance(CUBE, mesh, None, motion[order])
        for field in ("distance", "lower", "point_a", "point_b", "face_a", "face_b"):
            assert np.array_equal(getattr(along, field)[order], getattr(shuffled, field))
        for clearance in (0.0, 0.5):
            near = impinge.within(CUBE, mesh, clearance, None, motion)
            assert 0.05 < near.mean() < 0.95
            assert np.array_equal(near[order], impinge.within(CUBE, mesh, clearance, None, motion[order]))


def test_clearances_are_decided_exactly():
    above = impinge.pose([0, 0, 1.1])
    gap = float(np.float64(1.1) - 1)  # exact: the faces are at 0.5 and at 1.1 - 0.5
    assert impinge.within(CUBE, CUBE, gap, pose_b=above)
    assert not impinge.within(CUBE, CUBE, np.nextafter(gap, 0), pose_b=above)


def test_empty_meshes_are_infinitely_far_and_invalid_poses_have_a_status():
    empty = impinge.Mesh([], [])
    far = impinge.distance(CUBE, empty)
    assert (far.distance, far.lower, far.face_a, far.face_b) == (np.inf, np.inf, -1, -1)
    assert not impinge.within(CUBE, empty, np.inf)
    poses = impinge.pose([[9, 0, 0]] * 2)
    poses[1, 0, 0] = np.nan
    far, status = impinge.distance(CUBE, CUBE, poses, on_error="status")
    assert far.distance[1] == far.lower[1] == 0
    assert status.tolist() == [0, 1]
    near, status = impinge.within(CUBE, CUBE, 0.5, poses, on_error="status")
    assert (near.tolist(), status.tolist()) == ([False, True], [0, 1])
    for wrong in (-1, np.nan, True, "1", None, 10**400, [0.5], np.array([0.5])):
        with pytest.raises(impinge.InputError, match="clearance"):
            impinge.within(CUBE, CUBE, wrong)


@pytest.mark.parametrize("exponent", [-300, -535, -540, -600, -880, -960, -1040, -1070])
def test_distances_of_tiny_meshes_are_accurate(exponent):
    size = 2.0**exponent
    triangle = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    unit, tiny = impinge.Mesh(triangle, [[0, 1, 2]]), impinge.Mesh(triangle * size, [[0, 1, 2]])
    shrunk, away = np.diag([size, size, size, 1.0]), np.diag([size, size, size, 1.0])
    away[2, 3] = 3 * size
    for found in (
        impinge.distance(unit, unit, shrunk, away),
        impinge.distance(tiny, tiny, None, impinge.pose([0, 0, 3 * size])),
    ):
        assert found.lower <= 3 * size <= found.upper
        assert exponent < -880 or found.upper - found.lower <= 1e-12 * size
    for closer in (2.0, 2.9, 3.0, 3.5):
        assert impinge.within(unit, unit, closer * size, shrunk, away) is (closer >= 3 or closer * size == 3 * size)
    motion = impinge.Motion(impinge.pose([0, 0, 3 * size]), impinge.pose([0, 0, -size]))
    if exponent >= -1000:
        impact = impinge.time_of_impact(tiny, tiny, None, motion)
        assert impact.hit
        assert impact.t_lower <= 0.75 <= impact.t_upper
