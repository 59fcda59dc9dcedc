"""Reads handles of bodies, and the numbers, poses and layers that belong to them."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _arrays
from impinge._errors import InputError
from impinge._scalars import whole

Handles: TypeAlias = NDArray[np.uint64]
"""Handles of bodies in a flat array."""

ALL_LAYERS = 0xFFFF_FFFF
"""Bit mask of all 32 layers."""

MAX_NUMBER = 2**64 - 1
"""Maximum value of a handle, an owner, a surface or a tag."""


def handle(body: int) -> int:
    """Return a single handle as an int. Raise an `InputError` unless it is an integer of 64 bits.

    Whether the body exists is not checked.
    """
    handles, lead = handles_of(body, "body")
    if lead:
        raise InputError(f"has shape {lead}; a single handle is expected", kind="shape", what="body")
    return int(handles[0])


def handles_of(bodies: ArrayLike, name: str = "bodies") -> tuple[Handles, tuple[int, ...]]:
    """Return handles as a flat array, and their original shape.

    Raise an `InputError` unless all are integers of 64 bits. Whether the bodies exist is not
    checked.
    """
    array = _arrays.plain_numbers(bodies, name, MAX_NUMBER)
    return array.reshape(-1), array.shape


def numbers_of(values: ArrayLike, name: str, lead: tuple[int, ...]) -> Handles:
    """Return an owner or a tag for each body, flat, broadcast to the shape `lead` of the bodies.

    Raise an `InputError` if a value is not an integer from 0 to 2^64 - 1, or does not broadcast.
    """
    numbers, shape = handles_of(values, name)
    try:
        return np.ascontiguousarray(np.broadcast_to(numbers.reshape(shape), lead)).reshape(-1)
    except ValueError:
        message = f"leading axes {shape} do not broadcast with {lead}, the shape of the bodies"
        raise InputError(message, kind="shape", what=name) from None


def poses_of(poses: ArrayLike | None, lead: tuple[int, ...]) -> NDArray[np.float64]:
    """Return a pose for each body, (n, 4, 4), broadcast to the shape `lead` of the bodies.

    None is accepted only if there are no bodies. Raise an `InputError` if the type or the shape is
    wrong; the values are not checked.
    """
    plain = np.zeros((0, 4, 4)) if poses is None else _arrays.plain_poses(poses, "poses")
    try:
        spread = np.broadcast_to(plain, (*lead, 4, 4))
    except ValueError:
        message = f"leading axes {plain.shape[:-2]} do not broadcast with {lead}, the shape of bodies"
        raise InputError(message, kind="shape", what="poses") from None
    return np.ascontiguousarray(spread).reshape(-1, 4, 4)


def mask(layers: int, name: str) -> int:
    """Return a bit mask of layers as an int. Raise an `InputError` if it exceeds 32 bits."""
    return whole(layers, name, maximum=ALL_LAYERS)


def surface_of(surface: int | None) -> int | None:
    """Return the key of a surface or None. Raise an `InputError` if it exceeds 64 bits."""
    return None if surface is None else whole(surface, "surface", maximum=MAX_NUMBER)
