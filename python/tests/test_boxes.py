"""Axis-aligned boxes in three forms, packed and in batches, against rational arithmetic."""

import pickle
from fractions import Fraction

import impinge
import numpy as np
import pytest
from impinge import fit
from shapes import random_poses

FORMS = [fit.Aabb, fit.MinWidths, fit.CenterRadius]
CONVERSIONS = [fit.AxisBox.to_min_max, fit.AxisBox.to_min_widths, fit.AxisBox.to_center_radius]


def exact(box):
    """Returns the exact corners of a box, as fractions."""
    first, second = ([Fraction(x) for x in row.tolist()] for row in box.__reduce__()[1])
    if isinstance(box, fit.Aabb):
        return first, second
    if isinstance(box, fit.MinWidths):
        return first, [x + w for x, w in zip(first, second, strict=True)]
    ends = zip(first, second, strict=True)
    return tuple(zip(*[(x - e, x + e) for x, e in ends], strict=True))


def encloses(outer, inner):
    (low, high), (own_low, own_high) = exact(outer), exact(inner)
    return all(low[k] <= own_low[k] and own_high[k] <= high[k] for k in range(3))


def overlap(a, b):
    (low_a, high_a), (low_b, high_b) = exact(a), exact(b)
    return all(low_a[k] <= high_b[k] and low_b[k] <= high_a[k] for k in range(3))


def random_boxes(count, seed):
    rng = np.random.default_rng(seed)
    low = rng.integers(-12, 12, (count, 3)) / 10 * rng.choice([1, 1, 1, 1e-9, 1e12], (count, 1))
    return [fit.Aabb(x, x + w) for x, w in zip(low, rng.integers(0, 9, (count, 3)) / 10, strict=True)]


def test_conversions_never_shrink_and_are_tight():
    rounded = 0
    for box in random_boxes(300, 1):
        for there in CONVERSIONS:
            for back in CONVERSIONS:
                made = there(box)
                again = back(made)
                assert encloses(made, box)
                assert encloses(again, made)
                (low, high), (least, most) = exact(again), exact(box)
                size = max(abs(x) for x in (*least, *most))
                assert all(abs(x - y) <= size / 2**50 for x, y in zip((*low, *high), (*least, *most), strict=True))
                rounded += exact(made) != exact(box)
    assert rounded > 300


def test_box_predicates_agree_with_rational_arithmetic():
    hits, close = 0, 0
    boxes = random_boxes(60, 2)
    for form, convert in zip(FORMS, CONVERSIONS, strict=True):
        made = [convert(box) for box in boxes]
        for a in made:
            for b in made:
                true, said = overlap(a, b), a.overlaps(b)
                hits += true
                close += said and not true
                assert said or not true
                assert said == true or form is fit.CenterRadius
                assert encloses(a, b) or not a.encloses(b)
                assert form is not fit.Aabb or a.encloses(b) == encloses(a, b)
                merged = a.merged(b)
                assert type(merged) is form
                assert encloses(merged, a)
                assert encloses(merged, b)
    assert 600 < hits < 9000
    assert close < 100


def test_boxes_contain_their_points_and_the_images_of_their_corners():
    rng = np.random.default_rng(3)
    for box in random_boxes(40, 4):
        low, high = box.low, box.high
        points = rng.choice([0, 0.5, 1, 1.5], (30, 3)) * (high - low) + low
        inside = ((points >= low) & (points <= high)).all(axis=1)
        for convert in CONVERSIONS:
            made = convert(box)
            assert (made.contains(points) >= inside).all()
            assert made.contains(low) is True
            [pose] = random_poses(1, 5, 6)
            corners = np.where(rng.integers(0, 2, (8, 3)), low, high) @ pose[:3, :3].T + pose[:3, 3]
            moved = made.moved(pose)
            assert type(moved) is type(made)
            middle = moved.to_center_radius()
            slack = 1e-12 * (1 + np.abs(corners).max())
            assert (np.abs(corners - middle.center) <= middle.half_extents + slack).all()
        assert np.array_equal(box.contains(points), inside)


@pytest.mark.parametrize("bits", [8, 16])
def test_packed_boxes_enclose_the_original_box(bits):
    nbytes, most, hits = {8: 16, 16: 20}[bits], 2**bits, 0
    boxes = random_boxes(80, 5)
    for convert in CONVERSIONS[1:]:
        packed = [convert(box).packed(bits) for box in boxes]
        for box, small in zip(boxes, packed, strict=True):
            loose = small.unpacked()
            assert small.nbytes == nbytes
            assert encloses(loose, convert(box))
            assert small.volume == loose.volume
            extent, size = max(box.high - box.low), np.abs([box.low, box.high]).max()
            grown = max(exact(loose)[1][k] - exact(loose)[0][k] - Fraction(box.high[k] - box.low[k]) for k in range(3))
            assert grown <= 8 * extent / most + size / 2**20
            assert exact(pickle.loads(pickle.dumps(small)).unpacked()) == exact(loose)
            for other in packed:
                hits += small.overlaps(other)
                assert small.overlaps(other) == loose.overlaps(other.unpacked())
    assert 200 < hits < 12_000


def test_a_batch_finds_the_same_boxes_as_single_tests():
    rng = np.random.default_rng(6)
    low = rng.integers(0, 40, (1003, 3)).astype(np.float32)
    batch = fit.AabbBatch(low, low + 4)
    assert len(batch) == 1003
    found = 0
    for x in rng.integers(0, 40, (20, 3)).astype(float):
        box = fit.Aabb(x, x + 3)
        near = ((low <= box.high) & (low + 4 >= box.low)).all(axis=1)
        for convert in CONVERSIONS:
            assert np.array_equal(batch.overlapping(convert(box)), np.flatnonzero(near))
            assert np.array_equal(pickle.loads(pickle.dumps(batch)).overlapping(box), np.flatnonzero(near))
        found += near.sum()
    assert 20 < found < 2000
    assert fit.AabbBatch(low).overlapping(fit.Aabb([-1, -1, -1], [50, 50, 50])).tolist() == list(range(1003))
    # Corners that float32 cannot represent are rounded outward, so no overlap is missed.
    assert fit.AabbBatch([[0.1] * 3]).overlapping(fit.Aabb([0.1] * 3, [0.1] * 3)).tolist() == [0]


@pytest.mark.parametrize("form", FORMS)
def test_boxes_are_immutable_and_picklable(form):
    box = form([0.1, 0.2, 0.3], [0.5, 0.6, 0.7])
    again = pickle.loads(pickle.dumps(box))
    assert exact(again) == exact(box)
    assert (again.volume, again.surface_area) == (box.volume, box.surface_area)
    assert isinstance(box, fit.Volume)
    with pytest.raises(ValueError, match="read-only"):
        box.__reduce__()[1][0][0] = 1
    with pytest.raises(AttributeError):
        box.volume = 3


def test_volumes_and_areas_of_boxes():
    assert fit.Aabb([1, 1, 1], [3, 4, 5]).volume == fit.MinWidths([0, 0, 0], [2, 3, 4]).volume == 24
    assert fit.CenterRadius([9, 9, 9], [1, 1.5, 2]).surface_area == 2 * (6 + 12 + 8)
    points = np.random.default_rng(7).normal(size=(50, 3))
    assert fit.aabb(points).contains(points).all()


@pytest.mark.parametrize(
    ("kind", "what", "where", "make"),
    [
        ("order", "high", (), lambda: fit.Aabb([0, 0, 1], [1, 1, 0])),
        ("shape", "low", (), lambda: fit.Aabb([[0, 0, 0]], [1, 1, 1])),
        ("non-finite", "low", (), lambda: fit.MinWidths([np.nan, 0, 0], [1, 1, 1])),
        ("negative", "widths", (1,), lambda: fit.MinWidths([0, 0, 0], [1, -1, 1])),
        ("negative", "half_extents", (2,), lambda: fit.CenterRadius([0, 0, 0], [1, 1, -1])),
        ("out-of-range", "center", (), lambda: fit.CenterRadius([1e200, 0, 0], [1, 1, 1])),
        ("shape", "half_extents", (), lambda: fit.CenterRadius([0, 0, 0], [[1, 1, 1]])),
        ("type", "other", (), lambda: fit.Aabb([0, 0, 0], [1, 1, 1]).overlaps(fit.MinWidths([0, 0, 0], [1, 1, 1]))),
        ("type", "other", (), lambda: fit.Aabb([0, 0, 0], [1, 1, 1]).merged("box")),
        ("shape", "pose", (), lambda: fit.Aabb([0, 0, 0], [1, 1, 1]).moved(np.zeros((0, 4, 4)))),
        ("singular", "pose", (), lambda: fit.Aabb([0, 0, 0], [1, 1, 1]).moved(np.diag([1.0, 1, 0, 1]))),
        ("shape", "points", (), lambda: fit.Aabb([0, 0, 0], [1, 1, 1]).contains([0, 0])),
        ("out-of-range", "box", (0,), lambda: fit.MinWidths([1e39, 0, 0], [1, 1, 1]).packed()),
        ("option", "bits", (), lambda: fit.MinWidths([0, 0, 0], [1, 1, 1]).packed(12)),
        ("shape", "low", (), lambda: fit.AabbBatch([0, 0, 0])),
        ("type", "box", (), lambda: fit.AabbBatch([[0, 0, 0]]).overlapping([0, 0, 0])),
    ],
)
def test_errors_name_the_invalid_argument(kind, what, where, make):
    with pytest.raises(impinge.InputError) as caught:
        make()
    assert (caught.value.kind, caught.value.what, caught.value.where) == (kind, what, where)


def test_packed_boxes_of_two_forms_raise_an_error():
    box = fit.Aabb([0, 0, 0], [1, 1, 1])
    with pytest.raises(impinge.InputError, match="PackedMinWidths"):
        box.to_min_widths().packed().overlaps(box.to_center_radius().packed())
    assert repr(box.to_min_widths().packed()) == "PackedMinWidths(20 bytes)"
