"""Axis-aligned boxes of `impinge.fit` in their three forms, and in packed form."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal, Self, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impinge import _impinge
from impinge._errors import InputError
from impinge._points import scalar
from impinge._scalars import chosen
from impinge._volumes import Numbers, Volume

_Kind = TypeVar("_Kind")

_BYTES_OF_8_BITS = 16
"""Size in bytes of a packed box with extents of 8 bits."""


@dataclass(frozen=True, eq=False)
class AxisBox(Volume):
    """Base class of the three forms of an axis-aligned box: `Aabb`, `MinWidths`, `CenterRadius`.

    A box is the closed set of real points that its numbers define, in a frame and unit of the
    caller's choice. Conversion, merging and moving round outward: the result contains the exact
    box. Numbers are finite and below 2^320 in magnitude; a box is immutable.

    Attributes
    ----------
    volume : float
        Volume in cubic units, rounded.
    surface_area : float
        Surface area in square units, rounded. For a flat box, both sides count.

    Examples
    --------
    >>> import impinge
    >>> box = impinge.fit.Aabb([1, 1, 1], [4, 2, 2])
    >>> box.to_center_radius()
    CenterRadius(center=array([2.5, 1.5, 1.5]), half_extents=array([1.5, 0.5, 0.5]))
    >>> box.to_min_widths().overlaps(impinge.fit.MinWidths([4, 2, 2], [1, 1, 1]))
    True
    >>> box.moved(impinge.pose([10, 0, 0])).low
    array([11.,  1.,  1.])
    """

    volume: float = field(init=False, repr=False)
    surface_area: float = field(init=False, repr=False)
    _core: _impinge.BoxCore = field(init=False, repr=False)
    _names: ClassVar[tuple[str, str]]
    """Names of the two fields that define the box, in the order of the constructor."""

    def _take(self, core: _impinge.BoxCore) -> None:
        first, second, volume, surface_area = core.columns()
        first.setflags(write=False)
        second.setflags(write=False)
        names = (*self._names, "volume", "surface_area", "_core")
        for name, value in zip(names, (first, second, volume, surface_area, core), strict=True):
            object.__setattr__(self, name, value)

    @classmethod
    def _of(cls, core: _impinge.BoxCore) -> Self:
        made = object.__new__(cls)
        made._take(core)
        return made

    def to_min_max(self) -> Aabb:
        """Return the box by its corners; corners that are not exact are rounded outward."""
        return Aabb._of(self._core.to_min_max())

    def to_min_widths(self) -> MinWidths:
        """Return the box by its lower corner and its widths, which are rounded up."""
        return MinWidths._of(self._core.to_min_widths())

    def to_center_radius(self) -> CenterRadius:
        """Return the box by its center and half-extents.

        The center is rounded. The half-extents are rounded up, so that the box still contains both
        corners.
        """
        return CenterRadius._of(self._core.to_center_radius())

    def overlaps(self, other: Self) -> bool:
        """Report whether two boxes of the same form and frame overlap; touching counts.

        The test is exact for `Aabb` and `MinWidths`. Two `CenterRadius` boxes also count as
        overlapping if their gap is below one unit in the last place of the sum of half-extents.

        Raises
        ------
        InputError
            If `other` is not a box of this form.
        """
        return self._core.overlaps(core_of(other))

    def encloses(self, other: Self) -> bool:
        """Report whether another box of the same form and frame is proved to lie inside this one.

        The test is exact for `Aabb`. For the other forms, False means not proved.

        Raises
        ------
        InputError
            If `other` is not a box of this form.
        """
        return self._core.encloses(core_of(other))

    def contains(self, points: ArrayLike) -> bool | NDArray[np.bool_]:
        """Report whether points are inside the box or on its boundary.

        False only if the point is proved to be outside.

        Parameters
        ----------
        points : (..., 3) array_like of float32 or float64
            In the frame of the box, below 2^320 in magnitude.

        Returns
        -------
        bool or (...) bool array
            True if the point is inside.

        Raises
        ------
        InputError
            If the points have another type or shape, or if a number is out of range.

        Examples
        --------
        >>> import impinge
        >>> impinge.fit.MinWidths([0, 0, 0], [1, 1, 1]).contains([[1, 1, 1], [1, 1, 1.5]])
        array([ True, False])
        """
        return scalar(self._core.contains(points))  # type: ignore[no-any-return]

    def merged(self, other: Self) -> Self:
        """Return a box that contains this box and another one of the same form and frame.

        For `Aabb` it is exactly the smallest such box; for the other forms it is rounded outward.

        Raises
        ------
        InputError
            If `other` is not a box of this form.
        """
        return self._of(self._core.merged(core_of(other)))

    def moved(self, pose: ArrayLike) -> Self:
        """Return a world-frame box of this form that contains this box at a pose, rounded outward.

        Parameters
        ----------
        pose : (4, 4) array_like of float32 or float64
            World from the frame of the box; any invertible affine map.

        Raises
        ------
        InputError
            If the pose is invalid, or if the image is out of range.
        """
        return self._of(self._core.moved(pose))

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the two fields that define the box."""
        return type(self), tuple(getattr(self, name) for name in self._names)


@final
@dataclass(frozen=True, eq=False)
class Aabb(AxisBox):
    """An axis-aligned box by its corners: the form with the fastest test, and with exact unions.

    Attributes
    ----------
    low, high : (3,) float64 array
        Lower and upper corners.

    Raises
    ------
    InputError
        If a number is not finite or out of range, or if an upper corner is below the lower one.

    Examples
    --------
    >>> import impinge
    >>> box = impinge.fit.Aabb([0, 0, 0], [1, 1, 1])
    >>> box.overlaps(impinge.fit.Aabb([1, 0, 0], [2, 2, 2])), box.volume
    (True, 1.0)
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    _names: ClassVar[tuple[str, str]] = ("low", "high")

    def __init__(self, low: ArrayLike, high: ArrayLike) -> None:
        self._take(_impinge.BoxCore(self._names, low, high))


@final
@dataclass(frozen=True, eq=False)
class MinWidths(AxisBox):
    """An axis-aligned box by lower corner and widths: all ``low + w`` with ``0 <= w <= widths``.

    Attributes
    ----------
    low : (3,) float64 array
        Lower corner.
    widths : (3,) float64 array
        Lengths along the axes, at least zero.

    Raises
    ------
    InputError
        If a number is not finite or out of range, or if a width is negative.

    Examples
    --------
    >>> import impinge
    >>> impinge.fit.Aabb([1, 1, 1], [4, 2, 2]).to_min_widths()
    MinWidths(low=array([1., 1., 1.]), widths=array([3., 1., 1.]))
    """

    low: NDArray[np.float64]
    widths: NDArray[np.float64]
    _names: ClassVar[tuple[str, str]] = ("low", "widths")

    def __init__(self, low: ArrayLike, widths: ArrayLike) -> None:
        self._take(_impinge.BoxCore(self._names, low, widths))

    def packed(self, bits: Literal[8, 16] = 16) -> PackedMinWidths:
        """Return a packed box that contains this box, rounded outward.

        It takes 20 bytes with widths of 16 bits, and 16 bytes with widths of 8 bits.

        Raises
        ------
        InputError
            If a coordinate is beyond 2^127, or if `bits` is invalid.
        """
        return PackedMinWidths(self._core.packed(chosen(bits, (8, 16), "bits")))


@final
@dataclass(frozen=True, eq=False)
class CenterRadius(AxisBox):
    """An axis-aligned box by center and half-extents.

    It consists of the points ``center + e`` with ``abs(e) <= half_extents``.

    Attributes
    ----------
    center : (3,) float64 array
        Center of the box.
    half_extents : (3,) float64 array
        Half the lengths along the axes, at least zero.

    Raises
    ------
    InputError
        If a number is not finite or out of range, or if a half-extent is negative.

    Examples
    --------
    >>> import impinge
    >>> impinge.fit.CenterRadius([0, 0, 0], [1, 2, 3]).to_min_max()
    Aabb(low=array([-1., -2., -3.]), high=array([1., 2., 3.]))
    """

    center: NDArray[np.float64]
    half_extents: NDArray[np.float64]
    _names: ClassVar[tuple[str, str]] = ("center", "half_extents")

    def __init__(self, center: ArrayLike, half_extents: ArrayLike) -> None:
        self._take(_impinge.BoxCore(self._names, center, half_extents))

    def packed(self, bits: Literal[8, 16] = 16) -> PackedCenterRadius:
        """Return a packed box that contains this box, rounded outward.

        It takes 20 bytes with half-extents of 16 bits, and 16 bytes with half-extents of 8 bits.

        Raises
        ------
        InputError
            If a coordinate is beyond 2^127, or if `bits` is invalid.
        """
        return PackedCenterRadius(self._core.packed(chosen(bits, (8, 16), "bits")))


class PackedBox:
    """An axis-aligned box in single precision, its extents stored in 8 or 16 bits each.

    Extents are integers times a power of two that the box stores. Only packing rounds, outward:
    `unpacked` returns the stored box exactly.

    Examples
    --------
    >>> import impinge
    >>> box = impinge.fit.MinWidths([0, 0, 0], [1, 0.7, 0])
    >>> box.packed(8), box.packed(8).unpacked().widths
    (PackedMinWidths(16 bytes), array([1.      , 0.703125, 0.      ]))
    """

    __slots__ = ("_core",)

    def __init__(self, core: _impinge.PackedCore) -> None:
        self._core = core

    @property
    def nbytes(self) -> int:
        """Size of the packed box in bytes: 16 or 20."""
        return self._core.size()

    @property
    def volume(self) -> float:
        """Volume of the unpacked box in cubic units, rounded."""
        volume: float = self.unpacked().volume
        return volume

    @abstractmethod
    def unpacked(self) -> Any:
        """Return the box in double precision, exactly."""

    def overlaps(self, other: Self) -> bool:
        """Report whether two packed boxes of the same form and frame overlap; touching counts.

        The result is that of `overlaps` of the unpacked boxes.

        Raises
        ------
        InputError
            If `other` is not a packed box of this form.
        """
        overlap: bool = self.unpacked().overlaps(_checked(other, type(self)).unpacked())
        return overlap

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the unpacked box and the number of bits; packing it again gives the same box."""
        return _repacked, (self.unpacked(), 8 if self.nbytes == _BYTES_OF_8_BITS else 16)

    def __repr__(self) -> str:
        """Return the form and the size."""
        return f"{type(self).__name__}({self.nbytes} bytes)"


@final
class PackedMinWidths(PackedBox):
    """A packed box by its lower corner and its widths; `MinWidths.packed` makes it."""

    __slots__ = ()

    def unpacked(self) -> MinWidths:
        """Return the box in double precision, exactly."""
        return MinWidths._of(self._core.unpacked())


@final
class PackedCenterRadius(PackedBox):
    """A packed box by its center and half-extents, which contains the box it was made from."""

    __slots__ = ()

    def unpacked(self) -> CenterRadius:
        """Return the box in double precision, exactly."""
        return CenterRadius._of(self._core.unpacked())


def aabb_of(numbers: Numbers) -> Aabb:
    """Return the box whose corners the extension returned."""
    low, high = numbers[0]
    return Aabb(low, high)


def core_of(box: object, name: str = "other") -> _impinge.BoxCore:
    """Return the extension's object of a box in any form.

    Raise an `InputError` that names the argument if `box` is not an `AxisBox`.
    """
    return _checked(box, AxisBox, name)._core


def _checked(box: object, kind: type[_Kind], name: str = "other") -> _Kind:
    if not isinstance(box, kind):
        raise InputError(f"must be {kind.__name__}, not {type(box).__name__}", kind="type", what=name)
    return box


def _repacked(box: MinWidths | CenterRadius, bits: Literal[8, 16]) -> PackedBox:
    return box.packed(bits)
