"""A character in one pose: which of its parts rays, punches, shapes, meshes and other characters strike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._errors import InputError
from impinge._mesh import Mesh
from impinge._points import scalar
from impinge._ragged import Ragged
from impinge._shape import AnyShape, Shape

if TYPE_CHECKING:
    from impinge._character import Character


@dataclass(frozen=True, eq=False)
class PartHit:
    """Parts that were struck; numbers where a single ray was cast.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether a part was struck.
    part : int or (...) int64 array
        Which, as an index into `Character.parts`; -1 where none was.
    bone : int or (...) int64 array
        The number of the bone that its volume is fixed to; -1 where none was.
    t : float or (...) float64 array
        When: for a ray in units of the direction's length, for a punch from 0 to 1 and never later than the true first
        contact, for all else zero; infinite where nothing was struck.
    point : (..., 3) float64 array
        Where, in the world frame, rounded.
    normal : (..., 3) float64 array
        Of length 1, in the world frame: out of the part for a ray, from what struck it into the part for all else.
    depth : float or (...) float64 array
        How much of the ray is inside, or how deep the two are in each other, in world units.
    """

    hit: bool | NDArray[np.bool_]
    part: int | NDArray[np.int64]
    bone: int | NDArray[np.int64]
    t: float | NDArray[np.float64]
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    depth: float | NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SurfaceHit:
    """Where rays meet the skinned surface; numbers where a single ray was cast.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether the surface is met.
    part : int or (...) int64 array
        The part of the face, as an index into `Character.parts`; -1 where none is met.
    bone : int or (...) int64 array
        The number of the bone that the face's corners follow most; -1 where none is met.
    face : int or (...) int64 array
        The face, as an index into `Character.faces`; of several in one point the first, -1 where none is met.
    t : float or (...) float64 array
        In units of the direction's length, within 2^-40 of itself of the true one; infinite where nothing is met.
    point : (..., 3) float64 array
        Where, in the world frame, rounded.
    """

    hit: bool | NDArray[np.bool_]
    part: int | NDArray[np.int64]
    bone: int | NDArray[np.int64]
    face: int | NDArray[np.int64]
    t: float | NDArray[np.float64]
    point: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class PartHits(Ragged[PartHit]):
    """All parts that each of many rays strikes, one ray's hits after another's.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        The hits of ray ``i``, in row-major order of the leading axes, are those from ``offsets[i]`` to
        ``offsets[i + 1]``; for each ray in the order in which it enters the volumes.
    all : PartHit
        Those of all rays.
    shape : tuple of int
        The leading axes of the rays; their product is ``n``.
    """

    offsets: NDArray[np.int64]
    all: PartHit
    shape: tuple[int, ...]

    def _row(self, entries: slice) -> PartHit:
        return _part_hits(getattr(self.all, name)[entries] for name in _COLUMNS)

    def _rows(self, entries: slice, offsets: NDArray[np.int64], shape: tuple[int, ...]) -> PartHits:
        return PartHits(offsets, self._row(entries), shape)

    def __repr__(self) -> str:
        """Return the shape and the number of hits."""
        return f"PartHits(shape={self.shape}, {self.offsets[-1] - self.offsets[0]} hits)"


@dataclass(frozen=True, eq=False)
class PartPairs:
    """Parts of two characters that meet.

    Attributes
    ----------
    part_a, part_b : (k,) int64 array
        The parts of either character, as indices into `Character.parts`; sorted.
    point : (k, 3) float64 array
        Where, in the world frame, rounded.
    normal : (k, 3) float64 array
        Of length 1, from the first to the second, in the world frame.
    depth : (k,) float64 array
        How deep they are in each other, in world units.
    """

    part_a: NDArray[np.int64]
    part_b: NDArray[np.int64]
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    depth: NDArray[np.float64]


_COLUMNS = ("part", "bone", "t", "point", "normal", "depth")

_PUNCHES = ("sphere", "capsule", "box", "triangle", "hull")
"""The kinds of shapes that may strike on the way."""


@final
class CharacterPose:
    """A character at a time of an animation: what `Character.at` returns."""

    __slots__ = ("_asked", "_character", "_core")

    def __init__(
        self, character: Character, core: _impinge.PosedCore, asked: tuple[int | None, float, list[float]]
    ) -> None:
        self._character, self._core, self._asked = character, core, asked

    @property
    def character(self) -> Character:
        """The character."""
        return self._character

    @property
    def frames(self) -> NDArray[np.float64]:
        """(p, 4, 4) world from the frame of each part's volume, rigid."""
        return self._core.frames()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) lower and upper corner of a box in the world that holds all volumes."""
        return np.array(self._core.bounds())

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(n, 3) vertices of the skinned surface, in the world; computed anew each time."""
        return self._core.vertices()

    def mesh(self) -> Mesh:
        """Return the skinned surface as a mesh in the world, for questions to the surface itself.

        For many poses make one, and `Mesh.refit` it to the `vertices` of the next.
        """
        return Mesh(self.vertices, self._character.faces)

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> PartHit:
        """Return the part whose volume each ray enters first. No volume that a ray meets is missed.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            In the world frame, below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            Of any length below 2^300 but zero. The leading axes of both broadcast as in NumPy.

        Returns
        -------
        PartHit
            Its fields have the leading axes.

        Raises
        ------
        InputError
            If a number is not in range or a direction is zero; it says which.
        """
        hit, columns = self._core.ray_cast(origins, directions)
        part, bone, t, point, normal, depth = columns
        return PartHit(scalar(hit), scalar(part), scalar(bone), scalar(t), point, normal, scalar(depth))

    def surface_ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> SurfaceHit:
        """Return the part whose skin each ray truly meets first: what `mesh` says, without skinning all of it.

        Nothing is skinned but the faces that a ray comes near, so that a few rays cost some microseconds. Where
        surfaces are soft, this is what tells parts apart: volumes reach over their neighbours there.

        Parameters
        ----------
        origins, directions : (..., 3) array_like of float32 or float64
            As for `ray_cast`.

        Returns
        -------
        SurfaceHit
            Its fields have the leading axes. Whether faces are met, and which first, is decided exactly.

        Raises
        ------
        InputError
            As for `ray_cast`.

        Examples
        --------
        The part that a bullet truly struck, and the face of the file::

            walking = robot.at("Robot_Walking", 0.5)
            hit = walking.surface_ray_cast([0, 4, 9], [0, 0, -1])
            robot.parts[hit.part].name, hit.face
        """
        hit, part, bone, face, t, point = self._core.surface_ray_cast(origins, directions)
        return SurfaceHit(scalar(hit), scalar(part), scalar(bone), scalar(face), scalar(t), point)

    def ray_cast_all(self, origins: ArrayLike, directions: ArrayLike) -> PartHit | PartHits:
        """Return all parts whose volumes each ray meets, in the order in which it enters them.

        Parameters
        ----------
        origins, directions : (..., 3) array_like of float32 or float64
            As for `ray_cast`.

        Returns
        -------
        PartHit or PartHits
            For a single ray a `PartHit` with as many entries as there are hits.

        Raises
        ------
        InputError
            As for `ray_cast`.
        """
        offsets, columns, shape = self._core.ray_cast_all(origins, directions)
        hits = _part_hits(columns)
        return PartHits(offsets, hits, tuple(shape)) if shape else hits

    def struck_by(self, shape: AnyShape, pose: ArrayLike | None = None) -> PartHit:
        """Return all parts that a shape meets, or that the surface of a mesh comes into; in their order.

        Parameters
        ----------
        shape : Shape or Mesh
            What strikes.
        pose : (4, 4) array_like of float32 or float64, optional
            World from shape.

        Returns
        -------
        PartHit
            With as many entries as there are parts struck.

        Raises
        ------
        InputError
            If an argument is none of the above.
        """
        return _part_hits(self._core.struck_by(shape, pose))

    def struck_by_character(self, other: CharacterPose) -> PartPairs:
        """Return all pairs of parts, of this character and of another, that meet.

        Parameters
        ----------
        other : CharacterPose
            Of the same character or of another.

        Raises
        ------
        InputError
            If it is something else.
        """
        _known(other, "other")
        return PartPairs(*self._core.struck_by_character(other._core))

    def strikes(self, to: CharacterPose, shape: Shape, pose_t0: ArrayLike | None, pose_t1: ArrayLike | None) -> PartHit:
        """Return all parts that a shape strikes while it moves and the character goes on to another pose.

        A punch between two frames, however fast: nothing is passed through. Frames and shape move evenly along lines
        and turn evenly by the least angle.

        Parameters
        ----------
        to : CharacterPose
            The character at the end of the time.
        shape : Shape
            A sphere, capsule, box, triangle or hull.
        pose_t0, pose_t1 : (4, 4) array_like of float32 or float64, or None
            World from shape at both ends, rigid within 1e-4.

        Returns
        -------
        PartHit
            With an entry for each part struck, by `t`, then in the order of the parts.

        Raises
        ------
        InputError
            If an argument is none of the above.

        Examples
        --------
        A fist that is through within one frame::

            fist = impinge.Shape.sphere(0.1)
            before, after = robot.at("Robot_Idle", 0.30), robot.at("Robot_Idle", 0.35)
            before.strikes(after, fist, impinge.pose([0, 2, 9]), impinge.pose([0, 2, -9]))
        """
        _known(to, "to")
        if not isinstance(shape, Shape) or shape.kind not in _PUNCHES:
            kind = shape.kind if isinstance(shape, Shape) else type(shape).__name__
            message = f"must be a Shape that is a {', '.join(_PUNCHES[:-1])} or {_PUNCHES[-1]}, not {kind}"
            raise InputError(message, kind="type", what="shape")
        return _part_hits(self._core.strikes(to._core, _swept(shape), pose_t0, pose_t1))

    def __repr__(self) -> str:
        """Return the character."""
        return f"CharacterPose({self._character!r})"

    def __copy__(self) -> CharacterPose:
        """Return the pose, which never changes."""
        return self

    def __deepcopy__(self, memo: object) -> CharacterPose:
        """Return the pose, which never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the character, and when and where it is; poses that are pickled together share it."""
        return _posed_again, (self._character, *self._asked)


def _posed_again(character: Character, animation: int | None, time: float, origin: list[float]) -> CharacterPose:
    return character.at(animation, time, origin=origin)


def _swept(shape: Shape) -> tuple[str, NDArray[np.float64], float]:
    """Return kind, points and radius: the shape is all within the radius of the points' hull."""
    kind, source, numbers = shape._made_of
    if kind == "box":
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        return kind, signs * np.array(numbers), 0.0
    return kind, source, numbers[0] if numbers else 0.0


def _part_hits(columns: Any) -> PartHit:
    part, bone, t, point, normal, depth = columns
    return PartHit(np.ones(len(part), bool), part, bone, t, point, normal, depth)


def _known(pose: object, name: str) -> None:
    if not isinstance(pose, CharacterPose):
        message = f"must be what Character.at() returned, not {type(pose).__name__}"
        raise InputError(message, kind="type", what=name)
