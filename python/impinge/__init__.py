"""Exact, fast collision detection for triangle meshes.

>>> import impinge
>>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> impinge.intersects(triangle, triangle, pose_b=impinge.pose([0, 0, 1]))
False

A pose is a (4, 4) matrix, world from local, for column vectors. Arrays of poses, (n, 4, 4), are answered in one call,
on all cores. `impinge.trimesh` and `impinge.fcl` stand in for the collision parts of the libraries of those names.
"""

from impinge._errors import InputError, LoadWarning, Status
from impinge._impinge import __version__
from impinge._mesh import Mesh, Origin, load
from impinge._pairs import Pairs
from impinge._pose import pose
from impinge._queries import Distance, distance, intersecting_pairs, intersection_curves, intersects, within
from impinge._scene import Scene, SceneReport
from impinge._show import show
from impinge._threads import threads

__all__ = [
    "Distance",
    "InputError",
    "LoadWarning",
    "Mesh",
    "Origin",
    "Pairs",
    "Scene",
    "SceneReport",
    "Status",
    "__version__",
    "distance",
    "intersecting_pairs",
    "intersection_curves",
    "intersects",
    "load",
    "pose",
    "show",
    "threads",
    "within",
]
