"""Limits the number of threads that a call may use."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from impinge import _impinge
from impinge._scalars import whole

_MAX_THREADS = 1024

asked: ContextVar[int | None] = ContextVar("impinge_threads", default=None)
"""Number of threads that `threads` sets; the extension reads it."""


@contextmanager
def threads(n: int) -> Iterator[None]:
    """Limit the number of threads that calls within a ``with`` block use.

    Without a limit, a call uses all processors available to the process. The number of threads
    affects no answer. The limit applies to the thread or task that enters the block; other threads
    are not affected.

    Parameters
    ----------
    n : int
        Number of threads, from 1 to 1024.

    Raises
    ------
    InputError
        If `n` is not an integer, or out of range.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> with impinge.threads(1):
    ...     impinge.intersects(triangle, triangle)
    True
    """
    token = asked.set(whole(n, "n", minimum=1, maximum=_MAX_THREADS))
    try:
        yield
    finally:
        asked.reset(token)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_impinge.after_fork)
