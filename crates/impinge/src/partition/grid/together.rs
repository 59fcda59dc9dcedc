//! Moves that are done together, so that the memory that they need is asked for at once.

use super::super::{Changes, Dynamic, Items, Move, record};
use super::follow::Looks;
use crate::volume::MinMax;

/// Moves that are done together, side by side in a vector: what they touch is in the first cache, and memory is asked for so often
/// in a row that a processor looks up several pages at once. With 32 a step took 1.07 times as long.
pub(super) const TOGETHER: usize = 16;

/// No key: they are less.
const NONE: u32 = u32::MAX;

/// Boxes that move in their cells, each a short way and each once.
#[derive(Clone, Debug)]
pub(super) struct Movers {
    keys: [u32; TOGETHER],
    /// Where each comes from, and where it goes.
    boxes: [[MinMax; 2]; TOGETHER],
    count: usize,
    /// A bit for each key, which others share: most keys have none, and nothing has to be read that was only just written.
    seen: u64,
}

/// A grid that can do moves together.
pub(super) trait Follows: Dynamic {
    /// How many levels of cells it looks into.
    fn levels(&self) -> usize;

    /// Where a box that is in cells and stays there looks, in each level; whether that is all, and the way is short.
    fn trace(&self, mover: usize, way: &[MinMax; 2], looks: &mut [Looks]) -> bool;

    /// Moves the boxes, and notes what that changes.
    fn follow(&mut self, movers: &Movers, looks: &mut [Looks], changes: &mut Changes);
}

impl Movers {
    fn new() -> Self {
        let nowhere = MinMax::from_ordered([0.0; 3], [0.0; 3]);
        Self { keys: [NONE; TOGETHER], boxes: [[nowhere; 2]; TOGETHER], count: 0, seen: 0 }
    }

    #[inline]
    pub(super) fn of(&self, mover: usize) -> (u32, &[MinMax; 2]) {
        (self.keys[mover], &self.boxes[mover])
    }

    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = (u32, &[MinMax; 2])> {
        (0..self.count).map(|mover| self.of(mover))
    }

    #[inline(always)]
    fn holds(&self, key: u32) -> bool {
        self.seen >> (key % 64) & 1 == 1 && self.keys.contains(&key)
    }

    /// Where the box of a key is when it is a mover's turn: those before it have moved.
    #[inline]
    pub(super) fn at_turn<'b>(&'b self, items: &'b Items, mover: usize, key: u32) -> Option<&'b MinMax> {
        if !self.holds(key) {
            return items.get(key);
        }
        let own = self.keys.iter().position(|&own| own == key)?;
        Some(&self.boxes[own][usize::from(own < mover)])
    }
}

/// Applies moves. The result is the same as if they were applied one after the other.
pub(super) fn step(grid: &mut impl Follows, moves: &[Move], changes: &mut Changes) {
    changes.clear();
    let mut movers = Movers::new();
    let mut looks: Vec<Looks> = Vec::new();
    for (at, step) in moves.iter().enumerate() {
        if at % TOGETHER == 0 {
            // Those of the next moves, too, which come while what these need is waited for.
            let first = if at == 0 { 0 } else { at + TOGETHER };
            for step in moves.iter().take(at + 2 * TOGETHER).skip(first) {
                grid.items().prefetch(step.key);
            }
        }
        if movers.holds(step.key) {
            follow(grid, &mut movers, &mut looks, changes);
        }
        if let (Some(from), Some(to)) = (grid.items().get(step.key), &step.to) {
            if looks.len() != grid.levels() {
                looks.resize_with(grid.levels(), Looks::default);
            }
            let mover = movers.count;
            movers.boxes[mover][0] = *from;
            movers.boxes[mover][1] = *to;
            if grid.trace(mover, &movers.boxes[mover], &mut looks) {
                movers.keys[mover] = step.key;
                movers.seen |= 1 << (step.key % 64);
                movers.count += 1;
                if movers.count == TOGETHER {
                    follow(grid, &mut movers, &mut looks, changes);
                }
                continue;
            }
        }
        follow(grid, &mut movers, &mut looks, changes);
        record(grid, step, changes);
        match step.to {
            Some(bounds) => grid.insert(step.key, bounds),
            None => grid.remove(step.key),
        };
    }
    follow(grid, &mut movers, &mut looks, changes);
    changes.settle();
}

fn follow(grid: &mut impl Follows, movers: &mut Movers, looks: &mut [Looks], changes: &mut Changes) {
    if movers.count > 0 {
        grid.follow(movers, looks, changes);
        movers.keys = [NONE; TOGETHER];
        movers.count = 0;
        movers.seen = 0;
    }
}
