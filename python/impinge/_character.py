"""Rigged characters: hit volumes that are fitted to their parts."""

from __future__ import annotations

import os
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._arrays import plain_points
from impinge._character_pose import CharacterPose
from impinge._errors import InputError
from impinge._scalars import MAX_COUNT, chosen, path_of, real, whole
from impinge._shape import Shape

_Limited: TypeAlias = tuple[str, int | None, int | None]
"""The path of a file, its `max_bytes` and its `max_triangles`."""


@dataclass(frozen=True)
class Animation:
    """An animation of a character.

    Attributes
    ----------
    name : str
        Name in the file; may be empty.
    start, end : float
        Times of the first and the last key, in seconds. The character does not move before and
        after.
    """

    name: str
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a character with its volume: all points within `radius` of the hull of `points`.

    Attributes
    ----------
    name : str
        Name of the part, from the names of its bones, or from its index if they have none.
    bones : tuple of str
        Names of the bones whose faces belong to the part.
    bone : int
        Bone that the volume is fixed to, as an index into `Character.bones`.
    kind : {"sphere", "capsule", "box", "lozenge", "hull"}
        Kind of volume, by its `points`: one point, two points, the eight corners of a box, the four
        corners of a rectangle, or more points.
    looseness : float
        Surface area of the volume, divided by that of the convex hull of the points it was fitted
        to. 1 is the minimum for convex volumes.
    points : (k, 3) float64 array
        Points whose hull, enlarged by `radius`, is the volume. They are in the frame of the bone
        (see `CharacterPose.frames`) and in the unit of the file.
    radius : float
        Distance from the hull of `points` to the surface of the volume, in the unit of the file; at
        least zero.
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
    """How much of each part's surface is outside of all volumes, in about 100 poses.

    The poses are taken from all animations; nothing is proved about other poses. The arrays have
    an entry for each part in `Character.parts`.

    Attributes
    ----------
    share : (p,) float64 array
        Share of the part's vertices that are outside, from 0 to 1, averaged over the poses.
    farthest : (p,) float64 array
        Maximum distance of a vertex from the volumes, in the unit of the file, rounded; 0 if no
        vertex is outside.
    """

    share: NDArray[np.float64]
    farthest: NDArray[np.float64]


@final
class Character:
    """Hit volumes of a rigged character, such as a sphere for the head and capsules for limbs.

    Parameters
    ----------
    path : str or os.PathLike
        A rigged glTF or GLB file.
    volumes : int
        Maximum number of parts, at least one.
    mode : {"conservative", "snug"}
        ``"conservative"`` volumes contain the whole skinned surface, at rest and at any time of any
        animation in the file. ``"snug"`` volumes may leave out the outermost 5 % of a part's
        vertices, so that hits look more accurate.
    plan : str or os.PathLike, optional
        A text file, as written by `save` and edited, with the bones, the name and the kind of each
        part. Missing entries are chosen automatically. Replaces `volumes`.
    pieces : int, optional
        Maximum number of faces in a group. If given, the faces of each part are split into groups,
        each with a hull. A ray that enters a volume must then also hit one of the part's hulls, so
        that hits agree with the surface far more often.
    max_bytes : int, optional
        Maximum number of bytes of the file, of the content that it unpacks to, of all files that it
        refers to, and of the plan, each. As for `load`.
    max_triangles : int, optional
        Maximum number of triangles, counted over all nodes. As for `load`.

    Raises
    ------
    OSError
        If a file cannot be read.
    InputError
        If the content is invalid or not a rig; the error names the node or the accessor. If a limit
        is exceeded, `InputError.kind` is ``"too-many"``.

    Notes
    -----
    A character is immutable, so a copy (`copy.copy`, `copy.deepcopy`) is the character itself. It
    pickles the path of its file and the text that `save` writes. Unpickling reads the file again
    and checks that it still contains the same character; nothing is fitted again.

    Examples
    --------
    Find the part that a ray hits, half a second into a walk::

        robot = impinge.Character("robot.glb")
        walking = robot.at("Robot_Walking", 0.5)
        hit = walking.ray_cast([0, 4, 9], [0, 0, -1])
        robot.parts[hit.part].name if hit.hit else None    # "head"
    """

    __slots__ = ("_animations", "_core", "_file", "_parts", "_pieces")

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        volumes: int = 6,
        mode: Literal["conservative", "snug"] = "conservative",
        plan: str | os.PathLike[str] | None = None,
        pieces: int | None = None,
        max_bytes: int | None = None,
        max_triangles: int | None = None,
    ) -> None:
        file = _limited(path, max_bytes, max_triangles)
        self._open(file, (whole(volumes, "volumes", minimum=1), mode, plan, None, pieces))

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        fitted: str | os.PathLike[str],
        *,
        pieces: int | None = None,
        max_bytes: int | None = None,
        max_triangles: int | None = None,
    ) -> Character:
        """Return a character with the volumes that `save` wrote, bitwise equal, without fitting.

        Parameters
        ----------
        path : str or os.PathLike
            The rigged file.
        fitted : str or os.PathLike
            A file that `save` wrote, perhaps edited.
        pieces, max_bytes, max_triangles : int, optional
            As for `Character`. `max_bytes` also limits `fitted`.

        Raises
        ------
        OSError
            If a file cannot be read.
        InputError
            If the content is invalid, or refers to bones that the rig does not have.
        """
        character = cls.__new__(cls)
        character._open(_limited(path, max_bytes, max_triangles), (1, "conservative", None, fitted, pieces))
        return character

    def _open(self, file: _Limited, options: tuple[Any, ...]) -> None:
        volumes, mode, plan, fitted, pieces = options
        chosen(mode, ("conservative", "snug"), "mode")
        pieces = None if pieces is None else whole(pieces, "pieces", minimum=1)
        plan = None if plan is None else path_of(plan, "plan")
        fitted = None if fitted is None else path_of(fitted, "fitted")
        self._take(_impinge.CharacterCore(file, volumes, mode, plan, fitted, pieces), file, pieces)

    def _take(self, core: _impinge.CharacterCore, file: _Limited, pieces: int | None) -> None:
        self._core, self._file, self._pieces = core, file, pieces
        self._animations = tuple(Animation(*animation) for animation in self._core.animations())
        bones = self._core.bones()
        self._parts = tuple(
            Part(name, tuple(bones[at] for at in own), bone, kind, looseness, np.array(points), radius)
            for name, own, bone, kind, looseness, points, radius in self._core.parts()
        )

    @property
    def parts(self) -> tuple[Part, ...]:
        """Parts of the character, each with its volume, in the order of their first bones."""
        return self._parts

    @property
    def animations(self) -> tuple[Animation, ...]:
        """Animations in the file, in the order of the file."""
        return self._animations

    @property
    def bones(self) -> tuple[str, ...]:
        """Names of the bones, by index."""
        return tuple(self._core.bones())

    @property
    def faces(self) -> NDArray[np.uint32]:
        """Faces of the skin, (m, 3): three indices into `CharacterPose.vertices` each."""
        return self._core.faces()[0]

    @property
    def part_of(self) -> NDArray[np.uint32]:
        """Part that each face belongs to, (m,), as an index into `parts`."""
        return self._core.faces()[1]

    def leaks(self) -> Leaks:
        """Measure how much of each part's surface is outside of all volumes, in about 100 poses.

        All results are 0 if the volumes are conservative.
        """
        share, farthest = self._core.leaks()
        return Leaks(np.array(share), np.array(farthest))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the parts and their volumes to a text file, which can be edited and loaded.

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
            Name or index of the animation. Without it, the character is at rest.
        time : float
            In seconds. A time outside of the animation gives the pose at the nearer end.
        origin : (3,) array_like of float32 or float64
            Position of the file's origin in the world, in the unit of the file.

        Returns
        -------
        CharacterPose
            The pose, which finds hits on the character.

        Raises
        ------
        InputError
            If there is no such animation, or if a number is not finite.
        """
        at = None if animation is None else self._number(animation)
        place = plain_points(origin, "origin")
        if place.shape != (3,) or not (np.abs(place) < 2.0**128).all():
            message = "must be a finite (3,) point of the world, below 2^128 in magnitude"
            raise InputError(message, kind="shape", what="origin")
        seconds = real(time, "time")
        if np.isinf(seconds):
            raise InputError(f"{seconds} is not finite", kind="non-finite", what="time")
        arguments = at, seconds, place.tolist()
        return CharacterPose(self, self._core.pose(*arguments), arguments)

    def _shapes(self) -> list[Shape]:
        """Return the parts as shapes of bodies; `PosedCore.body_poses` returns their poses."""
        rows = self._core.shapes()
        for _, points, _ in rows:
            points.setflags(write=False)
        return [Shape._of(kind, points if len(points) else None, numbers) for kind, points, numbers in rows]

    def _fingerprint(self) -> int:
        """Return a checksum of the skin, the bones, and the poses at rest and in each animation."""
        posed = [self.at()] + [self.at(at, (one.start + one.end) / 2) for at, one in enumerate(self._animations)]
        parts = [repr((self.bones, self._animations)).encode(), self.faces.tobytes(), posed[0].vertices.tobytes()]
        return zlib.crc32(b"".join(parts + [pose.frames.tobytes() for pose in posed]))

    def __copy__(self) -> Character:
        """Return the character itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Character:
        """Return the character itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the path of the file, and the volumes."""
        return _reopened, (self._file, self._core.text(), self._pieces, self._fingerprint())

    def _number(self, animation: str | int) -> int:
        names = [known.name for known in self._animations]
        if not isinstance(animation, str):
            animation = whole(animation, "animation", minimum=-MAX_COUNT)
            if 0 <= animation < len(names):
                return animation
        elif animation in names:
            return names.index(animation)
        message = f"there is no animation {animation!r}; there are {', '.join(map(repr, names)) or 'none'}"
        raise InputError(message, kind="name", what="animation")

    def __repr__(self) -> str:
        """Return the file and the numbers of parts and animations."""
        return f"Character({self._file[0]!r}, {len(self._parts)} parts, {len(self._animations)} animations)"


def _limited(path: str | os.PathLike[str], max_bytes: int | None, max_triangles: int | None) -> _Limited:
    """Return the path of a file with its valid limits."""
    limits = (("max_bytes", max_bytes), ("max_triangles", max_triangles))
    bytes_, triangles = (None if limit is None else whole(limit, name) for name, limit in limits)
    return path_of(path, "path"), bytes_, triangles


def _reopened(file: _Limited, text: str, pieces: int | None, fingerprint: int) -> Character:
    """Return the character that was pickled."""
    character = Character.__new__(Character)
    character._take(_impinge.CharacterCore.reopened(file, text, pieces), file, pieces)
    if character._fingerprint() != fingerprint:
        message = "the file has changed since the character was pickled"
        raise InputError(message, kind="changed", what=file[0], hint="load the file and pickle the character again")
    return character
