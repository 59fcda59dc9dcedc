"""Files: formats, units, origins, warnings and errors."""

import mmap
import os
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.shared_memory import SharedMemory
from pathlib import Path

import impinge
import numpy as np
import pytest
from shapes import cube, random_poses, torus

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


def test_the_origin_names_polygons_and_parts(tmp_path):
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


def test_a_scene_has_the_parts_of_a_file(tmp_path):
    path = tmp_path / "parts.obj"
    path.write_text(OBJ + "o left\nf 2 3 4\no\nf 1 3 4\n")
    whole, scene = impinge.load(path), impinge.load_scene(path)
    assert len(scene.parts) == len(whole.origin.parts)
    assert list(scene.parts)[:2] == ["left", "right"]
    assert len(set(scene.parts)) == len(scene.parts)
    for number, (name, mesh) in enumerate(scene.parts.items()):
        rows = whole.origin.part_of == number
        assert np.array_equal(mesh.vertices[mesh.faces], whole.vertices[whole.faces[rows]])
        assert np.array_equal(mesh.origin.polygons, whole.origin.polygons[rows])
        assert (mesh.origin.parts, mesh.origin.path) == ((name,), str(path))
        assert mesh.vertices.dtype == whole.vertices.dtype
    assert scene.check(stop="all").meets.all()
    twice = tmp_path / "twice.gltf"
    nodes = '"nodes":[{"mesh":0,"name":"nut"},{"mesh":0,"name":"nut","translation":[5,0,0]},{"mesh":0}]'
    twice.write_text(GLTF.replace('"nodes":[{"mesh":0}]', nodes).replace('"nodes":[0]', '"nodes":[0,1,2]'))
    scene = impinge.load_scene(twice, "mm")
    assert list(scene.parts) == ["nut", "nut (2)", "part 2"]
    assert scene.parts["nut (2)"] is scene.parts["nut"]  # instances share a mesh
    assert scene.parts["nut (2)"].vertices[:, 0].max() == 1000
    assert scene.poses["nut (2)"][0, 3] == 5000
    assert [scene.details(name).key for name in scene.parts] == ["nut", "nut#2", "part"]
    assert scene.check(stop="all").names() == [("nut", "part 2")]
    empty = tmp_path / "empty.off"
    empty.write_text("OFF\n0 0 0\n")
    with pytest.warns(impinge.LoadWarning, match="no faces"):
        assert impinge.load_scene(empty).parts == {}
    with pytest.warns(impinge.LoadWarning, match="no faces"):
        assert len(impinge.load(empty).faces) == 0


def test_baked_meshes_give_the_same_answers(tmp_path):
    human = impinge.load(HUMAN)
    human.bake(tmp_path / "human.impinge")
    opened = impinge.load(tmp_path / "human.impinge")
    assert opened.origin.format == "baked"
    assert np.array_equal(opened.vertices, human.vertices)
    assert opened.vertices.dtype == human.vertices.dtype
    assert np.array_equal(opened.faces, human.faces)
    assert np.array_equal(opened.origin.polygons, human.origin.polygons)
    assert opened.origin.parts == human.origin.parts
    poses = random_poses(20, 8, 3)
    assert np.array_equal(impinge.intersects(human, opened, None, poses), impinge.intersects(human, human, None, poses))
    assert np.array_equal(
        impinge.intersecting_pairs(opened, human, None, poses[0]),
        impinge.intersecting_pairs(human, human, None, poses[0]),
    )
    double = impinge.Mesh([[0, 0, 0.1], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    double.bake(str(tmp_path / "human.impinge"))  # replaces the file, which stays mapped by `opened`
    assert np.array_equal(impinge.load(tmp_path / "human.impinge").vertices, double.vertices)
    assert impinge.intersects(opened, human)
    opened.refit(human.vertices * 2)
    assert opened.vertices.max() == 2 * human.vertices.max()
    assert [path.name for path in tmp_path.iterdir()] == ["human.impinge"]


def test_a_mapped_mesh_can_be_baked_to_its_own_file(tmp_path):
    path = tmp_path / "human.impinge"
    human = impinge.load(HUMAN)
    human.bake(path)
    opened = impinge.load(path)
    opened.bake(path)
    assert np.array_equal(impinge.load(path).faces, human.faces)
    assert impinge.intersects(opened, human)
    with pytest.raises(FileNotFoundError, match="missing"):
        human.bake(tmp_path / "missing" / "human.impinge")


def test_concurrent_bakes_to_one_path_leave_one_valid_file(tmp_path):
    path = tmp_path / "mesh.impinge"
    corners = np.random.default_rng(3).random((300, 3))
    meshes = [impinge.Mesh(corners, np.arange(300 + 3 * i).reshape(-1, 3) % 300) for i in range(8)]

    def work(mesh):
        for _ in range(20):
            mesh.bake(path)
            assert 100 <= len(impinge.load(path).faces) < 108

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(work, meshes))
    assert [entry.name for entry in tmp_path.iterdir()] == ["mesh.impinge"]


def test_workers_share_a_baked_mesh(tmp_path):
    torus_file, poses_file = tmp_path / "torus.impinge", tmp_path / "poses.npy"
    mesh, poses = impinge.Mesh(*torus()), random_poses(40, 2.5, 6)
    mesh.bake(torus_file)
    np.save(poses_file, poses)
    program = (
        "import sys, impinge, numpy as np\n"
        "mesh, poses = impinge.load(sys.argv[1]), np.load(sys.argv[2])\n"
        "print(any('.impinge' in line for line in open('/proc/self/maps')))\n"
        "print(impinge.intersects(mesh, mesh, None, poses).tolist())\n"
    )
    command = [sys.executable, "-c", program, str(torus_file), str(poses_file)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    is_mapped, answers = done.stdout.splitlines()
    assert is_mapped == "True" or not sys.platform.startswith("linux")
    assert answers == str(impinge.intersects(mesh, mesh, None, poses).tolist())


def test_a_baked_mesh_is_read_from_any_buffer(tmp_path):
    human = impinge.load(HUMAN)
    human.bake(tmp_path / "human.impinge")
    baked = human.to_baked()
    assert baked == (tmp_path / "human.impinge").read_bytes()
    poses = random_poses(20, 8, 3)
    expected = impinge.intersects(human, human, None, poses)
    shared = SharedMemory(create=True, size=len(baked))
    try:
        shared.buf[: len(baked)] = baked
        array = np.frombuffer(b"." + baked, np.uint8)[1:]  # not aligned
        with open(tmp_path / "human.impinge", "rb") as file:
            held = [baked, bytearray(baked), memoryview(baked), array, shared.buf[: len(baked)]]
            held.append(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
        meshes = [impinge.Mesh.from_baked(buffer) for buffer in held]
        del held
        wide = np.frombuffer(baked + b"\0" * (-len(baked) % 8), np.uint64)
        if len(baked) % 8 == 0:
            meshes.append(impinge.Mesh.from_baked(wide.reshape(1, -1)))
        shared.buf[:] = b"\0" * len(shared.buf)  # does not affect the mesh, which is a copy
    finally:
        shared.close()
        shared.unlink()
    for mesh in meshes:
        assert np.array_equal(impinge.intersects(human, mesh, None, poses), expected)
        assert (mesh.vertices.dtype, mesh.origin.path, mesh.origin.format) == (human.vertices.dtype, "", "baked")
        assert mesh.aging == human.aging
        assert mesh.to_baked() == baked
    for wrong in (None, 5, "text", np.zeros((9, 9))[::2, ::2]):
        with pytest.raises((TypeError, BufferError)):
            impinge.Mesh.from_baked(wrong)
    for spoilt in (b"", baked[:-1], baked + b"\0", baked[1:], bytes(len(baked))):
        with pytest.raises(impinge.InputError):
            impinge.Mesh.from_baked(spoilt)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="shared memory has paths on Linux")
def test_shared_memory_with_a_path_is_mapped():
    mesh, poses = impinge.Mesh(*torus()), random_poses(10, 2.5, 6)
    baked = mesh.to_baked()
    shared = SharedMemory(create=True, size=len(baked))
    try:
        shared.buf[:] = baked
        program = (
            "import sys, impinge\n"
            "mesh = impinge.load(sys.argv[1])\n"
            "print(any(sys.argv[1] in line for line in open('/proc/self/maps')), mesh.origin.format)\n"
        )
        path = f"/dev/shm/{shared.name}"
        done = subprocess.run([sys.executable, "-c", program, path], capture_output=True, text=True, check=True)
        assert done.stdout.split() == ["True", "baked"]
        opened = impinge.load(path)
    finally:
        shared.close()
        shared.unlink()
    assert np.array_equal(impinge.intersects(opened, mesh, None, poses), impinge.intersects(mesh, mesh, None, poses))


def test_corrupt_baked_files_raise_an_error(tmp_path):
    path = tmp_path / "cube.impinge"
    impinge.Mesh(*cube()).bake(path)
    whole = path.read_bytes()
    for spoilt in (whole[:100], whole[:-1], whole[:400] + b"\x7f" * 8 + whole[408:], b""):
        path.write_bytes(spoilt)
        with pytest.raises(impinge.InputError):
            impinge.load(path)
    with pytest.raises(impinge.InputError, match="impinge"):
        impinge.Mesh(*cube()).bake(tmp_path / "cube.stl")
    with pytest.raises(FileNotFoundError):
        impinge.Mesh(*cube()).bake(tmp_path / "nowhere" / "cube.impinge")
    stated, baked = tmp_path / "meters.gltf", tmp_path / "meters.impinge"
    stated.write_text(GLTF)
    impinge.load(stated).bake(baked)
    assert impinge.load(baked).origin.unit == "m"
    assert impinge.load(baked, "mm").vertices.max() == 1000


def test_units_are_converted_if_a_file_states_one(tmp_path):
    stated, silent = tmp_path / "meters.gltf", tmp_path / "silent.obj"
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


def test_limits_are_respected_and_named(tmp_path):
    path = tmp_path / "cube.obj"
    path.write_text(OBJ)
    size, triangles = path.stat().st_size, impinge.load(path).face_count
    for load in (impinge.load, impinge.load_scene):
        load(path, max_bytes=size, max_triangles=triangles)
        with pytest.raises(impinge.InputError, match="larger max_bytes") as caught:
            load(path, max_bytes=size - 1)
        assert caught.value.kind == "too-many"
        with pytest.raises(impinge.InputError, match="larger max_triangles") as caught:
            load(path, max_triangles=triangles - 1)
        assert (caught.value.kind, caught.value.what) == ("too-many", str(path))
        with pytest.raises(impinge.InputError, match="max_triangles"):
            load(path, max_triangles=-1)
        with pytest.raises(impinge.InputError, match="max_bytes"):
            load(path, max_bytes=1.5)
    baked = tmp_path / "cube.impinge"
    impinge.load(path).bake(baked)
    with pytest.raises(impinge.InputError, match="larger max_triangles"):
        impinge.load(baked, max_triangles=triangles - 1)


@pytest.mark.skipif(sys.platform == "win32", reason="needs named pipes")
def test_pipes_and_devices_are_refused_before_they_are_opened(tmp_path):
    pipe = tmp_path / "pipe.obj"
    os.mkfifo(pipe)
    for path in (pipe, "/dev/zero"):
        with pytest.raises(OSError, match="not a regular file"):
            impinge.load(path)
    with pytest.raises(IsADirectoryError):
        impinge.load(tmp_path)


def test_skipped_content_gives_a_warning(tmp_path):
    path = tmp_path / "odd.obj"
    path.write_text(OBJ + "f 1 2\n")
    with pytest.warns(impinge.LoadWarning, match="fewer than three corners"):
        assert impinge.load(path).face_count == 3


def test_errors_name_the_broken_file(tmp_path):
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
    far = tmp_path / "far.obj"
    far.write_text("v 9 9 9\nv 0 0 0\nv 1e40 0 0\nv 0 1 0\nf 2 3 4\n")
    with pytest.raises(impinge.InputError, match="vertex 2 is out of range") as caught:
        impinge.load(far)
    assert (caught.value.kind, caught.value.what, caught.value.where) == ("out-of-range", str(far), None)
    with pytest.raises(
        impinge.InputError, match="vertex 2 has a coordinate that is NaN, infinite or too large"
    ) as caught:
        impinge.load_scene(far)
    assert (caught.value.kind, caught.value.what) == ("non-finite", str(far))
    for wrong in (None, 3, b"\xff"):
        with pytest.raises((TypeError, FileNotFoundError, impinge.InputError)):
            impinge.load(wrong)
