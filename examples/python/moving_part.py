"""A part that moves: when it first touches another part, found without stepping through the motion.

No contact is missed, however fast the parts move and however thin they are.
"""

from pathlib import Path

import impinge
import numpy as np

DATA = Path(__file__).parents[2] / "data"

human = impinge.load(DATA / "human_makehuman_cc0.ply")

# A door swings by a quarter turn about its hinge, toward a human who stands in its way.
door = impinge.Shape.box([0.5, 1, 0.03125])
hinge = [-0.75, 0, -0.5]
shut = impinge.pose([-0.25, 0, -0.5])
swing = impinge.Motion.screw(shut, linear=[0, 0, 0], angular=[0, -np.pi / 2, 0], pivot=hinge)
impact = impinge.time_of_impact(human, door, motion_b=swing)
if impact.hit:
    print(f"the door touches at {impact.t_lower:.6f} of its way, after {90 * impact.t_lower:.6f} degrees")

# Another human walks by: from one pose to another in a straight line.
walk = impinge.Motion(impinge.pose([-3, 0, 0.125]), impinge.pose([3, 0, 0.125]))
impact = impinge.time_of_impact(human, human, motion_b=walk)
if impact.hit:
    x, y, z = walk.at(impact.t_lower)[:3, 3]
    print(f"the humans touch at {impact.t_lower:.6f} of the walk, at ({x:.6f}, {y:.6f}, {z:.6f})")

# Many motions in one call: parallel walks, each farther away than the one before.
lanes = np.zeros((5, 3))
lanes[:, 2] = np.arange(5) / 8
half = np.array([3, 0, 0])
walks = impinge.Motion(impinge.pose(lanes - half), impinge.pose(lanes + half))
impacts = impinge.time_of_impact(human, human, motion_b=walks)
for lane in range(5):
    if impacts.hit[lane]:
        print(f"lane {lane}: touches at {impacts.t_lower[lane]:.6f}")
    else:
        print(f"lane {lane}: passes by")
