"""Solids: boxes on a grid, intersecting interiors, and self-intersecting meshes."""

import impinge
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import oracle_pairs
from shapes import cube, random_poses, torus

UNIT = impinge.Mesh(*cube())
grid = st.tuples(*[st.integers(-3, 3)] * 3)
sides = st.tuples(*[st.sampled_from([1, 2, 4, 6])] * 3)


def box(size):
    vertices, faces = cube()
    return impinge.Mesh(vertices * size, faces)


@settings(max_examples=60)
@given(size_a=sides, size_b=sides, offsets=st.lists(grid, min_size=8, max_size=8))
def test_boxes_on_a_grid_equal_interval_arithmetic(size_a, size_b, offsets):
    size_a, size_b, offsets = np.array(size_a), np.array(size_b), np.array(offsets, float)
    gap = np.abs(offsets) - (size_a + size_b) / 2
    touch, overlap = (gap <= 0).all(axis=1), (gap < 0).all(axis=1)
    a_in_b = (np.abs(offsets) + size_a / 2 < size_b / 2).all(axis=1)
    b_in_a = (np.abs(offsets) + size_b / 2 < size_a / 2).all(axis=1)
    apart = np.linalg.norm(np.maximum(gap, 0), axis=1)
    a, b, poses = box(size_a), box(size_b), impinge.pose(offsets)
    for solid, expected in (
        (False, touch & ~a_in_b & ~b_in_a),
        (True, touch),
        ("a", touch & ~a_in_b),
        ("b", touch & ~b_in_a),
    ):
        assert impinge.intersects(a, b, None, poses, solid=solid).tolist() == expected.tolist()
        far = impinge.distance(a, b, None, poses, solid=solid)
        assert ((far.distance == 0) == expected).all()
        assert np.allclose(far.distance[~touch], apart[~touch], rtol=0, atol=1e-12)
        for clearance in (0.0, 1.0, 5.0):  # integer distances, such as 5 from (3, 4), are exact
            near = impinge.within(a, b, clearance, None, poses, solid=solid)
            squared = (np.maximum(gap, 0) ** 2).sum(axis=1)
            assert near[~touch].tolist() == (squared <= clearance**2)[~touch].tolist()
            assert near[expected].all()
    assert impinge.penetrates(a, b, None, poses).tolist() == overlap.tolist()


def test_the_grid_contains_separate_touching_and_overlapping_boxes():
    """The grid must contain all cases, or the test above is void."""
    offsets = np.stack(np.meshgrid(*[np.arange(-3, 4)] * 3), axis=-1).reshape(-1, 3)
    gap = np.abs(offsets) - (2 + 4) / 2
    kinds = [(gap > 0).any(axis=1), (gap <= 0).all(axis=1) & (gap == 0).any(axis=1), (gap < 0).all(axis=1)]
    counts = [int(kind.sum()) for kind in kinds]
    assert sum(counts) == 343
    assert counts[1] > 100
    assert counts[2] > 100
    assert impinge.intersects(box((1, 1, 1)), box((6, 6, 6)), solid="b")


def test_a_body_inside_a_solid_has_distance_zero_and_no_faces():
    far = impinge.distance(UNIT, box((4, 4, 4)), solid=True)
    assert (far.distance, far.lower, far.face_a, far.face_b) == (0, 0, -1, -1)
    assert not far.point_a.any()
    surfaces = impinge.distance(UNIT, box((4, 4, 4)))
    assert surfaces.distance == pytest.approx(1.5)


def test_undecided_penetration_has_a_status():
    vertices, faces = cube()
    opened = impinge.Mesh(vertices, faces[:-2])
    assert (UNIT.is_closed, opened.is_closed) == (True, False)
    assert impinge.penetrates(opened, opened) is True
    # Moved across, walls far from the hole touch and decide. Moved towards the hole, no wall does.
    poses = impinge.pose([[0.25, 0, 0], [0, 0, 0.25], [50, 0, 0], [0, 0, 0]])
    poses[3, 0, 0] = np.nan
    answer, status = impinge.penetrates(opened, UNIT, poses, on_error="status")
    assert answer.tolist() == [True, True, False, True]
    statuses = impinge.Status
    assert status.tolist() == [statuses.OK, statuses.UNDECIDED, statuses.OK, statuses.NON_FINITE]
    closed, sure = impinge.penetrates(UNIT, UNIT, poses[:3], on_error="status")
    assert (closed.tolist(), sure.tolist()) == ([True, True, False], [0, 0, 0])


def test_swapping_the_meshes_does_not_change_the_answer():
    a, b = impinge.Mesh(*torus()), UNIT
    poses = random_poses(150, 1.2, 4)
    assert 0.2 < impinge.intersects(a, b, poses).mean() < 0.95
    for solid, swapped in ((False, False), (True, True), ("a", "b"), ("b", "a")):
        assert np.array_equal(
            impinge.intersects(a, b, poses, solid=solid), impinge.intersects(b, a, None, poses, solid=swapped)
        )
    assert np.array_equal(impinge.penetrates(a, b, poses), impinge.penetrates(b, a, None, poses))
    deep = impinge.penetrates(a, b, poses)
    assert (deep <= impinge.intersects(a, b, poses, solid=True)).all()


@pytest.mark.parametrize("solid", ["c", "both", 2, None, [True], "A"])
def test_invalid_values_of_solid_raise_an_error(solid):
    for ask in (impinge.intersects, impinge.distance):
        with pytest.raises(impinge.InputError) as caught:
            ask(UNIT, UNIT, solid=solid)
        assert (caught.value.kind, caught.value.what) == ("option", "solid")
    with pytest.raises(impinge.InputError, match="solid"):
        impinge.within(UNIT, UNIT, 1, solid=solid)
    assert impinge.intersects(UNIT, UNIT, solid=np.True_)


def test_self_intersections_of_a_soup_equal_the_oracle():
    rng = np.random.default_rng(8)
    corners = rng.integers(-2, 3, (18, 3, 3)).astype(float)
    own = [set(map(tuple, triangle)) for triangle in corners]
    alone = [(triangle, np.array([[0, 1, 2]])) for triangle in corners]
    strangers = [(i, j) for i in range(18) for j in range(i) if not own[i] & own[j]]
    expected = sorted((j, i) for i, j in strangers if len(oracle_pairs(alone[i], alone[j])))
    soup = impinge.Mesh(corners.reshape(-1, 3), np.arange(54).reshape(-1, 3))
    found = [tuple(pair) for pair in impinge.self_intersecting_pairs(soup).tolist()]
    assert [pair for pair in found if not own[pair[0]] & own[pair[1]]] == expected
    assert 20 < len(expected) < len(strangers) - 20
    assert found == sorted(set(found))


def test_two_shells_in_one_mesh_intersect_like_two_meshes():
    vertices, faces = torus()
    shell = impinge.Mesh(vertices, faces)
    assert impinge.self_intersecting_pairs(shell).shape == (0, 2)
    moved = vertices + np.array([0.5, 0.1, 0.05])
    both = impinge.Mesh(np.concatenate([vertices, moved]), np.concatenate([faces, faces + len(vertices)]))
    expected = impinge.intersecting_pairs(shell, impinge.Mesh(moved, faces)) + np.array([0, len(faces)], np.uint32)
    assert len(expected) > 100
    assert np.array_equal(impinge.self_intersecting_pairs(both), expected)
    with pytest.raises(impinge.InputError, match="mesh"):
        impinge.self_intersecting_pairs(vertices)


def test_moving_by_the_depth_separates_the_solids():
    ring, box = impinge.Mesh(*torus()), impinge.Mesh(*cube())
    poses = random_poses(12, 1.5, 2)
    deep = impinge.penetration(ring, box, None, poses)
    assert 3 < deep.hit.sum() < 12
    assert np.array_equal(deep.hit, impinge.intersects(ring, box, None, poses, solid=True))
    assert (deep.lower <= deep.upper).all()
    moved = poses.copy()
    moved[:, :3, 3] += deep.normal * (deep.upper * (1 + 1e-9))[:, None]
    assert not impinge.penetrates(ring, box, None, moved).any()
    # A translation shorter than the lower bound does not separate them, in any direction.
    for direction in (deep.normal, -deep.normal, [1, 0, 0], [0, 0.6, -0.8]):
        moved = poses.copy()
        moved[:, :3, 3] += direction * (0.999 * deep.lower)[:, None]
        assert impinge.penetrates(ring, box, None, moved)[deep.lower > 0].all()
    unit = impinge.Mesh(*cube())
    low, high = unit.vertices.min(), unit.vertices.max()
    near = impinge.penetration(unit, unit, None, impinge.pose([0.75 * (high - low), 0, 0]))
    assert near.lower <= 0.25 * (high - low) <= near.upper <= 0.2501 * (high - low)
    assert np.allclose(near.normal, [1, 0, 0], atol=1e-3)
    poses[3] = np.nan
    deep, status = impinge.penetration(ring, box, None, poses, on_error="status")
    assert (deep.lower[3], deep.upper[3], int(status[3])) == (0, np.inf, impinge.Status.NON_FINITE)
    ball = impinge.Shape.sphere(0.25)
    middle = np.linalg.norm(ring.vertices, axis=1).mean()
    deep, solid = (
        impinge.penetration(one, ball, None, impinge.pose([middle, 0, 0]))
        for one in (ring, impinge.Shape.mesh(ring, solid=True))
    )
    assert deep.hit is True
    assert (deep.lower, deep.upper) == (solid.lower, solid.upper)
    assert impinge.penetrates(ring, ball, None, impinge.pose([middle, 0, 0])) is True
    with pytest.raises(impinge.InputError, match="Mesh"):
        impinge.penetration(ring, cube())


def cup():
    """Returns a cube without its upper side; on that side winding numbers are exactly 1/2."""
    vertices, faces = cube()
    vertices = np.asarray(vertices, float)
    top = vertices[:, 2].max()
    return vertices, np.array([face for face in faces if not all(vertices[v][2] == top for v in face)])


def test_points_in_the_hole_of_an_open_solid_are_undecided():
    vertices, faces = cup()
    open_cube, lid = impinge.Mesh(vertices, faces), vertices[:, 2].max()
    point = impinge.Mesh([[0.0, 0, lid]] * 3, [[0, 1, 2]])
    for ask in (
        lambda: impinge.intersects(open_cube, point, solid="a", on_error="status"),
        lambda: impinge.within(open_cube, point, 0.01, solid="a", on_error="status"),
    ):
        answer, status = ask()
        assert (answer, impinge.Status(int(status))) == (True, impinge.Status.UNDECIDED)
    far, status = impinge.distance(open_cube, point, solid="a", on_error="status")
    assert (far.distance, far.lower, impinge.Status(int(status))) == (0, 0, impinge.Status.UNDECIDED)
    assert far.upper == impinge.distance(open_cube, point).upper
    assert impinge.intersects(open_cube, point, on_error="status") == (False, 0)


@pytest.mark.parametrize("size", [1.0, 1e-82, 1e-90, 1e-160, 1e-300])
def test_open_meshes_penetrate_at_every_scale(size):
    vertices, faces = cup()
    once = impinge.Mesh(vertices * size, np.concatenate([faces, faces]))
    turned = np.diag([1.0, -1, -1, 1])
    turned[2, 3] = 1.2 * (vertices[:, 2].max() - vertices[:, 2].min()) * size
    answer, status = impinge.penetrates(once, once, None, turned, on_error="status")
    assert (answer, impinge.Status(int(status))) == (True, impinge.Status.UNDECIDED)
