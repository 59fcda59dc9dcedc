"""Questions about the configurations and motions of a robot."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from impinge import _impinge
from impinge._engine import engine
from impinge._errors import InputError
from impinge._picture import Picture, angles_of, png_path, size_of
from impinge._robot_arguments import check_limits, clearance
from impinge._robot_audit import RobotAudit
from impinge._robot_base import RobotBase
from impinge._robot_motion import RobotClearance, RobotMotion
from impinge._robot_report import RobotReport
from impinge._scalars import chosen, real, whole
from impinge._scene import Scene

if TYPE_CHECKING:
    from impinge.cluster import Cluster


class RobotQueries(RobotBase):
    """The questions that `Robot` answers."""

    def check(
        self,
        q: ArrayLike,
        scene: Scene | None = None,
        *,
        poses: Mapping[str, ArrayLike] | None = None,
        stop: Literal["first", "all"] = "first",
        padding: float | Mapping[str, float] = 0.0,
        self_padding: float = 0.0,
        ignored: Iterable[tuple[str, str]] = (),
        on_limits: Literal["ignore", "raise"] = "ignore",
        progress: bool = False,
        on: Cluster | None = None,
    ) -> RobotReport:
        """Check which configurations collide: links with each other, and with a scene.

        A pair of links collides exactly if `impinge.intersects` says so for their `shapes` at the
        poses of `at`.

        Parameters
        ----------
        q : (..., dof) array_like
            Configurations, in radians and meters, one value for each of `joints`.
        scene : Scene, optional
            Obstacles. Pairs of two obstacles are not checked.
        poses : mapping of str to (4, 4) array_like, optional
            World from part, for parts of the scene. Other parts have their poses in the scene.
        stop : {"first", "all"}
            Whether a configuration is finished at the first pair found, or all pairs are checked.
        padding : float or mapping of str to float
            Distance in meters that links must keep from obstacles: for all links, or for each link
            by its name, where ``"*"`` stands for all others.
        self_padding : float
            Distance in meters that links must keep from each other.
        ignored : iterable of (str, str), optional
            Pairs of a link and a part of the scene that are not checked, such as the base and the
            floor that it stands on.
        on_limits : {"ignore", "raise"}
            Whether a value beyond the limits of its joint is an error.
        progress : bool
            As for `impinge.intersects`.
        on : impinge.cluster.Cluster, optional
            A cluster that answers instead of this process: the configurations are divided. A robot
            that was loaded is loaded on each node, from the same paths. The report is the same.

        Returns
        -------
        RobotReport
            The report is the same for any number of threads.

        Raises
        ------
        InputError
            As for `at`; if a name is unknown, or if a distance is negative.
        """
        rows, lead = self._rows(q)
        chosen(stop, ("first", "all"), "stop")
        chosen(on_limits, ("ignore", "raise"), "on_limits")
        if on_limits == "raise":
            check_limits(rows, lead, self.joints, (self.lower, self.upper))
        clearances = clearance(self_padding, "self_padding"), self._paddings(padding)
        obstacles, skipped = self._obstacles(scene, poses, ignored)
        answer = self._ask(on, "robot_check", rows, stop == "first", clearances, obstacles, skipped, progress)
        return RobotReport(answer, lead, self._names(obstacles), stopped_at_first=stop == "first")

    def _ask(self, on: Cluster | None, function: str, *arguments: Any) -> Any:
        """Return the answer of a function of the extension or of a cluster."""
        return getattr(engine(on), function)(self._core if on is None else self, *arguments)

    def clearance(
        self,
        q: ArrayLike,
        scene: Scene | None = None,
        *,
        limit: float | None = None,
        poses: Mapping[str, ArrayLike] | None = None,
        ignored: Iterable[tuple[str, str]] = (),
        progress: bool = False,
        on: Cluster | None = None,
    ) -> RobotClearance:
        """Return how far each configuration is from a collision.

        The clearance is the distance of the nearest pair that `check` checks.

        Parameters
        ----------
        q : (..., dof) array_like
            Configurations, in radians and meters.
        scene : Scene, optional
            As for `check`, as are `poses`, `ignored`, `progress` and `on`.
        limit : float, optional
            Distance in meters beyond which clearances do not matter. With a limit the call is
            faster.

        Returns
        -------
        RobotClearance
            The bounds of each clearance, the nearest pair, and its nearest points.

        Raises
        ------
        InputError
            As for `check`; if the limit is negative.
        """
        rows, lead = self._rows(q)
        farthest = np.inf if limit is None else real(limit, "limit", minimum=0)
        obstacles, skipped = self._obstacles(scene, poses, ignored)
        answer = self._ask(on, "robot_clearance", rows, farthest, obstacles, skipped, progress)
        return RobotClearance(answer, lead, self._names(obstacles))

    def check_motion(
        self,
        q0: ArrayLike,
        q1: ArrayLike,
        scene: Scene | None = None,
        *,
        clearance: float = 0.0,
        poses: Mapping[str, ArrayLike] | None = None,
        ignored: Iterable[tuple[str, str]] = (),
        certificate: bool = False,
        max_steps: int = 1 << 17,
        progress: bool = False,
        on: Cluster | None = None,
    ) -> RobotMotion:
        """Prove that straight motions between configurations are free, or find the first contact.

        At time t, from 0 to 1, the robot is at ``(1 - t) * q0 + t * q1``. No verdict is by
        sampling: bounds on how far each link moves prove whole intervals of the motion free.

        Parameters
        ----------
        q0, q1 : (..., dof) array_like
            Starts and ends of motions, in radians and meters. Leading axes broadcast.
        scene : Scene, optional
            As for `check`, as are `poses`, `ignored`, `progress` and `on`.
        clearance : float
            Distance in meters that links must keep from each other and from obstacles.
        certificate : bool
            Whether to keep the proofs of free motions, which `RobotMotion.verify` verifies.
        max_steps : int
            Maximum number of configurations that are examined for a motion. A motion that needs
            more is undecided.

        Returns
        -------
        RobotMotion
            The verdict about each motion, and the times of first contacts.

        Raises
        ------
        InputError
            As for `check`.
        """
        (starts, _), (ends, _) = self._rows(q0, "q0"), self._rows(q1, "q1")
        leads = [np.shape(q)[:-1] for q in (q0, q1)]
        try:
            lead = np.broadcast_shapes(*leads)
        except ValueError:
            message = f"the leading axes {leads[1]} do not broadcast with {leads[0]}"
            raise InputError(message, kind="shape", what="q1") from None
        pair = [
            np.ascontiguousarray(np.broadcast_to(rows.reshape(*own, self.dof), (*lead, self.dof))).reshape(rows_shape)
            for rows, own in zip((starts, ends), leads, strict=True)
            for rows_shape in [(-1, self.dof) if self.dof else (-1,)]
        ]
        obstacles, skipped = self._obstacles(scene, poses, ignored)
        distance = real(clearance, "clearance", minimum=0)
        surroundings = ((distance, [distance] * len(self.links)), obstacles, skipped)
        both = (pair[0], pair[1])
        options = whole(max_steps, "max_steps"), bool(certificate), progress
        answer = self._ask(on, "robot_motions", both, surroundings, *options)
        question = (self, both, surroundings)
        return RobotMotion(answer, lead, self._names(obstacles), question, has_certificate=bool(certificate))

    def check_path(
        self,
        waypoints: ArrayLike,
        scene: Scene | None = None,
        *,
        clearance: float = 0.0,
        poses: Mapping[str, ArrayLike] | None = None,
        ignored: Iterable[tuple[str, str]] = (),
        certificate: bool = False,
        max_steps: int = 1 << 17,
        progress: bool = False,
        on: Cluster | None = None,
    ) -> RobotMotion:
        """Prove that the straight legs between consecutive waypoints are free, as `check_motion`.

        Parameters
        ----------
        waypoints : (n, dof) array_like
            Configurations on the path, at least two.
        scene, clearance, poses, ignored, certificate, max_steps, progress, on
            As for `check_motion`.

        Returns
        -------
        RobotMotion
            The verdict about each leg, with one axis of n - 1 legs; `RobotMotion.path` joins them.

        Raises
        ------
        InputError
            As for `check_motion`.
        """
        rows, lead = self._rows(waypoints, "waypoints")
        if len(lead) != 1 or lead[0] < 2:
            message = f"must be at least two rows of {self.dof} columns; the shape is {np.shape(waypoints)}"
            raise InputError(message, kind="shape", what="waypoints")
        rows = rows.reshape(*lead, self.dof)
        return self.check_motion(
            rows[:-1],
            rows[1:],
            scene,
            clearance=clearance,
            poses=poses,
            ignored=ignored,
            certificate=certificate,
            max_steps=max_steps,
            progress=progress,
            on=on,
        )

    def picture(
        self,
        q: ArrayLike,
        scene: Scene | None = None,
        *,
        poses: Mapping[str, ArrayLike] | None = None,
        path: str | os.PathLike[str] | None = None,
        size: tuple[int, int] = (960, 720),
        view: tuple[float, float] = (-35.0, 25.0),
        up: Literal["x", "y", "z"] = "z",
    ) -> Picture:
        """Render one configuration: what collides in colors, and all else as ghosts.

        If nothing collides, the links are solid and gray. No window is opened, and no display is
        needed. A notebook shows the returned picture. Half-spaces are not drawn.

        Parameters
        ----------
        q : (dof,) array_like
            The configuration, in radians and meters.
        scene : Scene, optional
            As for `check`, as are `poses`.
        path : str or os.PathLike, optional
            A PNG file to write the picture to.
        size, view, up
            As for `impinge.show`.

        Returns
        -------
        Picture
            The picture.

        Raises
        ------
        InputError
            As for `check` and `impinge.show`.
        OSError
            If the file cannot be written.
        """
        options = size_of(size), angles_of(view), chosen(up, ("x", "y", "z"), "up")
        if path is not None:
            png_path(path)
        rows, lead = self._rows(q)
        if lead:
            raise InputError("a picture shows one configuration", kind="shape", what="q")
        obstacles, _ = self._obstacles(scene, poses, ())
        picture = Picture(_impinge.picture_of_robot(self._core, rows, obstacles, options))
        if path is not None:
            picture.save(path)
        return picture

    def audit(
        self, samples: int = 10_000, seed: int = 0, *, max_boxes: int = 1 << 12, progress: bool = False
    ) -> RobotAudit:
        """Find the pairs of links that never collide, by proof, and those that do.

        Random configurations within the limits of the joints are checked, for all pairs of links,
        whether the robot checks them or not. For each pair that never collides there, boxes of
        configurations are examined and halved, until bounds on how far the links move prove that
        none collides.

        Parameters
        ----------
        samples : int
            Number of random configurations.
        seed : int
            Start of the random numbers, which are the same on every machine.
        max_boxes : int
            Maximum number of boxes of configurations that are examined for each pair.
        progress : bool
            As for `impinge.intersects`.

        Returns
        -------
        RobotAudit
            The finding about each pair, and an SRDF file that disables those that need no check.

        Raises
        ------
        InputError
            If an option is invalid, or if a limit of a joint is too large.

        Examples
        --------
        >>> import impinge
        >>> robot = impinge.Robot.load("data/robots/gantry.urdf", "data/robots/gantry.srdf")
        >>> audit = robot.audit(1000)
        >>> audit.findings["base", "carriage"]
        'adjacent'
        """
        numbers = whole(samples, "samples"), whole(seed, "seed"), whole(max_boxes, "max_boxes")
        return RobotAudit(_impinge.robot_audit(self._core, *numbers, progress), self.links)
