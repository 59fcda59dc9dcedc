//! Bounding volume hierarchies over boxes: building, memory layout and simultaneous descent. This
//! module knows boxes only, no shapes.
//!
//! A builder orders the boxes and emits a neutral [`BinaryTree`]. The collapse turns it into the
//! [`WideTree`] that every query descends.

mod aging;
mod area;
mod binary;
mod box_map;
mod boxes;
mod build;
mod cluster;
mod columns;
mod cost;
mod curve;
mod descent;
mod digit_order;
mod dynamic;
mod edge_cross;
mod generic;
mod lanes;
mod morton;
mod queue;
mod radix;
mod refit;
mod slab;
mod slab_map;
mod soundness;
#[cfg(test)]
mod tests;
mod wide;

pub(crate) use aging::{Aged, Origin};
pub use binary::{BinaryNode, BinaryTree, LEAF_CAPACITY, MAX_DEPTH, NODE_OF_LEAVES};
pub(crate) use box_map::BoxMap;
pub use boxes::Bounds;
pub(crate) use boxes::Boxes;
pub use build::{Builder, DynamicTree, optimize};
pub use cost::{Costs, Counters, TreeStatistics};
pub(crate) use descent::{APPROACHES_PER_BATCH, Descent, Large, LeafVisitor, Order, Task, lanes_in_use};
pub(crate) use dynamic::{DynamicBvh, DynamicNode, Stack};
pub(crate) use edge_cross::EdgeCrossAxes;
pub use generic::{Enclosure, GenericTree, NodeVolume};
pub(crate) use lanes::{BoxLanes, HALF_ULP, overlapping, overlapping_pairs};
pub use morton::build_morton;
pub(crate) use morton::tree_along_curve;
pub(crate) use queue::QUEUE;
pub(crate) use radix::scatter;
pub(crate) use refit::{Leaves, Patch, Patches, Work};
pub use slab::Slab;
pub(crate) use slab_map::SlabMap;
pub use wide::{Child, Node, WideTree};
