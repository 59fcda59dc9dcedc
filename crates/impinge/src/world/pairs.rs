//! The candidate pairs of the broad phase, each with its result of the narrow phase. A pair can be
//! found from either body.

use std::collections::TryReserveError;

use super::narrow::Meeting;

/// The candidate pairs by index, and for each body the list of its pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    entries: Vec<Option<Entry>>,
    free: Vec<u32>,
    /// Pairs of each body, by the slot of the body.
    links: Vec<Vec<Link>>,
}

/// A candidate pair.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Slots of the bodies, in the order in which they are reported.
    pub(super) bodies: [u32; 2],
    /// Index of the pair in the list of each body.
    places: [u32; 2],
    /// Result of the narrow phase. `None` if the bodies are apart, or were not processed yet.
    pub(super) meeting: Option<Meeting>,
}

/// A pair in the list of one of its bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Link {
    /// Slot of the other body.
    pub(super) other: u32,
    /// Index of the pair.
    pub(super) pair: u32,
}

impl Pairs {
    /// Reserves memory for new pairs, so that adding them allocates nothing.
    ///
    /// # Errors
    /// Returns an error if the memory cannot be allocated. The pairs are unchanged.
    pub(super) fn try_reserve(&mut self, bodies: &[[u32; 2]]) -> Result<(), TryReserveError> {
        let slots = bodies.as_flattened().iter().max().map_or(0, |&slot| slot as usize + 1);
        if self.links.len() < slots {
            self.links.try_reserve(slots - self.links.len())?;
            self.links.resize(slots, Vec::new());
        }
        let mut counts: Vec<u32> = Vec::new();
        counts.try_reserve_exact(slots)?;
        counts.resize(slots, 0);
        bodies.as_flattened().iter().for_each(|&slot| counts[slot as usize] += 1);
        self.entries.try_reserve(bodies.len().saturating_sub(self.free.len()))?;
        self.links.iter_mut().zip(counts).try_for_each(|(links, count)| links.try_reserve(count as usize))
    }

    /// Adds a pair, which must be new, and returns its index.
    pub(super) fn add(&mut self, bodies: [u32; 2]) -> u32 {
        let pair = self.free.pop().unwrap_or_else(|| {
            self.entries.push(None);
            self.entries.len() as u32 - 1
        });
        let places = [0, 1].map(|side: usize| {
            let body = bodies[side] as usize;
            if self.links.len() <= body {
                self.links.resize(body + 1, Vec::new());
            }
            self.links[body].push(Link { other: bodies[1 - side], pair });
            self.links[body].len() as u32 - 1
        });
        self.entries[pair as usize] = Some(Entry { bodies, places, meeting: None });
        pair
    }

    /// Removes a pair, in constant time however many pairs its bodies are in.
    pub(super) fn remove(&mut self, pair: u32) -> Option<Entry> {
        let entry = self.entries.get_mut(pair as usize)?.take()?;
        self.free.push(pair);
        for side in 0..2 {
            let (body, place) = (entry.bodies[side], entry.places[side] as usize);
            let links = &mut self.links[body as usize];
            links.swap_remove(place);
            // The last link of the list is now at this index.
            if let Some(moved) = links.get(place)
                && let Some(other) = &mut self.entries[moved.pair as usize]
            {
                other.places[usize::from(other.bodies[0] != body)] = place as u32;
            }
            if links.is_empty() && links.capacity() > MAX_KEPT {
                *links = Vec::new();
            }
        }
        Some(entry)
    }

    /// Returns the pairs of a body.
    pub(super) fn of(&self, body: u32) -> &[Link] {
        self.links.get(body as usize).map_or(&[], Vec::as_slice)
    }

    pub(super) fn get(&self, pair: u32) -> Option<&Entry> {
        self.entries.get(pair as usize)?.as_ref()
    }

    pub(super) fn get_mut(&mut self, pair: u32) -> Option<&mut Entry> {
        self.entries.get_mut(pair as usize)?.as_mut()
    }

    /// Returns the index of the pair of two bodies, searching the shorter list. Returns `None` if
    /// there is no such pair.
    pub(super) fn find(&self, one: u32, other: u32) -> Option<u32> {
        let (of, sought) = if self.of(one).len() <= self.of(other).len() { (one, other) } else { (other, one) };
        self.of(of).iter().find(|link| link.other == sought).map(|link| link.pair)
    }

    /// Returns all pairs, in no particular order.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().flatten()
    }

    /// Returns the number of pairs.
    pub(super) fn len(&self) -> usize {
        self.entries.len() - self.free.len()
    }
}

/// Maximum capacity that the empty list of a body keeps. Larger lists are freed, so that a body
/// that was once in a crowd does not keep the memory.
const MAX_KEPT: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;
    use std::collections::BTreeSet;

    #[test]
    fn lists_and_pairs_agree_after_any_changes() {
        let mut rng = Rng::new(72);
        let mut pairs = Pairs::default();
        let mut expected = BTreeSet::new();
        for _ in 0..20_000 {
            let bodies = [0; 2].map(|_| rng.integer(0, 30) as u32);
            let key = [bodies[0].min(bodies[1]), bodies[0].max(bodies[1])];
            if key[0] == key[1] {
                continue;
            }
            match pairs.find(bodies[0], bodies[1]) {
                Some(pair) => {
                    assert!(expected.remove(&key));
                    pairs.remove(pair);
                }
                None => {
                    assert!(expected.insert(key));
                    pairs.add(bodies);
                }
            }
            assert_eq!(pairs.len(), expected.len());
        }
        for body in 0..=30 {
            let mut others: Vec<u32> = pairs.of(body).iter().map(|link| link.other).collect();
            others.sort();
            let wanted = expected.iter().filter(|key| key.contains(&body));
            assert_eq!(others, wanted.map(|key| key[0] + key[1] - body).collect::<Vec<_>>());
        }
        assert!(pairs.iter().all(|entry| {
            expected.contains(&[entry.bodies[0].min(entry.bodies[1]), entry.bodies[0].max(entry.bodies[1])])
        }));
        assert!(expected.len() > 100 && pairs.entries.len() < 450);
    }
}
