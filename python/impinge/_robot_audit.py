"""Which pairs of links can collide at all."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from impinge._robot_arguments import known
from impinge._scalars import path_of

Finding = Literal["adjacent", "proved_never", "witness", "always", "open"]

FINDINGS: tuple[Finding, ...] = ("adjacent", "proved_never", "witness", "always", "open")


class RobotAudit:
    """Findings of `Robot.audit` about pairs of links.

    Attributes
    ----------
    findings : dict of (str, str) to str
        For each pair of links with shapes: ``"adjacent"`` if a joint connects the links, or only
        fixed joints do; ``"proved_never"`` if it is proved that they collide in no configuration;
        ``"witness"`` if they collide in a known configuration, but not in all samples;
        ``"always"`` if they collide in every sample; ``"open"`` if they collide in no sample and
        nothing is proved.
    missed : tuple of (str, str)
        Pairs that collide in some configurations, but that the robot does not check.
    """

    findings: dict[tuple[str, str], Finding]
    missed: tuple[tuple[str, str], ...]

    def __init__(self, answer: Any, links: tuple[str, ...]) -> None:
        pairs, numbers, checked, self._witnesses, self._srdf = answer
        names = [(links[a], links[b]) for a, b in pairs.tolist()]
        self.findings = {pair: FINDINGS[number] for pair, number in zip(names, numbers.tolist(), strict=True)}
        rows = zip(names, checked.tolist(), strict=True)
        self.missed = tuple(pair for pair, known in rows if self.findings[pair] == "witness" and not known)

    def witness(self, a: str, b: str) -> NDArray[np.float64] | None:
        """Return a configuration in which two links collide; None if none is known.

        Parameters
        ----------
        a, b : str
            Names of the links, in any order.

        Raises
        ------
        InputError
            If the audit has no such pair.
        """
        places = {pair: at for at, pair in enumerate(self.findings)}
        both = {f"{x}, {y}": at for (x, y), at in places.items()}
        row = places.get((a, b), places.get((b, a)))
        place = known(f"{a}, {b}", both, "pair", "witness") if row is None else row
        found: NDArray[np.float64] = self._witnesses[place]
        return None if np.isnan(found).any() else found.copy()

    def srdf(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return an SRDF file that disables the pairs that need no check.

        They are the adjacent pairs, those that are proved to collide never, and those that collide
        in every sample. The file has no groups and states.

        Parameters
        ----------
        path : str or os.PathLike, optional
            A file to write it to.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        if path is not None:
            Path(path_of(path, "path")).write_text(self._srdf, encoding="utf-8")
        text: str = self._srdf
        return text

    def __repr__(self) -> str:
        """Return the number of pairs with each finding."""
        found = list(self.findings.values())
        counts = ", ".join(f"{found.count(finding)} {finding}" for finding in FINDINGS)
        return f"RobotAudit({len(found)} pairs: {counts})"
