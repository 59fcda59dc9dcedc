"""Times of impact: meshes against sampled motions, single features against closed forms."""

import impinge
import numpy as np
import pytest
from shapes import TRIANGLE, cube, random_poses, torus

CUBE, TORUS = impinge.Mesh(*cube()), impinge.Mesh(*torus())
FLAT = impinge.Mesh(*TRIANGLE)


def test_sampled_poses_are_apart_before_the_time_and_touch_after_it():
    starts, ends = random_poses(40, 3.0, 1), random_poses(40, 3.0, 2)
    motion = impinge.Motion(starts, ends)
    impact = impinge.time_of_impact(TORUS, CUBE, motion_b=motion)
    assert 10 < impact.hit.sum() < 40
    assert np.array_equal(impact.hit, np.isfinite(impact.t_lower))
    assert np.isfinite(impact.t_upper[impact.hit]).mean() > 0.8
    for t in np.linspace(0, 1, 101):
        meets = impinge.intersects(TORUS, CUBE, pose_b=motion.at(t))
        assert not meets[t < impact.t_lower].any()
    for row in np.flatnonzero(np.isfinite(impact.t_upper)):
        assert impact.t_lower[row] <= impact.t_upper[row]
        assert impinge.intersects(TORUS, CUBE, pose_b=motion.at(impact.t_upper[row])[row])


def test_contact_of_a_fast_body_is_found():
    through = impinge.Motion(impinge.pose([0, 0, 1000]), impinge.pose([0, 0, -1000]))
    impact = impinge.time_of_impact(FLAT, FLAT, motion_b=through)
    assert isinstance(impact.hit, bool)
    assert impact.hit
    assert 0.5 - 1e-9 < impact.t_lower <= 0.5


def test_bodies_glide_past_each_other_and_the_touch_has_its_place():
    floor, ball = impinge.Shape.half_space([0, 0, 1]), impinge.Shape.sphere(0.5)
    glide = impinge.Motion(impinge.pose([0, 0, 0.501]), impinge.pose([[20, 0, 0.501], [20, 0, 0.499]]))
    impact = impinge.time_of_impact(ball, floor, glide)
    assert impact.hit.tolist() == [False, True]
    assert np.isnan(impact.point[0]).all()
    assert np.allclose(impact.point[1], [10, 0, 0], atol=1e-6)
    assert impact.normal[1].tolist() == [0, 0, -1]
    assert impact.parts.tolist() == [[-1, -1], [0, 0]]
    assert impact.faces.tolist() == [[-1, -1], [-1, -1]]
    fall = impinge.Motion(impinge.pose([0, 0, 3]), impinge.pose([0, 0, -1]))
    assert impinge.time_of_impact(FLAT, FLAT, motion_b=fall).faces.tolist() == [0, 0]
    near = impinge.time_of_impact(ball, floor, impinge.Motion(impinge.pose([0, 0, 2.5]), None), clearance=0.5)
    assert abs(near.t_lower - 0.6) < 1e-9
    slide = impinge.Motion(impinge.pose([0, 0, 0.5]), impinge.pose([20, 0, 0.5]))
    assert impinge.time_of_impact(ball, floor, slide).t_upper == 0
    assert not impinge.time_of_impact(ball, floor, slide, ignore_touch=True).hit


def test_a_body_that_starts_inside_a_solid_touches_it_at_zero():
    inner = impinge.Mesh(cube()[0] * 0.1, cube()[1])
    assert not impinge.time_of_impact(CUBE, inner).hit
    assert impinge.time_of_impact(CUBE, inner, solid="a").t_upper == 0
    assert impinge.time_of_impact(CUBE, inner, solid=True).t_upper == 0
    assert not impinge.time_of_impact(CUBE, inner, solid="b").hit


def test_leading_axes_broadcast():
    ends = impinge.pose([[[0, 0, -1]], [[0, 0, 1]], [[0, 0, 3]]])
    up = impinge.Motion(impinge.pose([0, 0, 3]), ends)
    assert up.shape == [3, 1]
    aside = impinge.Motion.screw(None, [[0, 0, 0], [50, 0, 0]], [0, 0, 0])
    impact = impinge.time_of_impact(FLAT, FLAT, aside, up)
    assert impact.t_lower.shape == (3, 2)
    assert impact.hit.tolist() == [[True, False], [False, False], [False, False]]
    nothing = impinge.Motion(np.zeros((0, 4, 4)), None)
    assert impinge.time_of_impact(FLAT, FLAT, nothing).t_lower.shape == (0,)
    assert repr(up) == "Motion(shape=(3, 1))"
    assert repr(impinge.Motion(None, None)) == "Motion()"


def test_a_screw_turns_about_its_pivot_any_number_of_times():
    start = impinge.pose([3, 0, 0])
    whole = impinge.Motion.screw(start, [0, 0, 1], [0, 0, 4 * np.pi], pivot=[2, 0, 0])
    assert np.array_equal(whole.at(0), start)
    assert np.allclose(whole.at(1), impinge.pose([3, 0, 1]), atol=1e-12)
    assert np.allclose(whole.at(0.25)[:3, 3], [1, 0, 0.25], atol=1e-12)


@pytest.mark.parametrize(
    ("make", "kind", "what"),
    [
        (lambda: impinge.Motion(None, np.zeros((4, 4))), "not-affine", "pose_t1"),
        (lambda: impinge.Motion(np.zeros((2, 4, 4)) + np.eye(4), np.zeros((3, 4, 4)) + np.eye(4)), "shape", "pose_t1"),
        (lambda: impinge.Motion(None, np.diag([2.0, 1, 1, 1])), "not-rigid", "motion"),
        (lambda: impinge.Motion.screw(None, [0, 0, np.nan], [0, 0, 0]), "non-finite", "linear"),
        (lambda: impinge.Motion.screw(None, [0, 0, 0], [0, 0, 1e9]), "out-of-range", "motion"),
        (lambda: impinge.time_of_impact(FLAT, FLAT, np.eye(4)), "type", "motion_a"),
        (lambda: impinge.ccd.vertex_face(np.zeros((3, 3)), np.zeros((4, 3))), "shape", "t0"),
        (lambda: impinge.ccd.edge_edge(np.zeros((4, 3)), np.full((4, 3), np.inf)), "non-finite", "t1"),
    ],
)
def test_errors_name_the_invalid_argument(make, kind, what):
    with pytest.raises(impinge.InputError) as raised:
        make()
    assert raised.value.kind == kind
    assert raised.value.what == what


def test_feature_queries_accept_leading_axes():
    rng = np.random.default_rng(5)
    t0, t1 = rng.integers(-2, 3, (2, 5000, 4, 3)).astype(float)
    for find in (impinge.ccd.vertex_face, impinge.ccd.edge_edge):
        times = find(t0, t1)
        assert times.shape == (5000,)
        assert times.dtype == np.float64
        hits = np.isfinite(times)
        assert 0.02 < hits.mean() < 0.9
        assert ((times[hits] >= 0) & (times[hits] <= 1)).all()
        assert np.array_equal(find(t0[::-1], t1[::-1]), times[::-1])
        assert all(find(t0[row], t1[row]) == times[row] for row in range(0, 5000, 500))
    falling = np.array([[0.25, 0.25, 1.0], [0, 0, 0], [1, 0, 0], [0, 1, 0]])
    lower = falling - np.array([[[0, 0, h], [0, 0, 0], [0, 0, 0], [0, 0, 0]] for h in (0.5, 1, 2, 4)])
    times = impinge.ccd.vertex_face(falling, lower)
    assert times[0] == np.inf
    assert (times[1:] <= [1, 0.5, 0.25]).all()
    assert np.allclose(times[1:], [1, 0.5, 0.25], rtol=0, atol=1e-9)
