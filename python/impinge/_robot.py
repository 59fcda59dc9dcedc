"""Robots: from URDF files to the collisions of many configurations."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._errors import InputError, LoadWarning
from impinge._mesh import Mesh
from impinge._robot_arguments import known, pairs_of, text
from impinge._robot_joint import Joint
from impinge._robot_queries import RobotQueries
from impinge._scalars import chosen, path_of, whole
from impinge._shape import AnyShape, Shape


@final
class Robot(RobotQueries):
    """A kinematic tree of links with shapes, whose configurations are checked in one call.

    A link is the union of its shapes, and closed meshes are solids. The frame of the root link is
    the world frame. Make a robot by `load` or `from_parts`. A robot is immutable, and a copy is the
    robot itself. A robot that was loaded pickles the paths of its files.

    Examples
    --------
    >>> import impinge
    >>> robot = impinge.Robot.load("data/robots/gantry.urdf", "data/robots/gantry.srdf")
    >>> robot
    Robot('gantry', 8 links, 5 coordinates, 11 pairs)
    >>> robot.joints
    ('slide', 'shoulder', 'elbow', 'wrist', 'grip')
    >>> report = robot.check([[0, 0, 0, 0, 0], [-0.25, 3, 2.6, 0, 0]])
    >>> report.collides
    array([False,  True])
    """

    _core: _impinge.RobotCore
    _made_of: tuple[Any, ...]

    def __init__(self) -> None:
        """Raise an error: use `load` or `from_parts`."""
        hint = "use Robot.load(...) or Robot.from_parts(...)"
        raise InputError("Robot() does not make a robot", kind="option", what="Robot", hint=hint)

    @classmethod
    def _of(cls, made_of: tuple[Any, ...], core: _impinge.RobotCore) -> Robot:
        robot = object.__new__(cls)
        robot._made_of, robot._core = made_of, core
        return robot

    @classmethod
    def load(
        cls,
        urdf: str | os.PathLike[str],
        srdf: str | os.PathLike[str] | None = None,
        packages: Mapping[str, str | os.PathLike[str]] | None = None,
        geometry: Literal["collision", "visual", "hull"] = "collision",
        *,
        max_bytes: int | None = None,
        max_triangles: int | None = None,
    ) -> Robot:
        """Load a robot from a URDF file, and optionally an SRDF file about it.

        Lengths are in meters. A mesh whose format states its unit is converted to meters; the axes
        are those of the mesh file.

        Parameters
        ----------
        urdf : str or os.PathLike
            The URDF file. Process a xacro file first: ``xacro robot.urdf.xacro > robot.urdf``.
        srdf : str or os.PathLike, optional
            The SRDF file: groups, states, and pairs of links that are not checked.
        packages : mapping of str to str or os.PathLike, optional
            Folders of the packages that ``package://`` URIs name. Other packages are searched in
            ``ROS_PACKAGE_PATH`` and ``AMENT_PREFIX_PATH``, then in the folders above the URDF file;
            the latter is a guess, which a warning reports.
        geometry : {"collision", "visual", "hull"}
            The shapes of the links: the ``collision`` elements, the ``visual`` elements, or the
            convex hulls of the meshes of the ``collision`` elements.
        max_bytes, max_triangles : int, optional
            As for `impinge.load`, for each file.

        Returns
        -------
        Robot
            Pairs of links that a joint or only fixed joints connect are not checked, nor are those
            that the SRDF file disables.

        Raises
        ------
        OSError
            If a URDF or SRDF file cannot be read.
        InputError
            If a file is invalid, or if a mesh is missing, ambiguous or invalid. The error names the
            file, the line, and the link or joint.

        Warns
        -----
        LoadWarning
            For each entry of `warnings`.
        """
        given = {} if packages is None else packages
        if not isinstance(given, Mapping):
            raise InputError(f"must be a mapping, not {type(given).__name__}", kind="type", what="packages")
        chosen(geometry, ("collision", "visual", "hull"), "geometry")
        limits = [(max_bytes, "max_bytes"), (max_triangles, "max_triangles")]
        checked = [None if limit is None else whole(limit, name) for limit, name in limits]
        folders = [(text(name, "packages"), os.path.abspath(path_of(path, "packages"))) for name, path in given.items()]
        given_paths = [(urdf, "urdf")] if srdf is None else [(urdf, "urdf"), (srdf, "srdf")]
        paths = [os.path.abspath(path_of(path, name)) for path, name in given_paths] + [None] * (srdf is None)
        arguments = (*paths, folders, geometry, *checked)
        robot = cls._loaded(*arguments)
        for message in robot.warnings:
            warnings.warn(message, LoadWarning, stacklevel=2)
        return robot

    @classmethod
    def _loaded(cls, *arguments: Any) -> Robot:
        return cls._of((cls._loaded, arguments), _impinge.RobotCore(*arguments))

    @classmethod
    def from_parts(
        cls,
        links: Mapping[str, AnyShape | None],
        joints: Iterable[Joint],
        ignored: Iterable[tuple[str, str]] = (),
    ) -> Robot:
        """Make a robot of links and joints, for example from another library's model.

        Parameters
        ----------
        links : mapping of str to Shape, Mesh or None
            Shape of each link in the frame of the link; `Shape.compound` joins several. A mesh
            stands for its solid. None is a link that cannot collide.
        joints : iterable of Joint
            The joints, which form one tree of all links. Configurations have their order.
        ignored : iterable of (str, str), optional
            Pairs of links that are not checked, in addition to those that a joint or only fixed
            joints connect.

        Returns
        -------
        Robot

        Raises
        ------
        InputError
            If links and joints are not one tree, or if a joint is invalid. The error names it.

        Examples
        --------
        >>> import impinge
        >>> bar = impinge.Shape.capsule([0, 0, 0], [1, 0, 0], 0.05)
        >>> tip = impinge.pose([1, 0, 0])
        >>> joints = [
        ...     impinge.Joint("elbow", "upper", "fore", "revolute", tip, axis=(0, 0, 1)),
        ...     impinge.Joint("wrist", "fore", "hand", "revolute", tip, axis=(0, 0, 1)),
        ... ]
        >>> robot = impinge.Robot.from_parts({"upper": bar, "fore": bar, "hand": bar}, joints)
        >>> robot.check([2.2, 2.2]).names()
        [('upper', 'hand')]
        """
        if not isinstance(links, Mapping):
            raise InputError(f"must be a mapping, not {type(links).__name__}", kind="type", what="links")
        rows = [(text(name, "links"), shape) for name, shape in links.items()]
        for name, shape in rows:
            if shape is not None and not isinstance(shape, Mesh | Shape):
                message = f"link {name!r} is {type(shape).__name__}; pass impinge.Shape, impinge.Mesh or None"
                raise InputError(message, kind="type", what="links")
        joints = list(joints)
        for joint in joints:
            if not isinstance(joint, Joint):
                raise InputError(f"must be impinge.Joint, not {type(joint).__name__}", kind="type", what="joints")
        place = {name: at for at, (name, _) in enumerate(rows)}
        pairs = pairs_of(ignored)
        places = [(known(a, place, "link", "ignored"), known(b, place, "link", "ignored")) for a, b in pairs]
        core = _impinge.robot_of_parts(rows, [joint._row() for joint in joints], places)
        return cls._of((cls.from_parts, (dict(links), joints, pairs)), core)

    def attached(
        self,
        name: str,
        shape: AnyShape,
        link: str,
        pose: ArrayLike | None = None,
        touch: Iterable[str] = (),
    ) -> Robot:
        """Return a robot that also holds an object, such as a part in its gripper.

        The object is a link with its own name. It is checked against all links, except for `link`,
        for the links that only fixed joints connect with that, and for those in `touch`. All else
        is shared with this robot, which stays as it is.

        Parameters
        ----------
        name : str
            Name of the object, which no link has.
        shape : Shape or Mesh
            Shape of the object in its own frame. A mesh stands for its solid.
        link : str
            The link that holds the object.
        pose : (4, 4) array_like, optional
            Link from object. The default is the identity.
        touch : iterable of str
            Links that the object may touch, such as the fingers of the gripper.

        Returns
        -------
        Robot

        Raises
        ------
        InputError
            If a link has the name, or if there is no link with a name in `link` or `touch`.

        Examples
        --------
        >>> import impinge
        >>> robot = impinge.Robot.load("data/robots/gantry.urdf", "data/robots/gantry.srdf")
        >>> rod = impinge.Shape.capsule([0, 0, -0.1], [0, 0, 0.1], 0.01)
        >>> holding = robot.attached("rod", rod, "palm", impinge.pose([0, 0, 0.15]))
        >>> holding.links[-1], holding.joints == robot.joints
        ('rod', True)
        """
        if not isinstance(shape, Mesh | Shape):
            message = f"must be impinge.Shape or impinge.Mesh, not {type(shape).__name__}"
            raise InputError(message, kind="type", what="shape")
        numbers = {known_name: at for at, known_name in enumerate(self.links)}
        names = (touch,) if isinstance(touch, str) else tuple(touch)
        place = known(link, numbers, "link", "link")
        others = [known(other, numbers, "link", "touch") for other in names]
        core = _impinge.robot_attached(self._core, text(name, "name"), shape, place, pose, others)
        return Robot._of((Robot.attached, (self, name, shape, link, pose, names)), core)

    @property
    def name(self) -> str:
        """The name in the URDF file; empty for a robot of parts."""
        return self._core.name

    @cached_property
    def shapes(self) -> dict[str, Shape]:
        """The shape of each link that has one, in the frame of the link."""
        return {
            name: Shape._of("link", self, [at]) for at, (name, is_solid) in enumerate(self._core.links()) if is_solid
        }

    @property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Names of the moving joints of each group of the SRDF file."""
        return {name: tuple(joints) for name, joints in self._core.groups()}

    @property
    def states(self) -> dict[str, dict[str, dict[str, float | list[float]]]]:
        """Named states of the SRDF file: ``states[group][state][joint]`` is a value."""
        states: dict[str, dict[str, dict[str, float | list[float]]]] = {}
        for name, group, values in self._core.states():
            state = {joint: value[0] if len(value) == 1 else value for joint, value in values}
            states.setdefault(group, {})[name] = state
        return states

    @cached_property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Pairs of links that are checked."""
        return tuple((self.links[a], self.links[b]) for a, b in self._core.pairs())

    @property
    def ignored(self) -> dict[tuple[str, str], str]:
        """Pairs of links with shapes that are not checked, each with the reason.

        The reason is ``"rigid"`` (only fixed joints between them), ``"adjacent"`` (a joint between
        them), or ``"disabled: ..."`` with the reason of the SRDF file.
        """
        return {(self.links[a], self.links[b]): reason for (a, b), reason in self._core.ignored()}

    @property
    def warnings(self) -> tuple[str, ...]:
        """Notes on content of the files that was skipped or guessed, or may surprise."""
        return tuple(self._core.warnings())

    def at(self, q: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """Return where the links are.

        Parameters
        ----------
        q : (..., dof) array_like
            Configurations, in radians and meters.

        Returns
        -------
        dict of str to (..., 4, 4) float64 array
            World from link, for each link. The same on every machine.

        Raises
        ------
        InputError
            If `q` has another number of columns, or a value that is NaN, infinite or out of range.
        """
        rows, lead = self._rows(q)
        poses = self._core.poses(rows)
        return {name: poses[:, at].reshape(*lead, 4, 4) for at, name in enumerate(self.links)}

    def __copy__(self) -> Robot:
        """Return the robot itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Robot:
        """Return the robot itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the paths of the files, or the parts."""
        return self._made_of

    def __repr__(self) -> str:
        """Return the name and the numbers of links, coordinates and pairs."""
        counts = f"{len(self.links)} links, {self.dof} coordinates, {len(self._core.pairs())} pairs"
        return f"Robot({self.name!r}, {counts})"
