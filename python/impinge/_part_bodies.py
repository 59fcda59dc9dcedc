"""Characters in a world: one body for each part."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge._character import Character
from impinge._character_pose import CharacterPose
from impinge._errors import InputError
from impinge._handles import ALL_LAYERS, MAX_NUMBER, handles_of
from impinge._points import scalar
from impinge._scalars import whole
from impinge._world import Kind, World


@final
@dataclass(frozen=True, eq=False, repr=False)
class PartBodies:
    """The parts of one character as bodies of a `World`: inserted, moved and removed together.

    Make them with `insert`. Parts with a common owner do not collide with each other. The world
    reports pairs with parts by handles, like pairs of any other bodies; `part` converts handles to
    part indices.

    Attributes
    ----------
    character : Character
        The character.
    bodies : (p,) uint64 array
        Handles of the bodies, one for each part, in the order of `Character.parts`.

    Examples
    --------
    Find the parts of a boxer that a ball hits::

        world = impinge.World()
        boxer = impinge.PartBodies.insert(world, robot.at("Robot_Punch", 0.0), owner=1)
        ball = world.insert(impinge.Shape.sphere(0.3), impinge.pose([0, 3, 9]), tag=1000)

        world.step(*boxer.moves(robot.at("Robot_Punch", 0.1)))
        step = world.step(ball, impinge.pose([0, 3, 0]))
        struck = {robot.parts[part].name for part in boxer.part(step.began).ravel() if part >= 0}

    Move a crowd in one step, given lists of `PartBodies` and of `CharacterPose`::

        bodies, poses = zip(*(own.moves(pose) for own, pose in zip(crowd, crowd_poses)))
        world.step(np.concatenate(bodies), np.concatenate(poses))
    """

    character: Character
    bodies: NDArray[np.uint64]

    @classmethod
    def insert(
        cls,
        world: World,
        pose: CharacterPose,
        *,
        kind: Kind = "moving",
        layers: int = ALL_LAYERS,
        meets: int = ALL_LAYERS,
        owner: int | None = None,
        tag: int = 0,
    ) -> PartBodies:
        """Insert the parts of a character into a world: one body for each part, posed as in `pose`.

        Parameters
        ----------
        world : World
            The world; its next step reports the pairs of the parts.
        pose : CharacterPose
            A result of `Character.at`.
        kind, layers, meets
            As for `World.insert`.
        owner : int, optional
            A number that only this character uses, so that its parts do not collide with each
            other. Without it, overlapping parts collide.
        tag : int
            Tag of the first part; part ``i`` gets ``tag + i``.

        Raises
        ------
        InputError
            If an argument is invalid. Nothing is inserted then.
        """
        if not isinstance(world, World):
            raise InputError(f"must be a World, not {type(world).__name__}", kind="type", what="world")
        _check_pose(pose)
        character, places = pose.character, pose._core.body_poses()
        insert = partial(world.insert, kind=kind, layers=layers, meets=meets, owner=owner)
        inserted: list[Any] = []
        first = whole(tag, "tag", maximum=MAX_NUMBER + 1 - len(places))
        try:
            for part, (shape, place) in enumerate(zip(character._shapes(), places, strict=True)):
                inserted.append(insert(shape, place, tag=first + part))
        except BaseException:
            world.remove(inserted)
            raise
        bodies = np.array(inserted, np.uint64)
        bodies.setflags(write=False)
        return cls(character, bodies)

    def part(self, bodies: ArrayLike) -> Any:
        """Return the part of each body, as an index into `Character.parts`; -1 for other bodies.

        Parameters
        ----------
        bodies : int or (...) array_like of integers
            Handles of bodies, such as `Step.began`.

        Returns
        -------
        int or (...) int64 array
            Indices of the parts, in the shape of `bodies`.
        """
        handles, lead = handles_of(bodies)
        order = np.argsort(self.bodies)
        at = order[np.searchsorted(self.bodies, handles, sorter=order).clip(max=len(order) - 1)]
        return scalar(np.where(self.bodies[at] == handles, at, -1).reshape(lead))

    def moves(self, pose: CharacterPose) -> tuple[NDArray[np.uint64], NDArray[np.float64]]:
        """Return the arguments of `World.step` that move the bodies to a pose of the character.

        Parameters
        ----------
        pose : CharacterPose
            A pose of this character.

        Returns
        -------
        bodies : (p,) uint64 array
            Handles of the bodies.
        poses : (p, 4, 4) float64 array
            Poses of the bodies, world from body.

        Raises
        ------
        InputError
            If `pose` is not a `CharacterPose`, or is a pose of another character.
        """
        _check_pose(pose)
        if pose.character is not self.character:
            raise InputError("is a pose of another character", kind="type", what="pose")
        return self.bodies, pose._core.body_poses()

    def remove(self, world: World) -> None:
        """Remove the bodies from the world that they were inserted into.

        Raises
        ------
        InputError
            If one of the bodies was removed before. Nothing is removed then.
        """
        world.remove(self.bodies)

    def __repr__(self) -> str:
        """Return the number of bodies and the character."""
        return f"PartBodies({len(self.bodies)} bodies of {self.character!r})"


def _check_pose(pose: object) -> None:
    if not isinstance(pose, CharacterPose):
        message = f"must be a CharacterPose, the result of Character.at(), not {type(pose).__name__}"
        raise InputError(message, kind="type", what="pose")
