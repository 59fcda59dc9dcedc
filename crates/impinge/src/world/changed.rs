//! Which bodies changed since the last step, and how.

/// How a body changed since the last step; the greater holds the lesser.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Change {
    /// It did not.
    No,
    /// A step moved it.
    Moved,
    /// Its pose or its shape, by something else than a step; or it moved and no box bounds it.
    Place,
    /// Whom it meets.
    Traits,
}

/// How the body in each place changed. Apart from the bodies, as a step asks it of every pair.
#[derive(Clone, Debug, Default)]
pub(super) struct Changed {
    /// By place; bodies beyond the last did not change.
    how: Vec<Change>,
    /// The places of those that did; perhaps of some that are gone or changed twice.
    places: Vec<u32>,
}

impl Changed {
    pub(super) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// How the body in a place changed.
    #[inline]
    pub(super) fn of(&self, place: u32) -> Change {
        self.how.get(place as usize).copied().unwrap_or(Change::No)
    }

    /// Notes that it did.
    pub(super) fn mark(&mut self, place: u32, change: Change) {
        let at = place as usize;
        if at >= self.how.len() {
            self.how.resize(at + 1, Change::No);
        }
        if self.how[at] == Change::No && change != Change::No {
            self.places.push(place);
        }
        self.how[at] = self.how[at].max(change);
    }

    /// Notes that the body in a place is gone.
    pub(super) fn forget(&mut self, place: u32) {
        if let Some(how) = self.how.get_mut(place as usize) {
            *how = Change::No;
        }
    }

    /// Takes the places of the bodies that changed out, in order; how they did stands until they are forgotten.
    pub(super) fn take(&mut self) -> Vec<u32> {
        let mut places = std::mem::take(&mut self.places);
        places.retain(|&place| self.of(place) != Change::No);
        places.sort_unstable();
        places.dedup();
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_change_counts_and_what_is_gone_did_not_change() {
        let mut changed = Changed::default();
        assert!(changed.is_empty() && changed.of(7) == Change::No);
        for (place, change) in [(5, Change::Moved), (2, Change::Traits), (5, Change::Place), (2, Change::Moved)] {
            changed.mark(place, change);
        }
        changed.mark(9, Change::No);
        changed.mark(3, Change::Moved);
        changed.forget(3);
        // Another body in a place that one left.
        changed.forget(2);
        changed.mark(2, Change::Moved);
        assert_eq!(changed.take(), [2, 5]);
        assert_eq!([2, 3, 5, 9].map(|place| changed.of(place)), [Change::Moved, Change::No, Change::Place, Change::No]);
        assert!(changed.is_empty());
    }
}
