"""Properties of the bodies of a world: handles, poses, tags, boxes and margins."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._handles import handles_of
from impinge._points import scalar


class WorldBodies:
    """Base class of `World` that reads the properties of bodies."""

    __slots__ = ()
    _core: _impinge.WorldCore

    @property
    def bodies(self) -> NDArray[np.uint64]:
        """Handles of all bodies, (n,)."""
        return self._core.bodies()

    def poses(self, bodies: ArrayLike) -> NDArray[np.float64]:
        """Return the poses of bodies, world from body, (..., 4, 4).

        Raises
        ------
        InputError
            If a handle is stale.
        """
        handles, lead = handles_of(bodies)
        return self._core.poses(handles).reshape(*lead, 4, 4)

    def tags(self, bodies: ArrayLike) -> Any:
        """Return the tags of bodies, (...) uint64, in the shape of `bodies`.

        Raises
        ------
        InputError
            If a handle is stale.
        """
        handles, lead = handles_of(bodies)
        return scalar(self._core.tags(handles).reshape(lead))

    def bounds(self, bodies: ArrayLike) -> NDArray[np.float64]:
        """Return lower and upper corners, (..., 2, 3), of world-frame boxes of bodies and margins.

        They are -inf and inf for a body that is unbounded or empty.

        Raises
        ------
        InputError
            If a handle is stale.
        """
        handles, lead = handles_of(bodies)
        return self._core.bounds(handles).reshape(*lead, 2, 3)

    def margins(self, bodies: ArrayLike) -> Any:
        """Return the margins of bodies in world units, (...) float64, in the shape of `bodies`.

        Raises
        ------
        InputError
            If a handle is stale.
        """
        handles, lead = handles_of(bodies)
        return scalar(_impinge.world_margins(self._core, handles).reshape(lead))
