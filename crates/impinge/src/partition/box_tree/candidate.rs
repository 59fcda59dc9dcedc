//! Nodes that the insertion of a box looks at.

use std::cmp::Ordering;

/// A node beside or below which a box may go. The boxes above it grow by `grown` then: the least is looked at first, and of
/// several the deepest, which is nearest to a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) grown: f64,
    pub(super) depth: u16,
    pub(super) node: u32,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        other.grown.total_cmp(&self.grown).then(self.depth.cmp(&other.depth)).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}
