//! The queue of a search: pairs of children, the nearest last.

use super::bounds::LaneBounds;
use super::direction_bounds::Reach;
use super::slot::Slot;
use crate::simd::LANES;

/// Two children that are not yet processed, with a lower bound of their distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    /// Lower bound, comparable with [`Bounds::limit`](super::bounds::Bounds::limit).
    pub(super) bound: f32,
    pub(super) reach: Reach,
    /// Children of the host and of the guest.
    pub(super) slots: [Slot; 2],
    /// Index of the frontier's entry that has the bound of the children, or
    /// [`NO_ENTRY`](super::frontier::NO_ENTRY).
    pub(super) entry: u32,
}

/// Pairs of children that are sorted by their bounds before they are queued.
pub(super) struct Sorted {
    /// Order of each pair in the upper 32 bits, and its two lanes in the lower bits.
    keys: [u64; LANES * LANES],
    /// Bound and reach of each pair, by its two lanes.
    bounds: [[f32; 2]; LANES * LANES],
    count: usize,
}

impl Sorted {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { keys: [0; LANES * LANES], bounds: [[0.0; 2]; LANES * LANES], count: 0 }
    }

    /// Adds two children, by their lanes, with the bound of the lane `of` and the sum of their
    /// reaches.
    #[inline(always)]
    pub(super) fn add(&mut self, bounds: &LaneBounds, of: usize, reach: f32, [host_lane, guest_lane]: [usize; 2]) {
        let order = bounds.order[of].to_bits();
        // Floats are ordered like integers once the bits of negative floats are inverted.
        let ordered = order ^ (((order as i32 >> 31) as u32) | 1 << 31);
        let lanes = host_lane * LANES + guest_lane;
        self.keys[self.count] = u64::from(ordered) << 32 | lanes as u64;
        self.bounds[lanes] = [bounds.bounds[of], reach];
        self.count += 1;
    }

    /// Moves the added pairs to the tasks, the nearest last. `along` is the number of the direction
    /// of their reaches, and `entry` is their entry of the frontier.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        tasks: &mut Vec<Task>,
        (along, entry): (u32, u32),
        slots: impl Fn([u8; 2]) -> [Slot; 2],
    ) {
        let keys = &mut self.keys[..self.count];
        keys.sort_unstable_by(|x, y| y.cmp(x));
        tasks.reserve(keys.len());
        for &key in &*keys {
            let lanes = key as u8;
            let slots = slots([lanes / LANES as u8, lanes % LANES as u8]);
            let [bound, both] = self.bounds[usize::from(lanes)];
            tasks.push(Task { bound, reach: Reach { both, along }, slots, entry });
        }
        self.count = 0;
    }
}
