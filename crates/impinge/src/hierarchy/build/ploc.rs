//! Bottom-up: clusters that are each other's nearest neighbours are joined, until one is left.
//!
//! Source: Meister, Bittner, *Parallel locally-ordered clustering for bounding volume hierarchy construction*, TVCG 2018.
//! Neighbours are sought among those next along a space-filling curve, whose order the default builder provides. Ours
//! departs in two ways, without which equal or nested boxes would be joined one pair a round: ties go to the neighbour
//! whose place differs in the lowest bits, so that places 2i and 2i + 1 choose each other; and a round that joins too few
//! joins all of those instead.

use rayon::prelude::*;

use super::super::area::half_area;
use super::super::binary::BinaryTree;
use super::super::morton::build_morton;
use super::linked::{Below, Linked, LinkedNode, NONE};
use crate::volume::Aabb;

/// Neighbours looked at on either side: twice as many make trees a hundredth cheaper and take nearly twice as long.
const RADIUS: usize = 14;

/// A round joins at least one cluster in this many, so that there are O(log n) rounds.
const LEAST_JOINED: usize = 16;

/// Clusters that one thread looks after.
const CHUNK: usize = 1 << 10;

/// The tree of these boxes, of which there is at least one.
pub(super) fn build(boxes: &[Aabb], capacity: usize) -> BinaryTree {
    let order = build_morton(boxes).order;
    let leaves = order.iter().zip(0..).map(|(&index, first)| LinkedNode {
        bounds: boxes[index as usize],
        parent: NONE,
        below: Below::Boxes { first, count: 1 },
    });
    let mut nodes: Vec<LinkedNode> = leaves.collect();
    let mut clusters: Vec<Cluster> =
        nodes.iter().zip(0..).map(|(leaf, node)| Cluster { bounds: leaf.bounds, node }).collect();
    while clusters.len() > 1 {
        let mut partners = partners(&clusters);
        let joined = (0..clusters.len()).filter(|&at| partners[partners[at]] == at).count() / 2;
        if joined * LEAST_JOINED < clusters.len() {
            partners = (0..clusters.len()).map(|at| if at ^ 1 < clusters.len() { at ^ 1 } else { at }).collect();
        }
        clusters = join(&clusters, &partners, &mut nodes);
    }
    let root = nodes.len() as u32 - 1;
    Linked { nodes, root }.to_binary(&order, capacity, |index| boxes[index as usize])
}

/// A subtree that is still to be joined.
#[derive(Clone, Copy)]
struct Cluster {
    bounds: Aabb,
    node: u32,
}

/// For each cluster the place of that which it makes the smallest box with.
fn partners(clusters: &[Cluster]) -> Vec<usize> {
    let nearest = |at: usize| {
        let mut best = (f64::INFINITY, usize::MAX, at);
        for other in at.saturating_sub(RADIUS)..(at + RADIUS + 1).min(clusters.len()) {
            if other != at {
                let area = half_area(&clusters[at].bounds.union(clusters[other].bounds));
                if area < best.0 || area == best.0 && at ^ other < best.1 {
                    best = (area, at ^ other, other);
                }
            }
        }
        best.2
    };
    (0..clusters.len()).into_par_iter().with_min_len(CHUNK).map(nearest).collect()
}

/// The clusters of the next round, in order; those that chose each other are one, which is a new node.
fn join(clusters: &[Cluster], partners: &[usize], nodes: &mut Vec<LinkedNode>) -> Vec<Cluster> {
    let mut joined = Vec::with_capacity(clusters.len());
    for (at, cluster) in clusters.iter().enumerate() {
        let other = partners[at];
        if partners[other] != at || other == at {
            joined.push(*cluster);
        } else if at < other {
            let pair = [cluster.node, clusters[other].node];
            let bounds = cluster.bounds.union(clusters[other].bounds);
            let node = nodes.len() as u32;
            for child in pair {
                nodes[child as usize].parent = node;
            }
            nodes.push(LinkedNode { bounds, parent: NONE, below: Below::Pair(pair) });
            joined.push(Cluster { bounds, node });
        }
    }
    joined
}
