//! What is left of a search: pairs of children, the nearest to be taken next.

use crate::simd::LANES;

/// A child of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) node: u32,
    pub(super) lane: u8,
}

/// Two children whose triangles are still to be compared, and a bound of their distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    pub(super) bound: f32,
    pub(super) host: Slot,
    pub(super) guest: Slot,
}

/// Pairs of children by their bounds.
pub(super) struct Sorted {
    keys: [u64; LANES * LANES],
    count: usize,
}

impl Sorted {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { keys: [0; LANES * LANES], count: 0 }
    }

    #[inline(always)]
    pub(super) fn add_below(&mut self, limit: f32, bound: f32, host_lane: usize, guest_lane: usize) {
        // A bound that is not a number proves nothing.
        if bound > limit {
            return;
        }
        // Floats order like integers once those of negative ones are turned over.
        let ordered = bound.to_bits() ^ (((bound.to_bits() as i32 >> 31) as u32) | 1 << 31);
        self.keys[self.count] = u64::from(ordered) << 32 | (host_lane * LANES + guest_lane) as u64;
        self.count += 1;
    }

    /// Appends tasks, the nearest last.
    #[inline(always)]
    pub(super) fn push(&mut self, tasks: &mut Vec<Task>, slots: impl Fn(u8, u8) -> (Slot, Slot)) {
        let keys = &mut self.keys[..self.count];
        keys.sort_unstable_by(|x, y| y.cmp(x));
        tasks.extend(keys.iter().map(|&key| {
            let ordered = (key >> 32) as u32;
            let bits = ordered ^ ((!(ordered as i32 >> 31)) as u32 | 1 << 31);
            let lanes = key as u8;
            let (host, guest) = slots(lanes / LANES as u8, lanes % LANES as u8);
            Task { bound: f32::from_bits(bits), host, guest }
        }));
    }
}
