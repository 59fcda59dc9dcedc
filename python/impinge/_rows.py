"""Types and helpers that the queries on two things share: poses, options and the status of rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NotRequired, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from impinge.cluster import Cluster

Pose: TypeAlias = ArrayLike | None
"""Matrices (..., 4, 4), world from mesh; None is the identity."""

Solid: TypeAlias = bool | Literal["a", "b"]
"""Which of two meshes are solids: neither, both, or one."""

Booleans: TypeAlias = bool | NDArray[np.bool_]
Statuses: TypeAlias = NDArray[np.uint8]


class RaiseOptions(TypedDict, total=False):
    """Options of a call that raises an error for an invalid pose."""

    on_error: Literal["raise"]
    progress: bool
    on: Cluster | None


class StatusOptions(TypedDict):
    """Options of a call that returns the safe answer and a status for an invalid pose."""

    on_error: Literal["status"]
    progress: NotRequired[bool]
    on: NotRequired[Cluster | None]


def with_status(answer: Any, on_error: str, convert: Any) -> Any:
    """Return the converted result, with the status of each row if the caller asked for it."""
    return (convert(answer[0]), answer[1]) if on_error == "status" else convert(answer)
