//! Rows of a table by their numbers. One comparison proves that all of the numbers are in range.
//!
//! The numbers may lie in a memory map that another process writes to. So they are read once, into
//! an array that nobody else can change, and compared and used there.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x8};

use super::LANES;

/// Rows of three numbers, which are read four numbers at a time: any fourth comes along.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a, T> {
    rows: &'a [[T; 3]],
    /// The last row, which no number follows, and one that does.
    last: [T; 4],
}

/// Numbers of rows, all of them before the last one.
pub(crate) struct Inside<'a, T, const N: usize> {
    rows: &'a [[T; 3]],
    at: [u32; N],
}

impl<'a, T: Copy + Default> Rows<'a, T> {
    pub(crate) fn of(rows: &'a [[T; 3]]) -> Self {
        let [x, y, z] = rows.last().copied().unwrap_or_default();
        Self { rows, last: [x, y, z, T::default()] }
    }

    /// The rows.
    #[inline(always)]
    pub(crate) fn all(&self) -> &'a [[T; 3]] {
        self.rows
    }

    /// Returns the row of a number, or the last row if the number is too large.
    #[inline(always)]
    pub(crate) fn row(&self, at: u32) -> &[T; 4] {
        let first = 3 * at as usize;
        let row = self.rows.as_flattened().get(first..first + 4).and_then(|row| row.try_into().ok());
        row.unwrap_or(&self.last)
    }

    /// Returns the rows of these numbers, or `None` unless each number is before the last row. They
    /// nearly always are, and then no row needs a comparison of its own. There must be a multiple of
    /// eight numbers.
    #[inline(always)]
    pub(crate) fn inside<S: Simd, const N: usize>(&self, simd: S, at: &[u32; N]) -> Option<Inside<'a, T, N>> {
        const { assert!(N.is_multiple_of(LANES)) };
        // SAFETY: a reference to plain numbers can be read. The read is volatile so that the compiler
        // reads each number once, not again after the comparison.
        #[allow(unsafe_code)]
        let at = unsafe { std::ptr::read_volatile(at) };
        let mut greatest = u32x8::splat(simd, 0);
        for eight in at.as_chunks::<LANES>().0 {
            greatest = greatest.max(u32x8::from_slice(simd, eight));
        }
        // A number and one may be more than an index can be.
        let inside = (greatest.reduce_max() as usize) < self.rows.len().saturating_sub(1);
        inside.then_some(Inside { rows: self.rows, at })
    }
}

impl<'a, T, const N: usize> Inside<'a, T, N> {
    /// The row of one of the numbers.
    #[inline(always)]
    pub(crate) fn row(&self, index: usize) -> &'a [T; 4] {
        let row = self.at[index] as usize;
        // SAFETY: another row follows this one (`Rows::inside`, and nobody else can change the
        // numbers that it compared), so that three numbers from its first on, and a fourth, are of
        // the slice; an array is aligned as its elements are.
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
