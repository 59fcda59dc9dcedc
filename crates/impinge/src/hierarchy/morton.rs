//! The default builder: boxes sorted along a space-filling curve and split where its cells split, down to clusters that
//! are split at medians.
//!
//! Source: Lauterbach et al., *Fast BVH construction on GPUs*, Eurographics 2009; Karras, *Maximizing parallelism in the
//! construction of BVHs*, HPG 2012. Ours departs in three ways: a cell that holds more than a cluster gets a curve of its
//! own, so that small detail in a large scene keeps its order; a bounded depth, by halving ranges once the curve has
//! split often enough; and medians at the bottom, which make leaves and nodes full and compact where a curve would jump.

use std::num::NonZeroU32;

use fearless_simd::prelude::*;
use fearless_simd::{dispatch, f32x4};
use rayon::prelude::*;

use super::binary::{BinaryNode, BinaryTree, LEAF_CAPACITY};
use super::boxes::{Bounds, Boxes};
use super::cluster::{CLUSTER, Cluster};
use super::curve::{Curve, Key, code, index};
use super::radix;
use crate::simd::best_level;
use crate::storage::{Room, Space};
use crate::volume::Aabb;

/// Depth from which ranges are halved whatever the codes say: 2^32 boxes halved 23 times leave one cluster, which is at
/// most 6 deep, so that no leaf is deeper than 32 + 23 + 6, below [`MAX_DEPTH`](super::MAX_DEPTH).
const HALVE_FROM_DEPTH: usize = 32;

/// The most boxes of a task where there is more than one thread.
const LONGEST_TASK: usize = 1 << 15;

/// Boxes whose codes are one task.
const CHUNK: usize = 1 << 14;

/// The tree of these boxes, none of which may be empty; the same for any number of threads.
///
/// # Complexity
/// O(n log n), depth at most [`MAX_DEPTH`](super::MAX_DEPTH) for any input: equal, nested or sorted boxes included.
#[must_use]
pub fn build_morton(boxes: &[Aabb]) -> BinaryTree {
    let mut room = Room::new(Keyed::space(boxes.len()) + Keyed::space_to_sort(boxes.len()), 0);
    let mut space = room.space();
    let keyed = Keyed::of(boxes, &mut space);
    keyed.tree(|group| group.iter().fold(Aabb::EMPTY, |bounds, &index| bounds.union(boxes[index as usize])), &mut space)
}

/// Boxes with their keys: all that a builder along the curve looks at.
pub(crate) struct Keyed<'a> {
    twice_centres: &'a [[f32; 4]],
    keys: &'a mut [Key],
}

impl<'a> Keyed<'a> {
    /// Bytes that [`of`](Self::of) needs for so many boxes, until there is a tree.
    pub(crate) fn space(boxes: usize) -> usize {
        Space::of::<[f32; 4]>(boxes) + Space::of::<Key>(boxes)
    }

    /// Bytes that [`tree`](Self::tree) needs in passing.
    pub(crate) fn space_to_sort(boxes: usize) -> usize {
        Space::of::<Key>(boxes)
    }

    pub(crate) fn of<B: Boxes + ?Sized>(boxes: &B, space: &mut Space<'a>) -> Self {
        let len = boxes.len();
        let (twice_centres, keys) = (space.take::<[f32; 4]>(len), space.take::<Key>(len));
        let curve = Curve::over(&boxes.twice_centres());
        keys.par_chunks_mut(CHUNK).zip(twice_centres.par_chunks_mut(CHUNK)).enumerate().for_each(
            |(chunk, (keys, twice_centres))| {
                let first = (chunk * CHUNK) as u32;
                dispatch!(best_level(), simd => {
                    for ((key, stored), index) in keys.iter_mut().zip(twice_centres).zip(first..) {
                        let twice_centre = boxes.twice_centre(simd, index);
                        twice_centre.store_slice(stored);
                        *key = curve.as_ref().map_or(Key::from(index), |curve| curve.key(simd, twice_centre, index));
                    }
                });
            },
        );
        Self { twice_centres, keys }
    }

    /// The tree, with what `bounds` keeps of the boxes of a group.
    pub(crate) fn tree<B: Bounds>(self, bounds: impl Fn(&[u32]) -> B + Sync, space: &mut Space<'_>) -> BinaryTree<B> {
        let Self { twice_centres, keys } = self;
        let len = keys.len();
        if len == 0 {
            return BinaryTree::default();
        }
        radix::sort(keys, space.take(len));
        let mut order = vec![0; len];
        let mut blocks = Vec::new();
        let task = if rayon::current_num_threads() == 1 { len } else { LONGEST_TASK };
        let builder = Builder { twice_centres, bounds, task };
        builder.subtree(Range { keys, order: &mut order, first: 0, depth: 0 }, &mut blocks);
        let nodes = if blocks.len() == 1 { blocks.swap_remove(0) } else { blocks.concat() };
        BinaryTree { nodes, order }
    }
}

struct Builder<'a, F> {
    twice_centres: &'a [[f32; 4]],
    bounds: F,
    /// Ranges longer than this are built as two tasks.
    task: usize,
}

/// A range of the sorted keys, its part of the order, which is written, where it starts, and how deep its node lies.
struct Range<'a> {
    keys: &'a mut [Key],
    order: &'a mut [u32],
    first: usize,
    depth: usize,
}

impl Range<'_> {
    /// The two parts before and from `middle`, both one deeper.
    fn split_at(&mut self, middle: usize) -> (Range<'_>, Range<'_>) {
        let (low_keys, high_keys) = self.keys.split_at_mut(middle);
        let (low_order, high_order) = self.order.split_at_mut(middle);
        let depth = self.depth + 1;
        (
            Range { keys: low_keys, order: low_order, first: self.first, depth },
            Range { keys: high_keys, order: high_order, first: self.first + middle, depth },
        )
    }
}

impl<B: Bounds, F: Fn(&[u32]) -> B + Sync> Builder<'_, F> {
    /// Appends the nodes of a range in preorder, in blocks, and returns its bounds and how many nodes there are.
    fn subtree(&self, mut range: Range<'_>, blocks: &mut Vec<Vec<BinaryNode<B>>>) -> (B, usize) {
        let (first, count) = (range.first as u32, range.keys.len());
        if count <= self.task {
            let mut nodes = Vec::with_capacity(count / (LEAF_CAPACITY / 2) + 1);
            let bounds = self.emit(range, &mut nodes, &mut Cluster::new());
            let len = nodes.len();
            blocks.push(nodes);
            return (bounds, len);
        }
        let middle = self.middle(&mut range);
        let (low, high) = range.split_at(middle);
        let (mut left_blocks, mut right_blocks) = (Vec::new(), Vec::new());
        let ((left, left_len), (right, right_len)) =
            rayon::join(|| self.subtree(low, &mut left_blocks), || self.subtree(high, &mut right_blocks));
        let bounds = left.union(right);
        let right = NonZeroU32::new(1 + left_len as u32);
        blocks.push(vec![BinaryNode { bounds, first, count: count as u32, right }]);
        blocks.append(&mut left_blocks);
        blocks.append(&mut right_blocks);
        (bounds, 1 + left_len + right_len)
    }

    /// Appends the nodes of a range, the root first, and returns its bounds.
    fn emit(&self, mut range: Range<'_>, nodes: &mut Vec<BinaryNode<B>>, cluster: &mut Cluster) -> B {
        let (first, count) = (range.first as u32, range.keys.len());
        if count <= CLUSTER {
            cluster.hold(self.twice_centres, range.keys);
            return dispatch!(best_level(), simd => cluster.emit(simd, &self.bounds, range.order, first, nodes));
        }
        let middle = self.middle(&mut range);
        let (low, high) = range.split_at(middle);
        let at = nodes.len();
        nodes.push(BinaryNode { bounds: B::EMPTY, first, count: count as u32, right: None });
        let left = self.emit(low, nodes, cluster);
        let right_at = NonZeroU32::new((nodes.len() - at) as u32);
        let bounds = left.union(self.emit(high, nodes, cluster));
        nodes[at].bounds = bounds;
        nodes[at].right = right_at;
        bounds
    }

    /// Where to split a range longer than a cluster: where the curve's cells split; strictly inside it. A range in one
    /// cell is sorted along a curve of its own first.
    fn middle(&self, range: &mut Range<'_>) -> usize {
        let halfway = range.keys.len() / 2;
        if range.depth >= HALVE_FROM_DEPTH {
            return halfway;
        }
        let ends = |keys: &[Key]| (code(keys[0]), code(keys[keys.len() - 1]));
        let (mut low, mut high) = ends(range.keys);
        if low == high {
            let Some(curve) = Curve::over(&self.around(range.keys)) else { return halfway };
            dispatch!(best_level(), simd => for key in &mut *range.keys {
                let index = index(*key);
                *key = curve.key(simd, f32x4::from_slice(simd, &self.twice_centres[index as usize]), index);
            });
            range.keys.par_sort_unstable();
            (low, high) = ends(range.keys);
            if low == high {
                return halfway;
            }
        }
        let top_bit = 1 << (low ^ high).ilog2();
        range.keys.partition_point(|&key| code(key) & top_bit == 0)
    }

    /// Bounds of twice the centres of some.
    fn around(&self, keys: &[Key]) -> Aabb {
        keys.iter().fold(Aabb::EMPTY, |around, &key| {
            let [x, y, z, _] = self.twice_centres[index(key) as usize];
            around.union(Aabb { min: [x, y, z], max: [x, y, z] })
        })
    }
}
