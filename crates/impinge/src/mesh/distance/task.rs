//! The queue of a search: pairs of children, the nearest last.

use super::bounds::LaneBounds;
use super::direction_bounds::Reach;
use super::slot::Slot;
use crate::simd::LANES;

/// Two children that are not yet processed, and a bound of their distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    pub(super) bound: f32,
    pub(super) reach: Reach,
    /// Children of the host and of the guest.
    pub(super) slots: [Slot; 2],
    /// Entry of the frontier with the bound of the children.
    pub(super) entry: u32,
}

/// Pairs of children that are sorted by their bounds.
pub(super) struct Sorted {
    keys: [u64; LANES * LANES],
    bounds: [[f32; 2]; LANES * LANES],
    count: usize,
}

impl Sorted {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { keys: [0; LANES * LANES], bounds: [[0.0; 2]; LANES * LANES], count: 0 }
    }

    /// Adds two children, by their lanes, with the bound of the lane `of` and how far they reach towards each other.
    #[inline(always)]
    pub(super) fn add(&mut self, bounds: &LaneBounds, of: usize, reach: f32, [host_lane, guest_lane]: [usize; 2]) {
        let order = bounds.order[of].to_bits();
        // Floats order like integers once those of negative ones are turned over.
        let ordered = order ^ (((order as i32 >> 31) as u32) | 1 << 31);
        let lanes = host_lane * LANES + guest_lane;
        self.keys[self.count] = u64::from(ordered) << 32 | lanes as u64;
        self.bounds[lanes] = [bounds.bounds[of], reach];
        self.count += 1;
    }

    /// Moves the pairs that were added to the tasks, the nearest last. `along` is the number of the direction of their reaches, and
    /// `entry` is their entry of the frontier.
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
