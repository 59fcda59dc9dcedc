"""Compares the robot of a worker with that of the caller."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from impinge._robot import Robot


def contents_of(robot: Robot) -> str:
    """Return a hash of the links, joints, pairs and boxes of a robot.

    A robot that was loaded travels as the paths of its files. The hash tells whether another
    machine has the same files there.
    """
    core = robot._core
    boxes = [shape.local_box() for shape in robot.shapes.values()]
    content = core.links(), core.coordinates(), core.pairs(), boxes
    return hashlib.sha256(repr(content).encode()).hexdigest()
