"""Two meshes at two poses: whether they intersect, in which faces, and along which curves.

The answers are exact, and touching counts as intersecting.
"""

from pathlib import Path

import impinge
import numpy as np

DATA = Path(__file__).parents[2] / "data"

human = impinge.load(DATA / "human_makehuman_cc0.ply")
beside = impinge.pose([0.5, 0, 0.125])

if impinge.intersects(human, human, pose_b=beside):
    print("the surfaces intersect")
if impinge.penetrates(human, human, pose_b=beside):
    print("the interiors intersect")

pairs = impinge.intersecting_pairs(human, human, pose_b=beside)
print(f"{len(pairs)} pairs of faces, the first {pairs[0, 0]} with {pairs[0, 1]}")

for curve in impinge.intersection_curves(human, human, pose_b=beside):
    length = np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()
    x, y, z = curve.mean(axis=0)
    print(f"a curve of {len(curve)} points, {length:.6f} long, about ({x:.6f}, {y:.6f}, {z:.6f})")
