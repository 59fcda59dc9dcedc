//! What cells hold: a few copies of boxes in a line of memory each, and more lines where there are more.

use bytemuck::{Pod, Zeroable};

use super::quantized_box::QuantizedBox;
use crate::storage::{Buffer, Pages};

/// Number of copies in a line, so that a line has 64 bytes.
pub(super) const LINE_CAPACITY: usize = 5;

/// Where no line follows, as in memory that is all zeros.
const LAST: u32 = 0;

/// Copies of boxes, as many as a line of memory of a processor's cache holds. One of zeros is empty.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Line {
    /// Those that are there come first, in the first line of a cell; the lines that follow are full.
    pub(super) boxes: [QuantizedBox; LINE_CAPACITY],
    pub(super) keys: [u32; LINE_CAPACITY],
    /// The next line of the same cell, among those that are shared, counted from one.
    pub(super) next: u32,
}

const _: () = assert!(size_of::<Line>() == 64);

const EMPTY: Line = Line { boxes: [QuantizedBox::NONE; LINE_CAPACITY], keys: [0; LINE_CAPACITY], next: LAST };

/// A line for each of a number of cells, and more where one does not do.
#[derive(Debug)]
pub(super) struct Lines {
    /// In large pages: cells that are looked at lie anywhere, and to find a small page takes longer than to have a line.
    first: Buffer<Line>,
    more: Vec<Line>,
    /// The first of the lines in `more` that are not in use, which follow each other, counted from one.
    free: u32,
    copies: usize,
}

/// Lines to be written: what a buffer asks each time that it is to be changed is asked once.
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

    /// Returns the place of a copy, by the key of its box and the key of its cell.
    fn find(&self, key: u32, like: QuantizedBox) -> Option<usize> {
        (0..LINE_CAPACITY).find(|&at| self.keys[at] == key && self.boxes[at].has_cell_key_of(like))
    }
}

impl Lines {
    pub(super) fn new(cells: usize) -> Self {
        Self { first: Pages::zeroed(cells), more: Vec::new(), free: LAST, copies: 0 }
    }

    /// How many cells there are.
    pub(super) fn len(&self) -> usize {
        self.first.len()
    }

    /// How many copies they hold.
    pub(super) fn copies(&self) -> usize {
        self.copies
    }

    /// The first lines of all cells.
    #[inline]
    pub(super) fn first(&self) -> &[Line] {
        &self.first
    }

    /// The line that follows one.
    #[inline]
    pub(super) fn after(&self, line: &Line) -> Option<&Line> {
        self.more.get(shared(line.next))
    }

    /// The lines of a cell.
    #[inline]
    pub(super) fn of(&self, at: usize) -> impl Iterator<Item = &Line> {
        std::iter::successors(self.first.get(at), |line| self.after(line))
    }

    /// All of them, to be written.
    #[inline(always)]
    pub(super) fn open(&mut self) -> Opened<'_> {
        let Self { first, more, free, copies } = self;
        Opened { first: first.to_mut(), more, free, copies }
    }
}

impl Opened<'_> {
    /// The first line of a cell, to write copies anew.
    #[inline(always)]
    pub(super) fn first(&mut self, at: usize) -> &mut Line {
        &mut self.first[at]
    }

    /// A line that follows one.
    #[inline(always)]
    pub(super) fn more(&mut self, next: u32) -> Option<&mut Line> {
        self.more.get_mut(shared(next))
    }

    /// Adds a copy. No copy of this box here has the same cell key.
    pub(super) fn put(&mut self, at: usize, key: u32, quantized: QuantizedBox) {
        *self.copies += 1;
        let mut held = self.first[at].held();
        if held == LINE_CAPACITY {
            // The full line makes room and follows.
            let next = self.lend(self.first[at]);
            self.first[at] = Line { next, ..EMPTY };
            held = 0;
        }
        let line = &mut self.first[at];
        line.boxes[held] = quantized;
        line.keys[held] = key;
    }

    /// Removes the copy of a box with the cell key of `like`.
    pub(super) fn take(&mut self, at: usize, key: u32, like: QuantizedBox) {
        let Some((line, place)) = self.find(at, key, like) else { return };
        // The last of the first line fills the gap.
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

    /// Overwrites the copy of a box with the same cell key.
    pub(super) fn write(&mut self, at: usize, key: u32, quantized: QuantizedBox) {
        match self.find(at, key, quantized) {
            Some((None, place)) => self.first[at].boxes[place] = quantized,
            Some((Some(line), place)) => self.more[line].boxes[place] = quantized,
            None => {}
        }
    }

    /// The line of a copy among those that are shared, none for the first, and its place there.
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

    /// Puts a line among those that are shared, and says which it is there, counted from one.
    fn lend(&mut self, line: Line) -> u32 {
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

/// Where a line is that is counted from one; nowhere for none.
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
    fn lines_hold_what_was_put_and_lend_no_more_than_they_need() {
        let mut rng = Rng::new(92);
        let mut lines = Lines::new(3);
        let mut expected = BTreeMap::new();
        for round in 0..30_000_u32 {
            // Filled and emptied in turns.
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
