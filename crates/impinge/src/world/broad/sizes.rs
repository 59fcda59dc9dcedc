//! How large boxes are, by a sample of them.

use crate::volume::MinMax;

/// Boxes that are looked at, at most.
pub(super) const SAMPLE: usize = 256;

/// The edge of the least cells of a grid, over the size that a quarter of the boxes exceed: so much that most boxes are in two or
/// four cells, of which most are a line of memory (`docs/partition.md`).
const ROOM: f64 = 1.25;

/// Where sizes are unknown, or none, in world units: smaller boxes share such cells.
const LEAST_CELL: f64 = 1.0 / 1024.0;

/// A grid stands until other cells would be so many times as large, or as small.
const STANDS: f64 = 1.5;

/// Sizes that an eighth of the boxes exceed are alike if they are less than so many times those that an eighth falls short of.
const ALIKE: f64 = 16.0;

/// Boxes that may come or move, beyond half as many as there are, before they are looked at again.
const PATIENCE: usize = 64;

/// What is known of the sizes.
#[derive(Clone, Debug)]
pub(super) struct Sizes {
    /// The edge of the least cells that suit the boxes.
    pub(super) cell: f64,
    /// Whether most boxes are of like size.
    pub(super) are_alike: bool,
    /// Boxes that came or moved since then.
    since: usize,
}

impl Default for Sizes {
    fn default() -> Self {
        Self { cell: LEAST_CELL, are_alike: false, since: 0 }
    }
}

impl Sizes {
    /// By the longest edges of some boxes.
    pub(super) fn of(sample: impl Iterator<Item = MinMax>) -> Self {
        let longest = |bounds: MinMax| (0..3).map(|k| bounds.max()[k] - bounds.min()[k]).fold(0.0, f64::max);
        let mut edges: Vec<f64> = sample.map(longest).collect();
        edges.sort_unstable_by(f64::total_cmp);
        let share = |eighths: usize| edges.get(edges.len() * eighths / 8).copied().unwrap_or(0.0);
        let cell = ROOM * share(6);
        let are_alike = share(7) <= ALIKE * share(1);
        Self { cell: if cell > 0.0 { cell } else { LEAST_CELL }, are_alike, since: 0 }
    }

    /// Notes that boxes came or moved.
    pub(super) fn age(&mut self, boxes: usize) {
        self.since += boxes;
    }

    /// Whether what is known of so many boxes is old.
    pub(super) fn are_old(&self, len: usize) -> bool {
        self.since > len / 2 + PATIENCE
    }

    /// Whether a grid with such cells still suits the boxes.
    pub(super) fn suit(&self, cell: f64) -> bool {
        cell <= STANDS * self.cell && self.cell <= STANDS * cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(edges: impl Iterator<Item = f64>) -> Sizes {
        Sizes::of(edges.map(|edge| MinMax::from_ordered([0.0; 3], [0.1 * edge, edge, 0.0])))
    }

    #[test]
    fn cells_are_a_little_larger_than_most_boxes() {
        let even = sizes((0..200).map(|at| 0.5 + f64::from(at) / 200.0));
        assert!(even.are_alike && even.cell > 1.4 && even.cell < 1.7, "{even:?}");
        // A floor under them changes neither, and points have cells, too.
        let floor = sizes((0..200).map(|at| if at == 77 { 1e9 } else { 1.0 }));
        assert!(floor.are_alike && floor.cell == ROOM, "{floor:?}");
        let points = sizes(std::iter::repeat_n(0.0, 50));
        assert!(points.are_alike && points.cell == LEAST_CELL);
        assert!(!sizes((0..200).map(|at| 1.1_f64.powi(at))).are_alike);
        assert!(even.suit(1.2 * even.cell) && !even.suit(1.6 * even.cell) && !even.suit(0.6 * even.cell));
    }
}
