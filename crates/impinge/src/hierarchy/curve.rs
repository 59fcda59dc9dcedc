//! The Morton curve: the order in which a depth-first walk of an octree meets its cells.
//!
//! Source: Morton, *A computer oriented geodetic data base*, IBM 1966; Ericson, 7.3.5.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, u32x8};

use crate::simd::{LANES, by_axis, transposed};
use crate::volume::Aabb;

/// Bits of a cell's coordinate on each axis.
const BITS: u32 = 10;

/// Bits of a digit of a code, of which there are three.
const DIGIT_BITS: u32 = BITS;

/// How many digits there are to choose from.
pub(super) const DIGITS: usize = 1 << DIGIT_BITS;

/// The place of the leading digit of a code.
pub(super) const LEADING: u32 = 2;

/// The last cell on each axis.
const LAST: f32 = ((1 << BITS) - 1) as f32;

/// Added to a small positive number, leaves an integer in the lowest bits.
const ROUND: f32 = (1 << 23) as f32;

/// A curve through the cubic cells of a cube.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curve {
    origin: [f32; 3],
    /// Cells for each unit of length.
    scale: f32,
}

impl Curve {
    /// The curve with one cell for all that there is.
    pub(crate) const ONE_CELL: Self = Self { origin: [0.0; 3], scale: 0.0 };

    /// The curve over these bounds; none where they are a point, or so large or small that cells could not be told apart.
    pub(crate) fn over(bounds: &Aabb) -> Option<Self> {
        let extent = (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f32::max);
        let scale = (1_u32 << BITS) as f32 / extent;
        (extent > 0.0 && extent.is_finite() && scale.is_finite()).then_some(Self { origin: bounds.min, scale })
    }

    /// Calls `visit` with each number of a range, twice the centre that it has, and digit `place` of its code, the least being 0.
    /// `eight` are those from a number on.
    #[inline(always)]
    pub(super) fn for_each_digit<S: Simd>(
        &self,
        simd: S,
        place: u32,
        numbers: Range<usize>,
        eight: impl Fn(usize) -> [[f32x4<S>; 4]; 2],
        mut visit: impl FnMut(usize, f32x4<S>, usize),
    ) {
        let whole = numbers.len() / LANES * LANES;
        for first in (numbers.start..numbers.start + whole).step_by(LANES) {
            let centres = eight(first);
            let digits = self.digits(simd, place, &centres);
            for lane in 0..LANES {
                visit(first + lane, centres[lane / 4][lane % 4], digits[lane] as usize % DIGITS);
            }
        }
        let last = numbers.start + whole..numbers.end;
        if !last.is_empty() {
            let centres = eight(last.start);
            let digits = self.digits(simd, place, &centres);
            for (number, lane) in last.zip(0..LANES) {
                visit(number, centres[lane / 4][lane % 4], digits[lane] as usize % DIGITS);
            }
        }
    }

    /// Of the codes of the cells of centres.
    #[inline(always)]
    fn digits<S: Simd>(&self, simd: S, place: u32, &[low, high]: &[[f32x4<S>; 4]; 2]) -> [u32; LANES] {
        let twice = transposed(low, high);
        let [x, y, z] = by_axis!(axis => {
            let along = (twice[axis] - self.origin[axis]) * self.scale - 0.5;
            // Not a number is before the first cell.
            let inside = along.simd_gt(f32x8::splat(simd, 0.0)).select(along, f32x8::splat(simd, 0.0));
            let cell = inside.min(f32x8::splat(simd, LAST)) + ROUND;
            spread(cell.bitcast::<u32x8<S>>())
        });
        let code = x | (y << 1) | (z << 2);
        ((code >> (DIGIT_BITS * place)) & (DIGITS as u32 - 1)).into()
    }
}

/// The low 10 bits of each lane, each followed by two zeros.
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
    use crate::simd::levels;
    use fearless_simd::dispatch;
    use impinge_testkit::generate::Rng;

    /// The code of a cell by its bits, one by one.
    fn code(curve: &Curve, twice: [f32; 3]) -> u32 {
        (0..3)
            .map(|axis| {
                let along = (twice[axis] - curve.origin[axis]) * curve.scale - 0.5;
                let cell = along.clamp(0.0, LAST).round_ties_even() as u32;
                (0..BITS).map(|bit| (cell >> bit & 1) << (3 * bit + axis as u32)).sum::<u32>()
            })
            .sum()
    }

    #[test]
    fn a_code_has_the_bits_of_its_cell_by_turns() {
        let mut rng = Rng::new(142);
        let bounds = Aabb { min: [-1.0, 0.0, 2.0], max: [1.0, 0.5, 3.0] };
        // On the borders of cells, outside all of them, and not a number.
        let far = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MAX];
        let mut coordinate = || if rng.one_in(20) { rng.choose(&far) } else { rng.integer(-600, 2_000) as f32 / 512.0 };
        let mut seen = [0; 3];
        for count in (0..40).chain([500]) {
            let centres: Vec<[f32; 4]> = (0..count).map(|_| [0; 4].map(|_| coordinate())).collect();
            for curve in [Curve::over(&bounds).expect("a cube"), Curve::ONE_CELL] {
                for (name, level) in levels() {
                    for (first, place) in [(0, 0), (count / 2, 1), (0, LEADING)] {
                        let mut next = first;
                        dispatch!(level, simd => curve.for_each_digit(
                            simd,
                            place,
                            first..count,
                            |first| {
                                let mut eight = [[f32x4::splat(simd, 0.0); 4]; 2];
                                for (lanes, centre) in eight.as_flattened_mut().iter_mut().zip(&centres[first..]) {
                                    *lanes = f32x4::from_slice(simd, centre);
                                }
                                eight
                            },
                            |number, twice, digit| {
                                assert_eq!(number, next, "{name}");
                                assert_eq!(twice[0].to_bits(), centres[number][0].to_bits(), "{name}");
                                let [x, y, z, _] = centres[number];
                                let code = code(&curve, [x, y, z]);
                                let expected = (code >> (DIGIT_BITS * place)) as usize % DIGITS;
                                assert_eq!(digit, expected, "{name}, {place}: {:?}", centres[number]);
                                seen[place as usize] |= digit;
                                next += 1;
                            },
                        ));
                        assert_eq!(next, count, "{name}");
                    }
                }
            }
        }
        assert_eq!(seen, [DIGITS - 1; 3], "not all bits were met");
    }
}
