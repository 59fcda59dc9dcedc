//! The last two commits of a record side by side.

use std::fmt;

use crate::records::{Record, Row};

/// Relative change of a value that is flagged. Smaller changes are the noise of a shared machine.
const FLAGGED: f64 = 0.05;

/// A value at two commits.
#[derive(Clone, Debug, PartialEq)]
struct Change<'a> {
    old: &'a Row,
    new: &'a Row,
}

impl Change<'_> {
    /// Returns the new value divided by the old one. Two zeros have the ratio 1.
    fn ratio(&self) -> f64 {
        if self.old.value == self.new.value { 1.0 } else { self.new.value / self.old.value }
    }

    /// Returns the word that flags a change over 5 %, or nothing.
    fn flag(&self) -> &'static str {
        match self.ratio() - 1.0 {
            change if change.abs() <= FLAGGED => "",
            _ if self.new.unit != "s" => "changed",
            change if change > 0.0 => "slower",
            _ => "faster",
        }
    }
}

/// The values that the last two commits of a record share.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Comparison<'a> {
    record: &'a Record,
    changes: Vec<Change<'a>>,
}

/// Compares the newest commit of a record with the commit recorded before it.
///
/// Returns `None` if the record has fewer than two commits, or if the two share no value. If a
/// commit was measured several times, its newest value counts.
pub(crate) fn last_two(record: &Record) -> Option<Comparison<'_>> {
    let rows = &record.rows;
    let new = &rows.last()?.commit;
    let old = &rows.iter().rfind(|row| row.commit != *new)?.commit;
    let mut changes: Vec<Change<'_>> = Vec::new();
    for row in rows.iter().filter(|row| row.commit == *new) {
        if let Some(known) = changes.iter_mut().find(|change| change.new.measures_same(row)) {
            known.new = row;
        } else if let Some(before) = rows.iter().rfind(|other| other.commit == *old && other.measures_same(row)) {
            changes.push(Change { old: before, new: row });
        }
    }
    (!changes.is_empty()).then_some(Comparison { record, changes })
}

impl fmt::Display for Comparison<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(Change { old, new }) = self.changes.first() else { return Ok(()) };
        writeln!(f, "{} on {}", self.record.bench, self.record.cpu)?;
        for row in [old, new] {
            writeln!(f, "  {} ({}): {}", row.commit, row.date, row.command)?;
        }
        let head = ["case", "engine", "quantity", &old.commit, &new.commit, "ratio", ""].map(str::to_owned);
        let cells = self.changes.iter().map(|change| {
            let Row { case, engine, quantity, unit, .. } = change.new;
            let [old, new] = [change.old, change.new].map(|row| value(row.value, unit));
            let ratio = format!("{:.2}", change.ratio());
            [case.clone(), engine.clone(), quantity.clone(), old, new, ratio, change.flag().to_owned()]
        });
        let cells: Vec<[String; 7]> = std::iter::once(head).chain(cells).collect();
        let widths: [usize; 7] =
            std::array::from_fn(|column| cells.iter().map(|row| row[column].chars().count()).max().unwrap_or(0));
        for row in &cells {
            let mut line = String::from(" ");
            for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
                line += &if (3..6).contains(&column) { format!(" {cell:>width$}") } else { format!(" {cell:<width$}") };
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        let flagged = self.changes.iter().filter(|change| !change.flag().is_empty()).count();
        writeln!(f, "  {} values, {flagged} of them changed by more than {} %", self.changes.len(), FLAGGED * 100.0)
    }
}

/// Returns a value with its unit. Seconds are scaled to the unit that gives one to three digits
/// before the point.
fn value(value: f64, unit: &str) -> String {
    match (unit, value.abs()) {
        ("1", _) => value.to_string(),
        ("s", size) if size < 1e-6 => format!("{:.4} ns", value * 1e9),
        ("s", size) if size < 1e-3 => format!("{:.3} µs", value * 1e6),
        ("s", size) if size < 1.0 => format!("{:.3} ms", value * 1e3),
        _ => format!("{value:.3} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::tests::row;

    fn record(rows: Vec<Row>) -> Record {
        Record { bench: "hulls".into(), cpu: "zen5".into(), rows }
    }

    #[test]
    fn the_last_two_commits_are_compared_by_their_newest_values() {
        let record = record(vec![
            row("oldest", "knot", "impinge", "hull", 9.0),
            row("old", "knot", "impinge", "hull", 1.0),
            row("old", "knot", "qhull", "hull", 4.0),
            row("old", "cube", "impinge", "hull", 2.0),
            row("new", "knot", "impinge", "hull", 3.0),
            row("new", "cube", "impinge", "hull", 2.08),
            row("new", "sphere", "impinge", "hull", 5.0),
            row("new", "knot", "impinge", "hull", 1.5),
        ]);
        let comparison = last_two(&record).unwrap();
        let seen: Vec<(&str, f64, &str)> =
            comparison.changes.iter().map(|change| (&*change.new.case, change.ratio(), change.flag())).collect();
        assert_eq!(seen, [("knot", 1.5, "slower"), ("cube", 1.04, "")]);
        let text = comparison.to_string();
        assert!(text.starts_with("hulls on zen5\n  old (date of old): run\n  new (date of new): run\n"), "{text}");
        assert!(text.contains("  knot impinge hull     1.000 s 1.500 s  1.50 slower\n"), "{text}");
        assert!(text.ends_with("2 values, 1 of them changed by more than 5 %\n"), "{text}");
    }

    #[test]
    fn one_commit_or_none_in_common_is_not_compared() {
        assert_eq!(last_two(&record(vec![])), None);
        assert_eq!(last_two(&record(vec![row("a", "knot", "impinge", "hull", 1.0)])), None);
        let apart = vec![row("a", "knot", "impinge", "hull", 1.0), row("b", "cube", "impinge", "hull", 1.0)];
        assert_eq!(last_two(&record(apart)), None);
    }

    #[test]
    fn zeros_and_counts_have_ratios_and_flags() {
        let count = |value| Row { unit: "1".into(), ..row("a", "knot", "impinge", "pairs", value) };
        let [none, some, less] = [0.0, 10.0, 9.0].map(count);
        let change = |old, new| (Change { old, new }.ratio(), Change { old, new }.flag());
        assert_eq!(change(&none, &none), (1.0, ""));
        assert_eq!(change(&none, &some), (f64::INFINITY, "changed"));
        assert_eq!(change(&some, &less), (0.9, "changed"));
    }

    #[test]
    fn seconds_are_scaled() {
        let shown = [2.5, 0.0125, 3.25e-5, 8e-9].map(|seconds| value(seconds, "s"));
        assert_eq!(shown, ["2.500 s", "12.500 ms", "32.500 µs", "8.0000 ns"]);
        assert_eq!(value(14974.0, "1"), "14974");
    }
}
