//! Rows of a table by their numbers, of which one comparison settles that they are all there.

/// Rows of three numbers, which are read four numbers at a time: any fourth comes along.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a, T> {
    rows: &'a [[T; 3]],
    /// The last row, which no number follows, and one that does.
    last: [T; 4],
}

/// Numbers of rows, all of them before the last one.
pub(crate) struct Inside<'a, 'b, T> {
    rows: &'a [[T; 3]],
    at: &'b [u32],
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

    /// One row; the last where there is none of that number.
    #[inline(always)]
    pub(crate) fn row(&self, at: u32) -> &[T; 4] {
        let first = 3 * at as usize;
        let row = self.rows.as_flattened().get(first..first + 4).and_then(|row| row.try_into().ok());
        row.unwrap_or(&self.last)
    }

    /// Those of these numbers, where each is before the last row: nearly always, and read without a comparison each.
    #[inline(always)]
    pub(crate) fn inside<'b>(&self, at: &'b [u32]) -> Option<Inside<'a, 'b, T>> {
        let greatest = at.iter().fold(0, |greatest, &row| row.max(greatest));
        // A number and one may be more than an index can be.
        let inside = (greatest as usize) < self.rows.len().saturating_sub(1);
        inside.then_some(Inside { rows: self.rows, at })
    }
}

impl<'a, T> Inside<'a, '_, T> {
    /// The row of one of the numbers.
    #[inline(always)]
    pub(crate) fn row(&self, index: usize) -> &'a [T; 4] {
        let row = self.at[index] as usize;
        // SAFETY: another row follows this one (`Rows::inside`, and what it compared is borrowed since), so that three numbers
        // from its first on, and a fourth, are of the slice; an array is aligned as its elements are.
        #[allow(unsafe_code)]
        unsafe {
            &*self.rows.as_ptr().add(row).cast::<[T; 4]>()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_of_their_numbers() {
        let table: Vec<[u32; 3]> = (0..9).map(|row| [3 * row, 3 * row + 1, 3 * row + 2]).collect();
        let rows = Rows::of(&table);
        for row in 0..9 {
            assert_eq!(rows.row(row)[..3], table[row as usize]);
            let at = [0, row, 5];
            let inside = rows.inside(&at);
            assert_eq!(inside.is_some(), row < 8, "the last row has no fourth number");
            for (index, &row) in at.iter().enumerate() {
                assert!(inside.as_ref().is_none_or(|inside| inside.row(index)[..3] == table[row as usize]));
            }
        }
        assert!(rows.inside(&[9]).is_none() && rows.inside(&[u32::MAX]).is_none());
        assert!([9, u32::MAX].iter().all(|&row| rows.row(row)[..3] == table[8]));
        let none = Rows::<f32>::of(&[]);
        assert!(none.inside(&[0]).is_none() && none.row(0) == &[0.0; 4]);
    }
}
