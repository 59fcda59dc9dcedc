"""Handles of bodies as they come, and what comes with them: a number or a pose for each, layers as bits."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays
from impinge._errors import InputError
from impinge._scalars import whole

Handles: TypeAlias = NDArray[np.uint64]
"""Handles, one a row."""

ALL_LAYERS = 0xFFFF_FFFF
"""All 32 layers, as bits."""

MOST_NUMBER = 2**64 - 1
"""The greatest handle, owner or tag."""


def handle(body: int) -> int:
    """Return the one handle that an argument is."""
    handles, lead = handles_of(body, "body")
    if lead:
        raise InputError(f"shape {lead}, where one handle is expected", kind="shape", what="body")
    return int(handles[0])


def handles_of(bodies: ArrayLike, name: str = "bodies") -> tuple[Handles, tuple[int, ...]]:
    """Return handles in one row, and the axes that they came in."""
    array = _arrays.plain_numbers(bodies, name, MOST_NUMBER)
    return array.reshape(-1), array.shape


def numbers_of(values: ArrayLike, name: str, lead: tuple[int, ...]) -> Handles:
    """Return a number for each of some bodies."""
    numbers, shape = handles_of(values, name)
    try:
        return np.ascontiguousarray(np.broadcast_to(numbers.reshape(shape), lead)).reshape(-1)
    except ValueError:
        message = f"leading axes {shape} do not broadcast with {lead}, those of the bodies"
        raise InputError(message, kind="shape", what=name) from None


def poses_of(poses: ArrayLike | None, lead: tuple[int, ...]) -> NDArray[np.float64]:
    """Return (n, 4, 4) poses, one for each of the bodies."""
    plain = np.zeros((0, 4, 4)) if poses is None else _arrays.plain_poses(poses, "poses")
    try:
        spread = np.broadcast_to(plain, (*lead, 4, 4))
    except ValueError:
        message = f"leading axes {plain.shape[:-2]} do not broadcast with {lead}, those of bodies"
        raise InputError(message, kind="shape", what="poses") from None
    return np.ascontiguousarray(spread).reshape(-1, 4, 4)


def mask(layers: int, name: str) -> int:
    """Return layers as 32 bits."""
    return whole(layers, name, most=ALL_LAYERS)
