"""Two meshes at many poses: one call answers for every row of an array of poses, on all processors.

Rows that follow each other along a motion take less time than shuffled rows. The answers are the
same.
"""

from pathlib import Path

import impinge
import numpy as np

DATA = Path(__file__).parents[2] / "data"
ROWS = 256

human = impinge.load(DATA / "human_makehuman_cc0.ply")
# One of two humans passes by the other from left to right.
places = np.zeros((ROWS, 3))
places[:, 0] = np.arange(ROWS) / 64 - 2
places[:, 2] = 0.125
poses = impinge.pose(places)

hits = impinge.intersects(human, human, pose_b=poses)
print(f"{hits.sum()} of {ROWS} poses intersect, the first is {hits.argmax()}")

near = impinge.within(human, human, 0.25, pose_b=poses)
print(f"{near.sum()} of {ROWS} poses come within 0.25")

distance = impinge.distance(human, human, pose_b=poses).distance
for row in range(0, ROWS, 32):
    print(f"pose {row}: distance {distance[row]:.6f}")

pairs = impinge.intersecting_pairs(human, human, pose_b=poses)
print(f"{len(pairs.rows)} pairs of faces in all, at most {pairs.counts.max()} at one pose")
