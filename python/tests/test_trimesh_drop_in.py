"""`impinge.trimesh` behaves as `trimesh.collision`; the cases are from trimesh's tests."""

import impinge
import numpy as np
import pytest
from impinge.trimesh import CollisionManager, mesh_to_BVH, mesh_to_convex, scene_to_collision
from shapes import cube, torus

trimesh = pytest.importorskip("trimesh")
CUBE = trimesh.creation.box()
AT_5, AT_MINUS_5 = impinge.pose([5, 0, 0]), impinge.pose([-5, 0, 0])


def test_a_mesh_collides_with_the_meshes_of_a_manager():
    manager = CollisionManager()
    manager.add_object("cube0", CUBE)
    manager.add_object("cube1", CUBE, AT_5)
    assert manager.in_collision_single(CUBE) is True
    hit, names, data = manager.in_collision_single(CUBE, AT_5, return_names=True, return_data=True)
    assert hit is True
    assert names == {"cube1"}
    assert data
    for contact in data:
        assert contact.names == {"cube1", "__external"}
        assert {contact.index("cube1"), contact.index("__external")} <= set(range(12))
        assert contact.point.shape == (3,)
        assert (np.abs(contact.point - [5, 0, 0]) <= 0.5).all()
        assert contact.depth == pytest.approx(1)
        assert sorted(np.abs(contact.normal)) == pytest.approx([0, 0, 1])
    hit, names, data = manager.in_collision_single(CUBE, AT_MINUS_5, return_names=True, return_data=True)
    assert (hit, names, data) == (False, set(), [])
    assert manager.in_collision_single(CUBE, return_data=True)[0] is True
    assert manager.in_collision_single(CUBE, return_names=True) == (True, {"cube0"})


def test_normals_point_away_from_the_meshes_of_the_manager():
    manager = CollisionManager()
    manager.add_object("cube", CUBE)
    _, data = manager.in_collision_single(CUBE, impinge.pose([0, 0, 0.75]), return_data=True)
    for contact in data:
        assert (contact.normal.tolist(), contact.depth) == ([0, 0, 1], pytest.approx(0.25))


def test_meshes_within_a_manager_collide():
    manager = CollisionManager()
    manager.add_object("cube0", CUBE)
    manager.add_object("cube1", CUBE, AT_5)
    assert manager.in_collision_internal() is False
    manager.add_object("cube2", CUBE, AT_5)
    hit, names = manager.in_collision_internal(return_names=True)
    assert hit is True
    assert names == {("cube1", "cube2")}
    manager.set_transform("cube2", AT_MINUS_5)
    assert manager.in_collision_internal() is False
    manager.set_transform("cube2", AT_5)
    assert manager.in_collision_internal() is True
    manager.remove_object("cube2")
    assert manager.in_collision_internal() is False
    manager.add_object("cube1", CUBE, impinge.pose([0.9, 0, 0]))  # replaces the mesh
    assert manager.in_collision_internal(return_names=True) == (True, {("cube0", "cube1")})


def test_meshes_of_two_managers_collide():
    m, n = CollisionManager(), CollisionManager()
    m.add_object("cube0", CUBE)
    m.add_object("cube1", CUBE, AT_5)
    n.add_object("cube0", CUBE, AT_MINUS_5)
    assert m.in_collision_other(n) is False
    n.add_object("cube3", CUBE, AT_5)
    hit, names, data = m.in_collision_other(n, return_names=True, return_data=True)
    assert (hit, names) == (True, {("cube1", "cube3")})
    assert {frozenset(contact.names) for contact in data} == {frozenset(("cube1", "cube3"))}
    assert n.in_collision_other(m, return_names=True)[1] == {("cube3", "cube1")}


def test_distances_equal_those_of_trimesh():
    """Distances 4, 2, 9, 6 and 1, and -0.25 for two overlapping cubes."""
    manager = CollisionManager()
    manager.add_object("cube0", CUBE)
    assert manager.min_distance_single(CUBE, AT_5) == pytest.approx(4)
    assert manager.min_distance_single(CUBE, AT_5, return_name=True) == (pytest.approx(4), "cube0")
    far, name, data = manager.min_distance_single(CUBE, AT_5, return_name=True, return_data=True)
    assert (far, name, data.names) == (pytest.approx(4), "cube0", {"cube0", "__external"})
    assert data.distance == far
    assert data.point("cube0")[0] == 0.5
    assert data.point("__external")[0] == 4.5
    assert manager.min_distance_single(CUBE, impinge.pose([0.75, 0, 0])) == pytest.approx(-0.25)
    assert manager.min_distance_internal() == np.inf
    manager.add_object("cube1", CUBE, AT_5)
    manager.add_object("cube2", CUBE, impinge.pose([8, 0, 0]))
    far, names, data = manager.min_distance_internal(return_names=True, return_data=True)
    assert (far, names, data.names) == (pytest.approx(2), ("cube1", "cube2"), {"cube1", "cube2"})
    assert manager.min_distance_internal("cube0", return_names=True) == (pytest.approx(4), ("cube0", "cube1"))
    with pytest.raises(ValueError, match="not in collision manager"):
        manager.min_distance_internal("cube9")
    other = CollisionManager()
    assert manager.min_distance_other(other) == np.inf
    other.add_object("east", CUBE, impinge.pose([18, 0, 0]))
    other.add_object("west", CUBE, impinge.pose([-7, 0, 0]))
    far, names, data = manager.min_distance_other(other, return_names=True, return_data=True)
    assert (far, names, data.names) == (pytest.approx(6), ("cube0", "west"), {"cube0", "west"})
    other.remove_object("west")
    assert manager.min_distance_other(other, return_names=True) == (pytest.approx(9), ("cube2", "east"))
    other.set_transform("east", impinge.pose([10, 0, 0]))
    assert manager.min_distance_other(other) == pytest.approx(1)
    assert other.min_distance_other(manager, return_names=True) == (pytest.approx(1), ("east", "cube2"))


def test_the_minimum_distance_equals_a_loop():
    rng = np.random.default_rng(3)
    manager, ring = CollisionManager(), impinge.Mesh(*torus(12, 8))
    poses = {f"n{i}": impinge.pose(at) for i, at in enumerate(rng.uniform(-12, 12, (8, 3)))}
    for name, at in poses.items():
        manager.add_object(name, ring, at)
    far, names = manager.min_distance_internal(return_names=True)
    each = {(a, b): impinge.distance(ring, ring, poses[a], poses[b]).distance for a in poses for b in poses if a < b}
    assert far == min(each.values()) > 0
    assert each[names] == far
    manager.set_transform(names[0], poses[names[1]])
    assert manager.min_distance_internal() == 0  # surfaces that intersect
    manager.add_object("solid", CUBE, poses[names[1]] @ impinge.pose([1, 0, 0]))
    assert manager.min_distance_internal("solid") == -1  # one of them is solid


def test_invalid_names_and_transforms_raise_a_value_error():
    manager = CollisionManager()
    for wrong in (lambda: manager.remove_object("a"), lambda: manager.set_transform("a", np.eye(4))):
        with pytest.raises(ValueError, match="not in collision manager"):
            wrong()
    with pytest.raises(ValueError, match=r"\(4,4\)"):
        manager.add_object("a", CUBE, np.eye(3))


def test_all_of_700_colliding_probes_are_reported():
    """No limit on contacts drops a pair."""
    manager = CollisionManager()
    probe = trimesh.creation.box(extents=[0.02] * 3)
    inside = np.random.default_rng(1).uniform(-0.4, 0.4, size=(700, 3))
    for i, at in enumerate(inside):
        manager.add_object(f"probe{i}", probe, impinge.pose(at))
    hit, names = manager.in_collision_single(CUBE, return_names=True)
    assert hit is True
    assert len(names) == 700


def test_convex_meshes_are_solids_and_others_are_surfaces():
    small = trimesh.creation.box(extents=[0.1] * 3)
    assert small.is_convex
    ring = trimesh.Trimesh(*torus(radius=2.0, tube=1.0), process=False)
    assert not ring.is_convex
    manager = CollisionManager()
    manager.add_object("cube", CUBE)
    assert manager.in_collision_single(small) is True  # inside, surfaces are apart
    hit, data = manager.in_collision_single(small, return_data=True)
    assert hit
    assert [(c.index("cube"), c.index("__external")) for c in data] == [(-1, -1)]
    assert manager.in_collision_single(trimesh.creation.box(extents=[9] * 3)) is True  # around it
    assert manager.in_collision_single(impinge.Mesh(small)) is True  # a surface inside a solid
    surfaces = CollisionManager()
    surfaces.add_object("ring", ring)
    in_tube = impinge.pose([2, 0, 0])
    assert surfaces.in_collision_single(small, in_tube) is False  # inside a hollow surface
    assert surfaces.in_collision_single(small, impinge.pose([1.5, 0, 0], rpy=[0.3, 0.2, 0.1])) is False
    assert surfaces.in_collision_single(small, impinge.pose([1.0, 0, 0])) is True


def test_each_component_of_a_mesh_is_tested_for_inside():
    """One mesh has two cubes: one inside the solid, the other far away."""
    (v, f), inner = cube(-0.1, 0.1), impinge.pose([0.3, 0.2, -0.1], rpy=[1.0, 2.0, 0.4])
    pair = impinge.Mesh(np.concatenate([v + np.array([7, 0, 0]), v]), np.concatenate([f, f + 8]))
    manager = CollisionManager()
    manager.add_object("cube", CUBE, inner)
    assert manager.in_collision_single(pair, inner) is True
    assert manager.in_collision_single(pair, impinge.pose([-3.5, 0, 0])) is False


def test_conversions_keep_the_faces():
    assert mesh_to_BVH(CUBE).num_tries_() == 12
    assert mesh_to_convex(CUBE).num_faces == 12


def test_scenes_become_managers():
    scene = trimesh.Scene()
    for i, x in enumerate((0.0, 0.9, 3.0)):
        scene.add_geometry(CUBE, node_name=f"n{i}", transform=impinge.pose([x, 0, 0]))
    manager, objects = scene_to_collision(scene)
    assert set(objects) == {"n0", "n1", "n2"}
    assert manager.in_collision_internal(return_names=True) == (True, {("n0", "n1")})
