//! Guest leaves taken up: turned once for the host leaves that they meet in turn, and kept for those that they meet later.

use fearless_simd::Simd;

use super::filter::Guest;
use super::packet::Packet;
use super::relation::Relation;
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
    pub(super) fn new(most: usize) -> Self {
        Self { places: Vec::new(), most, last: 0 }
    }

    /// Takes up a leaf, if that is not done, and returns its bounds in the host's frame. There must be a place for which no pair
    /// waits.
    #[inline(always)]
    pub(super) fn take_up<S: Simd>(
        &mut self,
        simd: S,
        leaf: u32,
        packets: &[Packet],
        relation: &Relation,
        back: &Relation,
    ) -> Aabb {
        if self.places.is_empty() {
            self.places = vec![TakenUp { leaf: u32::MAX, awaited: 0, guest: Guest::EMPTY }; self.most];
        }
        if self.places[self.last].leaf != leaf {
            // A division would take as long as half of what is saved.
            let mask = self.most - 1;
            self.last = leaf as usize & mask;
            if self.places[self.last].leaf != leaf {
                while self.places[self.last].awaited > 0 {
                    self.last = (self.last + 1) & mask;
                }
                let place = &mut self.places[self.last];
                place.leaf = leaf;
                place.guest.take_up(simd, &packets[leaf as usize], relation, back);
            }
        }
        self.places[self.last].guest.bounds
    }

    /// Lets a pair wait for the leaf taken up last; returns its place.
    #[inline(always)]
    pub(super) fn await_last(&mut self) -> usize {
        self.places[self.last].awaited += 1;
        self.last
    }

    /// The leaf in a place for which a pair has waited.
    #[inline(always)]
    pub(super) fn awaited(&mut self, place: usize) -> (u32, &Guest) {
        let place = &mut self.places[place];
        place.awaited -= 1;
        (place.leaf, &place.guest)
    }
}
