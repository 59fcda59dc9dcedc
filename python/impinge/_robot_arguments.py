"""Validates arguments of robots: names, clearances and limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge._errors import InputError
from impinge._scalars import real


def text(value: object, what: str) -> str:
    """Return a name, which must be a str."""
    if not isinstance(value, str):
        raise InputError(f"names must be str, not {type(value).__name__}", kind="type", what=what)
    return value


def known(name: Any, names: Mapping[str, Any], noun: str, what: str) -> Any:
    """Return the entry of a name."""
    if not isinstance(name, str) or name not in names:
        message = f"there is no {noun} {name!r}; there are {', '.join(map(repr, names)) or 'none'}"
        raise InputError(message, kind="name", what=what)
    return names[name]


def clearance(value: object, what: str) -> float:
    """Return a distance in meters, which must be finite and at least zero."""
    distance = real(value, what, minimum=0)
    if math.isinf(distance):
        raise InputError("must be finite", kind="non-finite", what=what)
    return distance


def pairs_of(ignored: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return pairs of names as a list."""
    try:
        return [(a, b) for a, b in ignored]
    except (TypeError, ValueError):
        raise InputError("must be pairs of names", kind="type", what="ignored") from None


def check_limits(
    rows: NDArray[np.float64],
    lead: tuple[int, ...],
    joints: tuple[str, ...],
    limits: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> None:
    """Raise an error if a value is beyond the limits of its joint."""
    lower, upper = limits
    beyond = (rows < lower) | (rows > upper)
    if beyond.any():
        row, column = (int(at) for at in np.argwhere(beyond)[0])
        message = f"{rows[row, column]:g} is beyond the limits of {joints[column]}, "
        message += f"{lower[column]:g} to {upper[column]:g}"
        place = tuple(int(at) for at in np.unravel_index(row, lead)) if lead else ()
        raise InputError(message, kind="out-of-range", what="q", where=(*place, column))
