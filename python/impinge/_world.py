"""Worlds of many bodies that the caller moves: which pairs intersect, since when, and where."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._contacts import ContactRows, contact_rows
from impinge._errors import InputError
from impinge._handles import ALL_LAYERS, handle, handles_of, mask, numbers_of, poses_of, surface_of
from impinge._points import scalar
from impinge._scalars import flag, real
from impinge._shape import AnyShape, snapshot_of
from impinge._world_answers import Step, Work
from impinge._world_bodies import WorldBodies
from impinge._world_queries import WorldQueries
from impinge._world_state import WorldState

Kind: TypeAlias = Literal["static", "kinematic", "moving"]
BroadPhase: TypeAlias = Literal["auto", "every", "tree", "columns", "grid", "one_axis", "three_axes"]
Realignment: TypeAlias = Literal["own", "rotated", "loose", "hull", "climbing"]
NarrowPhase: TypeAlias = Literal["boxes", "intersections", "contacts"]


@final
class World(WorldQueries, WorldBodies):
    """Many bodies, and the pairs that intersect. No dynamics: the caller moves the bodies.

    A body is identified by its handle, an integer that is never used for another body. Reports are
    sorted by the bodies' tags, then by handles, and do not depend on options, threads or the order
    of insertion. Two bodies intersect if `impinge.intersects` returns True.

    Parameters
    ----------
    broad_phase : {"auto", "every", "tree", "columns", "grid", "one_axis", "three_axes"}
        Algorithm that finds pairs of overlapping boxes; it affects no answer. ``"auto"`` chooses by
        the number of bodies and by the share that moves.
    narrow_phase : {"contacts", "intersections", "boxes"}
        Test of pairs with overlapping boxes: whether they intersect, and their contacts; only
        whether they intersect; or no test, so that all such pairs count as intersecting.

    Notes
    -----
    Steps and queries use all processors (see `impinge.threads`), without the interpreter's lock.
    Calls from several threads run one after another. A copy is an independent world that shares the
    shapes. A world pickles its options, its filter, which must be picklable, and its state.

    Examples
    --------
    >>> import impinge
    >>> world = impinge.World()
    >>> floor = world.insert(impinge.Shape.half_space([0, 0, 1]), kind="static")
    >>> crates = world.insert(impinge.Shape.box([0.5, 0.5, 0.5]), impinge.pose([[0, 0, 2], [3, 0, 0.5]]))
    >>> world.step().began
    array([[         1, 8589934593]], dtype=uint64)
    >>> step = world.step(crates, impinge.pose([[0, 0, 0.25], [3, 0, 4]]))
    >>> step
    Step(1 began, 1 ended)
    >>> contacts = world.contacts()[0]
    >>> contacts.normal[0], contacts.depth
    (array([0., 0., 1.]), array([0.25, 0.25, 0.25, 0.25]))
    """

    __slots__ = ("_admits", "_options")
    _admits: Callable[[int, int], object] | None

    def __init__(self, *, broad_phase: BroadPhase = "auto", narrow_phase: NarrowPhase = "contacts") -> None:
        self._core = _impinge.WorldCore(broad_phase, narrow_phase)
        self._options, self._admits = (broad_phase, narrow_phase), None

    def insert(
        self,
        shape: AnyShape,
        pose: ArrayLike | None = None,
        *,
        kind: Kind = "moving",
        layers: int = ALL_LAYERS,
        meets: int = ALL_LAYERS,
        owner: ArrayLike | None = None,
        surface: int | None = None,
        tag: ArrayLike = 0,
        realigned_by: Realignment = "own",
        margin: float = 0.0,
    ) -> Any:
        """Insert bodies with one shape; the next step reports their pairs.

        Parameters
        ----------
        shape : Shape or Mesh
            Shape of all the bodies. A mesh is its surface in its current state.
        pose : (..., 4, 4) array_like of float32 or float64, optional
            World from body, for one body or for many; None is the identity.
        kind : {"moving", "kinematic", "static"}
            Pairs without a ``"moving"`` body are skipped. No step can move a ``"static"`` body.
        layers, meets : int
            Layers of the bodies, and layers that they collide with, as 32 bits. A pair is skipped
            unless each body collides with a layer of the other.
        owner : (...) array_like of integers, optional
            Bodies with the same owner, such as the limbs of one character, never collide.
        surface : int, optional
            Surface that the bodies are pieces of while they are ``"static"``, such as a floor of
            tiles. Their contacts are those of one compound: nothing that slides or rolls over the
            tiles meets the sides or edges between them. A pair may then have no contacts.
        tag : (...) array_like of integers
            Numbers chosen by the caller, by which reports are sorted.
        realigned_by : {"own", "rotated", "loose", "hull", "climbing"}
            Method that updates the bodies' boxes after moves; it affects no answer. ``"own"`` is
            tight for convex shapes; a mesh gets the box of its rotated local box, as with
            ``"rotated"``. ``"loose"`` is the box of a sphere about the body's origin. ``"hull"``
            and ``"climbing"`` are tight: one tests all vertices of the convex hull, the other
            climbs on it. Compounds and half-spaces use ``"own"``. See ``docs/notes/realigning.md``.
        margin : float
            Distance in world units, from 0 to 2^128. Two bodies are a pair if their distance is at
            most the sum of their margins, so contacts are known before the bodies touch.

        Returns
        -------
        int or (...) uint64 array
            Handles of the bodies.

        Raises
        ------
        InputError
            If an argument is invalid, or a round shape's pose is not rigid; nothing is inserted.
        """
        poses = np.eye(4) if pose is None else _arrays.plain_poses(pose, "pose")
        lead = poses.shape[:-2]
        owners = None if owner is None else numbers_of(owner, "owner", lead)
        traits = kind, mask(layers, "layers"), mask(meets, "meets"), surface_of(surface)
        placement = snapshot_of(shape), realigned_by, poses
        standing = traits, real(margin, "margin", minimum=0)
        return scalar(self._core.insert(placement, standing, owners, numbers_of(tag, "tag", lead)))

    def remove(self, bodies: ArrayLike) -> None:
        """Remove bodies. Their pairs are removed at once, and the next step reports them as ended.

        Parameters
        ----------
        bodies : int or (...) array_like of integers
            Handles, which are invalid from now on.

        Raises
        ------
        InputError
            If a handle is stale. Nothing is removed then.
        """
        self._core.remove(handles_of(bodies)[0])

    def step(
        self, bodies: ArrayLike | None = None, poses: ArrayLike | None = None, *, persisting: bool = False
    ) -> Step:
        """Move bodies, and return the pairs that began and ended; other bodies cost nothing.

        Parameters
        ----------
        bodies : int or (...) array_like of integers, optional
            Handles of the bodies that move. If a handle occurs twice, its last pose is used.
        poses : (..., 4, 4) array_like of float32 or float64, optional
            World from body at the new position, one for each body or one for all.
        persisting : bool
            Whether to return also the pairs that intersected before and still do.

        Returns
        -------
        Step
            The changes since the previous step.

        Raises
        ------
        InputError
            If a handle is stale, a body is static, or a pose is invalid, or not rigid and the shape
            is round. The error names the entry; no body is moved.
        MemoryError, KeyboardInterrupt
            If memory runs out, or at Ctrl-C before pairs are stored. The world is unchanged.
        Exception
            From the filter. The pair counts as admitted; the step is complete.
        """
        if (bodies is None) != (poses is None):
            what = "poses" if poses is None else "bodies"
            raise InputError("is missing: pass both bodies and poses, or neither", kind="option", what=what)
        handles, lead = handles_of(() if bodies is None else bodies)
        began, ended, persisted, work = self._core.step(handles, poses_of(poses, lead), flag(persisting, "persisting"))
        return Step(began, ended, persisted, Work(*work))

    def pairs(self, body: int | None = None) -> NDArray[np.uint64]:
        """Return the pairs that intersected at the last step, as (p, 2) handles, sorted by tag.

        If `body`, a handle, is given, only its pairs are returned. Undecided pairs are included.

        Raises
        ------
        InputError
            If the handle is stale.
        """
        return self._core.pairs(None if body is None else handle(body))[0]

    def undecided(self) -> NDArray[np.bool_]:
        """Report which of `pairs` are undecided, (p,).

        These are round shapes that touch within rounding, things that may be inside the solid of an
        open mesh, and, with ``narrow_phase="boxes"``, all pairs.
        """
        return self._core.pairs(None)[1]

    def contacts(self) -> ContactRows:
        """Return the contacts of `pairs` at the last step: row ``i`` belongs to pair ``i``.

        They equal those of `impinge.contacts`. Empty unless `narrow_phase` is ``"contacts"``.
        """
        offsets, columns = self._core.contacts()
        return contact_rows(offsets, columns, (len(offsets) - 1,))

    def set_poses(self, bodies: ArrayLike, poses: ArrayLike) -> None:
        """Move bodies immediately, static bodies too; the next step reports the changed pairs.

        Parameters
        ----------
        bodies, poses
            As for `step`.

        Raises
        ------
        InputError
            If a handle is stale, or a pose is invalid, or not rigid and the shape is round. The
            error names the entry; no body is moved.
        """
        handles, lead = handles_of(bodies)
        self._core.set_poses(handles, poses_of(poses, lead))

    def set_traits(
        self,
        bodies: ArrayLike,
        *,
        kind: Kind = "moving",
        layers: int = ALL_LAYERS,
        meets: int = ALL_LAYERS,
        owner: ArrayLike | None = None,
        surface: int | None = None,
    ) -> None:
        """Set kind, layers, owner and surface of bodies, from the next step on; tags do not change.

        Parameters
        ----------
        bodies : int or (...) array_like of integers
            Handles of the bodies.
        kind, layers, meets, owner, surface
            As for `insert`. All of them are set: an omitted argument is reset to its default.

        Raises
        ------
        InputError
            If a handle is stale, or if an option is invalid. Nothing is changed then.
        """
        handles, lead = handles_of(bodies)
        owners = None if owner is None else numbers_of(owner, "owner", lead)
        traits = kind, mask(layers, "layers"), mask(meets, "meets"), surface_of(surface)
        self._core.set_traits(handles, traits, owners)

    def set_margin(self, bodies: ArrayLike, margin: float) -> None:
        """Set the margin of bodies, from the next step on, as for `insert`.

        Parameters
        ----------
        bodies : int or (...) array_like of integers
            Handles of the bodies.
        margin : float
            Distance in world units, from 0 to 2^128.

        Raises
        ------
        InputError
            If a handle is stale, or if the margin is invalid. Nothing is changed then.
        """
        least = real(margin, "margin", minimum=0)
        _impinge.world_set_margin(self._core, handles_of(bodies)[0], least)

    def set_shape(self, body: int, shape: AnyShape) -> None:
        """Replace the shape of one body, given by its handle; the next step reports the changes.

        Raises
        ------
        InputError
            If the handle is stale, or if the shape is round and the body's pose is not rigid.
        """
        self._core.set_shape(handle(body), snapshot_of(shape))

    def refit(self, body: int, vertices: ArrayLike) -> float:
        """Move the vertices of a body that is a mesh, as `Mesh.refit` does; no other body changes.

        Parameters
        ----------
        body : int
            Handle of the body.
        vertices : (n, 3) array_like of float32 or float64
            In the mesh frame, as for `Mesh.refit`.

        Returns
        -------
        float
            `Mesh.aging` after the refit.

        Raises
        ------
        InputError
            If the handle is stale, if the body is not a mesh, or as for `Mesh.refit`.
        """
        return self._core.refit(handle(body), _arrays.plain_cloud(vertices, "vertices"))

    def set_filter(self, admits: Callable[[int, int], object] | None) -> None:
        """Set a function that decides which pairs may collide, from the next step on.

        Parameters
        ----------
        admits : callable or None
            ``admits(a, b)`` returns whether two bodies may collide; None admits all pairs. The
            arguments are handles, sorted by tag, then by handle. One thread at a time calls it for
            pairs of overlapping boxes that kinds, layers and owners admit, which are much faster.
            Its result must not change. It must not call this world, nor impinge with many rows.
        """
        if admits is not None and not callable(admits):
            raise InputError(f"must be callable, not {type(admits).__name__}", kind="type", what="admits")
        self._core.set_filter(admits)
        self._admits = admits

    def save(self) -> WorldState:
        """Return a snapshot of everything that steps change, for `restore`.

        After `restore`, the same steps return bitwise equal results. The filter is not included.
        A snapshot shares the shapes, and is picklable, with arrays out of band with protocol 5.
        """
        return self._core.save()

    def restore(self, state: WorldState) -> None:
        """Restore a snapshot of this world, or of another world with the same options.

        Raises
        ------
        InputError
            If `state` is not such a snapshot.

        Examples
        --------
        >>> import impinge
        >>> world = impinge.World()
        >>> ball = world.insert(impinge.Shape.sphere(1), impinge.pose([1, 2, 3]))
        >>> before = world.save()
        >>> world.remove(ball)
        >>> world.restore(before)
        >>> world.poses(ball)[:3, 3]
        array([1., 2., 3.])
        """
        if not isinstance(state, WorldState):
            message = f"must be a WorldState, the result of save(), not {type(state).__name__}"
            raise InputError(message, kind="type", what="state")
        self._core.restore(state)

    def __len__(self) -> int:
        """Return the number of bodies."""
        return self._core.count()

    def __repr__(self) -> str:
        """Return the numbers of bodies and of pairs."""
        return f"World({len(self)} bodies, {len(self.pairs())} pairs)"

    def __copy__(self) -> World:
        """Return an independent world with the same bodies, pairs and filter; shapes are shared."""
        return _world_of(*self._options, self._admits, self.save())

    def __deepcopy__(self, memo: object) -> World:
        """Return an independent world with the same bodies, pairs and filter; shapes are shared."""
        return self.__copy__()

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the options, the filter and the state."""
        return _world_of, (*self._options, self._admits, self.save())


def _world_of(
    broad_phase: BroadPhase,
    narrow_phase: NarrowPhase,
    admits: Callable[[int, int], object] | None,
    state: WorldState,
) -> World:
    world = World(broad_phase=broad_phase, narrow_phase=narrow_phase)
    world.set_filter(admits)
    world.restore(state)
    return world
