//! The bottom of a tree: a cluster of at most some thousand boxes, split by planes through the middle of their centres, and at medians into
//! whole nodes and whole leaves once hundreds are left.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 6.2.2 and 6.2.3, the splits at the middle and at the median. Ours departs in that it
//! never sorts: medians are found by counting, and the last few boxes about one are told apart by their order alone, which costs no
//! tightness that can be measured.

use std::num::NonZeroU32;

use fearless_simd::Simd;

use super::binary::{BinaryNode, LEAF_CAPACITY, NODE_OF_LEAVES};
use super::boxes::{Bounds, Centre};
use super::columns::{Columns, MOST, PLANES, Run};
use crate::simd::LANES;

/// The most boxes of a cluster.
pub(crate) const CLUSTER: usize = MOST;

/// More boxes than a wide node over nodes of leaves holds are parted by planes, which find the gaps between them; medians fill what is below.
const BY_PLANE: usize = LANES * NODE_OF_LEAVES;

/// One run for each level and one more.
const MOST_LEFT: usize = PLANES as usize + (CLUSTER / LEAF_CAPACITY).ilog2() as usize + 2;

/// Room for one cluster after another.
#[derive(Default)]
pub(crate) struct Cluster(Columns);

impl Cluster {
    /// Groups the boxes of a cluster, of which the first is the tree's box `first`, writes their order, appends their nodes in
    /// preorder, and returns what `bounds` keeps of them all.
    #[inline(always)]
    pub(crate) fn emit<S: Simd, B: Bounds>(
        &mut self,
        simd: S,
        centres: &[Centre],
        bounds: impl Fn(&[u32]) -> B,
        order: &mut [u32],
        first: u32,
        nodes: &mut Vec<BinaryNode<B>>,
    ) -> B {
        let Self(columns) = self;
        columns.set(simd, centres);
        let root = nodes.len();
        let node = |Run { start, len, .. }: Run| BinaryNode {
            bounds: B::EMPTY,
            first: first + start as u32,
            count: len as u32,
            right: None,
        };
        // The runs to come, each with its parent where it is a right child.
        let mut left: [(Run, Option<usize>); MOST_LEFT] = [Default::default(); MOST_LEFT];
        left[0].0 = Run::all(centres.len());
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (run, parent) = left[count];
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
            let by_plane = if run.len > BY_PLANE { columns.part_by_plane(simd, run) } else { None };
            let (low, high) = by_plane.unwrap_or_else(
                #[inline(always)]
                || {
                    let whole = if run.len > NODE_OF_LEAVES { NODE_OF_LEAVES } else { LEAF_CAPACITY };
                    columns.part(simd, run, run.len.div_ceil(whole).div_ceil(2) * whole)
                },
            );
            (left[count], left[count + 1]) = ((high, Some(at)), (low, None));
            count += 2;
        }
        for (index, number) in order.iter_mut().zip(columns.finished()) {
            *index = centres[*number as usize].index;
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
