//! Cells of one size, in an array or hashed.

use std::ops::ControlFlow;

use super::super::{Visitor, Work};
use crate::simd::prefetch;
use crate::volume::{BoundingVolume, MinMax};

/// Cells are counted to here from the origin, and farther ones are the last: whole numbers that a float holds.
const FARTHEST: f64 = (1_u64 << 40) as f64;

/// Hashed cells for each copy that they hold, at least; there are at most eight times as many.
const ROOM: usize = 2;

/// Hashed cells at least.
const FEWEST: usize = 16;

/// Cells about a way that is short: more are looked through more often than they are worth.
const SHORT: f64 = 64.0;

/// Copies of a cell that are asked for ahead: most cells hold fewer. Each takes about a line of memory.
const HELD: usize = 6;

/// Where a few cells are in memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Places {
    /// Those of a box that is at most as large as a cell; the first of more.
    places: [usize; 8],
    count: usize,
}

/// A cell by its place, counted along each axis.
type Cell = [i64; 3];

/// Where cells are in memory.
#[derive(Clone, Debug)]
enum Layout {
    /// One for each cell of a block of so many; what is outside belongs to those at its border.
    Dense { counts: Cell },
    /// Any number of cells share one; as many as a power of two.
    Hashed,
}

/// A copy of a box in a cell.
#[derive(Clone, Copy, Debug)]
struct Copy {
    bounds: MinMax,
    key: u32,
}

/// Equal cells, each with a copy of each box that reaches into it.
#[derive(Clone, Debug)]
pub(super) struct Level {
    origin: [f64; 3],
    /// Of the edge of a cell: a division takes four times as long as a product, which is monotone, too.
    inverse: f64,
    layout: Layout,
    cells: Vec<Vec<Copy>>,
    copies: usize,
    /// Memory of cells that became empty, for those that become full: else each cell that ever held something kept its own.
    spare: Vec<Vec<Copy>>,
    /// Memory to list places in.
    listed: Vec<usize>,
}

/// The cells that a box reaches into: from, and to with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach([Cell; 2]);

impl Reach {
    /// How many there are.
    pub(super) fn count(&self) -> f64 {
        let [low, high] = self.0;
        (0..3).map(|axis| (high[axis] - low[axis] + 1) as f64).product()
    }

    fn each(&self, mut visit: impl FnMut(Cell) -> ControlFlow<()>) -> ControlFlow<()> {
        let [low, high] = self.0;
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    visit([x, y, z])?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

impl Level {
    /// A block of cells, `counts` of them along each axis, from `origin`.
    pub(super) fn dense(origin: [f64; 3], cell: f64, counts: [usize; 3]) -> Self {
        let cells = vec![Vec::new(); counts.iter().product()];
        Self::new(origin, cell, Layout::Dense { counts: counts.map(|count| count as i64) }, cells)
    }

    /// Cells without an end.
    pub(super) fn hashed(cell: f64) -> Self {
        Self::new([0.0; 3], cell, Layout::Hashed, vec![Vec::new(); FEWEST])
    }

    fn new(origin: [f64; 3], cell: f64, layout: Layout, cells: Vec<Vec<Copy>>) -> Self {
        Self {
            origin,
            inverse: (1.0 / cell).min(f64::MAX),
            layout,
            cells,
            copies: 0,
            spare: Vec::new(),
            listed: Vec::new(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.copies == 0
    }

    /// The cell of a coordinate. Every step is monotone, so that what is between two corners is in the cells between theirs.
    #[inline]
    fn along(&self, coordinate: f64, axis: usize) -> i64 {
        let last = match &self.layout {
            Layout::Dense { counts } => [0.0, (counts[axis] - 1) as f64],
            Layout::Hashed => [-FARTHEST, FARTHEST],
        };
        let cut = ((coordinate - self.origin[axis]) * self.inverse).clamp(last[0], last[1]);
        let whole = cut as i64;
        whole - i64::from(whole as f64 > cut)
    }

    pub(super) fn reach(&self, bounds: &MinMax) -> Reach {
        let (min, max) = (bounds.min(), bounds.max());
        Reach([[0, 1, 2].map(|axis| self.along(min[axis], axis)), [0, 1, 2].map(|axis| self.along(max[axis], axis))])
    }

    #[inline]
    fn place(&self, cell: Cell) -> usize {
        match &self.layout {
            Layout::Dense { counts } => ((cell[2] * counts[1] + cell[1]) * counts[0] + cell[0]) as usize,
            Layout::Hashed => {
                // Large odd numbers without pattern, one for each axis (Teschner et al., 2003), and the upper bits, which all
                // bits of the cell reach.
                let mixed = (cell[0] as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
                    ^ (cell[1] as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
                    ^ (cell[2] as u64).wrapping_mul(0x1656_67b1_9e37_79f9);
                (mixed.wrapping_mul(0xff51_afd7_ed55_8ccd) >> 32) as usize & (self.cells.len() - 1)
            }
        }
    }

    /// Lists the places in memory of these cells, each once.
    fn list(&self, reach: &Reach, places: &mut Vec<usize>) {
        places.clear();
        let _ = reach.each(|cell| {
            places.push(self.place(cell));
            ControlFlow::Continue(())
        });
        places.sort_unstable();
        places.dedup();
    }

    fn put(&mut self, copy: Copy) {
        let mut places = std::mem::take(&mut self.listed);
        self.list(&self.reach(&copy.bounds), &mut places);
        for &place in &places {
            let cell = &mut self.cells[place];
            if cell.is_empty() {
                *cell = self.spare.pop().unwrap_or_default();
            }
            cell.push(copy);
        }
        self.copies += places.len();
        self.listed = places;
    }

    pub(super) fn insert(&mut self, key: u32, bounds: &MinMax) {
        self.put(Copy { bounds: *bounds, key });
        self.resize();
    }

    fn take(&mut self, key: u32, bounds: &MinMax) {
        let mut places = std::mem::take(&mut self.listed);
        self.list(&self.reach(bounds), &mut places);
        for &place in &places {
            let cell = &mut self.cells[place];
            if let Some(at) = cell.iter().position(|copy| copy.key == key) {
                cell.swap_remove(at);
                self.copies -= 1;
                if cell.is_empty() {
                    self.spare.push(std::mem::take(cell));
                }
            }
        }
        self.listed = places;
    }

    pub(super) fn remove(&mut self, key: u32, bounds: &MinMax) {
        self.take(key, bounds);
        self.resize();
    }

    /// Asks for the cells that a box reaches into, and says where they are, as far as there is room.
    pub(super) fn prefetch(&self, bounds: &MinMax, places: &mut Places) {
        places.count = 0;
        let _ = self.reach(bounds).each(|cell| {
            let Some(next) = places.places.get_mut(places.count) else { return ControlFlow::Break(()) };
            *next = self.place(cell);
            prefetch(&self.cells[*next]);
            places.count += 1;
            ControlFlow::Continue(())
        });
    }

    /// Asks for what cells hold.
    pub(super) fn prefetch_held(&self, places: &Places) {
        for &place in &places.places[..places.count] {
            // Cells may have become fewer since.
            self.cells.get(place).into_iter().flatten().take(HELD).for_each(prefetch);
        }
    }

    /// Moves a box that is here by a short way, and tells which boxes here begin to meet it, and which cease to; false, and
    /// nothing done, where the way is not short.
    pub(super) fn follow(&mut self, key: u32, from: &MinMax, to: &MinMax, mut note: impl FnMut(u32, bool)) -> bool {
        let (before, after) = (self.reach(from), self.reach(to));
        let both = Reach([
            [0, 1, 2].map(|axis| before.0[0][axis].min(after.0[0][axis])),
            [0, 1, 2].map(|axis| before.0[1][axis].max(after.0[1][axis])),
        ]);
        if both.count() > SHORT {
            return false;
        }
        let stays = before == after;
        let _ = both.each(|cell| {
            let place = self.place(cell);
            for at in 0..self.cells[place].len() {
                let copy = &mut self.cells[place][at];
                if copy.key == key {
                    // A place that two cells share is written twice.
                    if stays {
                        copy.bounds = *to;
                    }
                    continue;
                }
                let (other, bounds) = (copy.key, copy.bounds);
                let meets = to.overlaps(&bounds);
                if from.overlaps(&bounds) != meets {
                    // Once: in the cell of the least corner of what it shares with the way.
                    let own = bounds.min();
                    if (0..3).all(|axis| cell[axis] == both.0[0][axis].max(self.along(own[axis], axis))) {
                        note(other, meets);
                    }
                }
            }
            ControlFlow::Continue(())
        });
        if !stays {
            self.take(key, from);
            self.put(Copy { bounds: *to, key });
            self.resize();
        }
        true
    }

    /// Moves a box that is here; one that stays in its cells is only written anew.
    pub(super) fn relocate(&mut self, key: u32, from: &MinMax, to: &MinMax) {
        let reach = self.reach(from);
        if reach != self.reach(to) {
            self.remove(key, from);
            self.insert(key, to);
            return;
        }
        // A place that two cells share is written twice.
        let _ = reach.each(|cell| {
            let place = self.place(cell);
            let copy = self.cells[place].iter_mut().find(|copy| copy.key == key);
            copy.into_iter().for_each(|copy| copy.bounds = *to);
            ControlFlow::Continue(())
        });
    }

    /// Keeps the number of hashed cells in proportion to what they hold.
    fn resize(&mut self) {
        let fits = self.copies * ROOM <= self.cells.len() && self.cells.len() <= FEWEST.max(self.copies * ROOM * 8);
        if matches!(self.layout, Layout::Dense { .. }) || fits {
            return;
        }
        let mut boxes: Vec<Copy> = Vec::new();
        let _ = self.each_once(|copy| {
            boxes.push(*copy);
            ControlFlow::Continue(())
        });
        let count = (2 * ROOM * self.copies).next_power_of_two().max(FEWEST);
        self.cells = vec![Vec::new(); count];
        self.spare.clear();
        self.copies = 0;
        boxes.into_iter().for_each(|copy| self.put(copy));
    }

    /// Visits each box here once: in the place of its first cell.
    fn each_once(&self, mut visit: impl FnMut(&Copy) -> ControlFlow<()>) -> ControlFlow<()> {
        for (place, cell) in self.cells.iter().enumerate() {
            for copy in cell {
                if self.place(self.reach(&copy.bounds).0[0]) == place {
                    visit(copy)?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Visits each box that meets this one, once: in the cell of the least corner of what they share.
    pub(super) fn overlapping(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        let reach = self.reach(bounds);
        if reach.count() > self.cells.len() as f64 {
            work.nodes += self.cells.len() as u64;
            return self.each_once(|copy| {
                work.boxes += 1;
                if copy.bounds.overlaps(bounds) { visit(copy.key) } else { ControlFlow::Continue(()) }
            });
        }
        reach.each(|cell| {
            work.nodes += 1;
            for copy in &self.cells[self.place(cell)] {
                work.boxes += 1;
                if copy.bounds.overlaps(bounds) {
                    let (first, own) = (reach.0[0], copy.bounds.min());
                    if (0..3).all(|axis| cell[axis] == first[axis].max(self.along(own[axis], axis))) {
                        visit(copy.key)?;
                    }
                }
            }
            ControlFlow::Continue(())
        })
    }

    /// Calls for each two boxes here that meet, once, in the place of the cell of the least corner of what they share.
    pub(super) fn pairs(&self, mut meet: impl FnMut(u32, u32)) {
        for (place, cell) in self.cells.iter().enumerate() {
            for (at, one) in cell.iter().enumerate() {
                for other in &cell[at + 1..] {
                    if !one.bounds.overlaps(&other.bounds) {
                        continue;
                    }
                    let (min, others) = (one.bounds.min(), other.bounds.min());
                    let shared = [0, 1, 2].map(|axis| self.along(min[axis].max(others[axis]), axis));
                    if self.place(shared) == place {
                        meet(one.key, other.key);
                    }
                }
            }
        }
    }
}
