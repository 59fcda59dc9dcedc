"""Runs of tasks without Ray: interrupts, checkpoints, the command, and errors of workers."""

import json
import sys

import impinge
import pytest
from grid_scenes import CUBE, TORUS, grid_scene
from impinge.cluster import _command, _parcels, _session
from impinge.cluster._checkpoint import Checkpoint
from in_process_engine import Engine, cluster_of_tasks
from same_answers import same, same_reports
from shapes import cube, random_poses, torus

MANY = random_poses(20, 2.0, 4)


@pytest.fixture
def cluster(monkeypatch):
    return cluster_of_tasks(monkeypatch)


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
