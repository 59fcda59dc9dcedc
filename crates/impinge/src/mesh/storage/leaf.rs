//! Leaves: the faces that a leaf of the tree holds. The packed triangles of a leaf are in
//! [`triangles`](super::triangles), and are made when a query first reaches the leaf.

use crate::simd::LANES;

/// Number of leaves, or of faces, that one task processes.
pub(in crate::mesh) const CHUNK: usize = 512;

/// Up to eight faces, at least one. Unused lanes repeat the first face.
#[derive(Clone, Copy, Debug, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(32))]
pub(crate) struct Leaf {
    /// The face of each lane.
    pub(crate) faces: [u32; LANES],
}

impl Leaf {
    /// Returns a leaf that holds these faces, at least one and at most eight.
    ///
    /// # Panics
    /// If `held` has no or more than eight faces.
    #[inline(always)]
    pub(in crate::mesh) fn holding(held: &[u32]) -> Self {
        let mut faces = [held[0]; LANES];
        faces[..held.len()].copy_from_slice(held);
        Self { faces }
    }

    /// Returns the faces of the leaf, without the repetitions in unused lanes.
    pub(crate) fn held(&self) -> &[u32] {
        &self.faces[..self.count()]
    }

    /// Returns the number of lanes that hold a face of their own. It is meaningful only if the leaf
    /// [is sound](Self::is_sound).
    #[inline(always)]
    pub(in crate::mesh) fn count(&self) -> usize {
        1 + self.faces.iter().filter(|&&face| face != self.faces[0]).count()
    }

    /// Reports whether only lanes after all other faces repeat the first face. It does not compare
    /// the other faces with each other.
    pub(in crate::mesh) fn is_sound(&self) -> bool {
        let is_other = |lane: usize| u32::from(self.faces[lane] != self.faces[0]);
        let others = (0..LANES).fold(0, |others, lane| others | is_other(lane) << lane);
        // Sound if the set bits are consecutive from bit 1 on, or if there are none. This needs no
        // branch, which could not be predicted, as the number of lanes in use varies.
        (others + 2).is_power_of_two()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use impinge_testkit::generate::Rng;

    use super::*;

    /// Only a sound leaf is equal to the leaf that is made from its faces.
    #[test]
    fn a_leaf_is_sound_if_it_equals_the_leaf_of_its_faces() {
        let mut rng = Rng::new(171);
        let (mut sound, mut unsound) = (BTreeSet::new(), 0);
        for _ in 0..20_000 {
            let faces = [0; LANES].map(|_| rng.integer(0, 2) as u32);
            // About half of the leaves are made as a build makes them.
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
