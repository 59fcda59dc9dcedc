"""Depth of common material, and whether it exceeds a threshold."""

import impinge
import numpy as np
import pytest
from impinge import pose
from shapes import cube

UNIT = impinge.Mesh(*cube())


def test_boxes_on_the_grid_have_the_depth_of_integers():
    steps = np.arange(-5, 6) / 4
    moved = pose(np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1))
    found, status = impinge.depth(UNIT, UNIT, None, moved, on_error="status")
    assert found.lower.shape == found.upper.shape == (11, 11, 11)
    assert not status.any()
    # A common point is farthest from a surface in the middle of the cube, or at an end of the
    # overlap.
    overlap = 1 - np.abs(moved[..., :3, 3])
    expected = np.where((overlap > 0).all(-1), np.minimum(0.5, overlap.min(-1)), 0)
    assert (found.lower <= expected).all()
    assert (expected <= found.upper).all()
    assert (found.upper - found.lower <= expected / 1000 + 1e-9).all()
    inside = np.abs(found.point) <= 0.5
    assert inside[found.lower > 0].all()
    assert not found.point[found.lower == 0].any()
    for threshold in (0.0, 0.125, 0.3):
        deeper, status = impinge.deeper(UNIT, UNIT, threshold, None, moved, on_error="status")
        assert deeper.tolist() == (expected > threshold).tolist()
        assert not status.any()
        assert 20 < deeper.sum() < deeper.size - 20


def test_a_single_answer_is_plain():
    found = impinge.depth(UNIT, UNIT, None, pose([0.75, 0, 0]))
    assert (type(found.lower), type(found.upper), found.point.shape) == (float, float, (3,))
    assert impinge.deeper(UNIT, UNIT, 0.2, None, pose([0.75, 0, 0])) is True
    assert impinge.deeper(UNIT, UNIT, 0.25, None, pose([0.75, 0, 0])) in (True, False)
    assert impinge.deeper(UNIT, UNIT, 0.3, None, pose([0.75, 0, 0])) is False
    assert impinge.deeper(UNIT, UNIT, np.inf) is False


def test_rows_with_invalid_poses_have_the_safe_answer():
    poses = np.stack([np.eye(4), np.full((4, 4), np.nan), pose([9, 0, 0])])
    found, status = impinge.depth(UNIT, UNIT, poses, on_error="status")
    assert status.tolist() == [0, impinge.Status.NON_FINITE, 0]
    assert (found.lower[1], found.upper[1], found.upper[2]) == (0, np.inf, 0)
    deeper, status = impinge.deeper(UNIT, UNIT, 0.1, poses, on_error="status")
    assert deeper.tolist() == [True, True, False]
    assert status.tolist() == [0, impinge.Status.NON_FINITE, 0]
    with pytest.raises(impinge.InputError, match="pose_a"):
        impinge.depth(UNIT, UNIT, poses)


def test_an_open_mesh_is_not_proved():
    vertices, faces = cube()
    opened = impinge.Mesh(vertices, faces[1:])
    _, status = impinge.depth(opened, UNIT, None, pose([[0.75, 0, 0]]), on_error="status")
    assert status.tolist() == [impinge.Status.UNDECIDED]


def test_shapes_have_depths_too():
    ball = impinge.Shape.sphere(1)
    found = impinge.depth(ball, ball, None, pose([1.5, 0, 0]))
    assert 0 < found.lower <= found.upper <= 0.5 + 1e-9
    assert impinge.deeper(ball, ball, 0.6, None, pose([1.5, 0, 0])) is False


@pytest.mark.parametrize(("threshold", "kind"), [(-1, "negative"), (np.nan, "non-finite"), ("1", "type")])
def test_invalid_thresholds_are_named(threshold, kind):
    with pytest.raises(impinge.InputError) as caught:
        impinge.deeper(UNIT, UNIT, threshold)
    assert (caught.value.kind, caught.value.what) == (kind, "threshold")
