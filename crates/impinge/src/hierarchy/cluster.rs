//! The bottom of a tree: a cluster of at most a few hundred boxes, split at medians into whole nodes and whole leaves.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 6.2.2, the median cut. Ours departs in that it never sorts: the widest
//! axis is halved five times about the median, by counting, and the boxes that are left between are told apart by their
//! order alone, which costs no tightness that can be measured.

use std::num::NonZeroU32;

use bytemuck::Zeroable;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::binary::{BinaryNode, LEAF_CAPACITY, NODE_OF_LEAVES};
use super::boxes::{Bounds, Centre};
use crate::simd::LANES;

/// The most boxes of a cluster. Each level of a cluster costs a pass over it; twice as many cost a seventh more time and
/// gain nothing that can be measured.
pub(crate) const CLUSTER: usize = 8 * NODE_OF_LEAVES;

/// Room for one cluster after another.
pub(crate) struct Cluster {
    spare: [Centre; CLUSTER],
    along: [f32; CLUSTER],
}

/// What is left to emit: a range of the cluster, and whether it is in the spare room.
#[derive(Clone, Copy, Default)]
struct Left {
    start: usize,
    len: usize,
    is_spare: bool,
}

impl Default for Cluster {
    fn default() -> Self {
        Self { spare: Zeroable::zeroed(), along: [0.0; CLUSTER] }
    }
}

impl Cluster {
    /// Groups the boxes of a cluster, of which the first is the tree's box `first`, writes their order, appends their nodes in
    /// preorder, and returns what `bounds` keeps of them all.
    #[inline(always)]
    pub(crate) fn emit<S: Simd, B: Bounds>(
        &mut self,
        simd: S,
        centres: &mut [Centre],
        bounds: impl Fn(&[u32]) -> B,
        order: &mut [u32],
        first: u32,
        nodes: &mut Vec<BinaryNode<B>>,
    ) -> B {
        /// One range for each level and one more.
        const MOST_LEFT: usize = 8;
        let Self { spare, along } = self;
        let root = nodes.len();
        let mut left = [Left::default(); MOST_LEFT];
        left[0].len = centres.len();
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let Left { start, len, is_spare } = left[count];
            let all = start..start + len;
            let (from, to) = if is_spare { (&mut spare[..], &mut *centres) } else { (&mut *centres, &mut spare[..]) };
            let (from, to, order) = (&from[all.clone()], &mut to[all.clone()], &mut order[all]);
            let at = first + start as u32;
            let leaf = |order: &[u32], at: u32| BinaryNode {
                bounds: bounds(order),
                first: at,
                count: order.len() as u32,
                right: None,
            };
            if len <= LEAF_CAPACITY {
                for (index, centre) in order.iter_mut().zip(from) {
                    *index = centre.index;
                }
                nodes.push(leaf(order, at));
                continue;
            }
            let whole = if len > NODE_OF_LEAVES { NODE_OF_LEAVES } else { LEAF_CAPACITY };
            let low = len.div_ceil(whole).div_ceil(2) * whole;
            // All leaves of the lower part are full, so that its nodes are known before they are there.
            let right = NonZeroU32::new(2 * low.div_ceil(LEAF_CAPACITY) as u32);
            nodes.push(BinaryNode { bounds: B::EMPTY, first: at, count: len as u32, right });
            if len <= 2 * LEAF_CAPACITY {
                halve(
                    simd,
                    from,
                    along,
                    low,
                    #[inline(always)]
                    |place, centre| order[place] = centre.index,
                );
                let (low_order, high_order) = order.split_at(low);
                nodes.extend([leaf(low_order, at), leaf(high_order, at + low as u32)]);
                continue;
            }
            halve(
                simd,
                from,
                along,
                low,
                #[inline(always)]
                |place, centre| to[place] = *centre,
            );
            left[count] = Left { start: start + low, len: len - low, is_spare: !is_spare };
            left[count + 1] = Left { start, len: low, is_spare: !is_spare };
            count += 2;
        }
        for at in (root..nodes.len()).rev() {
            if let Some(right) = nodes[at].right {
                nodes[at].bounds = nodes[at + 1].bounds.union(nodes[at + right.get() as usize].bounds);
            }
        }
        nodes[root].bounds
    }
}

/// Puts each centre in its place: the `low` ones that come first along the widest axis before the others, all else in the order in
/// which they come. `along` is room for a number for each, and for whole lanes.
#[inline(always)]
fn halve<S: Simd>(simd: S, centres: &[Centre], along: &mut [f32], low: usize, mut put: impl FnMut(usize, &Centre)) {
    let Some((axis, least, greatest)) = widest_axis(simd, centres) else {
        for (at, centre) in centres.iter().enumerate() {
            put(at, centre);
        }
        return;
    };
    for (along, centre) in along.iter_mut().zip(centres) {
        *along = centre.twice[axis];
    }
    let whole = centres.len().next_multiple_of(LANES);
    along[centres.len()..whole].fill(f32::INFINITY);
    let (from, to, below) = median(simd, &along[..whole], [least, greatest], low);
    let (from, to, mut wanted) = (f32x8::splat(simd, from), f32x8::splat(simd, to), (low - below) as u64);
    let mut next = [0, low];
    for (eight, along) in along[..whole].as_chunks::<LANES>().0.iter().enumerate() {
        let along = f32x8::from_slice(simd, along);
        let below = along.simd_lt(from).to_bitmask();
        let between = first_bits(along.simd_lt(to).to_bitmask() & !below, wanted);
        wanted -= u64::from(between.count_ones());
        let low_lanes = below | between;
        let centres = &centres[LANES * eight..];
        match centres.first_chunk::<LANES>() {
            Some(eight) => put_each(eight, low_lanes, &mut next, &mut put),
            None => put_each(centres, low_lanes, &mut next, &mut put),
        }
    }
}

/// Puts those of which there is a bit in the next place of the one kind, the others in that of the other.
#[inline(always)]
fn put_each(centres: &[Centre], bits: u64, [front, back]: &mut [usize; 2], put: &mut impl FnMut(usize, &Centre)) {
    for (lane, centre) in centres.iter().enumerate() {
        let is_front = (bits >> lane & 1) as usize;
        put(if is_front == 0 { *back } else { *front }, centre);
        *front += is_front;
        *back += 1 - is_front;
    }
}

/// At most so many bits, the lowest ones.
#[inline(always)]
fn first_bits(bits: u64, count: u64) -> u64 {
    if u64::from(bits.count_ones()) <= count {
        return bits;
    }
    let mut others = bits;
    for _ in 0..count {
        others &= others - 1;
    }
    bits ^ others
}

/// An interval, as short as halving makes it, such that at most `low` numbers are below it and more than as many are
/// below its end; and how many are below it. Where that is `low` itself, nobody looks at the end.
#[inline(always)]
fn median<S: Simd>(simd: S, along: &[f32], [least, greatest]: [f32; 2], low: usize) -> (f32, f32, usize) {
    /// Each halves the interval.
    const ROUNDS: usize = 5;
    let (mut from, mut to, mut below) = (least, f32::INFINITY, 0);
    let mut end = greatest;
    for _ in 0..ROUNDS {
        let middle = from + 0.5 * (end - from);
        let (lanes, pivot) = (along.as_chunks::<LANES>().0, f32x8::splat(simd, middle));
        let mut count = 0;
        for lanes in lanes {
            count += f32x8::from_slice(simd, lanes).simd_lt(pivot).to_bitmask().count_ones();
        }
        let count = count as usize;
        let is_low = count <= low;
        from = if is_low { middle } else { from };
        below = if is_low { count } else { below };
        to = if is_low { to } else { middle };
        end = if is_low { end } else { middle };
        if below == low {
            break;
        }
    }
    (from, to, below)
}

/// The axis along which the centres spread most, and from where to where; none where they coincide or reach too far.
#[inline(always)]
fn widest_axis<S: Simd>(simd: S, centres: &[Centre]) -> Option<(usize, f32, f32)> {
    let (pairs, last) = centres.as_chunks::<2>();
    let first = centres[0].lanes(simd);
    let (mut min, mut max) = (first.combine(first), first.combine(first));
    for pair in pairs {
        let pair = f32x8::from_slice(simd, bytemuck::cast_ref::<[Centre; 2], [f32; 8]>(pair));
        min = min.min(pair);
        max = max.max(pair);
    }
    let ((low_min, high_min), (low_max, high_max)) = (min.split(), max.split());
    let (mut min, mut max) = (low_min.min(high_min), low_max.max(high_max));
    for centre in last {
        let centre = centre.lanes(simd);
        min = min.min(centre);
        max = max.max(centre);
    }
    let extent = max - min;
    let mut widest = 0;
    for axis in 1..3 {
        if extent[axis] > extent[widest] {
            widest = axis;
        }
    }
    (extent[widest] > 0.0 && extent[widest].is_finite()).then_some((widest, min[widest], max[widest]))
}
