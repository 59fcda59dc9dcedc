"""Array arguments of any type, layout and value: meshes, poses, and their errors."""

import impinge
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapes import TRIANGLE, cube, torus


def _unaligned(x):
    raw = np.zeros(x.nbytes + 1, np.uint8)
    view = raw[1:].view(np.uint8)[: x.nbytes].view(x.dtype).reshape(x.shape)
    view[...] = x
    assert not view.flags.aligned or x.dtype.itemsize == 1
    return view


def _read_only(x):
    x = x.copy()
    x.flags.writeable = False
    return x


LAYOUTS = {
    "plain": lambda x: x,
    "fortran": np.asfortranarray,
    "strided": lambda x: np.repeat(np.repeat(x, 2, axis=0), 3, axis=1)[::2, ::3],
    "reversed": lambda x: x[::-1, ::-1].copy()[::-1, ::-1],
    "big endian": lambda x: x.astype(x.dtype.newbyteorder(">")),
    "unaligned": _unaligned,
    "read-only": _read_only,
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("floats", [np.float32, np.float64])
@pytest.mark.parametrize("integers", [np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64])
def test_mesh_arrays_of_any_layout_are_accepted(layout, floats, integers):
    vertices, faces = cube()
    vertices = (vertices * 0.3).astype(floats)
    mesh = impinge.Mesh(LAYOUTS[layout](vertices), LAYOUTS[layout](faces.astype(integers)))
    assert np.array_equal(mesh.vertices, vertices)
    assert np.array_equal(mesh.faces, faces)
    assert (mesh.vertices.dtype, mesh.faces.dtype) == (floats, np.uint32)


@pytest.mark.parametrize("layout", [name for name in LAYOUTS if name != "strided"])
@pytest.mark.parametrize("floats", [np.float32, np.float64])
def test_poses_of_any_layout_are_accepted(layout, floats):
    triangle = impinge.Mesh(*TRIANGLE)
    pose = np.eye(4, dtype=floats)
    pose[:3, 3] = [1, 0, 0]
    assert impinge.intersects(triangle, triangle, LAYOUTS[layout](pose)) is True
    pose[0, 3] = np.nextafter(floats(1), floats(2))
    assert impinge.intersects(triangle, triangle, LAYOUTS[layout](pose)) is False
    assert impinge.intersects(triangle, triangle, np.stack([pose] * 6)[::2]).tolist() == [False] * 3
    assert impinge.intersects(triangle, triangle, np.broadcast_to(pose, (5, 4, 4))).tolist() == [False] * 5


def test_arrays_are_copied_and_returned_read_only():
    vertices, faces = cube()
    mesh = impinge.Mesh(vertices, faces)
    vertices += 100
    faces[:] = 0
    assert impinge.intersects(mesh, impinge.Mesh(*cube()))
    assert mesh.vertices.max() == 0.5
    for shown in (mesh.vertices, mesh.faces):
        assert not shown.flags.writeable
    assert mesh.vertices is mesh.vertices


def test_meshes_of_other_libraries_are_accepted():
    class Foreign:
        vertices, faces = cube()

    assert impinge.Mesh(Foreign()).face_count == 12
    trimesh = pytest.importorskip("trimesh")
    sphere = trimesh.creation.icosphere(subdivisions=2)
    mesh = impinge.Mesh(sphere)
    assert (mesh.vertex_count, mesh.face_count) == (len(sphere.vertices), len(sphere.faces))


def test_empty_meshes_are_valid_and_intersect_nothing():
    for vertices, faces in [([], []), (np.zeros((0, 3)), np.zeros((0, 3), int)), (cube()[0], [])]:
        empty = impinge.Mesh(vertices, faces)
        assert empty.faces.shape == (0, 3)
        assert not impinge.intersects(empty, impinge.Mesh(*cube()))
        assert impinge.intersecting_pairs(empty, empty).shape == (0, 2)
        assert impinge.intersection_curves(empty, empty) == []


def test_health_counts_defects():
    vertices, faces = cube()
    sound = impinge.Mesh(vertices, faces).health()
    assert (sound.components, sound.open_edges, sound.duplicate_vertices, sound.degenerate_faces) == (1, 0, 0, 0)
    soup = impinge.Mesh(np.concatenate([vertices[faces].reshape(-1, 3), [[9, 9, 0.1]]]), np.arange(36).reshape(-1, 3))
    odd = soup.health()
    assert (odd.duplicate_vertices, odd.unused_vertices, odd.double_coordinates) == (28, 1, 1)
    assert soup.is_closed
    broken = impinge.Mesh(vertices, np.concatenate([faces[:-1], faces[:1], [[0, 0, 1]]])).health()
    assert (broken.degenerate_faces, broken.duplicate_faces) == (1, 1)
    assert broken.open_edges > 0


def test_tree_statistics_are_plausible():
    mesh = impinge.Mesh(*torus())
    tree = mesh.tree_statistics()
    assert 1600 / 8 <= tree.leaves <= 1600
    assert 2 <= tree.depth <= 64
    assert 0 < tree.leaf_fill <= 1
    assert 0 < tree.node_fill <= 1
    assert 1 <= tree.sah < tree.inner + tree.leaves
    assert 0 <= tree.overlap < 1
    assert 0 < tree.bytes < mesh.memory
    assert impinge.Mesh([], []).tree_statistics().leaves == 0


V, F = TRIANGLE
WRONG = [
    ("dtype", "vertices", (), V.astype(np.float16), F),
    ("dtype", "vertices", (), V.astype(int), F),
    ("dtype", "vertices", (), V.astype(complex), F),
    ("dtype", "vertices", (), V.astype(np.longdouble), F),
    ("dtype", "vertices", (), V.astype(bool), F),
    ("shape", "vertices", (), V[:, :2], F),
    ("shape", "vertices", (), V[0], F),
    ("shape", "vertices", (), V[None], F),
    ("shape", "vertices", (), [[0.0, 1.0], [2.0]], F),
    ("type", "vertices", (), None, F),
    ("type", "vertices", (), object(), F),
    ("type", "vertices", (), np.ma.masked_array(V), F),
    ("dtype", "vertices", (), [["a", "b", "c"]], F),
    ("dtype", "faces", (), V, F.astype(float)),
    ("dtype", "faces", (), V, [[0.0, 1.5, 2.0]]),
    ("dtype", "faces", (), V, F.astype(bool)),
    ("shape", "faces", (), V, F[0]),
    ("shape", "faces", (), V, [[0, 1, 2, 0]]),
    ("type", "faces", (), V, None),
    ("index-out-of-bounds", "faces", (0,), V, [[0, 1, 3]]),
    ("index-out-of-bounds", "faces", (1,), V, [[0, 1, 2], [0, -1, 2]]),
    ("index-out-of-bounds", "faces", (1,), V, np.array([[0, 1, 2], [2**32, 1, 2]])),
    ("index-out-of-bounds", "faces", (0,), V, np.array([[2**64 - 1, 1, 2]], np.uint64)),
    ("index-out-of-bounds", "faces", (0,), V, np.array([[-(2**31), 1, 2]], np.int32)),
    ("index-out-of-bounds", "faces", (0,), V, np.array([[4, 1, 2]], np.uint32)),
    ("non-finite", "vertices", (1,), [[0, 0, 0], [0, np.nan, 0], [1, 1, 1]], F),
    ("non-finite", "vertices", (2,), np.array([[0, 0, 0], [0, 1, 0], [1, 1, np.inf]], np.float32), F),
    ("out-of-range", "vertices", (0,), [[2.0**128, 0, 0], [0, 1, 0], [1, 1, 1]], F),
]


@pytest.mark.parametrize(("kind", "what", "where", "vertices", "faces"), WRONG)
def test_errors_name_the_invalid_array(kind, what, where, vertices, faces):
    with pytest.raises(impinge.InputError) as caught:
        impinge.Mesh(vertices, faces)
    assert isinstance(caught.value, ValueError)
    assert (caught.value.kind, caught.value.what, caught.value.where) == (kind, what, where)
    assert str(caught.value).startswith(what)


def test_arguments_that_are_not_meshes_raise_an_error():
    mesh = impinge.Mesh(*cube())
    for ask in (impinge.intersects, impinge.intersecting_pairs, impinge.intersection_curves):
        for pair, what in (((cube(), mesh), "a"), ((mesh, "mesh"), "b"), ((mesh, None), "b")):
            with pytest.raises(impinge.InputError) as caught:
                ask(*pair)
            assert (caught.value.kind, caught.value.what) == ("type", what)


@given(
    data=st.data(),
    dtype=st.sampled_from(["f2", "f4", "f8", ">f4", ">f8", "i4", "i8", ">i2", "u8", "c16", "O", "U3", "b1", "M8[s]"]),
    shape=st.lists(st.integers(0, 5), max_size=4).map(tuple),
    role=st.sampled_from(["vertices", "faces", "pose_a"]),
)
def test_any_array_is_accepted_or_raises_an_input_error(data, dtype, shape, role):
    """Any array gives a mesh, or an `InputError` that names it, never another exception."""
    size = int(np.prod(shape))
    numbers = data.draw(st.lists(st.integers(-3, 6), min_size=size, max_size=size))
    array = np.array(numbers).reshape(shape).astype(dtype)
    if array.ndim:
        array = data.draw(st.sampled_from([array, array[::-1], np.asfortranarray(array), array[..., ::2]]))
    triangle = impinge.Mesh(*TRIANGLE)
    try:
        if role == "vertices":
            mesh = impinge.Mesh(array, np.zeros((1, 3), int) if len(array) else [])
            assert np.array_equal(mesh.vertices, array.reshape(-1, 3))
        elif role == "faces":
            mesh = impinge.Mesh(np.eye(3), array)
            assert np.array_equal(mesh.faces, array.reshape(-1, 3))
        else:
            answer = impinge.intersects(triangle, triangle, array)
            assert np.shape(answer) == array.shape[:-2]
    except impinge.InputError as error:
        assert error.what == role
    except TypeError:
        assert array.ndim == 0  # raised by the test's own `len(array)`
        assert role == "vertices"
