//! Packets: up to eight triangles of a leaf in SoA layout. A packet is made when a query first
//! reaches its leaf, together with some neighbors, and cached until the mesh moves. Most leaves of
//! a large mesh are never reached, and packets would be most of the memory that a build or a refit
//! writes.
//!
//! Guarded by the tests of `triangles`, by `a_refit_discards_cached_packets` in the tests
//! `engine/moving.rs`, and by the benchmark `headline`.

use std::ops::Deref;

use fearless_simd::Simd;
use once_cell::race::OnceBox;

use super::leaf::Leaf;
use super::stored_corners::{Corners, StoredCorners};
use super::triangles::{self, Triangles};
use crate::simd::{LANES, outlined, prefetch};

/// A leaf with its packed triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packet<'a> {
    pub(crate) leaf: &'a Leaf,
    /// Local origin of the triangles, in the packed frame.
    pub(crate) local_origin: [f64; 3],
    triangles: &'a Triangles,
}

impl Deref for Packet<'_> {
    type Target = Triangles;

    #[inline(always)]
    fn deref(&self) -> &Triangles {
        self.triangles
    }
}

/// Number of neighboring leaves whose packets are made together. If it is smaller, fewer packets
/// are made that no query needs; if it is larger, less memory keeps track of them.
const LEAVES_PER_BLOCK: usize = LANES;

/// The packets that queries have made so far, in blocks of neighboring leaves.
#[derive(Debug)]
pub(in crate::mesh) struct PacketCache(Box<[OnceBox<[Triangles; LEAVES_PER_BLOCK]>]>);

impl PacketCache {
    /// Returns an empty cache for this number of leaves.
    pub(in crate::mesh) fn new(leaves: usize) -> Self {
        Self((0..leaves.div_ceil(LEAVES_PER_BLOCK)).map(|_| OnceBox::new()).collect())
    }

    /// Removes all packets.
    pub(in crate::mesh) fn clear(&mut self) {
        for slot in &mut self.0 {
            *slot = OnceBox::new();
        }
    }

    /// Returns the memory of the cache in bytes.
    pub(in crate::mesh) fn memory(&self) -> usize {
        let made = self.0.iter().filter_map(OnceBox::get).map(size_of_val).sum::<usize>();
        size_of_val(&self.0[..]) + made
    }
}

/// Access to the packets of a mesh, which makes missing ones.
#[derive(Clone, Copy)]
pub(crate) struct Packets<'a> {
    leaves: &'a [Leaf],
    blocks: &'a [OnceBox<[Triangles; LEAVES_PER_BLOCK]>],
    corners: Corners<'a>,
}

impl<'a> Packets<'a> {
    /// Returns access to the packets of these leaves, cached in `cache`.
    pub(in crate::mesh) fn new(leaves: &'a [Leaf], cache: &'a PacketCache, corners: Corners<'a>) -> Self {
        Self { leaves, blocks: &cache.0, corners }
    }

    /// Returns a leaf, which names its faces.
    #[inline(always)]
    pub(crate) fn leaf(&self, leaf: u32) -> &'a Leaf {
        &self.leaves[leaf as usize]
    }

    /// Prefetches a leaf, which names its faces.
    #[inline(always)]
    pub(crate) fn prefetch_leaf(&self, leaf: u32) {
        prefetch(&self.leaves[leaf as usize]);
    }

    /// Prefetches the vertex indices of a face.
    #[inline(always)]
    pub(crate) fn prefetch_face(&self, face: u32) {
        match &self.corners {
            Corners::Single(stored) => stored.faces().prefetch(face),
            Corners::SingleWidened(stored) => stored.faces().prefetch(face),
            Corners::Double(stored) => stored.faces().prefetch(face),
        }
    }

    /// Prefetches the vertices of a face, whose indices should be in the cache by now.
    #[inline(always)]
    pub(crate) fn prefetch_vertices(&self, face: u32) {
        match &self.corners {
            Corners::Single(stored) => stored.prefetch_vertices(face),
            Corners::SingleWidened(stored) => stored.prefetch_vertices(face),
            Corners::Double(stored) => stored.prefetch_vertices(face),
        }
    }

    /// Prefetches the pointer to the block that holds the packet of a leaf.
    #[inline(always)]
    pub(crate) fn prefetch_place(&self, leaf: u32) {
        prefetch(&self.blocks[leaf as usize / LEAVES_PER_BLOCK]);
    }

    /// Prefetches the packet of a leaf, if it has been made.
    #[inline(always)]
    pub(crate) fn prefetch(&self, leaf: u32) {
        let leaf = leaf as usize;
        if let Some(block) = self.blocks[leaf / LEAVES_PER_BLOCK].get() {
            prefetch(&block[leaf % LEAVES_PER_BLOCK]);
        }
    }

    /// Returns the packet of a leaf, made first if necessary.
    #[inline(always)]
    pub(crate) fn get<S: Simd>(&self, simd: S, leaf: u32) -> Packet<'a> {
        let at = leaf as usize;
        let block = match self.blocks[at / LEAVES_PER_BLOCK].get() {
            Some(block) => block,
            None => self.make(simd, at / LEAVES_PER_BLOCK),
        };
        let triangles = &block[at % LEAVES_PER_BLOCK];
        let local_origin = match &self.corners {
            Corners::Single(stored) => stored.frame().pack(stored.origin_in_mesh_frame(triangles.local_origin)),
            Corners::SingleWidened(stored) => stored.frame().pack(stored.origin_in_mesh_frame(triangles.local_origin)),
            Corners::Double(stored) => stored.frame().pack(stored.origin_in_mesh_frame(triangles.local_origin)),
        };
        Packet { leaf: self.leaf(leaf), local_origin, triangles }
    }

    /// Makes the packets of a block of leaves. If two threads make the same block, one result is
    /// kept; both have the same bits.
    #[cold]
    #[inline(never)]
    fn make<S: Simd>(&self, simd: S, slot: usize) -> &'a [Triangles; LEAVES_PER_BLOCK] {
        let end = self.leaves.len().min((slot + 1) * LEAVES_PER_BLOCK);
        let leaves = &self.leaves[slot * LEAVES_PER_BLOCK..end];
        self.blocks[slot].get_or_init(|| {
            outlined(
                simd,
                #[inline(always)]
                || match &self.corners {
                    Corners::Single(stored) => triangles::of_leaves(simd, leaves, stored),
                    Corners::SingleWidened(stored) => triangles::of_leaves(simd, leaves, stored),
                    Corners::Double(stored) => triangles::of_leaves(simd, leaves, stored),
                },
            )
        })
    }
}
