"""Partitions of space: every kind against brute force, with ties and with boxes that change."""

import copy
import pickle
import threading

import impinge
import numpy as np
import pytest
from impinge import partition

SPACE = [[0, 0, 0], [16, 16, 16]]

DYNAMIC = {
    "box tree": partition.BoxTree,
    "box tree with a margin": lambda *boxes: partition.BoxTree(*boxes, margin=0.25),
    "uniform grid": lambda *boxes: partition.UniformGrid(SPACE, 2, *boxes),
    "hashed grid": lambda *boxes: partition.HashedGrid(2.0, *boxes),
    "hierarchical grid": lambda *boxes: partition.HierarchicalGrid(1, *boxes),
    "octree": lambda *boxes: partition.Octree(SPACE, *boxes),
    "loose octree": lambda *boxes: partition.LooseOctree(SPACE, *boxes),
    "one axis": lambda *boxes: partition.SweepOneAxis("y", *boxes),
    "three axes": partition.SweepThreeAxes,
}
KINDS = DYNAMIC | {"k-d tree": partition.KdTree, "BSP tree": partition.BspTree}

every_kind = pytest.mark.parametrize("made", KINDS.values(), ids=KINDS)
every_dynamic_kind = pytest.mark.parametrize("made", DYNAMIC.values(), ids=DYNAMIC)


def boxes_with_ties(rng, count):
    """Returns boxes on a grid: a few points, a few huge boxes, and many that touch."""
    low = rng.integers(0, 16, (count, 3)).astype(float)
    size = rng.integers(0, 3, (count, 3)) * rng.choice([0, 0.5, 1, 1, 8], (count, 1))
    return low, low + size


def overlap(low, high, other_low, other_high):
    """Returns whether each of n boxes overlaps each of m boxes, (n, m)."""
    return ((low[:, None] <= other_high) & (other_low <= high[:, None])).all(axis=2)


def overlapping_pairs(low, high):
    first, second = np.nonzero(np.triu(overlap(low, high, low, high), 1))
    return np.column_stack([first, second])


@every_kind
def test_pairs_equal_brute_force(made):
    rng = np.random.default_rng(7)
    low, high = boxes_with_ties(rng, 150)
    other_low, other_high = boxes_with_ties(rng, 40)
    held = made(low, high)
    assert len(held) == 150
    expected = overlapping_pairs(low, high)
    assert 300 < len(expected) < 6000
    assert np.array_equal(held.pairs(), expected)
    assert np.array_equal(partition.pairs(low, high), expected)
    across = np.argwhere(overlap(low, high, other_low, other_high))
    for other in (partition.BoxTree(other_low, other_high), made(other_low, other_high)):
        assert np.array_equal(held.pairs_with(other), across)


@every_kind
def test_overlapping_boxes_and_points_equal_brute_force(made):
    rng = np.random.default_rng(8)
    low, high = boxes_with_ties(rng, 120)
    held = made(low, high)
    asked_low, asked_high = boxes_with_ties(rng, 60)
    found = held.overlapping(asked_low, asked_high)
    expected = overlap(asked_low, asked_high, low, high)
    assert found.shape == (60,)
    assert [row.tolist() for row in found] == [np.flatnonzero(row).tolist() for row in expected]
    assert expected.any(axis=1).sum() > 30
    points = rng.integers(0, 33, (3, 20, 3)) / 2
    at = held.overlapping(points)
    inside = overlap(points.reshape(-1, 3), points.reshape(-1, 3), low, high)
    assert at.shape == (3, 20)
    assert np.array_equal(at.counts.ravel(), inside.sum(axis=1))
    assert np.array_equal(held.overlapping(points[1, 4]), at[1, 4])
    with impinge.threads(1):
        alone = held.overlapping(points)
    assert np.array_equal(alone.keys, at.keys)


@every_kind
def test_nearest_boxes_equal_brute_force(made):
    rng = np.random.default_rng(9)
    low, high = boxes_with_ties(rng, 90)
    points = rng.integers(-4, 40, (40, 3)) / 2
    gaps = np.maximum(np.maximum(low - points[:, None], points[:, None] - high), 0)
    squared = (gaps**2).sum(axis=2)
    near = made(low, high).nearest(points, 5)
    expected = np.lexsort((np.broadcast_to(np.arange(90), squared.shape), squared))[:, :5]
    assert np.array_equal(near.key, expected)
    assert np.array_equal(near.distance, np.sqrt(np.take_along_axis(squared, expected, axis=1)))
    few = made(low[:2], high[:2]).nearest(points[0], 3)
    assert few.key.shape == (3,)
    assert few.key[2] == -1
    assert few.distance[2] == np.inf
    assert made(low, high).nearest(points, 0).key.shape == (40, 0)


@every_kind
def test_rays_enter_the_boxes_of_the_slab_test(made):
    rng = np.random.default_rng(10)
    low, high = boxes_with_ties(rng, 200)
    held = made(low, high)
    origins = rng.integers(-6, 24, (200, 3)).astype(float)
    directions = rng.integers(-2, 3, (200, 3)).astype(float)
    directions[~directions.any(axis=1)] = [0, 0, 1]
    reach = 6.0
    hits = held.ray_cast_all(origins, directions, reach=reach)
    first = held.ray_cast(origins, directions, reach=reach)
    entered = 0
    for row, (origin, direction) in enumerate(zip(origins, directions, strict=True)):
        # Integers divided by 1 or 2: no division is rounded.
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (low - origin) / direction, (high - origin) / direction
        stands = (low <= origin) & (origin <= high)
        still = direction == 0
        near = np.where(still, np.where(stands, 0, np.inf), np.minimum(a, b)).max(axis=1, initial=0)
        far = np.where(still, np.inf, np.maximum(a, b)).min(axis=1)
        met = np.flatnonzero((near <= far) & (near <= reach))
        order = met[np.lexsort((met, near[met]))]
        own = hits[row]
        assert sorted(own.key.tolist()) == met.tolist()
        assert (own.t <= near[own.key]).all()
        assert np.allclose(own.t, near[own.key], rtol=2.0**-49, atol=0)
        assert (np.diff(own.t) >= 0).all()
        assert first.key[row] == (own.key[0] if len(met) else -1)
        assert np.isclose(first.t[row], near[order[0]] if len(met) else np.inf, rtol=2.0**-49, atol=0)
        entered += len(met)
    assert entered > 200
    single = held.ray_cast(origins[0], directions[0], reach=reach)
    assert (single.key, single.t) == (first.key[0], first.t[0])
    assert np.array_equal(held.ray_cast_all(origins[0], directions[0], reach=reach).key, hits[0].key)


@every_dynamic_kind
def test_steps_report_the_changes_of_brute_force(made):
    rng = np.random.default_rng(11)
    low, high = boxes_with_ties(rng, 60)
    held = made(low, high)
    own = {key: (low[key], high[key]) for key in range(60)}
    before = {tuple(pair) for pair in overlapping_pairs(low, high)}
    began = ended = 0
    for _ in range(60):
        removed = rng.choice(list(own), 2, replace=False)
        keys = np.setdiff1d(rng.integers(0, 80, 12), removed)
        low, high = boxes_with_ties(rng, len(keys))
        if rng.random() < 0.2:
            low[:, 0], high[:, 0] = low[:, 0] + 1e6, high[:, 0] + 1e6
        changes = held.step(keys, low, high, removed=removed)
        own |= {int(key): (low[row], high[row]) for row, key in enumerate(keys)}
        for key in removed:
            del own[int(key)]
        there = np.array(sorted(own))
        low, high = (np.array([own[key][end] for key in sorted(own)]) for end in (0, 1))
        now = {tuple(pair) for pair in there[overlapping_pairs(low, high)].tolist()}
        assert [tuple(pair) for pair in changes.began.tolist()] == sorted(now - before)
        assert [tuple(pair) for pair in changes.ended.tolist()] == sorted(before - now)
        assert [tuple(pair) for pair in held.pairs().tolist()] == sorted(now)
        assert np.array_equal(held.keys, there)
        assert np.array_equal(held.boxes(), np.stack([low, high], axis=1))
        began, ended, before = began + len(changes.began), ended + len(changes.ended), now
    assert began > 500
    assert ended > 500


@every_dynamic_kind
def test_copies_are_independent(made):
    held = made([[0, 0, 0], [4, 0, 0]], [[1, 1, 1], [5, 1, 1]])
    other, third = copy.copy(held), copy.deepcopy(held)
    held.step([1], [[1, 0, 0]], [[2, 1, 1]])
    assert [len(each.pairs()) for each in (held, other, third)] == [1, 0, 0]
    other.step([], [], removed=[0, 1])
    assert [len(each) for each in (held, other, third)] == [2, 0, 2]
    assert other.bounds is None
    around = third.bounds
    assert (around[0] <= 0).all()
    assert (around[1] >= [5, 1, 1]).all()
    assert (np.abs(around) <= 6).all()


def test_each_kind_reports_its_cells():
    assert {name: made([[0.0, 0, 0]]).cells for name, made in KINDS.items()} == {
        "box tree": "volumes",
        "box tree with a margin": "volumes",
        "uniform grid": "disjoint",
        "hashed grid": "disjoint",
        "hierarchical grid": "disjoint",
        "octree": "disjoint",
        "loose octree": "loose",
        "one axis": "order",
        "three axes": "order",
        "k-d tree": "disjoint",
        "BSP tree": "disjoint",
    }


@every_kind
def test_an_empty_partition_finds_nothing(made):
    held = made(np.zeros((0, 3)), np.zeros((0, 3)))
    assert (len(held), held.bounds, len(held.pairs())) == (0, None, 0)
    assert held.ray_cast([0, 0, 0], [1, 0, 0]).key == -1
    assert held.nearest([0, 0, 0]).key.tolist() == [-1]
    assert len(held.overlapping([0, 0, 0], [1, 1, 1])) == 0
    assert partition.pairs(np.zeros((0, 3))).shape == (0, 2)


def fault(call):
    with pytest.raises(impinge.InputError) as raised:
        call()
    return raised.value.kind, raised.value.what, raised.value.where


def test_errors_name_the_invalid_argument():
    low, high = [[0, 0, 0], [1, 1, 1]], [[1, 1, 1], [2, 2, 0.5]]
    assert fault(lambda: partition.BoxTree(low, high)) == ("order", "high", (1,))
    assert fault(lambda: partition.pairs([[0, 0, 0], [0, np.nan, 0]])) == ("non-finite", "low", (1,))
    assert fault(lambda: partition.KdTree([[0, 0, 2.0**320]])) == ("out-of-range", "low", (0,))
    assert fault(lambda: partition.KdTree([[0, 0]]))[:2] == ("shape", "low")
    assert fault(lambda: partition.HashedGrid(0))[:2] == ("negative", "cell")
    assert fault(lambda: partition.HashedGrid(np.nan))[:2] == ("non-finite", "cell")
    assert fault(lambda: partition.UniformGrid(SPACE, 1e-3))[:2] == ("out-of-range", "cell")
    assert fault(lambda: partition.UniformGrid([0, 0, 0], 1))[:2] == ("shape", "space")
    assert fault(lambda: partition.Octree([[0, 0, 0], [-1, 1, 1]]))[0] == "order"
    assert fault(lambda: partition.SweepOneAxis("w"))[:2] == ("option", "axis")
    assert fault(lambda: partition.BoxTree(margin=-1))[:2] == ("negative", "margin")
    tree = partition.BoxTree([[0, 0, 0]], [[1, 1, 1]])
    assert fault(lambda: tree.boxes([0, 7])) == ("unknown-key", "keys", (1,))
    assert fault(lambda: tree.step([0], [[5, 5, 5]], removed=[3])) == ("unknown-key", "removed", (0,))
    assert fault(lambda: tree.step([1, 2**31], [[5, 5, 5]] * 2)) == ("out-of-range", "keys", (1,))
    assert fault(lambda: tree.step([0, -1], [[5, 5, 5]] * 2)) == ("out-of-range", "keys", (1,))
    assert fault(lambda: tree.step([0.5], [[5, 5, 5]]))[:2] == ("dtype", "keys")
    assert fault(lambda: tree.step([0, 1], [[5, 5, 5]]))[:2] == ("shape", "low")
    assert fault(lambda: tree.ray_cast([0, 0, 0], [0, 0, 0]))[:2] == ("zero-direction", "directions")
    assert fault(lambda: tree.ray_cast([0, 0, 0], [0, 0, 1], reach=-1))[:2] == ("negative", "reach")
    assert fault(lambda: tree.nearest([0, 0, 0], -1))[:2] == ("negative", "count")
    assert tree.boxes().tolist() == [[[0, 0, 0], [1, 1, 1]]], "nothing was moved"


def test_sparse_keys_raise_an_error():
    tree = partition.BoxTree()
    tree.step([2**20 - 1], [[0, 0, 0]])
    assert tree.keys.tolist() == [2**20 - 1]
    assert fault(lambda: tree.step([2**20], [[0, 0, 0]]))[0] == "out-of-range"
    many = np.arange(2**17)
    tree.step(many, np.zeros((2**17, 3)) + many[:, None])
    tree.step([2**20 + 5], [[-1, -1, -1]])
    tree.step([], [], removed=many)
    tree.step([2**20 + 5], [[-2, -2, -2]])
    assert tree.boxes([2**20 + 5])[0, 0].tolist() == [-2, -2, -2]
    again = pickle.loads(pickle.dumps(tree))
    again.step([2**20 + 5], [[-3, -3, -3]])
    assert again.keys.tolist() == tree.keys.tolist() == [2**20 - 1, 2**20 + 5]


def test_a_query_uses_the_boxes_at_its_start():
    rng = np.random.default_rng(12)
    low = rng.uniform(0, 30, (2000, 3))
    tree = partition.HashedGrid(2.0, low, low + 1)
    expected, seen, ends = len(tree.pairs()), [], threading.Event()

    def ask():
        while not ends.is_set():
            seen.append(len(tree.pairs()))

    asking = [threading.Thread(target=ask) for _ in range(3)]
    for thread in asking:
        thread.start()
    try:
        for turn in range(40):
            at = low + 1000.0 * (turn % 2)
            tree.step(range(2000), at, at + 1)
    finally:
        ends.set()
        for thread in asking:
            thread.join()
    assert expected > 400
    assert len(seen) > 3
    # All boxes move together, so few pairs change, and only by rounding of the sums.
    assert all(abs(count - expected) < 5 for count in seen)
