//! The moves of a step, and the pairs that begin or end in it.

use std::collections::TryReserveError;

use crate::budget::Stopped;
use crate::storage::TryPush;
use crate::volume::MinMax;

/// A change to one box: a new position, or removal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Key of the box. If the key has no box yet, the move inserts one.
    pub key: u32,
    /// New box, or `None` to remove the box.
    pub to: Option<MinMax>,
}

/// Pairs that began and pairs that ended in a step, both sorted, with the smaller key first. The
/// caller keeps this value, so that a step need not allocate.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    began: Vec<[u32; 2]>,
    ended: Vec<[u32; 2]>,
    /// One note for each time that a pair began (`true`) or ended (`false`) while boxes moved one
    /// after the other.
    notes: Vec<([u32; 2], bool)>,
    /// Error of the allocation that failed. Notes after it are missing.
    failed: Option<TryReserveError>,
}

impl Changes {
    /// Returns the pairs of keys whose boxes overlap now and did not before the step, sorted.
    #[must_use]
    pub fn began(&self) -> &[[u32; 2]] {
        &self.began
    }

    /// Returns the pairs of keys whose boxes overlapped before the step and do not now, sorted.
    #[must_use]
    pub fn ended(&self) -> &[[u32; 2]] {
        &self.ended
    }

    /// Checks that the lists are complete. The boxes of a step have moved in any case.
    ///
    /// # Errors
    /// Returns [`Memory`](Stopped::Memory) if there was not enough memory for the pairs. Both lists
    /// are then empty.
    pub fn check_complete(&self) -> Result<(), Stopped> {
        self.failed.clone().map_or(Ok(()), |error| Err(error.into()))
    }

    pub(super) fn clear(&mut self) {
        self.began.clear();
        self.ended.clear();
        self.notes.clear();
        self.failed = None;
    }

    /// Records that a pair began or ended when one box moved.
    pub(super) fn note(&mut self, key: u32, other: u32, began: bool) {
        if self.failed.is_none() {
            self.failed = self.notes.try_push(([key.min(other), key.max(other)], began)).err();
        }
    }

    /// Turns the notes into sorted lists. Beginnings and ends of a pair alternate, so an even
    /// number of notes cancels.
    pub(super) fn settle(&mut self) {
        if self.failed.is_some() {
            self.notes = Vec::new();
        }
        self.notes.sort_unstable();
        if let Err(error) = self.settled() {
            self.failed = Some(error);
            self.began.clear();
            self.ended.clear();
        }
    }

    fn settled(&mut self) -> Result<(), TryReserveError> {
        for notes in self.notes.chunk_by(|one, other| one.0 == other.0) {
            let began = notes.iter().filter(|note| note.1).count();
            match (began, notes.len() - began) {
                (began, ended) if began > ended => self.began.try_push(notes[0].0)?,
                (began, ended) if began < ended => self.ended.try_push(notes[0].0)?,
                _ => {}
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_that_begins_and_ends_is_not_listed() {
        let mut changes = Changes::default();
        changes.note(7, 3, true);
        changes.note(3, 7, false);
        changes.note(9, 1, false);
        changes.note(1, 2, true);
        changes.note(2, 1, false);
        changes.note(1, 2, true);
        changes.settle();
        assert_eq!((changes.began(), changes.ended()), (&[[1, 2]][..], &[[1, 9]][..]));
    }
}
