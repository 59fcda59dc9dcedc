//! A cache of guest leaves in the host's frame. A guest leaf is mapped once for all host leaves
//! that it is compared with in turn, and kept in case it comes again later.
//!
//! Guarded by the test below and by those in `engine/ways.rs`.

use fearless_simd::Simd;

use super::filter::Guest;
use super::relation::Relation;
use crate::mesh::storage::packet::Packets;
use crate::volume::Aabb;

/// A guest leaf with its packet, mapped into the frame of the host.
#[derive(Clone)]
struct CachedGuest {
    /// Number of the leaf.
    leaf: u32,
    /// Number of queued pairs that refer to the slot.
    pending: u32,
    guest: Guest,
}

/// A direct-mapped cache. A leaf is in the slot that its number selects, or in the next free slot
/// if queued pairs refer to that one.
pub(super) struct GuestCache {
    /// Empty before the first leaf, as most searches reach none.
    slots: Vec<CachedGuest>,
    /// Number of slots, a power of two.
    capacity: usize,
    /// Slot of the leaf that was loaded last.
    last_slot: usize,
}

impl GuestCache {
    /// Returns an empty cache with this number of slots, which must be a power of two.
    pub(in crate::mesh) fn new(capacity: usize) -> Self {
        Self { slots: Vec::new(), capacity, last_slot: 0 }
    }

    /// Loads a leaf unless it is cached, and returns its bounds in the packed frame of the host.
    /// There must be a slot without pending pairs.
    #[inline(always)]
    pub(super) fn load<S: Simd>(
        &mut self,
        simd: S,
        leaf: u32,
        packets: &Packets<'_>,
        relation: &Relation,
        back: &Relation,
    ) -> Aabb {
        if self.slots.is_empty() {
            self.slots = vec![CachedGuest { leaf: u32::MAX, pending: 0, guest: Guest::EMPTY }; self.capacity];
        }
        // A mask, as a division would cost half of the time that the cache saves.
        let mask = self.capacity - 1;
        self.last_slot = leaf as usize & mask;
        if self.slots[self.last_slot].leaf != leaf {
            while self.slots[self.last_slot].pending > 0 {
                self.last_slot = (self.last_slot + 1) & mask;
            }
            let slot = &mut self.slots[self.last_slot];
            slot.leaf = leaf;
            slot.guest.set_packet(simd, &packets.get(simd, leaf), relation, back);
        }
        self.slots[self.last_slot].guest.bounds
    }

    /// Adds pending pairs to the leaf that was loaded last, and returns its slot.
    #[inline(always)]
    pub(super) fn add_pending(&mut self, pairs: u32) -> u32 {
        self.slots[self.last_slot].pending += pairs;
        self.last_slot as u32
    }

    /// Removes one pending pair from a slot, and returns its leaf. The leaf stays there at least
    /// until the next one is loaded.
    #[inline(always)]
    pub(super) fn take_pending(&mut self, slot: usize) -> &Guest {
        let slot = &mut self.slots[slot];
        slot.pending -= 1;
        &slot.guest
    }

    /// Returns the number of the leaf in a slot, and its packet.
    #[inline(always)]
    pub(in crate::mesh) fn get(&self, slot: usize) -> (u32, &Guest) {
        let slot = &self.slots[slot];
        (slot.leaf, &slot.guest)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use impinge_testkit::generate::Rng;
    use impinge_testkit::generate::knots::{TREFOIL, torus_knot};

    use super::*;
    use crate::math::{Pose, RelativeMap};
    use crate::mesh::{Mesh, Positions};
    use crate::simd::{dispatch, levels};

    #[test]
    fn a_leaf_with_pending_pairs_keeps_its_slot() {
        let knot = torus_knot(20, 10, TREFOIL);
        let mesh = Mesh::new(Positions::F64(knot.vertices), knot.faces).expect("a valid mesh");
        let (packets, frame, count) = (&mesh.packets(), &mesh.0.frame, mesh.0.leaves.len());
        let poses = [Pose::IDENTITY, Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, [0.3, 0.2, 0.1]).expect("a pose")];
        let relate = |a: &Pose, b: &Pose| Relation::new(&RelativeMap::a_from_b(a, b), frame, frame);
        let (relation, back) = (relate(&poses[0], &poses[1]), relate(&poses[1], &poses[0]));
        let (_, level) = levels()[0];
        let bounds: Vec<Aabb> = (0..count as u32)
            .map(|leaf| dispatch!(level, simd => GuestCache::new(1).load(simd, leaf, packets, &relation, &back)))
            .collect();
        let mut rng = Rng::new(77);
        let (mut guests, mut queue) = (GuestCache::new(4), VecDeque::new());
        let mut displaced = 0;
        for _ in 0..20_000 {
            let leaf = rng.integer(0, count as i64 - 1) as u32;
            let taken = dispatch!(level, simd => guests.load(simd, leaf, packets, &relation, &back));
            assert_eq!(taken, bounds[leaf as usize]);
            displaced += u32::from(guests.last_slot != leaf as usize % 4);
            for _ in 0..rng.integer(0, 2) {
                queue.push_back((guests.add_pending(1) as usize, leaf));
                // At most three pairs are pending when another leaf is loaded.
                if queue.len() > 3 {
                    let (slot, leaf) = queue.pop_front().expect("four wait");
                    assert_eq!(guests.take_pending(slot).bounds, bounds[leaf as usize]);
                    assert_eq!(guests.get(slot).0, leaf);
                }
            }
        }
        assert!(displaced > 2_000, "{displaced} were loaded into another slot, as their own had pending pairs");
    }
}
