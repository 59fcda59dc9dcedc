"""Limits of time and memory: calls end with an error or with marked rows, and later calls work."""

import time

import impinge
import numpy as np
import pytest
from shapes import cube, random_poses, torus

TORUS = impinge.Mesh(*torus())
CUBE = impinge.Mesh(*cube())
PILE = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]] * 3000)
"""Faces in one place: nine million pairs intersect, which take 72 MB."""

MANY = random_poses(200_000, 1.0, 1)
SPHERES = impinge.Shape.compound([(impinge.Shape.sphere(0.1), impinge.pose([k, 0, 0])) for k in range(200)])


LONG_CALLS = {
    "intersecting_pairs": lambda: impinge.intersecting_pairs(TORUS, TORUS, MANY, limit=1),
    "distance": lambda: impinge.distance(TORUS, TORUS, MANY),
    "shapes": lambda: impinge.intersects(SPHERES, TORUS, MANY[:, :, :]),
    "penetrates": lambda: impinge.penetrates(TORUS, TORUS, MANY),
    "curves": lambda: impinge.intersection_curves(TORUS, TORUS, MANY),
    "closest_point": lambda: TORUS.closest_point(np.zeros((5_000_000, 3))),
    "scene": lambda: impinge.Scene({"a": TORUS, "b": TORUS}).check({"a": MANY}, stop="all"),
}


@pytest.mark.parametrize("name", LONG_CALLS)
def test_a_call_ends_at_its_deadline(name):
    call = LONG_CALLS[name]
    with impinge.limit(seconds=0.05), pytest.raises(TimeoutError):
        call()
    assert impinge.intersects(TORUS, CUBE)


def test_rows_that_are_complete_are_returned():
    with impinge.limit(seconds=0.005):
        hits, status = impinge.intersects(TORUS, TORUS, MANY, on_error="status")
        late, late_status = impinge.intersects(TORUS, TORUS, MANY[:2], on_error="status")
    is_late = status == impinge.Status.OUT_OF_BUDGET
    assert len(hits) == len(MANY)
    assert is_late.any()
    assert hits[is_late].all()
    first = np.flatnonzero(~is_late)[:200]
    assert np.array_equal(hits[first], impinge.intersects(TORUS, TORUS, MANY[first]))
    assert len(late) == len(late_status) == 2


def test_no_time_at_all_marks_all_rows():
    with impinge.limit(seconds=0):
        time.sleep(0.001)
        for rows in (2, 3000):
            bounds, status = impinge.distance(TORUS, CUBE, MANY[:rows], on_error="status")
            assert (status == impinge.Status.OUT_OF_BUDGET).all()
            assert (bounds.lower == 0).all()
        with pytest.raises(TimeoutError, match=r"impinge\.limit"):
            impinge.intersects(TORUS, CUBE)
        with pytest.raises(TimeoutError):
            impinge.contacts(impinge.Shape.sphere(1), impinge.Shape.sphere(1), MANY[:300])


def test_memory_is_limited_for_each_call():
    with impinge.limit(gigabytes=0.02):
        for call in (
            lambda: impinge.intersecting_pairs(PILE, PILE),
            lambda: impinge.intersection_curves(PILE, PILE),
        ):
            with pytest.raises(MemoryError, match="gigabytes"):
                call()
        assert len(impinge.intersecting_pairs(PILE, CUBE)) > 0
        some, status = impinge.intersecting_pairs(PILE, PILE, on_error="status")
        assert status == impinge.Status.OUT_OF_BUDGET
        assert len(some) == 0
    assert len(impinge.intersecting_pairs(PILE, PILE)) == 9_000_000


def test_an_inner_block_cannot_allow_more():
    with impinge.limit(seconds=0), impinge.limit(seconds=60), pytest.raises(TimeoutError):
        impinge.distance(TORUS, CUBE)
    with impinge.limit(seconds=60):
        with impinge.limit(seconds=0), pytest.raises(TimeoutError):
            impinge.distance(TORUS, CUBE)
        impinge.distance(TORUS, CUBE)


def test_limits_are_checked():
    for limits in ({"seconds": -1}, {"gigabytes": float("nan")}):
        with pytest.raises(impinge.InputError), impinge.limit(**limits):
            pass
    with impinge.limit(seconds=1e300, gigabytes=1e300):
        assert impinge.intersects(TORUS, CUBE)
