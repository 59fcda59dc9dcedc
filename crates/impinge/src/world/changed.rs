//! Records which bodies changed since the last step, and how.

/// How a body changed since the last step. A greater value includes the smaller ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Change {
    /// The body did not change.
    #[default]
    No,
    /// A step moved the body.
    Moved,
    /// A call other than a step changed the pose or the shape, or a step moved a body that no box
    /// bounds.
    Place,
    /// The traits changed, so pairs must be filtered again.
    Traits,
}

/// The change of the body in each slot. It is apart from the bodies, because a step reads it for
/// every pair.
#[derive(Clone, Debug, Default)]
pub(super) struct Changed {
    /// Change by slot. Bodies beyond the end did not change.
    how: Vec<Change>,
    /// Slots of bodies that changed. It may contain slots of removed bodies, and slots twice.
    places: Vec<u32>,
}

impl Changed {
    pub(super) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Returns the change of the body in a slot.
    #[inline]
    pub(super) fn of(&self, place: u32) -> Change {
        self.how.get(place as usize).copied().unwrap_or(Change::No)
    }

    /// Records a change of the body in a slot, and returns the change that was known before.
    #[inline]
    pub(super) fn mark(&mut self, place: u32, change: Change) -> Change {
        let at = place as usize;
        if at >= self.how.len() {
            self.how.resize(at + 1, Change::No);
        }
        let before = self.how[at];
        if before == Change::No && change != Change::No {
            // Bodies that come and go without a step list their slots again and again.
            if self.places.len() >= 2 * self.how.len() {
                self.tidy();
            }
            self.places.push(place);
        }
        self.how[at] = before.max(change);
        before
    }

    /// Removes slots of bodies that did not change, and slots that are listed twice.
    fn tidy(&mut self) {
        self.places.retain(|&place| self.how[place as usize] != Change::No);
        self.places.sort_unstable();
        self.places.dedup();
    }

    /// Forgets the change of the body in a slot, for example because it was removed.
    pub(super) fn forget(&mut self, place: u32) {
        if let Some(how) = self.how.get_mut(place as usize) {
            *how = Change::No;
        }
    }

    /// Sets the change of the body in a slot back to an earlier one.
    pub(super) fn set_back(&mut self, place: u32, change: Change) {
        if let Some(how) = self.how.get_mut(place as usize) {
            *how = change;
        }
    }

    /// Returns the slots of the changed bodies, sorted.
    pub(super) fn places(&mut self) -> Vec<u32> {
        self.tidy();
        self.places.clone()
    }

    /// Forgets all changes.
    pub(super) fn clear(&mut self) {
        for place in self.places.drain(..) {
            self.how[place as usize] = Change::No;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_change_counts_and_removed_bodies_did_not_change() {
        let mut changed = Changed::default();
        assert!(changed.is_empty() && changed.of(7) == Change::No);
        for (place, change) in [(5, Change::Moved), (2, Change::Traits), (5, Change::Place), (2, Change::Moved)] {
            changed.mark(place, change);
        }
        changed.mark(9, Change::No);
        changed.mark(3, Change::Moved);
        changed.forget(3);
        // Another body in the slot of a removed one.
        changed.forget(2);
        changed.mark(2, Change::Moved);
        assert_eq!(changed.places(), [2, 5]);
        assert_eq!([2, 3, 5, 9].map(|place| changed.of(place)), [Change::Moved, Change::No, Change::Place, Change::No]);
        changed.set_back(5, Change::No);
        assert_eq!(changed.places(), [2]);
        changed.clear();
        assert!(changed.is_empty() && changed.of(2) == Change::No);
    }

    #[test]
    fn bodies_that_come_and_go_take_no_more_memory() {
        let mut changed = Changed::default();
        for round in 0..10_000 {
            changed.mark(round % 3, Change::Place);
            changed.forget(round % 3);
        }
        changed.mark(1, Change::Place);
        assert!(changed.places.capacity() <= 16, "{}", changed.places.capacity());
        assert_eq!(changed.places(), [1]);
    }
}
