//! The linear builder: boxes sorted along a space-filling curve, split where the curve's cells split.
//!
//! Source: Lauterbach et al., *Fast BVH construction on GPUs*, Eurographics 2009; Karras, *Maximizing parallelism in the
//! construction of BVHs*, HPG 2012. Ours departs in three ways: 63-bit codes, so that small detail in a large scene
//! keeps its order; a bounded depth, by halving ranges once the curve has split often enough; and short ranges split
//! where the surface area heuristic likes it best, in whole packets, which keeps the leaves full.

use std::num::NonZeroU32;

use rayon::prelude::*;

use super::binary::{BinaryNode, BinaryTree, LEAF_CAPACITY};
use crate::volume::Aabb;

/// Bits of a code for each axis; three axes fill 63 bits.
const BITS: u32 = 21;

/// Depth from which ranges are halved whatever the codes say. 2^32 boxes halved 29 times leave one packet, so that no
/// leaf is deeper than 32 + 29, below [`MAX_DEPTH`](super::MAX_DEPTH).
const HALVE_FROM_DEPTH: usize = 32;

/// Ranges up to this long are split at the median, in whole packets.
const MEDIAN_UP_TO: usize = 8 * LEAF_CAPACITY;

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
    let mut keys = sorted_keys(boxes);
    let nodes = Builder { boxes }.subtree(&mut keys, 0, 0);
    let order = keys.par_iter().map(|key| key.index).collect();
    BinaryTree { nodes, order }
}

/// A box's place on the curve; ties are broken by its index, so that the order is one only.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    code: u64,
    index: u32,
}

fn sorted_keys(boxes: &[Aabb]) -> Vec<Key> {
    let bounds = boxes.par_iter().copied().reduce(|| Aabb::EMPTY, Aabb::union);
    // Twice the centre runs from twice the least bound over a range of twice the extent.
    let origin: [f32; 3] = std::array::from_fn(|axis| 2.0 * bounds.min[axis]);
    let cells = (1_u32 << BITS) as f32;
    let scale: [f32; 3] = std::array::from_fn(|axis| {
        let extent = 2.0 * (bounds.max[axis] - bounds.min[axis]);
        if extent > 0.0 { cells / extent } else { 0.0 }
    });
    let code = |bounds: &Aabb| {
        (0..3).fold(0, |code, axis| {
            let cell = (bounds.min[axis] + bounds.max[axis] - origin[axis]) * scale[axis];
            // A float cast saturates, and takes NaN to zero: any cell is a legal one.
            let cell = (cell as u32).min((1 << BITS) - 1);
            code | spread(cell) << axis
        })
    };
    let mut keys: Vec<Key> =
        boxes.par_iter().enumerate().map(|(index, bounds)| Key { code: code(bounds), index: index as u32 }).collect();
    keys.par_sort_unstable();
    keys
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
}

impl Builder<'_> {
    /// The nodes of these keys, which stand at `first` in the order, in preorder and counted from zero.
    fn subtree(&self, keys: &mut [Key], first: usize, depth: usize) -> Vec<BinaryNode> {
        if keys.len() <= SPLIT_TASKS_ABOVE {
            let mut nodes = Vec::with_capacity(keys.len() / 2);
            self.emit(keys, first, depth, &mut nodes);
            return nodes;
        }
        let middle = split(keys, depth);
        let (low, high) = keys.split_at_mut(middle);
        let (left, right) = rayon::join(
            || self.subtree(low, first, depth + 1),
            || self.subtree(high, first + middle, depth + 1),
        );
        let right_at = 1 + left.len() as u32;
        let bounds = left[0].bounds.union(right[0].bounds);
        let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
        nodes.push(BinaryNode {
            bounds,
            first: first as u32,
            count: keys.len() as u32,
            right: NonZeroU32::new(right_at),
        });
        nodes.extend(left.into_iter().map(|node| node.moved_by(1)));
        nodes.extend(right.into_iter().map(|node| node.moved_by(right_at)));
        nodes
    }

    /// Appends the nodes of these keys, the root first, and returns its bounds.
    fn emit(&self, keys: &mut [Key], first: usize, depth: usize, nodes: &mut Vec<BinaryNode>) -> Aabb {
        let at = nodes.len();
        if keys.len() <= LEAF_CAPACITY {
            let bounds = keys.iter().fold(Aabb::EMPTY, |bounds, key| bounds.union(self.boxes[key.index as usize]));
            nodes.push(BinaryNode { bounds, first: first as u32, count: keys.len() as u32, right: None });
            return bounds;
        }
        let (first_box, count) = (first as u32, keys.len() as u32);
        nodes.push(BinaryNode { bounds: Aabb::EMPTY, first: first_box, count, right: None });
        let middle = if keys.len() <= MEDIAN_UP_TO { self.median(keys) } else { split(keys, depth) };
        let (low, high) = keys.split_at_mut(middle);
        let left = self.emit(low, first, depth + 1, nodes);
        let right_at = nodes.len() as u32;
        let right = self.emit(high, first + middle, depth + 1, nodes);
        nodes[at].bounds = left.union(right);
        nodes[at].right = NonZeroU32::new(right_at);
        nodes[at].bounds
    }

    /// Moves the half with the smaller centres on the axis along which they spread most to the front, in whole packets.
    fn median(&self, keys: &mut [Key]) -> usize {
        let mut centres = [(0.0, Key { code: 0, index: 0 }); MEDIAN_UP_TO];
        let mut spread = Aabb::EMPTY;
        for key in keys.iter() {
            spread = spread.union(Aabb::of_points([self.centre(key)]));
        }
        let extent: [f32; 3] = std::array::from_fn(|axis| spread.max[axis] - spread.min[axis]);
        let axis = if extent[0] >= extent[1] && extent[0] >= extent[2] { 0 } else if extent[1] >= extent[2] { 1 } else { 2 };
        let centres = &mut centres[..keys.len()];
        for (centre, key) in centres.iter_mut().zip(keys.iter()) {
            *centre = (self.centre(key)[axis], *key);
        }
        let packets = keys.len().div_ceil(LEAF_CAPACITY);
        let middle = packets.div_ceil(2) * LEAF_CAPACITY;
        centres.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0).then(a.1.index.cmp(&b.1.index)));
        for (key, centre) in keys.iter_mut().zip(centres) {
            *key = centre.1;
        }
        middle
    }

    /// Twice the centre of a box.
    fn centre(&self, key: &Key) -> [f32; 3] {
        let bounds = &self.boxes[key.index as usize];
        std::array::from_fn(|axis| bounds.min[axis] + bounds.max[axis])
    }
}

/// Where to split a sorted range of more than one key: where the curve's cells split; strictly inside it.
fn split(keys: &[Key], depth: usize) -> usize {
    let (low, high) = (keys[0].code, keys[keys.len() - 1].code);
    if low == high || depth >= HALVE_FROM_DEPTH {
        return keys.len() / 2;
    }
    let top_bit = 1 << (low ^ high).ilog2();
    keys.partition_point(|key| key.code & top_bit == 0)
}

impl BinaryNode {
    /// The same node in an array that starts `offset` nodes earlier.
    fn moved_by(mut self, offset: u32) -> Self {
        self.right = self.right.and_then(|right| right.checked_add(offset));
        self
    }
}
