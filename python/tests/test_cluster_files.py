"""Parts in a folder that all nodes share, without Ray: paths travel, and never to other meshes."""

import json
import os
import sys

import impinge
import numpy as np
import pytest
from impinge._stored import Stored
from impinge.cluster import _command, _session, _worker
from in_process_engine import Engine, cluster_of_tasks
from same_answers import same, same_reports
from shapes import cube, random_poses, torus
from test_scene_files import write


@pytest.fixture
def cluster(monkeypatch, tmp_path):
    """Returns a cluster with a shared folder, whose workers have no parts yet."""
    monkeypatch.setattr(_worker, "_parts", _worker._Parts())
    return cluster_of_tasks(monkeypatch, str(tmp_path))


def stored(path, mesh):
    """Returns the mesh that was written to a file and loaded from it."""
    mesh.bake(path)
    return impinge.load(path)


def row_of(meshes):
    """Returns a scene of meshes that overlap their neighbors."""
    poses = {str(at): impinge.pose([at * 1.5, 0, 0]) for at in range(len(meshes))}
    return impinge.Scene({str(at): mesh for at, mesh in enumerate(meshes)}, poses=poses)


def tori(count):
    return [impinge.Mesh(*torus(20 + at, 15)) for at in range(count)]


def test_baked_files_of_the_shared_folder_are_mapped(cluster, tmp_path):
    scene = row_of([stored(tmp_path / f"{at}.impinge", mesh) for at, mesh in enumerate(tori(20))])
    report = scene.check(stop="all", on=cluster)
    assert same_reports(report, scene.check(stop="all"))
    assert len(report.names()) == 19
    assert cluster.work.tasks > 5
    assert cluster.work.bytes_put == 0
    assert cluster.work.bytes_mapped == sum(path.stat().st_size for path in tmp_path.glob("*.impinge"))
    clashes = impinge.clash(scene, on=cluster)
    assert clashes.to_json() == impinge.clash(scene).to_json()
    assert len(clashes) == 19
    assert cluster.work.bytes_put == 0
    a, b, poses = scene.parts["3"], scene.parts["4"], random_poses(20, 2.0, 3)
    for verb in (impinge.intersects, impinge.distance, impinge.intersecting_pairs):
        assert same(verb(a, b, None, poses, on=cluster), verb(a, b, None, poses))
    assert cluster.work.bytes_put == 0


def test_a_baked_scene_is_mapped_and_other_parts_travel_as_bytes(cluster, tmp_path):
    row_of(tori(12)).bake(tmp_path / "row")
    baked = impinge.load_scene(tmp_path / "row")
    more = {"ball": impinge.Shape.sphere(1.0), "cube": impinge.Mesh(*cube())}
    scene = impinge.Scene({**baked.parts, **more}, poses=baked.poses)
    report = scene.check(stop="all", on=cluster)
    assert same_reports(report, scene.check(stop="all"))
    assert len(report.names()) > 12
    assert 0 < cluster.work.bytes_put < 1 << 14
    assert 0 < cluster.work.bytes_mapped <= (tmp_path / "row" / "meshes").stat().st_size


@pytest.mark.parametrize("where", ["no shared folder", "a sibling with a longer name", "another unit"])
def test_files_that_are_not_shared_travel_as_bytes(monkeypatch, tmp_path, where):
    monkeypatch.setattr(_worker, "_parts", _worker._Parts())
    folder = tmp_path / "share"
    folder.mkdir()
    (tmp_path / "share2").mkdir()
    place = tmp_path / "share2" if where == "a sibling with a longer name" else folder
    cluster = _session.Cluster(Engine(), None, None if where == "no shared folder" else str(folder))
    mesh = stored(place / "torus.impinge", impinge.Mesh(*torus()))
    if where == "another unit":
        mesh = impinge.load(place / "torus.impinge", "mm")
    poses = random_poses(20, 2.0, 3)
    assert same(impinge.intersects(mesh, mesh, None, poses, on=cluster), impinge.intersects(mesh, mesh, None, poses))
    assert cluster.work.bytes_put > 0
    assert cluster.work.bytes_mapped == 0


CHANGES = {
    "refit": lambda mesh, path: mesh.refit(mesh.vertices + np.float32(0.5)),
    "rebuild": lambda mesh, path: mesh.rebuild("median"),
    "another file": lambda mesh, path: impinge.Mesh(*torus(9, 8)).bake(path),
    "no file": lambda mesh, path: os.remove(path),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_meshes_that_are_not_those_of_their_files_travel_as_bytes(cluster, tmp_path, change):
    path = tmp_path / "torus.impinge"
    mesh, other = stored(path, impinge.Mesh(*torus())), impinge.Mesh(*torus(12, 13))
    poses = random_poses(40, 2.0, 3)
    impinge.distance(mesh, other, None, poses, on=cluster)
    assert cluster.work.bytes_mapped == path.stat().st_size
    change(mesh, path)
    answer = impinge.distance(mesh, other, None, poses, on=cluster)
    assert same(answer, impinge.distance(mesh, other, None, poses))
    assert answer.distance.min() == 0
    assert cluster.work.bytes_put > len(mesh.to_baked()) // 2
    assert cluster.work.bytes_mapped == 0


def test_a_refitted_copy_has_no_file(tmp_path):
    mesh = stored(tmp_path / "torus.impinge", impinge.Mesh(*torus()))
    assert mesh._snapshot()._stored is mesh._stored is not None
    assert mesh.refitted(mesh.vertices)._stored is None
    assert mesh.repaired()[0]._stored is None


OTHERS = {
    "another mesh": (lambda path: scaled(0.5).bake(path), "is not that of the caller: the file has another mesh"),
    "a longer mesh": (lambda path: impinge.Mesh(*torus(50, 40)).bake(path), "is not that of the caller: .*same paths"),
    "no file": (os.remove, "is not that of the caller: .*no such regular file"),
    "a shorter file": (lambda path: os.truncate(path, 9000), "is not that of the caller: the file is shorter"),
    "a vertex": (lambda path: flip(path, 0.01), "is damaged: .*bake the part again"),
    "the tree": (lambda path: flip(path, 0.6), "is damaged"),
}


def scaled(factor):
    """Returns the mesh whose file is replaced, in another size."""
    vertices, faces = torus(40, 30)
    return impinge.Mesh(vertices * factor, faces)


def flip(path, fraction):
    """Changes a bit of a float of the file, in place."""
    with open(path, "r+b") as file:
        at = int(fraction * os.path.getsize(path)) // 4 * 4 + 3 + 320
        file.seek(at)
        old = file.read(1)[0]
        file.seek(at)
        file.write(bytes([old ^ 1]))


@pytest.mark.parametrize(("spoil", "message"), OTHERS.values(), ids=OTHERS)
def test_another_file_on_a_worker_is_an_error(cluster, tmp_path, monkeypatch, spoil, message):
    path = tmp_path / "torus.impinge"
    mesh = scaled(1)
    mesh.bake(path)
    kept = path.read_bytes()
    loaded = impinge.load(path)
    # The file on the worker differs from that of the caller, which still finds its own.
    monkeypatch.setattr(Stored, "is_there", lambda self: True)
    path.unlink()  # the caller keeps what it mapped
    path.write_bytes(kept)
    spoil(path)
    with pytest.raises(impinge.InputError, match=f"part 'b' in the file .*torus.impinge' on a worker {message}"):
        impinge.intersects(impinge.Shape.sphere(0.5), loaded, None, random_poses(20, 2.0, 3), on=cluster)
    path.unlink(missing_ok=True)
    path.write_bytes(kept)
    poses = random_poses(20, 2.0, 3)
    assert same(impinge.intersects(mesh, loaded, None, poses, on=cluster), impinge.intersects(mesh, mesh, None, poses))


def test_a_worker_keeps_few_mapped_parts(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr(_worker, "_MAX_CACHED_BYTES", 5 * _worker._BYTES_OF_MAPPED)
    scene = row_of([stored(tmp_path / f"{at}.impinge", mesh) for at, mesh in enumerate(tori(40))])
    assert len(scene.check(stop="all", on=cluster).names()) == 39
    assert len(_worker._parts._kept) <= 5
    assert cluster.work.bytes_mapped >= sum(path.stat().st_size for path in tmp_path.glob("*.impinge"))


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads the memory of the process from /proc")
def test_the_memory_of_workers_is_reported(cluster):
    mesh = impinge.Mesh(*torus())
    impinge.intersects(mesh, mesh, None, random_poses(20, 2.0, 3), on=cluster)
    ((node, memory),) = cluster.work.memory.items()
    assert node.endswith(f", raylet {os.getppid()}")
    assert 1 << 24 < memory <= _worker.private_memory() + (1 << 26)


def test_a_shared_folder_must_exist(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", Engine())
    with (
        pytest.raises(impinge.InputError, match=r"shared: '.*none' is not a folder"),
        impinge.cluster.ray(shared=tmp_path / "none"),
    ):
        pass


def test_the_command_uses_the_poses_and_ignored_pairs_of_scenes(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(Engine, "is_initialized", lambda self: True, raising=False)
    monkeypatch.setitem(sys.modules, "ray", Engine())
    monkeypatch.setattr(_worker, "_parts", _worker._Parts())
    nodes = [{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "translation": [9, 0, 0]}, {"mesh": 0, "name": "c"}]
    path = write(tmp_path / "three.gltf", nodes)

    def pairs(*arguments):
        code = _command.main(["pairs", *map(str, arguments)])
        report = json.loads(capsys.readouterr().out)
        assert code == bool(report["pairs"])
        return report["pairs"]

    assert pairs(path) == [["a", "c"]]
    scene = impinge.load_scene(path)
    scene.ignore("c", "a")
    scene.bake(tmp_path / "baked")
    options = tmp_path / "baked", "--shared", tmp_path
    assert pairs(*options) == []
    # Four parts in one place and two in another; one pair is ignored.
    found = pairs(path, *options)
    assert len(found) == 6
    assert ["2 baked: a", "2 baked: c"] not in found
    solid = impinge.Scene({"d": impinge.Mesh(*cube())}, solid=True)
    solid.bake(tmp_path / "solid")
    assert _command.main(["pairs", str(path), str(tmp_path / "solid")]) == 2
    assert "of other scenes are surfaces" in capsys.readouterr().err
