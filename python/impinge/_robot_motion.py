"""Verdicts about motions of a robot, and clearances of its configurations."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._errors import InputError

VERDICTS = ("free", "collides", "undecided")

Verdict = Literal["free", "collides", "undecided"]


class RobotMotion:
    """Verdicts of `Robot.check_motion` and `Robot.check_path`. Times go from 0 to 1.

    Attributes
    ----------
    verdict : str or (...) str array
        ``"free"`` if it is proved that nothing collides at any time; ``"collides"`` if a
        configuration of the motion collides; ``"undecided"`` if neither was proved, because shapes
        touch to within rounding, or because `max_steps` was reached.
    t_free : float or (...) float64 array
        The motion is proved free before this time; 1 if it is free.
    t_hit : float or (...) float64 array
        A time at which the robot collides, NaN without one. If nothing before it is undecided, the
        first contact is between `t_free` and `t_hit`, which differ by less than 1e-10.
    q_hit : (..., dof) float64 array
        The configuration at that time.
    """

    verdict: Any
    t_free: Any
    t_hit: Any
    q_hit: NDArray[np.float64]

    def __init__(
        self,
        answer: Any,
        shape: tuple[int, ...],
        names: tuple[str, ...],
        question: tuple[Any, ...],
        *,
        has_certificate: bool,
    ) -> None:
        (verdicts, times, self._pairs, hits), self._certificates = answer
        self._shape, self._names, self._question, self._has_certificate = shape, names, question, has_certificate
        self.verdict = self._shaped(np.array(VERDICTS)[verdicts])
        self.t_free, self.t_hit = self._shaped(times[:, 0]), self._shaped(times[:, 1])
        self.q_hit = hits.reshape(*shape, hits.shape[1])

    @property
    def pair(self) -> Any:
        """For each motion, the names of a pair that collides at `t_hit`; None without one."""
        return _named(self._pairs, self._names, self._shape)

    @property
    def certificate(self) -> Any:
        """For each free motion the rows of its proof; None if certificates were not kept.

        A structured array of the names `link` and `other`, and the numbers `time` and `half`: the
        pair keeps its clearance in the interval of this half length about the time. An empty
        `other` stands for all obstacles.
        """
        if not self._has_certificate:
            return None
        offsets, subjects, intervals = self._certificates
        names = np.array((*self._names, ""))
        rows = np.empty(len(subjects), [("link", names.dtype), ("other", names.dtype), ("time", "f8"), ("half", "f8")])
        rows["link"], rows["other"] = names[subjects].T if len(subjects) else ((), ())
        rows["time"], rows["half"] = intervals.T
        each = np.empty(len(offsets) - 1, object)
        for at, (start, end) in enumerate(zip(offsets[:-1].tolist(), offsets[1:].tolist(), strict=True)):
            each[at] = rows[start:end]
        return each.reshape(self._shape) if self._shape else each[0]

    def verify(self, certificate: Any = None) -> bool:
        """Verify the certificate of a single motion again, by the distances of its shapes.

        Parameters
        ----------
        certificate : structured array, optional
            Rows as in `certificate`, which are the default.

        Returns
        -------
        bool
            Whether the rows prove that the motion is free. `flaw` is the reason why not.
        """
        return self.flaw(certificate) is None

    def flaw(self, certificate: Any = None) -> str | None:
        """Return why a certificate of a single motion proves nothing; None if it proves it free."""
        if self._shape:
            hint = "call check_motion for one motion"
            raise InputError("only a single motion can be verified", kind="shape", what="verify", hint=hint)
        rows = self.certificate if certificate is None else certificate
        if rows is None:
            hint = "call check_motion with certificate=True"
            raise InputError("there is no certificate", kind="option", what="certificate", hint=hint)
        number = {name: at for at, name in enumerate(self._names)} | {"": -1}
        subjects = [[number.get(str(row["link"]), -1), number.get(str(row["other"]), -1)] for row in rows]
        intervals = np.column_stack([rows["time"], rows["half"]])
        table = np.array(subjects, np.int64).reshape(-1, 2), np.ascontiguousarray(intervals, np.float64)
        robot, ends, surroundings = self._question
        return _impinge.robot_verify(robot._core, ends, surroundings, *table)

    def path(self) -> tuple[Verdict, float, float]:
        """Return the verdict about all legs of a path together, and two times along it.

        Leg i lasts from time i to i + 1. The path is proved free before the first time, and
        collides at the second, which is NaN without a collision.
        """
        verdicts = np.atleast_1d(self.verdict)
        if verdicts.ndim != 1:
            raise InputError("a path has one axis of legs", kind="shape", what="path")
        times = np.atleast_1d(self.t_free), np.atleast_1d(self.t_hit)
        stuck = np.flatnonzero(verdicts != "free")
        hits = np.flatnonzero(verdicts == "collides")
        free = float(stuck[0] + times[0][stuck[0]]) if len(stuck) else float(len(verdicts))
        if len(hits):
            return "collides", free, float(hits[0] + times[1][hits[0]])
        return ("undecided" if len(stuck) else "free"), free, float("nan")

    def _shaped(self, values: NDArray[Any]) -> Any:
        return values.reshape(self._shape) if self._shape else values[0].item()

    def __repr__(self) -> str:
        """Return the number of motions with each verdict."""
        verdicts = np.asarray(self.verdict)
        counts = ", ".join(f"{int((verdicts == verdict).sum())} {verdict}" for verdict in VERDICTS)
        return f"RobotMotion({verdicts.size} motions: {counts})"


class RobotClearance:
    """Clearances of `Robot.clearance`: distances of the nearest pairs, in meters.

    Attributes
    ----------
    lower, upper : float or (...) float64 array
        Proved bounds of each clearance. Both are zero if the configuration collides. If all pairs
        are farther apart than the limit, they are the limit and infinity.
    undecided : bool or (...) bool array
        Whether it is undecided that a pair collides; `lower` is zero then.
    points : (..., 2, 3) float64 array
        Nearest points of the pairs in the world. NaN without a pair, or if one shape is inside the
        other.
    """

    lower: Any
    upper: Any
    undecided: Any
    points: NDArray[np.float64]

    def __init__(self, answer: Any, shape: tuple[int, ...], names: tuple[str, ...]) -> None:
        bounds, self._pairs, points, undecided = answer
        self._shape, self._names = shape, names
        self.lower, self.upper = self._shaped(bounds[:, 0]), self._shaped(bounds[:, 1])
        self.undecided = self._shaped(undecided)
        self.points = points.reshape(*shape, 2, 3)

    @property
    def pair(self) -> Any:
        """For each configuration, the names of the nearest pair; None beyond the limit."""
        return _named(self._pairs, self._names, self._shape)

    def _shaped(self, values: NDArray[Any]) -> Any:
        return values.reshape(self._shape) if self._shape else values[0].item()

    def __repr__(self) -> str:
        """Return the number of configurations and the smallest clearance."""
        upper = np.asarray(self.upper)
        least = f", at least {np.asarray(self.lower).min():g} m" if upper.size else ""
        return f"RobotClearance({upper.size} configurations{least})"


def _named(pairs: NDArray[np.int64], names: tuple[str, ...], shape: tuple[int, ...]) -> Any:
    """Return the names of pairs of indices, or None for those that are negative."""
    named = np.empty(len(pairs), object)
    for row, (a, b) in enumerate(pairs.tolist()):
        named[row] = None if a < 0 else (names[a], names[b])
    return named.reshape(shape) if shape else named[0]
