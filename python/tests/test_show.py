"""Pictures show meshes, intersections and curves at the right place."""

import impinge
import numpy as np
import pytest
from shapes import TRIANGLE, cube, torus


def pixels(picture):
    return np.asarray(picture).astype(int)


def struck(picture):
    """Returns the mask of pixels that show intersecting faces: mostly red."""
    r, g, b = np.moveaxis(pixels(picture), -1, 0)
    return (r > g + 60) & (r > b + 30)


def curve(picture):
    r, g, b = np.moveaxis(pixels(picture), -1, 0)
    return (r > 120) & (g > 80) & (b < 60)


def test_intersecting_faces_and_curves_are_visible(tmp_path):
    ring = impinge.Mesh(*torus())
    apart, meeting = impinge.pose([5, 0, 0]), impinge.pose([0.6, 0, 0], rpy=[1.5, 0, 0.2])
    clear = impinge.show(ring, ring, pose_b=apart, size=(320, 240))
    assert clear.size == (320, 240)
    assert not struck(clear).any()
    assert not curve(clear).any()
    path = tmp_path / "rings.png"
    picture = impinge.show(ring, ring, pose_b=meeting, size=(320, 240), view=(150, 30), path=path)
    assert 0.002 < struck(picture).mean() < 0.3
    assert curve(picture).sum() > 50
    assert path.read_bytes() == picture._repr_png_()
    assert path.read_bytes().startswith(b"\x89PNG\r\n")
    assert (picture.width, picture.height, picture.pixels.shape) == (320, 240, (240, 320, 3))


def test_right_and_up_of_the_picture_match_the_world():
    """From the front, a marker at +x and at the top is at the upper right, for either up axis."""
    flat = impinge.Mesh(cube()[0] * [4, 0.1, 4], cube()[1])
    for up, towards in (("z", [0, -1, 0]), ("y", [0, 0, 1])):
        turned = flat if up == "z" else impinge.Mesh(cube()[0] * [4, 4, 0.1], cube()[1])
        corner = np.array([1.5, 0, 1.5] if up == "z" else [1.5, 1.5, 0]) + 0.7 * np.array(towards)
        mark = impinge.Mesh(cube(-0.3, 0.3)[0] + corner, cube()[1])
        picture = pixels(impinge.show(turned, mark, view=(0, 0), up=up, size=(200, 200)))
        blue = picture[..., 2] > picture[..., 0] + 15
        rows, columns = np.nonzero(blue)
        assert blue.sum() > 50
        assert rows.max() < 100 < columns.min()


def test_nearer_surfaces_hide_farther_ones():
    near, far = (impinge.Mesh(cube()[0] * [2, 0.1, 2] + [0, y, 0], cube()[1]) for y in (-1.0, 1.0))
    opaque_in_front = pixels(impinge.show(near, far, view=(0, 0), size=(100, 100)))[50, 50]
    transparent_in_front = pixels(impinge.show(far, near, view=(0, 0), size=(100, 100)))[50, 50]
    assert opaque_in_front[0] > opaque_in_front[2]  # color of a: the opaque mesh hides b
    assert transparent_in_front[2] > opaque_in_front[2]
    assert transparent_in_front[0] > 0.6 * opaque_in_front[0]  # color of a, visible through b


@pytest.mark.parametrize("focus", ["all", "contact"])
def test_empty_degenerate_and_distant_meshes_are_rendered(focus):
    empty = impinge.Mesh([], [])
    point = impinge.Mesh([[1, 1, 1]], [[0, 0, 0]])
    far = impinge.Mesh(cube()[0] * 1e30 + 1e31, cube()[1])
    for a in (empty, point, far, impinge.Mesh(*TRIANGLE)):
        for b in (empty, point, far):
            assert impinge.show(a, b, size=(64, 48), focus=focus).size == (64, 48)


def test_focus_on_contact_zooms_in():
    ring, pin = impinge.Mesh(*torus()), impinge.Mesh(cube()[0] * 0.05 + [0, -1.35, 0], cube()[1])
    views = [struck(impinge.show(ring, pin, size=(160, 120), focus=focus)).sum() for focus in ("all", "contact")]
    assert views[1] > 3 * max(views[0], 1)


def test_errors_name_the_invalid_option():
    ring = impinge.Mesh(*torus())
    for wrong in (
        {"size": (10, 10)},
        {"size": (1e3, 100)},
        {"up": "w"},
        {"focus": "b"},
        {"path": "a.jpg"},
        {"pose_a": np.eye(4)[None]},
    ):
        with pytest.raises(impinge.InputError) as caught:
            impinge.show(ring, ring, **wrong)
        assert caught.value.what in wrong


def test_scenes_and_shapes_are_drawn_in_colors(tmp_path):
    ball = impinge.Shape.sphere(1)
    scene = impinge.Scene({"left": ball, "right": ball}, poses={"right": impinge.pose([3, 0, 0])})
    picture = impinge.show(scene, view=(0, 0), size=(240, 120), path=tmp_path / "scene.png")
    r, _, b = np.moveaxis(pixels(picture), -1, 0)
    assert 3000 < (b[:, :120] > r[:, :120] + 20).sum() < 8000
    assert 3000 < (r[:, 120:] > b[:, 120:] + 20).sum() < 8000
    both = impinge.show(ball, ball, pose_b=impinge.pose([3, 0, 0]), view=(0, 0), size=(240, 120))
    assert np.array_equal(both, picture)
    assert impinge.show(impinge.Mesh(*torus()), ball, size=(64, 48)).size == (64, 48)
    assert scene._repr_png_().startswith(b"\x89PNG")
    for options in ({"b": ball}, {"pose_a": impinge.pose([0, 0, 0])}):
        with pytest.raises(impinge.InputError, match="alone"):
            impinge.show(scene, **options)


def test_contacts_are_a_table_in_a_notebook():
    box = impinge.Shape.box([1, 1, 1])
    contacts = impinge.contacts(box, box, None, impinge.pose([0, 0, 1.5]))
    table = contacts._repr_html_()
    assert "<caption>Contacts(4)</caption>" in table
    assert table.count("<tr>") == 5
    assert "<td>0.5</td><td>0.5</td><td>0, 0, 1</td>" in table
    rows = impinge.contacts(box, box, None, impinge.pose([[0, 0, 1.5], [0, 0, 3], [0, 0, 2], [0, 0, 1.5]]))
    table = rows._repr_html_()
    assert table.count("<tr>") == 11  # the first ten of twelve
    assert "12 contacts" in table
    assert "<th>4</th><td>2</td>" in table
