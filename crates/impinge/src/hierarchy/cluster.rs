//! Builds the bottom of a tree: subtrees of clusters, which have at most 8192 boxes. A cluster is
//! split by planes through the middle of its centers. Runs of at most 512 boxes are split at
//! medians into full nodes and full leaves.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 6.2.2 and 6.2.3, the splits at the middle and
//! at the median. Ours departs in that it never sorts: medians are found by counting. The last few
//! boxes around a median are split by their order alone, which does not measurably loosen the
//! boxes.

use std::num::NonZeroU32;

use fearless_simd::Simd;

use super::binary::{BinaryNode, LEAF_CAPACITY, NODE_OF_LEAVES};
use super::boxes::{Bounds, Center};
use super::columns::{Columns, MAX_PLANES, MAX_ROWS, Run};
use crate::simd::LANES;

/// Maximum number of boxes in a cluster.
pub(crate) const MAX_CLUSTER: usize = MAX_ROWS;

/// Runs with more boxes than this (512) are split by planes, which find the gaps between boxes;
/// smaller runs at medians, which fill the nodes. A wide node whose children have only leaves as
/// children holds this many boxes.
const SPLIT_BY_PLANE_ABOVE: usize = LANES * NODE_OF_LEAVES;

/// Maximum number of pending runs: one for each level and one more.
const MAX_PENDING: usize = MAX_PLANES as usize + (MAX_CLUSTER / LEAF_CAPACITY).ilog2() as usize + 2;

/// Memory that is reused for one cluster after another.
#[derive(Default)]
pub(crate) struct Cluster(Columns);

impl Cluster {
    /// Builds the subtree of a cluster, whose first box is box `first` of the tree. It writes the
    /// order of the boxes and appends the nodes in preorder. Returns the bounds of all boxes, as
    /// `bounds` computes them for a group.
    #[inline(always)]
    pub(crate) fn emit<S: Simd, B: Bounds>(
        &mut self,
        simd: S,
        centers: &[Center],
        bounds: impl Fn(&[u32]) -> B,
        order: &mut [u32],
        first: u32,
        nodes: &mut Vec<BinaryNode<B>>,
    ) -> B {
        let Self(columns) = self;
        columns.set(simd, centers);
        let root = nodes.len();
        let node = |Run { start, len, .. }: Run| BinaryNode {
            bounds: B::EMPTY,
            first: first + start as u32,
            count: len as u32,
            right: None,
        };
        // The pending runs. Each right child comes with the index of its parent.
        let mut pending: [(Run, Option<usize>); MAX_PENDING] = [Default::default(); MAX_PENDING];
        pending[0].0 = Run::all(centers.len());
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (run, parent) = pending[count];
            let at = nodes.len();
            if let Some(parent) = parent {
                nodes[parent].right = NonZeroU32::new((at - parent) as u32);
            }
            nodes.push(node(run));
            if run.len <= 2 * LEAF_CAPACITY {
                columns.finish(simd, run);
                let (low, high) = run.split(LEAF_CAPACITY);
                if high.len > 0 {
                    nodes[at].right = NonZeroU32::new(2);
                    nodes.extend([node(low), node(high)]);
                }
                continue;
            }
            let by_plane = if run.len > SPLIT_BY_PLANE_ABOVE { columns.part_by_plane(simd, run) } else { None };
            let (low, high) = by_plane.unwrap_or_else(
                #[inline(always)]
                || {
                    let whole = if run.len > NODE_OF_LEAVES { NODE_OF_LEAVES } else { LEAF_CAPACITY };
                    columns.part(simd, run, run.len.div_ceil(whole).div_ceil(2) * whole)
                },
            );
            (pending[count], pending[count + 1]) = ((high, Some(at)), (low, None));
            count += 2;
        }
        for (index, number) in order.iter_mut().zip(columns.finished()) {
            *index = centers[*number as usize].index;
        }
        for at in (root..nodes.len()).rev() {
            let BinaryNode { first: start, count, right, .. } = nodes[at];
            nodes[at].bounds = match right {
                Some(right) => nodes[at + 1].bounds.union(nodes[at + right.get() as usize].bounds),
                None => bounds(&order[(start - first) as usize..][..count as usize]),
            };
        }
        nodes[root].bounds
    }
}
