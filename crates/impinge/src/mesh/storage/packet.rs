//! Packets: what a leaf holds, as a question asks for it. They are made when a leaf is first met, some neighbours at a time, and
//! kept until the mesh moves: most of a large mesh is never met, and what a build and a refit would write else is mostly packets.

use std::ops::Deref;

use fearless_simd::Simd;
use once_cell::race::OnceBox;

use super::leaf::Leaf;
use super::stored_corners::{Corners, StoredCorners};
use super::triangles::{self, Triangles};
use crate::simd::{LANES, outlined, prefetch};

/// What a leaf holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packet<'a> {
    pub(crate) leaf: &'a Leaf,
    /// The anchor of the triangles, in the packed frame.
    pub(crate) anchor: [f64; 3],
    triangles: &'a Triangles,
}

impl Deref for Packet<'_> {
    type Target = Triangles;

    #[inline(always)]
    fn deref(&self) -> &Triangles {
        self.triangles
    }
}

/// Leaves whose packets are made together: fewer waste less of what is made, and more less memory for keeping track.
const TOGETHER: usize = LANES;

/// What was made so far.
#[derive(Debug)]
pub(in crate::mesh) struct Made(Box<[OnceBox<[Triangles; TOGETHER]>]>);

impl Made {
    /// Nothing of so many leaves.
    pub(in crate::mesh) fn none(leaves: usize) -> Self {
        Self((0..leaves.div_ceil(TOGETHER)).map(|_| OnceBox::new()).collect())
    }

    /// Nothing any more.
    pub(in crate::mesh) fn clear(&mut self) {
        for slot in &mut self.0 {
            *slot = OnceBox::new();
        }
    }

    /// Bytes.
    pub(in crate::mesh) fn memory(&self) -> usize {
        let made = self.0.iter().filter_map(OnceBox::get).map(size_of_val).sum::<usize>();
        size_of_val(&self.0[..]) + made
    }
}

/// The packets of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Packets<'a> {
    leaves: &'a [Leaf],
    made: &'a [OnceBox<[Triangles; TOGETHER]>],
    corners: Corners<'a>,
}

impl<'a> Packets<'a> {
    /// The packets of these leaves.
    pub(in crate::mesh) fn new(leaves: &'a [Leaf], made: &'a Made, corners: Corners<'a>) -> Self {
        Self { leaves, made: &made.0, corners }
    }

    #[inline(always)]
    pub(crate) fn leaf(&self, leaf: u32) -> &'a Leaf {
        &self.leaves[leaf as usize]
    }

    /// Asks for which faces a leaf holds.
    #[inline(always)]
    pub(crate) fn prefetch_leaf(&self, leaf: u32) {
        prefetch(&self.leaves[leaf as usize]);
    }

    /// Asks for a face.
    #[inline(always)]
    pub(crate) fn prefetch_face(&self, face: u32) {
        match &self.corners {
            Corners::Single(stored) => stored.faces().prefetch(face),
            Corners::SingleWidened(stored) => stored.faces().prefetch(face),
            Corners::Double(stored) => stored.faces().prefetch(face),
        }
    }

    /// Asks for the vertices of a face.
    #[inline(always)]
    pub(crate) fn prefetch_vertices(&self, face: u32) {
        match &self.corners {
            Corners::Single(stored) => stored.prefetch_vertices(face),
            Corners::SingleWidened(stored) => stored.prefetch_vertices(face),
            Corners::Double(stored) => stored.prefetch_vertices(face),
        }
    }

    /// Asks for what says where the packet of a leaf is, and those of its neighbours.
    #[inline(always)]
    pub(crate) fn prefetch_place(&self, leaf: u32) {
        prefetch(&self.made[leaf as usize / TOGETHER]);
    }

    /// Asks for the packet of a leaf, where that is made.
    #[inline(always)]
    pub(crate) fn prefetch(&self, leaf: u32) {
        let leaf = leaf as usize;
        if let Some(made) = self.made[leaf / TOGETHER].get() {
            prefetch(&made[leaf % TOGETHER]);
        }
    }

    /// The packet of a leaf.
    #[inline(always)]
    pub(crate) fn get<S: Simd>(&self, simd: S, leaf: u32) -> Packet<'a> {
        let at = leaf as usize;
        let made = match self.made[at / TOGETHER].get() {
            Some(made) => made,
            None => self.make(simd, at / TOGETHER),
        };
        let triangles = &made[at % TOGETHER];
        let anchor = match &self.corners {
            Corners::Single(stored) => stored.frame().pack(stored.place(triangles.anchor)),
            Corners::SingleWidened(stored) => stored.frame().pack(stored.place(triangles.anchor)),
            Corners::Double(stored) => stored.frame().pack(stored.place(triangles.anchor)),
        };
        Packet { leaf: self.leaf(leaf), anchor, triangles }
    }

    #[cold]
    #[inline(never)]
    fn make<S: Simd>(&self, simd: S, slot: usize) -> &'a [Triangles; TOGETHER] {
        let end = self.leaves.len().min((slot + 1) * TOGETHER);
        let leaves = &self.leaves[slot * TOGETHER..end];
        self.made[slot].get_or_init(|| {
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
