"""Scenes whose checks are cut into tasks, without Ray: the bytes of a local call."""

import weakref

import impinge
import numpy as np
import pytest
from grid_scenes import CUBE, TORUS, grid_scene, row_of
from impinge.cluster import _parcels, _scenes
from in_process_engine import Engine, cluster_of_tasks
from same_answers import same_reports
from shapes import cube, random_poses, torus

MANY = random_poses(20, 2.0, 4)


@pytest.fixture
def cluster(monkeypatch):
    return cluster_of_tasks(monkeypatch)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("question", ["intersects", "penetrates", "within"])
def test_pairs_of_a_scene_have_the_bytes_of_a_local_check(cluster, question, seed):
    scene, poses = grid_scene(120, seed)
    clearance = 0.5 if question == "within" else None
    options = {"question": question, "clearance": clearance, "stop": "all"}
    report = scene.check(poses, on=cluster, **options)
    assert cluster.work.tasks > 10
    assert len(cluster._ray.started) == cluster.work.tasks
    assert same_reports(report, scene.check(poses, **options))
    assert len(report.names()) > 50
    poses["part 7"] = np.full((4, 4), np.nan)
    for more in ({"on_error": "status"}, {"on_error": "status", "stop": "first"}):
        assert same_reports(scene.check(poses, on=cluster, **{**options, **more}), scene.check(poses, **options | more))


@pytest.mark.parametrize("stop", ["first", "all"])
def test_configurations_of_a_scene_have_the_bytes_of_a_local_check(cluster, stop):
    scene, poses = grid_scene(30, 1)
    poses["part 3"] = MANY[:5, None].copy()
    poses["part 4"] = MANY[:4]
    report = scene.check(poses, stop=stop, on=cluster)
    assert cluster.work.tasks == 7
    assert same_reports(report, scene.check(poses, stop=stop))
    assert report.intersects.shape == (5, 4)
    poses["part 3"][2, 0, 1, 1] = np.inf
    with_status = {"stop": stop, "on_error": "status"}
    assert same_reports(scene.check(poses, on=cluster, **with_status), scene.check(poses, **with_status))


def test_ignored_pairs_are_ignored_in_each_configuration(cluster):
    scene = impinge.Scene({"a": CUBE, "b": CUBE, "c": TORUS}, ignored=[("a", "b"), ("c", "a")])
    poses = {"c": impinge.pose(np.linspace([0, 0, 0], [9, 0, 0], 40))}
    report = scene.check(poses, stop="all", on=cluster)
    assert cluster.work.tasks == 7
    assert same_reports(report, scene.check(poses, stop="all"))
    assert report.names(0) == [("b", "c")]
    assert 0.1 < report.intersects.mean() < 0.9


def test_scenes_without_parts_or_configurations_are_answered(cluster):
    for parts in ({}, {"a": CUBE}, {"a": CUBE, "b": CUBE}):
        scene = impinge.Scene(parts)
        for stop in ("first", "all"):
            for lead in ((0,), (1,), ()):
                poses = {name: np.broadcast_to(np.eye(4), (*lead, 4, 4)) for name in parts}
                assert same_reports(scene.check(poses, stop=stop, on=cluster), scene.check(poses, stop=stop))


def test_clashes_have_the_bytes_of_a_local_call(cluster):
    rng = np.random.default_rng(3)
    kinds = [CUBE, TORUS, impinge.Shape.sphere(0.75), impinge.Mesh(CUBE.vertices, CUBE.faces[1:])]
    parts = {f"part {at}": kinds[at % 4] for at in range(60)}
    poses = {name: impinge.pose(place) for name, place in zip(parts, rng.integers(-6, 7, (60, 3)) / 2, strict=True)}
    few = dict(list(parts.items())[:8])  # in one place
    rooms = {"a": impinge.Scene(parts, poses=poses, ignored=[("part 0", "part 1")]), "b": impinge.Scene(few)}
    rules = 'tolerance = 0.25\n[[rule]]\na = "*"\nb = "*"\nclearance = 0.5\n'
    listed = {"tolerance": 0.01, "contacts": True, "volume": True}
    for options in (listed, {"clearance": 0.5, "between": True}, {"rules": rules}):
        local = impinge.clash(rooms, **options)
        shared = impinge.clash(rooms, on=cluster, **options)
        assert shared.to_json() == local.to_json()
        assert shared.to_csv() == local.to_csv()
        assert len(local) > 50
        assert cluster.work.tasks > 3
    kinds = {each.kind for each in impinge.clash(rooms, tolerance=0.01, clearance=0.5, contacts=True)}
    assert kinds >= {"clash", "contact", "clearance"}


def test_a_mesh_that_is_refitted_during_a_call_counts_as_it_was(cluster, monkeypatch):
    mesh = impinge.Mesh(*cube())
    scene = impinge.Scene({"a": mesh, "b": TORUS})
    expected = scene.check(stop="all")
    assert expected.intersects
    packed = _parcels.Parcels.packed

    def refit(self, number):
        mesh.refit(CUBE.vertices + 9)
        return packed(self, number)

    monkeypatch.setattr(_parcels.Parcels, "packed", refit)
    assert same_reports(scene.check(stop="all", on=cluster), expected)
    assert not scene.check(stop="all", on=cluster).intersects


def test_a_part_that_is_used_often_is_sent_once(cluster, monkeypatch):
    monkeypatch.setattr(_parcels, "_PARCEL_BYTES", 1 << 24)
    scene, poses = row_of([TORUS] * 40)
    report = scene.check(poses, stop="all", on=cluster)
    assert cluster.work.tasks > 5
    assert cluster.work.bytes_put < len(TORUS.to_baked()) + 64
    assert len(report.names()) == 39


def test_parts_are_kept_only_while_tasks_need_them(cluster, monkeypatch):
    put = Engine.put
    parcels, alive = [], []

    def watched(self, value):
        stored = np.frombuffer(put(self, value), np.uint8)
        parcels.append(weakref.ref(stored))
        alive.append(sum(parcel() is not None for parcel in parcels))
        return stored

    monkeypatch.setattr(Engine, "put", watched)
    scene, poses = row_of([impinge.Mesh(*torus(40, 20 + at % 3)) for at in range(60)])
    report = scene.check(poses, stop="all", on=cluster)
    assert len(report.names()) == 59
    assert len(alive) == 60
    assert max(alive) < 30


def test_tasks_of_pairs_are_bounded_and_close_together():
    scene, poses = grid_scene(400, 2)
    parts = [(name, part, False, poses.get(name)) for name, part in scene.parts.items()]
    ignored = np.zeros((0, 2), np.uint32)
    axes, (status, pairs, boxes) = impinge._impinge.scene_candidates(parts, ignored, ("intersects", 0.0), "raise")
    assert (axes, status) == ([], 0)
    ranks = _scenes.ranks(boxes)
    assert sorted(ranks.tolist()) == list(range(400))
    call = _scenes.ScenePairs(parts, ("intersects", 0.0), "raise", axes, (status, pairs, boxes))
    runs = [call._run(task) for task in range(call.count)]
    assert np.array_equal(np.unique(np.concatenate(runs), axis=0), pairs)
    assert call.count > 5
    needed = [len(np.unique(run)) for run in runs]
    assert np.mean(needed) < 0.6 * min(400, np.mean([len(run) for run in runs]))
    faces = np.array([_scenes.faces(part) for part in call.parts])
    costs = [int((faces[run].sum(axis=1) + _scenes._COST_OF_PAIR).sum()) for run in runs]
    assert max(costs) < _scenes._MIN_COST + 2 * faces.max() + _scenes._COST_OF_PAIR


def test_pairs_of_large_parts_are_few_tasks_and_never_one_for_several_huge_pairs():
    pairs = np.array([[at, at + 1] for at in range(0, 40_000, 2)], np.uint32)
    large = np.full(40_000, 250_000)
    small = np.full(40_000, 100)
    ends = _scenes.cut(pairs, large, _scenes._MAX_FACES)
    assert len(ends) - 1 == _scenes._TARGET_TASKS
    assert len(_scenes.cut(pairs, large)) - 1 > 1150  # clashes visit all faces
    assert np.array_equal(_scenes.cut(pairs, small, _scenes._MAX_FACES), _scenes.cut(pairs, small))
    assert len(_scenes.cut(pairs[:10], 8 * large, _scenes._MAX_FACES)) - 1 == 10
    many = np.tile(pairs, (40, 1))
    counts = np.diff(_scenes.cut(many, large, _scenes._MAX_FACES))
    limited = counts * (2 * _scenes._MAX_FACES + _scenes._COST_OF_PAIR)
    assert _scenes._MAX_COST // 2 < limited[:-1].min() <= limited.max() < 1.1 * _scenes._MAX_COST
