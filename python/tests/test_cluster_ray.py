"""Calls on three nodes of Ray: the bytes of a local call, also if a node ends or the run is cut."""

import gc
import json
import pickle
import signal
import subprocess
import sys
import time
import weakref
from pathlib import Path

import impinge
import numpy as np
import pytest
from impinge.cluster import _calls, _command, _parcels, _scenes, _session
from impinge.cluster._checkpoint import Checkpoint
from same_answers import same, same_reports
from shapes import cube, random_poses, torus

ray = pytest.importorskip("ray", reason="Ray is not installed")
cluster_utils = pytest.importorskip("ray.cluster_utils", reason="Ray is not installed with its test utilities")

pytestmark = pytest.mark.filterwarnings("ignore")  # those of Ray and of the packages that it uses

DATA = Path(__file__).resolve().parents[2] / "data"
NODE = {"num_cpus": 1, "object_store_memory": 300_000_000}
SETTINGS = {
    "health_check_initial_delay_ms": 500,
    "health_check_period_ms": 500,
    "health_check_failure_threshold": 3,
    "worker_niceness": 0,
}
"""Settings of Ray. With these health checks it notices in two seconds that a node was killed, where
its own take 15. Its own niceness of 15 leaves workers little time beside other programs."""


@pytest.fixture(scope="module")
def nodes():
    """Three nodes on this machine."""
    head = {**NODE, "include_dashboard": False, "_system_config": SETTINGS}
    cluster = cluster_utils.Cluster(initialize_head=True, head_node_args=head)
    for _ in range(2):
        cluster.add_node(**NODE)
    yield cluster
    cluster.shutdown()


@pytest.fixture(scope="module")
def connected(nodes):
    """Returns the nodes after a connection to them, so that workers start once for all tests."""
    ray.init(nodes.address, log_to_driver=False, logging_level="ERROR")
    yield nodes
    ray.shutdown()


@pytest.fixture
def small_tasks(monkeypatch):
    """Cuts calls into many tasks and parcels."""
    monkeypatch.setattr(_calls, "_MIN_WORK", 1)
    monkeypatch.setattr(_calls, "_TARGET_TASKS", 8)
    monkeypatch.setattr(_scenes, "_MIN_COST", 1 << 17)
    monkeypatch.setattr(_parcels, "_PARCEL_BYTES", 1 << 20)


def building():
    """Returns a scene of 700 parts, most of which touch, and their poses at half units."""
    human = impinge.load(DATA / "human_makehuman_cc0.ply")
    meshes = [impinge.Mesh(*cube()), impinge.Mesh(*torus()), impinge.Mesh(*torus(90, 30, 2.0, 0.5)), human]
    rng = np.random.default_rng(8)
    which = rng.choice(len(meshes), 700, p=[0.5, 0.3, 0.18, 0.02])
    parts = {f"part {at}": meshes[kind] for at, kind in enumerate(which)}
    poses = {name: impinge.pose(place) for name, place in zip(parts, rng.integers(-16, 17, (700, 3)) / 2, strict=True)}
    return impinge.Scene(parts), poses


SCENE, POSES = building()
QUESTION = {"question": "penetrates", "stop": "all"}


@pytest.fixture(scope="module")
def expected():
    report = SCENE.check(POSES, **QUESTION)
    assert len(report.names()) > 1000
    return report


def test_pairs_and_rows_have_the_bytes_of_a_local_call(nodes, expected, small_tasks):
    b = impinge.Mesh(*cube())
    poses = random_poses(200, 2.0, 3)
    with impinge.cluster.ray(nodes.address) as cluster:
        assert cluster.processors == 3
        assert same_reports(SCENE.check(POSES, on=cluster, **QUESTION), expected)
        assert cluster.work.tasks > 20
        for verb in (impinge.intersects, impinge.distance, impinge.intersecting_pairs, impinge.contacts):
            assert same(verb(b, b, None, poses, on=cluster), verb(b, b, None, poses))
            assert cluster.work.tasks == 8
        moving = impinge.Motion(poses, poses[::-1])
        impact = impinge.time_of_impact(b, b, None, moving, on=cluster)
        assert same(impact, impinge.time_of_impact(b, b, None, moving))
        assert cluster.work.tasks == 8
        assert 0.1 < impact.hit.mean() < 0.9
        rows = {"part 1": random_poses(64, 9.0, 5)}
        assert same_reports(SCENE.check({**POSES, **rows}, on=cluster), SCENE.check({**POSES, **rows}))
        assert cluster.work.tasks == 8
    assert not ray.is_initialized()


def running_tasks(node):
    """Returns the number of tasks that a node runs now. Ray writes them in titles of processes."""
    raylet = node.all_processes["raylet"][0].process.pid
    titles = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            if int(status.read_text().rpartition(")")[2].split()[1]) == raylet:
                titles.append((status.parent / "cmdline").read_text())
        except OSError:  # the process has ended
            continue
    return sum(title.startswith("ray::impinge: pairs, task") for title in titles)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads the titles of processes from /proc")
def test_a_node_that_is_killed_changes_nothing(connected, expected, small_tasks, monkeypatch, tmp_path):
    node = connected.add_node(**NODE)
    add, finished, killed = Checkpoint.add, [], []

    def kill(self, call, task, answer):
        add(self, call, task, answer)
        finished.append(task)
        if not killed and len(finished) >= 8 and running_tasks(node):
            killed.append(len(finished))
            connected.remove_node(node, allow_graceful=False)

    monkeypatch.setattr(Checkpoint, "add", kill)
    with impinge.cluster.ray(checkpoint=tmp_path / "run.ndjson") as cluster:
        assert cluster.processors == 4
        report = SCENE.check(POSES, on=cluster, **QUESTION)
        assert sorted(finished) == list(range(cluster.work.tasks))
        assert killed
        assert killed[0] < len(finished) - 4 * _session._TASKS_PER_PROCESSOR
        deadline = time.monotonic() + 60
        while cluster.processors > 3 and time.monotonic() < deadline:
            time.sleep(0.2)  # until the cluster has noticed
        assert cluster.processors == 3
    assert same_reports(report, expected)


@pytest.mark.usefixtures("ctrl_c_raises_keyboard_interrupt")
def test_an_interrupted_call_continues_from_its_checkpoint(connected, expected, small_tasks, monkeypatch, tmp_path):
    add = Checkpoint.add

    def interrupt(self, call, task, answer):
        add(self, call, task, answer)
        if len(self.answers(call)) == 10:
            # The signal comes between two calls of Ray in each run of the test.
            signal.raise_signal(signal.SIGINT)

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "add", interrupt)
        with (
            pytest.raises(KeyboardInterrupt),
            impinge.cluster.ray(checkpoint=tmp_path / "run.ndjson") as cluster,
        ):
            SCENE.check(POSES, on=cluster, **QUESTION)
    with impinge.cluster.ray(checkpoint=tmp_path / "run.ndjson") as cluster:
        assert same_reports(SCENE.check(POSES, on=cluster, **QUESTION), expected)
        assert 10 <= cluster.work.resumed < cluster.work.tasks


def test_parts_are_used_in_place_in_the_object_store(connected):
    mesh = impinge.Mesh(*torus(400, 200))
    baked = np.frombuffer(mesh.to_baked(), np.uint8)
    with impinge.cluster.ray():
        stored = ray.get(ray.put(baked))
        made, owner = impinge.Mesh.from_baked(stored), weakref.ref(stored)
        del stored
        gc.collect()
        assert owner() is not None
        assert np.array_equal(made.vertices, mesh.vertices)
        del made
        gc.collect()
        assert owner() is None


def test_damaged_parts_and_other_versions_are_errors(connected, monkeypatch):
    a, b = impinge.Mesh(*torus(41, 20)), impinge.Mesh(*torus(43, 20))
    packed = _parcels.Parcels.packed

    def spoil(self, number):
        parcel = packed(self, number)
        parcel[len(parcel) // 4] ^= 4
        return parcel

    with impinge.cluster.ray() as cluster:
        with monkeypatch.context() as patch:
            patch.setattr(_parcels.Parcels, "packed", spoil)
            with pytest.raises(impinge.InputError, match="part 'a' did not reach the worker as it was sent"):
                impinge.intersects(a, b, on=cluster)
        with monkeypatch.context() as patch:
            patch.setattr(_session, "__version__", "0.0.1")
            with pytest.raises(impinge.cluster.ClusterError, match=r"the caller has impinge 0\.0\.1"):
                impinge.intersects(a, b, on=cluster)
        assert impinge.intersects(a, b, on=cluster) == impinge.intersects(a, b)


def run_when_loaded(action, part):
    """Returns the bytes of a shape whose worker runs an action when it loads them."""

    class Acting:
        def __reduce__(self):
            return eval, (f"({action}, __import__('pickle').loads({pickle.dumps(part)!r}))[1]",)

    return pickle.dumps(Acting())


KILL = "__import__('os').kill(__import__('os').getpid(), 9)"
FAULTS = {
    "a worker is killed once": "__import__('os').path.exists({flag!r}) or (open({flag!r}, 'x').close(), " + KILL + ")",
    "a worker is killed each time": KILL,
    "an allocation fails": "__import__('numpy').zeros(1 << 46)",
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_worker_without_memory_is_repeated_or_an_error(connected, monkeypatch, tmp_path, fault):
    action = FAULTS[fault].format(flag=str(tmp_path / "flag"))
    ball, mesh, poses = impinge.Shape.sphere(1.25), impinge.Mesh(*torus()), random_poses(64, 2.0, 3)
    bytes_of = _parcels._bytes_of
    faulty = {ball: run_when_loaded(action, ball)}
    monkeypatch.setattr(_parcels, "_bytes_of", lambda part: faulty.get(part) or bytes_of(part))
    monkeypatch.setattr(_session, "_MAX_RETRIES", 1)
    with impinge.cluster.ray() as cluster:
        if fault == "a worker is killed once":
            assert same(
                impinge.intersects(ball, mesh, None, poses, on=cluster), impinge.intersects(ball, mesh, None, poses)
            )
            assert (tmp_path / "flag").exists()
        elif fault == "an allocation fails":
            with pytest.raises(MemoryError, match="Unable to allocate"):
                impinge.intersects(ball, mesh, None, poses, on=cluster)
        else:
            with pytest.raises(
                impinge.cluster.ClusterError,
                match=r"intersects, task 1 of 1: WorkerCrashedError(.|\n)*Run the call again",
            ):
                impinge.intersects(ball, mesh, None, poses, on=cluster)


def test_a_lost_object_is_an_error(connected, small_tasks, monkeypatch):
    node = connected.add_node(**NODE, resources={"lost": 1})
    put = ray.put
    lost = []

    def put_and_lose(value):
        """Puts the first parcel from a node that is killed then."""
        if lost:
            return put(value)
        lost.extend(ray.get(ray.remote(resources={"lost": 1})(lambda: [put(value)]).remote()))
        connected.remove_node(node, allow_graceful=False)
        return lost[0]

    with impinge.cluster.ray() as cluster:
        with monkeypatch.context() as patch:
            patch.setattr(ray, "put", put_and_lose)
            with pytest.raises(impinge.cluster.ClusterError, match=r"pairs, task .*: OwnerDiedError"):
                SCENE.check(POSES, on=cluster, **QUESTION)
        assert lost
        assert impinge.intersects(impinge.Mesh(*cube()), impinge.Mesh(*torus()), on=cluster)


def test_parts_in_a_shared_folder_are_mapped_on_each_node(connected, expected, small_tasks, tmp_path):
    SCENE.bake(tmp_path / "building")
    scene = impinge.load_scene(tmp_path / "building")
    with impinge.cluster.ray(shared=tmp_path) as cluster:
        report = scene.check(POSES, on=cluster, **QUESTION)
        assert cluster.work.bytes_put == 0
        assert cluster.work.bytes_mapped > 3 * 1000
        assert len(cluster.work.memory) == 3
        assert all(1 << 24 < memory < 1 << 30 for memory in cluster.work.memory.values())
        assert same_reports(report, expected)
        (tmp_path / "building" / "meshes").unlink()
        assert same_reports(scene.check(POSES, on=cluster, **QUESTION), expected)
        assert cluster.work.bytes_put > 0


def write_scene(path, count):
    """Writes an OBJ file of cubes in a row, of which neighbors touch, and one that is apart."""
    lines, first = [], 1
    vertices, faces = cube()
    for at in range(count):
        lines.append(f"o part {at}")
        lines += [f"v {x + at + 5 * (at == count - 1)} {y} {z}" for x, y, z in vertices]
        lines += [f"f {a + first} {b + first} {c + first}" for a, b, c in faces]
        first += len(vertices)
    path.write_text("\n".join(lines) + "\n")


def test_the_command_writes_the_pairs_as_json(connected, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_scene(tmp_path / "row.obj", 6)
    write_scene(tmp_path / "two.obj", 2)

    def run(*arguments):
        code = _command.main(["pairs", *arguments])
        out, err = capsys.readouterr()
        return code, out, err

    row = "row.obj", "--checkpoint", "run.ndjson"
    command = [sys.executable, "-m", "impinge.cluster", "pairs", *row, "--address", connected.address]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (1, "")
    report = json.loads(done.stdout)
    assert report["complete"] is True
    assert report["tasks"] == [1, 1]
    assert report["pairs"] == [[f"part {at}", f"part {at + 1}"] for at in range(4)]
    assert report["parts"] == 6
    assert json.loads((tmp_path / "run.ndjson").read_text())["task"] == 0
    assert run(*row) == (1, done.stdout, "")
    _, out, _ = run("row.obj", "two.obj", "--question", "within", "--clearance", "0.5")
    assert ["1 row.obj: part 0", "2 two.obj: part 0"] in json.loads(out)["pairs"]
    code, out, err = run("two.obj", "--question", "penetrates")
    assert (code, json.loads(out)["pairs"], err) == (0, [], "")
    code, out, err = run("none.obj")
    assert (code, out) == (2, "")
    assert "none.obj" in err
