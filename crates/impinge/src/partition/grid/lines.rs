//! The memory of cells: a line of memory per cell with a few copies of boxes, and more lines if a
//! cell holds more.

use bytemuck::{Pod, Zeroable};

use super::quantized_box::QuantizedBox;
use crate::storage::{Buffer, Pages};

/// Number of copies in a line, so that a line has 64 bytes.
pub(super) const LINE_CAPACITY: usize = 5;

/// Value of `next` if no line follows. It is zero, so that zeroed memory is an empty line.
const LAST: u32 = 0;

/// Copies of boxes, as many as fit into a cache line of the processor. A line of zeros is empty.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Line {
    /// Quantized boxes. In the first line of a cell, copies come before empty places. The following
    /// lines are full.
    pub(super) boxes: [QuantizedBox; LINE_CAPACITY],
    pub(super) keys: [u32; LINE_CAPACITY],
    /// Number of the next line of the same cell among the additional lines, counted from one, or
    /// [`LAST`].
    pub(super) next: u32,
}

const _: () = assert!(size_of::<Line>() == 64);

const EMPTY: Line = Line { boxes: [QuantizedBox::NONE; LINE_CAPACITY], keys: [0; LINE_CAPACITY], next: LAST };

/// One line for each of a number of cells, and additional lines for cells that need more.
#[derive(Debug)]
pub(super) struct Lines {
    /// First line of each cell, in large pages. Cells are visited in random order, and with small
    /// pages translating an address takes longer than loading the line.
    first: Buffer<Line>,
    /// Additional lines of all cells.
    more: Vec<Line>,
    /// Number of the first unused line in `more`, counted from one. Each unused line refers to the
    /// next.
    free: u32,
    /// Number of copies in all lines.
    copies: usize,
}

/// The lines, borrowed for writing, so that the buffer is made writable once for many writes.
pub(super) struct Opened<'a> {
    first: &'a mut [Line],
    more: &'a mut Vec<Line>,
    free: &'a mut u32,
    copies: &'a mut usize,
}

impl Line {
    fn held(&self) -> usize {
        self.boxes.iter().position(|quantized| quantized.is_none()).unwrap_or(LINE_CAPACITY)
    }

    /// Returns the position of a copy, given the key of its box and a word with the key of its
    /// cell.
    fn find(&self, key: u32, like: QuantizedBox) -> Option<usize> {
        (0..LINE_CAPACITY).find(|&at| self.keys[at] == key && self.boxes[at].has_cell_key_of(like))
    }
}

impl Lines {
    pub(super) fn new(cells: usize) -> Self {
        Self { first: Pages::zeroed(cells), more: Vec::new(), free: LAST, copies: 0 }
    }

    /// Returns the number of cells.
    pub(super) fn len(&self) -> usize {
        self.first.len()
    }

    /// Returns the number of copies in all cells.
    pub(super) fn copies(&self) -> usize {
        self.copies
    }

    /// Returns the first lines of all cells.
    #[inline]
    pub(super) fn first(&self) -> &[Line] {
        &self.first
    }

    /// Returns the line that follows a line.
    #[inline]
    pub(super) fn after(&self, line: &Line) -> Option<&Line> {
        self.more.get(shared(line.next))
    }

    /// Returns the lines of a cell.
    #[inline]
    pub(super) fn of(&self, at: usize) -> impl Iterator<Item = &Line> {
        std::iter::successors(self.first.get(at), |line| self.after(line))
    }

    /// Borrows all lines for writing.
    #[inline(always)]
    pub(super) fn open(&mut self) -> Opened<'_> {
        let Self { first, more, free, copies } = self;
        Opened { first: first.to_mut(), more, free, copies }
    }
}

impl Opened<'_> {
    /// Returns the first line of a cell, for overwriting its copies.
    #[inline(always)]
    pub(super) fn first(&mut self, at: usize) -> &mut Line {
        &mut self.first[at]
    }

    /// Returns the additional line with this number.
    #[inline(always)]
    pub(super) fn more(&mut self, next: u32) -> Option<&mut Line> {
        self.more.get_mut(shared(next))
    }

    /// Adds a copy to a cell. The cell must not contain a copy of the same box with the same cell
    /// key.
    pub(super) fn put(&mut self, at: usize, key: u32, quantized: QuantizedBox) {
        *self.copies += 1;
        let mut held = self.first[at].held();
        if held == LINE_CAPACITY {
            // The full line moves to the additional lines and follows the new first line.
            let next = self.allocate(self.first[at]);
            self.first[at] = Line { next, ..EMPTY };
            held = 0;
        }
        let line = &mut self.first[at];
        line.boxes[held] = quantized;
        line.keys[held] = key;
    }

    /// Removes the copy of a box that has the cell key of `like`, if there is one.
    pub(super) fn take(&mut self, at: usize, key: u32, like: QuantizedBox) {
        let Some((line, place)) = self.find(at, key, like) else { return };
        // The last copy of the first line fills the gap.
        let first = &mut self.first[at];
        let last = first.held() - 1;
        let (last_word, last_key) = (first.boxes[last], first.keys[last]);
        first.boxes[last] = QuantizedBox::NONE;
        let next = first.next;
        match line {
            None if place == last => {}
            None => (first.boxes[place], first.keys[place]) = (last_word, last_key),
            Some(line) => {
                let line = &mut self.more[line];
                (line.boxes[place], line.keys[place]) = (last_word, last_key);
            }
        }
        if last == 0 && next != LAST {
            let line = &mut self.more[shared(next)];
            *first = *line;
            *line = Line { next: *self.free, ..EMPTY };
            *self.free = next;
        }
        *self.copies -= 1;
    }

    /// Overwrites the copy of a box that has the same cell key, if there is one.
    pub(super) fn write(&mut self, at: usize, key: u32, quantized: QuantizedBox) {
        match self.find(at, key, quantized) {
            Some((None, place)) => self.first[at].boxes[place] = quantized,
            Some((Some(line), place)) => self.more[line].boxes[place] = quantized,
            None => {}
        }
    }

    /// Returns the position of a copy: the index of its additional line (`None` for the first
    /// line), and its position in the line.
    fn find(&self, at: usize, key: u32, like: QuantizedBox) -> Option<(Option<usize>, usize)> {
        let mut line = &self.first[at];
        let mut number = None;
        loop {
            if let Some(place) = line.find(key, like) {
                return Some((number, place));
            }
            number = Some(shared(line.next));
            line = self.more.get(shared(line.next))?;
        }
    }

    /// Stores a line among the additional lines, and returns its number, counted from one.
    fn allocate(&mut self, line: Line) -> u32 {
        match self.more.get_mut(shared(*self.free)) {
            Some(free) => {
                let at = *self.free;
                *self.free = free.next;
                *free = line;
                at
            }
            None => {
                self.more.push(line);
                self.more.len() as u32
            }
        }
    }
}

impl Clone for Lines {
    fn clone(&self) -> Self {
        let Self { first, more, free, copies } = self;
        Self { first: Pages::copied(first), more: more.clone(), free: *free, copies: *copies }
    }
}

/// Returns the index of an additional line from its number, which counts from one. For zero the
/// index is out of bounds.
#[inline(always)]
fn shared(next: u32) -> usize {
    (next as usize).wrapping_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;
    use std::collections::BTreeMap;

    #[test]
    fn lines_hold_the_copies_put_and_allocate_no_more_than_needed() {
        let mut rng = Rng::new(92);
        let mut lines = Lines::new(3);
        let mut expected = BTreeMap::new();
        for round in 0..30_000_u32 {
            // Filling and emptying take turns.
            let fills = round / 3000 % 2 == 0;
            let (at, key, cell) = (rng.integer(0, 2) as usize, rng.integer(0, 20) as u32, rng.integer(0, 3));
            let now = quantized(cell, rng.integer(1, 99) as u8);
            match expected.get_mut(&(at, key, cell)) {
                Some(before) if fills => {
                    lines.open().write(at, key, now);
                    *before = now;
                }
                Some(_) => {
                    lines.open().take(at, key, now);
                    expected.remove(&(at, key, cell));
                }
                None if fills || rng.one_in(4) => {
                    lines.open().put(at, key, now);
                    expected.insert((at, key, cell), now);
                }
                None => {
                    lines.open().take(at, key, now);
                    lines.open().write(at, key, now);
                }
            }
            assert_eq!(lines.copies(), expected.len());
            if round % 50 != 0 {
                continue;
            }
            let mut in_use = 0;
            for at in 0..3 {
                let copies = lines.of(at).flat_map(|line| (0..line.held()).map(|k| (line.keys[k], line.boxes[k])));
                let mut copies: Vec<_> = copies.collect();
                copies.sort_by_key(|(key, seen)| (*key, (0..4).find(|&cell| seen.has_cell_key_of(quantized(cell, 1)))));
                let wanted = expected.iter().filter(|((place, ..), _)| *place == at);
                assert_eq!(copies, wanted.map(|((_, key, _), quantized)| (*key, *quantized)).collect::<Vec<_>>());
                let count = lines.of(at).count();
                assert_eq!(count, copies.len().div_ceil(LINE_CAPACITY).max(1));
                in_use += count - 1;
            }
            let free = std::iter::successors(lines.more.get(shared(lines.free)), |line| lines.after(line)).count();
            assert_eq!(in_use + free, lines.more.len());
        }
        assert!(lines.more.len() > 10);
    }

    fn quantized(cell: i64, step: u8) -> QuantizedBox {
        QuantizedBox::along(0, [step, 200], cell)
    }
}
