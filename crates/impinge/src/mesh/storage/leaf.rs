//! Leaves: which faces a leaf of the tree holds. What else there is to know of them is in [`triangles`](super::triangles), and made
//! when a leaf is first met.

use crate::simd::LANES;

/// Number of leaves, or of faces, that one task processes.
pub(in crate::mesh) const CHUNK: usize = 512;

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
    pub(in crate::mesh) fn holding(held: &[u32]) -> Self {
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
    pub(in crate::mesh) fn count(&self) -> usize {
        1 + self.faces.iter().filter(|&&face| face != self.faces[0]).count()
    }

    /// Whether only lanes after all others repeat the first.
    pub(in crate::mesh) fn is_sound(&self) -> bool {
        let is_other = |lane: usize| u32::from(self.faces[lane] != self.faces[0]);
        let others = (0..LANES).fold(0, |others, lane| others | is_other(lane) << lane);
        // Ones in a row from the second on, or none: without a branch, as how many lanes are in use is not to be foreseen.
        (others + 2).is_power_of_two()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use impinge_testkit::generate::Rng;

    use super::*;

    /// Whatever the lanes repeat: made anew of what it holds, only a sound leaf is the same.
    #[test]
    fn sound_leaves_are_what_leaves_of_their_faces_are() {
        let mut rng = Rng::new(171);
        let (mut sound, mut unsound) = (BTreeSet::new(), 0);
        for _ in 0..20_000 {
            let faces = [0; LANES].map(|_| rng.integer(0, 2) as u32);
            // One in two as a build makes them.
            let count = rng.integer(1, 2 * LANES as i64) as usize;
            let leaf = if count > LANES { Leaf { faces } } else { Leaf::holding(&faces[..count]) };
            let is_sound = Leaf::holding(leaf.held()).faces == leaf.faces;
            assert_eq!(leaf.is_sound(), is_sound, "{leaf:?}");
            if is_sound {
                sound.insert(leaf.count());
            }
            unsound += usize::from(!is_sound);
        }
        assert_eq!(sound.len(), LANES, "{sound:?}");
        assert!(unsound > 5_000, "{unsound} of 20,000 are unsound");
    }
}
