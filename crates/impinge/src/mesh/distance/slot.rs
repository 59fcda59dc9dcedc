//! The place of a child in its parent.

/// A child of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) node: u32,
    pub(super) lane: u8,
}
