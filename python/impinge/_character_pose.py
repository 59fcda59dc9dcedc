"""A character in one pose: the parts that rays, punches, shapes and other characters hit."""

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
    """Hits on the parts of a character; plain numbers for `ray_cast` with a single ray.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether a part was hit.
    part : int or (...) int64 array
        Part that was hit, as an index into `Character.parts`; -1 if there was no hit.
    bone : int or (...) int64 array
        Bone that the part's volume is fixed to, as an index into `Character.bones`; -1 if there was
        no hit.
    t : float or (...) float64 array
        For a ray, its parameter at the hit, in units of the direction's length; zero if the ray
        starts inside. For `strikes`, a time from 0 to 1, never later than the true first contact.
        For `struck_by`, zero. Infinite if there was no hit.
    point : (..., 3) float64 array
        Point of the hit in the world frame, rounded; zero if there was no hit.
    normal : (..., 3) float64 array
        Unit vector in the world frame: out of the part for a ray, otherwise from the striking shape
        into the part. Zero if there was no hit.
    depth : float or (...) float64 array
        In world units: for a ray, its length inside the volume, rounded; for a shape, an upper
        bound of the penetration depth; for a mesh, that depth, rounded. Zero if there was no hit.
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
    """Hits of rays on the skinned surface; plain numbers for a single ray.

    Attributes
    ----------
    hit : bool or (...) bool array
        Whether the ray hits the surface.
    part : int or (...) int64 array
        Part of the face, as an index into `Character.parts`; -1 if the ray misses.
    bone : int or (...) int64 array
        Bone with the greatest skinning weight on the face's corners, as an index into
        `Character.bones`; -1 if the ray misses.
    face : int or (...) int64 array
        Face, as an index into `Character.faces`, the first if several are hit in one point; -1 if
        the ray misses.
    t : float or (...) float64 array
        Ray parameter of the hit, in units of the direction's length, with a relative error of at
        most 2^-40; infinite if the ray misses.
    point : (..., 3) float64 array
        Point of the hit in the world frame, rounded; zero if the ray misses.
    """

    hit: bool | NDArray[np.bool_]
    part: int | NDArray[np.int64]
    bone: int | NDArray[np.int64]
    face: int | NDArray[np.int64]
    t: float | NDArray[np.float64]
    point: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class PartHits(Ragged[PartHit]):
    """All parts that each of many rays hits, concatenated ray by ray.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
        Start of each ray's hits: the hits of ray ``i``, in row-major order of the leading axes, go
        from ``offsets[i]`` to ``offsets[i + 1]``. They are in the order in which the ray enters the
        volumes.
    all : PartHit
        The hits of all rays.
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
    """Pairs of intersecting parts of two characters.

    Attributes
    ----------
    part_a, part_b : (k,) int64 array
        Part of the first and of the second character, as indices into `Character.parts`. Pairs are
        sorted by `part_a`, then by `part_b`.
    point : (k, 3) float64 array
        Point of contact in the world frame, rounded.
    normal : (k, 3) float64 array
        Unit vector from the first part to the second, in the world frame.
    depth : (k,) float64 array
        Upper bound of the penetration depth, in world units.
    """

    part_a: NDArray[np.int64]
    part_b: NDArray[np.int64]
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    depth: NDArray[np.float64]


_COLUMNS = ("part", "bone", "t", "point", "normal", "depth")

_STRIKING_KINDS = ("sphere", "capsule", "box", "triangle", "hull")
"""Kinds of shapes that `CharacterPose.strikes` accepts."""


@final
class CharacterPose:
    """A character at one time of an animation, as returned by `Character.at`."""

    __slots__ = ("_arguments", "_character", "_core")

    def __init__(
        self, character: Character, core: _impinge.PosedCore, arguments: tuple[int | None, float, list[float]]
    ) -> None:
        self._character, self._core, self._arguments = character, core, arguments

    @property
    def character(self) -> Character:
        """The character that is in this pose."""
        return self._character

    @property
    def frames(self) -> NDArray[np.float64]:
        """Rigid poses (p, 4, 4), rounded: world from the bone that a part's volume is fixed to."""
        return self._core.frames()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lower and upper corners (2, 3) of a world-frame box that contains all volumes."""
        return np.array(self._core.bounds())

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Vertices (n, 3) of the skinned surface in the world frame, rounded.

        They are computed at each access.
        """
        return self._core.vertices()

    def mesh(self) -> Mesh:
        """Return the skinned surface as a mesh in the world frame, for queries on the surface.

        For many poses, make one mesh and `Mesh.refit` it to the `vertices` of each pose.
        """
        return Mesh(self.vertices, self._character.faces)

    def ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> PartHit:
        """Return the part whose volume each ray enters first; no volume on its way is missed.

        If a ray enters several at the same parameter, the part with the lowest index is returned.

        Parameters
        ----------
        origins : (..., 3) array_like of float32 or float64
            In the world frame, below 2^300 in magnitude.
        directions : (..., 3) array_like of float32 or float64
            In the world frame, with any nonzero length below 2^300. Leading axes broadcast.

        Returns
        -------
        PartHit
            The fields have the leading axes.

        Raises
        ------
        InputError
            If a number is out of range or a direction is zero; the error names the entry.
        """
        hit, columns = self._core.ray_cast(origins, directions)
        part, bone, t, point, normal, depth = columns
        return PartHit(scalar(hit), scalar(part), scalar(bone), scalar(t), point, normal, scalar(depth))

    def surface_ray_cast(self, origins: ArrayLike, directions: ArrayLike) -> SurfaceHit:
        """Return the part whose skin each ray hits first, without skinning the whole surface.

        The result equals that of a ray cast on `mesh`. Only faces near the rays are skinned, so a
        few rays take a few microseconds. Use this method for soft surfaces, whose volumes reach
        over the neighboring parts.

        Parameters
        ----------
        origins, directions : (..., 3) array_like of float32 or float64
            As for `ray_cast`.

        Returns
        -------
        SurfaceHit
            The fields have the leading axes. Whether a face is hit, and which face is hit first, is
            decided exactly.

        Raises
        ------
        InputError
            As for `ray_cast`.

        Examples
        --------
        Find the part and the face of the file that a bullet hits::

            walking = robot.at("Robot_Walking", 0.5)
            hit = walking.surface_ray_cast([0, 4, 9], [0, 0, -1])
            robot.parts[hit.part].name, hit.face
        """
        hit, part, bone, face, t, point = self._core.surface_ray_cast(origins, directions)
        return SurfaceHit(scalar(hit), scalar(part), scalar(bone), scalar(face), scalar(t), point)

    def ray_cast_all(self, origins: ArrayLike, directions: ArrayLike) -> PartHit | PartHits:
        """Return all parts whose volumes each ray hits, in the order in which it enters them.

        Parameters
        ----------
        origins, directions : (..., 3) array_like of float32 or float64
            As for `ray_cast`.

        Returns
        -------
        PartHit or PartHits
            For a single ray a `PartHit` with one entry for each hit; `PartHits` if there are
            leading axes.

        Raises
        ------
        InputError
            As for `ray_cast`.
        """
        offsets, columns, shape = self._core.ray_cast_all(origins, directions)
        hits = _part_hits(columns)
        return PartHits(offsets, hits, tuple(shape)) if shape else hits

    def struck_by(self, shape: AnyShape, pose: ArrayLike | None = None) -> PartHit:
        """Return all parts that a shape or the surface of a mesh intersects, sorted by index.

        A part is left out only if it is proved to be apart.

        Parameters
        ----------
        shape : Shape or Mesh
            The striking shape.
        pose : (4, 4) array_like of float32 or float64, optional
            World from shape; the default is the identity.

        Returns
        -------
        PartHit
            One entry for each part that is hit.

        Raises
        ------
        InputError
            If an argument is invalid.
        """
        return _part_hits(self._core.struck_by(shape, pose))

    def struck_by_character(self, other: CharacterPose) -> PartPairs:
        """Return all intersecting pairs of a part of this character and a part of another.

        A pair is left out only if its parts are proved to be apart.

        Parameters
        ----------
        other : CharacterPose
            A pose of the same character or of another one.

        Raises
        ------
        InputError
            If `other` is not a `CharacterPose`.
        """
        _check_pose(other, "other")
        return PartPairs(*self._core.struck_by_character(other._core))

    def strikes(self, to: CharacterPose, shape: Shape, pose_t0: ArrayLike | None, pose_t1: ArrayLike | None) -> PartHit:
        """Return all parts that a moving shape hits while the character goes on to another pose.

        No hit is missed, however fast the shape moves between two frames. The bones' frames and the
        shape move along lines at constant velocity, and rotate by the smallest angle at constant
        angular velocity.

        Parameters
        ----------
        to : CharacterPose
            A pose of the same character: its pose at time 1.
        shape : Shape
            A sphere, capsule, box, triangle or hull.
        pose_t0, pose_t1 : (4, 4) array_like of float32 or float64, or None
            World from shape at times 0 and 1, rigid within 1e-4. None is the identity.

        Returns
        -------
        PartHit
            One entry for each part that is hit, sorted by `t`, then by index.

        Raises
        ------
        InputError
            If an argument is invalid.

        Examples
        --------
        Hit with a fist that passes through the character within one frame::

            fist = impinge.Shape.sphere(0.1)
            before, after = robot.at("Robot_Idle", 0.30), robot.at("Robot_Idle", 0.35)
            before.strikes(after, fist, impinge.pose([0, 2, 9]), impinge.pose([0, 2, -9]))
        """
        _check_pose(to, "to")
        if not isinstance(shape, Shape) or shape.kind not in _STRIKING_KINDS:
            kind = shape.kind if isinstance(shape, Shape) else type(shape).__name__
            message = (
                f"must be a Shape that is a {', '.join(_STRIKING_KINDS[:-1])} or {_STRIKING_KINDS[-1]}, not {kind}"
            )
            raise InputError(message, kind="type", what="shape")
        return _part_hits(self._core.strikes(to._core, _swept(shape), pose_t0, pose_t1))

    def __repr__(self) -> str:
        """Return the character."""
        return f"CharacterPose({self._character!r})"

    def __copy__(self) -> CharacterPose:
        """Return the pose itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> CharacterPose:
        """Return the pose itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the character, the animation, the time and the origin.

        Poses that are pickled together share the character.
        """
        return _restored, (self._character, *self._arguments)


def _restored(character: Character, animation: int | None, time: float, origin: list[float]) -> CharacterPose:
    return character.at(animation, time, origin=origin)


def _swept(shape: Shape) -> tuple[str, NDArray[np.float64], float]:
    """Return the kind, points and radius of a shape: all within the radius of the points' hull."""
    kind, source, numbers = shape._made_of
    if kind == "box":
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        return kind, signs * np.array(numbers), 0.0
    return kind, source, numbers[0] if numbers else 0.0


def _part_hits(columns: Any) -> PartHit:
    part, bone, t, point, normal, depth = columns
    return PartHit(np.ones(len(part), bool), part, bone, t, point, normal, depth)


def _check_pose(pose: object, name: str) -> None:
    if not isinstance(pose, CharacterPose):
        message = f"must be a CharacterPose, the result of Character.at(), not {type(pose).__name__}"
        raise InputError(message, kind="type", what=name)
