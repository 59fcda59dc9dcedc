"""Folders with baked scenes: the same scene comes back, mapped, and damage is an error."""

import json
import random
import sys

import impinge
import numpy as np
import pytest
from impinge.cluster import _worker
from same_answers import same_reports
from shapes import cube, torus
from test_scene_files import write

CUBE, TORUS = impinge.Mesh(*cube()), impinge.Mesh(*torus())


def room():
    """Returns a scene of 40 parts at half units that share two meshes."""
    rng = np.random.default_rng(4)
    parts = {f"part {at}": (CUBE, TORUS)[at % 2] for at in range(40)}
    poses = {name: impinge.pose(place) for name, place in zip(parts, rng.integers(-5, 6, (40, 3)) / 2, strict=True)}
    del poses["part 7"]
    details = {"part 1": impinge.Details("g", "IfcWall", ("hall", "é"), {"load": "1.5"})}
    ignored = [("part 3", "part 2"), ("part 5", "part 9"), ("part 4", "part 4")]
    return impinge.Scene(parts, poses=poses, details=details, ignored=ignored)


def test_a_baked_scene_is_the_same_scene(tmp_path):
    scene = room()
    scene.bake(tmp_path / "room")
    again = impinge.load_scene(tmp_path / "room")
    assert list(again.parts) == list(scene.parts)
    assert again.parts["part 0"] is again.parts["part 2"]
    assert again.parts["part 0"].origin is None
    for name in scene.parts:
        assert np.array_equal(again.poses[name], scene.poses[name])
        assert again.details(name) == scene.details(name)
        assert np.array_equal(again.parts[name].vertices, scene.parts[name].vertices)
        assert np.array_equal(again.parts[name].faces, scene.parts[name].faces)
    assert again.pairs == scene.pairs
    report = again.check(stop="all")
    assert same_reports(report, scene.check(stop="all"))
    assert len(report.names()) > 50


def test_clashes_of_a_baked_scene_are_those_of_its_file(tmp_path):
    path = write(tmp_path / "two.gltf", [{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "scale": [-2, 1, 1]}])
    scene = impinge.load_scene(path, "mm")
    scene.bake(tmp_path / "two")
    again = impinge.load_scene(tmp_path / "two")
    origins = [part.origin for each in (scene, again) for part in (each.parts["a"],)]
    assert [(origin.format, origin.unit, origin.parts) for origin in origins] == [("glTF", "mm", ("a",))] * 2
    assert [origin.polygons.tolist() for origin in origins] == [[0, 1]] * 2
    assert [origin.part_of.tolist() for origin in origins] == [[0, 0]] * 2
    reports = [json.loads(impinge.clash({"s": each}, contacts=True).to_json()) for each in (scene, again)]
    assert reports[0] == reports[1]


def test_scenes_are_added_to_a_folder(tmp_path):
    path = tmp_path / "all"
    impinge.Scene({"a": CUBE, "b": TORUS}, solid=True).bake(path)
    held = impinge.load_scene(path)
    impinge.Scene({"c": TORUS, "d": CUBE}, ignored=[("c", "d")], solid=True).bake(path)
    again = impinge.load_scene(path)
    assert again.pairs == (("a", "b"), ("a", "c"), ("a", "d"), ("b", "c"), ("b", "d"))
    far = {"a": impinge.pose([9, 0, 0]), "c": impinge.pose([9, 0, 0])}
    assert held.check(stop="all").names() == [("a", "b")]
    assert not held.check({"a": far["a"]}).intersects
    assert again.check(far, stop="all").names() == [("a", "c"), ("b", "d")]
    inside = {"b": np.diag([0.125, 0.125, 0.125, 1]), "c": impinge.pose([9, 0, 0]), "d": impinge.pose([99, 0, 0])}
    assert again.check(inside, stop="all").names() == [("a", "b")]  # a solid in a solid
    with pytest.raises(impinge.InputError, match="has a part 'c' already"):
        impinge.Scene({"e": CUBE, "c": CUBE}, solid=True).bake(path)
    with pytest.raises(impinge.InputError, match="solid: must be that of the scene in the folder"):
        impinge.Scene({"e": CUBE}).bake(path)
    with pytest.raises(impinge.InputError, match="part 's' is Shape; only meshes can be baked"):
        impinge.Scene({"s": impinge.Shape.sphere(1)}, solid=True).bake(path)
    assert list(impinge.load_scene(path).parts) == ["a", "b", "c", "d"]


def test_an_empty_scene_is_baked_too(tmp_path):
    impinge.Scene({}).bake(tmp_path)
    assert impinge.load_scene(tmp_path).parts == {}
    empty = impinge.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
    impinge.Scene({"empty": empty}).bake(tmp_path)
    assert impinge.load_scene(tmp_path).parts["empty"].face_count == 0


def test_other_arguments_do_not_apply_to_a_folder(tmp_path):
    room().bake(tmp_path)
    for name, value in {"unit": "mm", "origin": [0, 0, 0], "max_bytes": 9, "max_triangles": 9}.items():
        with pytest.raises(impinge.InputError, match=f"^{name}: does not apply to a folder"):
            impinge.load_scene(tmp_path, **{name: value})


@pytest.mark.parametrize("name", ["parts.ndjson", "meshes"])
def test_damaged_folders_are_errors_or_valid_scenes(tmp_path, name):
    room().bake(tmp_path)
    path = tmp_path / name
    content = path.read_bytes()
    rng = random.Random(6)
    rejected = 0
    for _ in range(300):
        spoilt = bytearray(content)
        at = rng.randrange(len(spoilt))
        if rng.random() < 0.2:
            del spoilt[at:]
        else:
            spoilt[at] ^= 1 << rng.randrange(8)
        path.write_bytes(spoilt)
        try:
            scene = impinge.load_scene(tmp_path)
            scene.check()
        except impinge.InputError:
            rejected += 1
    assert rejected > 100
    path.write_bytes(content)
    assert same_reports(impinge.load_scene(tmp_path).check(), room().check())


def test_errors_of_damaged_folders_name_the_line_or_the_byte(tmp_path):
    room().bake(tmp_path)
    lines = (tmp_path / "parts.ndjson").read_text().splitlines()
    (tmp_path / "parts.ndjson").write_text("\n".join([*lines[:4], '{"part": "x", "of": 9}']))
    with pytest.raises(impinge.InputError, match=r"parts.ndjson, line 5: the list of parts is damaged"):
        impinge.load_scene(tmp_path)
    (tmp_path / "parts.ndjson").write_text('{"version": 2}')
    with pytest.raises(impinge.InputError, match="version 2 of baked scenes is not supported"):
        impinge.load_scene(tmp_path)
    (tmp_path / "parts.ndjson").write_text("\n".join(lines))
    content = bytearray((tmp_path / "meshes").read_bytes())
    start = json.loads(lines[3])["start"]
    assert json.loads(lines[3])["mesh"] == 1
    content[start + 700] ^= 1
    (tmp_path / "meshes").write_bytes(content)
    with pytest.raises(impinge.InputError, match=f"meshes, byte {start}: .*bake the scene again"):
        impinge.load_scene(tmp_path)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads the memory of the process from /proc")
def test_a_baked_scene_takes_no_private_memory_for_its_meshes(tmp_path):
    grids = [torus(500, 400 + at) for at in range(3)]
    for at, grid in enumerate(grids):
        impinge.Scene({f"{at}": impinge.Mesh(*grid)}).bake(tmp_path)
    size = (tmp_path / "meshes").stat().st_size
    before = _worker.private_memory()
    scene = impinge.load_scene(tmp_path)
    grown = _worker.private_memory() - before
    assert len(scene.parts) == 3
    assert before > 0
    assert size > 40 << 20
    assert grown < size // 3
