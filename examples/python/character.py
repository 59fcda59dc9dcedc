"""A rigged character: which part a shot hits, and which part a punch hits between two frames.

The volumes contain the whole skin at every time of every animation, so a shot that misses them
misses the character.
"""

from pathlib import Path

import impinge

DATA = Path(__file__).parents[2] / "data"

robot = impinge.Character(DATA / "robot.glb", volumes=6)
for part in robot.parts:
    print(f"{part.name}: {part.kind}")

walking = robot.at("Robot_Walking", 0.5)
origins = [[0.0, 4.0, 9.0], [0.0, 2.0, 9.0], [1.0, 0.5, 9.0], [3.0, 4.0, 9.0]]
direction = [0, 0, -1]
shots = walking.ray_cast(origins, direction)
skin = walking.surface_ray_cast(origins, direction)
for row in range(len(origins)):
    if not shots.hit[row]:
        print(f"shot {row}: misses")
    elif not skin.hit[row]:
        print(f"shot {row}: enters {robot.parts[shots.part[row]].name}, misses the skin")
    else:
        name = robot.parts[skin.part[row]].name
        print(f"shot {row}: strikes {name} at {skin.t[row]:.6f}, face {skin.face[row]}")

# A fist passes through the robot within one frame, while the robot moves on.
fist = impinge.Shape.sphere(0.125)
before, after = robot.at("Robot_Walking", 0.5), robot.at("Robot_Walking", 0.55)
struck = before.strikes(after, fist, impinge.pose([0, 3.5, 9]), impinge.pose([0, 3.5, -9]))
for part, t in zip(struck.part, struck.t, strict=True):
    print(f"the fist strikes {robot.parts[part].name} at {t:.6f}")
