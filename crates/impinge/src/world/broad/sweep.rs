//! All pairs of a few boxes that overlap, by a sort and a sweep.
//!
//! The boxes are sorted along the axis on which their centers are spread most. Each is compared
//! with those that begin before it ends, four at a time. All comparisons are exact.
//!
//! Source: Baraff, *Dynamic Simulation of Non-Penetrating Rigid Bodies*, Cornell University, 1992
//! (Ericson, 7.5). Ours sorts anew at each step, and sweeps along one axis.
//!
//! Guarded by the tests below, and by the benchmark `small_worlds`.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f64x4};

use crate::budget::{Budget, Stopped};
use crate::simd::{bits, by_axis, dispatch};
use crate::storage::TryPush;
use crate::volume::MinMax;

/// Number of boxes that are compared at once.
const LANES: usize = 4;

/// Four boxes: on each axis their smallest and their largest coordinates. Lanes without a box have
/// an empty one, which overlaps no other.
type Block = [[[f64; LANES]; 2]; 3];

/// Returns the pairs of indices of boxes that overlap. Touching counts.
///
/// # Errors
/// Returns an error if the budget ended the sweep, or if there is not enough memory.
pub(super) fn pairs(level: Level, boxes: &[MinMax], budget: &Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> {
    let axis = widest_axis(boxes);
    let mut order: Vec<(i64, u32)> = Vec::new();
    order.try_reserve_exact(boxes.len())?;
    order.extend((0..).zip(boxes).map(|(index, bounds)| (order_of(bounds.ends(axis)[0]), index)));
    order.sort_unstable_by_key(|&(begin, _)| begin);
    let mut blocks: Vec<Block> = Vec::new();
    blocks.try_reserve_exact(boxes.len().div_ceil(LANES))?;
    blocks.extend(order.chunks(LANES).map(|indices| block(boxes, indices)));
    let mut pairs = Vec::new();
    dispatch!(level, simd => sweep(simd, (boxes, &order, &blocks), axis, budget, &mut pairs))?;
    Ok(pairs)
}

fn block(boxes: &[MinMax], indices: &[(i64, u32)]) -> Block {
    let mut block = [[[f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]]; 3];
    for (lane, &(_, index)) in indices.iter().enumerate() {
        for (axis, sides) in block.iter_mut().enumerate() {
            let ends = boxes[index as usize].ends(axis);
            (sides[0][lane], sides[1][lane]) = (ends[0], ends[1]);
        }
    }
    block
}

/// Compares each box with those after it in the order along an axis.
#[inline(always)]
fn sweep<S: Simd>(
    simd: S,
    (boxes, order, blocks): (&[MinMax], &[(i64, u32)], &[Block]),
    axis: usize,
    budget: &Budget<'_>,
    pairs: &mut Vec<[u32; 2]>,
) -> Result<(), Stopped> {
    for (at, &(_, index)) in order.iter().enumerate() {
        budget.check()?;
        let bounds = &boxes[index as usize];
        let low = by_axis!(k => f64x4::splat(simd, bounds.ends(k)[0]));
        let high = by_axis!(k => f64x4::splat(simd, bounds.ends(k)[1]));
        let (own, end) = (at / LANES, bounds.ends(axis)[1]);
        for (number, block) in (own..).zip(&blocks[own..]) {
            if number > own && block[axis][0][0] > end {
                break;
            }
            let meets = by_axis!(k => {
                let [begins, ends] = [f64x4::from_slice(simd, &block[k][0]), f64x4::from_slice(simd, &block[k][1])];
                begins.simd_le(high[k]) & low[k].simd_le(ends)
            });
            let after = if number > own { u32::MAX } else { u32::MAX << (at % LANES) << 1 };
            let found = (meets[0] & meets[1] & meets[2]).to_bitmask() as u32 & after;
            for lane in bits(found) {
                pairs.try_push([index, order[number * LANES + lane].1])?;
            }
        }
    }
    Ok(())
}

/// Returns the axis on which the centers of boxes vary most.
fn widest_axis(boxes: &[MinMax]) -> usize {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for bounds in boxes {
        for axis in 0..3 {
            let [begin, end] = bounds.ends(axis);
            let center = begin + end;
            low[axis] = if center < low[axis] { center } else { low[axis] };
            high[axis] = if center > high[axis] { center } else { high[axis] };
        }
    }
    let spreads = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    (1..3).fold(0, |widest, axis| if spreads[axis] > spreads[widest] { axis } else { widest })
}

/// Returns an integer that is ordered as [`f64::total_cmp`] orders numbers. Sorting integers takes
/// fewer instructions.
#[inline]
fn order_of(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::levels;
    use crate::volume::BoundingVolume;
    use impinge_testkit::generate::Rng;

    /// Boxes with corners on a small grid share most of their sides.
    #[test]
    fn the_sweep_finds_the_pairs_of_every_comparison() {
        let mut rng = Rng::new(17);
        let (mut found, mut apart) = (0, 0);
        for round in 0..300 {
            let flat = round % 4;
            let mut bounds = || {
                let low: [f64; 3] = std::array::from_fn(|k| if k == flat { 2.0 } else { rng.integer(-3, 6) as f64 });
                let high = low.map(|x| x + rng.integer(0, 2) as f64);
                MinMax::from_ordered(low, high)
            };
            let boxes: Vec<MinMax> = (0..7 * round % 41).map(|_| bounds()).collect();
            let mut expected = Vec::new();
            for (at, bounds) in boxes.iter().enumerate() {
                let others = (at + 1..boxes.len()).filter(|&other| boxes[other].overlaps(bounds));
                expected.extend(others.map(|other| [at as u32, other as u32]));
            }
            for (_, level) in levels() {
                let mut pairs = pairs(level, &boxes, Budget::unlimited()).expect("no limits");
                pairs.iter_mut().for_each(|pair| pair.sort_unstable());
                pairs.sort_unstable();
                assert_eq!(pairs, expected);
            }
            apart += boxes.len() * boxes.len().saturating_sub(1) / 2 - expected.len();
            found += expected.len();
        }
        assert!(found > 3000 && apart > 10_000, "{found} {apart}");
    }

    #[test]
    fn integers_are_ordered_as_numbers() {
        let mut rng = Rng::new(18);
        let numbers = [0.0, -0.0, 1.0, -1.0, 5e-324, f64::MAX, f64::MIN, f64::NEG_INFINITY];
        let any = (0..200).map(|_| rng.uniform(-2.0, 2.0));
        let all: Vec<f64> = numbers.into_iter().chain(any).collect();
        for (x, y) in all.iter().flat_map(|x| all.iter().map(move |y| (*x, *y))) {
            assert_eq!(order_of(x).cmp(&order_of(y)), x.total_cmp(&y), "{x} {y}");
        }
    }

    #[test]
    fn the_sweep_is_along_the_widest_axis() {
        for axis in 0..3 {
            let bounds = |at: i32| {
                let low = std::array::from_fn(|k| f64::from(at) * if k == axis { 8.0 } else { 1.0 });
                MinMax::from_ordered(low, low)
            };
            assert_eq!(widest_axis(&(0..4).map(bounds).collect::<Vec<_>>()), axis);
        }
        assert_eq!(widest_axis(&[]), 0);
    }
}
