//! Pairs of triangles of two leaves in a batch of eight: tight bounds of eight pairs take as long
//! as the bound of one pair.

use fearless_simd::Simd;

use super::leaf::Facing;
use crate::simd::{Choice, LANES, outlined};

/// Up to eight pairs of triangles, by their lanes in the host's leaf and in the guest's, with lower
/// bounds of their distances in metric units.
pub(super) struct PairBatch {
    lanes: [[usize; 2]; LANES],
    lower: [f32; LANES],
    count: usize,
}

impl PairBatch {
    pub(super) const NONE: Self = Self { lanes: [[0; 2]; LANES], lower: [0.0; LANES], count: 0 };

    /// Adds a pair to a batch that is not full.
    #[inline(always)]
    pub(super) fn push(&mut self, lanes: [usize; 2], lower: f32) {
        self.lanes[self.count] = lanes;
        self.lower[self.count] = lower;
        self.count += 1;
    }

    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.count == LANES
    }

    /// Raises the bounds if `is_wanted` is set, or if that takes no longer than the value of one
    /// pair.
    #[inline(always)]
    pub(super) fn raise<S: Simd>(&mut self, simd: S, facing: &Facing<'_, S>, is_wanted: bool) {
        if self.count > usize::from(!is_wanted) {
            let raised = outlined(
                simd,
                #[inline(always)]
                || facing.by_points(self.choices()),
            );
            for (lower, raised) in self.lower.iter_mut().zip(raised) {
                *lower = lower.max(raised);
            }
        }
    }

    /// Returns the least of the bounds and of `other`.
    #[inline(always)]
    pub(super) fn least(&self, other: f32) -> f32 {
        self.lower[..self.count].iter().fold(other, |least, &lower| least.min(lower))
    }

    /// Returns the lanes of the host's leaf and of the guest's leaf.
    #[inline(always)]
    fn choices(&self) -> [Choice; 2] {
        [0, 1].map(|side| Choice::new(self.lanes.map(|lanes| lanes[side])))
    }

    /// Removes and returns the pair with the least bound. If that bound is above `limit`, clears
    /// the batch and returns `None`.
    #[inline(always)]
    pub(super) fn take_nearest(&mut self, limit: f32) -> Option<([usize; 2], f32)> {
        let nearest =
            (0..self.count).reduce(|least, at| if self.lower[at] < self.lower[least] { at } else { least })?;
        let (lanes, lower) = (self.lanes[nearest], self.lower[nearest]);
        self.count -= 1;
        (self.lanes[nearest], self.lower[nearest]) = (self.lanes[self.count], self.lower[self.count]);
        if lower > limit {
            self.count = 0;
            return None;
        }
        Some((lanes, lower))
    }
}
