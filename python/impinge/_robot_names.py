"""Names of links and parts in the arguments of robots."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

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
