"""Coordinates of a robot, and the arguments of questions about it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._errors import InputError
from impinge._robot_arguments import clearance, known, pairs_of
from impinge._scene import Scene

Obstacles = list[tuple[str, Any, bool, Any]]


class RobotBase:
    """Links and coordinates of a `Robot`."""

    _core: _impinge.RobotCore

    @cached_property
    def links(self) -> tuple[str, ...]:
        """Names of all links."""
        return tuple(name for name, _ in self._core.links())

    @cached_property
    def joints(self) -> tuple[str, ...]:
        """Names of the coordinates of a configuration, in the order of the joints of the file.

        They are the joints that move, without those that follow another. Planar and floating joints
        have several coordinates, such as ``base/x``.
        """
        return tuple(name for name, _, _ in self._core.coordinates())

    @property
    def dof(self) -> int:
        """Number of coordinates of a configuration."""
        return len(self.joints)

    @property
    def lower(self) -> NDArray[np.float64]:
        """Lower limit of each coordinate, in radians or meters; -inf for no limit."""
        return np.array([lower for _, lower, _ in self._core.coordinates()])

    @property
    def upper(self) -> NDArray[np.float64]:
        """Upper limit of each coordinate, in radians or meters; inf for no limit."""
        return np.array([upper for _, _, upper in self._core.coordinates()])

    def _obstacles(
        self,
        scene: Scene | None,
        poses: Mapping[str, ArrayLike] | None,
        ignored: Iterable[tuple[str, str]],
    ) -> tuple[Obstacles, list[tuple[int, int]]]:
        """Return the parts of a scene, and pairs of indices of links and parts to ignore."""
        if scene is not None and not isinstance(scene, Scene):
            raise InputError(f"must be impinge.Scene, not {type(scene).__name__}", kind="type", what="scene")
        parts = {} if scene is None else scene.parts
        places = {} if poses is None else poses
        if not isinstance(places, Mapping):
            raise InputError(f"must be a mapping, not {type(places).__name__}", kind="type", what="poses")
        for name in places:
            known(name, parts, "part", "poses")
        solid = scene is not None and scene._solid
        own = {} if scene is None else scene._poses
        placed = {**own, **{name: pose for name, pose in places.items() if pose is not None}}
        obstacles = [(name, part, solid, placed.get(name)) for name, part in parts.items()]
        numbers = {name: at for at, name in enumerate(parts)}
        links = {name: at for at, name in enumerate(self.links)}
        pairs = pairs_of(ignored)
        skipped = [(known(a, links, "link", "ignored"), known(b, numbers, "part", "ignored")) for a, b in pairs]
        return obstacles, skipped

    def _names(self, obstacles: Obstacles) -> tuple[str, ...]:
        """Return the names of the links and of the parts of a scene."""
        return (*self.links, *(name for name, *_ in obstacles))

    def _rows(self, q: ArrayLike, what: str = "q") -> tuple[NDArray[np.float64], tuple[int, ...]]:
        """Return configurations as rows, and their leading axes."""
        try:
            values = np.asarray(q, np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"must be numbers ({error})", kind="type", what=what) from None
        if values.ndim == 0 or values.shape[-1] != self.dof:
            message = f"must have {self.dof} columns, {', '.join(self.joints)}; the shape is {values.shape}"
            raise InputError(message, kind="shape", what=what)
        lead = values.shape[:-1]
        return np.ascontiguousarray(values.reshape(-1, self.dof) if self.dof else values.reshape(-1)), lead

    def _paddings(self, padding: float | Mapping[str, float]) -> list[float]:
        """Return the padding of each link."""
        if not isinstance(padding, Mapping):
            return [clearance(padding, "padding")] * len(self.links)
        others = clearance(padding.get("*", 0.0), "padding")
        paddings = [others] * len(self.links)
        links = {name: at for at, name in enumerate(self.links)}
        for name, distance in padding.items():
            if name != "*":
                paddings[known(name, links, "link", "padding")] = clearance(distance, "padding")
        return paddings
