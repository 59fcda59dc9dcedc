"""A picture of pixels."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge import _impinge
from impinge._errors import InputError
from impinge._scalars import path_of, real, whole


class Picture:
    """A picture that `show` or `ClashReport.picture` drew.

    A notebook shows it, and ``np.asarray`` returns its pixels.

    Attributes
    ----------
    width, height : int
        Size in pixels.
    size : (int, int)
        Width and height.
    pixels : (height, width, 3) uint8 array
        Red, green and blue of each pixel, row by row from the top. Read-only.
    """

    __slots__ = ("pixels",)

    def __init__(self, pixels: NDArray[np.uint8]) -> None:
        self.pixels = pixels
        self.pixels.setflags(write=False)

    @property
    def width(self) -> int:
        """Width in pixels."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """Height in pixels."""
        return int(self.pixels.shape[0])

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.width, self.height

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture as a PNG file.

        Parameters
        ----------
        path : str or os.PathLike
            The file, whose name ends in ``.png``.

        Raises
        ------
        InputError
            If the name has another extension.
        OSError
            If the file cannot be written.
        """
        Path(png_path(path)).write_bytes(self._repr_png_())

    def _repr_png_(self) -> bytes:
        """Return the picture as a PNG file, which notebooks show."""
        return _impinge.to_png(self.pixels)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Return the pixels."""
        return np.array(self.pixels, dtype=dtype, copy=copy)

    def __repr__(self) -> str:
        """Return the size."""
        return f"Picture({self.width} x {self.height})"


def size_of(size: object) -> list[int]:
    """Return the width and the height of a picture."""
    width, height = pair_of(size, "size")
    return [whole(pixels, "size", minimum=16, maximum=8192) for pixels in (width, height)]


def pair_of(pair: object, name: str) -> tuple[Any, Any]:
    """Return a tuple or a list of two numbers."""
    if not isinstance(pair, tuple | list) or len(pair) != 2:
        raise InputError(f"must be two numbers, not {type(pair).__name__}", kind="shape", what=name)
    return pair[0], pair[1]


def png_path(path: object) -> str:
    """Return the path of a PNG file as a str."""
    text = path_of(path, "path")
    if Path(text).suffix.lower() != ".png":
        raise InputError(f"{text!r} does not end in .png", kind="unsupported-format", what="path")
    return text


def angles_of(view: tuple[float, float]) -> list[float]:
    """Return the azimuth and the elevation of a camera in degrees."""
    angles = [real(angle, "view") for angle in pair_of(view, "view")]
    if np.isinf(angles).any():
        raise InputError("an angle is infinite", kind="non-finite", what="view")
    return angles
