"""Limits the time and the memory that calls may use."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from impinge import _impinge
from impinge._scalars import real

asked: ContextVar[_impinge.Limits | None] = ContextVar("impinge_limits", default=None)
"""Limits that `limit` sets; the extension reads it."""


@contextmanager
def limit(*, seconds: float | None = None, gigabytes: float | None = None) -> Iterator[None]:
    """Limit the time and the memory that calls within a ``with`` block use.

    Once a limit is reached, a call ends and raises an error. A call about two things with
    ``on_error="status"`` returns the rows that are complete, and marks the others with
    `Status.OUT_OF_BUDGET`. Such a row has the safe answer that the function describes.

    The limits apply to the thread or task that enters the block. A block inside another one cannot
    allow more than the outer block.

    Parameters
    ----------
    seconds : float, optional
        Time that all calls in the block may take together, from the start of the block. None means
        no limit.
    gigabytes : float, optional
        Memory, in units of 10^9 bytes, that the answer of each call may take, such as a list of
        pairs. Memory that grows with the size of the input alone does not count. None means no
        limit.

    Raises
    ------
    TimeoutError
        By a call in the block, if the time is over.
    MemoryError
        By a call in the block, if its answer needs more memory.
    InputError
        If a limit is negative or not a number.

    Examples
    --------
    >>> import impinge
    >>> pile = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]] * 3000)
    >>> with impinge.limit(seconds=60, gigabytes=0.01):
    ...     try:
    ...         impinge.intersecting_pairs(pile, pile)
    ...     except MemoryError:
    ...         print("nine million pairs need 0.07 gigabytes")
    nine million pairs need 0.07 gigabytes
    """
    time = None if seconds is None else real(seconds, "seconds", minimum=0)
    memory = None if gigabytes is None else real(gigabytes, "gigabytes", minimum=0)
    token = asked.set(_impinge.Limits(time, memory, asked.get()))
    try:
        yield
    finally:
        asked.reset(token)
