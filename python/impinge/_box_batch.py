"""Overlap tests of one axis-aligned box against many, for `impinge.fit`."""

from __future__ import annotations

from typing import final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._arrays import plain_points
from impinge._boxes import AxisBox, core_of


@final
class AabbBatch:
    """Many axis-aligned boxes in single precision, tested against one box, eight at a time (SIMD).

    Parameters
    ----------
    low, high : (n, 3) array_like of float32 or float64
        Lower and upper corners of the boxes, all in one frame. Without `high`, boxes are points.
        Coordinates that single precision cannot represent are rounded outward.

    Raises
    ------
    InputError
        If an array has another type or shape, if a number is not finite or not below 2^320 in
        magnitude, or if an upper corner is below a lower one. The error names the entry.

    Examples
    --------
    >>> import impinge, numpy as np
    >>> low = np.arange(100.0)[:, None] * [1, 0, 0]
    >>> impinge.fit.AabbBatch(low, low + 1).overlapping(impinge.fit.Aabb([6.5, 0, 0], [6.75, 1, 1]))
    array([6], dtype=uint32)
    """

    __slots__ = ("_core", "_made_of")

    def __init__(self, low: ArrayLike, high: ArrayLike | None = None) -> None:
        self._made_of = plain_points(low, "low").copy(), None if high is None else plain_points(high, "high").copy()
        self._core = _impinge.BatchCore(*self._made_of)

    def overlapping(self, box: AxisBox) -> NDArray[np.uint32]:
        """Return the row indices of the boxes that overlap a box, (k,), ascending; touching counts.

        `box` is in the frame of the batch. The test reads all boxes, 24 bytes for each. It is exact
        if single precision represents all corners. Otherwise, boxes that are apart by less than the
        rounding count as overlapping.

        Raises
        ------
        InputError
            If `box` is not an `AxisBox`.
        """
        return self._core.overlapping(core_of(box, "box"))

    def __len__(self) -> int:
        """Return the number of boxes."""
        return self._core.len()

    def __copy__(self) -> AabbBatch:
        """Return the batch itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> AabbBatch:
        """Return the batch itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the constructor's arguments."""
        return AabbBatch, self._made_of
