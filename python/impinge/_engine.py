"""Chooses where a call runs: on the threads of this process, or on a cluster."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from impinge import _impinge
from impinge._errors import InputError

if TYPE_CHECKING:
    from impinge.cluster import Cluster


def engine(on: Cluster | None) -> Any:
    """Return an object with the functions of the extension that answer the call.

    It is the extension itself, or the functions of the same names and arguments of a cluster.
    """
    if on is None:
        return _impinge
    functions = getattr(on, "_functions", None)
    if functions is None:
        hint = "use `with impinge.cluster.ray() as cluster:`"
        raise InputError(
            f"must be an impinge.cluster.Cluster, not {type(on).__name__}", kind="type", what="on", hint=hint
        )
    return functions()
