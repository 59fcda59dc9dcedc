"""Points and rays against one mesh: brute force, laws, and array arguments of any kind."""

import impinge
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import oracle_pairs, surface_distances, winding_numbers
from shapes import TRIANGLE, cube, torus

CUBE, TORUS = impinge.Mesh(*cube()), impinge.Mesh(*torus())
FLAT = impinge.Mesh(*TRIANGLE)
RNG = np.random.default_rng(3)
POINTS = RNG.uniform(-1.6, 1.6, (300, 3)) * [1, 1, 0.4]


def test_nearest_points_equal_brute_force():
    distances = surface_distances(torus(), POINTS)
    near = TORUS.closest_point(POINTS)
    assert np.allclose(near.distance, distances.min(axis=1), rtol=0, atol=1e-12)
    assert (near.lower <= near.upper).all()
    assert (near.upper - near.lower < 1e-12).all()
    assert np.allclose(np.linalg.norm(near.point - POINTS, axis=1), near.distance, rtol=0, atol=1e-12)
    assert np.allclose(distances[np.arange(len(POINTS)), near.face], near.distance, rtol=0, atol=1e-12)


def test_winding_numbers_equal_sums_of_solid_angles():
    shells = (np.concatenate([torus()[0], cube()[0]]), np.concatenate([torus()[1], cube()[1] + len(torus()[0])]))
    opened = (torus()[0], torus()[1][:-60])
    for mesh in (torus(), shells, opened):
        expected = winding_numbers(mesh, POINTS)
        own = impinge.Mesh(*mesh)
        found = own.winding_number(POINTS)
        assert np.allclose(found, expected, rtol=0, atol=1e-9)
        assert own.contains(POINTS).tolist() == (np.abs(expected) > 0.5).tolist()
        signed = own.signed_distance(POINTS)
        assert ((signed < 0) == own.contains(POINTS)).all()
        assert np.array_equal(np.abs(signed), own.closest_point(POINTS).distance)
    assert 0.1 < TORUS.contains(POINTS).mean() < 0.6
    assert set(impinge.Mesh(*shells).winding_number(POINTS).tolist()) == {0.0, 1.0}


def test_points_next_to_the_surface_are_decided_exactly():
    on = np.array([[0.5, 0.5, 0.5], [0.5, 0.25, -0.125], [-0.5, 0.0, 0.0], [0.5, 0.5, 0.3]])
    assert CUBE.contains(on).all()
    assert (CUBE.signed_distance(on) == 0).all()
    off = np.nextafter(on, 10 * on)
    assert not CUBE.contains(off).any()
    assert (CUBE.signed_distance(off) > 0).all()
    inside = np.nextafter(on, 0)
    assert CUBE.contains(inside).all()
    assert (CUBE.signed_distance(inside) < 0).all()


small = st.integers(-2, 2)
cells = st.lists(st.tuples(*[small] * 9), min_size=1, max_size=2)


@settings(max_examples=40)
@given(corners=cells, origin=st.tuples(*[small] * 3), direction=st.tuples(*[small] * 3).filter(any))
def test_rays_on_a_grid_equal_rational_arithmetic(corners, origin, direction):
    """The oracle treats a ray as a long segment, which is a triangle without area."""
    mesh = (np.array(corners, float).reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    origin, direction = np.array(origin, float), np.array(direction, float)
    ray = (np.array([origin, origin + 16 * direction]), np.array([[0, 1, 1]]))
    expected = oracle_pairs(ray, mesh)[:, 1]
    built = impinge.Mesh(*mesh)
    hits = built.ray_cast_all(origin, direction)
    assert sorted(hits.face.tolist()) == expected.tolist()
    assert hits.hit.all()
    assert np.array_equal(hits.t, np.sort(hits.t))
    assert np.allclose(hits.point, origin + hits.t[:, None] * direction)
    assert all(surface_distances(mesh, p[None])[0, face] < 1e-12 for p, face in zip(hits.point, hits.face, strict=True))
    first = built.ray_cast(origin, direction)
    assert first.hit == (len(expected) > 0)
    if first.hit:
        assert (first.t, first.face) == (hits.t[0], hits.face[0])
    else:
        assert (first.t, first.face, first.point.tolist()) == (np.inf, -1, [0, 0, 0])


def test_rays_leave_a_closed_mesh_as_often_as_they_enter_it():
    rays = RNG.uniform(-2, 2, (400, 3)), RNG.normal(size=(400, 3))
    rays[0][::4] *= 0.2
    rays[1][::2] -= rays[0][::2]  # towards the center
    outside = ~TORUS.contains(rays[0])
    hits = TORUS.ray_cast_all(*rays)
    assert 0.2 < (hits.counts > 0).mean() < 0.9
    assert (hits.counts[outside] % 2 == 0).all()
    assert (hits.counts[~outside] % 2 == 1).all()
    first = TORUS.ray_cast(*rays)
    assert np.array_equal(first.hit, hits.counts > 0)
    assert np.array_equal(first.t[first.hit], hits.t[hits.offsets[:-1][first.hit]])
    assert (first.t[~first.hit] == np.inf).all()
    assert (first.face[~first.hit] == -1).all()


def test_rays_broadcast_and_results_can_be_indexed():
    origins, directions = RNG.uniform(-2, 2, (3, 1, 3)), RNG.normal(size=(4, 3))
    first, every = TORUS.ray_cast(origins, directions), TORUS.ray_cast_all(origins, directions)
    assert first.hit.shape == first.t.shape == first.face.shape == every.shape == every.counts.shape == (3, 4)
    assert first.point.shape == (3, 4, 3)
    for at in np.ndindex(3, 4):
        alone = TORUS.ray_cast_all(origins[at[0], 0], directions[at[1]])
        for part in (every[at], every[at[0]][at[1]]):
            assert np.array_equal(part.t, alone.t)
            assert np.array_equal(part.face, alone.face)
            assert np.array_equal(part.point, alone.point)
    assert TORUS.ray_cast(origins[:0], directions).t.shape == (0, 4)
    assert [len(row) for row in every] == [4] * 3


METHODS = ["closest_point", "signed_distance", "winding_number", "contains"]


@pytest.mark.parametrize("method", METHODS)
def test_a_single_point_gives_a_plain_number(method):
    ask = getattr(TORUS, method)
    many = ask(POINTS[:6].reshape(2, 3, 3))
    for at in np.ndindex(2, 3):
        one = ask(POINTS[:6].reshape(2, 3, 3)[at])
        if method == "closest_point":
            assert isinstance(one.distance, float)
            assert isinstance(one.face, int)
            for field in ("point", "distance", "lower", "upper", "face"):
                assert np.array_equal(getattr(many, field)[at], getattr(one, field))
        else:
            assert isinstance(one, bool if method == "contains" else float)
            assert many[at] == one
    assert np.shape(getattr(ask(np.zeros((0, 5, 3))), "distance", ask(np.zeros((0, 5, 3))))) == (0, 5)


def test_an_empty_mesh_has_no_points_and_no_hits():
    empty = impinge.Mesh([], [])
    near = empty.closest_point([[1, 2, 3]])
    assert (near.distance.tolist(), near.face.tolist(), near.point.tolist()) == ([np.inf], [-1], [[0, 0, 0]])
    assert (empty.signed_distance([0, 0, 0]), empty.winding_number([0, 0, 0])) == (np.inf, 0.0)
    assert empty.contains([0, 0, 0]) is False
    assert empty.ray_cast([0, 0, 0], [1, 0, 0]).hit is False
    assert len(empty.ray_cast_all([0, 0, 0], [1, 0, 0]).t) == 0


def test_the_number_of_threads_does_not_change_the_answer():
    points = RNG.uniform(-2, 2, (5_000, 3))
    answers = []
    for n in (1, 2, 5):
        with impinge.threads(n):
            hits = TORUS.ray_cast(points, [0, 0, 1])
            answers.append((TORUS.closest_point(points).point, TORUS.signed_distance(points), hits.t, hits.face))
    for other in answers[1:]:
        assert all(map(np.array_equal, answers[0], other))
    alone = [TORUS.signed_distance(point) for point in points[:50]]
    assert answers[0][1][:50].tolist() == alone


WRONG = [
    ("shape", (), [1, 2]),
    ("shape", (), 1.0),
    ("shape", (), np.zeros((3, 2))),
    ("dtype", (), np.zeros(3, int)),
    ("dtype", (), np.zeros(3, np.float16)),
    ("dtype", (), "abc"),
    ("type", (), None),
    ("non-finite", (), [0, np.nan, 0]),
    ("non-finite", (1, 2), [[[0, 0, 0]] * 3, [[0, 0, 0], [0, 0, 0], [0, np.inf, 0]]]),
    ("out-of-range", (1,), [[0, 0, 0], [2.0**300, 0, 0]]),
]


@pytest.mark.parametrize(("kind", "where", "wrong"), WRONG)
def test_errors_name_the_invalid_array(kind, where, wrong):
    calls = [(name, "points", lambda name=name: getattr(CUBE, name)(wrong)) for name in METHODS]
    for cast in (CUBE.ray_cast, CUBE.ray_cast_all):
        calls.append((cast, "origins", lambda cast=cast: cast(wrong, [0, 0, 1])))
        calls.append((cast, "directions", lambda cast=cast: cast([0, 0, 1], wrong)))
    for _, what, call in calls:
        with pytest.raises(impinge.InputError) as caught:
            call()
        assert (caught.value.kind, caught.value.what, caught.value.where) == (kind, what, where)


def test_queries_on_solids_have_a_lower_coordinate_limit():
    far = [2.0**128, 0, 0]
    assert CUBE.closest_point(far).distance == pytest.approx(2.0**128)
    for ask in (CUBE.signed_distance, CUBE.winding_number, CUBE.contains):
        with pytest.raises(impinge.InputError, match="2\\^128"):
            ask(far)


def test_a_zero_direction_raises_an_error():
    with pytest.raises(impinge.InputError) as caught:
        CUBE.ray_cast([0, 0, 0], [[[0, 0, 1], [0, 0, -0.0]]])
    assert (caught.value.kind, caught.value.what, caught.value.where) == ("zero-direction", "directions", (0, 1))
    with pytest.raises(impinge.InputError, match="broadcast"):
        CUBE.ray_cast(np.zeros((2, 3)), np.ones((3, 3)))


@given(
    data=st.data(),
    dtype=st.sampled_from(["f2", "f4", "f8", ">f4", ">f8", "i4", "u8", "c16", "O", "U3", "b1", "M8[s]"]),
    shape=st.lists(st.integers(0, 4), max_size=4).map(tuple),
    role=st.sampled_from([*METHODS, "origins", "directions", "cloud", "hull"]),
)
def test_any_array_is_accepted_or_raises_an_input_error(data, dtype, shape, role):
    """Any array gives an answer of its shape, or an `InputError` that names it."""
    size = int(np.prod(shape))
    array = np.array(data.draw(st.lists(st.integers(-3, 6), min_size=size, max_size=size))).reshape(shape).astype(dtype)
    if array.ndim:
        array = data.draw(st.sampled_from([array, array[::-1], np.asfortranarray(array), array[..., ::2]]))
    names = {"origins": "origins", "directions": "directions"}
    try:
        if role in ("cloud", "hull"):
            ask = impinge.fit.obb if role == "cloud" else impinge.convex_hull
            assert ask(array) is not None
            assert array.ndim == 2 or array.shape == (0,)
            return
        if role in names:
            rays = (array, [0, 0, 1]) if role == "origins" else ([0, 0, 1], array)
            hits = FLAT.ray_cast(*rays)
            assert np.shape(hits.t) == array.shape[:-1]
            assert np.array_equal(
                FLAT.ray_cast_all(*rays).t, hits.t[hits.hit] if np.ndim(hits.t) else [hits.t][: hits.hit]
            )
        else:
            answer = getattr(FLAT, role)(array)
            assert np.shape(getattr(answer, "distance", answer)) == array.shape[:-1]
        assert array.dtype.kind == "f"
    except impinge.InputError as error:
        assert error.what == names.get(role, "points")
