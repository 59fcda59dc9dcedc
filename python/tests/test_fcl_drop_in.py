"""`impinge.fcl` behaves as python-fcl does; the cases are from python-fcl's tests/test_fcl.py."""

import impinge
import numpy as np
import pytest
from impinge import fcl
from shapes import cube, torus

X_TURN = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def model(vertices, faces):
    made = fcl.BVHModel()
    assert made.beginModel(len(faces), len(vertices)) == 0
    assert made.addSubModel(vertices, faces) is True
    assert made.endModel() == 0
    return made


def geometries():
    tetrahedron = model(
        np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]
    )
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    convex = fcl.Convex(cube()[0], 6, np.insert(quads, 0, 4, axis=1).ravel())
    return {"box": fcl.Box(1, 1, 1), "convex": convex, "mesh": tetrahedron}


@pytest.mark.parametrize("a", ["box", "convex", "mesh"])
@pytest.mark.parametrize("b", ["box", "convex", "mesh"])
def test_pairs_of_geometries_collide_as_in_python_fcl(a, b):
    request = fcl.CollisionRequest(num_max_contacts=100, enable_contact=True)
    one, two = (fcl.CollisionObject(geometries()[name]) for name in (a, b))
    for offset, rotation, meets in [
        ((0, 0, 0), np.eye(3), True),
        ((0, 0, 0), X_TURN, True),
        ((0.0, 0.0, -0.4), np.eye(3), True),
        ((0, 0, -1.6), np.eye(3), False),
        ((0, 3, 0), X_TURN, False),
    ]:
        two.setTranslation(np.array(offset))
        two.setRotation(rotation)
        result = fcl.CollisionResult()
        count = fcl.collide(one, two, request, result)
        assert (count > 0) == result.is_collision == meets
        assert count == len(result.contacts) <= 100
        for contact in result.contacts:
            assert contact.o1 is one.geometry
            assert contact.o2 is two.geometry
            assert np.isfinite(contact.pos).all()


def test_contacts_are_the_exact_pairs_and_lie_on_both_surfaces():
    vertices, faces = torus()
    mesh = impinge.Mesh(vertices, faces)
    pose = impinge.pose([0.5, 0.1, 0.2], rpy=[1.0, 0.3, 0.2])
    one = fcl.CollisionObject(model(vertices, faces))
    two = fcl.CollisionObject(model(vertices, faces), fcl.Transform(pose[:3, :3], pose[:3, 3]))
    result = fcl.CollisionResult()
    fcl.collide(one, two, fcl.CollisionRequest(num_max_contacts=10**6, enable_contact=True), result)
    expected = impinge.intersecting_pairs(mesh, mesh, pose_b=pose)
    assert [[c.b1, c.b2] for c in result.contacts] == expected.tolist()
    points = np.array([c.pos for c in result.contacts])
    for corners, at in ((vertices[faces[expected[:, 0]]], np.eye(4)), (vertices[faces[expected[:, 1]]], pose)):
        world = corners @ at[:3, :3].T + at[:3, 3]
        normals = np.cross(world[:, 1] - world[:, 0], world[:, 2] - world[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        assert np.abs(((points - world[:, 0]) * normals).sum(axis=1)).max() < 1e-12
    assert fcl.collide(one, two, fcl.CollisionRequest(num_max_contacts=7)) == 7
    assert fcl.collide(one, two) == 1


def test_coplanar_contacts_have_a_common_point():
    square = model([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], [[0, 1, 2], [0, 2, 3]])
    for offset in ((0.5, 0.25, 0), (2, 2, 0), (2, 0.5, 0), (0, 0, 0)):
        one, two = fcl.CollisionObject(square), fcl.CollisionObject(square, fcl.Transform(np.array(offset)))
        result = fcl.CollisionResult()
        assert fcl.collide(one, two, fcl.CollisionRequest(100, True), result) > 0
        for contact in result.contacts:
            assert contact.pos[2] == 0
            assert (contact.pos >= offset).all()
            assert (contact.pos <= 2).all()


def test_a_solid_collides_with_bodies_inside_it():
    small, large = fcl.CollisionObject(fcl.Box(1, 1, 1)), fcl.CollisionObject(fcl.Box(8, 8, 8))
    shell = fcl.CollisionObject(model(*cube(-4, 4)))
    result = fcl.CollisionResult()
    assert fcl.collide(small, large, fcl.CollisionRequest(10, True), result) == 1
    assert (result.contacts[0].b1, result.contacts[0].b2) == (-1, -1)
    assert (np.abs(result.contacts[0].pos) <= 0.5).all()
    assert fcl.collide(large, small) == 1
    assert fcl.collide(small, shell) == 0
    for at, meets in (((4.5, 0, 0), True), ((3.4999, 0, 0), True), ((np.nextafter(4.5, 5), 0, 0), False)):
        small.setTranslation(at)
        assert (fcl.collide(small, large) > 0) == meets


def contacts(one, two, limit=1000):
    result = fcl.CollisionResult()
    fcl.collide(one, two, fcl.CollisionRequest(limit, True), result)
    return result.contacts


def test_normals_separate_solids_by_the_shortest_translation():
    """The normal points from the first box to the second."""
    one, two = fcl.CollisionObject(fcl.Box(2, 2, 2)), fcl.CollisionObject(fcl.Box(2, 2, 2))
    ball = fcl.CollisionObject(fcl.Sphere(1))
    for sign in (1, -1):
        for other, depth in ((two, 0.75), (ball, 0.75)):
            other.setTranslation([sign * 1.25, 0.25, 0])
            found = contacts(one, other)
            assert found
            for contact in found:
                assert contact.normal == pytest.approx([sign, 0, 0], abs=1e-9)
                assert contact.penetration_depth == pytest.approx(depth, abs=1e-9)
            back = contacts(other, one)
            assert back[0].normal == pytest.approx([-sign, 0, 0], abs=1e-9)
    two.setTranslation([2, 0, 0])
    assert max(contact.penetration_depth for contact in contacts(one, two)) < 1e-12
    inside = fcl.CollisionObject(fcl.Box(0.5, 0.5, 0.5), fcl.Transform(np.array([0, 0.5, 0])))
    (contact,) = contacts(one, inside)
    assert contact.normal == pytest.approx([0, 1, 0])
    assert contact.penetration_depth == pytest.approx(0.75)


def test_normals_of_surfaces_are_those_of_their_contact_regions():
    """Two arms of a comb are at different depths in a floor; each pair has those of its arm."""
    arms = [cube(), cube()]
    tips = [
        vertices * [0.5, 0.5, 2] + [x, 0, z] for (vertices, _), x, z in zip(arms, (-2, 2), (0.75, 0.5), strict=True)
    ]
    comb = model(np.concatenate(tips), np.concatenate([arms[0][1], arms[1][1] + 8]))
    vertices, faces = cube()
    floor = model(vertices * [9, 9, 2] - [0, 0, 1], faces)
    found = contacts(fcl.CollisionObject(floor), fcl.CollisionObject(comb))
    assert len(found) >= 16
    for contact in found:
        deep = 0.25 if contact.pos[0] < 0 else 0.5
        assert contact.normal == pytest.approx([0, 0, 1], abs=1e-9)
        assert contact.penetration_depth == pytest.approx(deep, abs=1e-9)
    turned = contacts(fcl.CollisionObject(comb), fcl.CollisionObject(floor), limit=3)
    assert len(turned) == 3
    assert all(contact.normal == pytest.approx([0, 0, -1], abs=1e-9) for contact in turned)


def test_normals_of_a_body_inside_a_solid():
    ring = fcl.CollisionObject(model(*torus(radius=0.5, tube=0.1)), fcl.Transform(np.array([2.25, 0, 0])))
    box = fcl.CollisionObject(fcl.Box(6, 6, 6))
    (contact,) = contacts(box, ring)
    assert contact.normal == pytest.approx([1, 0, 0], abs=1e-6)
    assert contact.penetration_depth == pytest.approx(3 - 1.65, abs=1e-6)


def test_transforms_have_the_constructors_of_python_fcl():
    turn = fcl.Transform(X_TURN)
    assert np.allclose(turn.getQuatRotation(), [np.sqrt(0.5), np.sqrt(0.5), 0, 0])
    for args in [(np.array([1.0, 2, 3]),), (X_TURN, [1, 2, 3]), (turn.getQuatRotation(), np.array([[1], [2], [3]]))]:
        assert fcl.Transform(*args).getTranslation().tolist() == [1, 2, 3]
    assert np.allclose(fcl.Transform(turn.getQuatRotation()).getRotation(), X_TURN)
    assert np.array_equal(fcl.Transform(turn).getRotation(), X_TURN)
    rng = np.random.default_rng(4)
    quaternions = rng.normal(size=(50, 4))
    for q in quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True):
        back = fcl.Transform(q).getQuatRotation()
        assert np.allclose(back, q if q[0] >= 0 else -q, atol=1e-12)
    moved = fcl.CollisionObject(fcl.Box(1, 1, 1), turn)
    moved.getTransform().setTranslation([9, 9, 9])  # a copy
    assert moved.getTranslation().tolist() == [0, 0, 0]
    moved.setQuatRotation([1, 0, 0, 0])
    assert np.array_equal(moved.getRotation(), np.eye(3))
    for wrong in [(1, 2, 3), (np.eye(4),), (np.eye(3), [1, 2])]:
        with pytest.raises(ValueError, match=r"expected|at most"):
            fcl.Transform(*wrong)


def managers():
    box, cone = fcl.Box(1, 1, 1), geometries()["mesh"]
    first = [fcl.CollisionObject(box), fcl.CollisionObject(cone), fcl.CollisionObject(geometries()["convex"])]
    second = [fcl.CollisionObject(box), fcl.CollisionObject(box), fcl.CollisionObject(cone)]
    for obj, at in zip(second, ([0.0, 3, 0], [0, 0.5, 0], [0.0, 0, 9]), strict=True):
        obj.setTranslation(at)
    made = []
    for objects in (first, second):
        manager = fcl.DynamicAABBTreeCollisionManager()
        manager.registerObjects(objects)
        manager.setup()
        made.append(manager)
    return made


def test_managers_find_the_pairs_of_a_loop():
    one, two = managers()
    data = fcl.CollisionData(fcl.CollisionRequest(num_max_contacts=10_000))
    one.collide(data, fcl.defaultCollisionCallback)
    assert data.result.is_collision
    assert {(c.o1, c.o2) for c in data.result.contacts} == {
        (a.geometry, b.geometry) for i, a in enumerate(one.getObjects()) for b in one.getObjects()[i + 1 :]
    }
    data = fcl.CollisionData(fcl.CollisionRequest(num_max_contacts=10_000))
    one.collide(two, data, fcl.defaultCollisionCallback)
    assert {c.o2 for c in data.result.contacts} == {two.getObjects()[1].geometry}
    alone = fcl.CollisionObject(fcl.Box(0.5, 0.5, 0.5), fcl.Transform([0.0, 3.0, 0.0]))
    for manager, meets in ((one, False), (two, True)):
        data = fcl.CollisionData()
        manager.collide(alone, data, fcl.defaultCollisionCallback)
        assert data.result.is_collision is meets
        assert data.done is meets
    alone.setTranslation([0, 0, 0])
    data = fcl.CollisionData()
    one.collide(alone, data, fcl.defaultCollisionCallback)
    assert data.result.is_collision


def test_callbacks_are_called_until_they_return_true():
    one, _ = managers()
    handed = []
    one.collide("mine", lambda a, b, data: handed.append((a, b, data)))
    assert len(handed) == 3
    assert all(isinstance(a, fcl.CollisionObject) and data == "mine" for a, _, data in handed)
    handed.clear()
    one.collide(None, lambda a, b, data: handed.append(a) or True)
    assert len(handed) == 1


def test_managers_register_and_unregister_objects():
    one, _ = managers()
    first = one.getObjects()[0]
    assert (one.size(), one.empty()) == (3, False)
    one.unregisterObject(first)
    one.update()
    assert first not in one.getObjects()
    one.registerObject(first)
    assert one.getObjects()[-1] is first
    one.clear()
    assert one.empty()
    with pytest.raises(ValueError, match="must be"):
        one.collide(1)


def test_the_broad_phase_misses_no_pair():
    rng = np.random.default_rng(7)
    ring = model(*torus())
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects([fcl.CollisionObject(ring, fcl.Transform(at)) for at in rng.uniform(-4, 4, size=(40, 3))])
    found = set()

    def callback(a, b, _):
        if fcl.collide(a, b):
            found.add((manager.getObjects().index(a), manager.getObjects().index(b)))
        return False

    manager.collide(None, callback)
    mesh, objects = impinge.Mesh(*torus()), manager.getObjects()
    everyone = {
        (i, j)
        for i in range(40)
        for j in range(i + 1, 40)
        if impinge.intersects(mesh, mesh, objects[i].matrix, objects[j].matrix)
    }
    assert found == everyone
    assert 10 < len(everyone) < 400


def test_invalid_arguments_raise_a_value_error():
    for wrong in [
        lambda: fcl.CollisionObject("box"),
        lambda: fcl.collide(fcl.CollisionObject(fcl.BVHModel()), fcl.CollisionObject(fcl.Box(1, 1, 1))),
        lambda: fcl.Convex(cube()[0], 1, [3, 0, 1]),
        lambda: fcl.Convex(cube()[0], 1, [3, 0, 1, 8]),
        lambda: fcl.Box(np.nan, 1, 1),
    ]:
        with pytest.raises(impinge.InputError):
            wrong()


# (a, b, translation of b, distance in python-fcl 0.7); surfaces are hollow, solids are filled.
DISTANCES = [
    ("box", "box", (0, 0, 0), -1),
    ("box", "box", (0.75, 0, 0), -1),
    ("box", "box", (1, 0, 0), 0),
    ("box", "box", (6, 0.1, 0.2), 5),
    ("surface", "surface", (0, 0, 0), 0),
    ("surface", "surface", (1, 0, 0), 0),
    ("surface", "surface", (6, 0.1, 0.2), 5),
    ("surface", "large surface", (0, 0, 0), 1.5),
    ("surface", "large surface", (0.75, 0, 0), 0.75),
    ("box", "large box", (1, 0, 0), -1),
    ("box", "large surface", (0, 0, 0), 1.5),
    ("box", "large surface", (6, 0.1, 0.2), 3.5),
    ("surface", "large box", (0, 0, 0), -1),
    ("surface", "large box", (6, 0.1, 0.2), 3.5),
]


@pytest.mark.parametrize(("a", "b", "translation", "expected"), DISTANCES)
def test_distances_equal_those_of_python_fcl(a, b, translation, expected):
    known = {"box": fcl.Box(1, 1, 1), "surface": model(*cube()), "large box": fcl.Box(4, 4, 4)}
    known["large surface"] = model(*cube(-2, 2))
    moved = fcl.Transform(np.array(translation, float))
    one, two = fcl.CollisionObject(known[a]), fcl.CollisionObject(known[b], moved)
    result = fcl.DistanceResult()
    assert fcl.distance(one, two, fcl.DistanceRequest(enable_nearest_points=True), result) == pytest.approx(expected)
    assert result.min_distance == pytest.approx(expected)
    assert (result.o1, result.o2) == (known[a], known[b])
    if expected >= 0:
        assert [face >= 0 for face in (result.b1, result.b2)] == ["surface" in a, "surface" in b]
    apart = np.linalg.norm(result.nearest_points[0] - result.nearest_points[1])
    assert apart == pytest.approx(max(expected, 0), abs=1e-12)
    assert fcl.distance(two, one) == pytest.approx(expected)
    kept = fcl.DistanceResult()
    kept.min_distance = -2.0
    fcl.distance(one, two, None, kept)
    assert (kept.min_distance, kept.o1) == (-2.0, None)


def test_signed_distances_are_negative_depths():
    boxes = [fcl.CollisionObject(fcl.Box(1, 1, 1), fcl.Transform(np.array([x, 0.0, 0.0]))) for x in (0, 5, 8)]
    signed = fcl.DistanceRequest(enable_nearest_points=True, enable_signed_distance=True)
    moved, result = (
        fcl.CollisionObject(fcl.Box(1, 1, 1), fcl.Transform(np.array([0.75, 0.0, 0.0]))),
        fcl.DistanceResult(),
    )
    assert fcl.distance(boxes[0], moved, signed, result) == pytest.approx(-0.25)
    assert result.min_distance == pytest.approx(-0.25)
    assert abs(result.nearest_points[1] - result.nearest_points[0])[0] == pytest.approx(0.25)
    assert fcl.distance(boxes[0], moved) == -1
    manager, other = fcl.DynamicAABBTreeCollisionManager(), fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects(boxes)
    other.registerObjects([boxes[1], boxes[2]])
    for arguments, expected in (((), 2), ((moved,), -0.25), ((other,), -1)):
        data = fcl.DistanceData(signed)
        manager.distance(*arguments, data, fcl.defaultDistanceCallback)
        assert data.result.min_distance == pytest.approx(expected)
    asked = []

    def first(o1, o2, cdata, dist):
        asked.append((o1, o2, dist))
        return True, 0.0

    manager.distance(fcl.DistanceData(), first)
    assert asked == [(boxes[1], boxes[2], np.inf)]
    done = fcl.DistanceData()
    done.done = True
    assert fcl.defaultDistanceCallback(boxes[0], boxes[1], done, 3.0) == (True, np.inf)
    with pytest.raises(impinge.InputError):
        manager.distance(data)


def placed(geometry, *translation):
    return fcl.CollisionObject(geometry, fcl.Transform(np.array(translation, float)))


def test_round_solids_equal_closed_forms():
    """Spheres and capsules from the tests of FCL, and closed forms."""
    signed = fcl.DistanceRequest(enable_nearest_points=True, enable_signed_distance=True)
    facts = [
        (fcl.Sphere(20), fcl.Sphere(10), [40, 0, 0], 10),
        (fcl.Sphere(20), fcl.Sphere(10), [25, 0, 0], -5),
        (fcl.Sphere(20), fcl.Capsule(10, 20), [40, 0, 0], 10),
        (fcl.Sphere(20), fcl.Capsule(10, 20), [25, 0, 0], -5),
        (fcl.Cylinder(1, 2), fcl.Box(2, 2, 2), [0, 0, 2.5], 0.5),
        (fcl.Cone(1, 2), fcl.Sphere(0.5), [0, 0, 3], 1.5),
        (fcl.Ellipsoid(1, 2, 3), fcl.Sphere(1), [0, 0, 5], 1),
        (fcl.Halfspace([0, 0, 2], 2), fcl.Sphere(1), [7, 7, 4], 2),
        (fcl.Halfspace([0, 0, 2], 2), fcl.Box(2, 2, 2), [7, 7, 1.5], -0.5),
    ]
    for a, b, at, expected in facts:
        one, two, result = placed(a, 0, 0, 0), placed(b, *at), fcl.DistanceResult()
        assert fcl.distance(one, two, signed, result) == pytest.approx(expected, rel=1e-9)
        assert np.linalg.norm(np.subtract(*result.nearest_points)) == pytest.approx(abs(expected), rel=1e-6)
        assert fcl.distance(two, one) == pytest.approx(expected if expected > 0 else -1, rel=1e-9)
        collision = fcl.CollisionResult()
        count = fcl.collide(one, two, fcl.CollisionRequest(10, enable_contact=True), collision)
        assert (count > 0) == collision.is_collision == (expected < 0)
        assert all((contact.b1, contact.b2) == (-1, -1) and contact.pos.shape == (3,) for contact in collision.contacts)
    ring = fcl.BVHModel()
    ring.beginModel()
    ring.addSubModel(*torus())
    ring.endModel()
    ball = fcl.Sphere(0.1)
    assert fcl.collide(placed(ring, 0, 0, 0), placed(ball, 1, 0, 0)) == 0  # inside a hollow surface
    assert fcl.collide(placed(ring, 0, 0, 0), placed(ball, 1.35, 0, 0)) > 0
    assert fcl.distance(placed(ring, 0, 0, 0), placed(ball, 1.35, 0, 0), signed) == -1
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects([placed(ball, x, 0, 0) for x in (3, 5, 9)] + [placed(fcl.Halfspace([1, 0, 0], 0), 0, 0, 0)])
    data = fcl.DistanceData()
    manager.distance(data, fcl.defaultDistanceCallback)
    assert data.result.min_distance == pytest.approx(1.8)
    hits = fcl.CollisionData()
    manager.collide(placed(fcl.Sphere(4.5), 0, 0, 0), hits, fcl.defaultCollisionCallback)
    assert hits.result.is_collision
    for wrong in (lambda: fcl.Sphere(-1), lambda: fcl.Halfspace([0, 0, 0], 1), lambda: fcl.Cone(1, np.nan)):
        with pytest.raises(impinge.InputError):
            wrong()
