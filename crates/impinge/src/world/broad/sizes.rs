//! Statistics of box sizes, from a sample.

use crate::volume::MinMax;

/// Maximum number of boxes in a sample.
pub(super) const SAMPLE: usize = 256;

/// Edge length of the smallest cells of a grid, relative to the 75th percentile of the box sizes.
/// With 1.25, most boxes are in two or four cells, and most of these cells fit into one line of
/// memory (`docs/tasks/partitions.md`).
const CELL_FACTOR: f64 = 1.25;

/// Edge length of the smallest cells, in world units, if sizes are unknown or zero. Smaller boxes
/// share these cells.
const DEFAULT_CELL: f64 = 1.0 / 1024.0;

/// Maximum ratio between the cells of a grid and the best cells before the grid is rebuilt.
const CELL_TOLERANCE: f64 = 1.5;

/// Sizes count as uniform if the 87.5th percentile is at most this number of times the 12.5th
/// percentile.
const MAX_SIZE_RATIO: f64 = 16.0;

/// Number of boxes that may be inserted or moved, beyond half the number of boxes, before the sizes
/// are measured again.
const EXTRA_AGE: usize = 64;

/// Statistics of the sizes of boxes, by their longest edges.
#[derive(Clone, Debug)]
pub(super) struct Sizes {
    /// Edge length of the smallest cells that suit the boxes.
    pub(super) cell: f64,
    /// `true` if most boxes are of similar size.
    pub(super) are_uniform: bool,
    /// Number of boxes that were inserted or moved since the sizes were measured.
    since: usize,
}

impl Default for Sizes {
    fn default() -> Self {
        Self { cell: DEFAULT_CELL, are_uniform: false, since: 0 }
    }
}

impl Sizes {
    /// Computes the statistics from the longest edges of a sample of boxes.
    pub(super) fn of(sample: impl Iterator<Item = MinMax>) -> Self {
        let longest = |bounds: MinMax| (0..3).map(|k| bounds.max()[k] - bounds.min()[k]).fold(0.0, f64::max);
        let mut edges: Vec<f64> = sample.map(longest).collect();
        edges.sort_unstable_by(f64::total_cmp);
        let share = |eighths: usize| edges.get(edges.len() * eighths / 8).copied().unwrap_or(0.0);
        let cell = CELL_FACTOR * share(6);
        let are_uniform = share(7) <= MAX_SIZE_RATIO * share(1);
        Self { cell: if cell > 0.0 { cell } else { DEFAULT_CELL }, are_uniform, since: 0 }
    }

    /// Counts boxes that were inserted or moved.
    pub(super) fn age(&mut self, boxes: usize) {
        self.since += boxes;
    }

    /// Reports whether the statistics are stale, given the number of boxes.
    pub(super) fn are_stale(&self, len: usize) -> bool {
        self.since > len / 2 + EXTRA_AGE
    }

    /// Reports whether a grid with these cells still suits the boxes.
    pub(super) fn fit(&self, cell: f64) -> bool {
        cell <= CELL_TOLERANCE * self.cell && self.cell <= CELL_TOLERANCE * cell
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
        assert!(even.are_uniform && even.cell > 1.4 && even.cell < 1.7, "{even:?}");
        // One large floor changes neither, and points get cells, too.
        let floor = sizes((0..200).map(|at| if at == 77 { 1e9 } else { 1.0 }));
        assert!(floor.are_uniform && floor.cell == CELL_FACTOR, "{floor:?}");
        let points = sizes(std::iter::repeat_n(0.0, 50));
        assert!(points.are_uniform && points.cell == DEFAULT_CELL);
        assert!(!sizes((0..200).map(|at| 1.1_f64.powi(at))).are_uniform);
        assert!(even.fit(1.2 * even.cell) && !even.fit(1.6 * even.cell) && !even.fit(0.6 * even.cell));
    }
}
