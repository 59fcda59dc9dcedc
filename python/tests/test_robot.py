"""Robots: checks equal single queries at the poses, and known verdicts of real robots."""

import os
import pickle
import re
import warnings
from pathlib import Path

import impinge
import numpy as np
import pytest
from impinge import Joint, Robot, Shape, pose
from shapes import cube

DATA = Path(__file__).resolve().parents[2] / "data" / "robots"
URDF, SRDF = DATA / "gantry.urdf", DATA / "gantry.srdf"
GANTRY = Robot.load(URDF, SRDF)
REAL = os.environ.get("IMPINGE_DATA")


def configurations(robot, count, seed=0):
    lower, upper = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return np.random.default_rng(seed).uniform(lower, upper, (count, robot.dof))


def test_a_robot_has_the_contents_of_its_files():
    assert GANTRY.name == "gantry"
    assert GANTRY.joints == ("slide", "shoulder", "elbow", "wrist", "grip")
    assert GANTRY.lower.tolist() == [-0.25, -3, -2.6, -np.inf, 0]
    assert GANTRY.upper.tolist() == [0.5, 3, 2.6, np.inf, 0.03]
    assert GANTRY.groups["all"] == GANTRY.joints
    assert GANTRY.states["arm"]["folded"]["elbow"] == 2.2
    assert (len(GANTRY.pairs), GANTRY.warnings) == (11, ())
    assert GANTRY.ignored["left_finger", "right_finger"] == "disabled: Default"
    assert GANTRY.ignored["base", "carriage"] == "adjacent"
    assert len(GANTRY.pairs) + len(GANTRY.ignored) == 7 * 6 // 2
    assert set(GANTRY.links) - set(GANTRY.shapes) == {"tool"}


def test_checks_equal_single_queries_at_the_poses():
    q = configurations(GANTRY, 600).reshape(20, 30, 5)
    poses = GANTRY.at(q)
    assert poses["palm"].shape == (20, 30, 4, 4)
    every, first = GANTRY.check(q, stop="all"), GANTRY.check(q)
    found = {}
    for a, b in GANTRY.pairs:
        found[a, b] = impinge.intersects(GANTRY.shapes[a], GANTRY.shapes[b], poses[a], poses[b])
    for at in np.ndindex(20, 30):
        names = [pair for pair, hits in found.items() if hits[at]]
        assert every.names(at) == names
        assert first.names(at) == names[:1]
        assert first.first[at] == (names[0] if names else None)
    assert np.array_equal(every.collides, np.any(list(found.values()), axis=0))
    assert 0.05 < every.collides.mean() < 0.95
    assert sum(every.counts().values()) == sum(int(hits.sum()) for hits in found.values())
    with impinge.threads(1):
        assert np.array_equal(GANTRY.check(q).collides, every.collides)
    with pytest.raises(impinge.InputError, match="stop"):
        first.counts()


def test_a_single_configuration_has_no_axes():
    report = GANTRY.check([0, 0, 0, 0, 0])
    assert report.collides is report.undecided is False
    assert report.first is None
    assert GANTRY.at([0, 0, 0, 0, 0])["base"].shape == (4, 4)
    assert GANTRY.check(np.zeros((0, 5))).collides.shape == (0,)


def test_obstacles_and_clearances_equal_single_queries():
    q = configurations(GANTRY, 200, 1)
    mesh = impinge.Mesh(*cube())
    parts = {"floor": Shape.half_space([0, 0, 1], 0), "block": mesh, "ball": Shape.sphere(0.3)}
    places = {"block": pose([0.6, 0, 1.2]), "ball": pose([0, 0.6, 0.5])}
    padding = {"*": 0.05, "palm": 0.2}
    ignored = [("base", "floor"), ("carriage", "floor")]
    for solid in (False, True):
        scene = impinge.Scene(parts, solid=solid)
        options = {"poses": places, "padding": padding, "self_padding": 0.02, "ignored": ignored, "stop": "all"}
        report = GANTRY.check(q, scene, **options)
        poses = GANTRY.at(q)
        for row in range(0, 200, 7):
            names = []
            for a, b in GANTRY.pairs:
                if impinge.within(GANTRY.shapes[a], GANTRY.shapes[b], 0.02, poses[a][row], poses[b][row]):
                    names.append((a, b))
            for link, shape in GANTRY.shapes.items():
                for name, part in parts.items():
                    thing = Shape.mesh(part, solid=True) if solid and part is mesh else part
                    near = (poses[link][row], places.get(name))
                    if (link, name) not in ignored and impinge.within(shape, thing, padding.get(link, 0.05), *near):
                        names.append((link, name))
            assert report.names(row) == names
        assert report.collides.mean() > 0.3
        assert any("block" in pair for row in range(200) for pair in report.names(row))


def test_obstacles_have_their_poses_in_the_scene():
    q = configurations(GANTRY, 100, 2)
    parts = {"block": impinge.Mesh(*cube()), "ball": Shape.sphere(0.3)}
    places = {"block": pose([0.6, 0, 1.2]), "ball": pose([0, 0.6, 0.5])}
    scene, bare = impinge.Scene(parts, poses=places), impinge.Scene(parts)
    own = GANTRY.check(q, scene, stop="all")
    stated = GANTRY.check(q, bare, poses=places, stop="all")
    assert [own.names(row) for row in range(100)] == [stated.names(row) for row in range(100)]
    assert own.counts() != GANTRY.check(q, bare, stop="all").counts()
    # A pose of the call replaces that of the scene; None keeps it.
    moved = {"block": pose([9, 9, 9]), "ball": None}
    partly = GANTRY.clearance(q, scene, poses=moved).lower
    assert np.array_equal(partly, GANTRY.clearance(q, bare, poses={**places, "block": moved["block"]}).lower)
    motion = GANTRY.check_motion(q[:20], q[20:40], scene)
    assert np.array_equal(motion.verdict, GANTRY.check_motion(q[:20], q[20:40], bare, poses=places).verdict)


def test_planning_scenes_are_obstacles(tmp_path):
    (tmp_path / "cell").mkdir()
    corners, faces = cube()
    lines = [f"v {' '.join(map(str, row))}" for row in corners] + [f"f {' '.join(map(str, row + 1))}" for row in faces]
    (tmp_path / "cell" / "cube.obj").write_text("\n".join(lines))
    text = """
    world:
      collision_objects:
      - header: {frame_id: base}
        id: shelf
        pose: {position: [0.6, 0, 1.2], orientation: [0, 0, 0, 1]}
        primitives:
        - {type: box, dimensions: [0.4, 0.6, 0.2]}
        - {type: cylinder, dimensions: [0.5, 0.1]}
        primitive_poses: [{position: [0, 0, 0]}, {position: [0, 0, 0.3]}]
      - id: block
        meshes: [{resource: "package://cell/cube.obj", dimensions: [0.5, 0.5, 0.5]}]
        mesh_poses: [{position: [0, 0.6, 0.5]}]
    """
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    scene = impinge.load_planning_scene(path, {"cell": tmp_path / "cell"}, "base")
    shelf = Shape.compound([(Shape.box([0.2, 0.3, 0.1]), None), (Shape.cylinder(0.25, 0.1), pose([0, 0, 0.3]))])
    block = Shape.mesh(impinge.Mesh(0.5 * np.asarray(corners), faces), solid=True)
    places = {"shelf": pose([0.6, 0, 1.2]), "block": pose([0, 0.6, 0.5])}
    same = impinge.Scene({"shelf": shelf, "block": block}, poses=places)
    q = configurations(GANTRY, 100, 3)
    expected = GANTRY.check(q, same, stop="all")
    for found in (scene, impinge.Scene(pickle.loads(pickle.dumps(scene.parts)), poses=scene.poses)):
        report = GANTRY.check(q, found, stop="all")
        assert [report.names(row) for row in range(100)] == [expected.names(row) for row in range(100)]
    assert any("shelf" in pair for pair in expected.counts())
    path.write_text("world: {collision_objects: [{id: a, planes: [{coef: [0, 0, 1, 0]}]}]}")
    with pytest.raises(impinge.InputError, match=r"line 1: needs the plane of object .a., which is not supported"):
        impinge.load_planning_scene(path)
    path.write_text("[{id: a, header: {frame_id: x}}]")
    with pytest.warns(impinge.LoadWarning) as caught:
        assert list(impinge.load_planning_scene(path, frame="base").parts) == []
    assert len(caught) == 2
    with pytest.raises(impinge.InputError, match="must be a mapping"):
        impinge.load_planning_scene(path, packages=["cell"])


def test_robots_of_parts_and_their_copies():
    bar, tip = Shape.capsule([0, 0, 0], [1, 0, 0], 0.05), pose([1, 0, 0])
    joints = [
        Joint("elbow", "upper", "fore", "revolute", tip, axis=(0, 0, 1), limits=(-2.5, 2.5)),
        Joint("wrist", "fore", "hand", "revolute", tip, axis=(0, 0, 1), mimic=("elbow", 1, 0)),
        Joint("float", "hand", "free", "floating"),
    ]
    robot = Robot.from_parts({"upper": bar, "fore": bar, "hand": bar, "free": None}, joints)
    assert robot.joints == ("elbow", *(f"float/{name}" for name in ("x", "y", "z", "qx", "qy", "qz", "qw")))
    q = [2.2, 1, 2, 3, 0, 0, 0, 1]
    for same in (robot, pickle.loads(pickle.dumps(robot))):
        assert same.check(q).names() == [("upper", "hand")]
        assert np.array_equal(same.at(q)["free"], robot.at(q)["free"])
    alone = Robot.from_parts({"a": bar}, [])
    assert (alone.dof, alone.check([]).collides) == (0, False)
    again = pickle.loads(pickle.dumps(GANTRY))
    assert again.pairs == GANTRY.pairs


def test_invalid_arguments_are_named():
    def fails(match, call, *arguments, **options):
        with pytest.raises(impinge.InputError, match=re.escape(match)) as caught:
            call(*arguments, **options)
        return caught.value

    zero = np.zeros(5)
    fails("q: must have 5 columns", GANTRY.check, np.zeros(4))
    fails("q: must be numbers", GANTRY.check, ["a"])
    bad = np.zeros((3, 5))
    bad[2, 1] = np.nan
    assert fails("q[2, 1]", GANTRY.check, bad).kind == "non-finite"
    bad[2, 1] = 1e7
    assert fails("q[2, 1]", GANTRY.at, bad).kind == "out-of-range"
    fails("q[0]: 5 is beyond the limits of slide", GANTRY.check, [5, 0, 0, 0, 0], on_limits="raise")
    fails("padding: there is no link 'no'", GANTRY.check, zero, padding={"no": 1})
    fails("self_padding", GANTRY.check, zero, self_padding=-1)
    fails("stop", GANTRY.check, zero, stop="never")
    fails("scene: must be impinge.Scene", GANTRY.check, zero, 3)
    fails("poses: there is no part 'x'", GANTRY.check, zero, poses={"x": None})
    fails("ignored: there is no part 'x'", GANTRY.check, zero, ignored=[("base", "x")])
    fails("ignored: must be pairs of names", GANTRY.check, zero, ignored=[3])
    fails("padding: must be finite", GANTRY.check, zero, padding=np.inf)
    fails("geometry", Robot.load, URDF, geometry="none")
    fails("Robot", Robot)
    bar = Shape.sphere(1)
    fails("2 links have no parent", Robot.from_parts, {"a": bar, "b": bar}, [])
    fails("kind", Robot.from_parts, {"a": bar, "b": bar}, [Joint("j", "a", "b", "hinge")])
    fails("links: link 'a' is int", Robot.from_parts, {"a": 3}, [])
    with pytest.raises(FileNotFoundError):
        Robot.load("no such robot.urdf")


def test_errors_and_warnings_of_files(tmp_path):
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot name='r'>\n<link name='a'/><link name='b'/>\n</robot>")
    with pytest.raises(impinge.InputError, match="2 links have no parent") as caught:
        Robot.load(broken)
    assert (caught.value.kind, caught.value.what) == ("broken-robot", str(broken))
    broken.write_text(
        "<robot name='r'><link name='a'>\n<visual><geometry><sphere radius='1'/></geometry></visual></link></robot>"
    )
    with pytest.warns(impinge.LoadWarning, match="links without collision geometry, which cannot collide: a"):
        robot = Robot.load(broken)
    assert robot.shapes == {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert list(Robot.load(broken, geometry="visual").shapes) == ["a"]


def real(name, tmp_path):
    """Returns a real robot without joints that follow others, and its known verdicts."""
    if not REAL:
        pytest.skip("IMPINGE_DATA names no folder of real files")
    robots = Path(REAL) / "robots"
    urdf, srdf = {
        "panda": ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf"),
        "talos": ("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf"),
    }[name]
    plain = tmp_path / "robot.urdf"
    plain.write_text(re.sub(r"<mimic[^>]*/>", "", (robots / urdf).read_text()))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", impinge.LoadWarning)  # Talos has a link without collision geometry
        robot = Robot.load(plain, robots / srdf, packages={"example-robot-data": REAL})
    return robot, np.load(robots / "golden" / f"{name}_self.npz")


def in_order_of_robot(robot, name, q):
    """Returns known configurations in the order of the robot's file.

    The columns of Talos are in the order of Pinocchio: depth first, children by their names.
    """
    if name == "panda":
        return q
    limbs = [f"leg_{side}" for side in ("left", "right")], ["torso"], ["arm_left", "gripper_left"]
    limbs = [*limbs[0], *limbs[1], *limbs[2], "arm_right", "gripper_right", "head"]
    names = [joint for limb in limbs for joint in robot.joints if joint.startswith(limb)]
    return q[:, [names.index(joint) for joint in robot.joints]]


@pytest.mark.parametrize("name", ["panda", "talos"])
def test_known_verdicts_of_real_robots(name, tmp_path):
    robot, known = real(name, tmp_path)
    links = known["links"]
    assert {frozenset(map(str, links[pair])) for pair in known["pairs"]} == set(map(frozenset, robot.pairs))
    report = robot.check(in_order_of_robot(robot, name, known["q"]))
    assert np.array_equal(report.collides, known["collides"])
    assert not report.undecided.any()
    assert len(report.collides) == 10_000


@pytest.mark.parametrize("name", ["panda", "talos"])
def test_kinematics_equal_those_of_pinocchio(name, tmp_path):
    pin = pytest.importorskip("pinocchio", reason="pinocchio is not installed")
    robot, known = real(name, tmp_path)
    model = pin.buildModelFromUrdf(str(tmp_path / "robot.urdf"))
    data = model.createData()
    order = [robot.joints.index(joint) for joint in list(model.names)[1:]]
    compared = 0
    for row in in_order_of_robot(robot, name, known["q"])[:200]:
        pin.framesForwardKinematics(model, data, row[order])
        poses = robot.at(row)
        for frame, placed in zip(model.frames, data.oMf, strict=True):
            if frame.type == pin.FrameType.BODY:
                assert np.abs(placed.homogeneous - poses[frame.name]).max() < 1e-12
                compared += 1
    assert compared > 2000
