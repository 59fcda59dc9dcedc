//! Sorting records as far as a sweep needs it: into slots of equal length, in which they are in no order.

use super::record::Record;

/// Slots for which records are sorted in full: some slot would hold so many that to compare all in it takes longer.
const FULLEST: u32 = 32;

/// Slots at most: their counts fit the first cache.
const MOST_SLOTS: usize = 1 << 11;

/// The order of records along a column.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots {
    /// The step at which the first slot begins.
    low: u32,
    /// How often the steps of a slot are halved to be one.
    shift: u32,
    last: u32,
    /// For each slot where it starts, and then where it ends, once all are in their places.
    next: Vec<u32>,
    /// All beginnings in order where slots were too full; else nothing.
    sorted: Vec<(f32, u32)>,
}

impl Slots {
    /// Puts records from one list into places of another, which is as long; `begin` tells where a record begins, more exactly than
    /// by steps.
    #[inline(always)]
    pub(super) fn sort(&mut self, from: &[Record], to: &mut [Record], begin: impl Fn(&Record) -> f32) {
        let (mut low, mut high) = (u32::MAX, 0);
        for record in from {
            let [step, _] = record.along();
            low = low.min(step);
            high = high.max(step);
        }
        self.low = low;
        let most = from.len().clamp(8, MOST_SLOTS) as u32;
        let range = high.saturating_sub(low);
        self.shift = (range / most).checked_ilog2().map_or(0, |halvings| halvings + 1);
        self.last = range >> self.shift;
        self.next.clear();
        self.next.resize(self.last as usize + 1, 0);
        self.sorted.clear();
        let shift = self.shift;
        // A slice of its own, which no write to another can move.
        let next = &mut self.next[..];
        for record in from {
            next[((record.along()[0] - low) >> shift) as usize] += 1;
        }
        let (mut before, mut fullest) = (0, 0);
        for next in &mut *next {
            fullest = fullest.max(*next);
            (*next, before) = (before, before + *next);
        }
        if fullest > FULLEST {
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

    /// Whether records are in order of where they begin exactly.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        !self.sorted.is_empty()
    }

    /// The slot of a step, monotone.
    #[inline(always)]
    fn slot(&self, step: u32) -> u32 {
        (step.saturating_sub(self.low) >> self.shift).min(self.last)
    }

    /// Where the records end that may begin at or before a step.
    #[inline(always)]
    pub(super) fn end(&self, step: u32) -> u32 {
        self.ends().at(step)
    }

    /// Asks for many ends.
    #[inline(always)]
    pub(super) fn ends(&self) -> Ends<'_> {
        Ends { low: self.low, shift: self.shift, last: self.last, ends: &self.next }
    }

    /// Where the records start that may begin at a step or after it.
    #[inline(always)]
    pub(super) fn start(&self, step: u32) -> u32 {
        self.slot(step).checked_sub(1).map_or(0, |before| self.next[before as usize])
    }

    /// As [`end`](Self::end) where all are in order.
    pub(super) fn full_end(&self, at: f32) -> u32 {
        self.sorted.partition_point(|&(begin, _)| begin <= at) as u32
    }

    /// As [`start`](Self::start) where all are in order.
    pub(super) fn full_start(&self, at: f32) -> u32 {
        self.sorted.partition_point(|&(begin, _)| begin < at) as u32
    }
}

/// Where slots end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends<'s> {
    low: u32,
    shift: u32,
    last: u32,
    ends: &'s [u32],
}

impl Ends<'_> {
    /// As [`Slots::end`].
    #[inline(always)]
    pub(super) fn at(&self, step: u32) -> u32 {
        self.ends[(step.saturating_sub(self.low) >> self.shift).min(self.last) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::{LAST, interval};
    use super::*;

    /// Steps that are alike, repeat, or crowd about one place so that all are sorted in full.
    fn steps(kind: usize, len: usize) -> impl Iterator<Item = u32> {
        (0..len).map(move |at| match kind {
            0 => (at * at % 97) as u32,
            1 => (at * 7919 % 32_749) as u32,
            2 => 30_000 / (1 + at * 31 % 1009) as u32,
            _ => 500,
        })
    }

    #[test]
    fn what_a_sweep_skips_lies_apart() {
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
