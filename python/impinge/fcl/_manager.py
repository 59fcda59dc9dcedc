"""Managers of many objects, which find the pairs that are near each other."""

# The names are those of python-fcl.
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

_EXPECTED = "must be (cdata, callback), (manager, cdata, callback) or (object, cdata, callback)"


def nearest_first(
    pairs: Sequence[tuple[CollisionObject, CollisionObject]],
    measure: Callable[[CollisionObject, CollisionObject, float], tuple[bool, float]],
) -> None:
    """Measure pairs in ascending order of the gap between their boxes.

    `measure` gets two objects and the minimum distance so far, and returns whether to stop, and the
    new minimum. The search also stops if no other pair can be nearer than the minimum.
    """
    boxes = {id(own): own.box for pair in pairs for own in pair}
    gaps = [_bodies.gap(boxes[id(o1)], boxes[id(o2)]) for o1, o2 in pairs]
    minimum = np.inf
    for at in np.argsort(gaps, kind="stable"):
        if gaps[at] > minimum or (gaps[at] > 0 and minimum <= 0):
            return
        o1, o2 = pairs[at]
        done, minimum = measure(o1, o2, minimum)
        if done:
            return


class DynamicAABBTreeCollisionManager:
    """Manager of many objects that passes pairs which may collide, or be nearest, to a callback.

    It keeps references to the objects, and every query uses their current transforms.
    """

    def __init__(self) -> None:
        self._objects: list[CollisionObject] = []

    def registerObjects(self, other_objs: Sequence[CollisionObject]) -> None:
        """Add several objects, even if they are registered already."""
        self._objects += other_objs

    def registerObject(self, obj: CollisionObject) -> None:
        """Add an object, even if it is registered already."""
        self._objects.append(obj)

    def unregisterObject(self, obj: CollisionObject) -> None:
        """Remove an object, if it is registered."""
        self._objects = [own for own in self._objects if own is not obj]

    def setup(self) -> None:
        """Do nothing: every query computes the current boxes."""

    def update(self, arg: object = None) -> None:
        """Do nothing: every query computes the current boxes."""

    def clear(self) -> None:
        """Remove all objects."""
        self._objects.clear()

    def getObjects(self) -> list[CollisionObject]:
        """Return a list of the objects, in the order of registration."""
        return list(self._objects)

    def size(self) -> int:
        """Return the number of registered objects."""
        return len(self._objects)

    def empty(self) -> bool:
        """Report whether no objects are registered."""
        return not self._objects

    def distance(self, *args: Any) -> None:
        """Pass pairs to ``callback(o1, o2, cdata, dist)``, in ascending order of their boxes' gaps.

        The callback returns whether to stop, and the minimum distance so far. `dist` is the minimum
        that the last call returned, infinite at first. Pairs whose boxes are farther apart are
        skipped. ``distance(cdata, callback)`` measures pairs within the manager.
        ``distance(other, cdata, callback)`` measures against an object or another manager. Raise an
        `InputError` for other arguments.
        """
        if len(args) == 2:
            pairs = list(combinations(self._objects, 2))
        elif len(args) == 3 and isinstance(args[0], DynamicAABBTreeCollisionManager):
            pairs = list(product(self._objects, args[0]._objects))
        elif len(args) == 3 and isinstance(args[0], CollisionObject):
            pairs = [(own, args[0]) for own in self._objects]
        else:
            raise InputError(_EXPECTED, kind="type", what="args")
        cdata, callback = args[-2:]
        nearest_first(pairs, lambda o1, o2, minimum: callback(o1, o2, cdata, minimum))

    def collide(self, *args: Any) -> None:
        """Pass pairs with overlapping boxes to ``callback(o1, o2, cdata)`` until it returns True.

        ``collide(cdata, callback)`` passes pairs within the manager.
        ``collide(other, cdata, callback)`` passes pairs with an object or another manager. Boxes
        that touch overlap. Raise an `InputError` for other arguments.
        """
        if len(args) == 2:
            self._collide_within(*args)
        elif len(args) == 3 and isinstance(args[0], DynamicAABBTreeCollisionManager):
            self._collide_with(args[0]._objects, args[1], args[2])
        elif len(args) == 3 and isinstance(args[0], CollisionObject):
            self._collide_with([args[0]], args[1], args[2])
        else:
            raise InputError(_EXPECTED, kind="type", what="args")

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
