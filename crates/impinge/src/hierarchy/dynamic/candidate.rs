//! The queue of nodes that an insertion considers.

use std::cmp::Ordering;

/// A node beside which, or below which, a box may be inserted.
///
/// The greatest candidate is the one whose ancestors grow least. Among equals it is the deepest,
/// which is nearest to a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// Sum of the areas by which the node's ancestors grow.
    pub(super) grown: f64,
    /// Steps from the root.
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
