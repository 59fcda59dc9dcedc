"""Scenes from files: shared meshes, poses, details, names and origin; and poses of scenes."""

import copy
import json
import pickle
from pathlib import Path

import impinge
import numpy as np
import pytest
from shapes import cube

CUBE = impinge.Mesh(*cube())
FLOATS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "f4")
ROBOT = Path(__file__).resolve().parents[2] / "data" / "robot.glb"


def write(path, nodes):
    """Writes a glTF file with one mesh, four corners of which two triangles use."""
    faces = np.array([[0, 2, 1], [0, 1, 3]], "u1")
    path.with_suffix(".bin").write_bytes(FLOATS.tobytes() + faces.tobytes())
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 54, "uri": path.with_suffix(".bin").name}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 6}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": nodes,
    }
    path.write_text(json.dumps(document))
    return path


def test_instances_share_a_mesh_and_have_poses_and_details(tmp_path):
    extras = {"GlobalId": "g", "type": "IfcWall", "load": 1.5}
    group = {"name": "hall", "children": [1, 2], "translation": [500000, 0, 0]}
    nodes = [group, {"mesh": 0, "name": "a", "extras": extras}, {"mesh": 0, "name": "b", "scale": [-2, 1, 1]}]
    path = write(tmp_path / "hall.gltf", nodes)
    scene = impinge.load_scene(path, "mm", origin=[5e8, 0, 0])
    assert scene.parts["a"] is scene.parts["b"]
    assert scene.poses["a"].tolist() == np.eye(4).tolist()
    assert scene.poses["b"].tolist() == np.diag([-2, 1, 1, 1]).tolist()
    assert scene.details("a") == impinge.Details("g", "IfcWall", ("hall",), {"load": "1.5"})
    assert scene.details("b") == impinge.Details("hall/b", "", ("hall",), {})
    assert scene.check().names() == [("a", "b")]
    origin = scene.parts["a"].origin
    assert (origin.polygons.tolist(), origin.parts, origin.unit) == ([0, 1], ("a",), "mm")
    for again in (copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        assert again.parts["a"] is again.parts["b"]
        assert all(np.array_equal(again.poses[name], scene.poses[name]) for name in scene.parts)
        assert again.details("a") == scene.details("a")
        assert again.check().names() == [("a", "b")]


def test_a_file_of_names_names_parts(tmp_path):
    path = write(tmp_path / "two.gltf", [{"mesh": 0, "name": "n1"}, {"mesh": 0, "name": "n2"}])
    names = tmp_path / "names.json"
    names.write_text('{"elements": [{"node": "n1", "guid": "G", "type": "IfcWall", "name": "North"}]}')
    scene = impinge.load_scene(path, names=names)
    assert list(scene.parts) == ["North", "n2"]
    assert scene.details("North") == impinge.Details("G", "IfcWall")
    names.write_text('{"elements": [{"node": "n3"}]}')
    with pytest.warns(impinge.LoadWarning, match="names that name no node"):
        impinge.load_scene(path, names=names)
    names.write_text("[]")
    with pytest.raises(impinge.InputError, match="list of elements"):
        impinge.load_scene(path, names=names)
    for origin in ([0, 0], "x", [0, np.nan, 0]):
        with pytest.raises(impinge.InputError) as caught:
            impinge.load_scene(path, origin=origin)
        assert caught.value.what == "origin"


def test_a_scene_has_the_triangles_of_the_flattened_file():
    with pytest.warns(impinge.LoadWarning):
        flat, scene = impinge.load(ROBOT), impinge.load_scene(ROBOT)
    corners = []
    for name, mesh in scene.parts.items():
        pose = scene.poses[name]
        posed = mesh.vertices @ pose[:3, :3].T + pose[:3, 3]
        faces = mesh.faces[:, [0, 2, 1]] if np.linalg.det(pose) < 0 else mesh.faces
        corners.append(posed[faces])
    assert np.allclose(np.concatenate(corners), flat.vertices[flat.faces], atol=1e-5)


def test_checks_start_from_the_poses_of_the_scene():
    apart = {"b": impinge.pose([5, 0, 0])}
    scene = impinge.Scene({"a": CUBE, "b": CUBE}, poses=apart)
    assert not scene.check().intersects
    assert scene.check({"b": np.eye(4)}).intersects
    assert scene.check({"b": None}).intersects is False
    assert scene.check({"a": impinge.pose([[0, 0, 0], [4.5, 0, 0]])}).intersects.tolist() == [False, True]
    assert not scene.poses["b"].flags.writeable
    apart["b"][0, 3] = 0
    assert scene.poses["b"][0, 3] == 5
    for poses, what in [({"c": np.eye(4)}, "poses"), ({"a": np.eye(3)}, "poses['a']"), ([1], "poses")]:
        with pytest.raises(impinge.InputError) as caught:
            impinge.Scene({"a": CUBE}, poses=poses)
        assert caught.value.what == what
    with pytest.raises(impinge.InputError, match="pass configurations to check"):
        impinge.Scene({"a": CUBE}, poses={"a": impinge.pose([[0, 0, 0]])})
    with pytest.raises(impinge.InputError, match="Details"):
        impinge.Scene({"a": CUBE}, details={"a": "wall"})
