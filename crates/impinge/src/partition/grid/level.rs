//! Cells of one size, in an array or hashed, and which boxes reach into them.

use std::ops::ControlFlow;

use super::super::{Items, Visitor, Work};
use super::frame::Frame;
use super::layout::{FEWEST, Layout};
use super::lines::Lines;
use super::quantized_box::QuantizedBox;
use crate::volume::{BoundingVolume, MinMax};

/// Lines for each copy that they hold at least, where cells are hashed, and at most.
const ROOM: [f64; 2] = [0.3, 2.4];

/// Equal cells, each with a copy of each box that reaches into it.
///
/// A copy says where its box begins and ends in steps as seen from its cell, and boxes themselves are looked at where steps
/// decide nothing. Cells that share a place in memory are told apart by their keys, and the copies of one box have different cell keys. So a
/// copy of another cell with the same key is a copy of a box that is not in this cell.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub(super) frame: Frame,
    pub(super) layout: Layout,
    pub(super) lines: Lines,
    /// The cells of a block, along each axis, where there is one; what is outside belongs to those at its border.
    block: Option<[usize; 3]>,
    /// Copies that there may be at least and at most before the cells are laid out anew.
    fits: [f64; 2],
}

impl Level {
    /// A block of cells, `counts` of them along each axis, from `origin`.
    pub(super) fn dense(origin: [f64; 3], cell: f64, counts: [usize; 3]) -> Self {
        Self::empty(Frame::dense(origin, cell, counts), Some(counts))
    }

    /// Cells without an end.
    pub(super) fn hashed(cell: f64) -> Self {
        Self::empty(Frame::endless(cell), None)
    }

    fn empty(frame: Frame, block: Option<[usize; 3]>) -> Self {
        let (layout, fits) = layout_for(block, 0.0);
        Self { frame, layout, lines: Lines::new(layout.len()), block, fits }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lines.copies() == 0
    }

    /// Reports whether a box reaches into at most `most` cells, all with different keys.
    pub(super) fn takes(&self, bounds: &MinMax, most: f64) -> bool {
        self.frame.reach(bounds).block().is_small(most)
    }

    fn put(&mut self, key: u32, bounds: &MinMax) {
        let reach = self.frame.reach(bounds);
        let mut lines = self.lines.open();
        let _ = reach.block().each(|cell| {
            lines.put(self.layout.of(cell), key, reach.quantized(cell));
            ControlFlow::Continue(())
        });
    }

    pub(super) fn insert(&mut self, items: &Items, key: u32, bounds: &MinMax) {
        self.put(key, bounds);
        self.resize(items);
    }

    fn take(&mut self, key: u32, bounds: &MinMax) {
        let reach = self.frame.reach(bounds);
        let mut lines = self.lines.open();
        let _ = reach.block().each(|cell| {
            lines.take(self.layout.of(cell), key, reach.quantized(cell));
            ControlFlow::Continue(())
        });
    }

    pub(super) fn remove(&mut self, items: &Items, key: u32, bounds: &MinMax) {
        self.take(key, bounds);
        self.resize(items);
    }

    /// Moves a box that is here; one that stays in its cells is only written anew.
    pub(super) fn relocate(&mut self, items: &Items, key: u32, from: &MinMax, to: &MinMax) {
        let (before, after) = (self.frame.reach(from), self.frame.reach(to));
        if before.block() != after.block() {
            self.remove(items, key, from);
            self.insert(items, key, to);
            return;
        }
        let mut lines = self.lines.open();
        let _ = after.block().each(|cell| {
            lines.write(self.layout.of(cell), key, after.quantized(cell));
            ControlFlow::Continue(())
        });
    }

    /// Keeps the number of lines in proportion to what they hold.
    #[inline]
    pub(super) fn resize(&mut self, items: &Items) {
        let copies = self.lines.copies() as f64;
        if !(self.fits[0] <= copies && copies <= self.fits[1]) {
            self.rebuild(items);
        }
    }

    fn rebuild(&mut self, items: &Items) {
        let mut keys = Vec::new();
        let _ = self.each_once(&mut |key| {
            keys.push(key);
            ControlFlow::Continue(())
        });
        (self.layout, self.fits) = layout_for(self.block, self.lines.copies() as f64);
        self.lines = Lines::new(self.layout.len());
        for key in keys {
            items.get(key).into_iter().for_each(|bounds| self.put(key, bounds));
        }
    }

    /// Visits each box here once: in its first cell.
    fn each_once(&self, visit: &mut impl FnMut(u32) -> ControlFlow<()>) -> ControlFlow<()> {
        for place in 0..self.lines.len() {
            for line in self.lines.of(place) {
                for (&quantized, &key) in line.boxes.iter().zip(&line.keys) {
                    if !quantized.is_none() && !(0..3).any(|axis| quantized.begins_before(axis)) {
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
            let like = reach.quantized(cell);
            let probe = like.probe();
            for line in self.lines.of(self.layout.of(cell)) {
                for (&quantized, &key) in line.boxes.iter().zip(&line.keys) {
                    work.boxes += u64::from(!quantized.is_none());
                    if quantized.has_cell_key_of(like)
                        && probe.may_meet(quantized)
                        && (0..3).all(|axis| cell[axis] == block.low[axis] || !quantized.begins_before(axis))
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
        let mut here: Vec<(u32, QuantizedBox)> = Vec::new();
        for place in 0..self.lines.len() {
            here.clear();
            here.extend(self.lines.of(place).flat_map(|line| line.keys.into_iter().zip(line.boxes)));
            here.retain(|(_, quantized)| !quantized.is_none());
            for (at, &(key, quantized)) in here.iter().enumerate() {
                let probe = quantized.probe();
                for &(other, like) in &here[at + 1..] {
                    // One of them begins in the cell along each axis.
                    if like.has_cell_key_of(quantized)
                        && probe.may_meet(like)
                        && !(0..3).any(|axis| quantized.begins_before(axis) && like.begins_before(axis))
                        && key != other
                        && let (Some(one), Some(two)) = (items.get(key), items.get(other))
                        && one.overlaps(two)
                    {
                        let (min, others) = (one.min(), two.min());
                        let cell = [0, 1, 2].map(|axis| self.frame.cell_along(min[axis].max(others[axis]), axis));
                        let [one, two] = [one, two].map(|bounds| self.frame.reach(bounds).quantized(cell));
                        if self.layout.of(cell) == place && one == quantized && two == like {
                            meet(key, other);
                        }
                    }
                }
            }
        }
    }
}

/// Places for so many copies: one for each cell of a block, where these are not too many for what they hold, else shared ones;
/// and how many copies there may be at least and at most for that to stand.
fn layout_for(block: Option<[usize; 3]>, copies: f64) -> (Layout, [f64; 2]) {
    let [fewest, most] = ROOM;
    let cells = block.map_or(f64::INFINITY, |counts| counts.iter().map(|&count| count as f64).product());
    if let Some(counts) = block
        && cells <= (most * copies).max(FEWEST as f64)
    {
        // Half of what they are taken up for, so that they are not laid out anew time and again.
        let least = if cells <= FEWEST as f64 { 0.0 } else { 0.5 * cells / most };
        return (Layout::block(counts), [least, f64::INFINITY]);
    }
    let places = (((fewest * most).sqrt() * copies) as usize).next_power_of_two().max(FEWEST);
    let least = if places == FEWEST { 0.0 } else { places as f64 / most };
    (Layout::hashed(places), [least, (places as f64 / fewest).min(cells / most)])
}
