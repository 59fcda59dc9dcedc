//! Guest leaves taken up: turned once for the host leaves that they meet in turn, and kept for those that they meet later.

use fearless_simd::Simd;

use super::filter::Guest;
use super::relation::Relation;
use crate::mesh::storage::packet::Packets;
use crate::volume::Aabb;

/// A guest leaf and what it holds, turned.
#[derive(Clone)]
struct CachedGuest {
    leaf: u32,
    /// How many pairs wait for it.
    pending: u32,
    guest: Guest,
}

/// Leaves in slots, each in its own, which its number tells, unless another that is awaited is there.
pub(super) struct GuestCache {
    /// None before the first leaf: capacity searches meet none.
    slots: Vec<CachedGuest>,
    capacity: usize,
    /// Where the one taken up last is.
    last_slot: usize,
}

impl GuestCache {
    /// At capacity so many are kept, a power of two.
    pub(in crate::mesh) fn new(capacity: usize) -> Self {
        Self { slots: Vec::new(), capacity, last_slot: 0 }
    }

    /// Takes up a leaf, if that is not done, and returns its bounds in the host's frame. There must be a slot for which no pair
    /// waits.
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
        // A division would take as long as half of what is saved.
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

    /// Lets so many pairs wait for the leaf taken up last; returns its slot.
    #[inline(always)]
    pub(super) fn add_pending(&mut self, pairs: u32) -> u32 {
        self.slots[self.last_slot].pending += pairs;
        self.last_slot as u32
    }

    /// The leaf in a slot for which a pair has waited. It stays there until the next one is taken up.
    #[inline(always)]
    pub(super) fn take_pending(&mut self, slot: usize) -> &Guest {
        let slot = &mut self.slots[slot];
        slot.pending -= 1;
        &slot.guest
    }

    /// The leaf in a slot, and its number.
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
                // At capacity three wait when another is taken up.
                if queue.len() > 3 {
                    let (slot, leaf) = queue.pop_front().expect("four wait");
                    assert_eq!(guests.take_pending(slot).bounds, bounds[leaf as usize]);
                    assert_eq!(guests.get(slot).0, leaf);
                }
            }
        }
        assert!(displaced > 2_000, "{displaced} were taken up elsewhere, as what is awaited was in their slot");
    }
}
