"""Queries of worlds, and margins, against loops over single queries on grids full of ties."""

import pickle
from itertools import combinations
from math import inf, nan

import impinge
import numpy as np
import pytest

Shape, Motion, pose = impinge.Shape, impinge.Motion, impinge.pose
BROAD = ["auto", "every", "tree", "columns", "grid"]
SQUARE = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
CUBE = Shape.box([0.5, 0.5, 0.5])
PAIR = Shape.compound([(CUBE, pose([-1, 0, 0])), (Shape.sphere(0.5), pose([1, 0, 0]))])
KINDS = [CUBE, Shape.sphere(0.5), Shape.capsule([0, 0, -0.5], [0, 0, 0.5], 0.5), SQUARE, PAIR]
IMPACT = ["hit", "t_lower", "t_upper", "point", "normal", "parts", "faces"]
DISTANCE = ["distance", "lower", "upper", "point_a", "point_b", "face_a", "face_b"]


def on_grid(broad, count=24, reach=4, **options):
    """Returns a world of bodies at halves, their handles and poses, and the random generator."""
    world, rng = impinge.World(broad_phase=broad, **options), np.random.default_rng(7)
    poses = pose(rng.integers(-2 * reach, 2 * reach, (count, 3)) / 2)
    tags = rng.integers(0, 3, count) // 2
    handles = [world.insert(KINDS[row % 5], poses[row], tag=tags[row], layers=1 + row % 2) for row in range(count)]
    return world, np.array(handles, np.uint64), poses, rng


def same(one, other, names):
    return all(np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True) for name in names)


@pytest.mark.parametrize("options", [{"clearance": 0.5}, {"ignore_touch": True}])
@pytest.mark.parametrize("broad", BROAD)
def test_casts_equal_times_of_impact_with_each_body(broad, options):
    world, handles, poses, rng = on_grid(broad)
    starts, paths = rng.integers(-6, 7, (60, 3)), rng.integers(-6, 7, (60, 3))
    motion = Motion(pose(starts), pose(starts + paths))
    first = world.shape_cast(CUBE, motion, layers=1, **options)
    every = world.shape_cast_all(CUBE, motion, layers=1, **options)
    hits, ties = 0, 0
    for row in range(60):
        one = Motion(pose(starts[row]), pose(starts[row] + paths[row]))
        found = []
        for nth in range(0, len(handles), 2):
            impact = impinge.time_of_impact(CUBE, KINDS[nth % 5], one, Motion(poses[nth], poses[nth]), **options)
            if impact.hit:
                found.append((impact.t_lower, int(world.tags(handles[nth])), int(handles[nth]), impact))
        found.sort(key=lambda entry: entry[:3])
        assert every[row].body.tolist() == [entry[2] for entry in found]
        assert first.body[row] == (found[0][2] if found else 0)
        assert first.impact.hit[row] == bool(found)
        for nth, (t, _, _, impact) in enumerate(found):
            for name in IMPACT:
                listed = getattr(every[row].impact, name)[nth]
                assert np.array_equal(listed, getattr(impact, name), equal_nan=True), name
            ties += nth > 0 and t == found[nth - 1][0]
        hits += len(found)
        alone = world.shape_cast(CUBE, one, layers=1, **options)
        assert alone.body == first.body[row]
        assert alone.impact.t_lower == first.impact.t_lower[row]
    assert hits > 10
    assert ties > 0 or "clearance" not in options
    assert repr(every) == f"BodyImpacts(shape=(60,), {hits} impacts)"
    alone = world.shape_cast_all(CUBE, Motion(pose(starts[0]), pose(starts[0] + paths[0])), layers=1, **options)
    assert alone.body.tolist() == every[0].body.tolist()


@pytest.mark.parametrize("broad", BROAD)
def test_distances_equal_those_of_each_body(broad):
    world, handles, poses, rng = on_grid(broad)
    places = pose(rng.integers(-12, 13, (24, 3)) / 2)
    near = world.nearest(CUBE, places, layers=2, limit=2)
    held = world.within(CUBE, 1.5, places, layers=2)
    missed, ties = 0, 0
    for row in range(24):
        found = []
        for nth in range(1, len(handles), 2):
            distance = impinge.distance(CUBE, KINDS[nth % 5], places[row], poses[nth])
            found.append((distance.upper, int(world.tags(handles[nth])), int(handles[nth]), distance, nth))
        found.sort(key=lambda entry: entry[:3])
        best = next((entry for entry in found if entry[3].lower <= 2), None)
        assert near.body[row] == (best[2] if best else 0)
        ties += best is not None and found[0][0] == found[1][0]
        missed += best is None
        alone = world.nearest(CUBE, places[row], layers=2, limit=2)
        if best:
            assert same(alone.distance, best[3], DISTANCE)
        else:
            assert (alone.body, alone.distance.upper, alone.distance.face_a) == (0, inf, -1)
        within = [impinge.within(CUBE, KINDS[entry[4] % 5], 1.5, places[row], poses[entry[4]]) for entry in found]
        expected = sorted(entry[1:3] for entry, is_within in zip(found, within, strict=True) if is_within)
        assert held[row].tolist() == [handle for _, handle in expected]
    assert missed > 0
    assert ties > 0
    assert held.counts.sum() > 10
    pairs = handles[:12].reshape(2, 3, 2)
    found = world.distances(pairs)
    assert found.distance.shape == (2, 3)
    assert found.point_a.shape == (2, 3, 3)
    for i, j in np.ndindex(2, 3):
        a = 6 * i + 2 * j
        alone = impinge.distance(KINDS[a % 5], KINDS[(a + 1) % 5], poses[a], poses[a + 1])
        assert same(world.distances(pairs[i, j]), alone, DISTANCE)
        assert found.upper[i, j] == alone.upper


def test_ray_hits_have_normals_and_parts():
    world = impinge.World()
    body = world.insert(PAIR, pose([0, 0, 5]))
    square = world.insert(SQUARE)
    hits = world.ray_cast([[-1, 0, 9], [1, 0, 9], [9, 9, 9], [1, 0, 5]], [0, 0, -2])
    assert hits.part.tolist() == [0, 1, -1, 1]
    assert np.array_equal(hits.normal, [[0, 0, 1], [0, 0, 1], [nan] * 3, [nan] * 3], equal_nan=True)
    below = world.ray_cast_all([0.25, 0.25, -1], [0, 0, 1])
    assert below.body.tolist() == [square]
    assert below.normal.tolist() == [[0, 0, -1]]
    culled = world.ray_cast([0.25, 0.25, -1], [0, 0, 1], cull_back_faces=True)
    assert (culled.hit, culled.body, culled.part) == (False, 0, -1)
    rows = world.ray_cast_all([[0.25, 0.25, 1], [0.25, 0.25, -1]], [[0, 0, -1], [0, 0, 1]], cull_back_faces=True)
    assert rows.counts.tolist() == [1, 0]
    assert rows[0].normal.tolist() == [[0, 0, 1]]
    assert rows[0].part.tolist() == [0]
    assert int(world.ray_cast([-1, 0, 9], [0, 0, -1]).body) == body


def test_face_normals_are_those_of_the_faces():
    mesh = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2], [0, 2, 3], [0, 1, 1]])
    assert np.array_equal(mesh.face_normals(), [[0, 0, 1], [1, 0, 0], [nan] * 3], equal_nan=True)
    assert mesh.face_normals([[1], [0]]).tolist() == [[[1, 0, 0]], [[0, 0, 1]]]
    assert mesh.face_normals([]).shape == (0, 3)
    with pytest.raises(impinge.InputError, match="3 faces") as error:
        mesh.face_normals([0, 3])
    assert (error.value.kind, error.value.what) == ("out-of-range", "faces")


@pytest.mark.parametrize("broad", BROAD)
def test_pairs_with_margins_equal_single_queries(broad):
    world, handles, poses, rng = on_grid(broad, 16, 3)
    margins = rng.choice([0, 0.25, 0.5], 16)
    for handle, margin in zip(handles, margins, strict=True):
        world.set_margin(handle, margin)
    assert world.margins(handles).tolist() == margins.tolist()
    assert world.margins(handles[0]) == margins[0]
    step = world.step()
    expected, gaps = {}, 0
    order = sorted(range(16), key=lambda row: (int(world.tags(handles[row])), int(handles[row])))
    for i, j in combinations(order, 2):
        things, margin = (KINDS[i % 5], KINDS[j % 5]), margins[i] + margins[j]
        if impinge.within(*things, margin, poses[i], poses[j]):
            contacts = impinge.contacts(*things, poses[i], poses[j], margin=margin)
            expected[int(handles[i]), int(handles[j])] = contacts
            gaps += (contacts.depth < 0).all()
    found = [(int(a), int(b)) for a, b in world.pairs()]
    assert sorted(found) == sorted(expected)
    assert len(step.began) == len(expected)
    assert gaps > 3
    for pair, contacts in zip(found, world.contacts(), strict=True):
        assert np.array_equal(contacts.normal, expected[pair].normal)
        assert np.array_equal(contacts.depth, expected[pair].depth)
    other = pickle.loads(pickle.dumps(world))
    assert other.margins(handles).tolist() == margins.tolist()
    world.set_margin(handles, 0)
    ended = world.step().ended
    touching = [pair for pair in expected if (expected[pair].depth >= 0).any()]
    assert len(ended) == len(expected) - len(touching)


def test_invalid_options_of_queries_raise_an_error():
    world = impinge.World()
    body = world.insert(CUBE, margin=0.25)
    assert world.margins(body) == 0.25
    still = Motion(None, None)
    stretched = np.diag([2.0, 1, 1, 1])
    calls = [
        ("negative", "margin", lambda: world.set_margin(body, -1)),
        ("non-finite", "margin", lambda: world.set_margin(body, inf)),
        ("non-finite", "margin", lambda: world.insert(CUBE, margin=inf)),
        ("out-of-range", "margin", lambda: world.insert(CUBE, margin=1e39)),
        ("stale", "bodies", lambda: world.set_margin([body, 77], 1)),
        ("negative", "clearance", lambda: world.shape_cast(CUBE, still, clearance=-1)),
        ("type", "motion", lambda: world.shape_cast(CUBE, np.eye(4))),
        ("not-rigid", "motion", lambda: world.shape_cast(KINDS[1], Motion(stretched, stretched))),
        ("type", "ignore_touch", lambda: world.shape_cast_all(CUBE, still, ignore_touch=1)),
        ("negative", "limit", lambda: world.nearest(CUBE, limit=-1)),
        ("non-finite", "clearance", lambda: world.within(CUBE, nan)),
        ("stale", "pairs", lambda: world.distances([[body, 77]])),
        ("shape", "pairs", lambda: world.distances([body])),
        ("type", "cull_back_faces", lambda: world.ray_cast([0, 0, 9], [0, 0, 1], cull_back_faces=None)),
    ]
    for kind, what, call in calls:
        with pytest.raises(impinge.InputError) as error:
            call()
        assert (error.value.kind, error.value.what) == (kind, what)
    assert world.margins(body) == 0.25
