//! What boxes that move look at in the cells of one level.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x4};

use super::super::{Changes, Items};
use super::frame::{Block, Cell, Reach, seen_step};
use super::layout::Along;
use super::level::Level;
use super::lines::HELD;
use super::together::{Movers, TOGETHER};
use super::word::Seen;
use crate::simd::{by_axis, prefetch};
use crate::volume::MinMax;

/// Cells about a short way in all, and four along each axis: more are looked through more often than they are worth.
pub(super) const SHORT: usize = 27;

/// What boxes that move together look at in a level: cells, in the order in which they move. Kept, as it is written anew for each few moves.
#[derive(Clone, Debug)]
pub(super) struct Looks {
    /// As many as `count`, and others that mean nothing.
    looks: Vec<Look>,
    count: usize,
    ways: [Way; TOGETHER],
    open: Vec<Open>,
}

/// A cell that a box looks at as it moves.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    seen: Seen,
    place: u32,
    mover: u8,
    /// Which of the cells about the way it is.
    number: u8,
}

/// How a box moves among the cells.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    before: Block,
    after: Block,
    /// The first cell about it, and how many there are along two axes.
    low: Cell,
    counts: [u8; 2],
    /// Whether it has copies in this level, and whether these are in other cells afterwards.
    is_here: bool,
    stays: bool,
}

/// A box that steps do not tell from one that begins or ceases to meet what moved.
#[derive(Clone, Copy, Debug)]
struct Open {
    key: u32,
    mover: u8,
    number: u8,
}

impl Default for Looks {
    fn default() -> Self {
        Self {
            looks: vec![Look::default(); TOGETHER * SHORT],
            count: 0,
            ways: [Way::default(); TOGETHER],
            open: Vec::new(),
        }
    }
}

impl Looks {
    /// Forgets the cells of the last mover, if they are known.
    pub(super) fn forget(&mut self, mover: usize) {
        while self.count > 0 && usize::from(self.looks[self.count - 1].mover) == mover {
            self.count -= 1;
        }
    }

    /// Finds the cells about a way and asks for their memory, unless they are too many. Copies of the box are in this level, or
    /// it only looks here.
    #[inline(always)]
    pub(super) fn trace(&mut self, level: &Level, mover: usize, [from, to]: &[MinMax; 2], is_here: bool) -> bool {
        let reaches = [level.frame.reach(from), level.frame.reach(to)];
        let [before, after] = [reaches[0].block(), reaches[1].block()];
        let block = before.merged(&after);
        let counts = [0, 1, 2].map(|axis| block.high[axis] - block.low[axis] + 1);
        let most = counts[0].max(counts[1]).max(counts[2]);
        let in_rows = [counts[0] as u8, counts[1] as u8];
        self.ways[mover] = Way { before, after, low: block.low, counts: in_rows, is_here, stays: before == after };
        if most <= 2 {
            self.spread::<8>(level, mover, &reaches, counts);
        } else if most <= 4 && counts.iter().product::<i64>() <= SHORT as i64 {
            self.spread::<16>(level, mover, &reaches, counts);
        } else {
            return false;
        }
        true
    }

    /// Notes the cells, a quarter of the lanes along each axis at most.
    #[inline(always)]
    fn spread<const LANES: usize>(&mut self, level: &Level, mover: usize, reaches: &[Reach; 2], counts: [i64; 3]) {
        let low = self.ways[mover].low;
        let wide = LANES / 4;
        // Plain loops over lanes, one axis after the other, which become vectors; some lanes mean nothing.
        let ends = [&reaches[0].low, &reaches[0].high, &reaches[1].low, &reaches[1].high];
        let mut steps = [[0; LANES]; 4];
        for (steps, places) in steps.iter_mut().zip(ends) {
            let parts = by_axis!(axis => places[axis].parts_from(low[axis]) as i32);
            for (lane, step) in steps.iter_mut().enumerate() {
                *step = parts[(lane / wide).min(2)];
            }
            for (lane, step) in steps.iter_mut().enumerate() {
                *step = seen_step(*step, lane % wide);
            }
        }
        let mut slices = [Seen::default(); LANES];
        let mut places = [Along::default(); LANES];
        for (axis, first) in low.into_iter().enumerate() {
            for nth in 0..wide {
                let (lane, cell) = (axis * wide + nth, first + nth as i64);
                let (from, to) = ([steps[0][lane], steps[1][lane]], [steps[2][lane], steps[3][lane]]);
                slices[lane] = Seen::along(axis, from, to, cell, nth);
                places[lane] = level.layout.along(axis, cell);
            }
        }
        // One loop for all cells: where it ends is hard enough to foresee.
        let [mut x, mut y, mut z] = [0, wide, 2 * wide];
        let end = counts.map(|count| count as usize);
        let number = end[0] * end[1] * end[2];
        for (at, look) in self.looks[self.count..][..number].iter_mut().enumerate() {
            // What they never exceed.
            let lanes = [x % LANES, y % LANES, z % LANES];
            let place = level.layout.place([places[lanes[0]], places[lanes[1]], places[lanes[2]]]);
            let seen = Seen::all(&slices[lanes[0]], &slices[lanes[1]], &slices[lanes[2]]);
            *look = Look { seen, place: place as u32, mover: mover as u8, number: at as u8 };
            x += 1;
            let is_row = x == end[0];
            x = if is_row { 0 } else { x };
            y += usize::from(is_row);
            let is_layer = y == wide + end[1];
            y = if is_layer { wide } else { y };
            z += usize::from(is_layer);
        }
        self.count += number;
    }

    /// Moves the boxes in a level, and notes which pairs with boxes there begin and end.
    #[inline(always)]
    pub(super) fn follow<S: Simd>(
        &mut self,
        simd: S,
        level: &mut Level,
        items: &Items,
        movers: &Movers,
        changes: &mut Changes,
    ) {
        let looks = &self.looks[..self.count];
        // Close together, so that a processor looks for many pages at once.
        for look in looks {
            prefetch(level.lines.first(look.place as usize));
        }
        for look in looks {
            if let Some(more) = level.lines.after(level.lines.first(look.place as usize)) {
                prefetch(more);
            }
        }
        self.open.clear();
        for look in looks {
            let way = &self.ways[usize::from(look.mover)];
            let key = movers.of(usize::from(look.mover)).0;
            let mut line = level.lines.first_mut(look.place as usize);
            loop {
                let (open, here) = look.seen.compare(simd, &line.words);
                let own = here & places_of(simd, key, &line.keys);
                let mut undecided = open & !own;
                if own != 0 && way.stays {
                    line.words[own.trailing_zeros() as usize] = look.seen.after();
                }
                while undecided != 0 {
                    let key = line.keys[undecided.trailing_zeros() as usize];
                    undecided &= undecided - 1;
                    self.open.push(Open { key, mover: look.mover, number: look.number });
                }
                let next = line.next;
                match level.lines.more_mut(next) {
                    Some(more) => line = more,
                    None => break,
                }
            }
            if way.is_here && !way.stays {
                let cell = way.cell(look.number);
                let (place, after) = (look.place as usize, look.seen.after());
                match (way.before.holds(cell), way.after.holds(cell)) {
                    (true, true) => level.lines.write(place, key, after),
                    (true, false) => level.lines.take(place, key, after),
                    (false, true) => level.lines.put(place, key, after),
                    (false, false) => {}
                }
            }
        }
        self.count = 0;
        for open in &self.open {
            items.prefetch(open.key);
        }
        for open in &self.open {
            let (mover, way) = (usize::from(open.mover), &self.ways[usize::from(open.mover)]);
            let (key, [from, to]) = movers.of(mover);
            let Some(bounds) = movers.at_turn(items, mover, open.key) else { continue };
            let (met, meets) = (overlap(from, bounds), overlap(to, bounds));
            let block = Block { low: way.low, high: way.low };
            if met != meets && level.frame.is_first(way.cell(open.number), &block, bounds) {
                changes.note(key, open.key, meets);
            }
        }
    }
}

/// The places of copies of a key in a line, bits; there may be some where copies were.
#[inline(always)]
fn places_of<S: Simd>(simd: S, key: u32, keys: &[u32; HELD]) -> u32 {
    let [first @ .., last] = keys;
    let are_first = u32x4::from_slice(simd, first).simd_eq(u32x4::splat(simd, key)).to_bitmask() as u32;
    are_first | u32::from(*last == key) << (HELD - 1)
}

impl Way {
    fn cell(&self, number: u8) -> Cell {
        let (row, x) = (number / self.counts[0], number % self.counts[0]);
        let along = [x, row % self.counts[1], row / self.counts[1]];
        [0, 1, 2].map(|axis| self.low[axis] + i64::from(along[axis]))
    }
}

/// As [`BoundingVolume::overlaps`](crate::volume::BoundingVolume::overlaps), without a branch: it is as often true as not.
#[inline]
fn overlap(one: &MinMax, other: &MinMax) -> bool {
    let (min, max, other_min, other_max) = (one.min(), one.max(), other.min(), other.max());
    (0..3).fold(true, |meet, axis| meet & (min[axis] <= other_max[axis]) & (other_min[axis] <= max[axis]))
}
