"""How many threads a call may use."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from impinge import _impinge
from impinge._scalars import whole

_MOST = 1024

asked: ContextVar[int | None] = ContextVar("impinge_threads", default=None)
"""The number that `threads` asks for; the extension reads it."""


@contextmanager
def threads(n: int) -> Iterator[None]:
    """Limit the threads of the calls within a ``with`` block.

    Without it, a call uses all processors that the process may run on. No answer depends on it. The limit is that of
    the block's own thread or task: others are not affected.

    Parameters
    ----------
    n : int
        The number of threads, 1 to 1024.

    Raises
    ------
    InputError
        If `n` is no whole number, or out of range.

    Examples
    --------
    >>> import impinge
    >>> triangle = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> with impinge.threads(1):
    ...     impinge.intersects(triangle, triangle)
    True
    """
    token = asked.set(whole(n, "n", least=1, most=_MOST))
    try:
        yield
    finally:
        asked.reset(token)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_impinge.after_fork)
