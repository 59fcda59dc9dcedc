"""Scenes: every pair of every configuration equals a loop over single queries."""

from itertools import combinations

import impinge
import numpy as np
import pytest
from shapes import cube, random_poses, torus

CUBE, TORUS = impinge.Mesh(*cube()), impinge.Mesh(*torus())
PARTS = {"base": TORUS, "arm": CUBE, "hand": CUBE, "tool": TORUS, "table": CUBE}


def loop(scene, poses, at):
    parts = scene.parts
    found = []
    for a, b in scene.pairs:
        pose = [np.broadcast_to(poses[n], (*LEAD, 4, 4))[at] if n in poses else None for n in (a, b)]
        if impinge.intersects(parts[a], parts[b], *pose):
            found.append((a, b))
    return found


LEAD = (6, 7)
TWO, THREE = random_poses(2, 1, 0), random_poses(3, 1, 0)
POSES = {
    "arm": random_poses(6, 2.2, 1)[:, None],
    "hand": random_poses(7, 2.2, 2),
    "tool": random_poses(42, 2.5, 3).reshape(6, 7, 4, 4),
    "table": impinge.pose([0, 0, -3]),
}


def test_a_check_equals_a_loop_over_single_queries():
    scene = impinge.Scene(PARTS, ignored=[("hand", "arm"), ("tool", "hand")])
    assert len(scene.pairs) == 8
    assert ("arm", "hand") not in scene.pairs
    every = scene.check(POSES, stop="all")
    first = scene.check(POSES)
    assert every.meets.shape == (*LEAD, 8)
    assert first.meets is None
    counts = np.zeros(LEAD, int)
    for at in np.ndindex(LEAD):
        names = loop(scene, POSES, at)
        counts[at] = len(names)
        assert every.names(at) == names
        assert first.names(at) == names[:1]
        assert every.intersects[at] == first.intersects[at] == bool(names)
        assert every.first[at] == first.first[at] == (scene.pairs.index(names[0]) if names else -1)
    assert 0.2 < (counts > 0).mean() < 0.98
    assert every.worst == np.unravel_index(counts.argmax(), LEAD)
    with impinge.threads(1):
        assert np.array_equal(scene.check(POSES, stop="all").meets, every.meets)
    with pytest.raises(impinge.InputError, match="stop"):
        _ = first.worst


def test_a_report_keeps_the_pairs_of_its_check():
    scene = impinge.Scene({"a": CUBE, "b": CUBE, "c": CUBE}, ignored=[("b", "b")])
    before = scene.check(stop="all")
    other = scene.repaired()[0]
    scene.ignore("b", "a")
    other.ignore("b", "c")
    assert before.names() == list(before.pairs) == [("a", "b"), ("a", "c"), ("b", "c")]
    assert scene.check(stop="all").names() == list(scene.pairs) == [("a", "c"), ("b", "c")]
    assert other.check(stop="all").names() == list(other.pairs) == [("a", "b"), ("a", "c")]


def test_a_single_configuration_has_no_axes():
    scene = impinge.Scene({"a": CUBE, "b": CUBE, "c": TORUS})
    report = scene.check({"b": impinge.pose([1, 0, 0]), "c": impinge.pose([9, 0, 0])}, stop="all")
    assert report.intersects is True
    assert report.names() == [("a", "b")]
    assert report.worst == ()
    assert scene.check({"b": impinge.pose([5, 0, 0]), "c": impinge.pose([9, 0, 0])}).names() == []


def test_scenes_without_pairs_or_configurations_find_nothing():
    for parts in ({}, {"alone": CUBE}):
        for stop in ("first", "all"):
            report = impinge.Scene(parts).check({name: random_poses(3, 1, 0) for name in parts}, stop=stop)
            assert not np.any(report.intersects)
            assert np.shape(report.intersects) == ((3,) if parts else ())
    empty = impinge.Scene({"a": CUBE, "b": CUBE}).check({"a": np.zeros((0, 4, 4))}, stop="all")
    assert empty.meets.shape == (0, 1)
    with pytest.raises(impinge.InputError):
        _ = empty.worst


def test_a_part_with_an_invalid_pose_intersects_all_near_parts():
    scene = impinge.Scene({"a": CUBE, "b": CUBE, "c": CUBE})
    poses = {"b": impinge.pose([[5, 0, 0]] * 3), "c": impinge.pose([0, 9, 0])}
    poses["b"][1, 0, 0] = np.nan
    with pytest.raises(impinge.InputError) as caught:
        scene.check(poses)
    assert (caught.value.what, caught.value.where) == ('poses["b"]', (1, 0, 0))
    report = scene.check(poses, stop="all", on_error="status")
    assert report.status.tolist() == [0, impinge.Status.NON_FINITE, 0]
    assert [report.names(i) for i in range(3)] == [[], [("a", "b"), ("b", "c")], []]
    alone = scene.check({"b": poses["b"][1], "c": poses["c"]}, on_error="status")
    assert (alone.first, alone.status) == (0, 1)


def test_every_question_on_shapes_and_meshes_equals_a_loop():
    ball, floor = impinge.Shape.sphere(0.5), impinge.Shape.half_space([0, 0, 1], -1.5)
    parts = {
        "ring": TORUS,
        "ball": ball,
        "block": CUBE,
        "floor": floor,
        "rod": impinge.Shape.capsule([0, 0, 0], [1, 0, 0], 0.25),
    }
    poses = {
        name: impinge.pose(np.round(random_poses(30, 2.0, seed)[:, :3, 3] * 2) / 2) for seed, name in enumerate(parts)
    }
    del poses["floor"]
    scene = impinge.Scene(parts, ignored=[("block", "ring")], solid=True)

    def asked(question, a, b):
        at = (parts[a], parts[b], poses.get(a), poses.get(b))
        if question == "penetrates":
            return impinge.penetrates(*at)
        if question == "within":
            return impinge.within(at[0], at[1], 0.25, at[2], at[3], solid=True)
        return impinge.intersects(*at, solid=True)

    for question in ("intersects", "penetrates", "within"):
        clearance = 0.25 if question == "within" else None
        every = scene.check(poses, question=question, clearance=clearance, stop="all")
        meets = np.stack([asked(question, a, b) for a, b in scene.pairs], axis=-1)
        assert np.array_equal(every.meets, meets)
        first = scene.check(poses, question=question, clearance=clearance)
        assert np.array_equal(first.first, np.where(meets.any(axis=-1), meets.argmax(axis=-1), -1))
        assert 0.02 < meets.mean() < 0.9
    with pytest.raises(impinge.InputError, match="clearance"):
        scene.check(question="within")
    with pytest.raises(impinge.InputError, match="question"):
        scene.check(question="touches")


@pytest.mark.parametrize(
    ("what", "make"),
    [
        ("parts", lambda: impinge.Scene({"a": cube()})),
        ("parts", lambda: impinge.Scene({1: CUBE})),
        ("ignored", lambda: impinge.Scene({"a": CUBE}, ignored=[("a", "b")])),
        ("poses", lambda: impinge.Scene({"a": CUBE}).check({"b": np.eye(4)})),
        ("stop", lambda: impinge.Scene({"a": CUBE}).check(stop="last")),
        ('poses["b"]', lambda: impinge.Scene({"a": CUBE, "b": CUBE}).check({"a": TWO, "b": THREE})),
    ],
)
def test_errors_name_the_invalid_argument(what, make):
    with pytest.raises(impinge.InputError) as caught:
        make()
    assert caught.value.what == what


def test_pairs_are_all_combinations_of_parts():
    assert impinge.Scene(PARTS).pairs == tuple(combinations(PARTS, 2))
