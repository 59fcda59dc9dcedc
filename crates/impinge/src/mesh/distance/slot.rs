//! The position of a child in its parent.

/// A child of a node: the index of the node and the child's lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) node: u32,
    pub(super) lane: u8,
}
