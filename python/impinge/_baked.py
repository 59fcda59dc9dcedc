"""Opens baked meshes in memory, and decides which buffers they may use in place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from impinge import _impinge

if TYPE_CHECKING:
    from typing_extensions import Buffer


def opened(baked: Buffer) -> _impinge.Model:
    """Return the content of a baked mesh in a buffer of bytes; see `Mesh.from_baked`."""
    view = memoryview(baked)
    view = view if (view.format, view.ndim) == ("B", 1) else view.cast("B")
    return _impinge.Model.of_baked(view, is_constant(view))


def is_constant(view: memoryview) -> bool:
    """Report whether neither the buffer nor an object that it is a view of can be written.

    A read-only view of a ``bytearray`` is not constant, but a view of ``bytes`` is, and so is an
    array in Ray's object store. An array that owns its memory can be made writable again.
    """
    owner: object = view
    while isinstance(owner, memoryview | np.ndarray):
        is_read_only = owner.readonly if isinstance(owner, memoryview) else not owner.flags.writeable
        if not is_read_only:
            return False
        owner = owner.obj if isinstance(owner, memoryview) else owner.base
    if owner is None:
        return False
    try:
        with memoryview(owner) as whole:  # type: ignore[arg-type]
            return whole.readonly
    except TypeError:  # the owner has no buffer, so nothing is known about it
        return False
