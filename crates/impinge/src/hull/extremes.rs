//! The farthest points along directions, found by a scan of all points at memory speed.
//!
//! Points are packed eight to a block in single precision, relative to the middle of their box and
//! scaled by a power of two so that no coordinate exceeds 1. One pass finds the greatest and the
//! least score of every group of blocks. The few groups within the error of the best are scanned
//! again, and the points within it are compared exactly.
//!
//! # Accuracy
//! With u = 2^-24, a packed coordinate is wrong by u times the greatest coordinate of its axis, and
//! an entry of the scaled direction by u times itself. The score, of three products and two sums,
//! is wrong by 3 u times the sum of the products' magnitudes. Together that is 5 u of
//! `Σ |direction| · reach` and terms in u², taken as 6 u, whether or not multiply and add are
//! fused. [`UNDERFLOW`] covers losses too small for a float.
//!
//! The test is `every_level_finds_the_first_of_the_exact_extremes` below.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::cull::stored;
use crate::exact::compare_along;
use crate::math::Sign::{self, Negative, Positive};
use crate::simd::{LANES, Level, best_level, by_axis, dispatch};

/// Number of blocks in a group. Smaller groups need more memory and more reductions. Larger groups
/// make each second scan longer.
const GROUP_BLOCKS: usize = 16;

/// Bound on the loss in three products of numbers within 1 that underflow, and in entries that are
/// too small for a float.
const UNDERFLOW: f64 = 1.0 / (1_u128 << 120) as f64;

/// Eight points by axis.
type Block = [[f32; LANES]; 3];

/// Points packed to find the farthest. Each query needs the original points again.
#[derive(Clone, Debug)]
pub(crate) struct Extremes {
    blocks: Vec<Block>,
    count: usize,
    /// The greatest magnitude of a packed coordinate on each axis.
    reach: [f64; 3],
    level: Level,
}

/// The least and greatest scores of a group, or of all points, along `R` directions.
#[derive(Clone, Copy)]
struct Range<const R: usize> {
    min: [f32; R],
    max: [f32; R],
}

impl Extremes {
    /// Packs points. There must be at least one, and all must be in range.
    pub(crate) fn new<T: Copy + Into<f64>>(points: &[[T; 3]]) -> Self {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for &point in points {
            let p = stored(point);
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        let center: [f64; 3] = std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]);
        let half = (0..3).fold(0.0_f64, |half, k| half.max(high[k] - center[k]).max(center[k] - low[k]));
        let scale = inverse_power(half);
        let reach = std::array::from_fn(|k| (high[k] - center[k]).max(center[k] - low[k]) * scale);
        let pack = |&point: &[T; 3]| {
            let p = stored(point);
            [0, 1, 2].map(|k| ((p[k] - center[k]) * scale) as f32)
        };
        let blocks = points
            .chunks(LANES)
            .map(|chunk| {
                // Unused lanes repeat the first point of the block, which changes no extreme.
                let mut block = [[0.0; LANES]; 3];
                for lane in 0..LANES {
                    let packed = pack(chunk.get(lane).unwrap_or(&chunk[0]));
                    for k in 0..3 {
                        block[k][lane] = packed[k];
                    }
                }
                block
            })
            .collect();
        Self { blocks, count: points.len(), reach, level: best_level() }
    }

    /// Returns the memory that the packed points take, in bytes.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(&self.blocks[..])
    }

    /// Returns the point that is farthest along a direction. Of equally far points, returns the
    /// first.
    pub(crate) fn along<T: Copy + Into<f64>>(&self, points: &[[T; 3]], direction: &[f64; 3]) -> u32 {
        self.of(points, &[*direction])[0][1]
    }

    /// Returns the points with the least and with the greatest value of `row · point` for each row.
    /// Of equal values, returns the first point.
    pub(crate) fn of<T: Copy + Into<f64>, const R: usize>(
        &self,
        points: &[[T; 3]],
        rows: &[[f64; 3]; R],
    ) -> [[u32; 2]; R] {
        let mut errors = [0.0_f32; R];
        let mut scaled = [[0.0_f32; 3]; R];
        for (row, (error, scaled)) in rows.iter().zip(errors.iter_mut().zip(&mut scaled)) {
            let scale = inverse_power(row.iter().fold(0.0, |largest, x| largest.max(x.abs())));
            let unit = row.map(|x| x * scale);
            let size: f64 = (0..3).map(|k| unit[k].abs() * self.reach[k]).sum();
            *error = ((6.0 * f64::from(f32::EPSILON) * 0.5 * size + UNDERFLOW) as f32).next_up();
            *scaled = unit.map(|x| x as f32);
        }
        let mut groups = Vec::with_capacity(self.blocks.len().div_ceil(GROUP_BLOCKS));
        let all = dispatch!(self.level, simd => self.ranges(simd, &scaled, &mut groups));
        let mut found = [[u32::MAX; 2]; R];
        for r in 0..R {
            let best = |wanted: Sign, is_near: &dyn Fn(f32) -> bool, near: &dyn Fn(&Range<R>) -> bool| {
                let mut best: Option<(u32, [f64; 3])> = None;
                for (group, _) in groups.iter().enumerate().filter(|(_, range)| near(range)) {
                    let start = group * GROUP_BLOCKS * LANES;
                    for index in start..(start + GROUP_BLOCKS * LANES).min(self.count) {
                        if !is_near(self.score(index, &scaled[r])) {
                            continue;
                        }
                        let point = stored(points[index]);
                        if best.is_none_or(|(_, best)| compare_along(&rows[r], &point, &best) == wanted) {
                            best = Some((index as u32, point));
                        }
                    }
                }
                best.map_or(0, |best| best.0)
            };
            // Both the best score and another one may be wrong by the error, and the second scan
            // may round differently.
            let low = all.min[r] + 4.0 * errors[r];
            let high = all.max[r] - 4.0 * errors[r];
            found[r] = [
                best(Negative, &|score| score <= low, &|range| range.min[r] <= low),
                best(Positive, &|score| score >= high, &|range| range.max[r] >= high),
            ];
        }
        found
    }

    /// Returns the score of one point, which equals the score of a lane up to rounding.
    #[inline(always)]
    fn score(&self, index: usize, row: &[f32; 3]) -> f32 {
        let (block, lane) = (&self.blocks[index / LANES], index % LANES);
        row[0] * block[0][lane] + row[1] * block[1][lane] + row[2] * block[2][lane]
    }

    /// Computes the ranges of all groups, and returns the range of all points.
    #[inline(always)]
    fn ranges<S: Simd, const R: usize>(&self, simd: S, rows: &[[f32; 3]; R], groups: &mut Vec<Range<R>>) -> Range<R> {
        let mut all = Range { min: [f32::INFINITY; R], max: [f32::NEG_INFINITY; R] };
        for group in self.blocks.chunks(GROUP_BLOCKS) {
            let mut min = [f32x8::splat(simd, f32::INFINITY); R];
            let mut max = [f32x8::splat(simd, f32::NEG_INFINITY); R];
            for block in group {
                let p: [f32x8<S>; 3] = by_axis!(axis => f32x8::from_slice(simd, &block[axis]));
                for r in 0..R {
                    let row: [f32x8<S>; 3] = by_axis!(axis => f32x8::splat(simd, rows[r][axis]));
                    let score = row[2].mul_add(p[2], row[1].mul_add(p[1], row[0] * p[0]));
                    min[r] = min[r].min(score);
                    max[r] = max[r].max(score);
                }
            }
            let mut range = all;
            for r in 0..R {
                range.min[r] = min[r].reduce_min();
                range.max[r] = max[r].reduce_max();
                all.min[r] = all.min[r].min(range.min[r]);
                all.max[r] = all.max[r].max(range.max[r]);
            }
            groups.push(range);
        }
        all
    }
}

/// Returns the power of two that scales a number into [1/2, 1), or as near as exponents allow, or 1
/// for zero.
fn inverse_power(x: f64) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    let exponent = (x.to_bits() >> 52 & 0x7ff) as i64 - 1022;
    f64::from_bits(((1023 - exponent).clamp(1, 2046) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::levels;

    struct Random(u64);

    impl Random {
        fn next(&mut self) -> i64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as i64
        }
    }

    /// Points with many ties and near ties, so that single precision alone would be wrong, at every
    /// vector level.
    #[test]
    fn every_level_finds_the_first_of_the_exact_extremes() {
        let mut random = Random(1);
        let mut close = 0;
        for case in 0..400 {
            let count = 1 + random.next() as usize % 500;
            let (scale, offset) = [(1.0, 0.0), (1e-3, 1.0), (1e30, 0.0), (1e-300, 0.0), (1.0, 1e9)][case % 5];
            let points: Vec<[f64; 3]> = (0..count)
                .map(|_| {
                    std::array::from_fn(|_| {
                        let nudge = [0.0, 1e-9, 1e-12][random.next() as usize % 3];
                        offset + scale * ((random.next() % 3) as f64 + nudge)
                    })
                })
                .collect();
            let rows: [[f64; 3]; 3] = std::array::from_fn(|row| {
                let size = [1.0, 1e300, 1e-300][(case + row) % 3];
                std::array::from_fn(|_| size * (random.next() % 5 - 2) as f64 * [1.0, 1.0 / 3.0][case % 2])
            });
            let mut packed = Extremes::new(&points);
            for (name, level) in levels() {
                packed.level = level;
                for (row, [low, high]) in rows.iter().zip(packed.of(&points, &rows)) {
                    for (found, wanted) in [(low, Positive), (high, Negative)] {
                        // No point is beyond the result, and no earlier point is equally far.
                        for (index, point) in points.iter().enumerate() {
                            let compared = compare_along(row, &points[found as usize], point);
                            assert_ne!(compared, wanted, "{name}");
                            assert!(compared != Sign::Zero || index >= found as usize, "{name}");
                            close += usize::from(compared == Sign::Zero && index != found as usize);
                        }
                    }
                    assert_eq!(packed.along(&points, row), high, "{name}");
                }
            }
        }
        assert!(close > 15_000 * levels().len(), "{close}");
    }
}
