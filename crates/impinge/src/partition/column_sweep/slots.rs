//! Sorts records as far as a sweep needs it: into slots of equal length, within which the order is
//! arbitrary.

use super::record::Record;

/// Maximum number of records in a slot. If a slot would hold more, all records are sorted
/// completely instead, because comparing everything in a full slot takes longer.
const MAX_SLOT_LEN: u32 = 32;

/// Maximum number of slots. Their counts fit into the first-level cache.
const MAX_SLOTS: usize = 1 << 11;

/// The order of records along a column.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots {
    /// Step at which the first slot begins.
    low: u32,
    /// Binary logarithm of the number of steps in a slot.
    shift: u32,
    /// Number of the last slot.
    last: u32,
    /// Start of each slot while records are counted, and its end once all records are in their
    /// places.
    next: Vec<u32>,
    /// Beginnings of all records with their indices, in order, if a slot was too full. Empty
    /// otherwise.
    sorted: Vec<(f32, u32)>,
}

impl Slots {
    /// Writes the records of `from` to `to`, which has the same length, in slot order. `begin`
    /// returns the image at which a record begins, which is more precise than its step.
    #[inline(always)]
    pub(super) fn sort(&mut self, from: &[Record], to: &mut [Record], begin: impl Fn(&Record) -> f32) {
        let (mut low, mut high) = (u32::MAX, 0);
        for record in from {
            let [step, _] = record.along();
            low = low.min(step);
            high = high.max(step);
        }
        self.low = low;
        let most = from.len().clamp(8, MAX_SLOTS) as u32;
        let range = high.saturating_sub(low);
        self.shift = (range / most).checked_ilog2().map_or(0, |halvings| halvings + 1);
        self.last = range >> self.shift;
        self.next.clear();
        self.next.resize(self.last as usize + 1, 0);
        self.sorted.clear();
        let shift = self.shift;
        // A local slice, so that the compiler knows that no other write changes it.
        let next = &mut self.next[..];
        for record in from {
            next[((record.along()[0] - low) >> shift) as usize] += 1;
        }
        let (mut before, mut fullest) = (0, 0);
        for next in &mut *next {
            fullest = fullest.max(*next);
            (*next, before) = (before, before + *next);
        }
        if fullest > MAX_SLOT_LEN {
            self.sorted.extend(from.iter().map(begin).zip(0..));
            self.sorted.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
            to.iter_mut().zip(&self.sorted).for_each(|(to, &(_, place))| *to = from[place as usize]);
            return;
        }
        for record in from {
            let next = &mut next[((record.along()[0] - low) >> shift) as usize];
            to[*next as usize] = *record;
            *next += 1;
        }
    }

    /// Reports whether the records are sorted completely, by their exact beginnings.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        !self.sorted.is_empty()
    }

    /// Returns the slot of a step; monotone.
    #[inline(always)]
    fn slot(&self, step: u32) -> u32 {
        (step.saturating_sub(self.low) >> self.shift).min(self.last)
    }

    /// Returns the index after the last record that may begin at or before a step.
    #[inline(always)]
    pub(super) fn end(&self, step: u32) -> u32 {
        self.ends().at(step)
    }

    /// Returns the ends of all slots, for many lookups.
    #[inline(always)]
    pub(super) fn ends(&self) -> Ends<'_> {
        Ends { low: self.low, shift: self.shift, last: self.last, ends: &self.next }
    }

    /// Returns the index of the first record that may begin at or after a step.
    #[inline(always)]
    pub(super) fn start(&self, step: u32) -> u32 {
        self.slot(step).checked_sub(1).map_or(0, |before| self.next[before as usize])
    }

    /// Like [`end`](Self::end), for an image, if the records are sorted completely.
    pub(super) fn full_end(&self, at: f32) -> u32 {
        self.sorted.partition_point(|&(begin, _)| begin <= at) as u32
    }

    /// Like [`start`](Self::start), for an image, if the records are sorted completely.
    pub(super) fn full_start(&self, at: f32) -> u32 {
        self.sorted.partition_point(|&(begin, _)| begin < at) as u32
    }
}

/// Ends of the slots, with the map from steps to slots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends<'s> {
    low: u32,
    shift: u32,
    last: u32,
    ends: &'s [u32],
}

impl Ends<'_> {
    /// Like [`Slots::end`].
    #[inline(always)]
    pub(super) fn at(&self, step: u32) -> u32 {
        self.ends[(step.saturating_sub(self.low) >> self.shift).min(self.last) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::{LAST, interval};
    use super::*;

    /// Steps that are close together, that repeat, or that crowd around one place so that all
    /// records are sorted completely.
    fn steps(kind: usize, len: usize) -> impl Iterator<Item = u32> {
        (0..len).map(move |at| match kind {
            0 => (at * at % 97) as u32,
            1 => (at * 7919 % 32_749) as u32,
            2 => 30_000 / (1 + at * 31 % 1009) as u32,
            _ => 500,
        })
    }

    #[test]
    fn records_that_a_sweep_skips_are_apart() {
        let (mut slots, mut full) = (Slots::default(), 0);
        for (kind, len) in [(0, 0), (0, 1), (0, 90), (0, 4000), (1, 500), (1, 5000), (2, 900), (3, 20), (3, 300)] {
            let records: Vec<Record> =
                steps(kind, len).zip(0..).map(|(step, key)| Record::new(interval(step, step), [0; 2], key)).collect();
            let mut sorted = vec![Record::default(); len];
            slots.sort(&records, &mut sorted, |record| record.along()[0] as f32);
            full += usize::from(slots.is_full());
            let mut keys: Vec<u32> = sorted.iter().map(|record| record.key).collect();
            keys.sort_unstable();
            assert!(keys.iter().copied().eq(0..len as u32), "kind {kind}, {len}: not each record once");
            let begin = |record: &Record| record.along()[0];
            for step in steps(kind, len).flat_map(|step| [step, (step + 1).min(LAST), step.saturating_sub(1), 0, LAST])
            {
                let (start, end) = if slots.is_full() {
                    (slots.full_start(step as f32), slots.full_end(step as f32))
                } else {
                    (slots.start(step), slots.end(step))
                };
                let (before, behind) = (&sorted[..start as usize], &sorted[end as usize..]);
                assert!(before.iter().all(|record| begin(record) < step), "kind {kind}, {len}: before {step}");
                assert!(behind.iter().all(|record| begin(record) > step), "kind {kind}, {len}: behind {step}");
            }
        }
        assert!((3..7).contains(&full), "{full} of 9 were sorted in full");
    }
}
