//! What boxes that move look at in the cells of one level.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x4};

use super::super::{Changes, Items};
use super::frame::{Block, Frame, PARTS};
use super::layout::Along;
use super::level::Level;
use super::lines::HELD;
use super::together::{Movers, TOGETHER};
use super::word::Seen;
use crate::simd::{best_level, by_axis, dispatch, prefetch};
use crate::volume::MinMax;

/// Cells about a short way in all, and four along each axis: more are looked through more often than they are worth.
pub(super) const SHORT: usize = 27;

/// Cells along each axis that a short way is seen from at most.
const WIDEST: usize = 4;

/// What boxes that move together look at in a level: cells, in the order in which they move. Kept, as it is written anew for each
/// few moves.
#[derive(Clone, Debug)]
pub(super) struct Looks {
    /// As many as `count`, and others that mean nothing.
    looks: Vec<Look>,
    count: usize,
    ways: Ways,
    open: Vec<Open>,
}

/// A cell that a box looks at as it moves.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    seen: Seen,
    place: u32,
    mover: u8,
    /// Which of the cells about the way it is: along each axis how far from the first, in two bits.
    number: u8,
}

/// How boxes move among the cells, side by side.
#[derive(Clone, Debug, Default)]
struct Ways {
    /// Along each axis the first cell about a way.
    low: [[i64; TOGETHER]; 3],
    /// Where the box begins and ends before and after, in parts of a cell behind the beginning of the first.
    parts: [[[i16; TOGETHER]; 4]; 3],
    /// Which cells there are about it, a bit for each by its number, and whether they are more than two along an axis.
    cells: [u64; TOGETHER],
    is_wide: [bool; TOGETHER],
    /// Whether the box has copies in this level, and whether these are in other cells afterwards.
    is_here: [bool; TOGETHER],
    stays: [bool; TOGETHER],
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
        // One more than there may be, as the next is written before it is known whether it is kept.
        Self { looks: vec![Look::default(); TOGETHER * SHORT + 1], count: 0, ways: Ways::default(), open: Vec::new() }
    }
}

impl Looks {
    /// Notes a way among the cells of a level, unless the cells about it are too many. Copies of the box are in this level, or it
    /// only looks here.
    #[inline(always)]
    pub(super) fn trace(&mut self, level: &Level, mover: usize, [from, to]: &[MinMax; 2], is_here: bool) -> bool {
        let [before, after] = [level.frame.reach(from), level.frame.reach(to)];
        let low = by_axis!(axis => before.low[axis].min(after.low[axis]).cell());
        let counts = by_axis!(axis => before.high[axis].max(after.high[axis]).cell() - low[axis] + 1);
        let most = counts[0].max(counts[1]).max(counts[2]);
        if most > WIDEST as i64 || counts[0] * counts[1] * counts[2] > SHORT as i64 {
            return false;
        }
        let ways = &mut self.ways;
        let mut changed = 0;
        for axis in 0..3 {
            let ends = [before.low[axis], before.high[axis], after.low[axis], after.high[axis]];
            ways.low[axis][mover] = low[axis];
            let mut parts = [0; 4];
            for end in 0..4 {
                parts[end] = ends[end].parts_from(low[axis]) as i16;
                ways.parts[axis][end][mover] = parts[end];
            }
            changed |= (parts[0] ^ parts[2]) | (parts[1] ^ parts[3]);
        }
        ways.cells[mover] = cells_of(counts);
        ways.is_wide[mover] = most > 2;
        (ways.is_here[mover], ways.stays[mover]) = (is_here, changed >> PARTS == 0);
        true
    }

    /// Finds the cells about the ways.
    #[inline(always)]
    fn spread<const WIDE: usize, S: Simd>(&mut self, simd: S, level: &Level, movers: usize) {
        let ways = &self.ways;
        let mut slices = [[[Seen::default(); TOGETHER]; WIDE]; 3];
        for axis in 0..3 {
            for nth in 0..WIDE {
                slices[axis][nth] = Seen::along(simd, axis, &ways.parts[axis], &ways.low[axis], nth);
            }
        }
        let mut count = 0;
        let looks = &mut self.looks[..];
        for mover in 0..movers {
            let mut along = [[Along::default(); WIDE]; 3];
            for axis in 0..3 {
                for nth in 0..WIDE {
                    along[axis][nth] = level.layout.along(axis, ways.low[axis][mover] + nth as i64);
                }
            }
            // Written in any case and kept where there is such a cell: how many there are is hard to foresee.
            for z in 0..WIDE {
                for y in 0..WIDE {
                    let row = slices[1][y][mover].lanes(simd) | slices[2][z][mover].lanes(simd);
                    for x in 0..WIDE {
                        let place = level.layout.place([along[0][x], along[1][y], along[2][z]]) as u32;
                        let number = x | y << 2 | z << 4;
                        let look = &mut looks[count];
                        look.seen = Seen::all(simd, slices[0][x][mover].lanes(simd) | row);
                        (look.place, look.mover, look.number) = (place, mover as u8, number as u8);
                        count += (ways.cells[mover] >> number & 1) as usize;
                    }
                }
            }
        }
        self.count = count;
    }

    /// Moves the boxes of one level of cells and records which overlaps with other boxes of that
    /// level begin and end.
    ///
    /// This is the only function of the grids that is compiled for each vector unit. Both kinds of
    /// grid share it.
    pub(super) fn follow(&mut self, level: &mut Level, items: &Items, movers: &Movers, changes: &mut Changes) {
        dispatch!(best_level(), simd => self.follow_lanes(simd, level, items, movers, changes));
    }

    #[inline(always)]
    fn follow_lanes<S: Simd>(
        &mut self,
        simd: S,
        level: &mut Level,
        items: &Items,
        movers: &Movers,
        changes: &mut Changes,
    ) {
        let number = movers.iter().len();
        if self.ways.is_wide[..number].contains(&true) {
            self.spread::<WIDEST, S>(simd, level, number);
        } else {
            self.spread::<2, S>(simd, level, number);
        }
        let looks = &self.looks[..self.count];
        // Close together, so that a processor looks for many pages at once.
        let first = level.lines.first();
        for look in looks {
            prefetch(&first[look.place as usize]);
        }
        for look in looks {
            if let Some(more) = level.lines.after(&first[look.place as usize]) {
                prefetch(more);
            }
        }
        self.open.clear();
        let mut lines = level.lines.open();
        for look in looks {
            let mover = usize::from(look.mover);
            let (stays, key) = (self.ways.stays[mover], movers.of(mover).0);
            let mut line = lines.first(look.place as usize);
            loop {
                let mut own = places_of(simd, key, &line.keys);
                let mut undecided = look.seen.compare(simd, &line.words) & !own;
                while stays && own != 0 {
                    let word = &mut line.words[own.trailing_zeros() as usize];
                    own &= own - 1;
                    if word.is_marked_as(look.seen.after()) {
                        *word = look.seen.after();
                    }
                }
                while undecided != 0 {
                    let key = line.keys[undecided.trailing_zeros() as usize];
                    undecided &= undecided - 1;
                    self.open.push(Open { key, mover: look.mover, number: look.number });
                }
                let next = line.next;
                match lines.more(next) {
                    Some(more) => line = more,
                    None => break,
                }
            }
            if self.ways.is_here[mover] && !stays {
                let (place, after) = (look.place as usize, look.seen.after());
                match self.ways.holds(mover, look.number) {
                    [true, true] => lines.write(place, key, after),
                    [true, false] => lines.take(place, key, after),
                    [false, true] => lines.put(place, key, after),
                    [false, false] => {}
                }
            }
        }
        for open in &self.open {
            items.prefetch(open.key);
        }
        for open in &self.open {
            let mover = usize::from(open.mover);
            let (key, [from, to]) = movers.of(mover);
            let Some(bounds) = movers.at_turn(items, mover, open.key) else { continue };
            let (met, meets) = (overlap(from, bounds), overlap(to, bounds));
            if met != meets && self.ways.is_first(mover, open.number, &level.frame, bounds) {
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

impl Ways {
    /// Whether a box has a copy in a cell before and after.
    #[inline(always)]
    fn holds(&self, mover: usize, number: u8) -> [bool; 2] {
        let cell = from_first(number);
        let mut holds = [true; 2];
        for axis in 0..3 {
            let at = i16::from(cell[axis]);
            for (time, holds) in holds.iter_mut().enumerate() {
                let [first, last] = [2 * time, 2 * time + 1].map(|end| self.parts[axis][end][mover] >> PARTS);
                *holds &= (first <= at) & (at <= last);
            }
        }
        holds
    }

    /// Whether a cell is the one of the least corner of what a box shares with the cells about a way.
    fn is_first(&self, mover: usize, number: u8, frame: &Frame, bounds: &MinMax) -> bool {
        let (low, cell) = ([0, 1, 2].map(|axis| self.low[axis][mover]), from_first(number));
        frame.is_first([0, 1, 2].map(|axis| low[axis] + i64::from(cell[axis])), &Block { low, high: low }, bounds)
    }
}

/// Bits of as many cells along each axis, of four at most.
#[inline(always)]
fn cells_of(counts: [i64; 3]) -> u64 {
    let [x, y, z] = by_axis!(axis => u64::MAX >> (64 - (counts[axis] << (2 * axis))));
    // Those of all rows along x, and so on.
    (x * 0x1111_1111_1111_1111) & (y * 0x0001_0001_0001_0001) & z
}

/// A cell about a way by its number, counted along each axis from the first.
fn from_first(number: u8) -> [u8; 3] {
    [number & 3, number >> 2 & 3, number >> 4]
}

/// As [`BoundingVolume::overlaps`](crate::volume::BoundingVolume::overlaps), without a branch: it is as often true as not.
#[inline]
fn overlap(one: &MinMax, other: &MinMax) -> bool {
    let (min, max, other_min, other_max) = (one.min(), one.max(), other.min(), other.max());
    (0..3).fold(true, |meet, axis| meet & (min[axis] <= other_max[axis]) & (other_min[axis] <= max[axis]))
}
