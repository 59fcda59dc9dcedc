"""Static bodies that are one surface."""

import pickle

import impinge
import numpy as np
import pytest
from impinge import Shape


def test_bodies_of_one_surface_have_no_contacts_at_their_seams():
    tile, crate = Shape.box([0.5, 0.5, 0.5]), Shape.box([0.5, 0.4, 0.5])
    places = impinge.pose([[x + 0.5, y + 0.5, -0.5] for x in range(4) for y in range(4)])

    def sideways(world):
        normals = [contacts.normal for contacts in world.contacts()]
        return int((np.abs(np.concatenate(normals)[:, 2]) < 0.999).sum())

    world = impinge.World()
    tiles = world.insert(tile, places, kind="static", surface=2**64 - 1)
    world.insert(crate, impinge.pose([1.501, 1.5, 0.49]))
    world.step()
    assert len(world.pairs()) == 2
    assert sideways(world) == 0
    again = impinge.World()
    again.restore(pickle.loads(pickle.dumps(world.save())))
    assert sideways(again) == 0
    again.set_traits(tiles, kind="static")
    again.step()
    assert sideways(again) > 0
    again.set_traits(tiles, kind="static", surface=5)
    again.step()
    assert sideways(again) == 0
    for surface in (-1, 2**64, 1.5, "a"):
        with pytest.raises(impinge.InputError) as caught:
            world.insert(tile, kind="static", surface=surface)
        assert caught.value.what == "surface"
