//! Results as text: aligned columns, and times in the unit that suits them.

use std::fmt;

use crate::samples::Samples;

/// Rows of cells under headings; the first column stands left, the others right.
#[derive(Clone, Debug)]
pub struct Table<const COLUMNS: usize>(Vec<[String; COLUMNS]>);

impl<const COLUMNS: usize> Table<COLUMNS> {
    /// A table without rows.
    #[must_use]
    pub fn new(headings: [&str; COLUMNS]) -> Self {
        Self(vec![headings.map(str::to_owned)])
    }

    /// Adds a row below the others.
    pub fn row(&mut self, cells: [String; COLUMNS]) {
        self.0.push(cells);
    }
}

impl<const COLUMNS: usize> fmt::Display for Table<COLUMNS> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |column: usize| self.0.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: [usize; COLUMNS] = std::array::from_fn(width);
        for row in &self.0 {
            for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
                match column {
                    0 => write!(f, "{cell:<width$}")?,
                    _ => write!(f, "  {cell:>width$}")?,
                }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// A time with its unit, of four digits at most before it.
#[must_use]
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s >= 1.0 => format!("{s:.3} s"),
        s if s >= 1e-3 => format!("{:.2} ms", s * 1e3),
        s if s >= 1e-6 => format!("{:.2} µs", s * 1e6),
        s => format!("{:.1} ns", s * 1e9),
    }
}

/// The minimum and the median, as two cells.
#[must_use]
pub fn spread(samples: &Samples) -> [String; 2] {
    [time(samples.min()), time(samples.median())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(["pose", "time"]);
        table.row(["a".to_owned(), "12.00 µs".to_owned()]);
        assert_eq!(table.to_string(), "pose      time\na     12.00 µs\n");
    }

    #[test]
    fn times_bear_the_unit_that_suits_them() {
        let texts = [2.5, 0.0125, 3.25e-5, 8e-9].map(time);
        assert_eq!(texts, ["2.500 s", "12.50 ms", "32.50 µs", "8.0 ns"]);
    }
}
