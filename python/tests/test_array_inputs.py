"""Arrays of any type, shape, layout and value are read correctly, or raise an error."""

import impinge
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import cube
from visible_state import state

MESH = impinge.Mesh(*cube())
SHAPE = impinge.Shape.box([1, 1, 1])


def world():
    made = impinge.World()
    made.insert(SHAPE, impinge.pose([[0, 0, 0], [3, 0, 0]]))
    made.step()
    return made


def moved(vertices):
    mesh = impinge.Mesh(*cube())
    mesh.refit(vertices)
    return mesh


def stepped(poses):
    made = world()
    return made.step(made.bodies, poses), made.poses(made.bodies)


def inserted(poses):
    made = world()
    return made.insert(SHAPE, poses), made.poses(made.bodies)


DOWN = [0.0, 0.0, -1.0]
READERS = {
    "closest_point": ((3,), MESH.closest_point),
    "signed_distance": ((3,), MESH.signed_distance),
    "winding_number": ((3,), MESH.winding_number),
    "contains": ((3,), MESH.contains),
    "origins": ((3,), lambda points: MESH.ray_cast(points, DOWN)),
    "directions": ((3,), lambda points: MESH.ray_cast_all(DOWN, points)),
    "a shape's rays": ((3,), lambda points: SHAPE.ray_cast(points, DOWN)),
    "a world's rays": ((3,), lambda points: world().ray_cast(points, DOWN)),
    "at_points": ((3,), lambda points: world().at_points(points)),
    "in_boxes": ((3,), lambda points: world().in_boxes(points, [99, 99, 99])),
    "minimal_sphere": ((3,), impinge.minimal_sphere),
    "convex_hull": ((3,), impinge.convex_hull),
    "obb": ((3,), impinge.fit.obb),
    "hull": ((3,), lambda points: impinge.Shape.hull(points).bounds),
    "sphere": ((3,), lambda points: impinge.Shape.sphere(1, points).bounds),
    "half_space": ((3,), lambda points: repr(impinge.Shape.half_space(points))),
    "pose": ((3,), impinge.pose),
    "screw": ((3,), lambda points: impinge.Motion.screw(None, points, DOWN)),
    "vertex_face": ((4, 3), lambda corners: impinge.ccd.vertex_face(corners, np.ones((4, 3)))),
    "edge_edge": ((4, 3), lambda corners: impinge.ccd.edge_edge(corners, corners)),
    "refit": ((8, 3), moved),
    "refitted": ((8, 3), MESH.refitted),
    "motion": ((4, 4), lambda poses: impinge.Motion(poses, None)),
    "pose_a": ((4, 4), lambda poses: impinge.intersects(MESH, MESH, poses)),
    "distance": ((4, 4), lambda poses: impinge.distance(MESH, MESH, poses, solid=True)),
    "pairs": ((4, 4), lambda poses: impinge.intersecting_pairs(MESH, MESH, poses)),
    "curves": ((4, 4), lambda poses: impinge.intersection_curves(MESH, MESH, poses)),
    "a shape's pose": ((4, 4), lambda poses: impinge.distance(SHAPE, MESH, poses)),
    "a scene": ((4, 4), lambda poses: impinge.Scene({"a": MESH, "b": MESH}).check({"a": poses})),
    "insert": ((4, 4), inserted),
    "step": ((4, 4), stepped),
    "overlapping": ((4, 4), lambda poses: world().overlapping(SHAPE, poses)),
}

LAYOUTS = {
    "plain": lambda x: x,
    "fortran": np.asfortranarray,
    "strided": lambda x: np.repeat(x, 2, axis=-1)[..., ::2] if x.ndim else x,
    "reversed": lambda x: x[..., ::-1].copy()[..., ::-1] if x.ndim else x,
    "big endian": lambda x: x.astype(x.dtype.newbyteorder(">")),
    "unaligned": lambda x: np.frombuffer(b"." + x.tobytes(), np.uint8)[1:].view(x.dtype).reshape(x.shape),
    "list": lambda x: x.tolist(),
}

NUMBERS = st.sampled_from(
    [0.0, -0.0, 1.0, -1.0, 0.5, 3.0, 1e-300, -(2.0**64), 2.0**127, 1e308, np.nan, np.inf, -np.inf]
)


@st.composite
def arrays(draw, core):
    """Draws arrays that mostly have the expected shape, and numbers that are mostly in range."""
    lead = draw(st.lists(st.integers(0, 3), max_size=2))
    wrong = draw(st.sampled_from([None] * 4 + [(), core[:-1], (*core, 2), (*core[:-1], 5)]))
    shape = (*lead, *(core if wrong is None else wrong))
    plain = draw(st.sampled_from([np.float64, np.float64, np.float32]))
    dtype = draw(st.sampled_from([plain] * 6 + [np.float16, np.int64, np.complex128, bool]))
    values = np.random.default_rng(draw(st.integers(0, 99))).integers(-3, 4, shape).astype(float)
    if core == (4, 4) and wrong is None:
        values = values * 0 + np.eye(4)
        values[..., 0, 3] = draw(st.sampled_from([0.0, 0.5, 1.0, 4.0]))
    if values.size and draw(st.integers(0, 3)) == 0:
        values.flat[draw(st.integers(0, values.size - 1))] = draw(NUMBERS)
    with np.errstate(all="ignore"):
        return values.astype(dtype)


def answer(take, values):
    """Returns the visible state of the answer, or the kind, argument and place of the error."""
    try:
        return state(take(values))
    except impinge.InputError as error:
        assert error.kind
        assert error.what
        return error.kind, error.what, error.where


@pytest.mark.parametrize("name", READERS)
@settings(max_examples=50)
@given(data=st.data())
def test_the_layout_of_an_array_does_not_change_the_answer(name, data):
    core, take = READERS[name]
    values = data.draw(arrays(core))
    plain = answer(take, values)
    layout = data.draw(st.sampled_from(sorted(LAYOUTS)))
    as_floats = values.dtype in (np.float64, np.float32)
    if layout != "list":
        assert answer(take, LAYOUTS[layout](values)) == plain
    elif as_floats and values.size:  # lists have no dtype, and empty ones no shape
        assert answer(take, values.tolist()) == answer(take, values.astype(np.float64))
    if as_floats and name not in ("refit", "refitted"):  # both keep single precision
        assert answer(take, values.astype(np.float64)) == plain
    assert as_floats or isinstance(plain, tuple) or name == "pose"  # pose accepts any numbers


@given(data=st.data())
def test_corrupt_bytes_raise_or_give_the_same_mesh(data):
    whole = MESH.to_baked()
    spoiled = bytearray(whole)
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(whole) - 1))
        spoiled[at] ^= data.draw(st.integers(1, 255))
    spoiled = spoiled[: data.draw(st.sampled_from([len(whole), len(whole), len(whole) - 1, 63, 0]))]
    try:
        mesh = impinge.Mesh.from_baked(spoiled)
    except impinge.InputError as error:
        assert error.kind in ("truncated", "corrupt", "syntax", "unsupported-feature")
    else:  # only the padding between sections is not validated
        assert state(mesh.faces) == state(MESH.faces)
        assert np.array_equal(mesh.vertices, MESH.vertices)
