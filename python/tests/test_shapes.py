"""Shapes against closed forms, against each other and against their own meshes."""

import pickle
from math import inf, nan, pi, sqrt

import impinge
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapes import cube, random_poses, torus

Shape, pose = impinge.Shape, impinge.pose
UNIT = Shape.box([0.5, 0.5, 0.5])
TORUS = impinge.Mesh(*torus())
ROUND = [Shape.sphere(0.7), Shape.capsule([0, 0, -0.5], [0, 0.2, 0.5], 0.4), Shape.cylinder(0.6, 0.5)]
ROUND += [Shape.cone(0.6, 0.7), Shape.ellipsoid([0.3, 0.6, 0.9])]
ROUND += [Shape.box([0.25, 0.5, 0.125]).rounded(0.25), Shape.cone(0.5, 0.5).rounded(0.25)]
ROUND += [Shape.tapered_capsule([0, 0, -0.5], [0, 0.2, 0.5], (0.5, 0.25))]
FLAT = [
    UNIT,
    Shape.triangle([[0, 0, 0], [1, 0, 0], [0, 1, 1]]),
    Shape.hull(np.random.default_rng(5).normal(size=(30, 3)) / 2),
]
ALL = [*ROUND, *FLAT, Shape.half_space([1, 2, 2], -1.5), TORUS, Shape.mesh(TORUS, solid=True)]
HEIGHTS = np.random.default_rng(6).integers(-1, 2, (7, 6)) / 4
ALL += [Shape.height_field(HEIGHTS, (0.5, 0.25), holes=np.eye(6, 5, dtype=bool))]
ALL += [Shape.compound([(UNIT, pose([1, 0, 0])), (TORUS, None)])]


def test_distances_of_spheres_and_capsules_equal_closed_forms():
    rng = np.random.default_rng(1)
    centers, radii = rng.uniform(-1.5, 1.5, (200, 2, 3)), np.array([0.9, 0.6])
    far = np.linalg.norm(centers[:, 1] - centers[:, 0], axis=1) - radii.sum()
    a, b = (Shape.sphere(radius) for radius in radii)
    poses = pose(centers[:, 0]), pose(centers[:, 1])
    assert 0.1 < (far <= 0).mean() < 0.9
    assert np.array_equal(impinge.intersects(a, b, *poses), far <= 0)
    found = impinge.distance(a, b, *poses)
    assert np.allclose(found.distance, np.maximum(far, 0), rtol=0, atol=1e-12)
    assert (found.lower <= np.maximum(far, 0) + 1e-14).all()
    deep = impinge.penetration(a, b, *poses)
    assert np.array_equal(deep.hit, far <= 0)
    assert np.allclose(deep.depth, np.maximum(-far, 0), rtol=0, atol=1e-12)
    assert np.array_equal(np.linalg.norm(deep.normal, axis=1).round(9), (far <= 0).astype(float))
    for clearance in (0.0, 0.5, 2.0, inf):
        assert np.array_equal(impinge.within(a, b, clearance, *poses), far <= clearance)
    # A capsule along z equals a sphere about the nearest point of its segment.
    pill = Shape.capsule([0, 0, -1], [0, 0, 1], 0.25)
    between = centers[:, 1] - centers[:, 0]
    between[:, 2] -= between[:, 2].clip(-1, 1)
    far = np.linalg.norm(between, axis=1) - 0.25 - radii[1]
    assert np.allclose(impinge.distance(pill, b, *poses).distance, np.maximum(far, 0), atol=1e-12)


def test_answers_equal_closed_forms_from_fcl_and_coal():
    """Closed forms from the tests of FCL and Coal."""
    far = impinge.distance(Shape.box([3, 5, 1]), Shape.box([1, 1, 1]), None, pose([25, 20, 5]))
    assert far.distance == pytest.approx(sqrt(21**2 + 14**2 + 3**2), rel=1e-12)
    assert np.allclose([far.point_a, far.point_b], [[3, 5, 1], [24, 19, 4]])
    turned = pose([4, 0, 0], rpy=[0, 0, pi / 4])
    far = impinge.distance(UNIT, UNIT, pose([0, 0, 0], rpy=[0, 0, pi / 4]), turned)
    assert far.distance == pytest.approx(4 - sqrt(2), rel=1e-12)
    pill, crate = Shape.capsule([0, 0, -2], [0, 0, 2], 2), Shape.box([0.5, 1, 2])
    assert impinge.distance(pill, crate, pose([3, 0, 0])).distance == pytest.approx(0.5, rel=1e-12)
    assert impinge.distance(pill, crate, pose([0, 0, 8])).distance == pytest.approx(2, rel=1e-12)
    lying = pose([-10, 0.8, 1.5], rpy=[0, pi / 2, 0])
    far = impinge.distance(pill, crate, lying)
    assert far.distance == pytest.approx(5.5, rel=1e-12)
    assert np.allclose([far.point_a, far.point_b], [[-6, 0.8, 1.5], [-0.5, 0.8, 1.5]])
    deep = impinge.penetration(
        UNIT, Shape.box([1.5, 1.5, 1.5]), pose([0, 0, 0], rpy=[0, pi / 4, 0]), pose([0, 0, -1.5])
    )
    assert deep.depth == pytest.approx(sqrt(2) / 2, rel=1e-12)
    assert np.allclose(deep.normal, [0, 0, -1])
    cone = Shape.cone(1.5, 1)  # the box moves 20 along x, and hits the cone after 8.5
    drive = impinge.Motion(pose([-10, 0, 0]), pose([10, 0, 0]))
    found = impinge.time_of_impact(Shape.box([0.5, 1, 1.5]), cone, drive)
    assert found.hit
    assert 0.425 - 1e-6 < found.t_lower <= 0.425


@pytest.mark.parametrize("a", ALL, ids=lambda shape: getattr(shape, "kind", "Mesh"))
def test_queries_are_symmetric_invariant_and_consistent(a):
    """Swapping the shapes or moving both changes nothing, and queries agree with each other."""
    motion = pose([0.5, -2, 1], quat_wxyz=[0.5, 0.5, 0.5, 0.5])
    poses = random_poses(12, 1.4, 7)
    hits = 0
    for b in ALL:
        meets = impinge.intersects(a, b, pose_b=poses)
        assert np.array_equal(meets, impinge.intersects(b, a, poses))
        assert np.array_equal(meets, impinge.intersects(a, b, motion, motion @ poses))
        assert [impinge.intersects(a, b, None, one) for one in poses] == meets.tolist()
        far = impinge.distance(a, b, None, poses)
        assert np.array_equal(far.distance == 0, meets)
        assert np.allclose(far.distance, impinge.distance(b, a, poses).distance, rtol=1e-9, atol=1e-9)
        gap = np.linalg.norm(far.point_b - far.point_a, axis=-1)
        assert np.allclose(gap[~meets], far.distance[~meets], atol=1e-8)
        assert np.array_equal(impinge.within(a, b, 0.0, None, poses), meets)
        touching = impinge.contacts(a, b, None, poses)
        assert np.array_equal(touching.counts > 0, meets)
        assert np.allclose(np.linalg.norm(touching.all.normal, axis=1), 1)
        hits += meets.sum()
    assert 0.1 < hits / (12 * len(ALL)) < 0.98


@pytest.mark.parametrize("b", [*ROUND, *FLAT], ids=lambda shape: shape.kind)
def test_moving_by_the_depth_separates_the_shapes(b):
    for a in (UNIT, *ROUND):
        poses = random_poses(10, 0.8, 3)
        deep = impinge.penetration(a, b, None, poses)
        assert deep.hit.mean() >= 0.3
        assert (deep.lower <= deep.upper).all()
        moved = poses.copy()
        moved[:, :3, 3] += deep.normal * (deep.upper * (1 + 1e-9) + 1e-9)[:, None]
        assert not impinge.intersects(a, b, None, moved).any()


def test_a_box_answers_like_its_mesh():
    vertices, faces = cube()
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    box = Shape.compound([(Shape.box((high - low) / 2), pose((high + low) / 2))])
    mesh, poses = Shape.mesh(impinge.Mesh(vertices, faces), solid=True), random_poses(150, 1.5, 4)
    probe = Shape.hull(np.random.default_rng(2).normal(size=(20, 3)) / 3)
    meets = impinge.intersects(box, probe, None, poses)
    assert 0.2 < meets.mean() < 0.8
    assert np.array_equal(meets, impinge.intersects(mesh, probe, None, poses))
    far = impinge.distance(box, probe, None, poses).distance
    assert np.allclose(far, impinge.distance(mesh, probe, None, poses).distance, atol=1e-12)
    surface = impinge.Mesh(*cube())
    assert np.array_equal(
        impinge.intersects(surface, TORUS, None, poses), impinge.intersects(Shape.mesh(surface), TORUS, None, poses)
    )


def test_rays_on_shapes_equal_closed_forms_and_meshes():
    rng = np.random.default_rng(9)
    origins, directions = rng.uniform(-3, 3, (300, 3)), rng.normal(size=(300, 3))
    found = Shape.sphere(1.5, [0.5, 0, 0]).ray_cast(origins, directions)
    o = origins - [0.5, 0, 0]
    a, b, c = (directions**2).sum(1), (o * directions).sum(1), (o**2).sum(1) - 1.5**2
    root = np.sqrt(np.maximum(b * b - a * c, 0))
    t = np.where(c <= 0, 0, np.where((b * b >= a * c) & (root - b >= 0) & (b < 0), (-b - root) / a, inf))
    assert 0.1 < found.hit.mean() < 0.9
    assert np.allclose(found.t, t, atol=1e-6)
    assert np.array_equal(found.t[c <= 0], np.zeros((c <= 0).sum()))
    box = impinge.Mesh(*cube())
    exact, other = box.ray_cast(origins, directions), Shape.mesh(box).ray_cast(origins, directions)
    assert np.array_equal(exact.face, other.face)
    assert np.allclose(exact.t, other.t)
    assert Shape.sphere(1).ray_cast([-3, 0, 0], [1, 0, 0]).face == -1
    stretched = Shape.compound([(Shape.sphere(1), np.diag([2.0, 1, 1, 1]))])
    with pytest.raises(impinge.InputError, match="rigid") as caught:
        stretched.ray_cast([0, 0, 5], [0, 0, -1])
    assert (caught.value.kind, caught.value.what) == ("not-rigid", "shape")


def test_statuses_of_rows_with_round_shapes():
    poses = pose([[0, 0, 0], [9, 0, 0], [2, 0, 0], [0, 0, 0]])
    poses[3] = np.diag([1, 2, 1, 1])
    ball = Shape.sphere(1)
    with pytest.raises(impinge.InputError, match="rigid") as caught:
        impinge.intersects(ball, UNIT, poses)
    assert (caught.value.kind, caught.value.what, caught.value.where) == ("not-rigid", "pose_a", (3,))
    assert impinge.intersects(UNIT, UNIT, poses).tolist() == [True, False, False, True]  # any affine map is valid
    hits, status = impinge.intersects(ball, ball, poses, on_error="status")
    assert hits.tolist() == [True, False, True, True]
    assert status.tolist() == [0, 0, 0, impinge.Status.NOT_RIGID]
    far, status = impinge.distance(ball, ball, poses, on_error="status")
    assert far.distance.round(9).tolist()[1:] == [7, 0, 0]
    rows, status = impinge.contacts(ball, ball, poses, on_error="status")
    assert rows.counts.tolist() == [1, 0, 1, 0]
    deep, status = impinge.penetration(ball, ball, poses, on_error="status")
    assert (deep.lower[3], deep.upper[3]) == (0, inf)
    kinds = impinge.intersects(Shape.ellipsoid([1, 2, 3]), ball, pose([2, 0, 0]), on_error="status")
    assert kinds[0] is True
    assert int(kinds[1]) in (impinge.Status.OK, impinge.Status.UNDECIDED)


def test_contacts_are_arrays_with_manifolds_and_ids():
    crates = Shape.compound([(UNIT, pose([0, 0, 0])), (UNIT, pose([3, 0, 0]))])
    floor = Shape.half_space([0, 0, 1], -0.5)
    touch = impinge.contacts(crates, floor)
    assert isinstance(touch, impinge.Contacts)
    assert len(touch) == 8
    assert np.array_equal(touch.ids[:, 0, 0], [0] * 4 + [1] * 4)
    assert len({row.tobytes() for row in touch.ids}) == 8
    assert np.allclose(touch.depth, 0)
    assert np.allclose(touch.normal, [0, 0, -1])
    assert sorted(set(touch.manifold)) == [0, 1]
    assert len(touch[touch.manifold == 1]) == 4
    assert len(impinge.contacts(crates, floor, pose([0, 0, 0.25]))) == 0
    near = impinge.contacts(crates, floor, pose([0, 0, 0.25]), margin=0.25)
    assert np.allclose(near.depth, -0.25)
    assert len(impinge.contacts(UNIT, floor, most_points=1)) == 1
    rows = impinge.contacts(UNIT, floor, pose([[[0, 0, 0], [0, 0, 1]]]))
    assert rows.shape == (1, 2)
    assert [len(row) for row in rows[0]] == [4, 0]


@pytest.mark.parametrize("shape", [shape for shape in ALL if isinstance(shape, Shape)], ids=lambda shape: shape.kind)
def test_shapes_pickle_and_have_a_repr(shape):
    again = pickle.loads(pickle.dumps(shape))
    poses = random_poses(20, 2, 8)
    assert repr(again) == repr(shape)
    assert shape.kind in repr(shape)
    assert again.kind == shape.kind
    first, second = (impinge.distance(one, UNIT, None, poses).distance for one in (shape, again))
    assert np.array_equal(first, second)
    if shape.bounds is None:
        assert shape.kind == "half_space"
    else:
        low, high = shape.bounds
        assert (low <= high).all()
        beside = pose(high + 1)  # outside of the bounds there is nothing
        assert not impinge.intersects(shape, Shape.sphere(0.5), None, beside)


@pytest.mark.parametrize(
    ("kind", "what", "make"),
    [
        ("negative", "radius", lambda: Shape.sphere(-1)),
        ("non-finite", "radius", lambda: Shape.capsule([0, 0, 0], [1, 0, 0], nan)),
        ("negative", "radius", lambda: UNIT.rounded(-1)),
        ("out-of-range", "radius", lambda: Shape.sphere(3e38).rounded(3e38)),
        ("not-roundable", "shape", lambda: Shape.half_space([0, 0, 1]).rounded(1)),
        ("not-roundable", "shape", lambda: Shape.mesh(TORUS).rounded(1)),
        ("negative", "radii", lambda: Shape.tapered_capsule([0, 0, 0], [1, 0, 0], (1, -1))),
        ("shape", "radii", lambda: Shape.tapered_capsule([0, 0, 0], [1, 0, 0], (1, 1, 1))),
        ("empty", "heights", lambda: Shape.height_field(np.zeros((1, 4)))),
        ("shape", "heights", lambda: Shape.height_field([1, 2, 3])),
        ("non-finite", "heights", lambda: Shape.height_field([[0, 1], [nan, 0]])),
        ("out-of-range", "spacing", lambda: Shape.height_field(np.zeros((2, 2)), (1, 0))),
        ("shape", "holes", lambda: Shape.height_field(np.zeros((3, 3)), holes=np.zeros((3, 3), bool))),
        ("not-roundable", "shape", lambda: Shape.height_field(np.zeros((2, 2))).rounded(1)),
        ("type", "radius", lambda: Shape.cone(1, "wide")),
        ("negative", "half_height", lambda: Shape.cylinder(-1, 1)),
        ("negative", "half_extents", lambda: Shape.box([1, -1, 1])),
        ("shape", "half_extents", lambda: Shape.box([1, 1])),
        ("out-of-range", "half_axes", lambda: Shape.ellipsoid([1, 1, 1e39])),
        ("non-finite", "center", lambda: Shape.sphere(1, [0, inf, 0])),
        ("zero-axis", "normal", lambda: Shape.half_space([0, 0, 0])),
        ("non-finite", "level", lambda: Shape.half_space([0, 0, 1], nan)),
        ("empty", "points", lambda: Shape.hull(np.zeros((0, 3)))),
        ("shape", "corners", lambda: Shape.triangle([[0, 0, 0], [1, 1, 1]])),
        ("type", "mesh", lambda: Shape.mesh(UNIT)),
        ("empty", "parts", lambda: Shape.compound([])),
        ("type", "parts", lambda: Shape.compound([UNIT])),
        ("type", "parts[0]", lambda: Shape.compound([(cube(), None)])),
        ("singular", "parts[1]", lambda: Shape.compound([(UNIT, None), (UNIT, np.diag([1.0, 0, 1, 1]))])),
        ("type", "a", lambda: impinge.intersects(cube(), UNIT)),
        ("type", "b", lambda: impinge.distance(UNIT, None)),
        (
            "shape",
            "pose_b",
            lambda: impinge.intersects(UNIT, UNIT, np.stack([np.eye(4)] * 2), np.stack([np.eye(4)] * 3)),
        ),
        ("non-finite", "clearance", lambda: impinge.within(UNIT, UNIT, nan)),
        ("negative", "margin", lambda: impinge.contacts(UNIT, UNIT, margin=-1)),
        ("out-of-range", "most_points", lambda: impinge.contacts(UNIT, UNIT, most_points=0)),
        ("zero-direction", "directions", lambda: UNIT.ray_cast([0, 0, 0], [0, 0, 0])),
        ("option", "Shape", Shape),
    ],
)
def test_errors_name_the_invalid_argument(kind, what, make):
    with pytest.raises(impinge.InputError) as caught:
        make()
    assert (caught.value.kind, caught.value.what) == (kind, what)


NUMBERS = st.one_of(st.sampled_from([0.0, 1.0, -1.0, nan, inf, 1e300, 1e-300, 5e-324]), st.floats(width=64))


@given(st.lists(NUMBERS, min_size=3, max_size=3), NUMBERS, NUMBERS)
def test_any_numbers_are_accepted_or_raise_an_input_error(vector, one, other):
    """Any numbers raise an error, or give finite answers that agree with each other."""
    made = []
    makers = [
        lambda: Shape.sphere(one, vector),
        lambda: Shape.capsule(vector, [0, 0, 0], other),
        lambda: Shape.box(vector),
        lambda: Shape.box(vector).rounded(other),
        lambda: Shape.tapered_capsule(vector, [0, 0, 1], (one, other)),
    ]
    makers += [
        lambda: Shape.cylinder(one, other),
        lambda: Shape.ellipsoid(vector),
        lambda: Shape.half_space(vector, one),
    ]
    for make in makers:
        try:
            made.append(make())
        except impinge.InputError as error:
            assert error.kind in ("negative", "non-finite", "out-of-range", "zero-axis")
    for shape in made:
        far = impinge.distance(shape, UNIT)
        assert not np.isnan([far.distance, far.lower, far.upper]).any()
        assert far.lower <= far.upper
        assert impinge.intersects(shape, UNIT) == (far.distance == 0)
        assert np.isfinite([far.point_a, far.point_b]).all()


def test_every_query_reports_undecided_round_shapes():
    drum, beside = Shape.cylinder(1, 1), pose([2.0, 0, 0])
    verbs = ["intersects", "distance", "penetration", "contacts"]
    statuses = {verb: int(getattr(impinge, verb)(drum, drum, None, beside, on_error="status")[1]) for verb in verbs}
    statuses["within"] = int(impinge.within(drum, drum, 0.0, None, beside, on_error="status")[1])
    assert set(statuses.values()) == {int(impinge.Status.UNDECIDED)}, statuses
    deep = [getattr(impinge, verb)(drum, drum, None, pose([1.5, 0, 0]), on_error="status")[1] for verb in verbs]
    assert [int(status) for status in deep] == [0] * 4


def test_an_empty_mesh_is_not_within_any_clearance():
    empty = impinge.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
    ball = Shape.sphere(1)
    for clearance in (1.0, 1e90, 1e97, 1e300, np.inf):
        assert impinge.within(empty, ball, clearance) is False
        assert impinge.within(ball, ball, clearance, None, pose([1e80, 0, 0])) is (clearance > 1e80)


def first_parameter(surfaces):
    """Returns the smallest valid parameter of k candidates, (n,); infinite if none is valid."""
    t, counts = (np.column_stack(columns) for columns in zip(*surfaces, strict=True))
    return np.where(counts, t, np.inf).min(axis=1)


def roots(a, b, c):
    """Returns both roots of ``a t^2 + 2 b t + c``; NaN if there are none."""
    with np.errstate(invalid="ignore", divide="ignore"):
        # This form avoids cancellation.
        q = -(b + np.copysign(np.sqrt(b * b - a * c), b))
        return q / a, c / q


@pytest.mark.parametrize(("kind", "bound"), [("cylinder", 1e-9), ("cone", 1e-6)])
def test_rays_on_round_shapes_equal_closed_forms(kind, bound):
    rng = np.random.default_rng(31)
    origin, target = rng.uniform(-4, 4, (600, 3)), rng.uniform(-0.9, 0.9, (600, 3))
    outside = (np.abs(origin) > 1.1).any(axis=1)
    origin, direction = origin[outside], (target - origin)[outside]
    (x, y, z), (u, v, w) = origin.T, direction.T
    if kind == "cylinder":
        shape, slope = Shape.cylinder(1, 1), 0.0
        sides = roots(u * u + v * v, x * u + y * v, x * x + y * y - 1)
    else:
        # The radius at z is (1 - z) / 2.
        shape, slope = Shape.cone(1, 1), 0.5
        k = slope * slope
        sides = roots(u * u + v * v - k * w * w, x * u + y * v + k * (1 - z) * w, x * x + y * y - k * (1 - z) ** 2)
    candidates = [(t, (t >= 0) & (np.abs(z + t * w) <= 1)) for t in sides]
    for end in (-1.0, 1.0):
        t = (end - z) / w
        radius = 1 - slope * (1 + end)
        candidates.append((t, (t >= 0) & (np.hypot(x + t * u, y + t * v) <= radius)))
    expected = first_parameter(candidates)
    hit = shape.ray_cast(origin, direction)
    sure = np.isfinite(expected)
    assert sure.sum() > 200
    assert hit.hit[sure].all()
    # The error is the padding of the shape over the cosine of incidence; few rays graze it.
    off = np.abs(hit.t[sure] - expected[sure]) * np.linalg.norm(direction[sure], axis=1)
    assert off.max() < bound
    assert hit.hit.sum() <= sure.sum() + 2


@pytest.mark.parametrize("holes", [None, np.eye(6, 5, dtype=bool)], ids=["whole", "holes"])
def test_a_height_field_answers_as_the_mesh_of_its_triangles(holes):
    field = Shape.height_field(HEIGHTS, (0.5, 0.25), holes=holes)
    rows, columns = np.indices((7, 6))
    points = np.stack([0.5 * columns, 0.25 * rows, HEIGHTS], axis=-1).reshape(-1, 3)
    first = (6 * rows[:-1, :-1] + columns[:-1, :-1])[slice(None) if holes is None else ~holes].ravel()
    faces = np.stack([first, first + 1, first + 7, first, first + 7, first + 6], axis=-1).reshape(-1, 3)
    mesh = impinge.Mesh(points, faces)
    poses = random_poses(200, 1, 2)
    poses[:, :3, 3] += [1.25, 0.75, 0]  # about the middle of the field
    for shape in (*ROUND, *FLAT, TORUS):
        assert np.array_equal(
            impinge.intersects(field, shape, None, poses), impinge.intersects(mesh, shape, None, poses)
        )
        near, far = (impinge.distance(one, shape, None, poses).distance for one in (field, mesh))
        assert np.allclose(near, far, rtol=0, atol=1e-12)
        assert 0.02 < (far == 0).mean() < 0.98
    origins = np.random.default_rng(4).uniform(-1, 4, (300, 3))
    found, wanted = field.ray_cast(origins, [1, 0.5, -1]), mesh.ray_cast(origins, [1, 0.5, -1])
    assert np.array_equal(found.t, wanted.t)
    assert 0.02 < found.hit.mean() < 0.9
    if holes is None:
        assert np.array_equal(found.face, wanted.face)
