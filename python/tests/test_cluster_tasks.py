"""Calls that are cut into tasks, without Ray: an engine in its place runs them in any order."""

import json
import sys
import weakref

import impinge
import numpy as np
import pytest
from impinge.cluster import _calls, _command, _parcels, _scenes, _session
from impinge.cluster._checkpoint import Checkpoint
from in_process_engine import Engine
from same_answers import error_of, same, same_reports
from shapes import cube, random_poses, torus

CUBE, TORUS = impinge.Mesh(*cube()), impinge.Mesh(*torus())


@pytest.fixture
def cluster(monkeypatch):
    """Returns a cluster whose calls are cut into as many tasks as possible."""
    monkeypatch.setattr(_calls, "_LEAST_WORK", 1)
    monkeypatch.setattr(_calls, "_MOST_TASKS", 7)
    monkeypatch.setattr(_scenes, "_LEAST_COST", 1 << 11)
    monkeypatch.setattr(_parcels, "_PARCEL_BYTES", 1 << 16)
    return _session.Cluster(Engine(), None)


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


def grid_scene(count, seed):
    """Returns a scene of meshes and shapes at half units, so that many touch, and their poses."""
    rng = np.random.default_rng(seed)
    kinds = [
        CUBE,
        TORUS,
        impinge.Shape.sphere(0.5),
        impinge.Shape.half_space([0, 0, 1], -9.0),
        impinge.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)),
        impinge.Mesh(*cube(-0.25, 0.75)),
    ]
    which = rng.choice(len(kinds), count, p=[0.4, 0.2, 0.15, 0.01, 0.04, 0.2])
    parts = {f"part {at}": kinds[kind] for at, kind in enumerate(which)}
    places = rng.integers(-9, 10, (count, 3)) / 2
    poses = {name: impinge.pose(place) for name, place in zip(parts, places, strict=True) if rng.random() < 0.9}
    ignored = [tuple(rng.choice(list(parts), 2)) for _ in range(count)]
    return impinge.Scene(parts, ignored=ignored, solid=bool(seed % 2)), poses


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


def row_of(meshes):
    """Returns a scene of meshes that overlap their neighbors, and their poses."""
    poses = {str(at): impinge.pose([at * 1.5, 0, 0]) for at in range(len(meshes))}
    return impinge.Scene({str(at): mesh for at, mesh in enumerate(meshes)}), poses


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


def test_a_run_that_was_interrupted_continues(cluster, tmp_path, monkeypatch):
    scene, poses = grid_scene(120, 3)
    expected = scene.check(poses, stop="all")
    path = tmp_path / "run.ndjson"
    add = Checkpoint.add

    def interrupt(self, call, task, answer):
        add(self, call, task, answer)
        if len(self.answers(call)) == 5:
            raise KeyboardInterrupt

    monkeypatch.setattr(Checkpoint, "add", interrupt)
    cluster._checkpoint = Checkpoint(str(path))
    with pytest.raises(KeyboardInterrupt):
        scene.check(poses, stop="all", on=cluster)
    cluster._checkpoint.close()
    monkeypatch.setattr(Checkpoint, "add", add)

    # The last line is cut off, and one digit of the second line has changed.
    lines = path.read_bytes().splitlines(keepends=True)
    assert len(lines) == 5
    at = lines[1].index(b'"task":') + len(b'"task":')
    lines[1] = lines[1][:at] + b"9" + lines[1][at + 1 :]
    path.write_bytes(b"".join(lines)[:-7])

    for resumed in (3, None):
        cluster._checkpoint = Checkpoint(str(path))
        assert same_reports(scene.check(poses, stop="all", on=cluster), expected)
        assert cluster.work.resumed == (cluster.work.tasks if resumed is None else resumed)
        cluster._checkpoint.close()

    # Nothing is resumed for another call.
    cluster._checkpoint = Checkpoint(str(path))
    changed = {**poses, "part 0": impinge.pose([0, 0, 0.5])}
    assert same_reports(scene.check(changed, stop="all", on=cluster), scene.check(changed, stop="all"))
    assert cluster.work.resumed == 0
    assert same(impinge.distance(CUBE, TORUS, None, MANY, on=cluster), impinge.distance(CUBE, TORUS, None, MANY))
    assert same(impinge.distance(CUBE, TORUS, None, MANY, on=cluster), impinge.distance(CUBE, TORUS, None, MANY))
    assert cluster.work.resumed == cluster.work.tasks == 7
    other = MANY[::-1]
    assert same(impinge.distance(CUBE, TORUS, None, other, on=cluster), impinge.distance(CUBE, TORUS, None, other))
    assert cluster.work.resumed == 0
    cluster._checkpoint.close()


def test_an_interrupted_command_writes_the_pairs_so_far(cluster, tmp_path, monkeypatch, capsys):
    corners, triangles = cube()
    lines = []
    for at in range(40):
        lines += [f"o part {at}", *(f"v {x + at} {y} {z}" for x, y, z in corners)]
        lines += ["f " + " ".join(str(corner + 1 + 8 * at) for corner in triangle) for triangle in triangles]
    path = tmp_path / "row.obj"
    path.write_text("\n".join(lines))
    monkeypatch.setattr(Engine, "is_initialized", lambda self: True, raising=False)
    monkeypatch.setitem(sys.modules, "ray", Engine())
    arguments = ["pairs", str(path), "--checkpoint", str(tmp_path / "run.ndjson")]
    add = Checkpoint.add

    def interrupt(self, call, task, answer):
        add(self, call, task, answer)
        if len(self.answers(call)) == 3:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "add", interrupt)
        assert _command.main(arguments) == 2
    report = json.loads(capsys.readouterr().out)
    whole = [[f"part {at}", f"part {at + 1}"] for at in range(39)]
    assert (report["complete"], report["tasks"]) == (False, [3, 10])
    assert 0 < len(report["pairs"]) < 39
    assert all(pair in whole for pair in report["pairs"])
    assert _command.main(arguments) == 1
    report = json.loads(capsys.readouterr().out)
    assert (report["complete"], report["tasks"], report["pairs"]) == (True, [10, 10], whole)
    assert _command.main(["pairs", str(path), "--question", "within"]) == 2
    assert "--clearance is needed" in capsys.readouterr().err


def test_a_damaged_part_is_an_error_that_names_it(cluster, monkeypatch):
    packed = _parcels.Parcels.packed

    def spoil(self, number):
        parcel = packed(self, number)
        parcel[len(parcel) // 2] ^= 4
        return parcel

    monkeypatch.setattr(_parcels.Parcels, "packed", spoil)
    damaged = impinge.Mesh(*torus(20, 30))
    with pytest.raises(impinge.InputError, match=r"parts: part 'b' did not reach the worker as it was sent: .*again"):
        impinge.intersects(impinge.Shape.sphere(0.5), damaged, None, MANY, on=cluster)


def test_a_worker_of_another_version_is_an_error(cluster, monkeypatch):
    monkeypatch.setattr(_session, "__version__", "0.0.1")
    with pytest.raises(
        impinge.cluster.ClusterError, match=r"caller has impinge 0\.0\.1, and a worker has .*: install the"
    ):
        impinge.intersects(CUBE, TORUS, None, MANY, on=cluster)


def test_limits_and_closed_connections_are_errors(cluster):
    with impinge.limit(seconds=9), pytest.raises(impinge.InputError, match="limit"):
        impinge.intersects(CUBE, TORUS, on=cluster)
    with pytest.raises(impinge.InputError, match=r"must be an impinge\.cluster\.Cluster"):
        impinge.intersects(CUBE, TORUS, on="auto")
    cluster._close()
    with pytest.raises(impinge.cluster.ClusterError, match="closed"):
        impinge.intersects(CUBE, TORUS, on=cluster)


def test_without_ray_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(impinge.cluster.ClusterError, match=r'pip install "impinge\[ray\]"'), impinge.cluster.ray():
        pass


def test_a_connection_that_fails_is_an_error(monkeypatch):
    class Unreachable(Engine):
        def is_initialized(self):
            return False

        def init(self, address, **options):
            raise ConnectionError(f"nobody listens at {address}")

    monkeypatch.setitem(sys.modules, "ray", Unreachable())
    message = "cannot connect to Ray at 10.0.0.9: nobody listens at 10.0.0.9; `ray start --head`"
    with pytest.raises(impinge.cluster.ClusterError, match=message), impinge.cluster.ray("10.0.0.9"):
        pass


def test_tasks_of_pairs_are_bounded_and_close_together():
    scene, poses = grid_scene(400, 2)
    parts = [(name, part, False, poses.get(name)) for name, part in scene.parts.items()]
    axes, (status, pairs, boxes) = impinge._impinge.scene_candidates(parts, [], ("intersects", 0.0), "raise")
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
    assert max(costs) < _scenes._LEAST_COST + 2 * faces.max() + _scenes._COST_OF_PAIR


def test_pairs_of_large_parts_are_few_tasks_and_never_one_for_several_huge_pairs():
    pairs = np.array([[at, at + 1] for at in range(0, 40_000, 2)], np.uint32)
    large = np.full(40_000, 250_000)
    small = np.full(40_000, 100)
    ends = _scenes.cut(pairs, large, _scenes._MOST_FACES)
    assert len(ends) - 1 == _scenes._MOST_TASKS
    assert len(_scenes.cut(pairs, large)) - 1 > 1150  # clashes visit all faces
    assert np.array_equal(_scenes.cut(pairs, small, _scenes._MOST_FACES), _scenes.cut(pairs, small))
    assert len(_scenes.cut(pairs[:10], 8 * large, _scenes._MOST_FACES)) - 1 == 10
    many = np.tile(pairs, (40, 1))
    counts = np.diff(_scenes.cut(many, large, _scenes._MOST_FACES))
    limited = counts * (2 * _scenes._MOST_FACES + _scenes._COST_OF_PAIR)
    assert _scenes._MOST_COST // 2 < limited[:-1].min() <= limited.max() < 1.1 * _scenes._MOST_COST
