"""What people look at and hand on of a clash report: pictures and BCF."""

import pickle
import re
import zipfile
from datetime import UTC, datetime

import impinge
import numpy as np
import pytest
from impinge import pose
from shapes import cube

CUBE = impinge.Mesh(*cube())

PLACES = {"wall": [0, 0, 0], "pipe": [0.75, 0.75, 0]}
"""The pipe enters the wall by 0.25."""


def house(places=PLACES):
    """Returns a scene of cubes."""
    return impinge.Scene(dict.fromkeys(places, CUBE), poses={name: pose(place) for name, place in places.items()})


def colors(picture):
    """Returns the masks of pixels that are blue, orange and red."""
    r, g, b = np.moveaxis(np.asarray(picture).astype(int), -1, 0)
    return b > r + 40, (r > b + 80) & (g > b + 30), (r > g + 80) & (r > b + 30)


def test_a_picture_has_both_parts_and_their_curves(tmp_path):
    report = impinge.clash(house())
    path = tmp_path / "clash.png"
    picture = report.picture(report[0], path=path, size=(320, 240))
    assert picture.size == (320, 240)
    assert path.read_bytes() == picture._repr_png_()
    first, second, curves = (mask.sum() for mask in colors(picture))
    assert min(first, second) > 2000
    assert curves > 200
    assert np.array_equal(report.picture(report[0].id, size=(320, 240)), picture)
    copies = impinge.clash(house({"wall": [0, 0, 0], "copy": [0, 0, 0]}))
    assert colors(copies.picture(copies.duplicates[0], size=(320, 240)))[0].sum() > 2000


def test_pictures_and_bcf_refuse_what_they_cannot_show(tmp_path):
    report = impinge.clash(house())
    for known, kind in (("c-aaaaaaaa", "name"), (0, "type")):
        with pytest.raises(impinge.InputError) as raised:
            report.picture(known)
        assert (raised.value.kind, raised.value.what) == (kind, "clash")
    for size in ((8, 8), 5):
        with pytest.raises(impinge.InputError, match="size"):
            report.picture(report[0], size=size)
    with pytest.raises(impinge.InputError, match=r"\.bcfzip"):
        report.to_bcf(tmp_path / "clash.zip")
    with pytest.raises(impinge.InputError, match="no unit"):
        report.to_bcf(tmp_path / "clash.bcfzip")
    copy = pickle.loads(pickle.dumps(report))
    for ask in (lambda: copy.picture(copy[0]), lambda: copy.to_bcf(tmp_path / "clash.bcfzip")):
        with pytest.raises(impinge.InputError, match="pickle") as raised:
            ask()
        assert raised.value.kind == "state"
    space = impinge.Scene({"wall": CUBE, "ground": impinge.Shape.half_space([0, 0, 1], 0)})
    buried = impinge.clash(space)
    with pytest.raises(impinge.InputError, match="unbounded"):
        buried.picture(buried[0])


def model(tmp_path, unit="m"):
    """Returns a scene of two cubes that was loaded from a file."""
    path = tmp_path / "house.obj"
    lines = []
    for at, (name, place) in enumerate((("wall", [0, 0, 0]), ("pipe", [0.75, 0.75, 0]))):
        lines.append(f"o {name}")
        lines += [f"v {x} {y} {z}" for x, y, z in cube()[0] + place]
        lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in cube()[1] + 8 * at]
    path.write_text("\n".join(lines))
    return path, impinge.load_scene(path, unit=unit)


@pytest.mark.parametrize("version", ["2.1", "3.0"])
def test_bcf_has_the_clashes_and_its_statuses_come_back(tmp_path, monkeypatch, version):
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    file, scene = model(tmp_path)
    report = impinge.clash({"house": scene})
    path, again = tmp_path / "first.bcfzip", tmp_path / "again.bcf"
    report.to_bcf(path, version)
    report.to_bcf(again, version)
    assert path.read_bytes() == again.read_bytes()
    with zipfile.ZipFile(path) as archive:
        assert f'VersionId="{version}"' in archive.read("bcf.version").decode()
        (markup,) = (archive.read(name).decode() for name in archive.namelist() if name.endswith("markup.bcf"))
        (snapshot,) = (archive.read(name) for name in archive.namelist() if name.endswith("snapshot.png"))
    assert report[0].id in markup
    assert snapshot.startswith(b"\x89PNG")
    stamp = datetime.fromtimestamp(file.stat().st_mtime, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    assert stamp in markup
    assert impinge.clash({"house": scene}, previous=path)[0].status == "active"
    # Another program changes the status of the topic.
    changed = tmp_path / "changed.bcfzip"
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(changed, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name.endswith("markup.bcf"):
                content = re.sub(rb'TopicStatus="[^"]*"', b'TopicStatus="Approved"', content)
            new.writestr(name, content)
    assert impinge.clash({"house": scene}, previous=changed)[0].status == "approved"
    with pytest.raises(impinge.InputError, match="no unit"):
        impinge.clash(house(), previous=path)
    broken = tmp_path / "broken.bcf"
    broken.write_bytes(b"no archive")
    with pytest.raises(impinge.InputError) as raised:
        impinge.clash({"house": scene}, previous=broken)
    assert (raised.value.kind, raised.value.what) == ("bcf", str(broken))
    with pytest.raises(FileNotFoundError):
        impinge.clash({"house": scene}, previous=tmp_path / "missing.bcf")


def test_the_date_and_the_axis_that_points_up_may_be_given(tmp_path):
    _, scene = model(tmp_path)
    markups = []
    for up in ("y", "z"):
        report = impinge.clash({"house": scene}, up=up)
        report.to_bcf(tmp_path / "a.bcfzip", date=datetime(2024, 2, 29, 12, tzinfo=UTC))
        with zipfile.ZipFile(tmp_path / "a.bcfzip") as archive:
            names = [name for name in archive.namelist() if name.endswith((".bcf", ".bcfv"))]
            markups.append("".join(archive.read(name).decode() for name in names))
    assert all("2024-02-29T12:00:00Z" in text for text in markups)
    assert markups[0] != markups[1]
