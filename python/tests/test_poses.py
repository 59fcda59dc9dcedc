"""Poses: broadcasting, errors, and the matrices that `impinge.pose` makes."""

import impinge
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapes import TRIANGLE, cube, random_poses

MESH = impinge.Mesh(*TRIANGLE)
CUBE = impinge.Mesh(*cube())


@given(shapes=st.tuples(*[st.lists(st.integers(0, 3), max_size=3).map(tuple)] * 2))
def test_leading_axes_broadcast_as_in_numpy(shapes):
    poses = [random_poses(int(np.prod(shape)), 1.2, seed).reshape(*shape, 4, 4) for seed, shape in enumerate(shapes)]
    try:
        lead = np.broadcast_shapes(*shapes)
    except ValueError:
        with pytest.raises(impinge.InputError) as caught:
            impinge.intersects(CUBE, CUBE, *poses)
        assert (caught.value.kind, caught.value.what) == ("shape", "pose_b")
        return
    hits = impinge.intersects(CUBE, CUBE, *poses)
    pairs = impinge.intersecting_pairs(CUBE, CUBE, *poses)
    curves = impinge.intersection_curves(CUBE, CUBE, *poses)
    a, b = (np.broadcast_to(p, (*lead, 4, 4)) for p in poses)
    if lead == ():
        assert isinstance(hits, bool)
        assert isinstance(pairs, np.ndarray)
    else:
        assert hits.shape == pairs.counts.shape == lead
        assert len(pairs) == lead[0] == len(pairs.split())
    for at in np.ndindex(lead):
        alone = impinge.intersecting_pairs(CUBE, CUBE, a[at], b[at])
        assert np.array_equal(pairs[at] if lead else pairs, alone)
        assert (hits[at] if lead else hits) == impinge.intersects(CUBE, CUBE, a[at], b[at]) == (len(alone) > 0)
        lines = curves
        for i in at:
            lines = lines[i]
        expected = impinge.intersection_curves(CUBE, CUBE, a[at], b[at])
        assert len(lines) == len(expected)
        assert all(map(np.array_equal, lines, expected))


def test_results_have_the_broadcast_shape_of_the_poses():
    n, m = random_poses(3, 1, 0), random_poses(4, 1, 1)
    assert impinge.intersects(CUBE, CUBE, n, n[0]).shape == (3,)
    assert impinge.intersects(CUBE, CUBE, n, n[::-1]).shape == (3,)
    assert impinge.intersects(CUBE, CUBE, n[:, None], m).shape == (3, 4)
    assert impinge.intersects(CUBE, CUBE, n[:0]).shape == (0,)
    assert impinge.intersecting_pairs(CUBE, CUBE, n[:0]).offsets.tolist() == [0]
    assert impinge.intersection_curves(CUBE, CUBE, n[:0]) == []


def test_pairs_have_both_leading_axes():
    n, m = random_poses(3, 0.8, 0), random_poses(4, 0.8, 1)
    pairs = impinge.intersecting_pairs(CUBE, CUBE, n[:, None], m)
    assert pairs.shape == (3, 4)
    assert np.array_equal(pairs[1].counts, pairs.counts[1])
    assert np.array_equal(pairs[1][2], pairs[1, 2])
    assert np.array_equal(pairs[-1, -1], pairs[2, 3])
    assert np.shares_memory(pairs[1, 2], pairs.rows)
    assert [part.shape for part in pairs] == [(4,)] * 3
    assert sum(len(row) for part in pairs.split() for row in part.split()) == len(pairs.rows) > 0
    for wrong in (3, (0, 4), (0, 0, 0), -4):
        with pytest.raises(IndexError):
            pairs[wrong]


def bad_pose(entry, value):
    pose = np.eye(4)
    pose[entry] = value
    return pose


WRONG = [
    ("non-finite", (0, 3), 1, bad_pose((0, 3), np.nan)),
    ("non-finite", (3, 0), 1, bad_pose((3, 0), np.inf)),
    ("out-of-range", (1, 1), 2, bad_pose((1, 1), 2.0**65)),
    ("out-of-range", (2, 3), 2, bad_pose((2, 3), 2.0**301)),
    ("not-affine", (3,), 3, bad_pose((3, 3), 2)),
    ("singular", (), 4, bad_pose((2, 2), 0)),
]


@pytest.mark.parametrize(("kind", "where", "status", "pose"), WRONG)
def test_an_invalid_pose_raises_or_gets_the_safe_answer(kind, where, status, pose):
    poses = np.stack([np.eye(4)] * 6).reshape(2, 3, 4, 4)
    poses[..., 0, 3] = 5  # apart
    poses[1, 2] = pose
    for side, what in ((0, "pose_a"), (1, "pose_b")):
        given_poses = [None, None]
        given_poses[side] = poses
        with pytest.raises(impinge.InputError) as caught:
            impinge.intersects(MESH, MESH, *given_poses)
        assert (caught.value.kind, caught.value.what, caught.value.where) == (kind, what, (1, 2, *where))
        hits, statuses = impinge.intersects(MESH, MESH, *given_poses, on_error="status")
        assert hits.tolist() == [[False] * 3, [False, False, True]]
        assert statuses.tolist() == [[0] * 3, [0, 0, status]]
        assert statuses.dtype == np.uint8
        assert impinge.Status(status).name == kind.upper().replace("-", "_")
        pairs, statuses = impinge.intersecting_pairs(MESH, MESH, *given_poses, on_error="status")
        assert (pairs.counts.sum(), statuses[1, 2]) == (0, status)
        curves, statuses = impinge.intersection_curves(MESH, MESH, *given_poses, on_error="status")
        assert (curves, statuses[1, 2]) == ([[[]] * 3] * 2, status)
        given_poses[side] = pose
        hit, statuses = impinge.intersects(MESH, MESH, *given_poses, on_error="status")
        assert hit is True
        assert statuses == status


def test_a_transposed_matrix_gets_a_hint():
    with pytest.raises(impinge.InputError, match="looks transposed") as caught:
        impinge.intersects(MESH, MESH, impinge.pose([1, 2, 3]).T)
    assert caught.value.hint == "looks transposed"


@pytest.mark.parametrize(
    "wrong", [np.eye(3), np.eye(4)[0], np.zeros((4, 4, 3)), "pose", 1.0, np.eye(4, dtype=int), [[1]]]
)
def test_arguments_that_are_not_poses_raise_an_error(wrong):
    with pytest.raises(impinge.InputError) as caught:
        impinge.intersects(MESH, MESH, wrong)
    assert caught.value.what == "pose_a"


def test_invalid_options_raise_an_error():
    with pytest.raises(impinge.InputError, match="on_error"):
        impinge.intersects(MESH, MESH, on_error="ignore")
    for limit in (-1, 1.5, True, "1"):
        with pytest.raises(impinge.InputError, match="limit"):
            impinge.intersecting_pairs(MESH, MESH, limit=limit)
    pairs = impinge.intersecting_pairs(CUBE, CUBE)
    for limit in (0, 1, np.int64(7), 10**6):
        some = impinge.intersecting_pairs(CUBE, CUBE, limit=limit)
        assert np.array_equal(some.pairs, pairs[:limit])
        assert some.truncated == (len(pairs) > limit)
    rows, truncated = impinge.intersecting_pairs(CUBE, CUBE, impinge.pose([[0, 0, 0], [9, 0, 0]]), limit=3)
    assert (rows.counts.tolist(), truncated.tolist()) == ([3, 0], [True, False])
    for n in (0, 1025, 1.0, True, None):
        with pytest.raises(impinge.InputError, match="n:"), impinge.threads(n):
            pass


def test_pose_makes_the_matrices_of_rotations():
    quarter = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
    half = np.sqrt(0.5)
    made = [
        impinge.pose([1, 2, 3], quat_wxyz=[half, 0, 0, half]),
        impinge.pose([1, 2, 3], quat_xyzw=[0, 0, half, half]),
        impinge.pose([1, 2, 3], rotation=np.array(quarter)[:3, :3]),
        impinge.pose([1, 2, 3], rpy=[0, 0, np.pi / 2]),
    ]
    for exact in made[:3]:
        assert np.array_equal(exact, quarter)
    assert np.allclose(made[3], quarter, atol=1e-15)
    roll, pitch, yaw = (impinge.pose(rpy=turn)[:3, :3] for turn in np.diag([0.3, -0.7, 1.9]))
    assert np.allclose(impinge.pose(rpy=[0.3, -0.7, 1.9])[:3, :3], yaw @ pitch @ roll, atol=1e-15)
    assert impinge.pose(np.zeros((5, 1, 3)), rpy=np.zeros((2, 3))).shape == (5, 2, 4, 4)


@pytest.mark.parametrize(
    ("kind", "given"),
    [
        ("not-unit-quaternion", {"quat_wxyz": [[1, 0, 0, 0], [1, 1, 0, 0]]}),
        ("not-unit-quaternion", {"quat_xyzw": [0, 0, 0, 0]}),
        ("non-finite", {"rpy": [0, np.nan, 0]}),
        ("shape", {"rotation": np.eye(4)}),
        ("shape", {"t": [1, 2]}),
        ("shape", {"t": np.zeros((2, 3)), "rpy": np.zeros((3, 3))}),
        ("type", {"t": "here"}),
        ("option", {"rpy": [0, 0, 0], "rotation": np.eye(3)}),
    ],
)
def test_invalid_rotations_raise_an_error(kind, given):
    with pytest.raises(impinge.InputError) as caught:
        impinge.pose(**given)
    assert caught.value.kind == kind
