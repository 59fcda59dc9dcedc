//! The Morton curve: the order in which a depth-first walk of an octree visits its cells.
//!
//! Source: Morton, *A computer oriented geodetic data base*, IBM 1966; Ericson, 7.3.5.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, u32x8};

use crate::simd::{LANES, by_axis, transposed};
use crate::volume::Aabb;

/// Number of bits of a cell's coordinate on each axis.
const BITS: u32 = 8;

/// Number of bits of a digit. A code has two digits.
const DIGIT_BITS: u32 = 12;

/// Number of values of a digit.
pub(super) const DIGITS: usize = 1 << DIGIT_BITS;

/// Index of the leading digit of a code; the other digit has index 0.
pub(super) const LEADING: u32 = 1;

/// The last cell on each axis.
const LAST: f32 = ((1 << BITS) - 1) as f32;

/// Adding this to a small positive number leaves the rounded integer in the lowest bits.
const ROUND: f32 = (1 << 23) as f32;

/// A Morton curve through the cubic cells of a cube.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curve {
    origin: [f32; 3],
    /// Number of cells per unit of length.
    scale: f32,
}

impl Curve {
    /// The curve with one cell for all of space.
    pub(crate) const ONE_CELL: Self = Self { origin: [0.0; 3], scale: 0.0 };

    /// Returns the curve over these bounds. Returns `None` if they are a point, or so large or
    /// small that cells cannot be distinguished.
    pub(crate) fn over(bounds: &Aabb) -> Option<Self> {
        let extent = (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f32::max);
        let scale = (1_u32 << BITS) as f32 / extent;
        (extent > 0.0 && extent.is_finite() && scale.is_finite()).then_some(Self { origin: bounds.min, scale })
    }

    /// Calls `visit` with consecutive groups of eight boxes of a range, and with the rest at its
    /// end. `place` is the index of the digit to compute. `eight` returns twice the centers of
    /// eight boxes from an index on.
    #[inline(always)]
    pub(super) fn for_each_eight<S: Simd>(
        &self,
        simd: S,
        place: u32,
        numbers: Range<usize>,
        eight: impl Fn(usize) -> [[f32x4<S>; 4]; 2],
        mut visit: impl FnMut(&Eight<S>),
    ) {
        let whole = numbers.len() / LANES * LANES;
        for first in (numbers.start..numbers.start + whole).step_by(LANES) {
            let twice = eight(first);
            let digits = self.digits(simd, place, &twice);
            let is_same = digits.simd_eq(u32x8::splat(simd, digits[0])).all_true();
            visit(&Eight { first, count: LANES, twice, digits: digits.into(), is_same });
        }
        if whole < numbers.len() {
            let first = numbers.start + whole;
            let twice = eight(first);
            let digits = self.digits(simd, place, &twice).into();
            visit(&Eight { first, count: numbers.end - first, twice, digits, is_same: false });
        }
    }

    /// Computes the code of one cell bit by bit.
    #[cfg(test)]
    pub(super) fn code(&self, twice: [f32; 3]) -> u32 {
        let code = |axis: usize| {
            let along = (twice[axis] - self.origin[axis]) * self.scale - 0.5;
            let cell = along.clamp(0.0, LAST).round_ties_even() as u32;
            (0..BITS).map(|bit| (cell >> bit & 1) << (3 * bit + axis as u32)).sum::<u32>()
        };
        code(0) | code(1) | code(2)
    }

    /// Returns digit `place` of the codes of eight cells.
    #[inline(always)]
    fn digits<S: Simd>(&self, simd: S, place: u32, &[low, high]: &[[f32x4<S>; 4]; 2]) -> u32x8<S> {
        let twice = transposed(low, high);
        let [x, y, z] = by_axis!(axis => {
            let along = (twice[axis] - self.origin[axis]) * self.scale - 0.5;
            // NaN goes to the first cell.
            let inside = along.simd_gt(f32x8::splat(simd, 0.0)).select(along, f32x8::splat(simd, 0.0));
            let cell = inside.min(f32x8::splat(simd, LAST)) + ROUND;
            spread(cell.bitcast::<u32x8<S>>())
        });
        let code = x | (y << 1) | (z << 2);
        (code >> (DIGIT_BITS * place)) & (DIGITS as u32 - 1)
    }
}

/// Up to eight consecutive boxes: twice their centers, and digits of their codes.
pub(super) struct Eight<S: Simd> {
    pub(super) first: usize,
    pub(super) count: usize,
    twice: [[f32x4<S>; 4]; 2],
    digits: [u32; LANES],
    /// True if all eight have the same digit, as neighbors mostly do.
    pub(super) is_same: bool,
}

impl<S: Simd> Eight<S> {
    #[inline(always)]
    pub(super) fn twice(&self, lane: usize) -> f32x4<S> {
        self.twice[lane / 4][lane % 4]
    }

    #[inline(always)]
    pub(super) fn digit(&self, lane: usize) -> usize {
        self.digits[lane] as usize % DIGITS
    }
}

/// Spreads the low 10 bits of each lane: each is followed by two zeros.
#[inline(always)]
fn spread<S: Simd>(x: u32x8<S>) -> u32x8<S> {
    let x = x & 0x3ff;
    let x = (x | (x << 16)) & 0x0300_00ff;
    let x = (x | (x << 8)) & 0x0300_f00f;
    let x = (x | (x << 4)) & 0x030c_30c3;
    (x | (x << 2)) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::dispatch_every;
    use crate::simd::kernel_levels;
    use impinge_testkit::generate::Rng;

    #[test]
    fn a_code_interleaves_the_bits_of_its_cell() {
        let mut rng = Rng::new(142);
        let bounds = Aabb { min: [-1.0, 0.0, 2.0], max: [1.0, 0.5, 3.0] };
        // On the borders of cells, outside all of them, and NaN.
        let far = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MAX];
        let mut coordinate = || if rng.one_in(20) { rng.choose(&far) } else { rng.integer(-600, 2_000) as f32 / 512.0 };
        let (mut seen, mut same) = ([0; 2], 0);
        for count in (0..40).chain([500]) {
            let centers: Vec<[f32; 4]> = (0..count).map(|_| [0; 4].map(|_| coordinate())).collect();
            for curve in [Curve::over(&bounds).expect("a cube"), Curve::ONE_CELL] {
                for (name, level) in kernel_levels() {
                    for (first, place) in [(0, 0), (count / 2, LEADING)] {
                        let mut next = first;
                        dispatch_every!(level, simd => curve.for_each_eight(
                            simd,
                            place,
                            first..count,
                            |first| {
                                let mut eight = [[f32x4::splat(simd, 0.0); 4]; 2];
                                for (lanes, center) in eight.as_flattened_mut().iter_mut().zip(&centers[first..]) {
                                    *lanes = f32x4::from_slice(simd, center);
                                }
                                eight
                            },
                            |eight| {
                                assert_eq!(eight.first, next, "{name}");
                                for (lane, &[x, y, z, any]) in centers[next..][..eight.count].iter().enumerate() {
                                    let twice = <[f32; 4]>::from(eight.twice(lane)).map(f32::to_bits);
                                    assert_eq!(twice, [x, y, z, any].map(f32::to_bits), "{name}");
                                    let code = curve.code([x, y, z]);
                                    let expected = (code >> (DIGIT_BITS * place)) as usize % DIGITS;
                                    assert_eq!(eight.digit(lane), expected, "{name}, {place}: {:?}", [x, y, z]);
                                    seen[place as usize] |= expected;
                                }
                                let is_same = (1..LANES).all(|lane| eight.digit(lane) == eight.digit(0));
                                assert_eq!(eight.is_same, eight.count == LANES && is_same, "{name}");
                                same += usize::from(eight.is_same);
                                next += eight.count;
                            },
                        ));
                        assert_eq!(next, count, "{name}");
                    }
                }
            }
        }
        assert_eq!(seen, [DIGITS - 1; 2], "not all bits were seen");
        assert!(same > 100, "{same}");
    }
}
