//! Cells of one size, in an array or hashed, and which boxes reach into them.

use std::ops::ControlFlow;

use super::super::{Items, Visitor, Work};
use super::frame::{Block, Cell, Frame};
use super::lines::{HELD, Lines};
use super::word::Word;
use crate::simd::prefetch;
use crate::volume::{BoundingVolume, MinMax};

/// Hashed lines for each copy that they hold at least, and at most.
const ROOM: [f64; 2] = [0.3, 2.4];

/// Hashed cells that are neighbours in memory are so many along each axis, as a power of two: a page of memory. A box that
/// moves touches one or two of them.
const NEAR: u32 = 2;

/// Hashed cells at least.
const FEWEST: usize = 1 << (3 * NEAR);

/// Cells about a way that is short, along each axis and in all: more are looked through more often than they are worth.
const WIDE: usize = 4;
pub(super) const SHORT: usize = 27;

/// Cells about a way of which it is kept where they are.
const KEPT: usize = 8;

/// Where cells are in memory.
#[derive(Clone, Debug)]
enum Layout {
    /// One for each cell of a block of so many; what is outside belongs to those at its border.
    Dense { counts: Cell },
    /// Any number of cells share one; as many as a power of two.
    Hashed,
}

/// Equal cells, each with a copy of each box that reaches into it.
///
/// A copy says where its box begins and ends in steps as seen from its cell, and boxes themselves are looked at where steps
/// decide nothing. Cells that share a place in memory have marks, and one box has no two copies of one mark, so that the
/// copy of another cell with the same mark is one of a box that is not in this cell.
#[derive(Clone, Debug)]
pub(super) struct Level {
    frame: Frame,
    layout: Layout,
    lines: Lines,
}

/// How a box moves, a short way. Kept by the caller and written anew in place: it is large beside what it costs to find.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    /// The box where it comes from and where it goes to; none where the way is not short, and the rest means nothing.
    pub(super) boxes: Option<[MinMax; 2]>,
    before: Block,
    after: Block,
    /// The first cell about it, and how many there are along each axis.
    low: Cell,
    counts: [usize; 3],
    slices: [[Slice; WIDE]; 3],
    places: Places,
}

/// What is seen of a way from a cell along one axis.
#[derive(Clone, Copy, Debug, Default)]
struct Slice {
    /// The box where it goes.
    after: Word,
    /// What is about both boxes.
    around: Word,
    /// What both share; where they are apart it ends before it begins.
    shared: Word,
}

/// Where the first cells about a way are in memory, which has room for so many.
#[derive(Clone, Copy, Debug, Default)]
struct Places {
    places: [usize; KEPT],
    count: usize,
    room: usize,
}

/// A box that steps do not tell from one that begins or ceases to meet what moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub(super) key: u32,
    /// From where it is seen.
    cell: Cell,
}

impl Way {
    /// Visits the cells about it: each with its number, its place along each axis and what is seen from it.
    #[inline]
    fn each(&self, mut visit: impl FnMut(usize, Cell, Slice)) {
        let [xs, ys, zs] = &self.slices;
        let mut number = 0;
        for (z, zs) in zs[..self.counts[2]].iter().enumerate() {
            for (y, ys) in ys[..self.counts[1]].iter().enumerate() {
                let upper = ys.with(zs);
                for (x, xs) in xs[..self.counts[0]].iter().enumerate() {
                    let cell = [self.low[0] + x as i64, self.low[1] + y as i64, self.low[2] + z as i64];
                    visit(number, cell, xs.with(&upper));
                    number += 1;
                }
            }
        }
    }
}

impl Slice {
    #[inline]
    fn with(&self, other: &Self) -> Self {
        Self {
            after: self.after.with(other.after),
            around: self.around.with(other.around),
            shared: self.shared.with(other.shared),
        }
    }
}

impl Level {
    /// A block of cells, `counts` of them along each axis, from `origin`.
    pub(super) fn dense(origin: [f64; 3], cell: f64, counts: [usize; 3]) -> Self {
        let lines = Lines::new(counts.iter().product());
        let layout = Layout::Dense { counts: counts.map(|count| count as i64) };
        Self { frame: Frame::dense(origin, cell, counts), layout, lines }
    }

    /// Cells without an end.
    pub(super) fn hashed(cell: f64) -> Self {
        Self { frame: Frame::endless(cell), layout: Layout::Hashed, lines: Lines::new(FEWEST) }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lines.copies() == 0
    }

    /// Whether a box reaches into at most so many cells, and into none that look alike.
    pub(super) fn takes(&self, bounds: &MinMax, most: f64) -> bool {
        self.frame.reach(bounds).block().is_small(most)
    }

    #[inline]
    fn place(&self, cell: Cell) -> usize {
        match &self.layout {
            Layout::Dense { counts } => ((cell[2] * counts[1] + cell[1]) * counts[0] + cell[0]) as usize,
            Layout::Hashed => {
                // Large odd numbers without pattern, one for each axis (Teschner et al., 2003), and the upper bits, which all
                // bits of the cell reach; where a page has few cells in use they differ from page to page.
                let [x, y, z] = cell.map(|along| (along >> NEAR) as u64);
                let mixed = (x.wrapping_mul(0x9e37_79b9_7f4a_7c15)
                    ^ y.wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
                    ^ z.wrapping_mul(0x1656_67b1_9e37_79f9))
                .wrapping_mul(0xff51_afd7_ed55_8ccd);
                let [x, y, z] = cell.map(|along| (along & ((1 << NEAR) - 1)) as u64);
                let within = z << (2 * NEAR) | y << NEAR | x;
                ((mixed >> 26) ^ within) as usize & (self.lines.len() - 1)
            }
        }
    }

    fn put(&mut self, key: u32, bounds: &MinMax) {
        let reach = self.frame.reach(bounds);
        let _ = reach.block().each(|cell| {
            self.lines.put(self.place(cell), key, reach.seen_from(cell));
            ControlFlow::Continue(())
        });
    }

    pub(super) fn insert(&mut self, items: &Items, key: u32, bounds: &MinMax) {
        self.put(key, bounds);
        self.resize(items);
    }

    fn take(&mut self, key: u32, bounds: &MinMax) {
        let reach = self.frame.reach(bounds);
        let _ = reach.block().each(|cell| {
            self.lines.take(self.place(cell), key, reach.seen_from(cell));
            ControlFlow::Continue(())
        });
    }

    pub(super) fn remove(&mut self, items: &Items, key: u32, bounds: &MinMax) {
        self.take(key, bounds);
        self.resize(items);
    }

    /// Finds how a box moves.
    pub(super) fn trace(&self, from: &MinMax, to: &MinMax, way: &mut Way) {
        let reaches = [from, to].map(|bounds| self.frame.reach(bounds));
        let [before, after] = reaches.map(|reach| reach.block());
        let block = before.merged(&after);
        let counts = [0, 1, 2].map(|axis| block.high[axis] - block.low[axis] + 1);
        if counts.iter().any(|&count| count > WIDE as i64) || counts.iter().product::<i64>() > SHORT as i64 {
            way.boxes = None;
            return;
        }
        way.boxes = Some([*from, *to]);
        (way.before, way.after, way.low) = (before, after, block.low);
        way.counts = counts.map(|count| count as usize);
        for (axis, slices) in way.slices.iter_mut().enumerate() {
            for (at, slice) in slices[..way.counts[axis]].iter_mut().enumerate() {
                let cell = block.low[axis] + at as i64;
                let [[begin, end], [next_begin, next_end]] = reaches.map(|reach| reach.along(axis, cell));
                let word = |steps| Word::along(axis, steps, cell);
                *slice = Slice {
                    after: word([next_begin, next_end]),
                    around: word([begin.min(next_begin), end.max(next_end)]),
                    shared: word([begin.max(next_begin), end.min(next_end)]),
                };
            }
        }
        let mut places = Places { room: self.lines.len(), ..Places::default() };
        way.each(|_, cell, _| {
            if let Some(next) = places.places.get_mut(places.count) {
                *next = self.place(cell);
                places.count += 1;
            }
        });
        way.places = places;
    }

    /// Where the cells about a way are, as far as that is known and still true.
    #[inline]
    fn known<'w>(&self, way: &'w Way) -> &'w [usize] {
        let known = if way.places.room == self.lines.len() { way.places.count } else { 0 };
        &way.places.places[..known]
    }

    /// Asks for the memory of the cells about a way.
    #[inline]
    pub(super) fn prefetch(&self, way: &Way) {
        self.known(way).iter().for_each(|&place| prefetch(self.lines.first(place)));
    }

    /// Asks for that of the lines that follow.
    #[inline]
    pub(super) fn prefetch_more(&self, way: &Way) {
        for &place in self.known(way) {
            self.lines.after(self.lines.first(place)).into_iter().for_each(prefetch);
        }
    }

    /// Moves a box that is here, and tells which boxes here may begin to meet it, or cease to.
    pub(super) fn follow(&mut self, items: &Items, way: &Way, key: u32, mut tell: impl FnMut(Open)) {
        let stays = way.before == way.after;
        way.each(|number, cell, slice| {
            let place = self.known(way).get(number).copied().unwrap_or_else(|| self.place(cell));
            let (around, shared) = (slice.around.probe(), slice.shared.probe());
            self.lines.each_of(place, |line| {
                let (mut open, mut own) = (0_u32, 0_u32);
                for at in 0..HELD {
                    let word = line.words[at];
                    let here = word.is_marked_as(slice.after);
                    let undecided = around.with(word).may_meet & !shared.with(word).meet & here;
                    open |= u32::from(undecided) << at;
                    own |= u32::from((line.keys[at] == key) & here) << at;
                }
                if own != 0 && stays {
                    line.words[own.trailing_zeros() as usize] = slice.after;
                }
                open &= !own;
                while open != 0 {
                    let at = open.trailing_zeros() as usize;
                    open &= open - 1;
                    // Once: in the cell of the least corner of what it shares with the way.
                    if !(0..3).any(|axis| cell[axis] != way.low[axis] && line.words[at].begins_before(axis)) {
                        tell(Open { key: line.keys[at], cell });
                    }
                }
            });
            if stays {
                return;
            }
            match (way.before.holds(cell), way.after.holds(cell)) {
                (true, true) => self.lines.write(place, key, slice.after),
                (true, false) => self.lines.take(place, key, slice.after),
                (false, true) => self.lines.put(place, key, slice.after),
                (false, false) => {}
            }
        });
        if !stays {
            self.resize(items);
        }
    }

    /// Whether a box that is open after a way begins to meet what moved, or ceases to; none where it does neither.
    #[inline]
    pub(super) fn settle(&self, open: &Open, way: &Way, bounds: &MinMax) -> Option<bool> {
        let [met, meets] = way.boxes?.map(|one| one.overlaps(bounds));
        let block = Block { low: way.low, high: way.low };
        (met != meets && self.frame.is_first(open.cell, &block, bounds)).then_some(meets)
    }

    /// Moves a box that is here; one that stays in its cells is only written anew.
    pub(super) fn relocate(&mut self, items: &Items, key: u32, from: &MinMax, to: &MinMax) {
        let (before, after) = (self.frame.reach(from), self.frame.reach(to));
        if before.block() != after.block() {
            self.remove(items, key, from);
            self.insert(items, key, to);
            return;
        }
        let _ = after.block().each(|cell| {
            self.lines.write(self.place(cell), key, after.seen_from(cell));
            ControlFlow::Continue(())
        });
    }

    /// Keeps the number of hashed cells in proportion to what they hold.
    #[inline]
    fn resize(&mut self, items: &Items) {
        let (cells, copies) = (self.lines.len(), self.lines.copies() as f64);
        let fits = ROOM[0] * copies <= cells as f64 && (cells as f64 <= ROOM[1] * copies || cells == FEWEST);
        if matches!(self.layout, Layout::Hashed) && !fits {
            self.rebuild(items);
        }
    }

    fn rebuild(&mut self, items: &Items) {
        let mut keys = Vec::new();
        let _ = self.each_once(&mut |key| {
            keys.push(key);
            ControlFlow::Continue(())
        });
        let count = (ROOM[0] * ROOM[1]).sqrt() * self.lines.copies() as f64;
        self.lines = Lines::new((count as usize).next_power_of_two().max(FEWEST));
        for key in keys {
            items.get(key).into_iter().for_each(|bounds| self.put(key, bounds));
        }
    }

    /// Visits each box here once: in its first cell.
    fn each_once(&self, visit: &mut impl FnMut(u32) -> ControlFlow<()>) -> ControlFlow<()> {
        for place in 0..self.lines.len() {
            for line in self.lines.of(place) {
                for (&word, &key) in line.words.iter().zip(&line.keys) {
                    if !word.is_none() && !(0..3).any(|axis| word.begins_before(axis)) {
                        visit(key)?;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Visits each box that meets this one, once: in the cell of the least corner of what they share.
    pub(super) fn overlapping(
        &self,
        items: &Items,
        bounds: &MinMax,
        work: &mut Work,
        visit: &mut Visitor<'_>,
    ) -> ControlFlow<()> {
        let meets = |key: u32| items.get(key).filter(|other| other.overlaps(bounds));
        let reach = self.frame.reach(bounds);
        let block = reach.block();
        if block.count() > self.lines.len() as f64 {
            work.nodes += self.lines.len() as u64;
            return self.each_once(&mut |key| {
                work.boxes += 1;
                if meets(key).is_some() { visit(key) } else { ControlFlow::Continue(()) }
            });
        }
        block.each(|cell| {
            work.nodes += 1;
            let like = reach.seen_from(cell);
            let probe = like.probe();
            for line in self.lines.of(self.place(cell)) {
                for (&word, &key) in line.words.iter().zip(&line.keys) {
                    work.boxes += u64::from(!word.is_none());
                    if word.is_marked_as(like)
                        && probe.with(word).may_meet
                        && (0..3).all(|axis| cell[axis] == block.low[axis] || !word.begins_before(axis))
                        && let Some(other) = meets(key)
                        && self.frame.is_first(cell, &block, other)
                    {
                        visit(key)?;
                    }
                }
            }
            ControlFlow::Continue(())
        })
    }

    /// Calls for each two boxes here that meet, once, in the cell of the least corner of what they share.
    pub(super) fn pairs(&self, items: &Items, mut meet: impl FnMut(u32, u32)) {
        let mut here: Vec<(u32, Word)> = Vec::new();
        for place in 0..self.lines.len() {
            here.clear();
            here.extend(self.lines.of(place).flat_map(|line| line.keys.into_iter().zip(line.words)));
            here.retain(|(_, word)| !word.is_none());
            for (at, &(key, word)) in here.iter().enumerate() {
                let probe = word.probe();
                for &(other, like) in &here[at + 1..] {
                    // One of them begins in the cell along each axis.
                    if like.is_marked_as(word)
                        && probe.with(like).may_meet
                        && !(0..3).any(|axis| word.begins_before(axis) && like.begins_before(axis))
                        && key != other
                        && let (Some(one), Some(two)) = (items.get(key), items.get(other))
                        && one.overlaps(two)
                    {
                        let (min, others) = (one.min(), two.min());
                        let cell = [0, 1, 2].map(|axis| self.frame.cell_along(min[axis].max(others[axis]), axis));
                        let [one, two] = [one, two].map(|bounds| self.frame.reach(bounds).seen_from(cell));
                        if self.place(cell) == place && one == word && two == like {
                            meet(key, other);
                        }
                    }
                }
            }
        }
    }
}
