"""Validates single arguments: numbers, flags, options and paths.

Every function raises an `InputError` that names the argument if the value is invalid.
"""

from __future__ import annotations

import math
import os
import reprlib
import sys
from numbers import Integral, Real
from typing import Any

import numpy as np

from impinge._errors import InputError

MAX_COUNT = sys.maxsize
"""Maximum count that the extension accepts; no memory can hold more items."""

_SHOWN_BITS = 128
"""Maximum size in bits of an integer that a message shows. Python refuses to convert integers of
more than a few thousand digits to text."""


def whole(value: object, name: str, *, minimum: int = 0, maximum: int = MAX_COUNT) -> int:
    """Return an integer from `minimum` to `maximum`; NumPy integers are accepted, bool is not."""
    if type(value) is int and minimum <= value <= maximum:
        return value
    number = _unwrapped(value)
    if not isinstance(number, Integral) or isinstance(number, bool):
        raise InputError(f"must be a whole number, not {_shown(value)}", kind="type", what=name)
    count = int(number)
    if not minimum <= count <= maximum:
        kind = "negative" if count < 0 and minimum == 0 else "out-of-range"
        raise InputError(f"must be from {minimum} to {maximum}, not {_shown(count)}", kind=kind, what=name)
    return count


def real(value: object, name: str, *, minimum: float = -math.inf) -> float:
    """Return a float of at least `minimum`, possibly infinite; accepts real numbers except bool."""
    if type(value) is float and value >= minimum:
        return value
    number = _unwrapped(value)
    if not isinstance(number, Real) or isinstance(number, bool):
        raise InputError(f"must be a number, not {_shown(value)}", kind="type", what=name)
    try:
        double = float(number)
    except OverflowError:
        message = f"{_shown(value)} is beyond double precision"
        raise InputError(message, kind="out-of-range", what=name) from None
    if math.isnan(double):
        raise InputError("must be a number, not NaN", kind="non-finite", what=name)
    if double < minimum:
        kind = "negative" if minimum == 0 else "out-of-range"
        raise InputError(f"must be at least {minimum:g}, not {double:g}", kind=kind, what=name)
    return double


def flag(value: object, name: str) -> bool:
    """Return a bool of Python or NumPy as a bool; raise `InputError` for anything else."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"must be True or False, not {_shown(value)}", kind="type", what=name)
    return bool(value)


def chosen(option: Any, known: tuple[Any, ...], name: str) -> Any:
    """Return an option if it is one of the known ones, with the same type."""
    if not any(type(option) is type(own) and option == own for own in known):
        message = f"must be one of {', '.join(map(repr, known))}, not {_shown(option)}"
        raise InputError(message, kind="option", what=name)
    return option


def path_of(value: object, name: str) -> str:
    """Return the path of a file as a str."""
    path = os.fspath(value) if isinstance(value, str | os.PathLike) else None
    if not isinstance(path, str):
        raise InputError(f"must be a str or an os.PathLike of one, not {_shown(value)}", kind="type", what=name)
    return path


def _unwrapped(value: object) -> object:
    """Return the item of a 0-dimensional array; other values unchanged."""
    return value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value


def _shown(value: object) -> str:
    if isinstance(value, int) and value.bit_length() > _SHOWN_BITS:
        return f"a number of {value.bit_length()} bits"
    return reprlib.repr(value)
