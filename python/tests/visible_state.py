"""Visible state of an object, as text that can be compared."""

import impinge
import numpy as np
from impinge import fcl

VIEWS = [
    (np.ndarray, lambda array: (str(array.dtype), array.shape, str(array.tolist()))),
    (impinge.Mesh, lambda mesh: (mesh.vertices, mesh.faces, mesh.origin)),
    (impinge.World, lambda world: (world.bodies, world.pairs(), world.poses(world.bodies), world.tags(world.bodies))),
    (impinge.WorldState, lambda kept: kept.data()[4:6]),
    (impinge.Motion, lambda motion: (motion.at(0.0), motion.at(0.3), motion.at(1.0))),
    (impinge.ClashReport, lambda report: (*report, report.counts, report.groups(), report.to_csv(), report.to_html())),
    (impinge.CharacterPose, lambda posed: (posed.frames, posed.vertices)),
    (impinge.Robot, lambda robot: (robot.name, robot.links, robot.joints, robot.pairs, robot.at(np.zeros(robot.dof)))),
    (impinge.Character, lambda character: (character.parts, character.animations, character.faces)),
    (impinge.partition.Partition, lambda held: (held.keys, held.boxes(), held.cells, held.pairs())),
    (impinge.SolidBsp, lambda tree: (tree.cells, tree.depth, tree.contains([[0.1, 0.2, 0.3], [9, 9, 9]]))),
    (impinge.fit.AxisBox, lambda box: (*box.__reduce__()[1], box.volume, box.surface_area)),
    (impinge.fit.PackedBox, lambda box: (box.nbytes, box.unpacked())),
    (impinge.fit.AabbBatch, lambda many: (len(many), many.overlapping(impinge.fit.Aabb([0.1] * 3, [2.5] * 3)))),
    (fcl.Transform, lambda transform: transform.matrix),
    (fcl.CollisionObject, lambda thing: (thing.geometry, thing.matrix)),
    (set | frozenset, lambda items: sorted(map(str, items))),
    (dict, lambda items: [(str(key), value) for key, value in items.items()]),
]
"""Views of the types whose fields do not show their state: a type, and a function to its state."""


def state(thing):
    """Returns the visible state of an object as text."""
    for kind, view in VIEWS:
        if isinstance(thing, kind):
            return state(view(thing))
    if isinstance(thing, list | tuple):
        return str([state(item) for item in thing])
    if hasattr(thing, "__dict__") and not isinstance(thing, type):
        return type(thing).__name__ + state(vars(thing))
    return repr(thing)
