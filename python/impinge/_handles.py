"""Handles of bodies as they come, and what comes with them: a number or a pose for each, layers as bits."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays
from impinge._errors import InputError

Handles: TypeAlias = NDArray[np.uint64]
"""Handles, one a row."""

ALL_LAYERS = 0xFFFF_FFFF
"""All 32 layers, as bits."""


def handle(body: int) -> int:
    """Return the one handle that an argument is."""
    handles, lead = handles_of(body, "body")
    if lead:
        raise InputError(f"shape {lead}, where one handle is expected", kind="shape", what="body")
    return int(handles[0])


def handles_of(bodies: ArrayLike, name: str = "bodies") -> tuple[Handles, tuple[int, ...]]:
    """Return handles in one row, and the axes that they came in."""
    array = np.asarray(bodies)
    if array.size == 0:
        return np.zeros(0, np.uint64), array.shape
    if array.dtype.kind not in "iu" or (array < 0).any():
        wanted = "handles are expected: integers that insert() returned"
        if name not in ("body", "bodies"):
            wanted = "integers from 0 to 2^64 - 1 are expected"
        message = f"dtype {array.dtype}, where {wanted}" if array.dtype.kind not in "iu" else f"where {wanted}"
        raise InputError(message, kind="dtype", what=name)
    return np.ascontiguousarray(array.reshape(-1).astype(np.uint64)), array.shape


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
    bits = int(layers)
    if not 0 <= bits <= ALL_LAYERS:
        raise InputError(f"{bits} is not made of 32 bits", kind="out-of-range", what=name)
    return bits
