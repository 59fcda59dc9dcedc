//! Rows of a table, read by index. One comparison proves that all indices are in range.
//!
//! The indices may lie in a memory map that another process writes to. So they are read once, into
//! an array that nobody else can change, and then compared and used from there.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x8};

use super::LANES;

/// A table of rows of three numbers. A row is read as four numbers; the fourth is arbitrary.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a, T> {
    rows: &'a [[T; 3]],
    /// The last row, which no number follows in the table, and a fourth number.
    last: [T; 4],
}

/// Row indices, all of them before the last row.
pub(crate) struct Inside<'a, T, const N: usize> {
    rows: &'a [[T; 3]],
    at: [u32; N],
}

impl<'a, T: Copy + Default> Rows<'a, T> {
    /// Wraps a table. An empty table gets one row of zeros.
    pub(crate) fn of(rows: &'a [[T; 3]]) -> Self {
        let [x, y, z] = rows.last().copied().unwrap_or_default();
        Self { rows, last: [x, y, z, T::default()] }
    }

    /// Returns all rows.
    #[inline(always)]
    pub(crate) fn all(&self) -> &'a [[T; 3]] {
        self.rows
    }

    /// Returns row `at`, or the last row if `at` is out of range.
    #[inline(always)]
    pub(crate) fn row(&self, at: u32) -> &[T; 4] {
        let first = 3 * at as usize;
        let row = self.rows.as_flattened().get(first..first + 4).and_then(|row| row.try_into().ok());
        row.unwrap_or(&self.last)
    }

    /// Returns the rows at these indices, or `None` unless each index is before the last row.
    /// Nearly always they are, and then no row needs a comparison of its own. The number of indices
    /// must be a multiple of eight.
    #[inline(always)]
    pub(crate) fn inside<S: Simd, const N: usize>(&self, simd: S, at: &[u32; N]) -> Option<Inside<'a, T, N>> {
        const { assert!(N.is_multiple_of(LANES)) };
        // SAFETY: a reference to plain numbers can be read. The read is volatile so that the
        // compiler reads each number once, not again after the comparison.
        #[allow(unsafe_code)]
        let at = unsafe { std::ptr::read_volatile(at) };
        let mut greatest = u32x8::splat(simd, 0);
        for eight in at.as_chunks::<LANES>().0 {
            greatest = greatest.max(u32x8::from_slice(simd, eight));
        }
        // An index plus one could overflow.
        let inside = (greatest.reduce_max() as usize) < self.rows.len().saturating_sub(1);
        inside.then_some(Inside { rows: self.rows, at })
    }
}

impl<'a, T, const N: usize> Inside<'a, T, N> {
    /// Returns the row of one of the indices.
    #[inline(always)]
    pub(crate) fn row(&self, index: usize) -> &'a [T; 4] {
        let row = self.at[index] as usize;
        // SAFETY: `Rows::inside` proved that another row follows this one, and nobody else can
        // change the indices that it compared. So the three numbers of this row and one more lie in
        // the slice. An array has the alignment of its elements.
        #[allow(unsafe_code)]
        unsafe {
            &*self.rows.as_ptr().add(row).cast::<[T; 4]>()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::dispatch_every;
    use crate::simd::kernel_levels;

    #[test]
    fn rows_are_those_of_their_numbers() {
        let table: Vec<[u32; 3]> = (0..9).map(|row| [3 * row, 3 * row + 1, 3 * row + 2]).collect();
        let rows = Rows::of(&table);
        let none = Rows::<f32>::of(&[]);
        assert!([9, u32::MAX].iter().all(|&row| rows.row(row)[..3] == table[8]));
        assert_eq!(none.row(0), &[0.0; 4]);
        for (name, level) in kernel_levels() {
            dispatch_every!(level, simd => {
                for place in [0, 7, 8, 23] {
                    for row in (0..9).chain([9, u32::MAX]) {
                        let mut at = [0; 24];
                        (at[place], at[23 - place]) = (row, 5);
                        let inside = rows.inside(simd, &at);
                        assert_eq!(inside.is_some(), row < 8, "{name}: the last row has no fourth number");
                        for (index, &row) in at.iter().enumerate().filter(|_| row < 9) {
                            assert_eq!(rows.row(row)[..3], table[row as usize]);
                            assert!(inside.as_ref().is_none_or(|inside| inside.row(index)[..3] == table[row as usize]));
                        }
                    }
                }
                assert!(none.inside(simd, &[0; 8]).is_none());
            });
        }
    }
}
