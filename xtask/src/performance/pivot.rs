//! A table of Markdown from the rows of a run: a row for each case, a column for each engine.

use crate::records::Row;

/// A table to make from a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pivot {
    /// Heading of the first column, which has the cases.
    pub(crate) cases: &'static str,
    /// Engine that the other libraries are compared with.
    pub(crate) ours: &'static str,
    /// Counts to show, each with the engine that found it and a heading.
    pub(crate) counts: &'static [(&'static str, &'static str, &'static str)],
    /// Times to show, of every engine that has them.
    pub(crate) times: &'static [Time],
}

/// A time to show.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Time {
    /// Name of the quantity in the record.
    pub(crate) quantity: &'static str,
    /// Name of the quantity in the heading, or nothing if the table has one time.
    pub(crate) heading: &'static str,
    /// Unit of the column.
    pub(crate) unit: Unit,
}

/// Unit of a column of times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Unit {
    Milliseconds,
    Microseconds,
    Nanoseconds,
}

impl Unit {
    /// Returns the sign of the unit.
    pub(crate) fn sign(self) -> &'static str {
        match self {
            Self::Milliseconds => "ms",
            Self::Microseconds => "µs",
            Self::Nanoseconds => "ns",
        }
    }

    /// Returns a number of seconds in this unit, with three digits.
    pub(crate) fn show(self, seconds: f64) -> String {
        digits(match self {
            Self::Milliseconds => seconds * 1e3,
            Self::Microseconds => seconds * 1e6,
            Self::Nanoseconds => seconds * 1e9,
        })
    }
}

/// A time of impinge beside that of another library.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Compared<'a> {
    /// Scene, pose or size.
    pub(crate) case: &'a str,
    /// Name of the time in the heading of its column.
    pub(crate) quantity: &'static str,
    /// The other library.
    pub(crate) peer: &'a str,
    /// Seconds of impinge.
    pub(crate) ours: f64,
    /// Seconds of the other library.
    pub(crate) theirs: f64,
}

impl Compared<'_> {
    /// Returns the time of the other library divided by that of impinge.
    pub(crate) fn ratio(&self) -> f64 {
        self.theirs / self.ours
    }
}

impl Pivot {
    /// Returns the table in Markdown.
    pub(crate) fn table(&self, run: &[Row]) -> String {
        let cases = self.cases_of(run);
        let mut columns = vec![(self.cases.to_owned(), cases.iter().map(|case| (*case).to_owned()).collect())];
        let mut column = |heading: String, cell: &dyn Fn(&str) -> Option<String>| {
            columns.push((heading, cases.iter().map(|case| cell(case).unwrap_or_default()).collect::<Vec<_>>()));
        };
        for (engine, quantity, heading) in self.counts {
            column((*heading).to_owned(), &|case| find(run, case, engine, quantity).map(count));
        }
        for time in self.times {
            let ours = |case: &str| find(run, case, self.ours, time.quantity);
            let [unit, separator] = [time.unit.sign(), if time.heading.is_empty() { "" } else { ": " }];
            if self.has_one_peer_for_each_case(run, time.quantity) {
                let peer = |case: &str| self.peers(run, case, time.quantity).into_iter().next();
                let theirs = |case: &str| find(run, case, peer(case)?, time.quantity);
                column(format!("{}{separator}{}, {unit}", time.heading, self.ours), &|case| {
                    ours(case).map(|seconds| time.unit.show(seconds))
                });
                column("other library".to_owned(), &|case| peer(case).map(str::to_owned));
                column(format!("its time, {unit}"), &|case| theirs(case).map(|seconds| time.unit.show(seconds)));
                column("its time / impinge".to_owned(), &|case| Some(digits(theirs(case)? / ours(case)?)));
                continue;
            }
            for engine in engines(run, time.quantity) {
                let theirs = |case: &str| find(run, case, engine, time.quantity);
                column(format!("{}{separator}{engine}, {unit}", time.heading), &|case| {
                    theirs(case).map(|seconds| time.unit.show(seconds))
                });
                if self.is_peer(engine) {
                    column(format!("{engine} / impinge"), &|case| Some(digits(theirs(case)? / ours(case)?)));
                }
            }
        }
        markdown(&columns)
    }

    /// Returns every time of another library beside that of impinge, in the order of the table.
    pub(crate) fn compared<'a>(&self, run: &'a [Row]) -> Vec<Compared<'a>> {
        let mut found = Vec::new();
        for case in self.cases_of(run) {
            for time in self.times {
                let Some(ours) = find(run, case, self.ours, time.quantity) else { continue };
                for peer in engines(run, time.quantity).into_iter().filter(|engine| self.is_peer(engine)) {
                    if let Some(theirs) = find(run, case, peer, time.quantity) {
                        found.push(Compared { case, quantity: time.heading, peer, ours, theirs });
                    }
                }
            }
        }
        found
    }

    /// Reports whether there are several other libraries, but only one of them in each case.
    fn has_one_peer_for_each_case(&self, run: &[Row], quantity: &str) -> bool {
        let all = engines(run, quantity).into_iter().filter(|engine| self.is_peer(engine)).count();
        all > 1 && self.cases_of(run).iter().all(|case| self.peers(run, case, quantity).len() == 1)
    }

    /// Returns the other libraries that have a quantity in a case, in the order of the run.
    fn peers<'a>(&self, run: &'a [Row], case: &str, quantity: &str) -> Vec<&'a str> {
        let all = engines(run, quantity).into_iter();
        all.filter(|engine| self.is_peer(engine) && find(run, case, engine, quantity).is_some()).collect()
    }

    /// Reports whether an engine is another library, and not a way to call impinge.
    fn is_peer(&self, engine: &str) -> bool {
        engine != self.ours && !engine.starts_with("impinge")
    }

    /// Returns the cases that have one of the times, each once, in the order of the run.
    fn cases_of<'a>(&self, run: &'a [Row]) -> Vec<&'a str> {
        let rows = run.iter().filter(|row| self.times.iter().any(|time| time.quantity == row.quantity));
        distinct(rows.map(|row| &*row.case))
    }
}

/// Returns the engines that have a quantity, each once, in the order of the run.
fn engines<'a>(run: &'a [Row], quantity: &str) -> Vec<&'a str> {
    distinct(run.iter().filter(|row| row.quantity == quantity).map(|row| &*row.engine))
}

fn distinct<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for text in texts {
        if !found.contains(&text) {
            found.push(text);
        }
    }
    found
}

fn find(run: &[Row], case: &str, engine: &str, quantity: &str) -> Option<f64> {
    let mut rows = run.iter().filter(|row| row.case == case && row.engine == engine && row.quantity == quantity);
    rows.next_back().map(|row| row.value)
}

/// Returns columns as a table of Markdown. Columns of numbers are aligned to the right.
pub(crate) fn markdown(columns: &[(String, Vec<String>)]) -> String {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let mut table = line(columns.iter().map(|(heading, _)| &**heading).collect());
    let rule =
        |(_, cells): &(String, Vec<String>)| if cells.iter().all(|cell| is_number(cell)) { "---:" } else { "---" };
    table += &format!("|{}|\n", columns.iter().map(rule).collect::<Vec<_>>().join("|"));
    for row in 0..columns.first().map_or(0, |(_, cells)| cells.len()) {
        table += &line(columns.iter().map(|(_, cells)| &*cells[row]).collect());
    }
    table
}

/// Reports whether a cell is a number, perhaps with commas between its digits, or empty.
fn is_number(cell: &str) -> bool {
    cell.is_empty() || cell.replace(',', "").parse::<f64>().is_ok()
}

/// Returns a number rounded to three significant digits, without an exponent.
pub(crate) fn digits(value: f64) -> String {
    format!("{value:.2e}").parse::<f64>().unwrap_or(value).to_string()
}

/// Returns a whole number with a comma between each three digits.
fn count(value: f64) -> String {
    let plain = format!("{value:.0}");
    let groups: Vec<&str> = plain.as_bytes().rchunks(3).rev().filter_map(|group| str::from_utf8(group).ok()).collect();
    groups.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::tests::row;

    const PIVOT: Pivot = Pivot {
        cases: "pose",
        ours: "impinge, in one call",
        counts: &[("impinge, in one call", "pairs", "pairs")],
        times: &[
            Time { quantity: "build median", heading: "build", unit: Unit::Milliseconds },
            Time { quantity: "ray median", heading: "ray", unit: Unit::Nanoseconds },
        ],
    };

    fn run() -> Vec<Row> {
        vec![
            row("a", "deep", "impinge, in one call", "pairs", 14974.0),
            row("a", "deep", "impinge, in one call", "build median", 0.07),
            row("a", "deep", "impinge, one by one", "build median", 0.08),
            row("a", "deep", "FCL", "build median", 5.17),
            row("a", "far", "impinge, in one call", "ray median", 2.41e-7),
            row("a", "far", "FCL", "ray median", 1.2e-7),
            row("a", "other", "FCL", "hull median", 1.0),
        ]
    }

    #[test]
    fn cases_become_rows_and_engines_columns_with_ratios() {
        let expected = "\
| pose | pairs | build: impinge, in one call, ms | build: impinge, one by one, ms | build: FCL, ms | FCL / impinge | ray: impinge, in one call, ns | ray: FCL, ns | FCL / impinge |
|---|---:|---:|---:|---:|---:|---:|---:|---:|
| deep | 14,974 | 70 | 80 | 5170 | 73.9 |  |  |  |
| far |  |  |  |  |  | 241 | 120 | 0.498 |
";
        assert_eq!(PIVOT.table(&run()), expected);
    }

    #[test]
    fn a_table_with_another_library_in_each_case_names_it_in_a_column() {
        let pivot = Pivot {
            cases: "call",
            ours: "impinge",
            counts: &[],
            times: &[Time { quantity: "call minimum", heading: "", unit: Unit::Microseconds }],
        };
        let run = [
            row("a", "near", "impinge", "call minimum", 2e-6),
            row("a", "near", "FCL", "call minimum", 3e-6),
            row("a", "far", "impinge", "call minimum", 4e-6),
            row("a", "far", "Coal", "call minimum", 1e-6),
        ];
        let expected = "\
| call | impinge, µs | other library | its time, µs | its time / impinge |
|---|---:|---|---:|---:|
| near | 2 | FCL | 3 | 1.5 |
| far | 4 | Coal | 1 | 0.25 |
";
        assert_eq!(pivot.table(&run), expected);
    }

    #[test]
    fn other_libraries_are_compared_and_other_ways_are_not() {
        let run = run();
        let seen: Vec<(&str, &str, &str, String)> = PIVOT
            .compared(&run)
            .into_iter()
            .map(|compared| (compared.case, compared.quantity, compared.peer, digits(compared.ratio())))
            .collect();
        assert_eq!(seen, [("deep", "build", "FCL", "73.9".to_owned()), ("far", "ray", "FCL", "0.498".to_owned())]);
    }

    #[test]
    fn numbers_have_three_digits_and_counts_have_all() {
        assert_eq!([0.0, 1234.5, 0.00008215, 2.5].map(digits), ["0", "1230", "0.0000822", "2.5"]);
        assert_eq!([7.0, 999.0, 1000.0, 2_000_000.0].map(count), ["7", "999", "1,000", "2,000,000"]);
    }
}
