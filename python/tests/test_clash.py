"""Clash detection over scenes: the report, its arrays and files, and errors."""

import csv
import html
import io
import json
import pickle
import re
import subprocess
import sys

import impinge
import numpy as np
import pytest
from impinge import pose
from shapes import cube

CUBE = impinge.Mesh(*cube())

PLACES = {
    "wall": [0, 0, 0],
    "pipe": [0.75, 0.75, 0],
    "shelf": [0, -0.9, 1.0625],
    "lamp": [-1, 0.75, 0],
    "far": [9, 9, 9],
}
"""The pipe enters the wall by 0.25, the shelf is 0.0625 above it, and the lamp touches it."""

RULES = """
[sets]
walls = { type = "IfcWall" }
rest = { type = "IfcPipe*" }

[[rule]]
name = "pipes"
a = "walls"
b = "rest"
severity = "high"
"""


def house(places=PLACES, **types):
    """Returns a scene of cubes."""
    details = {name: impinge.Details(key=f"key-{name}", type=types.get(name, "")) for name in places}
    poses = {name: pose(place) for name, place in places.items()}
    return impinge.Scene(dict.fromkeys(places, CUBE), poses=poses, details=details)


def typed(places=PLACES):
    return house(places, wall="IfcWall", pipe="IfcPipeSegment")


def names(report):
    return [{each.a.name, each.b.name} for each in report]


def test_each_pair_has_one_kind():
    report = impinge.clash(house(), clearance=0.1, contacts=True)
    assert report.kind.tolist() == ["clash", "contact", "clearance"]
    assert names(report) == [{"wall", "pipe"}, {"wall", "lamp"}, {"wall", "shelf"}]
    assert len(report) == 3
    pairs = {"candidates": 3, "clash": 1, "contact": 1, "clearance": 1}
    assert report.counts == {**dict.fromkeys(report.counts, 0), **pairs}
    clash, contact, near = report
    assert clash == report[0]
    lower, upper = clash.depth
    assert lower <= 0.25 <= upper < 0.251
    assert near.gap == pytest.approx((0.0625, 0.0625))
    assert (near.depth, contact.gap) == (None, None)
    assert np.allclose(clash.box, [[0.25, 0.25, -0.5], [0.5, 0.5, 0.5]], atol=1e-6)
    assert (clash.status, clash.proved, clash.why, clash.inner) == ("new", True, None, None)
    assert clash.sentence.startswith("part '")
    assert repr(report) == "ClashReport(1 clash, 1 contact, 1 clearance)"
    assert sum(pairs for _, _, pairs in report.decades) == 2
    assert report.tolerance < 1e-3
    assert impinge.clash(house({"wall": [0, 0, 0]})).frame()["a_key"].shape == (0,)


def test_arrays_have_one_row_for_each_clash():
    report = impinge.clash(house(), clearance=0.1, contacts=True)
    assert report.a.tolist() == [each.a.key for each in report]
    assert set(report.b.tolist()) | set(report.a.tolist()) == {"key-wall", "key-pipe", "key-lamp", "key-shelf"}
    assert (report.depth.shape, report.gap.shape, report.volume.shape) == ((3, 2), (3, 2), (3, 2))
    assert (report.point.shape, report.box.shape) == ((3, 3), (3, 2, 3))
    assert np.isnan(report.volume).all()
    assert np.isnan(report.depth[2]).all()
    assert np.isnan(report.gap[:2]).all()
    assert tuple(report.depth[0]) == report[0].depth
    assert report.box[0].tolist() == [list(corner) for corner in report[0].box]
    assert (np.abs(report.point[0]) <= 0.5).all()
    frame = report.frame()
    assert {len(column) for column in frame.values()} == {3}
    assert frame["depth_upper"][0] == report[0].depth[1]
    assert frame["a_name"].tolist() == [each.a.name for each in report]
    assert frame["proved"].all()


def test_curves_are_traced_if_they_are_asked_for():
    scene = house()
    report = impinge.clash(scene, clearance=0.1, contacts=True, curves=True)
    clash, contact, near = report
    for each in (clash, contact):
        poses = [scene.poses[part.name] for part in (each.a, each.b)]
        expected = impinge.intersection_curves(CUBE, CUBE, *poses)
        assert len(each.curves) == len(expected) > 0
        assert all(np.array_equal(line, curve) for line, curve in zip(each.curves, expected, strict=True))
    assert near.curves is None
    assert impinge.clash(scene)[0].curves is None
    assert json.loads(report.to_json())["asked"]["curves"]


def test_files_have_what_the_report_has(tmp_path):
    report = impinge.clash(typed(), contacts=True, volume=True)
    text = report.to_json(tmp_path / "new.json")
    assert (tmp_path / "new.json").read_text() == text
    found = json.loads(text)
    assert found["schema"] == "impinge.clash/1"
    assert [row["id"] for row in found["clashes"]] == [each.id for each in report]
    rows = list(csv.DictReader(io.StringIO(report.to_csv(tmp_path / "new.csv"))))
    assert (tmp_path / "new.csv").read_bytes().decode() == report.to_csv()
    assert [row["id"] for row in rows] == [each.id for each in report]
    assert [float(row["depth_lower"]) for row in rows] == report.depth[:, 0].tolist()
    assert [row["volume_upper"] for row in rows] == [str(each.volume[1]) if each.volume else "" for each in report]
    assert any(each.volume for each in report)


def test_the_report_does_not_depend_on_threads_or_order():
    backwards = dict(reversed(PLACES.items()))
    with impinge.threads(1):
        one = impinge.clash(typed(), contacts=True, clearance=0.1)
    two = impinge.clash(typed(), contacts=True, clearance=0.1)
    assert (one.to_json(), one.to_csv()) == (two.to_json(), two.to_csv())
    other = impinge.clash(typed(backwards), contacts=True, clearance=0.1)
    assert [each.id for each in other] == [each.id for each in one]
    assert other.depth.tobytes() == one.depth.tobytes()


def test_labels_name_scenes_and_between_skips_pairs_inside_one():
    old, new = house({"wall": [0, 0, 0], "pipe": [0.75, 0, 0]}), house({"duct": [0, 0.5, 0]})
    with pytest.raises(impinge.InputError, match="there is one scene"):
        impinge.clash(old, between=True)
    both = impinge.clash({"arch": old, "mep": new})
    assert len(both) == 3
    between = impinge.clash({"arch": old, "mep": new}, between=True)
    assert names(between) == [{"wall", "duct"}, {"pipe", "duct"}]
    assert {(each.a.scene, each.b.scene) for each in between} == {("arch", "mep")}
    (group,) = between.groups("scene")
    assert group.shared == ("arch", "mep")
    assert group.clashes == tuple(between)


def test_duplicates_are_sets_and_inner_parts_are_contained():
    inner = impinge.pose([0, 0, 0], rotation=np.eye(3) / 4)
    scene = impinge.Scene(dict.fromkeys("abc", CUBE), poses={"c": inner})
    report = impinge.clash(scene)
    (copies,) = report.duplicates
    assert [part.name for part in copies.parts] == ["a", "b"]
    assert [(each.kind, {"a": each.a, "b": each.b}[each.inner].name) for each in report] == [("contained", "c")] * 2
    assert report.counts["duplicate"] == 1


def test_groups_share_a_part_or_types():
    report = impinge.clash(typed(), contacts=True, clearance=0.1)
    (group,) = report.groups("part")
    assert group.shared == ("scene/key-wall",)
    assert group.clashes == tuple(report)
    assert group.sentence.startswith("wall 'wall' meets 3 parts")
    assert [group.shared for group in report.groups("type")] == [("", "IfcWall"), ("IfcPipeSegment", "IfcWall")]
    with pytest.raises(impinge.InputError, match="by: must be one of"):
        report.groups("color")


def test_statuses_carry_over_from_a_report_or_its_file(tmp_path):
    old = impinge.clash(house())
    moved = house({**PLACES, "pipe": [5, 0, 0], "lamp": [-0.875, 0.75, 0]})
    for previous in (old, tmp_path / "old.json", str(tmp_path / "old.json")):
        old.to_json(tmp_path / "old.json")
        assert [each.status for each in impinge.clash(house(), previous=previous)] == ["active"]
        new = impinge.clash(moved, previous=previous)
        assert [each.status for each in new] == ["new"]
        assert new.gone == (old[0].id,)
    assert old.gone is None
    assert new.diff(old) == impinge.ClashDiff(new=(new[0].id,), known=(), gone=(old[0].id,))
    assert old.diff(old).known == (old[0].id,)
    approved = old.to_json().replace('"status":"new"', '"status":"approved"')
    (tmp_path / "old.json").write_text(approved)
    assert impinge.clash(house(), previous=tmp_path / "old.json")[0].status == "approved"


def test_rules_are_a_file_or_a_text(tmp_path):
    for name, text in (("rules.toml", RULES), ("rules.csv", ",IfcWall,IfcPipe*\nIfcWall,,0\nIfcPipe*,,\n")):
        (tmp_path / name).write_text(text)
        report = impinge.clash(typed({**PLACES, "desk": [0, 0.5, 0]}), rules=tmp_path / name)
        assert names(report) == [{"wall", "pipe"}]
        assert report.counts["unchecked"] > 0
    report = impinge.clash(typed(), rules=RULES)
    assert (report[0].rule, report[0].severity) == ("pipes", "high")
    assert json.loads(report.to_json())["rules"][0]["pairs"] == 1


def test_pairs_that_a_scene_ignores_are_not_checked():
    scene = house()
    scene.ignore("pipe", "wall")
    assert len(impinge.clash(scene)) == 0


def write_two(path):
    """Writes two cubes that overlap by 0.002."""
    vertices, faces = cube()
    lines = []
    for number, x in enumerate((0, 0.998)):
        lines += [f"o part{number}", *(f"v {a + x} {b} {c}" for a, b, c in vertices)]
        lines += ["f " + " ".join(str(corner + 1 + 8 * number) for corner in face) for face in faces]
    path.write_text("\n".join(lines))


def test_the_command_has_the_same_answer(tmp_path):
    write_two(tmp_path / "two.obj")
    command = [
        sys.executable,
        "-m",
        "impinge",
        "clash",
        str(tmp_path / "two.obj"),
        "--unit",
        "m",
        "--json",
        "--contacts",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    found = json.loads(done.stdout)
    report = impinge.clash({"two": impinge.load_scene(tmp_path / "two.obj", "m")}, contacts=True)
    own = json.loads(report.to_json())
    assert len(report) == 1
    assert found["scenes"][0].pop("file").endswith("two.obj")
    assert found == own


def test_lengths_may_have_the_unit_of_the_file(tmp_path):
    write_two(tmp_path / "two.obj")
    meters = impinge.load_scene(tmp_path / "two.obj", "m")
    assert len(impinge.clash(meters)) == len(impinge.clash(meters, tolerance="1mm")) == 1
    assert len(impinge.clash(meters, tolerance="3mm")) == len(impinge.clash(meters, tolerance=0.003)) == 0
    assert impinge.clash(meters).tolerance == 1e-4
    assert re.search(r" by (1\.9\d*|2|2\.0\d*) mm$", impinge.clash(meters)[0].sentence)
    feet = impinge.load_scene(tmp_path / "two.obj", "ft")
    with pytest.raises(impinge.InputError, match="different units") as caught:
        impinge.clash({"a": meters, "b": feet})
    assert (caught.value.kind, caught.value.what) == ("unit", "scenes")
    # Meshes that were not loaded have no unit.
    with pytest.raises(impinge.InputError, match="the scenes state none") as caught:
        impinge.clash(house(), tolerance="1mm")
    assert (caught.value.kind, caught.value.what) == ("unit", "tolerance")


def crowd(count):
    """Returns a scene of cubes that all overlap."""
    names = [str(at) for at in range(count)]
    return impinge.Scene(dict.fromkeys(names, CUBE), poses={name: pose([int(name) / 1024, 0, 0]) for name in names})


def test_progress_is_shown_on_request(capfd):
    scene = crowd(60)
    report = impinge.clash(scene, progress=True)
    assert "of 1,770" in capfd.readouterr().err
    assert report.to_json() == impinge.clash(scene).to_json()
    assert not capfd.readouterr().err


@pytest.mark.parametrize(
    ("kind", "what", "options"),
    [
        ("type", "scenes", {"scenes": [1]}),
        ("type", "scenes", {"scenes": {"a": CUBE}}),
        ("name", "scenes", {"scenes": {"a/b": house()}}),
        ("name", "scenes", {"scenes": {"": house()}}),
        ("negative", "tolerance", {"tolerance": -1}),
        ("out-of-range", "tolerance", {"tolerance": np.inf}),
        ("out-of-range", "clearance", {"clearance": np.inf}),
        ("option", "clearance", {"clearance": "wide"}),
        ("type", "tolerance", {"tolerance": [1]}),
        ("type", "between", {"between": 1}),
        ("type", "contacts", {"contacts": None}),
        ("type", "progress", {"progress": None}),
        ("type", "rules", {"rules": 5}),
        ("type", "previous", {"previous": 5}),
        ("empty", "rules", {"rules": RULES}),
        ("syntax", "rules", {"rules": RULES.replace('b = "rest"', 'b = "test"')}),
        ("syntax", "rules", {"rules": "a\nb"}),
    ],
)
def test_invalid_arguments_are_named(kind, what, options):
    with pytest.raises(impinge.InputError) as caught:
        impinge.clash(**{"scenes": house(), **options})
    assert (caught.value.kind, caught.value.what) == (kind, what)


def test_errors_of_files_name_the_place(tmp_path):
    with pytest.raises(FileNotFoundError):
        impinge.clash(house(), rules=tmp_path / "none.toml")
    (tmp_path / "rules.toml").write_text(RULES)
    with pytest.raises(impinge.InputError, match="no part of the scenes has a type") as caught:
        impinge.clash(house(), rules=tmp_path / "rules.toml")
    assert (caught.value.what, caught.value.where) == (str(tmp_path / "rules.toml"), "line 3")
    (tmp_path / "old.json").write_text("{}")
    with pytest.raises(impinge.InputError, match=r"the schema impinge\.clash/1"):
        impinge.clash(house(), previous=tmp_path / "old.json")
    with pytest.raises(impinge.InputError, match="old: must be an impinge"):
        impinge.clash(house()).diff("old.json")
    with pytest.raises(FileNotFoundError):
        impinge.clash(house()).to_json(tmp_path / "none" / "new.json")


def test_a_limit_ends_the_search():
    with impinge.limit(seconds=0.05), pytest.raises(TimeoutError):
        impinge.clash(crowd(300))


def test_a_page_has_the_report_and_survives_a_copy(tmp_path):
    report = impinge.clash(impinge.Scene({"a": CUBE, "b": CUBE}, poses={"b": pose([0.5, 0, 0])}))
    page = report.to_html(tmp_path / "page.html")
    assert page.startswith("<!doctype html>")
    assert page.count('<script type="application/octet-stream"') == 3
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page
    assert pickle.loads(pickle.dumps(report)).to_html() == page
    shown = report._repr_html_()
    assert shown.startswith('<iframe srcdoc="')
    assert html.unescape(shown.split('"')[1]) == page
