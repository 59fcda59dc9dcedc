//! A cache of the boxes of nodes in the frame in which they are compared.

use super::cache::Cache;
use crate::hierarchy::BoxLanes;

/// Number of nodes of either mesh whose carried boxes are cached, a power of two.
const CACHED_BOXES: usize = 32;

/// The most recently carried boxes of the nodes of one mesh.
pub(super) type CarriedBoxes = Cache<Carried, CACHED_BOXES>;

/// The boxes of a node's children in the frame in which nodes are compared.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    node: u32,
    boxes: BoxLanes,
}

/// Returns the carried boxes of a node's children. Calls `carry` if they are not cached.
#[inline(always)]
pub(super) fn carried_boxes(cache: &mut CarriedBoxes, node: u32, carry: impl FnOnce() -> BoxLanes) -> &BoxLanes {
    &cache.get(node, |kept| kept.node, |node| Carried { node, boxes: carry() }).boxes
}
