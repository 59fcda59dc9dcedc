"""A drop-in replacement for the collision part of python-fcl: use ``from impinge import fcl``.

Names, arguments and conventions are those of python-fcl: a `BVHModel` is a surface; all other
geometries are solids, which intersect anything inside them. Answers are those of impinge: they are
exact, no contact is false or missing, and each pair of faces is reported once.

Differences from python-fcl: the normal and the depth of a contact of two surfaces are those of the
region in which they penetrate each other, not those of its two triangles. If one body lies inside
the other and their surfaces do not intersect, there is one contact without faces (-1). A contact of
a geometry that is not a mesh has no faces either. Continuous collision detection is not supported.

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
