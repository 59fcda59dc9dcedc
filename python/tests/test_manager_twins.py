"""Managers answer as all pairs asked one by one through the plain verbs, in scenes full of ties."""

import itertools

import impinge
import numpy as np
import pytest
from impinge import fcl
from impinge.trimesh import CollisionManager
from shapes import cube, torus

TURNS = [[0, 0, 0], [np.pi / 2, 0, 0], [0, 0, np.pi / 4]]


class ConvexMesh:
    """A mesh that says that it is convex, as trimesh's meshes do."""

    is_convex = True

    def __init__(self, mesh):
        self.vertices, self.faces = mesh.vertices, mesh.faces


CUBE, SMALL, RING = impinge.Mesh(*cube()), impinge.Mesh(*cube(-0.125, 0.125)), impinge.Mesh(*torus(8, 6))
KINDS = [(ConvexMesh(CUBE), CUBE, True), (CUBE, CUBE, False), (ConvexMesh(SMALL), SMALL, True), (RING, RING, False)]
"""What a manager gets, its mesh, and whether it is solid."""


class Twin:
    """The meshes of a manager, asked pair by pair."""

    def __init__(self):
        self.held = {}

    def solid(self, a, b):
        solids = self.held[a][1], b[1]
        return solids[0] if solids[0] == solids[1] else "ab"[solids.index(True)]

    def intersects(self, a, b):
        mesh, _, at = self.held[a]
        return impinge.intersects(mesh, b[0], at, b[2], solid=self.solid(a, b))

    def faces(self, a, b):
        """Return the pairs of faces in contact; -1 twice if one mesh is inside the other."""
        mesh, _, at = self.held[a]
        pairs = set(map(tuple, impinge.intersecting_pairs(mesh, b[0], at, b[2]).tolist()))
        return pairs or ({(-1, -1)} if self.intersects(a, b) else set())

    def separation(self, a, b):
        (mesh, solid, at), (other, other_solid, other_at) = self.held[a], b
        far = impinge.distance(mesh, other, at, other_at, solid=self.solid(a, b)).distance
        if far > 0 or not (solid or other_solid):
            return far
        if not (solid and other_solid):
            return -1.0
        if not impinge.penetrates(mesh, other, at, other_at):
            return 0.0
        hulls = impinge.Shape.hull(mesh.vertices), impinge.Shape.hull(other.vertices)
        return -impinge.penetration(*hulls, at, other_at).depth

    def pairs(self):
        return list(itertools.combinations(self.held, 2))


def place(rng, step):
    """Return a pose on a grid, so that boxes touch, coincide and contain each other."""
    turn = TURNS[rng.integers(len(TURNS))]
    return impinge.pose(rng.integers(-2, 3, 3) * step, rpy=turn)


def change(rng, manager, twin, step):
    """Add, replace, move or remove a mesh, and return what was done."""
    what = rng.choice(["add", "add", "move", "move", "move", "remove", "again"])
    names = list(twin.held)
    if what == "add" or not names:
        name = f"n{rng.integers(100)}"
        given, mesh, solid = KINDS[rng.choice(4, p=[0.4, 0.2, 0.2, 0.2])]
        at = place(rng, step)
        manager.add_object(name, given, at)
        twin.held[name] = mesh, solid, at
        return what
    name = names[rng.integers(len(names))]
    mesh, solid, _ = twin.held[name]
    at = place(rng, step)
    if what == "move":
        manager.set_transform(name, at)
        twin.held[name] = mesh, solid, at
    if what in {"remove", "again"}:
        manager.remove_object(name)
        del twin.held[name]
    if what == "again":
        manager.add_object(name, ConvexMesh(mesh) if solid else mesh, at)
        twin.held[name] = mesh, solid, at
    return what


def contacts_by_pair(data, order):
    """Return the pairs of faces of contacts by pair of names."""
    found = {}
    for contact in data:
        a, b = sorted(contact.names, key=order)
        found.setdefault((a, b), []).append((contact.index(a), contact.index(b)))
    return found


@pytest.mark.parametrize("step", [0.25, 0.5, 1.0])
def test_a_manager_answers_as_a_loop_over_all_pairs(step):
    rng = np.random.default_rng(int(8 * step))
    manager, twin = CollisionManager(), Twin()
    done, hits, overlaps, touches = set(), [], 0, 0
    for _ in range(30):
        for _ in range(4):
            done.add(change(rng, manager, twin, step))
        held = twin.held
        colliding = {(a, b): twin.faces(a, held[b]) for a, b in twin.pairs()}
        colliding = {pair: faces for pair, faces in colliding.items() if faces}
        expected = {tuple(sorted(pair)) for pair in colliding}
        assert manager.in_collision_internal() is bool(expected)
        assert manager.in_collision_internal(return_names=True) == (bool(expected), expected)
        hit, names, data = manager.in_collision_internal(return_names=True, return_data=True)
        assert (hit, names) == (bool(expected), expected)
        found = contacts_by_pair(data, list(held).index)
        assert {pair: set(faces) for pair, faces in found.items()} == colliding
        assert sum(map(len, found.values())) == sum(map(len, colliding.values()))  # each pair once
        measured = {pair: twin.separation(pair[0], held[pair[1]]) for pair in twin.pairs()}
        least = min(measured.values(), default=np.inf)
        value, nearest = manager.min_distance_internal(return_names=True)
        assert value == pytest.approx(least, rel=1e-12, abs=1e-300)
        assert measured.get(nearest, measured.get((nearest or (0, 0))[::-1], np.inf)) == pytest.approx(least)
        for name in list(held)[:3]:
            own = [found for pair, found in measured.items() if name in pair]
            assert manager.min_distance_internal(name) == pytest.approx(min(own, default=np.inf), rel=1e-12)
        hits.append(len(expected) / max(1, len(measured)))
        overlaps += sum(value < 0 for value in measured.values())
        touches += sum(value == 0 for value in measured.values())
    assert done == {"add", "move", "remove", "again"}
    assert 0.01 < np.mean(hits) < 0.9
    assert overlaps > 10
    assert touches > 5


@pytest.mark.parametrize("step", [0.25, 0.5])
def test_two_managers_and_single_meshes_answer_as_a_loop(step):
    rng = np.random.default_rng(int(16 * step))
    sides = [(CollisionManager(), Twin()) for _ in range(2)]
    many = alone = 0
    for _ in range(8):
        for manager, twin in sides:
            for _ in range(5):
                change(rng, manager, twin, step)
        (one, ours), (two, theirs) = sides
        every = list(itertools.product(ours.held, theirs.held))
        expected = {(a, b) for a, b in every if ours.intersects(a, theirs.held[b])}
        assert one.in_collision_other(two) is two.in_collision_other(one) is bool(expected)
        assert one.in_collision_other(two, return_names=True) == (bool(expected), expected)
        assert two.in_collision_other(one, return_names=True)[1] == {(b, a) for a, b in expected}
        measured = {(a, b): ours.separation(a, theirs.held[b]) for a, b in every}
        value, names = one.min_distance_other(two, return_names=True)
        assert value == pytest.approx(min(measured.values(), default=np.inf), rel=1e-12)
        assert measured.get(names, np.inf) == pytest.approx(value, rel=1e-12)
        many += len(expected)
        for given, mesh, solid in KINDS:
            single = mesh, solid, place(rng, step)
            near = {name for name in ours.held if ours.intersects(name, single)}
            assert one.in_collision_single(given, single[2]) is bool(near)
            hit, names, data = one.in_collision_single(given, single[2], return_names=True, return_data=True)
            assert (hit, names) == (bool(near), near)
            faces = {name: set() for name in near}
            for contact in data:
                (name,) = contact.names - {"__external"}
                faces[name].add((contact.index(name), contact.index("__external")))
            assert faces == {name: ours.faces(name, single) for name in near}
            values = {name: ours.separation(name, single) for name in ours.held}
            value, name = one.min_distance_single(given, single[2], return_name=True)
            assert value == pytest.approx(min(values.values(), default=np.inf), rel=1e-12)
            assert values.get(name, np.inf) == pytest.approx(value, rel=1e-12)
            alone += len(near)
    assert many > 20
    assert alone > 10


def surface(mesh):
    made = fcl.BVHModel()
    made.beginModel()
    made.addSubModel(mesh.vertices, mesh.faces)
    made.endModel()
    return made


def test_objects_collide_as_their_bodies_do():
    """Every pair of geometries, on a grid, moved by each setter."""
    rng = np.random.default_rng(4)
    corners = cube(-1, 1)[0]
    known = [
        (fcl.Box(2, 2, 2), impinge.Shape.hull(corners)),
        (surface(CUBE), CUBE),
        (surface(RING), RING),
        (fcl.Sphere(1), impinge.Shape.sphere(1)),
        (fcl.Capsule(0.5, 1), impinge.Shape.capsule([0, 0, -0.5], [0, 0, 0.5], 0.5)),
        (fcl.Halfspace([0, 0, 1], 0), impinge.Shape.half_space([0, 0, 1], 0)),
    ]
    objects = [fcl.CollisionObject(geometry) for geometry, _ in known]
    hits = apart = 0
    for _ in range(12):
        for number, obj in enumerate(objects):
            at = place(rng, 1.0)
            if number % 2:
                obj.setTransform(fcl.Transform(at[:3, :3], at[:3, 3]))
            else:
                obj.setRotation(at[:3, :3])
                obj.setTranslation(at[:3, 3])
            assert np.array_equal(obj.matrix, at)
        manager = fcl.DynamicAABBTreeCollisionManager()
        manager.registerObjects(objects)
        visited = []
        manager.collide(visited, lambda a, b, seen: seen.append({objects.index(a), objects.index(b)}))
        for i, j in itertools.combinations(range(len(known)), 2):
            expected = impinge.intersects(known[i][1], known[j][1], objects[i].matrix, objects[j].matrix)
            assert (fcl.collide(objects[i], objects[j]) > 0) is (fcl.collide(objects[j], objects[i]) > 0) is expected
            if expected:
                assert {i, j} in visited
            result = fcl.CollisionResult()
            count = fcl.collide(objects[i], objects[j], fcl.CollisionRequest(1000, enable_contact=True), result)
            assert (count > 0) is expected is result.is_collision
            assert 0 <= fcl.collide(objects[i], objects[j], fcl.CollisionRequest(1000)) == count
            far = impinge.distance(known[i][1], known[j][1], objects[i].matrix, objects[j].matrix).distance
            assert max(fcl.distance(objects[i], objects[j]), 0) == pytest.approx(far, rel=1e-9, abs=1e-12)
            hits += expected
            apart += not expected
    assert hits > 20
    assert apart > 20


def test_the_default_callback_finds_a_collision_if_there_is_one():
    rng = np.random.default_rng(6)
    box, answers = fcl.Box(1, 1, 1), []
    for _ in range(40):
        manager = fcl.DynamicAABBTreeCollisionManager()
        manager.registerObjects([fcl.CollisionObject(box, fcl.Transform(at)) for at in rng.integers(0, 16, (7, 3)) / 2])
        objects = manager.getObjects()
        expected = any(fcl.collide(a, b) for a, b in itertools.combinations(objects, 2))
        data = fcl.CollisionData()
        manager.collide(data, fcl.defaultCollisionCallback)
        assert data.result.is_collision is data.done is expected
        assert len(data.result.contacts) == expected
        answers.append(expected)
    assert 5 < sum(answers) < 35


def test_a_manager_notices_a_model_that_was_built_again():
    model = surface(CUBE)
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects(
        [fcl.CollisionObject(model), fcl.CollisionObject(fcl.Box(1, 1, 1), fcl.Transform([9, 0, 0]))]
    )
    handed = []
    manager.collide(None, lambda *objects: handed.append(objects))
    assert not handed
    model.beginModel()
    model.addSubModel(CUBE.vertices * 18, CUBE.faces)
    model.endModel()
    manager.update()
    manager.collide(None, lambda *objects: handed.append(objects))
    assert len(handed) == 1


def test_callbacks_may_change_the_manager_and_raise():
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects([fcl.CollisionObject(fcl.Box(1, 1, 1)) for _ in range(4)])

    def change(a, b, _):
        manager.registerObject(fcl.CollisionObject(fcl.Box(1, 1, 1)))
        a.setTranslation([100, 0, 0])

    manager.collide(None, change)
    assert manager.size() == 4 + 6

    def fail(*_):
        raise KeyError("mine")

    for ask in (manager.collide, manager.distance):
        with pytest.raises(KeyError, match="mine"):
            ask(None, fail)


def test_a_mesh_that_changes_in_place_is_converted_again():
    """Also if its library does not notice the change."""
    trimesh = pytest.importorskip("trimesh")
    manager, box = CollisionManager(), trimesh.creation.box()
    manager.add_object("box", box)
    probe = trimesh.creation.box()
    aside = impinge.pose([1.5, 0, 0])
    assert manager.in_collision_single(probe, aside) is manager.in_collision_single(probe, aside) is False
    np.asarray(probe.vertices)[:] *= 2
    assert manager.in_collision_single(probe, aside) is True
    assert manager.in_collision_single(box, aside) is False
    probe.faces = probe.faces[:, ::-1]
    assert manager.in_collision_single(probe, aside) is True


def test_contacts_keep_their_numbers_after_changes():
    manager, box = CollisionManager(), ConvexMesh(CUBE)
    manager.add_object("a", box)
    manager.add_object("b", box, impinge.pose([0.75, 0, 0]))
    _, before = manager.in_collision_internal(return_data=True)
    _, read = manager.in_collision_internal(return_data=True)
    expected = [(tuple(contact.point), contact.depth) for contact in read]
    manager.set_transform("b", impinge.pose([0.5, 0, 0]))
    manager.remove_object("a")
    assert [(tuple(contact.point), contact.depth) for contact in before] == expected
    assert before[0].depth == pytest.approx(0.25)
    assert before[0].names == {"a", "b"}
    with pytest.raises(KeyError):
        before[0].index("c")
