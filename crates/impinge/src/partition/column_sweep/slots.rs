//! Sorting coordinates as far as a sweep needs it: into slots of equal length, in which they are in no order.

/// Slots for which coordinates are sorted in full: some slot would hold so many that to compare all in it takes longer.
const FULLEST: u32 = 24;

/// Slots at most: their counts fit the first cache.
const MOST_SLOTS: usize = 1 << 11;

/// A float of which the lower bits are a whole number: to add it rounds to the nearest, and costs less than a conversion.
const WHOLE: f32 = (3_u32 << 22) as f32;

/// Where coordinates belong in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots {
    low: f32,
    scale: f32,
    last: f32,
    /// For each coordinate the slot it is in.
    slots: Vec<u16>,
    /// For each slot where the next coordinate goes; where it ends, once all are there.
    next: Vec<u32>,
    /// All coordinates in order where slots were too full, and where each came from; else nothing.
    sorted: Vec<(f32, u32)>,
}

impl Slots {
    /// Finds the slots of these coordinates, which are numbers.
    #[inline(always)]
    pub(super) fn sort(&mut self, coordinates: impl Iterator<Item = f32> + Clone) {
        let (mut low, mut high, mut len) = (f32::INFINITY, f32::NEG_INFINITY, 0);
        for x in coordinates.clone() {
            low = if x < low { x } else { low };
            high = if x > high { x } else { high };
            len += 1;
        }
        let last = (len.min(MOST_SLOTS) - usize::from(len > 0)) as f32;
        self.low = low;
        self.last = last;
        self.scale = if high > low { (last / (high - low)).min(f32::MAX) } else { 0.0 };
        self.slots.clear();
        self.next.clear();
        self.next.resize(last as usize + 1, 0);
        self.sorted.clear();
        self.slots.resize(len, 0);
        for (slot, x) in self.slots.iter_mut().zip(coordinates.clone()) {
            let cut = ((x - low) * self.scale).clamp(0.0, last);
            *slot = (cut + WHOLE).to_bits() as u16;
        }
        for &slot in &self.slots {
            self.next[usize::from(slot)] += 1;
        }
        let (mut before, mut fullest) = (0, 0);
        for next in &mut self.next {
            fullest = fullest.max(*next);
            (*next, before) = (before, before + *next);
        }
        if fullest > FULLEST {
            self.sorted.extend(coordinates.zip(0..));
            self.sorted.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        }
    }

    /// Calls with each coordinate's number and its place in order, once after each sort.
    #[inline(always)]
    pub(super) fn each_place(&mut self, mut put: impl FnMut(usize, usize)) {
        if !self.sorted.is_empty() {
            return self.sorted.iter().enumerate().for_each(|(to, &(_, from))| put(from as usize, to));
        }
        for (from, &slot) in self.slots.iter().enumerate() {
            let next = &mut self.next[usize::from(slot)];
            put(from, *next as usize);
            *next += 1;
        }
    }

    /// The slot of a coordinate, monotone: rounded differences, products and sums are. Where all are sorted, how many are not
    /// greater.
    #[inline(always)]
    pub(super) fn of(&self, x: f32) -> u32 {
        if !self.sorted.is_empty() {
            return self.sorted.partition_point(|&(begin, _)| begin <= x) as u32;
        }
        let cut = ((x - self.low) * self.scale).clamp(0.0, self.last);
        u32::from((cut + WHOLE).to_bits() as u16)
    }

    /// Where the coordinates of a slot start.
    #[inline(always)]
    pub(super) fn start(&self, slot: u32) -> usize {
        if !self.sorted.is_empty() {
            return slot as usize;
        }
        slot.checked_sub(1).map_or(0, |before| self.end(before))
    }

    /// Where they end.
    #[inline(always)]
    pub(super) fn end(&self, slot: u32) -> usize {
        if !self.sorted.is_empty() { slot as usize } else { self.next[slot as usize] as usize }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coordinates that are alike, repeat, or crowd about one place so that all are sorted in full.
    fn coordinates(kind: usize, len: usize) -> Vec<f32> {
        (0..len)
            .map(|at| match kind {
                0 => (at * at % 97) as f32,
                1 => (at * 7919 % 4093) as f32 * 0.37 - 700.0,
                2 => 1.0 / (1.0 + (at * 31 % 1009) as f32),
                _ => 5.0,
            })
            .collect()
    }

    #[test]
    fn what_a_sweep_skips_lies_apart() {
        let (mut slots, mut full) = (Slots::default(), 0);
        for (kind, len) in [(0, 0), (0, 1), (0, 90), (0, 4000), (1, 500), (1, 5000), (2, 900), (3, 20), (3, 300)] {
            let coordinates = coordinates(kind, len);
            slots.sort(coordinates.iter().copied());
            full += usize::from(!slots.sorted.is_empty());
            let mut sorted = vec![f32::NAN; len];
            slots.each_place(|from, to| {
                assert!(sorted[to].is_nan(), "one place for two");
                sorted[to] = coordinates[from];
            });
            let asked = coordinates.iter().flat_map(|&x| [x, x + 0.01, x.next_down(), -x, 1e30, -1e30]);
            for x in asked {
                let slot = slots.of(x);
                assert!(sorted[slots.end(slot)..].iter().all(|&behind| behind > x), "kind {kind}, {len}: behind {x}");
                let below = slots.start(slots.of(x.next_down()));
                assert!(sorted[..below].iter().all(|&before| before < x), "kind {kind}, {len}: before {x}");
            }
        }
        assert!((3..7).contains(&full), "{full} of 9 were sorted in full");
    }
}
