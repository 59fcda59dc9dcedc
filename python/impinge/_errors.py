"""What is wrong with an input, and where."""

from __future__ import annotations

from enum import IntEnum


class InputError(ValueError):
    """An argument, or a file, that cannot be answered about.

    The text says what is wrong, where, and, where that is known, what to do.

    Attributes
    ----------
    kind : str
        A short stable name: ``"type"``, ``"dtype"``, ``"shape"``, ``"option"``, ``"name"``, ``"unit"``,
        ``"non-finite"``, ``"out-of-range"``, ``"index-out-of-bounds"``, ``"too-many"``, ``"not-affine"``,
        ``"singular"``, ``"not-rigid"``, ``"not-unit-quaternion"``, ``"zero-direction"``, ``"zero-axis"``,
        ``"negative"``, ``"order"``, ``"stale"``, ``"static"`` or ``"empty"``; for files those of the command's
        JSON too, such as ``"syntax"``.
    what : str
        The argument that is wrong, such as ``"vertices"`` or ``"pose_b"``, or the file.
    where : tuple of int, str or None
        An index into the argument: ``(row, 0, 3)`` in an array of poses, ``(vertex,)``, ``(face,)``; empty where all of
        it is wrong. For a file the line, byte or entry, or None.
    hint : str or None
        What to do about it.

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
        """Pickle with all attributes, as worker processes hand their errors on."""
        return _restored, (self._message, self.kind, self.what, self.where, self.hint)


def _restored(message: str, kind: str, what: str, where: tuple[int, ...] | str | None, hint: str | None) -> InputError:
    return InputError(message, kind=kind, what=what, where=where, hint=hint)


class LoadWarning(UserWarning):
    """Something in a file was left out, or read otherwise than one may expect."""


class Status(IntEnum):
    """How a row was answered where ``on_error="status"`` lets bad poses pass.

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
    """The answer is the truth."""
    NON_FINITE = 1
    """An entry of the pose is NaN or infinite; the answer is the safe one."""
    OUT_OF_RANGE = 2
    """An entry is beyond 2^64, or a translation beyond 2^300; the answer is the safe one."""
    NOT_AFFINE = 3
    """The last row of the pose is not 0, 0, 0, 1; the answer is the safe one."""
    SINGULAR = 4
    """The linear part of the pose has no inverse; the answer is the safe one."""
    UNDECIDED = 5
    """Nothing was proved: round shapes touch to within rounding, or a mesh is open or meets itself there; the answer is
    the safe one."""
    NOT_RIGID = 6
    """The pose is no rigid motion within 1e-4, which a round shape wants; the answer is the safe one."""
