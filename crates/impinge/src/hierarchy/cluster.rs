//! The bottom of a tree: a cluster of at most a few hundred boxes, split at medians into whole nodes and whole leaves.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 6.2.2, the median cut. Ours departs in that it never sorts: boxes are
//! counted into bins along the widest axis, and those that share the bin of the median are told apart by their order
//! alone, which costs no tightness that can be measured and a fifth of the time.

use std::num::NonZeroU32;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};

use super::binary::{BinaryNode, LEAF_CAPACITY, NODE_OF_LEAVES};
use super::boxes::Boxes;
use crate::volume::Aabb;

/// The most boxes of a cluster. Each level of a cluster costs a pass over it; twice as many cost a seventh more time and
/// gain nothing that can be measured.
pub(crate) const CLUSTER: usize = 8 * NODE_OF_LEAVES;

/// Bins along an axis; a power of two.
const BINS: usize = 32;

/// Twice the centre of a box.
#[derive(Clone, Copy, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
struct Centre {
    twice: [f32; 3],
    index: u32,
}

/// Appends the nodes of a cluster in preorder and returns its bounds. `order` is its part of the order, which starts at
/// `first`, and is rearranged.
#[inline(always)]
pub(crate) fn emit<S: Simd, B: Boxes + ?Sized>(
    simd: S,
    boxes: &B,
    order: &mut [u32],
    first: u32,
    nodes: &mut Vec<BinaryNode>,
) -> Aabb {
    /// What is left to emit, a range of the cluster: one for each level and one more.
    const MOST_LEFT: usize = 8;
    let len = order.len();
    let mut centres: [Centre; CLUSTER] = bytemuck::Zeroable::zeroed();
    let mut spare = centres;
    let mut bins = [0; CLUSTER];
    for (centre, &index) in centres.iter_mut().zip(order.iter()) {
        boxes.twice_centre(simd, index).store_slice(bytemuck::cast_mut::<Centre, [f32; 4]>(centre));
        centre.index = index;
    }
    let root = nodes.len();
    let mut left = [(0, 0); MOST_LEFT];
    left[0] = (0, len);
    let mut count = 1;
    while count > 0 {
        count -= 1;
        let (start, len) = left[count];
        let (at, held) = (first + start as u32, len as u32);
        if len <= LEAF_CAPACITY {
            for (index, centre) in order[start..start + len].iter_mut().zip(&centres[start..]) {
                *index = centre.index;
            }
            let bounds = boxes.bounds(simd, &order[start..start + len]);
            nodes.push(BinaryNode { bounds, first: at, count: held, right: None });
            continue;
        }
        let whole = if len > NODE_OF_LEAVES { NODE_OF_LEAVES } else { LEAF_CAPACITY };
        let low = len.div_ceil(whole).div_ceil(2) * whole;
        split(simd, &mut centres[start..start + len], &mut spare[..len], &mut bins[..len], low);
        // All leaves of the lower part are full, so that its nodes are known before they are there.
        let right = NonZeroU32::new(2 * low.div_ceil(LEAF_CAPACITY) as u32);
        nodes.push(BinaryNode { bounds: Aabb::EMPTY, first: at, count: held, right });
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

/// Moves the `low` centres that come first along the widest axis to the front.
#[inline(always)]
fn split<S: Simd>(simd: S, centres: &mut [Centre], spare: &mut [Centre], bins: &mut [u8], low: usize) {
    /// Added to a small positive number, leaves its nearest integer in the lowest bits.
    const ROUND: f32 = (1 << 23) as f32;
    let Some((axis, least, extent)) = widest_axis(simd, centres) else { return };
    let scale = (BINS - 1) as f32 / extent;
    if !(extent.is_finite() && scale.is_finite()) {
        return;
    }
    let mut held = [0_u16; BINS];
    for (bin, centre) in bins.iter_mut().zip(centres.iter()) {
        *bin = (((centre.twice[axis] - least) * scale + ROUND).to_bits() as usize % BINS) as u8;
        held[usize::from(*bin) % BINS] += 1;
    }
    let (mut middle, mut below) = (0, 0);
    while middle < BINS - 1 && below + usize::from(held[middle]) <= low {
        below += usize::from(held[middle]);
        middle += 1;
    }
    let mut wanted_of_middle = low - below;
    let (mut front, mut back) = (0, low);
    for (&bin, centre) in bins.iter().zip(centres.iter()) {
        let is_wanted = usize::from(usize::from(bin) == middle && wanted_of_middle > 0);
        wanted_of_middle -= is_wanted;
        let is_low = usize::from(usize::from(bin) < middle) | is_wanted;
        spare[if is_low == 1 { front } else { back }] = *centre;
        front += is_low;
        back += 1 - is_low;
    }
    centres.copy_from_slice(spare);
}

/// The axis along which the centres spread most, where they begin on it and how far they reach; none where they
/// coincide.
#[inline(always)]
fn widest_axis<S: Simd>(simd: S, centres: &[Centre]) -> Option<(usize, f32, f32)> {
    let first = f32x4::from_slice(simd, bytemuck::cast_ref::<Centre, [f32; 4]>(&centres[0]));
    let (mut min, mut max) = (first, first);
    for centre in centres {
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
    (extent[widest] > 0.0).then_some((widest, min[widest], extent[widest]))
}
