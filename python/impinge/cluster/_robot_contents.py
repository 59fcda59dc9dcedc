"""Compares the robot of a worker with that of the caller."""

from __future__ import annotations

import functools
import hashlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from impinge._robot import Robot

_CONFIGURATIONS = 3
"""Number of configurations at which the poses of the links are compared."""


@functools.lru_cache(maxsize=8)
def contents_of(robot: Robot) -> str:
    """Return a hash of the names, pairs and triangles of a robot, and of poses of its links.

    A robot that was loaded travels as the paths of its files. The hash tells whether another
    machine has the same files there. Poses have the same bits on every machine.
    """
    core = robot._core
    found = hashlib.sha256(repr((core.links(), core.coordinates(), core.pairs())).encode())
    q = np.random.default_rng(0).uniform(-1, 1, (_CONFIGURATIONS, robot.dof))
    found.update(core.poses(q).tobytes())
    for shape in robot.shapes.values():
        found.update(hashlib.sha256(shape.triangles()).digest())
    return found.hexdigest()
