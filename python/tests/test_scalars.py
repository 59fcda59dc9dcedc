"""Invalid numbers, flags, options and paths raise an `InputError` that names the argument."""

from pathlib import Path

import impinge
import numpy as np
import pytest
from impinge import fcl, fit, partition
from shapes import cube

MESH, BALL, MOTION = impinge.Mesh(*cube()), impinge.Shape.sphere(1), impinge.Motion(None, None)
ORIGIN, ALONG, PATH = [0, 0, 0], [0, 0, 1], Path(__file__).resolve().parents[2] / "data" / "robot.glb"
TREE = partition.BoxTree([[0, 0, 0], [2, 0, 0]], [[1, 1, 1], [3, 1, 1]])
SCENE = impinge.Scene({"a": MESH, "b": MESH})
WIDTHS, RADIUS = fit.MinWidths(ORIGIN, [1, 1, 1]), fit.CenterRadius(ORIGIN, [1, 1, 1])


def world():
    made = impinge.World()
    made.insert(MESH)
    return made


@pytest.fixture(scope="module")
def robot():
    return impinge.Character(PATH, volumes=1)


def enter(n):
    with impinge.threads(n):
        return impinge.intersects(MESH, MESH)


NOT_NUMBERS = [True, np.True_, "7", b"7", 1j, np.complex128(1), np.array([1]), [], {}, object()]
NOT_INTEGERS = [*NOT_NUMBERS, 0.5, 2.0, np.nan, np.inf, np.float32(2), 2**70, -(2**70), 10**5000, -1]
NOT_REALS = [*NOT_NUMBERS, None, np.nan, 10**400, -(10**5000)]

INTEGERS = [
    ("limit", lambda r, x: impinge.intersecting_pairs(MESH, MESH, limit=x)),
    ("n", lambda r, x: enter(x)),
    ("most_points", lambda r, x: impinge.contacts(BALL, BALL, most_points=x)),
    ("count", lambda r, x: TREE.nearest(ORIGIN, x)),
    ("volumes", lambda r, x: impinge.Character(PATH, volumes=x)),
    ("pieces", lambda r, x: impinge.Character(PATH, volumes=1, pieces=x)),
    ("animation", lambda r, x: r.at(x)),
    ("layers", lambda r, x: world().insert(BALL, layers=x)),
    ("meets", lambda r, x: world().insert(BALL, meets=x)),
    ("layers", lambda r, x: world().set_traits(1, layers=x)),
    ("meets", lambda r, x: world().set_traits(1, meets=x)),
    ("layers", lambda r, x: world().ray_cast(ORIGIN, ALONG, layers=x)),
    ("layers", lambda r, x: world().ray_cast_all(ORIGIN, ALONG, layers=x)),
    ("layers", lambda r, x: world().overlapping(BALL, layers=x)),
    ("layers", lambda r, x: world().in_boxes(ORIGIN, ALONG, layers=x)),
    ("layers", lambda r, x: world().at_points(ORIGIN, layers=x)),
    ("tag", lambda r, x: impinge.PartBodies.insert(world(), r.at(), tag=x)),
    ("size", lambda r, x: impinge.show(MESH, MESH, size=(64, x))),
    ("num_max_contacts", lambda r, x: collided(x)),
]
"""Calls that take one integer, by the name of the argument."""

REAL = [
    ("clearance", lambda r, x: impinge.within(MESH, MESH, x)),
    ("clearance", lambda r, x: impinge.within(BALL, BALL, x)),
    ("margin", lambda r, x: impinge.contacts(BALL, BALL, margin=x)),
    ("t", lambda r, x: MOTION.at(x)),
    ("radius", lambda r, x: impinge.Shape.sphere(x)),
    ("radius", lambda r, x: impinge.Shape.capsule(ORIGIN, ALONG, x)),
    ("half_height", lambda r, x: impinge.Shape.cylinder(x, 1)),
    ("radius", lambda r, x: impinge.Shape.cone(1, x)),
    ("level", lambda r, x: impinge.Shape.half_space(ALONG, x)),
    ("reach", lambda r, x: world().ray_cast(ORIGIN, ALONG, reach=x)),
    ("reach", lambda r, x: world().ray_cast_all(ORIGIN, ALONG, reach=x)),
    ("reach", lambda r, x: TREE.ray_cast(ORIGIN, ALONG, reach=x)),
    ("reach", lambda r, x: TREE.ray_cast_all(ORIGIN, ALONG, reach=x)),
    ("margin", lambda r, x: partition.BoxTree(margin=x)),
    ("cell", lambda r, x: partition.HashedGrid(x)),
    ("cell", lambda r, x: partition.HierarchicalGrid(x)),
    ("cell", lambda r, x: partition.UniformGrid([ORIGIN, [9, 9, 9]], x)),
    ("time", lambda r, x: r.at(0, x)),
    ("view", lambda r, x: impinge.show(MESH, MESH, size=(16, 16), view=(0, x))),
    ("radius", lambda r, x: fcl.Sphere(x)),
    ("lz", lambda r, x: fcl.Capsule(1, x)),
    ("y", lambda r, x: fcl.Box(1, x, 1)),
    ("d", lambda r, x: fcl.Halfspace(ALONG, x)),
]
"""Calls that take one real number, by the name of the argument."""

INTEGER_ARRAYS = [
    ("bodies", lambda x: world().remove(x)),
    ("bodies", lambda x: world().poses(x)),
    ("body", lambda x: world().pairs(x)),
    ("body", lambda x: world().set_shape(x, BALL)),
    ("body", lambda x: world().refit(x, cube()[0])),
    ("owner", lambda x: world().insert(BALL, owner=x)),
    ("tag", lambda x: world().insert(BALL, tag=x)),
    ("keys", TREE.boxes),
    ("keys", lambda x: TREE.step(x, [ORIGIN], [ALONG])),
    ("removed", lambda x: TREE.step([0], [ORIGIN], [ALONG], removed=x)),
    ("faces", lambda x: impinge.Mesh(cube()[0], [[0, 1, x]])),
]
"""Calls that take one or many integers, by the name of the argument."""

FLAGS = [
    ("progress", lambda x: impinge.intersects(MESH, MESH, progress=x)),
    ("progress", lambda x: impinge.intersects(BALL, BALL, progress=x)),
    ("progress", lambda x: impinge.time_of_impact(MESH, MESH, progress=x)),
    ("progress", lambda x: impinge.time_of_impact(BALL, BALL, progress=x)),
    ("progress", lambda x: SCENE.check(progress=x)),
    ("persisting", lambda x: world().step(persisting=x)),
    ("proxies", lambda x: MESH.to_baked(proxies=x)),
    ("solid", lambda x: impinge.Shape.mesh(MESH, solid=x)),
]

OPTIONS = [
    ("builder", MESH.rebuild),
    ("stop", lambda x: SCENE.check(stop=x)),
    ("axis", partition.SweepOneAxis),
    ("mode", lambda x: impinge.Character(PATH, mode=x)),
    ("method", lambda x: fit.sphere([ORIGIN], x)),
    ("up", lambda x: impinge.show(MESH, MESH, up=x)),
    ("focus", lambda x: impinge.show(MESH, MESH, focus=x)),
    ("bits", WIDTHS.packed),
    ("bits", RADIUS.packed),
    ("path", impinge.load),
    ("path", impinge.load_scene),
    ("path", MESH.bake),
    ("path", impinge.Character),
    ("plan", lambda x: impinge.Character(PATH, plan=x)),
    ("fitted", lambda x: impinge.Character.load(PATH, x)),
    ("names", lambda x: impinge.load_scene(PATH, names=x)),
    ("parts", impinge.Scene),
    ("poses", lambda x: impinge.Scene({"a": MESH}, poses=x)),
    ("details", lambda x: impinge.Scene({"a": MESH}, details=x)),
    ("name", SCENE.details),
    ("ignored", lambda x: impinge.Scene({"a": MESH}, ignored=x)),
    ("a", lambda x: SCENE.ignore(x, "a")),
    ("poses", SCENE.check),
    ("other", TREE.pairs_with),
]


def collided(most):
    ball = fcl.CollisionObject(fcl.Sphere(1))
    return fcl.collide(ball, ball, fcl.CollisionRequest(most))


def refused(ask, *arguments):
    with pytest.raises(impinge.InputError) as caught:
        ask(*arguments)
    return caught.value.what


def ids(table):
    return [f"{number}-{row[0]}" for number, row in enumerate(table)]


@pytest.mark.parametrize(("name", "ask"), INTEGERS, ids=ids(INTEGERS))
def test_invalid_integers_raise_an_error_with_the_name(name, ask, robot):
    assert [refused(ask, robot, wrong) for wrong in NOT_INTEGERS] == [name] * len(NOT_INTEGERS)
    for right in (64,) if name in ("size", "volumes", "pieces") else (2, np.int64(2), np.uint8(2), np.array(2)):
        ask(robot, right)


@pytest.mark.parametrize(("name", "ask"), REAL, ids=ids(REAL))
def test_invalid_numbers_raise_an_error_with_the_name(name, ask, robot):
    assert [refused(ask, robot, wrong) for wrong in NOT_REALS] == [name] * len(NOT_REALS)
    for right in (0.75, 1, np.float32(0.75), np.int8(1), np.array(0.75)):
        ask(robot, right)


@pytest.mark.parametrize(("name", "ask"), INTEGER_ARRAYS, ids=ids(INTEGER_ARRAYS))
def test_invalid_integer_arrays_raise_an_error_with_the_name(name, ask):
    for wrong in (2**70, [2**65], -1, [[1], [1, 2]], 0.5, [True], "7", [None], {}, 1j):
        assert refused(ask, wrong) == name


@pytest.mark.parametrize(("name", "ask"), FLAGS, ids=ids(FLAGS))
def test_invalid_flags_raise_an_error_with_the_name(name, ask):
    for wrong in (0, 1, 2**70, 0.5, "yes", None, [], np.array([True, False])):
        assert refused(ask, wrong) == name
    for right in (True, False, np.True_):
        ask(right)


@pytest.mark.parametrize(("name", "ask"), OPTIONS, ids=ids(OPTIONS))
def test_invalid_options_raise_an_error_with_the_name(name, ask):
    for wrong in (2**70, 0.5, True, b"x", 1j, object(), [1], np.array([1, 2])):
        assert refused(ask, wrong) == name


def test_errors_name_the_ends_of_a_capsule():
    for wrong in ([np.nan, 0, 0], [0, 0, 2.0**128], [0, 0], "end"):
        assert refused(impinge.Shape.capsule, wrong, ORIGIN, 1) == "start"
        assert refused(impinge.Shape.capsule, ORIGIN, wrong, 1) == "end"


def test_animations_are_names_or_integers(robot):
    """0.5 and True are rejected, although they are less than the number of animations."""
    for wrong in (0.5, 1.0, True, np.True_, np.float64(0)):
        assert refused(robot.at, wrong) == "animation"
    assert np.array_equal(robot.at(np.int64(1), 0.2).frames, robot.at(robot.animations[1].name, 0.2).frames)
