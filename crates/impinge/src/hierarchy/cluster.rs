//! The bottom of a tree: a cluster of at most a few hundred boxes, split at medians into whole nodes and whole leaves.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 6.2.2, the median cut. Ours departs in that it never sorts: the widest
//! axis is halved five times about the median, by counting, and the boxes that are left between are told apart by their
//! order alone, which costs no tightness that can be measured.

use std::num::NonZeroU32;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8};

use super::binary::{BinaryNode, LEAF_CAPACITY, NODE_OF_LEAVES};
use super::boxes::Bounds;
use super::curve::{Key, index};
use crate::simd::LANES;

/// The most boxes of a cluster. Each level of a cluster costs a pass over it; twice as many cost a seventh more time and
/// gain nothing that can be measured.
pub(crate) const CLUSTER: usize = 8 * NODE_OF_LEAVES;

/// Twice the centre of a box.
#[derive(Clone, Copy, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
struct Centre {
    twice: [f32; 3],
    index: u32,
}

/// One cluster after another, in the same memory.
pub(crate) struct Cluster {
    centres: [Centre; CLUSTER],
    len: usize,
    spare: [Centre; CLUSTER],
    along: [f32; CLUSTER],
}

impl Cluster {
    pub(crate) fn new() -> Self {
        let centres: [Centre; CLUSTER] = bytemuck::Zeroable::zeroed();
        Self { centres, len: 0, spare: centres, along: [0.0; CLUSTER] }
    }

    /// Takes up the boxes of these keys, of which there are not too many.
    pub(crate) fn hold(&mut self, twice_centres: &[[f32; 4]], keys: &[Key]) {
        for (centre, &key) in self.centres.iter_mut().zip(keys) {
            let index = index(key);
            let [x, y, z, _] = twice_centres[index as usize];
            *centre = Centre { twice: [x, y, z], index };
        }
        self.len = keys.len().min(CLUSTER);
    }

    /// Writes the order of the boxes that it holds, of which the first is the tree's box `first`, appends their nodes in
    /// preorder, and returns what `bounds` keeps of them all.
    #[inline(always)]
    pub(crate) fn emit<S: Simd, B: Bounds>(
        &mut self,
        simd: S,
        bounds: impl Fn(&[u32]) -> B,
        order: &mut [u32],
        first: u32,
        nodes: &mut Vec<BinaryNode<B>>,
    ) -> B {
        /// What is left to emit, a range of the cluster: one for each level and one more.
        const MOST_LEFT: usize = 8;
        let Self { centres, len, spare, along } = self;
        let root = nodes.len();
        let mut left = [(0, 0); MOST_LEFT];
        left[0] = (0, *len);
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (start, len) = left[count];
            let (at, held) = (first + start as u32, len as u32);
            if len <= LEAF_CAPACITY {
                let order = &mut order[start..start + len];
                for (index, centre) in order.iter_mut().zip(&centres[start..]) {
                    *index = centre.index;
                }
                nodes.push(BinaryNode { bounds: bounds(order), first: at, count: held, right: None });
                continue;
            }
            let whole = if len > NODE_OF_LEAVES { NODE_OF_LEAVES } else { LEAF_CAPACITY };
            let low = len.div_ceil(whole).div_ceil(2) * whole;
            split(simd, &mut centres[start..start + len], &mut spare[..len], along, low);
            // All leaves of the lower part are full, so that its nodes are known before they are there.
            let right = NonZeroU32::new(2 * low.div_ceil(LEAF_CAPACITY) as u32);
            nodes.push(BinaryNode { bounds: B::EMPTY, first: at, count: held, right });
            left[count] = (start + low, len - low);
            left[count + 1] = (start, low);
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

/// Moves the `low` centres that come first along the widest axis to the front. `along` is room for a number for each, and for
/// whole lanes.
#[inline(always)]
fn split<S: Simd>(simd: S, centres: &mut [Centre], spare: &mut [Centre], along: &mut [f32], low: usize) {
    let Some((axis, least, greatest)) = widest_axis(simd, centres) else { return };
    for (along, centre) in along.iter_mut().zip(centres.iter()) {
        *along = centre.twice[axis];
    }
    let whole = centres.len().next_multiple_of(LANES);
    along[centres.len()..whole].fill(f32::INFINITY);
    let (from, to, below) = median(simd, &along[..whole], [least, greatest], low);
    if below == low {
        deal(
            centres,
            spare,
            #[inline(always)]
            |at| along[at] < from,
        );
    } else {
        let mut wanted = low - below;
        deal(
            centres,
            spare,
            #[inline(always)]
            |at| {
                let is_wanted = (along[at] >= from) & (along[at] < to) & (wanted > 0);
                wanted -= usize::from(is_wanted);
                (along[at] < from) | is_wanted
            },
        );
    }
}

/// Moves the centres that are low to the front, all in the order in which they come. `spare` is as long.
#[inline(always)]
fn deal(centres: &mut [Centre], spare: &mut [Centre], mut is_low: impl FnMut(usize) -> bool) {
    let (mut front, mut back) = (0, 0);
    for at in 0..centres.len() {
        let (centre, is_low) = (centres[at], is_low(at));
        // To either side, and the next one over the one that is not kept.
        centres[front] = centre;
        spare[back] = centre;
        front += usize::from(is_low);
        back += usize::from(!is_low);
    }
    centres[front..].copy_from_slice(&spare[..back]);
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
    let first = f32x4::from_slice(simd, bytemuck::cast_ref::<Centre, [f32; 4]>(&centres[0]));
    let (mut min, mut max) = (first.combine(first), first.combine(first));
    for pair in pairs {
        let pair = f32x8::from_slice(simd, bytemuck::cast_ref::<[Centre; 2], [f32; 8]>(pair));
        min = min.min(pair);
        max = max.max(pair);
    }
    let ((low_min, high_min), (low_max, high_max)) = (min.split(), max.split());
    let (mut min, mut max) = (low_min.min(high_min), low_max.max(high_max));
    for centre in last {
        let centre = f32x4::from_slice(simd, bytemuck::cast_ref::<Centre, [f32; 4]>(centre));
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
