//! Cells of one size, in an array or hashed, and the boxes that reach into them.

use std::ops::ControlFlow;

use super::super::{Items, Visitor, Work};
use super::frame::Frame;
use super::layout::{Layout, MIN_PLACES};
use super::lines::Lines;
use super::quantized_box::QuantizedBox;
use crate::volume::{BoundingVolume, MinMax};

/// Minimum and maximum number of places per copy, if cells are hashed. Fewer places make more cells
/// share one; more places use more memory. Beyond these limits the cells are laid out again.
const PLACES_PER_COPY: [f64; 2] = [0.3, 2.4];

/// Equal cells, each with a copy of each box that reaches into it.
///
/// A copy stores the beginning and the end of its box, in steps relative to its cell. The boxes
/// themselves are compared only if the steps do not decide. Cells that share a place in memory are
/// distinguished by their keys. All cells that a box reaches into have different keys, so a copy
/// from another cell with the same key belongs to a box that is not in this cell.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub(super) frame: Frame,
    pub(super) layout: Layout,
    pub(super) lines: Lines,
    /// Number of cells along each axis, if the level is a block. Space outside the block belongs to
    /// the cells at its border.
    block: Option<[usize; 3]>,
    /// Minimum and maximum number of copies for which the current layout is kept.
    fits: [f64; 2],
}

impl Level {
    /// Returns an empty block of cells, `counts` of them along each axis, from `origin`.
    pub(super) fn dense(origin: [f64; 3], cell: f64, counts: [usize; 3]) -> Self {
        Self::empty(Frame::dense(origin, cell, counts), Some(counts))
    }

    /// Returns empty cells in all of space.
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

    /// Moves a box that is in this level. If it stays in its cells, only its copies are
    /// overwritten.
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

    /// Keeps the number of places in proportion to the number of copies.
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

    /// Visits each box of the level once: in its first cell.
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

    /// Visits each box that overlaps `bounds` once: in the cell of the minimum corner of the
    /// intersection.
    pub(super) fn overlapping(
        &self,
        items: &Items,
        bounds: &MinMax,
        work: &mut Work,
        visit: &mut Visitor<'_>,
    ) -> ControlFlow<()> {
        let overlapping = |key: u32| items.get(key).filter(|other| other.overlaps(bounds));
        let reach = self.frame.reach(bounds);
        let block = reach.block();
        if block.count() > self.lines.len() as f64 {
            work.nodes += self.lines.len() as u64;
            return self.each_once(&mut |key| {
                work.boxes += 1;
                if overlapping(key).is_some() { visit(key) } else { ControlFlow::Continue(()) }
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
                        && probe.may_overlap(quantized)
                        && (0..3).all(|axis| cell[axis] == block.low[axis] || !quantized.begins_before(axis))
                        && let Some(other) = overlapping(key)
                        && self.frame.is_first(cell, &block, other)
                    {
                        visit(key)?;
                    }
                }
            }
            ControlFlow::Continue(())
        })
    }

    /// Calls `report` once for each pair of boxes of this level that overlap, in the cell of the
    /// minimum corner of their intersection.
    pub(super) fn for_each_pair(
        &self,
        items: &Items,
        mut report: impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut here: Vec<(u32, QuantizedBox)> = Vec::new();
        for place in 0..self.lines.len() {
            here.clear();
            here.extend(self.lines.of(place).flat_map(|line| line.keys.into_iter().zip(line.boxes)));
            here.retain(|(_, quantized)| !quantized.is_none());
            for (at, &(key, quantized)) in here.iter().enumerate() {
                let probe = quantized.probe();
                for &(other, like) in &here[at + 1..] {
                    // At least one of the boxes begins in the cell along each axis.
                    if like.has_cell_key_of(quantized)
                        && probe.may_overlap(like)
                        && !(0..3).any(|axis| quantized.begins_before(axis) && like.begins_before(axis))
                        && key != other
                        && let (Some(one), Some(two)) = (items.get(key), items.get(other))
                        && one.overlaps(two)
                    {
                        let (min, others) = (one.min(), two.min());
                        let cell = [0, 1, 2].map(|axis| self.frame.cell_along(min[axis].max(others[axis]), axis));
                        let [one, two] = [one, two].map(|bounds| self.frame.reach(bounds).quantized(cell));
                        if self.layout.of(cell) == place && one == quantized && two == like {
                            report(key, other)?;
                        }
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// Returns a layout for this number of copies, and the minimum and maximum number of copies for
/// which it is kept. The layout has one place for each cell of a block if the block does not have
/// too many cells for the copies. Otherwise cells share places.
fn layout_for(block: Option<[usize; 3]>, copies: f64) -> (Layout, [f64; 2]) {
    let [fewest, most] = PLACES_PER_COPY;
    let cells = block.map_or(f64::INFINITY, |counts| counts.iter().map(|&count| count as f64).product());
    if let Some(counts) = block
        && cells <= (most * copies).max(MIN_PLACES as f64)
    {
        // Half the number that led to this layout, so that small changes do not switch back and
        // forth.
        let least = if cells <= MIN_PLACES as f64 { 0.0 } else { 0.5 * cells / most };
        return (Layout::block(counts), [least, f64::INFINITY]);
    }
    let places = (((fewest * most).sqrt() * copies) as usize).next_power_of_two().max(MIN_PLACES);
    let least = if places == MIN_PLACES { 0.0 } else { places as f64 / most };
    (Layout::hashed(places), [least, (places as f64 / fewest).min(cells / most)])
}
