//! Finds all pairs again at each step.

use super::every::Every;
use crate::partition::ColumnSweep;

/// An array of boxes, and a sweep over it that keeps nothing between steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    pub(super) boxes: Every,
    sweep: ColumnSweep,
}

impl Columns {
    /// Returns all pairs of bodies whose boxes overlap.
    pub(super) fn pairs(&mut self) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        self.sweep.find(self.boxes.boxes(), &mut pairs);
        let bodies = self.boxes.bodies();
        pairs.iter_mut().for_each(|pair| *pair = pair.map(|place| bodies[place as usize]));
        pairs
    }
}
