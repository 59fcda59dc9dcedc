//! Pairs of faces that intersect, of two meshes or within one mesh.
//!
//! `world_box` proves meshes apart by their boxes in the world. `sides` maps host and guest to the
//! first and the second mesh, and `relation` bounds the error of the map between their packed
//! frames. `filter` classifies most pairs of packed triangles. `large_leaf` compares a large leaf
//! with nodes, and `guest_cache` caches guest leaves in the host's frame. `leaf_pairs` queues pairs
//! of leaves and sends undecided pairs of faces to the exact decision, and `wanted` says which
//! pairs are kept. `share` divides a search among machines. `descent` ties these together. `hubs`
//! finds vertices with many faces, `crowd` divides the space of faces whose boxes all overlap, and
//! `self_descent` finds the pairs within one mesh.

pub(super) mod crowd;
pub(super) mod descent;
pub(super) mod filter;
pub(super) mod guest_cache;
pub(super) mod hubs;
pub(super) mod large_leaf;
pub(super) mod leaf_pairs;
pub(super) mod relation;
pub(super) mod self_descent;
pub(super) mod share;
pub(super) mod sides;
pub(super) mod wanted;
pub(super) mod world_box;
