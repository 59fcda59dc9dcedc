"""Exact, fast collision detection for triangle meshes.

>>> import impinge
>>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> impinge.intersects(triangle, triangle, pose_b=impinge.pose([0, 0, 1]))
False

A pose is a (4, 4) matrix that maps local to world coordinates, for column vectors. A function that
takes an array of poses, (n, 4, 4), processes all of them in one call, on all cores.
`impinge.trimesh` and `impinge.fcl` are drop-in replacements for ``trimesh.collision`` and for the
collision part of python-fcl.
"""

from impinge import ccd, cluster, fit, partition
from impinge._character import Animation, Character, Leaks, Part
from impinge._character_pose import CharacterPose, PartHit, PartHits, PartPairs, SurfaceHit
from impinge._clash import clash
from impinge._clash_report import ClashReport
from impinge._clash_rows import Clash, ClashDiff, ClashDuplicates, ClashGroup, ClashPart
from impinge._contacts import ContactRows, Contacts, contacts
from impinge._decomposition import ConvexPart, ConvexParts
from impinge._depth import Depth, deeper, depth
from impinge._details import Details
from impinge._distances import Distance, distance, within
from impinge._errors import InputError, LoadWarning, Status
from impinge._impinge import __version__
from impinge._inspection import Health, Repair, TreeStatistics
from impinge._intersections import (
    LimitedPairs,
    intersecting_pairs,
    intersection_curves,
    intersects,
    penetrates,
    self_intersecting_pairs,
)
from impinge._limits import limit
from impinge._load import load, load_scene
from impinge._mesh import Mesh
from impinge._motion import Impact, Motion, time_of_impact
from impinge._origin import Origin
from impinge._pairs import Pairs
from impinge._part_bodies import PartBodies
from impinge._penetration import Penetration, penetration
from impinge._picture import Picture
from impinge._planning_scene import load_planning_scene
from impinge._points import ClosestPoint, RayHit, RayHits
from impinge._pose import pose
from impinge._robot import Robot
from impinge._robot_audit import RobotAudit
from impinge._robot_joint import Joint
from impinge._robot_motion import RobotClearance, RobotMotion
from impinge._robot_report import RobotReport
from impinge._scene import Scene
from impinge._scene_report import SceneReport
from impinge._shape import Shape
from impinge._show import show
from impinge._solid_bsp import SolidBsp
from impinge._threads import threads
from impinge._world import World
from impinge._world_answers import (
    Bodies,
    BodyDistance,
    BodyImpact,
    BodyImpacts,
    BodyRayHit,
    BodyRayHits,
    Step,
    Work,
)
from impinge._world_state import WorldState
from impinge.fit import Hull, Sphere, convex_hull, minimal_sphere

__all__ = [
    "Animation",
    "Bodies",
    "BodyDistance",
    "BodyImpact",
    "BodyImpacts",
    "BodyRayHit",
    "BodyRayHits",
    "Character",
    "CharacterPose",
    "Clash",
    "ClashDiff",
    "ClashDuplicates",
    "ClashGroup",
    "ClashPart",
    "ClashReport",
    "ClosestPoint",
    "ContactRows",
    "Contacts",
    "ConvexPart",
    "ConvexParts",
    "Depth",
    "Details",
    "Distance",
    "Health",
    "Hull",
    "Impact",
    "InputError",
    "Joint",
    "Leaks",
    "LimitedPairs",
    "LoadWarning",
    "Mesh",
    "Motion",
    "Origin",
    "Pairs",
    "Part",
    "PartBodies",
    "PartHit",
    "PartHits",
    "PartPairs",
    "Penetration",
    "Picture",
    "RayHit",
    "RayHits",
    "Repair",
    "Robot",
    "RobotAudit",
    "RobotClearance",
    "RobotMotion",
    "RobotReport",
    "Scene",
    "SceneReport",
    "Shape",
    "SolidBsp",
    "Sphere",
    "Status",
    "Step",
    "SurfaceHit",
    "TreeStatistics",
    "Work",
    "World",
    "WorldState",
    "__version__",
    "ccd",
    "clash",
    "cluster",
    "contacts",
    "convex_hull",
    "deeper",
    "depth",
    "distance",
    "fit",
    "intersecting_pairs",
    "intersection_curves",
    "intersects",
    "limit",
    "load",
    "load_planning_scene",
    "load_scene",
    "minimal_sphere",
    "partition",
    "penetrates",
    "penetration",
    "pose",
    "self_intersecting_pairs",
    "show",
    "threads",
    "time_of_impact",
    "within",
]
