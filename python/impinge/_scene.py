"""Many parts at once: checks every configuration of a robot or an assembly in one call."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from copy import copy
from itertools import combinations
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays, _impinge
from impinge._baked_scene import bake_scene
from impinge._details import Details
from impinge._engine import engine
from impinge._errors import InputError
from impinge._inspection import Repair
from impinge._mesh import Mesh
from impinge._parts import parts_of, unit_of, up_of
from impinge._picture import Picture
from impinge._rows import Statuses
from impinge._scalars import chosen, flag, path_of, real
from impinge._scene_report import SceneReport
from impinge._shape import AnyShape, Shape

if TYPE_CHECKING:
    from impinge.cluster import Cluster


class Scene:
    """Named parts that are checked against each other in many configurations with one call.

    Parameters
    ----------
    parts : mapping of str to Mesh or Shape
        The parts; several parts may share one mesh or shape.
    poses : mapping of str to (4, 4) array_like, optional
        World from part, copied. A part without a pose has the identity.
    details : mapping of str to Details, optional
        Key, type, path and further properties of parts.
    ignored : iterable of (str, str), optional
        Pairs of parts that are not checked, such as neighboring links of a robot, in either order.
    solid : bool
        Whether meshes are solids, so that a part that lies inside another one intersects it.

    Raises
    ------
    InputError
        If a part is not a `Mesh` or `Shape`, if a pose is not a (4, 4) matrix, or if `poses`,
        `details` or `ignored` contains the name of an unknown part.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> scene = impinge.Scene({"base": triangle, "arm": triangle, "hand": triangle}, ignored=[("arm", "hand")])
    >>> arm = impinge.pose([[0, 0, 5], [0, 0, 0]])
    >>> report = scene.check({"arm": arm, "hand": impinge.pose([0, 0, 9])}, stop="all")
    >>> report
    SceneReport(2 configurations, 1 in collision, 2 pairs each)
    >>> report.worst, report.names(report.worst)
    ((1,), [('base', 'arm')])
    """

    def __init__(
        self,
        parts: Mapping[str, AnyShape],
        *,
        poses: Mapping[str, ArrayLike] | None = None,
        details: Mapping[str, Details] | None = None,
        ignored: Iterable[tuple[str, str]] = (),
        solid: bool = False,
    ) -> None:
        if not isinstance(parts, Mapping):
            raise InputError(f"must be a mapping, not {type(parts).__name__}", kind="type", what="parts")
        self._parts = dict(parts)
        self._solid = flag(solid, "solid")
        for name, part in self._parts.items():
            if not isinstance(name, str) or not isinstance(part, Mesh | Shape):
                message = f"part {name!r} is {type(part).__name__}; pass str names, and impinge.Mesh or impinge.Shape"
                raise InputError(message, kind="type", what="parts")
        self._poses = {name: _pose(pose, name) for name, pose in self._of_parts(poses, "poses").items()}
        self._details: dict[str, Details] = self._of_parts(details, "details")
        for name, about in self._details.items():
            if not isinstance(about, Details):
                message = f"of part {name!r} are {type(about).__name__}; pass impinge.Details"
                raise InputError(message, kind="type", what="details")
        self._places = {name: place for place, name in enumerate(self._parts)}
        self._ignored: set[tuple[int, int]] = set()
        self._sorted_ignored: NDArray[np.uint32] | None = None
        for a, b in _pairs(ignored):
            self._ignore((a, "ignored"), (b, "ignored"))

    @property
    def parts(self) -> dict[str, AnyShape]:
        """A copy of the parts by name."""
        return dict(self._parts)

    @property
    def poses(self) -> dict[str, NDArray[np.float64]]:
        """The pose of each part by name, (4, 4), world from part; read-only arrays."""
        return {name: self._poses.get(name, _IDENTITY) for name in self._parts}

    def details(self, name: str) -> Details:
        """Return key, type, path and further properties of a part; they may be empty.

        Raises
        ------
        InputError
            If there is no part with the name.
        """
        self._check_name(name, "name")
        return self._details.get(name, Details())

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Pairs of names that are checked, in the order of the parts."""
        places = combinations(enumerate(self._parts), 2)
        return tuple((a, b) for (i, a), (j, b) in places if (i, j) not in self._ignored)

    def ignore(self, a: str, b: str) -> None:
        """Exclude the pair of two named parts, in either order, from later checks.

        Raises
        ------
        InputError
            If there is no part with one of the names.
        """
        self._ignore((a, "a"), (b, "b"))

    def _ignore(self, a: tuple[str, str], b: tuple[str, str]) -> None:
        """Exclude a pair.

        Each item is the name of a part and, for error messages, the name of the argument.
        """
        for name, what in (a, b):
            self._check_name(name, what)
        i, j = sorted((self._places[a[0]], self._places[b[0]]))
        if i < j:
            self._ignored.add((i, j))
            self._sorted_ignored = None

    def repaired(self) -> tuple[Scene, dict[str, Repair]]:
        """Return a copy in which open meshes are repaired, and the repair of each changed part.

        Faces are turned so that neighbors agree. If it closes the mesh, vertices are welded by at
        most a millionth of the largest extent. No hole is filled. The inside of a closed part is
        certain, so answers about it are proved, and they take less time.

        Examples
        --------
        >>> import impinge
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> scene = impinge.Scene({"tip": impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 2, 3], [1, 2, 3]])})
        >>> repaired, repairs = scene.repaired()
        >>> repaired.parts["tip"].is_closed, repairs["tip"].turned_faces
        (True, array([2], dtype=uint32))
        """
        opened = {id(mesh): mesh for mesh in self._parts.values() if isinstance(mesh, Mesh) and not mesh.is_closed}
        better = {key: mesh._repaired(None, True) for key, mesh in opened.items()}
        changes = {key: len(repair.turned_faces) + len(repair.welded_vertices) for key, (_, repair) in better.items()}
        found = {name: better[id(part)] for name, part in self._parts.items() if changes.get(id(part), 0)}
        scene = copy(self)
        scene._parts = self._parts | {name: mesh for name, (mesh, _) in found.items()}
        scene._ignored = set(self._ignored)
        return scene, {name: repair for name, (_, repair) in found.items()}

    def check(
        self,
        poses: Mapping[str, ArrayLike] | None = None,
        *,
        question: Literal["intersects", "penetrates", "within"] = "intersects",
        clearance: float | None = None,
        stop: Literal["first", "all"] = "first",
        on_error: Literal["raise", "status"] = "raise",
        progress: bool = False,
        on: Cluster | None = None,
    ) -> SceneReport:
        """Check all pairs of parts in each configuration.

        Only pairs whose boxes are near each other are examined, and each configuration starts from
        the results of the one before. Neither affects the answer.

        Parameters
        ----------
        poses : mapping of str to (..., 4, 4) array_like
            World from part. The leading axes, the configurations, broadcast as in NumPy. A part
            without a pose here has that of the scene. Pairs of parts that do not move are checked
            once.
        question : {"intersects", "penetrates", "within"}
            The test, as the function of the same name. ``"penetrates"`` treats meshes as solids;
            ``"within"`` requires a clearance.
        clearance : float, optional
            In world units, at least zero; only for ``"within"``.
        stop : {"first", "all"}
            Whether a configuration is finished at the first pair found, in the order of `pairs`, or
            all pairs are checked.
        on_error : {"raise", "status"}
            How to treat an invalid pose. With ``"status"`` all checked pairs of its part count as
            found in that configuration.
        progress : bool
            As for `intersects`.
        on : impinge.cluster.Cluster, optional
            The cluster that divides the configurations among its nodes, or the pairs if there is
            one configuration and all its pairs are wanted. The report is the same.

        Returns
        -------
        SceneReport
            The report is the same for any number of threads.

        Raises
        ------
        InputError
            If `poses` contains the name of an unknown part, if a clearance is missing or not
            applicable, or as for `intersects`.

        Examples
        --------
        >>> import impinge
        >>> ball = impinge.Shape.sphere(0.5)
        >>> scene = impinge.Scene({"a": ball, "b": ball})
        >>> near = scene.check({"b": impinge.pose([[1.25, 0, 0], [9, 0, 0]])}, question="within", clearance=0.5)
        >>> near.intersects
        array([ True, False])
        """
        placed = self._poses | self._of_parts(poses, "poses")
        chosen(stop, ("first", "all"), "stop")
        chosen(question, ("intersects", "penetrates", "within"), "question")
        if (question == "within") != (clearance is not None):
            message = 'must be given if question is "within", and only then'
            raise InputError(message, kind="option", what="clearance")
        limit = 0.0 if clearance is None else real(clearance, "clearance", minimum=0)
        parts = [(name, part, self._solid, placed.get(name)) for name, part in self._parts.items()]
        asked = (question, limit), stop == "first", on_error, progress
        answer: Any = engine(on).check_scene(parts, self._ignored_places(), *asked)
        status: Statuses | None = None
        if on_error == "status":
            answer, status = answer
        return SceneReport(self, answer, status, stopped_at_first=stop == "first")

    def bake(self, folder: str | os.PathLike[str]) -> None:
        """Write the scene to a folder that `load_scene` maps, so that it may be larger than memory.

        If the folder has a baked scene already, the parts are added to it. So models that do not
        fit in memory together can be baked one after the other. Do not bake into one folder from
        two processes at a time, and do not change its files while they are in use.

        Parameters
        ----------
        folder : str or os.PathLike
            A folder, which is made if it does not exist. It gets the meshes with their hierarchies,
            each once, and the poses, the details and the ignored pairs.

        Raises
        ------
        InputError
            If a part is a `Shape`, or if the folder has a part with the same name, or a scene with
            another `solid`, or a damaged one.
        OSError
            If the folder cannot be read or written.

        Examples
        --------
        >>> import impinge, pathlib, tempfile
        >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     impinge.Scene({"a": triangle, "b": triangle}).bake(folder)
        ...     impinge.Scene({"c": triangle}).bake(folder)
        ...     impinge.load_scene(folder)
        Scene(3 parts, 3 pairs)
        """
        bake_scene(self, path_of(folder, "folder"))

    def _picture(self, size: list[int], view: list[float], up: str) -> Picture:
        """Return a picture of all bounded parts."""
        return Picture(_impinge.picture_of_scene(parts_of(self), (size, view, up), unit_of({"": self})))

    def _repr_png_(self) -> bytes:
        """Return a picture for a notebook."""
        return self._picture([640, 480], [-35.0, 25.0], up_of({"": self}))._repr_png_()

    def _names(self) -> list[str]:
        return list(self._parts)

    def _ignored_places(self) -> NDArray[np.uint32]:
        """Return the ignored pairs as sorted pairs of part indices, the smaller first, (k, 2)."""
        pairs = self._sorted_ignored
        if pairs is None:
            pairs = np.array(sorted(self._ignored), np.uint32).reshape(-1, 2)
            self._sorted_ignored = pairs
        return pairs

    def _of_parts(self, given: Mapping[str, Any] | None, what: str) -> dict[str, Any]:
        """Return an argument with values for some of the parts, without values of None."""
        if given is not None and not isinstance(given, Mapping):
            raise InputError(f"must be a mapping, not {type(given).__name__}", kind="type", what=what)
        for name in given or {}:
            self._check_name(name, what)
        return {name: value for name, value in (given or {}).items() if value is not None}

    def _check_name(self, name: str, what: str) -> None:
        if not isinstance(name, str) or name not in self._parts:
            message = f"there is no part {name!r}; there are {', '.join(map(repr, self._parts)) or 'none'}"
            raise InputError(message, kind="name", what=what)

    def __repr__(self) -> str:
        """Return the numbers of parts and pairs."""
        count = len(self._parts)
        return f"Scene({count} parts, {count * (count - 1) // 2 - len(self._ignored)} pairs)"


_IDENTITY = np.eye(4)
_IDENTITY.setflags(write=False)


def _pose(pose: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return a read-only copy of the pose of a part."""
    matrix = _arrays.plain_poses(pose, f"poses[{name!r}]").copy()
    if matrix.shape != (4, 4):
        message = f"has shape {matrix.shape}; a part of a scene has one pose, (4, 4)"
        raise InputError(message, kind="shape", what=f"poses[{name!r}]", hint="pass configurations to check")
    matrix.setflags(write=False)
    return matrix


def _pairs(ignored: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    try:
        return [(a, b) for a, b in ignored]
    except (TypeError, ValueError):
        raise InputError("must be pairs of names", kind="type", what="ignored") from None
