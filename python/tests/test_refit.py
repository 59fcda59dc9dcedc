"""Meshes whose vertices move."""

import pickle
import threading
from typing import get_args

import impinge
import numpy as np
import pytest
from impinge._mesh import BuilderName
from shapes import cube, random_poses, torus

POSES = random_poses(30, 1.5, 7)


def twisted(vertices, turns):
    angle = turns * vertices[:, 2:]
    x, y = vertices[:, :1], vertices[:, 1:2]
    return np.hstack([x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle), vertices[:, 2:]])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_refitted_mesh_answers_like_a_new_mesh(dtype):
    vertices, faces = torus(along=80, around=40)
    mesh, other = impinge.Mesh(vertices.astype(dtype), faces), impinge.Mesh(*cube())
    for turns in (0.5, 3.0, 0.0):
        moved = twisted(vertices, turns).astype(dtype)
        beside = mesh.refitted(moved)
        assert mesh.refit(moved) is None
        new = impinge.Mesh(moved, faces)
        for found in (mesh, beside):
            assert np.array_equal(found.vertices, moved)
            assert found.vertices.dtype == dtype
            assert not found.vertices.flags.writeable
            assert np.array_equal(
                impinge.intersecting_pairs(found, other, POSES).rows, impinge.intersecting_pairs(new, other, POSES).rows
            )
        assert mesh.aging >= 0.9
    assert mesh.aging == pytest.approx(1.0)


def test_rebuild_resets_aging_and_keeps_answers():
    rng = np.random.default_rng(1)
    vertices, faces = torus()
    mesh = impinge.Mesh(vertices, faces)
    mesh.refit(rng.permutation(vertices))
    assert mesh.aging > 1.5
    for builder in get_args(BuilderName):
        mesh.refit(vertices)
        mesh.refit(rng.permutation(vertices))
        before = impinge.intersecting_pairs(mesh, mesh, POSES).rows
        mesh.rebuild(builder)
        assert mesh.aging == 1.0
        assert np.array_equal(impinge.intersecting_pairs(mesh, mesh, POSES).rows, before)
    with pytest.raises(impinge.InputError, match="one of 'auto', 'morton'") as raised:
        mesh.rebuild("fast")  # type: ignore[arg-type]
    assert (raised.value.kind, raised.value.what) == ("option", "builder")


def test_a_failed_refit_does_not_change_the_mesh():
    vertices, faces = cube()
    mesh = impinge.Mesh(vertices, faces)
    for bad, kind in [(np.full((8, 3), np.nan), "non-finite"), (vertices[:7], "shape"), (vertices[:, :2], "shape")]:
        for move in (mesh.refit, mesh.refitted):
            with pytest.raises(impinge.InputError) as raised:
                move(bad)
            assert (raised.value.kind, raised.value.what) == (kind, "vertices")
    assert np.array_equal(mesh.vertices, vertices)
    assert impinge.intersects(mesh, mesh)


def test_arrays_returned_before_a_refit_do_not_change():
    vertices, faces = cube()
    mesh = impinge.Mesh(vertices, faces)
    before = mesh.vertices
    mesh.refit(vertices + 1)
    assert np.array_equal(before, vertices)
    assert np.array_equal(mesh.vertices, vertices + 1)
    assert mesh.faces is mesh.faces
    assert np.array_equal(pickle.loads(pickle.dumps(mesh)).vertices, vertices + 1)


def test_concurrent_calls_see_the_mesh_before_or_after_a_refit():
    vertices, faces = torus()
    mesh, wall = impinge.Mesh(vertices, faces), impinge.Mesh(*cube())
    far = vertices + np.array([10, 0, 0])
    touching = len(impinge.intersecting_pairs(mesh, wall))
    assert touching > 0
    stop, seen = threading.Event(), set()

    def ask():
        while not stop.is_set():
            seen.add(len(impinge.intersecting_pairs(mesh, wall)))

    asking = [threading.Thread(target=ask) for _ in range(3)]
    for thread in asking:
        thread.start()
    for _ in range(100):
        mesh.refit(far)
        mesh.refit(vertices)
    stop.set()
    for thread in asking:
        thread.join()
    assert seen <= {0, touching}
