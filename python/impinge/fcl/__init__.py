"""A stand-in for the part of python-fcl that collides: ``from impinge import fcl`` in place of ``import fcl``.

Names, arguments and conventions are python-fcl's: a `BVHModel` is a surface, all else a solid, which
meet what lies inside them. Answers are impinge's: exact, without false or missing contacts, each pair of faces once.

What differs: the normal and the depth of a contact of two surfaces are those of the region in which they go through
each other, and not of its two triangles. Two bodies one of which is inside the other, their surfaces apart, have one
contact without faces (-1). A contact of anything but meshes has no faces either. Continuous collision is not there.

Examples
--------
>>> from impinge import fcl
>>> request, result = fcl.CollisionRequest(num_max_contacts=100), fcl.CollisionResult()
>>> small, large = fcl.CollisionObject(fcl.Box(1, 1, 1)), fcl.CollisionObject(fcl.Box(4, 4, 4))
>>> fcl.collide(small, large, request, result)
1
>>> small.setTranslation([2.5, 0, 0])
>>> fcl.collide(small, large, request) > 1
True
>>> small.setTranslation([2.6, 0, 0])
>>> fcl.collide(small, large)
0
"""

from impinge.fcl._collision import (
    CollisionData,
    CollisionRequest,
    CollisionResult,
    Contact,
    collide,
    defaultCollisionCallback,
)
from impinge.fcl._distance import DistanceData, DistanceRequest, DistanceResult, defaultDistanceCallback, distance
from impinge.fcl._geometry import Box, BVHModel, CollisionGeometry, CollisionObject, Convex, TriangleP
from impinge.fcl._manager import DynamicAABBTreeCollisionManager
from impinge.fcl._round import Capsule, Cone, Cylinder, Ellipsoid, Halfspace, Sphere
from impinge.fcl._transform import Transform

__all__ = [
    "BVHModel",
    "Box",
    "Capsule",
    "CollisionData",
    "CollisionGeometry",
    "CollisionObject",
    "CollisionRequest",
    "CollisionResult",
    "Cone",
    "Contact",
    "Convex",
    "Cylinder",
    "DistanceData",
    "DistanceRequest",
    "DistanceResult",
    "DynamicAABBTreeCollisionManager",
    "Ellipsoid",
    "Halfspace",
    "Sphere",
    "Transform",
    "TriangleP",
    "collide",
    "defaultCollisionCallback",
    "defaultDistanceCallback",
    "distance",
]
