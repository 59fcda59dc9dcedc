"""Many objects, and which of them come near each other."""

# The names are python-fcl's.
# ruff: noqa: N802

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge import _bodies
from impinge._errors import InputError
from impinge.fcl._geometry import CollisionObject

Callback = Callable[[CollisionObject, CollisionObject, Any], bool]
DistanceCallback = Callable[[CollisionObject, CollisionObject, Any, float], tuple[bool, float]]

_WANTED = "wants (cdata, callback), (manager, cdata, callback) or (object, cdata, callback)"


def nearest_first(
    pairs: Sequence[tuple[CollisionObject, CollisionObject]],
    measure: Callable[[CollisionObject, CollisionObject, float], tuple[bool, float]],
) -> None:
    """Measure pairs in the order of their boxes' gaps, as long as one may be nearer than the least distance so far."""
    boxes = {id(own): own.box for pair in pairs for own in pair}
    gaps = [_bodies.gap(boxes[id(o1)], boxes[id(o2)]) for o1, o2 in pairs]
    least = np.inf
    for at in np.argsort(gaps, kind="stable"):
        if gaps[at] > least or (gaps[at] > 0 and least <= 0):
            return
        o1, o2 = pairs[at]
        done, least = measure(o1, o2, least)
        if done:
            return


class DynamicAABBTreeCollisionManager:
    """Many objects, of which those whose boxes overlap are handed to a callback, in the order of registration."""

    def __init__(self) -> None:
        self._objects: list[CollisionObject] = []

    def registerObjects(self, other_objs: Sequence[CollisionObject]) -> None:
        """Add objects."""
        self._objects += other_objs

    def registerObject(self, obj: CollisionObject) -> None:
        """Add an object."""
        self._objects.append(obj)

    def unregisterObject(self, obj: CollisionObject) -> None:
        """Remove an object, if it is there."""
        self._objects = [own for own in self._objects if own is not obj]

    def setup(self) -> None:
        """Do nothing: boxes are looked up when asked about."""

    def update(self, arg: object = None) -> None:
        """Do nothing: boxes are looked up when asked about."""

    def clear(self) -> None:
        """Remove all objects."""
        self._objects.clear()

    def getObjects(self) -> list[CollisionObject]:
        """Return the objects."""
        return list(self._objects)

    def size(self) -> int:
        """Return the number of objects."""
        return len(self._objects)

    def empty(self) -> bool:
        """Return whether there are none."""
        return not self._objects

    def distance(self, *args: Any) -> None:
        """Hand pairs of objects to ``callback(o1, o2, cdata, dist)``, those with the nearest boxes first.

        It returns whether all is done, and the least distance so far. Pairs whose boxes are farther apart are left out.
        ``distance(cdata, callback)`` asks within the manager, ``distance(other, cdata, callback)`` against an object or
        another manager.
        """
        if len(args) == 2:
            pairs = list(combinations(self._objects, 2))
        elif len(args) == 3 and isinstance(args[0], DynamicAABBTreeCollisionManager):
            pairs = list(product(self._objects, args[0]._objects))
        elif len(args) == 3 and isinstance(args[0], CollisionObject):
            pairs = [(own, args[0]) for own in self._objects]
        else:
            raise InputError(_WANTED, kind="type", what="args")
        cdata, callback = args[-2:]
        nearest_first(pairs, lambda o1, o2, least: callback(o1, o2, cdata, least))

    def collide(self, *args: Any) -> None:
        """Hand pairs of objects to ``callback(o1, o2, cdata)`` until it returns True.

        ``collide(cdata, callback)`` asks within the manager, ``collide(other, cdata, callback)`` against an object or
        another manager.
        """
        if len(args) == 2:
            self._collide_within(*args)
        elif len(args) == 3 and isinstance(args[0], DynamicAABBTreeCollisionManager):
            self._collide_with(args[0]._objects, args[1], args[2])
        elif len(args) == 3 and isinstance(args[0], CollisionObject):
            self._collide_with([args[0]], args[1], args[2])
        else:
            raise InputError(_WANTED, kind="type", what="args")

    def _boxes(self) -> NDArray[np.float64]:
        return np.array([own.box for own in self._objects]).reshape(-1, 2, 3)

    def _collide_within(self, cdata: object, callback: Callback) -> None:
        boxes = self._boxes()
        for i, own in enumerate(self._objects):
            for j in _bodies.overlaps(boxes[i + 1 :], boxes[i]):
                if callback(own, self._objects[i + 1 + j], cdata):
                    return

    def _collide_with(self, others: list[CollisionObject], cdata: object, callback: Callback) -> None:
        boxes = self._boxes()
        for other in others:
            for i in _bodies.overlaps(boxes, other.box):
                if callback(self._objects[i], other, cdata):
                    return
