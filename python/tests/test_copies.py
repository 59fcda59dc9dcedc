"""Copies and pickles of every public class equal the original, and continue like it."""

import copy
import dataclasses
import inspect
import pickle
from pathlib import Path

import impinge
import impinge.fcl
import impinge.trimesh
import numpy as np
import pytest
from impinge import Shape, fcl, partition, pose
from shapes import TRIANGLE, cube, torus
from visible_state import state

ROBOT = Path(__file__).resolve().parents[2] / "data" / "robot.glb"


def pickled(thing, protocol=5):
    return pickle.loads(pickle.dumps(thing, protocol))


COPIES = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle 2": lambda thing: pickled(thing, 2),
    "pickle 5": pickled,
}


def examples():
    """Returns one instance of each public class, by class."""
    mesh = impinge.Mesh(*torus(12, 8))
    box = impinge.Mesh(*cube())
    world = impinge.World()
    balls = world.insert(Shape.sphere(1), pose([[0, 0, 0], [1.5, 0, 0]]))
    step = world.step()
    robot = impinge.Character(ROBOT, volumes=2)
    posed = robot.at("Robot_Walking", 0.5, origin=[1, 2, 3])
    ray, rays = [0, 0, -9], [[0, 0, -9]]
    scene = impinge.Scene({"a": mesh, "b": box}, poses={"b": pose([1, 2, 3])}, ignored=[])
    points = cube()[0]
    loaded = impinge.Mesh.from_baked(mesh.to_baked())
    request, result = fcl.CollisionRequest(9, True), fcl.CollisionResult()
    one, two = fcl.CollisionObject(fcl.Box(1, 1, 1)), fcl.CollisionObject(fcl.Box(2, 2, 2))
    fcl.collide(one, two, request, result)
    manager, crowd = fcl.DynamicAABBTreeCollisionManager(), impinge.trimesh.CollisionManager()
    manager.registerObjects([one, two])
    crowd.add_object("box", box)
    crowd.add_object("ring", mesh)
    _, _, distances = crowd.min_distance_internal(return_names=True, return_data=True)
    _, data = crowd.in_collision_single(mesh, pose([0.5, 0, 0]), return_data=True)
    low, high = [[0, 0, 0], [2, 0, 0]], [[2, 1, 1], [3, 1, 1]]
    grid, space = partition.HashedGrid(2, low, high), [[0, 0, 0], [4, 4, 4]]
    wide, about = impinge.fit.MinWidths([0, 0, 0], [1, 2, 3]), impinge.fit.CenterRadius([0, 0, 0], [1, 2, 3])
    boxes = [wide, about, wide.packed(8), about.packed(16), impinge.fit.AabbBatch(low, high)]
    with pytest.raises(impinge.InputError) as caught:
        impinge.Mesh([[0, 0, 0]], [[0, 1, 2]])
    gantry = impinge.Robot.load(ROBOT.parent / "robots" / "gantry.urdf")
    crossing = impinge.Scene({"a": box, "b": box, "c": box}, poses={"c": pose([0.5, 0, 0])})
    clashes = impinge.clash(crossing)
    made = [
        impinge.show(mesh, box, size=(16, 16)),
        clashes, clashes[0], clashes[0].a, clashes.duplicates[0], clashes.groups()[0], clashes.diff(clashes),
        gantry, gantry.check(np.zeros((2, 5))), impinge.Joint("a", "b", "c"), gantry.clearance(np.zeros(5)),
        gantry.check_motion(np.zeros(5), np.ones(5) * 0.01), gantry.audit(10, max_boxes=4),
        mesh, world, balls, step, step.work, world.save(), world.ray_cast(ray, [0, 0, 1]), robot, posed,
        world.nearest(box), world.shape_cast(box, impinge.Motion(None, None)),
        world.shape_cast_all(box, impinge.Motion(pose([[0, 0, 9]]), None)),
        world.ray_cast_all(rays, [0, 0, 1]), world.at_points(np.zeros((1, 3))), world.contacts(), world.contacts()[0],
        robot.parts[0], robot.animations[0], robot.leaks(), posed.ray_cast(ray, [0, 0, 1]),
        posed.surface_ray_cast(ray, [0, 0, 1]), impinge.PartBodies.insert(impinge.World(), posed),
        posed.ray_cast_all(rays, [0, 0, 1]), posed.struck_by_character(robot.at(origin=[1, 2, 3])),
        mesh.closest_point(ray), mesh.ray_cast(ray, ray), mesh.ray_cast_all(rays, ray), mesh.health(),
        mesh.tree_statistics(), mesh.repaired(orient=True)[1], loaded.origin, impinge.distance(mesh, box),
        impinge.convex_hull(points),
        impinge.minimal_sphere(points), impinge.penetration(box, box), impinge.depth(box, box),
        impinge.Motion(None, pose([1, 0, 0])),
        impinge.time_of_impact(box, box), impinge.intersecting_pairs(box, box, pose([[0, 0, 0]])), scene,
        impinge.Details("k", "IfcWall", ("a",), {"b": "c"}),
        scene.check(), Shape.box([1, 2, 3]), caught.value, impinge.LoadWarning("a warning"), impinge.Status.SINGULAR,
        impinge.intersecting_pairs(box, box, limit=3), impinge.fit.obb(points), impinge.fit.capsule(points),
        impinge.fit.lozenge(points), impinge.fit.aabb(points), impinge.fit.kdop(points), *boxes, request, result,
        impinge.fit.proxies(box), box.convex_parts(), box.convex_parts().parts[0],
        result.contacts[0], fcl.CollisionData(), fcl.DistanceRequest(), fcl.DistanceResult(), fcl.DistanceData(), one,
        manager, crowd, distances, data[0], fcl.BVHModel(), fcl.Capsule(1, 2), fcl.Cone(1, 2), fcl.Cylinder(1, 2),
        fcl.Sphere(1), fcl.Ellipsoid(1, 2, 3), fcl.Halfspace([0, 0, 1], 0), fcl.TriangleP(*TRIANGLE[0][:3]),
        grid, grid.step([5], [[1, 1, 1]]), grid.overlapping(low), grid.ray_cast(ray, ray), grid.nearest(ray),
        grid.ray_cast_all(rays, ray), partition.UniformGrid(space, 1, low, high), partition.Octree(space, low, high),
        partition.LooseOctree(space, low, high), partition.HierarchicalGrid(1, low, high), partition.KdTree(low),
        partition.BspTree(low, high), partition.SweepOneAxis("x", low, high), partition.SweepThreeAxes(low, high),
        partition.BoxTree(low, high, margin=0.5), impinge.SolidBsp(box),
        fcl.Convex(*TRIANGLE[:1], 1, [3, 0, 1, 2]), fcl.Transform([1, 2, 3]), fcl.Box(1, 2, 3), fcl.CollisionGeometry(),
    ]  # fmt: skip
    return {type(thing): thing for thing in made}


@pytest.fixture(scope="module")
def things():
    return examples()


MODULES = (impinge, impinge.fcl, impinge.fit, partition, impinge.trimesh)
PUBLIC = dict.fromkeys(getattr(module, name) for module in MODULES for name in module.__all__)
CLASSES = [one for one in PUBLIC if inspect.isclass(one) and not set(one.__subclasses__()) & set(PUBLIC)]
"""Public classes with instances, without base classes of other public classes."""


@pytest.mark.parametrize("public", CLASSES)
@pytest.mark.parametrize("way", COPIES)
def test_copies_of_every_public_class_equal_the_original(things, public, way):
    thing = things[public]
    again = COPIES[way](thing)
    assert type(again) is public
    assert state(again) == state(thing)
    assert repr(again) == repr(thing) or " at 0x" in repr(thing)


def test_the_list_of_public_classes_is_complete():
    assert len(CLASSES) > 65


def test_a_copy_of_a_mesh_shares_data_until_a_refit():
    vertices, faces = torus()
    mesh = impinge.Mesh(vertices, faces)
    mesh.refit(vertices * [1, 1, 4])
    aged = mesh.aging
    shown = mesh.vertices
    for other in (copy.copy(mesh), copy.deepcopy(mesh)):
        assert other.vertices is shown
        assert other.faces is mesh.faces
        assert other.aging == aged  # the hierarchy is shared, not rebuilt
        mesh.refit(vertices + 9)
        assert np.array_equal(other.vertices, shown)
        other.refit(vertices - 9)
        assert np.array_equal(mesh.vertices, vertices + 9)
        mesh.refit(shown)


def test_a_pickled_shape_keeps_the_mesh_it_was_made_from():
    vertices, faces = cube()
    mesh = impinge.Mesh(vertices, faces)
    shapes = [Shape.mesh(mesh, solid=True), Shape.compound([(mesh, None), (Shape.mesh(mesh), pose([3, 0, 0]))])]
    mesh.refit(vertices + 100)
    probe = Shape.sphere(0.25, [0.5, 0, 0])
    for shape in shapes:
        assert impinge.intersects(pickled(shape), probe) is impinge.intersects(shape, probe) is True
    assert not impinge.intersects(Shape.mesh(mesh), probe)
    assert pickled(shapes[0]).bounds.tolist() == shapes[0].bounds.tolist()


def apart(a, b):
    """Rejects pairs, as a filter, if the sum of their handles is divisible by 7."""
    return (a + b) % 7 != 0


def crowd(rng, **options):
    """Returns a world with changes of every kind that no step has reported yet."""
    world = impinge.World(**options)
    mesh = impinge.Mesh(*cube())
    at = pose(rng.uniform(-2, 2, (12, 3)))
    shapes = [Shape.sphere(0.6), mesh, Shape.mesh(mesh, solid=True), Shape.hull(cube()[0]), Shape.half_space([0, 0, 1])]
    for row, shape in enumerate(shapes[:-1]):
        world.insert(shape, at[3 * row : 3 * row + 3], tag=[1, 0, 1], owner=[row, 7, 7])
    world.insert(shapes[-1], kind="static", layers=2)
    world.step()
    bodies = world.bodies
    world.remove(bodies[1])
    world.refit(int(bodies[4]), cube()[0] * 1.5)
    world.set_poses(bodies[7], pose([0.25, 0.25, 0.5]))
    world.set_traits(bodies[8], layers=5)
    world.insert(Shape.capsule([0, 0, 0], [0, 0, 1], 0.5), pose([0.5, 0, 0]))
    mesh.refit(cube()[0] + 50)  # does not affect the world
    return world


def history(world, steps, seed=5):
    """Returns all reports of a world over several random steps, as text."""
    rng, story = np.random.default_rng(seed), []
    for _ in range(steps):
        handles = np.array([body for body in world.bodies if world.bounds(body)[0, 0] > -np.inf])
        moved = handles[rng.random(len(handles)) < 0.5]
        step = world.step(moved, pose(rng.uniform(-2, 2, (len(moved), 3))), persisting=True)
        rows = world.contacts()
        story += [step.began, step.ended, step.persisting, step.work, world.pairs(), world.undecided(), rows.offsets]
        story += [getattr(rows.all, field.name) for field in dataclasses.fields(rows.all)]
        story.append(world.insert(Shape.box([0.5, 0.5, 0.5])))
    return state(story)


@pytest.mark.parametrize("broad_phase", ["auto", "tree", "columns", "three_axes"])
@pytest.mark.parametrize("way", COPIES)
def test_a_copied_world_continues_like_the_original(broad_phase, way):
    rng = np.random.default_rng(11)
    world = crowd(rng, broad_phase=broad_phase)
    before = state([world.pairs(), world.contacts().all, world.undecided()])
    other = COPIES[way](world)
    assert state([other.pairs(), other.contacts().all, other.undecided()]) == before
    assert len(world.pairs()) > 5
    expected = history(world, 3)
    assert history(other, 3) == expected
    assert history(COPIES[way](other), 2) == history(other, 2)


def test_a_world_pickles_a_picklable_filter():
    rng = np.random.default_rng(3)
    world = crowd(rng)
    world.set_filter(apart)
    expected = history(pickled(world), 2)
    assert expected == history(copy.copy(world), 2) == history(world, 2)
    world.set_filter(None)
    assert history(pickled(world), 1, 6) != expected
    world.set_filter(lambda a, b: True)
    with pytest.raises((pickle.PicklingError, AttributeError), match="lambda"):
        pickle.dumps(world)
    assert state(copy.copy(world)) == state(world)


def test_a_saved_state_pickles_without_its_world():
    world = crowd(np.random.default_rng(8))
    kept = pickle.dumps(world.save())
    expected = history(world, 2)
    other = impinge.World()
    other.restore(pickle.loads(kept))
    assert history(other, 2) == expected
    world.restore(pickle.loads(kept))
    assert history(world, 2) == expected


def test_shapes_and_arrays_of_a_world_are_pickled_once_and_out_of_band():
    world, mesh = impinge.World(), impinge.Mesh(*torus())
    for at in range(50):
        world.insert(mesh, pose([9.0 * at, 0, 0]))
    assert len(pickle.dumps(world)) < 3 * mesh.vertices.nbytes
    buffers = []
    head = pickle.dumps(world, 5, buffer_callback=buffers.append)
    assert sum(buffer.raw().nbytes for buffer in buffers) >= mesh.vertices.nbytes + mesh.faces.nbytes + 50 * 128
    # Buffers may be unaligned.
    unaligned = []
    for buffer in buffers:
        raw = bytearray(buffer.raw().nbytes + 1)
        raw[1:] = buffer.raw()
        unaligned.append(memoryview(raw)[1:])
    assert state(pickle.loads(head, buffers=unaligned)) == state(world)


def replaced(data, *path, by):
    """Returns the nested tuples with one item replaced."""
    at, *rest = path
    return (*data[:at], replaced(data[at], *rest, by=by) if rest else by, *data[at + 1 :])


def test_invalid_state_data_raise_an_error():
    world = impinge.World()
    world.insert(Shape.sphere(1), pose([[0, 0, 0], [1, 0, 0]]))
    world.step()
    data = world.save().data()
    assert state(impinge.WorldState(data)) == state(world.save())
    nan = data[5][2][1][1] * np.nan
    wrong = [
        ("version", replaced(data, 0, by=99)),
        ("option", replaced(data, 1, 0, by="cubes")),
        ("state", replaced(data, 2, 0, by=data[2][0][:1])),
        ("state", replaced(data, 2, 0, by=data[2][0][::-1] * 0)),
        ("state", replaced(data, 2, 2, by=np.array([0], np.uint32))),
        ("type", replaced(data, 3, 0, by=[object()])),
        ("state", replaced(data, 3, 1, by=data[3][1] + np.uint32(5))),
        ("non-finite", replaced(data, 4, 0, by=data[4][0] * np.nan)),
        ("state", replaced(data, 5, 0, by=data[5][0][:, ::-1])),
        ("state", replaced(data, 5, 1, by=data[5][1] * 0 + np.uint32(77))),
        ("state", replaced(data, 5, 2, 1, 1, by=nan)),
        ("state", replaced(data, 5, 2, 0, by=data[5][2][0] + 100)),
    ]
    for kind, broken in wrong:
        with pytest.raises(impinge.InputError) as caught:
            impinge.WorldState(broken)
        assert caught.value.kind == kind
    for broken in (None, (), replaced(data, 2, 0, by=data[2][0].astype(float)), replaced(data, 4, 4, by="tags")):
        with pytest.raises((TypeError, ValueError)):
            impinge.WorldState(broken)


def test_poses_of_a_character_share_it_in_one_pickle(tmp_path):
    file = tmp_path / "robot.glb"
    file.write_bytes(ROBOT.read_bytes())
    robot = impinge.Character(file, pieces=60)
    poses = [robot.at("Robot_Punch", time) for time in (0.1, 0.3)]
    first, second = pickled(poses)
    assert first.character is second.character
    fist = Shape.sphere(0.2)
    hits = [a.strikes(b, fist, pose([0, 2, -3]), pose([0, 2, 3])) for a, b in (poses, (first, second))]
    assert state(hits[0]) == state(hits[1])
    rays = np.random.default_rng(2).normal(size=(50, 3))
    assert state(first.ray_cast(-9 * rays, rays)) == state(poses[0].ray_cast(-9 * rays, rays))
    kept = pickle.dumps(robot)
    file.write_bytes(ROBOT.read_bytes().replace(b"Robot_Walking", b"Robot_Wolking"))
    with pytest.raises(impinge.InputError, match="character was pickled"):
        pickle.loads(kept)
    file.unlink()
    with pytest.raises(FileNotFoundError):
        pickle.loads(kept)


def test_an_unpickled_motion_has_the_same_poses():
    turn = impinge.Motion.screw(pose([[1, 2, 3], [0, 0, 0]]), [0, 0, 1], [0, 0, 7], pivot=[1, 0, 0])
    for motion in (turn, impinge.Motion.screw(None, [1, 0, 0], [0, 1, 0]), impinge.Motion(pose([1, 0, 0]), None)):
        again = pickled(motion)
        assert [again.at(t).tolist() for t in (0, 0.1, 1)] == [motion.at(t).tolist() for t in (0, 0.1, 1)]
