"""Rigged characters: hit volumes fitted to their parts, and the part that was struck."""

from __future__ import annotations

import os
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._arrays import plain_points
from impinge._character_pose import CharacterPose
from impinge._errors import InputError
from impinge._scalars import MOST, chosen, path_of, real, whole
from impinge._shape import Shape


@dataclass(frozen=True)
class Animation:
    """A motion of a character.

    Attributes
    ----------
    name : str
        As in the file; may be empty.
    start, end : float
        The times of its first and last keys, in seconds; before and after it stands still.
    """

    name: str
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a character with its volume: all within `radius` of the convex hull of `points`.

    Attributes
    ----------
    name : str
        After its bones, or after its place where these have no names.
    bones : tuple of str
        The bones whose faces it has.
    bone : int
        The number of the bone that the volume is fixed to.
    kind : {"sphere", "capsule", "box", "lozenge", "hull"}
        What the volume is: of one point, of two, of the eight corners of a box, of the four of a rectangle, or of more.
    looseness : float
        The area of the volume in areas of a convex hull about what it was fitted to: 1 is as tight as convex volumes
        are.
    points : (k, 3) float64 array
        In the frame of the bone (`CharacterPose.frames`).
    radius : float
        In the unit of the file, at least zero.
    """

    name: str
    bones: tuple[str, ...]
    bone: int
    kind: Literal["sphere", "capsule", "box", "lozenge", "hull"]
    looseness: float
    points: NDArray[np.float64]
    radius: float

    def __repr__(self) -> str:
        """Return name, kind and looseness."""
        return f"Part({self.name!r}, {self.kind}, looseness={self.looseness:.2f})"


@dataclass(frozen=True, eq=False)
class Leaks:
    """What of each part's surface is outside of all volumes, over some hundred poses of all animations.

    Attributes
    ----------
    share : (p,) float64 array
        The share of the part's vertices.
    farthest : (p,) float64 array
        How far the farthest is outside, in the unit of the file.
    """

    share: NDArray[np.float64]
    farthest: NDArray[np.float64]


@final
class Character:
    """The hit volumes of a rigged character: a sphere for the head, pills for the limbs, a box for the torso.

    Parameters
    ----------
    path : str or os.PathLike
        A rigged glTF or GLB file.
    volumes : int
        At most so many parts, at least one.
    mode : {"conservative", "snug"}
        Whether no point of the skinned surface is outside at rest and at any time of any animation of the file, or the
        outermost twentieth of a part's vertices may stick out, so that strikes hit what looks hit.
    plan : str or os.PathLike, optional
        A file, as `save` writes it and as people edit it, that says which bones make a part, its name and its kind;
        what it leaves out is chosen. In place of `volumes`.
    pieces : int, optional
        Rays that enter a volume go on to hulls about at most so many faces each, so that what they strike is what they
        would strike on the surface far more often.

    Raises
    ------
    OSError
        If a file cannot be read.
    InputError
        If its content is broken, or no rig: it names the node or the accessor.

    Notes
    -----
    A character never changes, so a copy (`copy.copy`, `copy.deepcopy`) is itself. It pickles by the path of its file
    and the text that `save` writes: where it is loaded the file has to be there, and to hold the same character, which
    is checked; nothing is fitted again.

    Examples
    --------
    What a ray strikes half a second into a walk::

        robot = impinge.Character("robot.glb")
        walking = robot.at("Robot_Walking", 0.5)
        hit = walking.ray_cast([0, 4, 9], [0, 0, -1])
        robot.parts[hit.part].name if hit.hit else None    # "head"
    """

    __slots__ = ("_animations", "_core", "_parts", "_path", "_pieces")

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        volumes: int = 6,
        mode: Literal["conservative", "snug"] = "conservative",
        plan: str | os.PathLike[str] | None = None,
        pieces: int | None = None,
    ) -> None:
        self._open(path, (whole(volumes, "volumes", least=1), mode, plan, None, pieces))

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], fitted: str | os.PathLike[str], *, pieces: int | None = None
    ) -> Character:
        """Return a character with the volumes that `save` wrote, to the last bit, without fitting anything.

        Parameters
        ----------
        path : str or os.PathLike
            The rigged file.
        fitted : str or os.PathLike
            What `save` wrote, perhaps edited.
        pieces : int, optional
            As for `Character`.

        Raises
        ------
        OSError
            If a file cannot be read.
        InputError
            If its content is broken, or names what the rig has not.
        """
        character = cls.__new__(cls)
        character._open(path, (1, "conservative", None, fitted, pieces))
        return character

    def _open(self, path: str | os.PathLike[str], options: tuple[Any, ...]) -> None:
        volumes, mode, plan, fitted, pieces = options
        chosen(mode, ("conservative", "snug"), "mode")
        path, pieces = path_of(path, "path"), None if pieces is None else whole(pieces, "pieces", least=1)
        plan = None if plan is None else path_of(plan, "plan")
        fitted = None if fitted is None else path_of(fitted, "fitted")
        self._take(_impinge.CharacterCore(path, volumes, mode, plan, fitted, pieces), path, pieces)

    def _take(self, core: _impinge.CharacterCore, path: str, pieces: int | None) -> None:
        self._core, self._path, self._pieces = core, path, pieces
        self._animations = tuple(Animation(*animation) for animation in self._core.animations())
        bones = self._core.bones()
        self._parts = tuple(
            Part(name, tuple(bones[at] for at in own), bone, kind, looseness, np.array(points), radius)
            for name, own, bone, kind, looseness, points, radius in self._core.parts()
        )

    @property
    def parts(self) -> tuple[Part, ...]:
        """The parts, in the order of their first bones."""
        return self._parts

    @property
    def animations(self) -> tuple[Animation, ...]:
        """The animations of the file."""
        return self._animations

    @property
    def bones(self) -> tuple[str, ...]:
        """The names of the bones."""
        return tuple(self._core.bones())

    @property
    def faces(self) -> NDArray[np.uint32]:
        """(m, 3) faces of the skin, of `CharacterPose.vertices`."""
        return self._core.faces()[0]

    @property
    def part_of(self) -> NDArray[np.uint32]:
        """(m,) the part of each face."""
        return self._core.faces()[1]

    def leaks(self) -> Leaks:
        """Return what of each part's surface is outside of all volumes; nothing for conservative ones."""
        share, farthest = self._core.leaks()
        return Leaks(np.array(share), np.array(farthest))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the parts and their volumes to a text file, to be loaded or edited.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        Path(path_of(path, "path")).write_text(self._core.text(), encoding="utf-8")

    def at(
        self, animation: str | int | None = None, time: float = 0.0, *, origin: ArrayLike = (0, 0, 0)
    ) -> CharacterPose:
        """Return the character at a time of an animation.

        Parameters
        ----------
        animation : str or int, optional
            Its name or its number; at rest without.
        time : float
            In seconds; at the nearer end where it is outside of the animation.
        origin : (3,) array_like of float32 or float64
            Where in the world the origin of the file is.

        Returns
        -------
        CharacterPose
            It answers what is struck.

        Raises
        ------
        InputError
            If there is no such animation, or a number is not finite.
        """
        at = None if animation is None else self._number(animation)
        place = plain_points(origin, "origin")
        if place.shape != (3,) or not (np.abs(place) < 2.0**128).all():
            raise InputError("a point of the world is expected, (3,), below 2^128", kind="shape", what="origin")
        seconds = real(time, "time")
        if np.isinf(seconds):
            raise InputError(f"{seconds} is not finite", kind="non-finite", what="time")
        asked = at, seconds, place.tolist()
        return CharacterPose(self, self._core.pose(*asked), asked)

    def _shapes(self) -> list[Shape]:
        """Return the parts as shapes of bodies, which stand where `PosedCore.body_poses` says."""
        rows = self._core.shapes()
        for _, points, _ in rows:
            points.setflags(write=False)
        return [Shape._of(kind, points if len(points) else None, numbers) for kind, points, numbers in rows]

    def _fingerprint(self) -> int:
        """Return a checksum of what the file holds: skin, bones, and where they are at rest and in each animation."""
        posed = [self.at()] + [self.at(at, (one.start + one.end) / 2) for at, one in enumerate(self._animations)]
        parts = [repr((self.bones, self._animations)).encode(), self.faces.tobytes(), posed[0].vertices.tobytes()]
        return zlib.crc32(b"".join(parts + [pose.frames.tobytes() for pose in posed]))

    def __copy__(self) -> Character:
        """Return the character, which never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Character:
        """Return the character, which never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the path of the file, and the volumes."""
        return _reopened, (self._path, self._core.text(), self._pieces, self._fingerprint())

    def _number(self, animation: str | int) -> int:
        names = [known.name for known in self._animations]
        if not isinstance(animation, str):
            animation = whole(animation, "animation", least=-MOST)
            if 0 <= animation < len(names):
                return animation
        elif animation in names:
            return names.index(animation)
        message = f"there is no animation {animation!r}; there are {', '.join(map(repr, names)) or 'none'}"
        raise InputError(message, kind="name", what="animation")

    def __repr__(self) -> str:
        """Return the file and the numbers of parts and animations."""
        return f"Character({self._path!r}, {len(self._parts)} parts, {len(self._animations)} animations)"


def _reopened(path: str, text: str, pieces: int | None, fingerprint: int) -> Character:
    """Return the character that was pickled."""
    character = Character.__new__(Character)
    character._take(_impinge.CharacterCore.reopened(path, text, pieces), path, pieces)
    if character._fingerprint() != fingerprint:
        message = "the file does not hold the character that was pickled"
        raise InputError(message, kind="changed", what=path, hint="pickle it anew, from the file as it is now")
    return character
