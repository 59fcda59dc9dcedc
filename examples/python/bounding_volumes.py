"""Bounding volumes of a mesh: how tight each kind is, and the convex hull instead of the mesh.

Each volume contains the whole mesh, so objects apart from the volume are apart from the mesh.
"""

from pathlib import Path

import impinge

DATA = Path(__file__).parents[2] / "data"

human = impinge.load(DATA / "human_makehuman_cc0.ply")
proxies = impinge.fit.proxies(human)
print(f"box: {proxies.aabb.volume:.6f}")
print(f"sphere: {proxies.sphere.volume:.6f}, of radius {proxies.sphere.radius:.6f}")
print(f"capsule: {proxies.capsule.volume:.6f}, of radius {proxies.capsule.radius:.6f}")
print(f"lozenge: {proxies.lozenge.volume:.6f}, of radius {proxies.lozenge.radius:.6f}")
print(f"oriented box: {proxies.obb.volume:.6f}")
print(f"18-DOP: {proxies.kdop18.volume:.6f}")
print(f"hull: {len(proxies.hull.vertices)} of {len(human.vertices)} vertices")

# The hull instead of the mesh: a lower bound of the distance at a fraction of the cost.
hull = impinge.Shape.hull(human.vertices[proxies.hull.vertices])
ball = impinge.Shape.sphere(0.25)
place = impinge.pose([0.75, -0.5, 0.125])
print(f"a ball is {impinge.distance(hull, ball, pose_b=place).distance:.6f} from the hull")
print(f"a ball is {impinge.distance(human, ball, pose_b=place).distance:.6f} from the human")
