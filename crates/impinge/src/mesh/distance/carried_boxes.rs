//! A cache of the boxes of nodes in the frame in which they are compared.

use super::cache::Cache;
use crate::hierarchy::BoxLanes;

/// Number of nodes of either mesh whose carried boxes are cached, a power of two.
const CACHED_BOXES: usize = 32;

/// The boxes of the nodes of one mesh that were carried last.
pub(super) type CarriedBoxes = Cache<Carried, CACHED_BOXES>;

/// The carried boxes of a node.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    node: u32,
    boxes: BoxLanes,
}

/// Returns the boxes of a node, and carries them if they are not cached.
#[inline(always)]
pub(super) fn carried_boxes(cache: &mut CarriedBoxes, node: u32, carry: impl FnOnce() -> BoxLanes) -> &BoxLanes {
    &cache.get(node, |kept| kept.node, |node| Carried { node, boxes: carry() }).boxes
}
