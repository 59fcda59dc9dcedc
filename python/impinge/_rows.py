"""What the verbs on two meshes have in common: rows of poses, and what is said of each row."""

from __future__ import annotations

from typing import Any, Literal, NotRequired, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

Pose: TypeAlias = ArrayLike | None
"""(..., 4, 4), world from mesh; None is the identity."""

Solid: TypeAlias = bool | Literal["a", "b"]
"""Which of two meshes are solid."""

Booleans: TypeAlias = bool | NDArray[np.bool_]
Statuses: TypeAlias = NDArray[np.uint8]


class Raising(TypedDict, total=False):
    """The options of a call in which a bad pose is an error."""

    on_error: Literal["raise"]
    progress: bool


class Stating(TypedDict):
    """The options of a call that answers a bad pose safely, and says so."""

    on_error: Literal["status"]
    progress: NotRequired[bool]


def beside_status(answer: Any, on_error: str, made: Any) -> Any:
    """Return what `made` makes of an answer, beside the status of each row where that was asked for."""
    return (made(answer[0]), answer[1]) if on_error == "status" else made(answer)
