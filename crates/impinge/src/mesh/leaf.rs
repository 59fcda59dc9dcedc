//! Leaves: which faces a leaf of the tree holds. What else there is to know of them is in [`triangles`](super::triangles), and made
//! when a leaf is first met.

use crate::simd::LANES;

/// Up to eight faces; unused lanes repeat the first one.
#[derive(Clone, Copy, Debug, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(32))]
pub(crate) struct Leaf {
    /// Which face each lane is.
    pub(crate) faces: [u32; LANES],
}

impl Leaf {
    /// A leaf of these faces, at least one and at most eight.
    #[inline(always)]
    pub(super) fn holding(held: &[u32]) -> Self {
        let mut faces = [held[0]; LANES];
        faces[..held.len()].copy_from_slice(held);
        Self { faces }
    }

    /// The faces that it holds.
    pub(crate) fn held(&self) -> &[u32] {
        &self.faces[..self.count()]
    }

    /// How many lanes hold a face of their own, where none of them comes after one that does not.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        1 + self.faces[1..].iter().filter(|&&face| face != self.faces[0]).count()
    }

    /// Whether only lanes after all others repeat the first.
    pub(super) fn is_sound(&self) -> bool {
        self.held()[1..].iter().all(|&face| face != self.faces[0])
    }
}
