"""Worlds against loops over single queries."""

import gc
import pickle
import threading
from functools import cache
from itertools import combinations
from math import inf, nan

import impinge
import numpy as np
import pytest
from shapes import random_poses, torus

Shape, pose = impinge.Shape, impinge.pose
BROAD = ["auto", "every", "tree", "columns", "grid", "one_axis", "three_axes"]
POINT = Shape.sphere(0)
KINDS = [Shape.sphere(0.6), Shape.box([0.5, 0.7, 0.3]), Shape.capsule([0, 0, -0.5], [0, 0, 0.5], 0.3)]
KINDS += [impinge.Mesh(*torus(12, 8))]


def named(pairs):
    return [tuple(map(int, pair)) for pair in pairs]


def filled(broad, count=80, **options):
    """Returns a world of bodies with four shapes and ascending tags, and its ingredients.

    These are the handles, the poses and the random generator.
    """
    world, rng = impinge.World(broad_phase=broad, **options), np.random.default_rng(11)
    poses = random_poses(count, 3.5, 12)
    handles = np.array([world.insert(KINDS[row % 4], poses[row], tag=row) for row in range(count)], np.uint64)
    return world, handles, poses, rng


def brute(handles, poses):
    """Returns the pairs that single queries find."""
    return [(int(handles[i]), int(handles[j])) for i, j in brute_rows(poses.tobytes())]


@cache
def brute_rows(poses):
    poses = np.frombuffer(poses).reshape(-1, 4, 4)
    return [
        (i, j)
        for i, j in combinations(range(len(poses)), 2)
        if impinge.intersects(KINDS[i % 4], KINDS[j % 4], poses[i], poses[j])
    ]


@pytest.mark.parametrize("broad", BROAD)
def test_steps_equal_a_loop_over_single_queries(broad):
    world, handles, poses, rng = filled(broad, narrow_phase="intersections")
    before = set()
    for _ in range(4):
        step = world.step(handles, poses, persisting=True)
        now = brute(handles, poses)
        assert len(now) > 20
        assert named(world.pairs()) == now
        assert named(step.began) == [pair for pair in now if pair not in before]
        gone = [(int(a), int(b)) for a, b in combinations(handles, 2) if (int(a), int(b)) in before - set(now)]
        assert named(step.ended) == gone
        assert named(step.persisting) == [pair for pair in now if pair in before]
        assert np.array_equal(world.poses(handles), poses)
        before = set(now)
        moved = rng.permutation(len(handles))[:30]
        poses[moved, :3, 3] += rng.normal(size=(30, 3)) / 2
    stood = world.step()
    assert (len(stood.began), len(stood.ended), stood.persisting, stood.work.changed) == (0, 0, None, 0)


def test_contacts_equal_those_of_single_queries():
    world, handles, poses, _ = filled("auto", 40)
    world.step()
    pairs, rows = world.pairs(), world.contacts()
    assert rows.shape == (len(pairs),)
    assert len(pairs) > 10
    place = {int(handle): row for row, handle in enumerate(handles)}
    for pair, found in zip(pairs, rows, strict=True):
        i, j = (place[int(handle)] for handle in pair)
        alone = impinge.contacts(KINDS[i % 4], KINDS[j % 4], poses[i], poses[j])
        for name in ("normal", "depth", "lower", "point_a", "point_b", "manifold", "ids"):
            assert np.array_equal(getattr(found, name), getattr(alone, name))
    assert not world.undecided().any()
    assert len(impinge.World(narrow_phase="intersections").contacts()) == 0


def test_kinds_layers_and_owners_select_pairs():
    def pairs(*bodies):
        world = impinge.World()
        for options in bodies:
            world.insert(KINDS[0], **options)
        return len(world.step().began)

    assert pairs({}, {}) == 1
    assert pairs({"kind": "static"}, {"kind": "kinematic"}) == 0
    assert pairs({"kind": "static"}, {}) == pairs({"kind": "kinematic"}, {}) == 1
    assert pairs({"layers": 1}, {"meets": 2}) == 0
    assert pairs({"layers": 2}, {"meets": 2}) == 1
    assert pairs({"owner": 7}, {"owner": 7}) == 0
    assert pairs({"owner": 7}, {"owner": 8}) == pairs({"owner": 7}, {}) == 1
    world = impinge.World()
    limbs = world.insert(KINDS[0], np.stack([np.eye(4)] * 4), owner=[1, 1, 2, 2], tag=[9, 8, 7, 6])
    assert len(world.step().began) == 4
    assert world.tags(world.pairs()).tolist() == [[6, 8], [6, 9], [7, 8], [7, 9]]
    world.set_traits(limbs, owner=5)
    assert len(world.step().ended) == 4


def test_a_filter_selects_pairs_and_its_errors_are_raised():
    world = impinge.World()
    bodies = world.insert(KINDS[0], np.stack([np.eye(4)] * 5), tag=np.arange(5))
    asked = []
    of_tags = dict(zip(bodies.tolist(), range(5), strict=True))
    world.set_filter(lambda a, b: asked.append((a, b)) or (of_tags[a] + of_tags[b]) % 2 == 0)
    every = [(int(a), int(b)) for a, b in combinations(bodies, 2)]
    assert named(world.step().began) == [(a, b) for a, b in every if (of_tags[a] + of_tags[b]) % 2 == 0]
    assert set(asked) == set(every)
    world.set_filter(None)
    assert len(world.step().began) == 10 - 4

    def fails(a, b):
        raise ZeroDivisionError

    world.set_filter(fails)
    with pytest.raises(ZeroDivisionError):
        world.step()
    assert len(world.pairs()) == 10
    world.set_filter(lambda a, b: len(world) > 0)
    with pytest.raises(RuntimeError, match="filter"):
        world.step()
    world.set_filter(lambda a, b: False)
    assert len(world.step().ended) == 10


def test_stale_handles_raise_an_error_and_change_nothing():
    world = impinge.World()
    first = world.insert(KINDS[0])
    other = world.insert(KINDS[1])
    world.step()
    world.remove(first)
    assert len(world.pairs()) == 0
    again = world.insert(KINDS[0])
    assert again != first
    step = world.step()
    assert [set(pair) for pair in named(step.ended)] == [{first, other}]
    assert [set(pair) for pair in named(step.began)] == [{again, other}]
    for stale in (
        lambda: world.remove([other, first]),
        lambda: world.poses(first),
        lambda: world.step([other, first], np.eye(4)),
        lambda: world.set_poses([other, first], pose([9, 0, 0])),
        lambda: world.bounds([other, first]),
        lambda: world.set_traits([other, first], kind="static"),
    ):
        with pytest.raises(impinge.InputError) as caught:
            stale()
        assert (caught.value.kind, caught.value.what) == ("stale", "bodies")
        assert caught.value.where in ((0,), (1,))
    assert len(world) == 2
    assert np.array_equal(world.poses(other), np.eye(4))
    world.remove([again, again, other])
    assert len(world) == 0
    assert world.bodies.tolist() == []


@pytest.mark.parametrize("way", ["own", "rotated", "loose", "hull", "climbing"])
def test_boxes_follow_bodies_for_every_realignment(way):
    world, expected = impinge.World(), []
    mesh = impinge.Mesh(*torus(12, 8))
    poses = random_poses(40, 3.0, 4)
    rings = world.insert(mesh, poses, tag=np.arange(40), realigned_by=way)
    balls = world.insert(KINDS[0], poses[::2] @ pose([1, 0, 0]), tag=np.arange(40, 60), realigned_by=way)
    for turn in range(4):
        turned = poses @ pose(rpy=[0.3 * turn, 0.1, 2.0 * turn])
        world.step(rings, turned)
        met = impinge.intersects(mesh, mesh, turned[:, None], turned)
        expected = [(int(rings[i]), int(rings[j])) for i, j in combinations(range(40), 2) if met[i, j]]
        among = [pair for pair in named(world.pairs()) if pair[1] < int(balls[0])]
        assert among == expected
        # Every vertex is inside its body's box.
        vertices = mesh.vertices @ turned[:, :3, :3].swapaxes(1, 2) + turned[:, None, :3, 3]
        bounds = world.bounds(rings)
        assert (bounds[:, 0] <= vertices.min(axis=1) + 1e-12).all()
        assert (bounds[:, 1] >= vertices.max(axis=1) - 1e-12).all()
        slack = (bounds[:, 1] - bounds[:, 0]).sum() / (vertices.max(axis=1) - vertices.min(axis=1)).sum()
        low, high = {"hull": (1, 1.0001), "climbing": (1, 1.0001), "loose": (1.15, 2)}.get(way, (1.01, 1.7))
        assert low <= slack <= high
    assert len(expected) > 20
    again = pickle.loads(pickle.dumps(world))
    step = poses @ pose(rpy=[1, 1, 1])
    for own in (world, again):
        own.step(rings, step)
    assert np.array_equal(again.bounds(rings), world.bounds(rings))
    assert np.array_equal(again.pairs(), world.pairs())


def test_restore_returns_to_the_saved_state():
    world, handles, poses, _ = filled("tree", 30)
    world.step()
    state, pairs = world.save(), world.pairs()
    moved = random_poses(30, 3.5, 5)
    there = world.step(handles, moved)
    world.remove(handles[:10])
    world.insert(KINDS[1])
    world.step()
    world.restore(state)
    assert np.array_equal(world.pairs(), pairs)
    assert np.array_equal(world.poses(handles), poses)
    again = world.step(handles, moved)
    assert np.array_equal(again.began, there.began)
    assert np.array_equal(again.ended, there.ended)
    assert again.work == there.work
    twin = impinge.World(broad_phase="tree")
    twin.restore(state)
    assert np.array_equal(twin.pairs(), pairs)


@pytest.mark.parametrize("broad", ["every", "tree", "columns", "grid"])
def test_queries_equal_loops_over_the_bodies(broad):
    world, handles, poses, rng = filled(broad, 40)
    world.insert(Shape.half_space([0, 0, 1], -3.4), kind="static", layers=2)
    world.step()
    origins, directions = rng.uniform(-6, 6, (60, 3)), rng.normal(size=(60, 3))
    first, every = world.ray_cast(origins, directions, layers=1), world.ray_cast_all(origins, directions, layers=1)
    for row in range(60):
        t = []
        for i, at in enumerate(poses):
            back = np.linalg.inv(at)
            local = back[:3, :3] @ origins[row] + back[:3, 3], back[:3, :3] @ directions[row]
            shape = KINDS[i % 4] if i % 4 != 3 else Shape.mesh(KINDS[3])
            t.append(shape.ray_cast(*local).t)
        assert first.t[row] == pytest.approx(min(t), abs=1e-6)
        if first.hit[row]:
            assert t[np.flatnonzero(handles == first.body[row])[0]] == pytest.approx(min(t), abs=1e-6)
        hits = every[row]
        assert sorted(hits.body.tolist()) == sorted(int(handles[i]) for i in range(40) if t[i] < inf)
        assert (np.diff(hits.t) >= 0).all()
    assert 0.2 < first.hit.mean() < 1
    down = world.ray_cast([9, 9, 0], [0, 0, -2])
    assert (down.hit, down.t) == (True, pytest.approx(1.7))
    assert not world.ray_cast([9, 9, 0], [0, 0, -2], reach=1.5).hit
    probe, places = Shape.sphere(0.8), random_poses(20, 4, 3)
    found = world.overlapping(probe, places, layers=1)
    for row in range(20):
        met = [impinge.intersects(probe, KINDS[i % 4], places[row], poses[i]) for i in range(40)]
        assert found[row].tolist() == handles[met].tolist()
    assert np.array_equal(world.overlapping(probe, places[3], layers=1), found[3])
    points = rng.uniform(-4, 4, (50, 3))
    at = world.at_points(points, layers=1)
    for row in range(50):
        held = [impinge.intersects(POINT, KINDS[i % 4], pose(points[row]), poses[i]) for i in range(40)]
        assert at[row].tolist() == handles[held].tolist()
    low, high = world.bounds(handles).transpose(1, 0, 2)
    corner = rng.uniform(-4, 3, (30, 3))
    boxes = world.in_boxes(corner, corner + 1, layers=1)
    for row in range(30):
        overlap = ((low <= corner[row] + 1) & (high >= corner[row])).all(axis=1)
        assert boxes[row].tolist() == handles[overlap].tolist()
    assert boxes.counts.sum() > 10
    assert np.isinf(world.bounds(world.bodies[-1])).all()


def test_refit_and_set_shape_change_the_pairs():
    flag = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    world = impinge.World()
    cloth, twin = world.insert(flag), world.insert(flag, pose([5, 0, 0]))
    pole = world.insert(Shape.capsule([0, 0, 1], [0, 0, 2], 0.1))
    assert len(world.step().began) == 0
    assert world.refit(cloth, [[0, 0, 1.5], [1, 0, 0], [0, 1, 0]]) == pytest.approx(1, abs=0.5)
    assert named(world.step().began) == [(cloth, pole)]
    world.set_shape(pole, Shape.sphere(6))
    step = world.step()
    assert named(world.pairs()) == [(cloth, pole), (twin, pole)]
    assert named(step.began) == [(twin, pole)]
    assert named(world.pairs(twin)) == [(twin, pole)]
    with pytest.raises(impinge.InputError, match="mesh"):
        world.refit(pole, np.zeros((3, 3)))
    with pytest.raises(impinge.InputError) as caught:
        world.refit(cloth, np.full((3, 3), nan))
    assert caught.value.what == "vertices"


def test_an_invalid_pose_moves_no_body():
    world = impinge.World()
    balls = world.insert(KINDS[0], pose([[0, 0, 0], [9, 0, 0]]))
    wall = world.insert(KINDS[1], kind="static")
    bad = pose([[1, 0, 0], [2, 0, 0]])
    bad[1] = np.diag([2, 1, 1, 1])
    for change in (world.step, world.set_poses):
        with pytest.raises(impinge.InputError) as caught:
            change(balls, bad)
        assert (caught.value.kind, caught.value.what, caught.value.where) == ("not-rigid", "poses", (1,))
        assert world.poses(balls)[:, 0, 3].tolist() == [0, 9]
    with pytest.raises(impinge.InputError) as caught:
        world.step([int(balls[0]), wall], np.eye(4))
    assert (caught.value.kind, caught.value.where) == ("static", (1,))
    world.set_poses(wall, pose([9, 0, 0]))
    assert [set(pair) for pair in named(world.step().began)] == [{int(balls[1]), wall}]


@pytest.mark.parametrize(
    ("kind", "what", "make"),
    [
        ("option", "broad_phase", lambda w: impinge.World(broad_phase="octree")),
        ("option", "narrow_phase", lambda w: impinge.World(narrow_phase=3)),
        ("option", "kind", lambda w: w.insert(KINDS[0], kind="heavy")),
        ("type", "shape", lambda w: w.insert("ball")),
        ("out-of-range", "layers", lambda w: w.insert(KINDS[0], layers=1 << 32)),
        ("shape", "tag", lambda w: w.insert(KINDS[0], tag=[1, 2])),
        ("out-of-range", "tag", lambda w: w.insert(KINDS[0], tag=-1)),
        ("non-finite", "pose", lambda w: w.insert(KINDS[0], np.full((4, 4), nan))),
        ("not-rigid", "pose", lambda w: w.insert(KINDS[0], np.stack([np.eye(4), np.diag([1, 1, 3, 1])]))),
        ("option", "poses", lambda w: w.step([1])),
        ("option", "bodies", lambda w: w.step(poses=np.eye(4))),
        ("dtype", "bodies", lambda w: w.step([1.5], np.eye(4))),
        ("shape", "poses", lambda w: w.step([1, 2], np.zeros((3, 4, 4)))),
        ("type", "admits", lambda w: w.set_filter(3)),
        ("type", "state", lambda w: w.restore(None)),
        ("negative", "reach", lambda w: w.ray_cast([0, 0, 0], [1, 0, 0], reach=-1)),
        ("order", "high", lambda w: w.in_boxes([0, 0, 0], [1, -1, 1])),
        ("non-finite", "points", lambda w: w.at_points([0, nan, 0])),
        ("stale", "body", lambda w: w.pairs(17)),
    ],
)
def test_errors_name_the_invalid_argument(kind, what, make):
    world = impinge.World()
    with pytest.raises(impinge.InputError) as caught:
        make(world)
    assert (caught.value.kind, caught.value.what) == (kind, what)
    assert len(world) == 0


def test_concurrent_calls_run_one_after_another():
    """Steps and queries of several threads do not deadlock."""
    world, handles, poses, _ = filled("auto", 60, narrow_phase="intersections")
    done = []

    def step(seed):
        for round_ in range(8):
            world.step(handles, random_poses(60, 3.5, 100 * seed + round_))
        done.append(seed)

    def ask():
        for _ in range(20):
            world.ray_cast(np.zeros((99, 3)), np.random.default_rng(1).normal(size=(99, 3)))
            world.pairs()
        done.append(-1)

    threads = [threading.Thread(target=step, args=(1,)), threading.Thread(target=step, args=(2,))]
    threads += [threading.Thread(target=ask) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert sorted(done) == [-1, -1, 1, 2]
    with impinge.threads(1):
        step = world.step(handles, poses)
    alone, *_ = filled("auto", 60, narrow_phase="intersections")
    alone.step()
    assert np.array_equal(world.pairs(), alone.pairs())
    assert len(step.began) > 0


def test_one_call_moves_8000_bodies():
    world = impinge.World(narrow_phase="intersections")
    grid = np.stack(np.meshgrid(*[np.arange(20)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    crates = world.insert(Shape.box([0.5, 0.5, 0.5]), pose(grid * 1.5), tag=np.arange(8000))
    assert len(world.step().began) == 0
    step = world.step(crates, pose(grid * [1.0, 1.5, 1.5]))  # neighbors along x touch
    assert len(step.began) == 19 * 400
    assert (world.tags(step.began)[:, 1] - world.tags(step.began)[:, 0] == 400).all()
    step = world.step(crates, pose(grid * 1.5))
    assert len(step.ended) == 19 * 400
    del world
    gc.collect()


def test_reports_are_sorted_by_handle_after_slots_are_reused():
    world = impinge.World()
    balls = world.insert(KINDS[0], np.stack([np.eye(4)] * 5))
    world.remove(balls[[0, 3]])
    again = [world.insert(KINDS[0]) for _ in range(2)]
    for found in (world.at_points([0, 0, 0]), world.overlapping(KINDS[0]), world.bodies):
        assert np.array_equal(found, np.sort(found))
        assert set(again) < set(found.tolist())
    began = world.step().began
    assert np.array_equal(began, began[np.lexsort(began.T[::-1])])
    assert len(began) == 10
    assert 0 not in world.bodies


def test_a_state_of_a_world_with_other_options_raises_an_error():
    world = impinge.World(narrow_phase="boxes")
    world.insert(KINDS[0])
    with pytest.raises(impinge.InputError) as raised:
        impinge.World().restore(world.save())
    assert (raised.value.kind, raised.value.what) == ("option", "state")
