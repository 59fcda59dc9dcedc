//! Guest leaves taken up: turned once for the host leaves that they meet in turn, and kept for those that they meet later.

use fearless_simd::Simd;

use super::filter::Guest;
use super::relation::Relation;
use crate::mesh::storage::packet::Packets;
use crate::volume::Aabb;

/// A guest leaf and what it holds, turned.
#[derive(Clone)]
struct TakenUp {
    leaf: u32,
    /// How many pairs wait for it.
    awaited: u32,
    guest: Guest,
}

/// Leaves in places, each in its own, which its number tells, unless another that is awaited is there.
pub(super) struct Guests {
    /// None before the first leaf: most searches meet none.
    places: Vec<TakenUp>,
    most: usize,
    /// Where the one taken up last is.
    last: usize,
}

impl Guests {
    /// At most so many are kept, a power of two.
    pub(in crate::mesh) fn new(most: usize) -> Self {
        Self { places: Vec::new(), most, last: 0 }
    }

    /// Takes up a leaf, if that is not done, and returns its bounds in the host's frame. There must be a place for which no pair
    /// waits.
    #[inline(always)]
    pub(super) fn take_up<S: Simd>(
        &mut self,
        simd: S,
        leaf: u32,
        packets: &Packets<'_>,
        relation: &Relation,
        back: &Relation,
    ) -> Aabb {
        if self.places.is_empty() {
            self.places = vec![TakenUp { leaf: u32::MAX, awaited: 0, guest: Guest::EMPTY }; self.most];
        }
        // A division would take as long as half of what is saved.
        let mask = self.most - 1;
        self.last = leaf as usize & mask;
        if self.places[self.last].leaf != leaf {
            while self.places[self.last].awaited > 0 {
                self.last = (self.last + 1) & mask;
            }
            let place = &mut self.places[self.last];
            place.leaf = leaf;
            place.guest.take_up(simd, &packets.get(simd, leaf), relation, back);
        }
        self.places[self.last].guest.bounds
    }

    /// Lets so many pairs wait for the leaf taken up last; returns its place.
    #[inline(always)]
    pub(super) fn await_last(&mut self, pairs: u32) -> u32 {
        self.places[self.last].awaited += pairs;
        self.last as u32
    }

    /// The leaf in a place for which a pair has waited. It stays there until the next one is taken up.
    #[inline(always)]
    pub(super) fn awaited(&mut self, place: usize) -> &Guest {
        let place = &mut self.places[place];
        place.awaited -= 1;
        &place.guest
    }

    /// The leaf in a place, and its number.
    #[inline(always)]
    pub(in crate::mesh) fn at(&self, place: usize) -> (u32, &Guest) {
        let place = &self.places[place];
        (place.leaf, &place.guest)
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
    fn a_leaf_that_is_awaited_stays_what_it_is() {
        let knot = torus_knot(20, 10, TREFOIL);
        let mesh = Mesh::new(Positions::F64(knot.vertices), knot.faces).expect("a legal mesh");
        let (packets, frame, count) = (&mesh.packets(), &mesh.0.frame, mesh.0.leaves.len());
        let poses = [Pose::IDENTITY, Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, [0.3, 0.2, 0.1]).expect("a pose")];
        let relate = |a: &Pose, b: &Pose| Relation::new(&RelativeMap::a_from_b(a, b), frame, frame);
        let (relation, back) = (relate(&poses[0], &poses[1]), relate(&poses[1], &poses[0]));
        let (_, level) = levels()[0];
        let bounds: Vec<Aabb> = (0..count as u32)
            .map(|leaf| dispatch!(level, simd => Guests::new(1).take_up(simd, leaf, packets, &relation, &back)))
            .collect();
        let mut rng = Rng::new(77);
        let (mut guests, mut waiting) = (Guests::new(4), VecDeque::new());
        let mut displaced = 0;
        for _ in 0..20_000 {
            let leaf = rng.integer(0, count as i64 - 1) as u32;
            let taken = dispatch!(level, simd => guests.take_up(simd, leaf, packets, &relation, &back));
            assert_eq!(taken, bounds[leaf as usize]);
            displaced += u32::from(guests.last != leaf as usize % 4);
            for _ in 0..rng.integer(0, 2) {
                waiting.push_back((guests.await_last(1) as usize, leaf));
                // At most three wait when another is taken up.
                if waiting.len() > 3 {
                    let (place, leaf) = waiting.pop_front().expect("four wait");
                    assert_eq!(guests.awaited(place).bounds, bounds[leaf as usize]);
                    assert_eq!(guests.at(place).0, leaf);
                }
            }
        }
        assert!(displaced > 2_000, "{displaced} were taken up elsewhere, as what is awaited was in their place");
    }
}
