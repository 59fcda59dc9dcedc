//! Finds all pairs again at each step.

use super::every::Every;
use crate::budget::{Budget, Stopped};
use crate::partition::ColumnSweep;

/// An array of boxes, and a sweep over it that keeps nothing between steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    pub(super) boxes: Every,
    sweep: ColumnSweep,
}

impl Columns {
    /// Returns all pairs of bodies whose boxes overlap.
    ///
    /// # Errors
    /// Returns an error if the budget ended the sweep, or if there is not enough memory.
    pub(super) fn pairs(&mut self, budget: &Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> {
        let mut pairs = Vec::new();
        self.sweep.try_find(self.boxes.boxes(), &mut pairs, budget)?;
        let bodies = self.boxes.bodies();
        pairs.iter_mut().for_each(|pair| *pair = pair.map(|place| bodies[place as usize]));
        Ok(pairs)
    }
}
