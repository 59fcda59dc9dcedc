"""Pickling of the snapshots that `World.save` returns."""

from __future__ import annotations

import copyreg
from typing import Any

from impinge._impinge import WorldState
from impinge._mesh import Mesh
from impinge._shape import Shape

__all__ = ["WorldState"]


def _reduced(state: WorldState) -> tuple[type[WorldState], tuple[Any]]:
    version, options, places, (shapes, numbers), bodies, pairs, departed = state.data()
    # A mesh that `World.refit` moved has no `Shape` of the caller's, so make one.
    made = [Shape.mesh(Mesh._of(one[0], None), solid=one[1]) if isinstance(one, tuple) else one for one in shapes]
    return WorldState, ((version, options, places, (made, numbers), bodies, pairs, departed),)


copyreg.pickle(WorldState, _reduced)
