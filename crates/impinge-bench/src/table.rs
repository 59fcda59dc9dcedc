//! Results as text: aligned columns, and times in the unit that suits them.

use std::collections::HashSet;
use std::fmt;

use anyhow::{Result, ensure};

use crate::record::{self, Row};
use crate::samples::Samples;

/// Libraries that tables name, in a heading or at the beginning of a row.
const ENGINES: [&str; 6] = ["impinge", "kiddo", "obvhs", "parry3d", "rapier3d", "rstar"];

/// Units of cells: the sign, the unit in a record, and the factor between the two.
const UNITS: [(&str, &str, f64); 5] =
    [("s", "s", 1.0), ("ms", "s", 1e-3), ("µs", "s", 1e-6), ("ns", "s", 1e-9), ("%", "%", 1.0)];

/// Rows of cells below a row of headings. The first column is aligned left, the others right.
#[derive(Clone, Debug)]
pub struct Table<const COLUMNS: usize>(Vec<[String; COLUMNS]>);

impl<const COLUMNS: usize> Table<COLUMNS> {
    /// Returns a table with headings and without rows.
    #[must_use]
    pub fn new(headings: [&str; COLUMNS]) -> Self {
        Self(vec![headings.map(str::to_owned)])
    }

    /// Adds a row below the others.
    pub fn row(&mut self, cells: [String; COLUMNS]) {
        self.0.push(cells);
    }

    /// Records the numbers of the table, if the benchmark is recorded.
    ///
    /// The first `keys` columns name the case of a row, behind `context` if that is not empty. Each
    /// other cell that is a number, with a unit or without, becomes a row of the record. Its
    /// quantity is the heading, and its engine is the library that the heading or the row begins
    /// with, or else impinge.
    ///
    /// # Errors
    /// Returns an error if two numbers have the same case, engine and quantity, or if the file
    /// cannot be written.
    pub fn record(&self, context: &str, keys: usize) -> Result<()> {
        let rows = self.recorded(context, keys);
        let mut seen = HashSet::new();
        for Row { case, engine, quantity, .. } in &rows {
            ensure!(
                seen.insert((case, engine, quantity)),
                "two numbers of {case}, {engine}, {quantity}. Give the table other headings or cases."
            );
        }
        record::append(&rows)
    }

    fn recorded(&self, context: &str, keys: usize) -> Vec<Row> {
        let Some((headings, rows)) = self.0.split_first() else { return Vec::new() };
        let mut found = Vec::new();
        for cells in rows {
            let names = headings.iter().zip(cells).take(keys).map(|(heading, cell)| match number(cell) {
                // A number alone does not say what it counts.
                Some(_) if !heading.is_empty() => format!("{heading} {cell}"),
                _ => cell.clone(),
            });
            let name = names.collect::<Vec<_>>().join(", ");
            let (engine_of_row, name) = engine(&name);
            let case = if context.is_empty() { name.to_owned() } else { format!("{context}, {name}") };
            for (heading, cell) in headings.iter().zip(cells).skip(keys) {
                let Some((value, unit)) = number(cell) else { continue };
                let (engine_of_heading, quantity) = engine(heading);
                found.push(Row {
                    case: case.clone(),
                    engine: engine_of_heading.or(engine_of_row).unwrap_or("impinge").to_owned(),
                    quantity: quantity.to_owned(),
                    unit,
                    value,
                });
            }
        }
        found
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

/// Returns the library that a heading or a row begins with, if it is one of [`ENGINES`], and the
/// rest.
fn engine(text: &str) -> (Option<&'static str>, &str) {
    let named = ENGINES.into_iter().find_map(|engine| {
        let rest = text.strip_prefix(engine).filter(|rest| rest.is_empty() || rest.starts_with([',', ' ']))?;
        Some((Some(engine), rest.trim_start_matches([',', ' '])))
    });
    named.unwrap_or((None, text))
}

/// Returns the number in a cell and its unit in a record, or `None` if the cell is other text.
fn number(cell: &str) -> Option<(f64, &'static str)> {
    let Some((digits, sign)) = cell.split_once(' ') else { return Some((cell.parse().ok()?, "1")) };
    let (_, unit, factor) = UNITS.into_iter().find(|(known, ..)| *known == sign)?;
    Some((digits.parse::<f64>().ok()? * factor, unit))
}

/// Formats a time in seconds with a suitable unit: s, ms, µs or ns, such as `12.50 ms`.
#[must_use]
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s >= 1.0 => format!("{s:.3} s"),
        s if s >= 1e-3 => format!("{:.2} ms", s * 1e3),
        s if s >= 1e-6 => format!("{:.2} µs", s * 1e6),
        s => format!("{:.1} ns", s * 1e9),
    }
}

/// Returns the minimum and the median time, as two cells.
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
    fn numbers_are_recorded_with_their_case_engine_and_quantity() {
        let mut table = Table::new(["bodies", "moving", "step", "parry3d step", "pairs", "share", "depth"]);
        let cells = ["1000", "all", "12.50 ms", "2.0 ns", "14974", "45.5 %", "0.1 to 0.2"];
        table.row(cells.map(str::to_owned));
        let seen: Vec<_> =
            table.recorded("boxes", 2).into_iter().map(|row| (row.engine, row.quantity, row.unit, row.value)).collect();
        let expected = [
            ("impinge", "step", "s", 0.0125),
            ("parry3d", "step", "s", 2e-9),
            ("impinge", "pairs", "1", 14974.0),
            ("impinge", "share", "%", 45.5),
        ];
        assert_eq!(
            seen,
            expected.map(|(engine, quantity, unit, value)| (engine.to_owned(), quantity.to_owned(), unit, value))
        );
        assert_eq!(table.recorded("boxes", 2)[0].case, "boxes, bodies 1000, all");
        assert_eq!(table.recorded("", 2)[0].case, "bodies 1000, all");
    }

    #[test]
    fn rows_may_name_the_library() {
        let mut table = Table::new(["", "build"]);
        table.row(["obvhs, fast".to_owned(), "1.000 s".to_owned()]);
        let row = &table.recorded("", 1)[0];
        assert_eq!((&*row.engine, &*row.case, &*row.quantity), ("obvhs", "fast", "build"));
    }

    #[test]
    fn numbers_with_the_same_name_are_refused() {
        let mut table = Table::new(["pose", "median", "median"]);
        table.row(["deep", "1.0 ns", "2.0 ns"].map(str::to_owned));
        assert!(table.record("", 1).is_err());
        let mut table = Table::new(["pose", "median"]);
        (0..2).for_each(|_| table.row(["deep", "1.0 ns"].map(str::to_owned)));
        assert!(table.record("", 1).is_err());
    }

    #[test]
    fn times_bear_the_unit_that_suits_them() {
        let texts = [2.5, 0.0125, 3.25e-5, 8e-9].map(time);
        assert_eq!(texts, ["2.500 s", "12.50 ms", "32.50 µs", "8.0 ns"]);
    }
}
