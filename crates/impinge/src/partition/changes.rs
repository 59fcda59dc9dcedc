//! What a step does to boxes, and to the pairs that meet.

use crate::volume::MinMax;

/// Where a box goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Of the box; one that is not there comes.
    pub key: u32,
    /// Its new place; none where it goes.
    pub to: Option<MinMax>,
}

/// The pairs that began and that ended in a step, both sorted, with the lesser key first. Kept by the caller, so that a
/// step allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    began: Vec<[u32; 2]>,
    ended: Vec<[u32; 2]>,
    /// Each time that a pair began or ended while boxes moved one after the other.
    notes: Vec<([u32; 2], bool)>,
}

impl Changes {
    /// Pairs that meet now and did not before.
    #[must_use]
    pub fn began(&self) -> &[[u32; 2]] {
        &self.began
    }

    /// Pairs that met before and do not now.
    #[must_use]
    pub fn ended(&self) -> &[[u32; 2]] {
        &self.ended
    }

    pub(super) fn clear(&mut self) {
        self.began.clear();
        self.ended.clear();
        self.notes.clear();
    }

    /// Notes that a pair began or ended when one box moved.
    pub(super) fn note(&mut self, key: u32, other: u32, began: bool) {
        self.notes.push(([key.min(other), key.max(other)], began));
    }

    /// Makes sorted lists of the notes. What happens to a pair alternates, so that an even number of notes is none.
    pub(super) fn settle(&mut self) {
        self.notes.sort_unstable();
        for notes in self.notes.chunk_by(|one, other| one.0 == other.0) {
            let began = notes.iter().filter(|note| note.1).count();
            match (began, notes.len() - began) {
                (began, ended) if began > ended => self.began.push(notes[0].0),
                (began, ended) if began < ended => self.ended.push(notes[0].0),
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_that_begins_and_ends_did_neither() {
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
