"""Worlds of many bodies that the caller moves: which of them meet, since when, where and how deep."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._contacts import ContactRows, contact_rows
from impinge._errors import InputError
from impinge._handles import ALL_LAYERS, handle, handles_of, mask, numbers_of, poses_of
from impinge._points import scalar
from impinge._scalars import flag
from impinge._shape import AnyShape, settled
from impinge._world_answers import Step, Work
from impinge._world_queries import WorldQueries
from impinge._world_state import WorldState

Kind: TypeAlias = Literal["static", "kinematic", "moving"]
BroadPhase: TypeAlias = Literal["auto", "every", "tree", "columns", "grid", "one_axis", "three_axes"]
Realignment: TypeAlias = Literal["own", "rotated", "loose", "hull", "climbing"]
NarrowPhase: TypeAlias = Literal["boxes", "intersections", "contacts"]


@final
class World(WorldQueries):
    """Many bodies, and which of them meet. There are no dynamics: the caller moves the bodies.

    A body is named by its handle, an integer that never comes to mean another body. Reports are sorted by the bodies'
    tags, then by their handles, and do not depend on the broad phase, the number of threads or the order in which
    bodies came. What counts as meeting is what `impinge.intersects` says; touching counts.

    Parameters
    ----------
    broad_phase : {"auto", "every", "tree", "columns", "grid", "one_axis", "three_axes"}
        How pairs of boxes are found, which changes no answer. ``"auto"`` goes by the number of bodies and how many of
        them move.
    narrow_phase : {"contacts", "intersections", "boxes"}
        What is found out about pairs whose boxes overlap: whether they meet and their contacts; whether they meet;
        nothing, so that such pairs count as meeting.

    Raises
    ------
    InputError
        If an option is none of these.

    Notes
    -----
    Steps and questions use all processors (`impinge.threads`), without Python's lock; calls from several threads take
    turns.

    A copy (`copy.copy`, `copy.deepcopy`) is a world of its own, which shares the shapes. A world pickles with all that
    `save` keeps, its options and its filter, if that does; so does what `save` returns. Handles stay what they are.

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
        tag: ArrayLike = 0,
        realigned_by: Realignment = "own",
    ) -> Any:
        """Put bodies of one shape into the world; what they meet is told by the next step.

        Parameters
        ----------
        shape : Shape or Mesh
            Shared by the bodies. A mesh is its surface as it is now.
        pose : (..., 4, 4) array_like of float32 or float64, optional
            World from body, for one body or for many.
        kind : {"moving", "kinematic", "static"}
            Pairs are looked for of which one body at least is ``"moving"``. A ``"static"`` one no step can move.
        layers, meets : int
            The layers that the bodies are on, and those whose bodies they meet, as 32 bits. Both bodies of a pair have
            to want it.
        owner : (...) array_like of integers, optional
            Bodies with one owner never meet: the limbs of one character.
        tag : (...) array_like of integers
            Numbers of the caller's, by which reports are sorted.
        realigned_by : {"own", "rotated", "loose", "hull", "climbing"}
            How the bodies' boxes follow them, which changes no answer: the shape's own way, tight for what is convex
            and that of the turned box for meshes; always the box of the turned box; the box of the sphere about the
            origin; tight, by all vertices of the convex hull; tight, by climbing on the hull from the last extremes.
            ``docs/realigning.md`` measures them. Compounds and half-spaces always have their own.

        Returns
        -------
        int or (...) uint64 array
            The handles.

        Raises
        ------
        InputError
            If an argument is none of the above, or a round shape does not stand a pose; nothing was inserted then.
        """
        poses = np.eye(4) if pose is None else _arrays.plain_poses(pose, "pose")
        lead = poses.shape[:-2]
        owners = None if owner is None else numbers_of(owner, "owner", lead)
        standing = kind, mask(layers, "layers"), mask(meets, "meets")
        placement = settled(shape), realigned_by, poses
        return scalar(self._core.insert(placement, standing, owners, numbers_of(tag, "tag", lead)))

    def remove(self, bodies: ArrayLike) -> None:
        """Take bodies out; pairs that they were in are gone at once, and told as ended by the next step.

        Parameters
        ----------
        bodies : int or (...) array_like of integers
            Handles, which are out of use from now on.

        Raises
        ------
        InputError
            If a body is not, or no longer, in the world; none was taken out then.
        """
        self._core.remove(handles_of(bodies)[0])

    def step(
        self, bodies: ArrayLike | None = None, poses: ArrayLike | None = None, *, persisting: bool = False
    ) -> Step:
        """Move bodies, and say what changed.

        Parameters
        ----------
        bodies : int or (...) array_like of integers, optional
            Those that move; others stay where they are. Of two poses for one body the last counts.
        poses : (..., 4, 4) array_like of float32 or float64, optional
            World from body, one for each body or one for all.
        persisting : bool
            Whether the pairs that met before and still do are wanted, too; all that meet are `pairs`.

        Returns
        -------
        Step
            A step costs what moved and the pairs that it is in; what stands still costs nothing.

        Raises
        ------
        InputError
            If a handle is stale, a body static or a pose none, or not rigid where the shape is round; it says which.
            Nothing has moved then.
        Exception
            What a filter raised; the pair counts as admitted, and the step was made.
        """
        if (bodies is None) != (poses is None):
            what = "poses" if poses is None else "bodies"
            raise InputError("bodies and poses come together", kind="option", what=what)
        handles, lead = handles_of(() if bodies is None else bodies)
        began, ended, stay, work = self._core.step(handles, poses_of(poses, lead), flag(persisting, "persisting"))
        return Step(began, ended, stay, Work(*work))

    def pairs(self, body: int | None = None) -> NDArray[np.uint64]:
        """Return the pairs that met at the last step, (p, 2) handles, sorted; those of one body where it is named.

        Raises
        ------
        InputError
            If the body is not, or no longer, in the world.
        """
        return self._core.pairs(None if body is None else handle(body))[0]

    def undecided(self) -> NDArray[np.bool_]:
        """Return which of `pairs` nothing was proved about, (p,): round shapes that touch to within rounding."""
        return self._core.pairs(None)[1]

    def contacts(self) -> ContactRows:
        """Return the contacts of `pairs`: row ``i`` has those of pair ``i``, as `impinge.contacts` says.

        There are none where the world was made with another `narrow_phase`.
        """
        offsets, columns = self._core.contacts()
        return contact_rows(offsets, columns, (len(offsets) - 1,))

    @property
    def bodies(self) -> NDArray[np.uint64]:
        """(n,) handles of all bodies."""
        return self._core.bodies()

    def poses(self, bodies: ArrayLike) -> NDArray[np.float64]:
        """Return where bodies are: world from body, (..., 4, 4).

        Raises
        ------
        InputError
            If a body is not, or no longer, in the world.
        """
        handles, lead = handles_of(bodies)
        return self._core.poses(handles).reshape(*lead, 4, 4)

    def tags(self, bodies: ArrayLike) -> Any:
        """Return the tags of bodies, (...) uint64; of pairs, for example.

        Raises
        ------
        InputError
            If a body is not, or no longer, in the world.
        """
        handles, lead = handles_of(bodies)
        return scalar(self._core.tags(handles).reshape(lead))

    def bounds(self, bodies: ArrayLike) -> NDArray[np.float64]:
        """Return lower and upper corners, (..., 2, 3), of boxes about bodies; infinite about what nothing bounds.

        Raises
        ------
        InputError
            If a body is not, or no longer, in the world.
        """
        handles, lead = handles_of(bodies)
        return self._core.bounds(handles).reshape(*lead, 2, 3)

    def set_poses(self, bodies: ArrayLike, poses: ArrayLike) -> None:
        """Put bodies elsewhere at once, static ones too; what they meet there is told by the next step.

        Parameters
        ----------
        bodies : int or (...) array_like of integers
            Handles.
        poses : (..., 4, 4) array_like of float32 or float64
            World from body, one for each body or one for all.

        Raises
        ------
        InputError
            As for `step`. Nothing has moved then.
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
    ) -> None:
        """Change what moves bodies, whom they meet and who owns them, from the next step on; their tags stay.

        Parameters
        ----------
        bodies : int or (...) array_like of integers
            Handles.
        kind, layers, meets, owner
            As for `insert`; all of them, so that what is not given is as it is there.

        Raises
        ------
        InputError
            If a handle is stale or an option none of these.
        """
        handles, lead = handles_of(bodies)
        owners = None if owner is None else numbers_of(owner, "owner", lead)
        self._core.set_traits(handles, (kind, mask(layers, "layers"), mask(meets, "meets")), owners)

    def set_shape(self, body: int, shape: AnyShape) -> None:
        """Give a body another shape; what it meets then is told by the next step.

        Raises
        ------
        InputError
            If the handle is stale, or the shape does not stand the body's pose.
        """
        self._core.set_shape(handle(body), settled(shape))

    def refit(self, body: int, vertices: ArrayLike) -> float:
        """Move the vertices of a body that is a mesh, as `Mesh.refit` does; other bodies of the mesh keep it as it is.

        Parameters
        ----------
        body : int
            Its handle.
        vertices : (n, 3) array_like of float32 or float64
            As many as before, in the mesh's own frame.

        Returns
        -------
        float
            What the mesh's `Mesh.aging` is by now.

        Raises
        ------
        InputError
            If the handle is stale, the body is no mesh, or as for `Mesh.refit`.
        """
        return self._core.refit(handle(body), _arrays.plain_cloud(vertices, "vertices"))

    def set_filter(self, admits: Callable[[int, int], object] | None) -> None:
        """Ask a function which pairs may meet, from the next step on.

        Parameters
        ----------
        admits : callable or None
            ``admits(a, b)`` with two handles, the first of the lesser tag or handle: whether they may meet. It is asked
            about pairs whose boxes overlap and that kinds, layers and owners admit. It has to
            give the same answer whenever it is asked, and must not call this world, or impinge with many rows. It is
            asked by the threads of a step, one after another as they need the interpreter: where layers or owners do,
            they are much quicker. None admits every pair.
        """
        if admits is not None and not callable(admits):
            raise InputError(f"must be callable, not {type(admits).__name__}", kind="type", what="admits")
        self._core.set_filter(admits)
        self._admits = admits

    def save(self) -> WorldState:
        """Return all that steps change, for going back to it with `restore`.

        From there the same steps give the same bytes. The filter is not part of it. It costs a copy of the bodies'
        records; shapes are shared. It pickles, the arrays out of band with protocol 5, and shapes once however many
        bodies have them.
        """
        return self._core.save()

    def restore(self, state: WorldState) -> None:
        """Go back to what `save` returned, of this world or of one with the same options; handles are those of then.

        Raises
        ------
        InputError
            If it is something else.

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
            raise InputError(f"must be what save() returned, not {type(state).__name__}", kind="type", what="state")
        self._core.restore(state)

    def __len__(self) -> int:
        """Return the number of bodies."""
        return self._core.count()

    def __repr__(self) -> str:
        """Return the numbers of bodies and of pairs."""
        return f"World({len(self)} bodies, {len(self.pairs())} pairs)"

    def __copy__(self) -> World:
        """Return another world with the same bodies, pairs and filter; shapes are shared."""
        return _world_of(*self._options, self._admits, self.save())

    def __deepcopy__(self, memo: object) -> World:
        """Return another world with the same bodies, pairs and filter; shapes, which never change, are shared."""
        return self.__copy__()

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle options, filter and state."""
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
