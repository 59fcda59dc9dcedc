//! Applies moves in batches, so that the memory of all moves of a batch is prefetched at once.

use super::super::{Changes, Dynamic, Move, record};
use super::cell_visits::CellVisits;
use super::move_batch::{BATCH, MoveBatch};
use crate::volume::MinMax;

/// A grid that can process moves in batches.
pub(super) trait BatchedMoves: Dynamic {
    /// Returns the number of levels of cells.
    fn levels(&self) -> usize;

    /// Records the cells that a moving box visits, in each level. Returns `true` if its path is
    /// short and all its boxes are in cells.
    fn note_path(&self, mover: usize, path: &[MinMax; 2], visits: &mut [CellVisits]) -> bool;

    /// Moves the boxes of a batch, and records which overlaps begin and end.
    fn apply_batch(&mut self, batch: &MoveBatch, visits: &mut [CellVisits], changes: &mut Changes);
}

/// Applies moves. The result is the same as if they were applied one after the other.
pub(super) fn step(grid: &mut impl BatchedMoves, moves: &[Move], changes: &mut Changes) {
    changes.clear();
    let mut batch = MoveBatch::new();
    let mut visits: Vec<CellVisits> = Vec::new();
    for (at, step) in moves.iter().enumerate() {
        if at % BATCH == 0 {
            // Also prefetches the boxes of the next batch: they arrive while this batch waits for
            // its memory.
            let first = if at == 0 { 0 } else { at + BATCH };
            for step in moves.iter().take(at + 2 * BATCH).skip(first) {
                grid.items().prefetch(step.key);
            }
        }
        if batch.holds(step.key) {
            apply_batch(grid, &mut batch, &mut visits, changes);
        }
        if let (Some(from), Some(to)) = (grid.items().get(step.key), &step.to) {
            if visits.len() != grid.levels() {
                visits.resize_with(grid.levels(), CellVisits::default);
            }
            let (mover, path) = batch.next(from, to);
            if grid.note_path(mover, path, &mut visits) {
                batch.add(step.key);
                if batch.is_full() {
                    apply_batch(grid, &mut batch, &mut visits, changes);
                }
                continue;
            }
        }
        apply_batch(grid, &mut batch, &mut visits, changes);
        record(grid, step, changes);
        match step.to {
            Some(bounds) => grid.insert(step.key, bounds),
            None => grid.remove(step.key),
        };
    }
    apply_batch(grid, &mut batch, &mut visits, changes);
    changes.settle();
}

fn apply_batch(grid: &mut impl BatchedMoves, batch: &mut MoveBatch, visits: &mut [CellVisits], changes: &mut Changes) {
    if !batch.is_empty() {
        grid.apply_batch(batch, visits, changes);
        batch.clear();
    }
}
