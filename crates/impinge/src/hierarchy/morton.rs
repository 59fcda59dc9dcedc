//! The default builder: boxes sorted along a space-filling curve and split where its cells split, down to clusters that
//! are split at the median.
//!
//! Source: Lauterbach et al., *Fast BVH construction on GPUs*, Eurographics 2009; Karras, *Maximizing parallelism in the
//! construction of BVHs*, HPG 2012. Ours departs in three ways: 63-bit codes, so that small detail in a large scene
//! keeps its order; a bounded depth, by halving ranges once the curve has split often enough; and medians at the bottom
//! (Ericson, 6.2.2), which make leaves and nodes full and compact where a curve would jump.

use std::num::NonZeroU32;

use rayon::prelude::*;

use super::binary::{BinaryNode, BinaryTree, LEAF_CAPACITY, NODE_OF_LEAVES};
use crate::volume::Aabb;

/// Bits of a code for each axis; three axes fill 63 bits.
const BITS: u32 = 21;

/// Depth from which ranges are halved whatever the codes say: 2^32 boxes halved 23 times leave one cluster, which is at
/// most 6 deep, so that no leaf is deeper than 32 + 23 + 6, below [`MAX_DEPTH`](super::MAX_DEPTH).
const HALVE_FROM_DEPTH: usize = 32;

/// Ranges up to this long are split at medians, which costs a pass over the range for each level: twice the length
/// costs a seventh more build time and gains nothing that can be measured.
const CLUSTER: usize = 8 * NODE_OF_LEAVES;

/// Ranges longer than this are built as two tasks.
const SPLIT_TASKS_ABOVE: usize = 1 << 15;

/// The tree of these boxes, none of which may be empty; the same for any number of threads.
///
/// # Complexity
/// O(n log n), depth at most [`MAX_DEPTH`](super::MAX_DEPTH) for any input: equal, nested or sorted boxes included.
#[must_use]
pub fn build_morton(boxes: &[Aabb]) -> BinaryTree {
    if boxes.is_empty() {
        return BinaryTree::default();
    }
    let builder = Builder { boxes, curve: Curve::over(boxes) };
    let mut order = builder.sorted();
    let mut blocks = Vec::new();
    builder.subtree(&mut order, 0, 0, &mut blocks);
    BinaryTree { nodes: blocks.concat(), order }
}

/// The space-filling curve over the range of the boxes' centres.
struct Curve {
    origin: [f32; 3],
    scale: [f32; 3],
}

impl Curve {
    fn over(boxes: &[Aabb]) -> Self {
        let bounds = boxes.par_iter().copied().reduce(|| Aabb::EMPTY, Aabb::union);
        let cells = (1_u32 << BITS) as f32;
        // Twice the centre runs from twice the least bound over a range of twice the extent.
        let origin = std::array::from_fn(|axis| 2.0 * bounds.min[axis]);
        let scale = std::array::from_fn(|axis| {
            let extent = 2.0 * (bounds.max[axis] - bounds.min[axis]);
            if extent > 0.0 { cells / extent } else { 0.0 }
        });
        Self { origin, scale }
    }

    /// How far along the curve a box's centre lies, in 63 bits.
    fn code(&self, bounds: &Aabb) -> u64 {
        (0..3).fold(0, |code, axis| {
            let cell = (bounds.min[axis] + bounds.max[axis] - self.origin[axis]) * self.scale[axis];
            // A float cast saturates, and takes NaN to zero: any cell is a legal one.
            let cell = (cell as u32).min((1 << BITS) - 1);
            code | spread(cell) << axis
        })
    }
}

/// The low 21 bits of `x`, each followed by two zeros.
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x) & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

struct Builder<'a> {
    boxes: &'a [Aabb],
    curve: Curve,
}

impl Builder<'_> {
    fn code(&self, index: u32) -> u64 {
        self.curve.code(&self.boxes[index as usize])
    }

    /// The boxes along the curve, ties by their index: dealt out by the leading bits of their codes, and sorted within
    /// each deal that is too long to be a cluster, in which order does not matter.
    fn sorted(&self) -> Vec<u32> {
        const DEAL_BITS: u32 = 15;
        let deals: Vec<u16> =
            self.boxes.par_iter().map(|bounds| (self.curve.code(bounds) >> (3 * BITS - DEAL_BITS)) as u16).collect();
        let mut starts = vec![0_u32; (1 << DEAL_BITS) + 1];
        for &deal in &deals {
            starts[usize::from(deal) + 1] += 1;
        }
        for at in 1..starts.len() {
            starts[at] += starts[at - 1];
        }
        let mut order = vec![0; deals.len()];
        let mut next = starts.clone();
        for (index, &deal) in deals.iter().enumerate() {
            let place = &mut next[usize::from(deal)];
            order[*place as usize] = index as u32;
            *place += 1;
        }
        let mut rest = &mut order[..];
        let mut long = Vec::new();
        for ends in starts.windows(2) {
            let (deal, after) = rest.split_at_mut((ends[1] - ends[0]) as usize);
            rest = after;
            if deal.len() > CLUSTER {
                long.push(deal);
            }
        }
        long.into_par_iter().for_each(|deal| {
            let mut keys: Vec<(u64, u32)> = deal.par_iter().map(|&index| (self.code(index), index)).collect();
            keys.par_sort_unstable();
            for (index, key) in deal.iter_mut().zip(keys) {
                *index = key.1;
            }
        });
        order
    }

    /// Appends the nodes of a range in preorder, in blocks, and returns its bounds and how many nodes there are.
    /// `order` is its part of the order, which starts at `first`, and is rearranged within clusters.
    fn subtree(
        &self,
        order: &mut [u32],
        first: usize,
        depth: usize,
        blocks: &mut Vec<Vec<BinaryNode>>,
    ) -> (Aabb, usize) {
        let count = order.len();
        if count <= SPLIT_TASKS_ABOVE {
            let mut nodes = Vec::with_capacity(count / (LEAF_CAPACITY / 2) + 1);
            let bounds = self.emit(order, first, depth, &mut nodes);
            let len = nodes.len();
            blocks.push(nodes);
            return (bounds, len);
        }
        let middle = self.split(order, depth);
        let (low, high) = order.split_at_mut(middle);
        let (mut left_blocks, mut right_blocks) = (Vec::new(), Vec::new());
        let ((left, left_len), (right, right_len)) = rayon::join(
            || self.subtree(low, first, depth + 1, &mut left_blocks),
            || self.subtree(high, first + middle, depth + 1, &mut right_blocks),
        );
        let bounds = left.union(right);
        let right = NonZeroU32::new(1 + left_len as u32);
        blocks.push(vec![BinaryNode { bounds, first: first as u32, count: count as u32, right }]);
        blocks.append(&mut left_blocks);
        blocks.append(&mut right_blocks);
        (bounds, 1 + left_len + right_len)
    }

    /// Appends the nodes of a range, the root first, and returns its bounds.
    fn emit(&self, order: &mut [u32], first: usize, depth: usize, nodes: &mut Vec<BinaryNode>) -> Aabb {
        if order.len() <= CLUSTER {
            let mut centres = [Centre::default(); CLUSTER];
            let centres = &mut centres[..order.len()];
            for (centre, &index) in centres.iter_mut().zip(order.iter()) {
                *centre = Centre::of(&self.boxes[index as usize], index);
            }
            let bounds = self.emit_cluster(centres, first, nodes);
            for (index, centre) in order.iter_mut().zip(centres) {
                *index = centre.index;
            }
            return bounds;
        }
        let middle = self.split(order, depth);
        let (low, high) = order.split_at_mut(middle);
        emit_inner(
            first,
            low.len() + high.len(),
            nodes,
            |nodes| self.emit(low, first, depth + 1, nodes),
            |nodes| self.emit(high, first + middle, depth + 1, nodes),
        )
    }

    /// Appends the nodes of a cluster, split at medians in whole leaves, or whole nodes of leaves, and returns its
    /// bounds.
    fn emit_cluster(&self, centres: &mut [Centre], first: usize, nodes: &mut Vec<BinaryNode>) -> Aabb {
        let count = centres.len();
        if count <= LEAF_CAPACITY {
            let bounds =
                centres.iter().fold(Aabb::EMPTY, |bounds, centre| bounds.union(self.boxes[centre.index as usize]));
            nodes.push(BinaryNode { bounds, first: first as u32, count: count as u32, right: None });
            return bounds;
        }
        let whole = if count > NODE_OF_LEAVES { NODE_OF_LEAVES } else { LEAF_CAPACITY };
        let middle = count.div_ceil(whole).div_ceil(2) * whole;
        let axis = widest_axis(centres);
        centres.select_nth_unstable_by_key(middle, |centre| centre.key(axis));
        let (low, high) = centres.split_at_mut(middle);
        emit_inner(
            first,
            count,
            nodes,
            |nodes| self.emit_cluster(low, first, nodes),
            |nodes| self.emit_cluster(high, first + middle, nodes),
        )
    }

    /// Where to split a sorted range longer than a cluster: where the curve's cells split; strictly inside it.
    fn split(&self, order: &[u32], depth: usize) -> usize {
        let (low, high) = (self.code(order[0]), self.code(order[order.len() - 1]));
        if low == high || depth >= HALVE_FROM_DEPTH {
            return order.len() / 2;
        }
        let top_bit = 1 << (low ^ high).ilog2();
        order.partition_point(|&index| self.code(index) & top_bit == 0)
    }
}

/// Appends an inner node and what its two sides append, and returns its bounds.
fn emit_inner(
    first: usize,
    count: usize,
    nodes: &mut Vec<BinaryNode>,
    left: impl FnOnce(&mut Vec<BinaryNode>) -> Aabb,
    right: impl FnOnce(&mut Vec<BinaryNode>) -> Aabb,
) -> Aabb {
    let at = nodes.len();
    nodes.push(BinaryNode { bounds: Aabb::EMPTY, first: first as u32, count: count as u32, right: None });
    let left_bounds = left(nodes);
    let right_at = NonZeroU32::new((nodes.len() - at) as u32);
    let bounds = left_bounds.union(right(nodes));
    nodes[at].bounds = bounds;
    nodes[at].right = right_at;
    bounds
}

/// Twice the centre of a box.
#[derive(Clone, Copy, Default)]
struct Centre {
    twice: [f32; 3],
    index: u32,
}

impl Centre {
    fn of(bounds: &Aabb, index: u32) -> Self {
        Self { twice: std::array::from_fn(|axis| bounds.min[axis] + bounds.max[axis]), index }
    }

    /// Sorts by one coordinate as floats do, then by the index.
    #[inline(always)]
    fn key(&self, axis: usize) -> u64 {
        let bits = self.twice[axis].to_bits();
        // A negative float's bits grow the wrong way; a positive one's need their top bit to come after it.
        let ordered = if bits >> 31 == 1 { !bits } else { bits | 1 << 31 };
        u64::from(ordered) << 32 | u64::from(self.index)
    }
}

/// The axis along which the centres spread most.
fn widest_axis(centres: &[Centre]) -> usize {
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for centre in centres {
        for axis in 0..3 {
            let x = centre.twice[axis];
            min[axis] = if x < min[axis] { x } else { min[axis] };
            max[axis] = if x > max[axis] { x } else { max[axis] };
        }
    }
    let extent: [f32; 3] = std::array::from_fn(|axis| max[axis] - min[axis]);
    if extent[0] >= extent[1] && extent[0] >= extent[2] {
        0
    } else if extent[1] >= extent[2] {
        1
    } else {
        2
    }
}
