"""Managers of many objects, which find the pairs that are near each other."""

# The names are those of python-fcl.
# ruff: noqa: N802

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from impinge import _impinge
from impinge._errors import InputError
from impinge.fcl._collision import CollisionData, defaultCollisionCallback
from impinge.fcl._geometry import CollisionObject

Callback = Callable[[CollisionObject, CollisionObject, Any], bool]
DistanceCallback = Callable[[CollisionObject, CollisionObject, Any, float], tuple[bool, float]]

_EXPECTED = "must be (cdata, callback), (manager, cdata, callback) or (object, cdata, callback)"


class DynamicAABBTreeCollisionManager(_impinge.ManagerBase):
    """Manager of many objects that passes pairs which may collide, or be nearest, to a callback.

    It keeps references to the objects and a tree over their boxes. An object that moves is marked,
    and the next query moves its box.
    """

    def __init__(self) -> None:
        self._objects: dict[int, CollisionObject] = {}
        """Objects by their keys, in the order of registration."""

    def registerObjects(self, other_objs: Sequence[CollisionObject]) -> None:
        """Add several objects, even if they are registered already."""
        for obj in other_objs:
            self.registerObject(obj)

    def registerObject(self, obj: CollisionObject) -> None:
        """Add an object, even if it is registered already."""
        self._objects[self._insert(obj, None)] = obj

    def unregisterObject(self, obj: CollisionObject) -> None:
        """Remove an object, if it is registered."""
        for key in [key for key, own in self._objects.items() if own is obj]:
            self._remove(key)
            del self._objects[key]

    def setup(self) -> None:
        """Prepare for queries; see `update`."""
        self.update()

    def update(self, arg: object = None) -> None:
        """Read the geometries of all objects again, unless `arg` is given.

        This is needed only after a `BVHModel` of a registered object was built again. Moves of
        objects are noticed without it.
        """
        if arg is None:
            self._renew()

    def clear(self) -> None:
        """Remove all objects."""
        for key in self._objects:
            self._remove(key)
        self._objects.clear()

    def getObjects(self) -> list[CollisionObject]:
        """Return a list of the objects, in the order of registration."""
        return list(self._objects.values())

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
        other, cdata, callback = _read(args)
        others = self._objects_of(other)
        minimum = np.inf

        def visit(a: int, b: int) -> float:
            nonlocal minimum
            done, minimum = callback(self._objects[a], others[b], cdata, minimum)
            return -np.inf if done else max(minimum, 0.0)

        _impinge.manager_each_by_gap(self, other, visit)

    def collide(self, *args: Any) -> None:
        """Pass pairs with overlapping boxes to ``callback(o1, o2, cdata)`` until it returns True.

        ``collide(cdata, callback)`` passes pairs within the manager.
        ``collide(other, cdata, callback)`` passes pairs with an object or another manager. Boxes
        that touch overlap. Raise an `InputError` for other arguments.
        """
        other, cdata, callback = _read(args)
        others = self._objects_of(other)
        if callback is defaultCollisionCallback and _wants_one_contact(cdata):
            # Pairs that do not collide change nothing, so the extension skips them.
            found = _impinge.manager_any(self, other)
            if found is not None:
                callback(self._objects[found[0]], others[found[1]], cdata)
            return
        _impinge.manager_each_near(self, other, lambda a, b: callback(self._objects[a], others[b], cdata))

    def _objects_of(
        self, other: DynamicAABBTreeCollisionManager | CollisionObject | None
    ) -> dict[int, CollisionObject]:
        """Return the objects that the second key of a pair refers to."""
        if other is None:
            return self._objects
        return {0: other} if isinstance(other, CollisionObject) else other._objects

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how to make an equal manager."""
        return type(self), (), self.getObjects()

    def __setstate__(self, objects: list[CollisionObject]) -> None:
        """Register the objects."""
        self.registerObjects(objects)


def _read(args: tuple[Any, ...]) -> tuple[DynamicAABBTreeCollisionManager | CollisionObject | None, Any, Any]:
    """Return the other manager or object, None if there is none, the data and the callback."""
    if len(args) == 2:
        return None, *args
    if len(args) == 3 and isinstance(args[0], DynamicAABBTreeCollisionManager | CollisionObject):
        return args
    raise InputError(_EXPECTED, kind="type", what="args")


def _wants_one_contact(cdata: Any) -> bool:
    """Report whether `defaultCollisionCallback` stops at the first pair that collides."""
    return (
        isinstance(cdata, CollisionData)
        and not cdata.done
        and not cdata.result.contacts
        and cdata.request.num_max_contacts == 1
    )
