//! The pairs that the broad phase left, each with what the narrow phase made of it, found from either body.

use super::narrow::Meeting;

/// Pairs by number, and the numbers of the pairs of each body.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    entries: Vec<Option<Entry>>,
    free: Vec<u32>,
    /// By place of the body.
    links: Vec<Vec<Link>>,
}

/// A pair.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// The places of the bodies, in the order in which they are reported.
    pub(super) bodies: [u32; 2],
    /// Where the pair is in the list of each.
    places: [u32; 2],
    /// None where the bodies are apart, or were not looked at yet.
    pub(super) meeting: Option<Meeting>,
}

/// A pair in the list of one of its bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Link {
    /// The other body.
    pub(super) other: u32,
    /// The number of the pair.
    pub(super) pair: u32,
}

impl Pairs {
    /// Adds a pair that is not there yet.
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

    /// Takes a pair out, in constant time however many others its bodies have.
    pub(super) fn remove(&mut self, pair: u32) -> Option<Entry> {
        let entry = self.entries.get_mut(pair as usize)?.take()?;
        self.free.push(pair);
        for side in 0..2 {
            let (body, place) = (entry.bodies[side], entry.places[side] as usize);
            let links = &mut self.links[body as usize];
            links.swap_remove(place);
            // The last of the list is now in this place.
            if let Some(moved) = links.get(place)
                && let Some(other) = &mut self.entries[moved.pair as usize]
            {
                other.places[usize::from(other.bodies[0] != body)] = place as u32;
            }
            if links.is_empty() && links.capacity() > MOST_KEPT {
                *links = Vec::new();
            }
        }
        Some(entry)
    }

    /// The pairs of a body.
    pub(super) fn of(&self, body: u32) -> &[Link] {
        self.links.get(body as usize).map_or(&[], Vec::as_slice)
    }

    pub(super) fn get(&self, pair: u32) -> Option<&Entry> {
        self.entries.get(pair as usize)?.as_ref()
    }

    pub(super) fn get_mut(&mut self, pair: u32) -> Option<&mut Entry> {
        self.entries.get_mut(pair as usize)?.as_mut()
    }

    /// The pair of two bodies, looked for in the shorter list.
    pub(super) fn find(&self, one: u32, other: u32) -> Option<u32> {
        let (of, sought) = if self.of(one).len() <= self.of(other).len() { (one, other) } else { (other, one) };
        self.of(of).iter().find(|link| link.other == sought).map(|link| link.pair)
    }

    /// Every pair, in no order that means anything.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().flatten()
    }

    /// How many pairs there are.
    pub(super) fn len(&self) -> usize {
        self.entries.len() - self.free.len()
    }
}

/// A list of more places than this is given back when it is empty, so that a body that once met a crowd does not keep the room for it.
const MOST_KEPT: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;
    use std::collections::BTreeSet;

    #[test]
    fn lists_and_pairs_agree_whatever_comes_and_goes() {
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
