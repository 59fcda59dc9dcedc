"""Files: formats, units, origins, warnings and errors."""

import pickle
from pathlib import Path

import impinge
import numpy as np
import pytest

HUMAN = Path(__file__).resolve().parents[2] / "data" / "human_makehuman_cc0.ply"
OBJ = "o left\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.1\nf 1 2 3 4\no right\nf 1 2 4\n"
GLTF = (
    '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],'
    '"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],'
    '"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],'
    '"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:;base64,'
    'AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}'
)


@pytest.mark.parametrize("as_path", [str, Path])
def test_a_file_becomes_a_mesh(as_path):
    human = impinge.load(as_path(HUMAN))
    assert (human.vertex_count, human.face_count) == (13_380, 26_756)
    assert human.vertices.dtype == np.float32
    assert human.origin.format == "PLY"
    assert human.origin.path == str(HUMAN)
    assert impinge.intersects(human, human)


def test_polygons_and_parts_are_remembered(tmp_path):
    path = tmp_path / "two.obj"
    path.write_text(OBJ)
    mesh = impinge.load(path)
    assert mesh.vertices.dtype == np.float64  # 0.1 is the nearest float64
    assert mesh.origin.polygons.tolist() == [0, 0, 1]
    assert mesh.origin.part_of.tolist() == [0, 0, 1]
    assert mesh.origin.parts == ("left", "right")
    assert mesh.origin.unit is None
    copy = pickle.loads(pickle.dumps(mesh))
    assert copy.origin.parts == mesh.origin.parts
    assert impinge.Mesh(mesh.vertices, mesh.faces).origin is None


def test_units_are_converted_where_a_file_states_one(tmp_path):
    stated, silent = tmp_path / "metres.gltf", tmp_path / "silent.obj"
    stated.write_text(GLTF)
    silent.write_text(OBJ)
    assert impinge.load(stated).origin.unit == "m"
    for unit, size in (("m", 1), ("mm", 1000), ("in", 1e6 / 25400), ("um", 1e6), ("ft", 1e6 / 304800)):
        mesh = impinge.load(stated, unit)
        assert mesh.origin.unit == unit
        assert mesh.vertices.max() == size
        assert impinge.load(silent, unit=unit).vertices.max() == 1
    with pytest.raises(impinge.InputError) as caught:
        impinge.load(stated, unit="furlong")
    assert (caught.value.kind, caught.value.what) == ("unit", "unit")


def test_what_was_left_out_is_warned_of(tmp_path):
    path = tmp_path / "odd.obj"
    path.write_text(OBJ + "f 1 2\n")
    with pytest.warns(impinge.LoadWarning, match="fewer than three corners"):
        assert impinge.load(path).face_count == 3


def test_broken_files_are_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"absent\.obj"):
        impinge.load(tmp_path / "absent.obj")
    for name, text, kind, where in [
        ("x.obj", "v 0 0 0\nf 1 2 3\n", "index-out-of-bounds", "line 2"),
        ("x.obj", "v 0 zero 0\n", "syntax", "line 1"),
        ("x.xyz", "0 0 0", "unsupported-format", None),
        ("x.stl", "", "empty", None),
    ]:
        path = tmp_path / name
        path.write_text(text)
        with pytest.raises(impinge.InputError) as caught:
            impinge.load(path)
        assert (caught.value.kind, caught.value.what, caught.value.where) == (kind, str(path), where)
        assert str(path) in str(caught.value)
    for wrong in (None, 3, b"\xff"):
        with pytest.raises((TypeError, FileNotFoundError, impinge.InputError)):
            impinge.load(wrong)
