"""Robots on a cluster, without Ray: an engine in its place runs the tasks in any order."""

import pickle
from pathlib import Path

import impinge
import numpy as np
import pytest
from impinge.cluster import _robots, _worker
from in_process_engine import cluster_of_tasks
from same_answers import error_of
from shapes import cube

DATA = Path(__file__).resolve().parents[2] / "data" / "robots"
GANTRY = impinge.Robot.load(DATA / "gantry.urdf", DATA / "gantry.srdf")
BAR, TIP = impinge.Shape.capsule([0, 0, 0], [1, 0, 0], 0.05), impinge.pose([1, 0, 0])
ARM = impinge.Robot.from_parts(
    {"upper": BAR, "fore": BAR, "hand": BAR},
    [
        impinge.Joint("elbow", "upper", "fore", "revolute", TIP, axis=(0, 0, 1), limits=(-2.5, 2.5)),
        impinge.Joint("wrist", "fore", "hand", "revolute", TIP, axis=(0, 0, 1), limits=(-2.5, 2.5)),
    ],
)
ROBOTS = {
    "loaded": GANTRY,
    "of parts": ARM,
    "with an object": GANTRY.attached("rod", BAR, "palm", impinge.pose([0, 0, 0.15])),
}


@pytest.fixture
def cluster(monkeypatch):
    return cluster_of_tasks(monkeypatch)


def grid(robot, count, seed):
    """Returns configurations of few values, so that many are equal and many touch."""
    rng = np.random.default_rng(seed)
    lower, upper = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return lower + (upper - lower) * rng.integers(0, 5, (count, robot.dof)) / 4


def arrays(answer):
    """Returns the arrays and values that an answer consists of, as bytes."""
    found = {}
    for name, value in vars(answer).items():
        values = value if isinstance(value, tuple) else (value,)
        found[name] = [item.tobytes() if isinstance(item, np.ndarray) else item for item in values]
    found.pop("_question", None)
    return found


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_answers_are_those_of_a_local_call(cluster, robot):
    block = impinge.Mesh(*cube())
    parts = {"block": block, "twin": block, "ball": impinge.Shape.sphere(0.3)}
    scene = impinge.Scene(parts, poses={"block": impinge.pose([0.5, 0, 1.0])}, solid=True)
    around = {"poses": {"ball": impinge.pose([0, 0.5, 0.5])}, "ignored": [(robot.links[0], "twin")]}
    q = grid(robot, 60, 1)
    calls = [
        lambda on: robot.check(q.reshape(3, 20, -1), scene, stop="all", padding=0.05, on=on, **around),
        lambda on: robot.check(q, on=on),
        lambda on: robot.check(q[0], scene, on=on, **around),
        lambda on: robot.clearance(q, scene, on=on, **around),
        lambda on: robot.clearance(q[:, None], limit=0.1, on=on),
        lambda on: robot.check_motion(q[:20], q[20:40], certificate=True, on=on),
        lambda on: robot.check_motion(q[0], q[1], scene, clearance=0.01, on=on, **around),
        lambda on: robot.check_path(q[:9], on=on),
    ]
    tasks = []
    for call in calls:
        local, shared = call(None), call(cluster)
        assert repr(shared) == repr(local)
        assert arrays(shared) == arrays(local)
        tasks.append(cluster.work.tasks)
    assert tasks == [7, 7, 1, 7, 7, 7, 1, 4]
    report = robot.check(q, scene, on=cluster, **around)
    assert report.collides.mean() > 0.1
    assert robot.check(np.zeros((0, robot.dof)), on=cluster).collides.shape == (0,)


def test_certificates_are_verified(cluster):
    motion = GANTRY.check_motion([0, 0, 0, 0, 0], [0.2, 0.5, 0.5, 1, 0.02], certificate=True, on=cluster)
    assert motion.verdict == "free"
    assert motion.verify()


def test_invalid_arguments_raise_the_errors_of_a_local_call(cluster):
    q = grid(GANTRY, 20, 2)
    bad = q.copy()
    bad[17, 3] = np.nan
    scene = impinge.Scene({"ball": impinge.Shape.sphere(0.3)})
    calls = [
        lambda on: GANTRY.check(bad, on=on),
        lambda on: GANTRY.check(q[:, :4], on=on),
        lambda on: GANTRY.check(q, scene, poses={"ball": np.diag([1, 2, 3, 1])}, on=on),
        lambda on: GANTRY.check(q, scene, ignored=[("nose", "ball")], on=on),
        lambda on: GANTRY.clearance(bad, on=on),
        lambda on: GANTRY.check_motion(q, bad, on=on),
    ]
    for call in calls:
        assert error_of(call, None) == error_of(call, cluster)
    assert not cluster._ray.started


def test_other_files_on_a_worker_are_an_error(cluster, monkeypatch):
    monkeypatch.setattr(_robots, "contents_of", lambda robot: "another hash")
    with pytest.raises(impinge.InputError, match=r"are not those of the caller.*the same files at the same paths"):
        GANTRY.check(grid(GANTRY, 20, 3), on=cluster)


def test_robots_with_other_faces_in_the_same_box_or_other_joints_differ():
    vertices, faces = cube()
    bent = np.vstack([vertices, [[0, 0, 0.25]]])
    # The first face gets a dent.
    a, b, c = faces[0]
    dented = np.vstack([faces[1:], [[a, b, 8], [b, c, 8], [c, a, 8]]])
    meshes = impinge.Mesh(vertices, faces), impinge.Mesh(bent, dented)

    def robot(mesh, place, kind="floating"):
        joint = impinge.Joint("joint", "base", "tip", kind, impinge.pose(place))
        return impinge.Robot.from_parts({"base": mesh, "tip": BAR}, [joint])

    robots = [
        robot(meshes[0], [1, 0, 0]),
        robot(meshes[1], [1, 0, 0]),
        robot(meshes[0], [1, 0, 1e-9]),
        robot(meshes[0], [1, 0, 0], "planar"),
    ]
    assert len({_worker.contents_of(each) for each in robots}) == 4
    assert _worker.contents_of(pickle.loads(pickle.dumps(robots[0]))) == _worker.contents_of(robots[0])
