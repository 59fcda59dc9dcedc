"""Queries of two things that are cut into tasks by rows, without Ray: the bytes of a local call."""

import impinge
import numpy as np
import pytest
from grid_scenes import CUBE, TORUS
from impinge.cluster import _calls
from impinge.cluster._checkpoint import Checkpoint
from in_process_engine import cluster_of_tasks
from same_answers import error_of, same
from shapes import cube, random_poses, torus


@pytest.fixture
def cluster(monkeypatch):
    return cluster_of_tasks(monkeypatch)


VERBS = {
    "intersects": impinge.intersects,
    "solid": lambda *at, **options: impinge.intersects(*at, solid="a", **options),
    "penetrates": impinge.penetrates,
    "within": lambda a, b, *at, **options: impinge.within(a, b, 0.25, *at, **options),
    "distance": impinge.distance,
    "pairs": impinge.intersecting_pairs,
    "limited pairs": lambda *at, **options: impinge.intersecting_pairs(*at, limit=5, **options),
    "curves": impinge.intersection_curves,
    "contacts": lambda a, b, *at, **options: impinge.contacts(CUBE, b, *at, **options),
    "contacts within a margin": lambda a, b, *at, **options: impinge.contacts(
        a, CUBE, *at, solid="b", margin=0.25, most_points=2, **options
    ),
    "penetration": lambda a, b, *at, **options: impinge.penetration(CUBE, CUBE, *at, **options),
    "depth": lambda a, b, *at, **options: impinge.depth(CUBE, CUBE, *at, **options),
    "deeper": lambda a, b, *at, **options: impinge.deeper(CUBE, b, 0.25, *at, **options),
}
MANY = random_poses(20, 2.0, 4)
POSES = {
    "none": (None, None),
    "one": (None, impinge.pose([0.5, 0, 0])),
    "no axis but one of length one": (None, impinge.pose([[0.5, 0, 0]])),
    "many": (MANY[0], MANY),
    "both": (MANY, MANY[::-1]),
    "table": (MANY[:5, None], MANY[:4]),
    "lists": (MANY.tolist(), np.float32(MANY[0])),
    "empty": (None, np.zeros((0, 4, 4))),
    "empty table": (np.zeros((0, 1, 4, 4)), MANY),
}


@pytest.mark.parametrize("poses", POSES.values(), ids=POSES)
@pytest.mark.parametrize("verb", VERBS.values(), ids=VERBS)
def test_every_verb_has_the_bytes_of_a_local_call(cluster, verb, poses):
    for options in ({}, {"on_error": "status"}):
        for other in (TORUS, CUBE):
            answer = verb(TORUS, other, *poses, on=cluster, **options)
            assert same(answer, verb(TORUS, other, *poses, **options))
    assert cluster.work.tasks == (7 if len(cluster._ray.started) > 10 else 1)


def test_rows_of_every_kind_are_among_the_compared_answers():
    contacts = impinge.contacts(CUBE, TORUS, *POSES["many"])
    assert 0.2 < (contacts.counts > 0).mean() < 0.9
    curves = impinge.intersection_curves(TORUS, TORUS, *POSES["table"])
    assert [len(curves), len(curves[0])] == [5, 4]
    assert {len(curve) > 0 for row in curves for curve in row} == {False, True}
    depth = impinge.depth(CUBE, CUBE, *POSES["many"])
    assert 0.1 < (depth.upper > 0).mean() < 0.9
    assert {*impinge.deeper(CUBE, TORUS, 0.125, *POSES["many"]).tolist()} == {False, True}


STARTS, ENDS = random_poses(20, 2.0, 6), random_poses(20, 2.0, 7)
RNG = np.random.default_rng(8)
GRID = impinge.pose(RNG.integers(-3, 4, (20, 3)) / 2)
ANGULAR, PIVOTS = RNG.integers(-2, 3, (4, 3)) / 2, RNG.integers(-1, 2, (5, 1, 3)) / 2
SCREW = impinge.Motion.screw(GRID[:5, None], [0.5, 0, 0], ANGULAR, PIVOTS)
MOTIONS = {
    "at rest": (None, None),
    "one": (None, impinge.Motion(STARTS[0], ENDS[0])),
    "no axis but one of length one": (impinge.Motion(GRID[:1], ENDS[0]), None),
    "many": (impinge.Motion(GRID[0], None), impinge.Motion(STARTS, ENDS)),
    "grid": (impinge.Motion(GRID, impinge.pose([1, 0, 0])), impinge.Motion(None, GRID[::-1])),
    "both": (impinge.Motion(STARTS, ENDS), impinge.Motion.screw(None, RNG.normal(size=(20, 3)), [0, 0, 9.5])),
    "table": (impinge.Motion(STARTS[:5, None], ENDS[:4]), SCREW),
    "screw without a pivot": (
        impinge.Motion.screw(STARTS[:4], [1, 0, 0], [0, 0, 3]),
        impinge.Motion(ENDS[:5, None], None),
    ),
    "empty": (None, impinge.Motion(np.zeros((0, 4, 4)), None)),
    "empty table": (impinge.Motion(np.zeros((0, 1, 4, 4)), None), impinge.Motion(STARTS, ENDS)),
}
SWEEPS = {
    "surfaces": {},
    "solids": {"solid": True},
    "a clearance": {"solid": "b", "clearance": 0.25},
    "touch ignored": {"ignore_touch": True},
}


@pytest.mark.parametrize("motions", MOTIONS.values(), ids=MOTIONS)
@pytest.mark.parametrize("options", SWEEPS.values(), ids=SWEEPS)
def test_sweeps_have_the_bytes_of_a_local_call(cluster, motions, options):
    ball, hall, hits = impinge.Shape.sphere(0.5), impinge.Mesh(*cube(-3, 3)), []
    for a, b in [(CUBE, hall), (CUBE, impinge.Mesh(*torus(8, 6))), (ball, CUBE), (ball, ball)]:
        impact = impinge.time_of_impact(a, b, *motions, on=cluster, **options)
        assert same(impact, impinge.time_of_impact(a, b, *motions, **options))
        hits += np.ravel(impact.hit).tolist()
    assert cluster.work.tasks == (7 if len(cluster._ray.started) > 4 else 1)
    assert len(hits) < 80 or 0.05 < np.mean(hits) < 0.95


def test_solids_of_sweeps_count_on_a_cluster(cluster):
    hall, motion = impinge.Mesh(*cube(-3, 3)), MOTIONS["grid"][0]
    for solid in (False, True, "a", "b"):
        impact = impinge.time_of_impact(CUBE, hall, motion, solid=solid, on=cluster)
        assert impact.hit.all() == (solid in (True, "b"))


def test_ragged_answers_and_sweeps_are_resumed(cluster, tmp_path):
    cluster._checkpoint = Checkpoint(str(tmp_path / "run.ndjson"))
    calls = [
        lambda on: impinge.contacts(CUBE, TORUS, None, MANY, on=on),
        lambda on: impinge.contacts(CUBE, TORUS, None, MANY, margin=0.5, on=on),
        lambda on: impinge.intersection_curves(CUBE, TORUS, None, MANY, on_error="status", on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, *MOTIONS["table"], on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, MOTIONS["many"][1], on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, None, MOTIONS["many"][1], on=on),
    ]
    answers = [call(None) for call in calls]
    for resumed in (0, 7):
        for call, answer in zip(calls, answers, strict=True):
            assert same(call(cluster), answer)
            assert (cluster.work.tasks, cluster.work.resumed) == (7, resumed)
    cluster._checkpoint.close()


def test_the_search_of_one_pair_of_meshes_is_divided(cluster, monkeypatch):
    monkeypatch.setattr(_calls, "_FACES_OF_SHARE", 1 << 7)
    for a, b in [(TORUS, TORUS), (CUBE, TORUS), (TORUS, impinge.Mesh(*torus(20, 12)))]:
        for pose in (None, impinge.pose([0.5, 0, 0]), impinge.pose([9, 0, 0])):
            pairs = impinge.intersecting_pairs(a, b, None, pose, on=cluster)
            assert same(pairs, impinge.intersecting_pairs(a, b, None, pose))
            assert cluster.work.tasks == 7
    pile = impinge.Mesh(CUBE.vertices, np.tile(CUBE.faces, (30, 1)))
    assert same(impinge.intersecting_pairs(pile, CUBE, on=cluster), impinge.intersecting_pairs(pile, CUBE))
    assert cluster.work.tasks == 2
    with pytest.raises(impinge.InputError, match="must be a mesh"):
        impinge.intersecting_pairs(TORUS, impinge.Shape.sphere(1), on=cluster)


def test_shapes_travel_too(cluster):
    parts = [(impinge.Shape.sphere(0.5), None), (TORUS, impinge.pose([1, 0, 0]))]
    compound, ball = impinge.Shape.compound(parts), impinge.Shape.sphere(0.25)
    for a, b in [(compound, TORUS), (ball, compound), (ball, ball)]:
        assert same(impinge.intersects(a, b, None, MANY, on=cluster), impinge.intersects(a, b, None, MANY))
        assert same(impinge.penetration(a, b, None, MANY[:7], on=cluster), impinge.penetration(a, b, None, MANY[:7]))


def test_invalid_arguments_raise_the_errors_of_a_local_call(cluster):
    bad = MANY.copy()
    bad[17, 1, 2] = np.nan
    scene = impinge.Scene({"a": CUBE, "b": TORUS})
    ball, still, moving = impinge.Shape.sphere(1), impinge.Motion(None, None), impinge.Motion(MANY, MANY)
    scaled = MANY.copy()
    scaled[3, :3, :3] *= 2
    grown = impinge.Motion(scaled, scaled)  # valid for a mesh
    calls = [
        lambda on: impinge.intersects(CUBE, "mesh", on=on),
        lambda on: impinge.intersects(CUBE, TORUS, None, bad, on=on),
        lambda on: impinge.intersects(CUBE, TORUS, MANY, MANY[:3], on=on),
        lambda on: impinge.intersects(CUBE, TORUS, solid="c", on=on),
        lambda on: scene.check({"b": bad}, on=on),
        lambda on: scene.check({"a": MANY, "b": MANY[:3]}, on=on),
        lambda on: impinge.within(CUBE, TORUS, -1, on=on),
        lambda on: impinge.contacts(CUBE, TORUS, None, bad, on=on),
        lambda on: impinge.contacts(CUBE, TORUS, margin=-1, on=on),
        lambda on: impinge.contacts(CUBE, TORUS, most_points=0, on=on),
        lambda on: impinge.depth(CUBE, None, on=on),
        lambda on: impinge.deeper(CUBE, TORUS, np.nan, on=on),
        lambda on: impinge.intersection_curves(CUBE, TORUS, bad, on=on),
        lambda on: impinge.time_of_impact(CUBE, 5, None, MANY, on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, None, MANY, on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, moving, MANY[0], on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, moving, impinge.Motion(MANY[:3], None), on=on),
        lambda on: impinge.time_of_impact(ball, TORUS, grown, moving, on=on),
        lambda on: impinge.time_of_impact(TORUS, ball, still, grown, on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, still, still, solid="c", on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, progress="yes", on=on),
        lambda on: impinge.time_of_impact(CUBE, TORUS, clearance=-1, on=on),
    ]
    for call in calls:
        assert error_of(call, None) == error_of(call, cluster)
    assert not cluster._ray.started
    assert error_of(lambda on: impinge.intersection_curves(CUBE, ball, None, MANY, on=on), cluster) == error_of(
        lambda on: impinge.intersection_curves(CUBE, ball, None, MANY, on=on), None
    )
    assert same(impinge.time_of_impact(CUBE, TORUS, grown, on=cluster), impinge.time_of_impact(CUBE, TORUS, grown))
    hits, status = impinge.intersects(CUBE, TORUS, None, bad, on_error="status", on=cluster)
    assert status.tolist() == [impinge.Status.NON_FINITE if row == 17 else 0 for row in range(20)]
    assert hits[17]
