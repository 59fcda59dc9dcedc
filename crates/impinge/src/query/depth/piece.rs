//! A cell in the queue of the search for a depth, with the faces that matter in it.

use std::cmp::Ordering;

use super::cell::Cell;

/// A cell that is not done.
pub(super) struct Piece {
    pub(super) cell: Cell,
    pub(super) local: [Local; 2],
    /// No point of the cell that counts is deeper.
    pub(super) upper: f64,
    pub(super) number: usize,
}

/// One solid, seen from a cell.
#[derive(Clone)]
pub(super) struct Local {
    /// The flat parts that may be near a point of the cell.
    pub(super) facets: Vec<u32>,
    /// The faces that may be the nearest to a point of the cell.
    pub(super) near: Vec<u32>,
    /// The faces that reach the cell.
    pub(super) touching: Vec<u32>,
    /// Whether all points of the cell are known to be on the side of the surface that counts.
    pub(super) is_inside: bool,
    /// No point of the cell is farther from the surface.
    pub(super) reach: f64,
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Piece {
    /// Compares by the bound. Of equal bounds, that of the cell that was added first is greater.
    fn cmp(&self, other: &Self) -> Ordering {
        self.upper.total_cmp(&other.upper).then(other.number.cmp(&self.number))
    }
}
