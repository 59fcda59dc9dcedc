"""Errors, warnings and the status of rows: what is wrong with an input, and where."""

from __future__ import annotations

from enum import IntEnum


class InputError(ValueError):
    """Raised if an argument or a file is invalid.

    The message says what is wrong, where, and, if known, what to do.

    Attributes
    ----------
    kind : str
        Short stable name: ``"type"``, ``"dtype"``, ``"shape"``, ``"option"``, ``"name"``,
        ``"unit"``, ``"non-finite"``, ``"out-of-range"``, ``"index-out-of-bounds"``, ``"too-many"``,
        ``"not-affine"``, ``"singular"``, ``"not-rigid"``, ``"not-unit-quaternion"``,
        ``"zero-direction"``, ``"zero-axis"``, ``"negative"``, ``"not-roundable"``, ``"order"``,
        ``"stale"``, ``"static"``, ``"empty"``, ``"unknown-key"``, ``"state"``, ``"changed"`` or
        ``"input"``. For files also the kinds in the JSON output of the command, such as
        ``"syntax"``.
    what : str
        Name of the invalid argument, such as ``"vertices"`` or ``"pose_b"``, or the path of the
        file.
    where : tuple of int, str or None
        Index into the argument: ``(row, 0, 3)`` in an array of poses, ``(vertex,)`` or ``(face,)``;
        empty if the whole argument is invalid. For a file the line, byte or entry, or None.
    hint : str or None
        How to fix the input, if known.

    Examples
    --------
    >>> import impinge
    >>> try:
    ...     impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])
    ... except impinge.InputError as error:
    ...     print(error)
    ...     print(error.kind, error.what, error.where)
    faces[0]: face 0 names vertex 3, but there are 3 vertices
    index-out-of-bounds faces (0,)
    """

    kind: str
    what: str
    where: tuple[int, ...] | str | None
    hint: str | None

    def __init__(
        self,
        message: str,
        *,
        kind: str = "input",
        what: str = "",
        where: tuple[int, ...] | str | None = (),
        hint: str | None = None,
    ) -> None:
        self._message = message
        self.kind, self.what, self.where, self.hint = kind, what, where, hint
        place = what
        if isinstance(where, str):
            place += f", {where}"
        elif where:
            place += f"[{', '.join(map(str, where))}]"
        super().__init__((f"{place}: " if place else "") + message + (f" ({hint})" if hint else ""))

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle with all attributes, so that worker processes can pass their errors on."""
        return _restored, (self._message, self.kind, self.what, self.where, self.hint)


def _restored(message: str, kind: str, what: str, where: tuple[int, ...] | str | None, hint: str | None) -> InputError:
    return InputError(message, kind=kind, what=what, where=where, hint=hint)


class LoadWarning(UserWarning):
    """Warning that a part of a file was skipped, or was read in a way that may be unexpected."""


class Status(IntEnum):
    """Status of one row of a call with ``on_error="status"``.

    Every status but `OK` means that the answer is not proved. The row then has the safe answer that
    the function describes at `on_error`: for example True for `intersects`, and 0 for `distance`.

    Examples
    --------
    >>> import numpy as np, impinge
    >>> cube = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> poses = np.stack([np.eye(4), np.full((4, 4), np.nan)])
    >>> hits, status = impinge.intersects(cube, cube, poses, on_error="status")
    >>> hits, status
    (array([ True,  True]), array([0, 1], dtype=uint8))
    >>> impinge.Status(status[1]).name
    'NON_FINITE'
    """

    OK = 0
    """The poses of the row are valid, and the answer is proved."""
    NON_FINITE = 1
    """An entry of a pose is NaN or infinite. The row has the safe answer, which proves nothing."""
    OUT_OF_RANGE = 2
    """An entry of a pose is above 2^64 in magnitude, or 2^300 in the translation. The row has the
    safe answer, which proves nothing."""
    NOT_AFFINE = 3
    """The last row of a pose's matrix is not 0, 0, 0, 1. The row of the call has the safe answer,
    which proves nothing."""
    SINGULAR = 4
    """The linear part of a pose has no inverse. The row has the safe answer, which proves
    nothing."""
    UNDECIDED = 5
    """The poses are valid, but the answer is not proved: round shapes touch to within rounding, or
    a mesh is open or intersects itself at the place in question. The row has the safe answer."""
    NOT_RIGID = 6
    """A pose is not rigid within 1e-4, which round shapes require. The row has the safe answer,
    which proves nothing."""
    OUT_OF_BUDGET = 7
    """A limit of `impinge.limit` was reached before the answer was complete. The row has the safe
    answer, which proves nothing."""
