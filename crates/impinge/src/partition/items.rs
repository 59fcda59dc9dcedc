//! The boxes of a partition by key, and a box around all of them.

use crate::simd::prefetch;
use crate::volume::{BoundingVolume, MinMax};

/// Access to the boxes of a partition by key. Every partition implements this trait, and no type
/// outside this module can.
pub trait Holds {
    /// Returns the boxes of the partition, indexed by key.
    fn items(&self) -> &Items;
}

/// A box and its key.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub(super) bounds: MinMax,
    pub(super) key: u32,
}

/// The boxes of a partition, indexed by key.
#[derive(Clone, Debug, Default)]
pub struct Items {
    /// Boxes indexed by key. An entry is meaningless if its bit in `present` is not set.
    boxes: Vec<MinMax>,
    present: Vec<u64>,
    len: usize,
    bounds: Option<MinMax>,
    /// Number of moves and removals since `bounds` was exact.
    stale: usize,
}

/// Number of changes, beyond the number of boxes, after which the bounds are recomputed. It keeps
/// partitions with few boxes from being scanned after nearly every change.
const EXTRA_STALE: usize = 64;

impl Items {
    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn bounds(&self) -> Option<MinMax> {
        self.bounds
    }

    pub(super) fn get(&self, key: u32) -> Option<&MinMax> {
        let word = self.present.get(key as usize / 64)?;
        (word >> (key % 64) & 1 == 1).then(|| &self.boxes[key as usize])
    }

    /// Prefetches the box of a key.
    pub(super) fn prefetch(&self, key: u32) {
        if let Some(bounds) = self.boxes.get(key as usize) {
            prefetch(bounds);
        }
    }

    /// Stores a box under a key, and returns the box that was there before.
    pub(super) fn insert(&mut self, key: u32, bounds: MinMax) -> Option<MinMax> {
        let before = self.get(key).copied();
        let at = key as usize;
        if at >= self.boxes.len() {
            self.boxes.resize(at + 1, bounds);
            self.present.resize(at / 64 + 1, 0);
        }
        self.boxes[at] = bounds;
        self.present[at / 64] |= 1 << (at % 64);
        self.len += usize::from(before.is_none());
        self.bounds = Some(self.bounds.map_or(bounds, |all| all.merged(&bounds)));
        if before.is_some() {
            self.age();
        }
        before
    }

    /// Replaces the box of a key that is present.
    #[inline]
    pub(super) fn replace(&mut self, key: u32, bounds: MinMax) {
        if let Some(own) = self.boxes.get_mut(key as usize) {
            *own = bounds;
        }
        // Most boxes stay within the current bounds.
        if !self.bounds.is_some_and(|all| all.encloses(&bounds)) {
            self.bounds = Some(self.bounds.map_or(bounds, |all| all.merged(&bounds)));
        }
        self.age();
    }

    /// Removes a box and returns it, or returns `None` if the key has no box.
    pub(super) fn remove(&mut self, key: u32) -> Option<MinMax> {
        let before = *self.get(key)?;
        self.present[key as usize / 64] &= !(1 << (key % 64));
        self.len -= 1;
        self.age();
        Some(before)
    }

    /// Counts a change, and makes the bounds exact often enough at an amortized constant cost per
    /// change.
    #[inline]
    fn age(&mut self) {
        self.stale += 1;
        if self.len == 0 || self.stale > self.len + EXTRA_STALE {
            self.measure();
        }
    }

    #[cold]
    fn measure(&mut self) {
        self.stale = 0;
        self.bounds = self.iter().map(|(_, bounds)| *bounds).reduce(|all, one| all.merged(&one));
    }

    /// Returns the boxes in ascending order of their keys.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, &MinMax)> {
        self.present.iter().enumerate().flat_map(move |(at, &word)| {
            let mut rest = word;
            std::iter::from_fn(move || {
                let bit = (rest != 0).then(|| rest.trailing_zeros())?;
                rest &= rest - 1;
                let key = at * 64 + bit as usize;
                Some((key as u32, &self.boxes[key]))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> MinMax {
        MinMax::from_ordered([x; 3], [x + 1.0; 3])
    }

    #[test]
    fn boxes_are_found_by_key_and_the_bounds_follow() {
        let mut items = Items::default();
        for key in [70, 3, 64, 127] {
            assert_eq!(items.insert(key, at(f64::from(key))), None);
        }
        assert_eq!(items.insert(3, at(-5.0)), Some(at(3.0)));
        assert_eq!(items.remove(127), Some(at(127.0)));
        assert_eq!((items.remove(127), items.remove(5), items.remove(9999)), (None, None, None));
        let found: Vec<_> = items.iter().map(|(key, bounds)| (key, *bounds)).collect();
        assert_eq!(found, [(3, at(-5.0)), (64, at(64.0)), (70, at(70.0))]);
        for _ in 0..2 * EXTRA_STALE {
            items.insert(70, at(70.0));
        }
        assert_eq!(items.bounds(), Some(MinMax::from_ordered([-5.0; 3], [71.0; 3])));
        for key in [3, 64, 70] {
            items.remove(key);
        }
        assert_eq!((items.len(), items.bounds()), (0, None));
    }
}
