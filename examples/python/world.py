"""A world of bodies that the caller moves: each step reports which pairs start or stop touching.

The tags 0, 1, 2 and so on are the caller's own numbers. Reports are sorted by them.
"""

import impinge
import numpy as np

world = impinge.World()
world.insert(impinge.Shape.half_space([0, 0, 1]), kind="static", tag=0)
heights = np.array([1.0, 2.25, 3.5])
crates = world.insert(impinge.Shape.box([0.5, 0.5, 0.5]), impinge.pose([[0, 0, z] for z in heights]), tag=[1, 2, 3])
balloon = world.insert(impinge.Shape.sphere(0.25), impinge.pose([0.625, 0, 0.25]), tag=4)
bodies = [*crates, balloon]

for frame in range(8):
    # The crates fall, and the balloon rises beside them.
    heights = np.maximum(heights - 0.25, [0.5, 1.5, 2.5])
    places = [[0, 0, z] for z in heights] + [[0.625, 0, 0.25 + 0.375 * frame]]
    step = world.step(bodies, impinge.pose(places))
    for a, b in world.tags(step.began):
        print(f"frame {frame}: {a} and {b} start touching")
    for a, b in world.tags(step.ended):
        print(f"frame {frame}: {a} and {b} stop touching")

contacts = world.contacts()
for (a, b), of_pair in zip(world.tags(world.pairs()), contacts, strict=True):
    x, y, z = of_pair.normal[0]
    print(f"{a} touches {b} in {len(of_pair)} points along ({x:.6f}, {y:.6f}, {z:.6f})")

hit = world.ray_cast([0.125, 0.25, 9], [0, 0, -1])
print(f"a ray from above hits {world.tags(hit.body)} at {hit.t:.6f}")

# A world can return to a saved state.
saved = world.save()
world.remove(crates)
print(f"{len(world)} bodies without the crates")
world.restore(saved)
print(f"{len(world)} bodies, {len(world.pairs())} pairs")
