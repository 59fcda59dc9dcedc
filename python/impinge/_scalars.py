"""Single values as they come, made plain: numbers, yes or no, options, paths. What is none is an `InputError`."""

from __future__ import annotations

import math
import os
import reprlib
import sys
from numbers import Integral, Real
from typing import Any

import numpy as np

from impinge._errors import InputError

MOST = sys.maxsize
"""The greatest count that the extension takes: so many things are in no memory."""

_SHOWN_BITS = 128
"""Longer numbers are told by their length: Python writes none of more than some thousand digits."""


def whole(value: object, name: str, *, least: int = 0, most: int = MOST) -> int:
    """Return a whole number from `least` to `most`: an int, or an integer of NumPy's, but no bool."""
    number = _unwrapped(value)
    if not isinstance(number, Integral) or isinstance(number, bool):
        raise InputError(f"must be a whole number, not {_shown(value)}", kind="type", what=name)
    count = int(number)
    if not least <= count <= most:
        kind = "negative" if count < 0 and least == 0 else "out-of-range"
        raise InputError(f"must be from {least} to {most}, not {_shown(count)}", kind=kind, what=name)
    return count


def real(value: object, name: str, *, least: float = -math.inf) -> float:
    """Return a number of at least `least`, which may be infinite: a float, an int, or one of NumPy's, but no bool."""
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
    if double < least:
        kind = "negative" if least == 0 else "out-of-range"
        raise InputError(f"must be at least {least:g}, not {double:g}", kind=kind, what=name)
    return double


def flag(value: object, name: str) -> bool:
    """Return True or False, which NumPy's may be, too."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"must be True or False, not {_shown(value)}", kind="type", what=name)
    return bool(value)


def chosen(option: Any, known: tuple[Any, ...], name: str) -> Any:
    """Return an option that is one of those that are known, to the type."""
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
    """Return what an array without axes holds."""
    return value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value


def _shown(value: object) -> str:
    if isinstance(value, int) and value.bit_length() > _SHOWN_BITS:
        return f"a number of {value.bit_length()} bits"
    return reprlib.repr(value)
