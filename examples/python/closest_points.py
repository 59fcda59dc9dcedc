"""Closest points: of a mesh to given points, and of two meshes to each other.

Each distance is an interval that provably contains the true distance.
"""

from pathlib import Path

import impinge

DATA = Path(__file__).parents[2] / "data"

human = impinge.load(DATA / "human_makehuman_cc0.ply")
points = [[0.0, 0.25, 0.0625], [0.0, 1.0, 0.0], [0.5, 0.5, 0.5], [2.0, 0.0, 0.0]]

found = human.closest_point(points)
inside = human.contains(points)
for row in range(len(points)):
    side = "inside" if inside[row] else "outside"
    x, y, z = found.point[row]
    print(f"{side}, {found.distance[row]:.6f} from face {found.face[row]} at ({x:.6f}, {y:.6f}, {z:.6f})")

beside = impinge.pose([1.5, 0, 0.125])
nearest = impinge.distance(human, human, pose_b=beside)
print(f"two humans are {nearest.distance:.6f} apart, at faces {nearest.face_a} and {nearest.face_b}")
for x, y, z in (nearest.point_a, nearest.point_b):
    print(f"({x:.6f}, {y:.6f}, {z:.6f})")
print("the bounds are", "tight" if nearest.upper - nearest.lower < 1e-12 else "loose")
