"""Compares answers byte for byte."""

import impinge
import numpy as np
import pytest


def same(a, b):
    """Reports whether two answers have the same types, shapes and bytes."""
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes())
    if isinstance(a, tuple | list):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    if hasattr(a, "__dict__"):
        return type(a) is type(b) and same(tuple(vars(a).items()), tuple(vars(b).items()))
    return type(a) is type(b) and a == b


def same_reports(a, b):
    return same(tuple(vars(a).values()), tuple(vars(b).values()))


def error_of(call, on):
    """Returns what the error of a call on a cluster, or on this process for None, says."""
    with pytest.raises(impinge.InputError) as caught:
        call(on)
    return str(caught.value), caught.value.what, caught.value.where, caught.value.kind
