"""Queries of two things that are cut into tasks by rows, without Ray: the bytes of a local call."""

import impinge
import numpy as np
import pytest
from grid_scenes import CUBE, TORUS
from impinge.cluster import _calls
from in_process_engine import cluster_of_tasks
from same_answers import error_of, same
from shapes import random_poses, torus


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
    calls = [
        lambda on: impinge.intersects(CUBE, "mesh", on=on),
        lambda on: impinge.intersects(CUBE, TORUS, None, bad, on=on),
        lambda on: impinge.intersects(CUBE, TORUS, MANY, MANY[:3], on=on),
        lambda on: impinge.intersects(CUBE, TORUS, solid="c", on=on),
        lambda on: scene.check({"b": bad}, on=on),
        lambda on: scene.check({"a": MANY, "b": MANY[:3]}, on=on),
        lambda on: impinge.within(CUBE, TORUS, -1, on=on),
    ]
    for call in calls:
        assert error_of(call, None) == error_of(call, cluster)
    assert not cluster._ray.started
    hits, status = impinge.intersects(CUBE, TORUS, None, bad, on_error="status", on=cluster)
    assert status.tolist() == [impinge.Status.NON_FINITE if row == 17 else 0 for row in range(20)]
    assert hits[17]
