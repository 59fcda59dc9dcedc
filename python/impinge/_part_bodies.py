"""Characters in a world of bodies: a body for each part."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge._character import Character
from impinge._character_pose import CharacterPose
from impinge._errors import InputError
from impinge._handles import ALL_LAYERS, MOST_NUMBER, handles_of
from impinge._points import scalar
from impinge._scalars import whole
from impinge._world import Kind, World


@final
@dataclass(frozen=True, eq=False, repr=False)
class PartBodies:
    """The parts of one character as bodies of a `World`: put in, moved and taken out together.

    `insert` makes them. Their owner keeps them from meeting each other. The world finds and tells pairs of parts as
    those of any other bodies, by their handles; `part` says which part a handle is.

    Attributes
    ----------
    character : Character
        Whose parts they are.
    bodies : (p,) uint64 array
        The handles, part by part.

    Examples
    --------
    Which parts of a boxer a ball strikes::

        world = impinge.World()
        boxer = impinge.PartBodies.insert(world, robot.at("Robot_Punch", 0.0), owner=1)
        ball = world.insert(impinge.Shape.sphere(0.3), impinge.pose([0, 3, 9]), tag=1000)

        world.step(*boxer.moves(robot.at("Robot_Punch", 0.1)))
        step = world.step(ball, impinge.pose([0, 3, 0]))
        struck = {robot.parts[part].name for part in boxer.part(step.began).ravel() if part >= 0}

    One step moves a crowd, given lists of `PartBodies` and of `CharacterPose`::

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
        """Put a body into a world for each part of a character, where its pose has it.

        Parameters
        ----------
        world : World
            Whose next step tells what they meet.
        pose : CharacterPose
            What `Character.at` returned.
        kind, layers, meets
            As for `World.insert`.
        owner : int, optional
            A number of the character's own. Without one, parts that overlap meet each other.
        tag : int
            Of the first part; tags count on from it, part by part.

        Raises
        ------
        InputError
            If an argument is none of the above; nothing was inserted then.
        """
        if not isinstance(world, World):
            raise InputError(f"must be a World, not {type(world).__name__}", kind="type", what="world")
        _known(pose)
        character, places = pose.character, pose._core.body_poses()
        insert = partial(world.insert, kind=kind, layers=layers, meets=meets, owner=owner)
        inserted: list[Any] = []
        first = whole(tag, "tag", most=MOST_NUMBER + 1 - len(places))
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
        """Return the part that each body of the world is, as an index into `Character.parts`; -1 where it is none.

        Parameters
        ----------
        bodies : int or (...) array_like of integers
            Handles: pairs that began, for example.

        Returns
        -------
        int or (...) int64 array
            The parts.
        """
        handles, lead = handles_of(bodies)
        order = np.argsort(self.bodies)
        at = order[np.searchsorted(self.bodies, handles, sorter=order).clip(max=len(order) - 1)]
        return scalar(np.where(self.bodies[at] == handles, at, -1).reshape(lead))

    def moves(self, pose: CharacterPose) -> tuple[NDArray[np.uint64], NDArray[np.float64]]:
        """Return the handles and where they are to go as the character takes a pose: the arguments of `World.step`.

        Parameters
        ----------
        pose : CharacterPose
            Of this character.

        Returns
        -------
        bodies : (p,) uint64 array
            The handles.
        poses : (p, 4, 4) float64 array
            World from body.

        Raises
        ------
        InputError
            If it is a pose of another character.
        """
        _known(pose)
        if pose.character is not self.character:
            raise InputError("is a pose of another character", kind="type", what="pose")
        return self.bodies, pose._core.body_poses()

    def remove(self, world: World) -> None:
        """Take the bodies out of their world.

        Raises
        ------
        InputError
            If one of them is gone already; none was taken out then.
        """
        world.remove(self.bodies)

    def __repr__(self) -> str:
        """Return the number of bodies and the character."""
        return f"PartBodies({len(self.bodies)} bodies of {self.character!r})"


def _known(pose: object) -> None:
    if not isinstance(pose, CharacterPose):
        message = f"must be what Character.at() returned, not {type(pose).__name__}"
        raise InputError(message, kind="type", what="pose")
