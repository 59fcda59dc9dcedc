"""Handles of bodies, as arrays and in lists."""

import impinge
import numpy as np
import pytest
from impinge import Shape, pose


def test_handles_in_lists_may_be_of_any_integer_type():
    world = impinge.World()
    many, one = (
        world.insert(Shape.sphere(1), pose([[0, 0, 0], [5, 0, 0]])),
        world.insert(Shape.sphere(1), pose([9, 0, 0])),
    )
    mixed = [*many, int(one)]
    assert world.step(mixed, pose([[0, 0, 0], [1, 0, 0], [9, 0, 0]])).began.tolist() == [many.tolist()]
    assert np.array_equal(world.tags(mixed), world.tags(np.array(mixed, np.uint64)))
    with pytest.raises(impinge.InputError, match="dtype"):
        world.tags([True, False])
