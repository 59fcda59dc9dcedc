"""Plans with OMPL, in which every motion is proved free: `pip install impinge ompl numpy`.

The gantry reaches around a post. OMPL asks the validator whether motions between states are free.
The validator proves it, so no resolution has to be chosen, and no thin obstacle is missed between
two samples. The path is then proved once more with a clearance.
"""

from __future__ import annotations

import sys
from pathlib import Path

import impinge
import numpy as np
from ompl import base, geometric

DATA = Path(__file__).resolve().parents[2] / "data" / "robots"


class ProvedMotions(base.MotionValidator):
    """Answers whether a straight motion between two states is free, by proof."""

    def __init__(self, space: base.SpaceInformation, robot: impinge.Robot, *where: object) -> None:
        super().__init__(space)
        self.robot, self.where = robot, where

    def checkMotion(self, start: base.State, end: base.State, *_: object) -> bool:
        """Return whether the motion is proved free. Undecided motions are not used."""
        ends = [values(state, self.robot.dof) for state in (start, end)]
        scene, poses = self.where
        return self.robot.check_motion(*ends, scene, poses=poses, max_steps=10_000).verdict == "free"


def values(state: base.State, count: int) -> list[float]:
    """Return the coordinates of a state."""
    return [state[at] for at in range(count)]


def main() -> int:
    """Plan a path around a post, and print its length and the verdict about it."""
    robot = impinge.Robot.load(DATA / "gantry.urdf", DATA / "gantry.srdf")
    scene = impinge.Scene({"post": impinge.Shape.cylinder(0.3, 0.03)})
    poses = {"post": impinge.pose([0.45, 0.2, 0.6])}

    space = base.RealVectorStateSpace(robot.dof)
    bounds = base.RealVectorBounds(robot.dof)
    limits = zip(np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi), strict=True)
    for at, (lower, upper) in enumerate(limits):
        bounds.setLow(at, float(lower))
        bounds.setHigh(at, float(upper))
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    information = setup.getSpaceInformation()

    def is_free(state: base.State) -> bool:
        return not robot.check(values(state, robot.dof), scene, poses=poses).collides

    setup.setStateValidityChecker(is_free)
    information.setMotionValidator(ProvedMotions(information, robot, scene, poses))
    start, goal = space.allocState(), space.allocState()
    for at, (first, last) in enumerate(zip([0.1, -1.0, 1.2, 0, 0.01], [0.1, 1.6, 1.2, 0, 0.01], strict=True)):
        start[at], goal[at] = float(first), float(last)
    setup.setStartAndGoalStates(start, goal)
    setup.setPlanner(geometric.RRTConnect(information))
    if not setup.solve(20.0):
        return 1
    path = setup.getSolutionPath()
    waypoints = np.array([values(state, robot.dof) for state in path.getStates()])
    verdict, _, _ = robot.check_path(waypoints, scene, poses=poses).path()
    print(f"{len(waypoints)} waypoints, length {path.length():.2f}, {verdict}")
    return 0 if verdict == "free" else 1


if __name__ == "__main__":
    sys.exit(main())
