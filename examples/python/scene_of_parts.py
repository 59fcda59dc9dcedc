"""A scene of named parts: which pairs of them intersect or come near, in many configurations.

Neighboring links of the robot are ignored. Only pairs of parts whose boxes are near each other are
tested.
"""

from pathlib import Path

import impinge
import numpy as np

DATA = Path(__file__).parents[2] / "data"
CONFIGURATIONS = 8

parts = {
    "base": impinge.Shape.box([0.25, 0.125, 0.25]),
    "arm": impinge.Shape.capsule([0, 0, 0], [0.5, 0, 0], 0.0625),
    "hand": impinge.Shape.sphere(0.125),
    "human": impinge.load(DATA / "human_makehuman_cc0.ply"),
}
scene = impinge.Scene(parts, ignored=[("base", "arm"), ("arm", "hand")])

# The base is fixed. The arm sinks from one configuration to the next, together with the hand at its
# end.
shoulders = np.array([[-1, 0.5 - row / 8, 0.25] for row in range(CONFIGURATIONS)])
poses = {
    "base": impinge.pose([-1, -0.5, 0.25]),
    "arm": impinge.pose(shoulders),
    "hand": impinge.pose(shoulders + np.array([0.5, 0, 0])),
}

report = scene.check(poses, stop="all")
print(f"{report.intersects.sum()} of {CONFIGURATIONS} configurations have parts that intersect")
for row in range(CONFIGURATIONS):
    for a, b in report.names(row):
        print(f"configuration {row}: {a} and {b}")

near = scene.check(poses, question="within", clearance=0.125, stop="all")
print(f"{near.intersects.sum()} of {CONFIGURATIONS} configurations have parts within 0.125 of each other")
