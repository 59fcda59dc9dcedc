//! All pairs anew at each step.

use super::every::Every;
use crate::partition::ColumnSweep;
use crate::volume::MinMax;

/// Boxes side by side, and a sweep that keeps nothing of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    pub(super) boxes: Every,
    sweep: ColumnSweep,
}

impl Columns {
    /// All pairs of bodies whose boxes overlap.
    pub(super) fn pairs(&mut self) -> Vec<[u32; 2]> {
        let boxes: Vec<MinMax> = self.boxes.boxes().iter().map(|(bounds, _)| *bounds).collect();
        let mut pairs = Vec::new();
        self.sweep.find(&boxes, &mut pairs);
        let body = |place: u32| self.boxes.boxes()[place as usize].1;
        pairs.iter_mut().for_each(|pair| *pair = pair.map(body));
        pairs
    }
}
