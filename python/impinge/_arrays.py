"""Validates array arguments, and converts them to native, aligned, C-contiguous arrays.

The extension reads the types that these functions return.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge._errors import InputError

_PLAIN: list[Literal["C_CONTIGUOUS", "ALIGNED"]] = ["C_CONTIGUOUS", "ALIGNED"]


def plain_cloud(points: ArrayLike, name: str) -> NDArray[Any]:
    """Return points as a C-contiguous (n, 3) array of float32 or float64.

    The array is not copied if possible. Raise an `InputError` if the type or the shape is wrong;
    the values are not checked.
    """
    return _floats(points, name, (3,), cloud=True, wanted="an (n, 3) array")


def plain_points(points: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return points as a C-contiguous (..., 3) float64 array, without a copy if possible.

    Raise an `InputError` if the type or the shape is wrong; the values are not checked.
    """
    return _floats(points, name, (3,), cloud=False, wanted="a (3,) point, or (..., 3) of them")


def plain_heights(heights: ArrayLike, name: str) -> NDArray[np.float32]:
    """Return heights as a C-contiguous (rows, columns) float32 copy.

    Raise an `InputError` if the type or the shape is wrong, or if a height is not finite.
    """
    array = _array(heights, name, "a (rows, columns) array of numbers")
    if array.dtype.kind not in "iuf":
        raise InputError(f"has dtype {array.dtype}; numbers are expected", kind="dtype", what=name)
    if array.ndim != 2:
        raise InputError(f"has shape {array.shape}; (rows, columns) is expected", kind="shape", what=name)
    with np.errstate(over="ignore"):
        single = np.array(array, np.float32, order="C")
    wrong = np.argwhere(~np.isfinite(single))
    if len(wrong):
        at = tuple(map(int, wrong[0]))
        raise InputError("a height is not finite in single precision", kind="non-finite", what=name, where=at)
    return single


def plain_flags(flags: ArrayLike, name: str, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return a C-contiguous copy of an array of bool with this shape.

    Raise an `InputError` if the type or the shape is wrong.
    """
    array = _array(flags, name, f"a {shape} array of bool")
    if array.dtype.kind != "b":
        raise InputError(f"has dtype {array.dtype}; bool is expected", kind="dtype", what=name)
    if array.shape != shape:
        raise InputError(f"has shape {array.shape}; {shape} is expected", kind="shape", what=name)
    return np.array(array, np.bool_, order="C")


def plain_poses(poses: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return poses as a C-contiguous (..., 4, 4) float64 array, without a copy if possible.

    Raise an `InputError` if the type or the shape is wrong; the values are not checked.
    """
    return _floats(poses, name, (4, 4), cloud=False, wanted="a (4, 4) matrix, or (..., 4, 4) of them")


def plain_faces(faces: ArrayLike) -> NDArray[Any]:
    """Return faces as a C-contiguous (m, 3) array of 32- or 64-bit integers.

    The array is not copied if possible. Raise an `InputError` if the type or the shape is wrong;
    the indices are not checked.
    """
    array = _array(faces, "faces", "an (m, 3) array of integers")
    if array.size == 0 and array.shape in ((0,), (0, 3)):
        return np.zeros((0, 3), np.int64)
    if array.dtype.kind not in "iu":
        raise InputError(
            f"has dtype {array.dtype}; integers are expected", kind="dtype", what="faces", hint=_integer_hint(array)
        )
    if array.ndim != 2 or array.shape[1] != 3:
        hint = "triangulate the polygons first" if array.ndim == 2 and array.shape[1] > 3 else None
        raise InputError(f"has shape {array.shape}; (m, 3) is expected", kind="shape", what="faces", hint=hint)
    wide = array.dtype.itemsize >= 4
    native = array.dtype.newbyteorder("=") if wide else np.dtype(np.int32)
    return np.require(array, native, _PLAIN)


def plain_numbers(numbers: ArrayLike, name: str, maximum: int) -> NDArray[np.uint64]:
    """Return integers from 0 to `maximum` as a uint64 array of the same shape.

    Raise an `InputError` for other types or numbers. An empty array may have any type.
    """
    if isinstance(numbers, list | tuple) and all(isinstance(number, int | np.integer) for number in numbers):
        # NumPy converts a mixture of signed and unsigned integers to floats.
        numbers = [number if isinstance(number, bool) else int(number) for number in numbers]
    array = _array(numbers, name, f"integers from 0 to {maximum}")
    if array.size == 0:
        return np.zeros(array.shape, np.uint64)
    if array.dtype.kind not in "iu":
        message = f"has dtype {array.dtype}; integers from 0 to {maximum} are expected"
        raise InputError(message, kind="dtype", what=name)
    wrong = np.argwhere((array < 0) | (array > maximum))
    if len(wrong):
        at = tuple(map(int, wrong[0]))
        message = f"must be from 0 to {maximum}, not {array[at]}"
        raise InputError(message, kind="out-of-range", what=name, where=at)
    return np.require(array, np.uint64, _PLAIN)


def plain_reals(value: Any, name: str, core: tuple[int, ...]) -> NDArray[np.float64]:
    """Return real numbers of any type as a float64 array whose last axes are `core`.

    Raise an `InputError` if the shape is wrong or a number is not finite.
    """
    try:
        given = np.asarray(value)
        if given.dtype.kind not in "iufO":
            raise TypeError(f"dtype {given.dtype}")
        array = given.astype(np.float64)
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(f"must be an array of numbers: {error}", kind="type", what=name) from None
    if array.shape[array.ndim - len(core) :] != core:
        message = f"has shape {array.shape}; (..., {', '.join(map(str, core))}) is expected"
        raise InputError(message, kind="shape", what=name)
    broken = np.argwhere(~np.isfinite(array))
    if len(broken):
        raise InputError("must be finite", kind="non-finite", what=name, where=tuple(map(int, broken[0])))
    return array


def plain_shaped(value: Any, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    """Return a value as a finite float64 array.

    Raise an `InputError` unless it has exactly this shape and all its numbers are finite.
    """
    array = plain_reals(value, name, shape)
    if array.shape != shape:
        raise InputError(f"has shape {array.shape}; {shape} is expected", kind="shape", what=name)
    return array


def _floats(values: ArrayLike, name: str, core: tuple[int, ...], *, cloud: bool, wanted: str) -> NDArray[Any]:
    """Read floats whose last axes are `core`; a cloud has one more axis and keeps float32."""
    is_array = hasattr(values, "dtype")
    array = _array(values, name, f"{wanted} of float32 or float64")
    if cloud and array.shape == (0,):
        array = array.reshape(0, 3)
    # A nested list has no dtype, so integers in it are accepted and converted.
    if not is_array and array.dtype.kind in "iu":
        array = array.astype(np.float64)
    if array.dtype.kind != "f" or array.dtype.itemsize not in (4, 8):
        hint = f"{name}.astype(numpy.float64) converts it" if array.dtype.kind in "iuf" else None
        message = f"has dtype {array.dtype}; float32 or float64 is expected"
        raise InputError(message, kind="dtype", what=name, hint=hint)
    if (cloud and array.ndim != 2) or array.shape[-len(core) :] != core:
        raise InputError(f"has shape {array.shape}; {wanted} is expected", kind="shape", what=name)
    single = cloud and array.dtype.itemsize == 4
    return np.require(array, np.float32 if single else np.float64, _PLAIN)


def _array(values: ArrayLike, name: str, wanted: str) -> NDArray[Any]:
    try:
        # A subclass, such as the arrays of trimesh, is replaced with its base array.
        array = np.asarray(values)
    except (ValueError, TypeError) as error:
        message = f"must be {wanted}: {error}"
        raise InputError(message, kind="shape", what=name) from None
    if array.dtype.kind == "O" or np.ma.isMaskedArray(values):
        message = f"must be {wanted}, not {type(values).__name__}"
        raise InputError(message, kind="type", what=name)
    return array


def _integer_hint(array: NDArray[Any]) -> str | None:
    return "faces.astype(numpy.int64) converts it" if array.dtype.kind == "f" else None
