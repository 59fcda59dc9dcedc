//! `cargo xtask performance`: writes `docs/performance.md` from the records of the benchmarks.
//!
//! The page shows one run for each section. The processors in [`PREFERRED`] come first, so that as
//! many sections as possible are of one machine. A test fails if the page is not what the records
//! give.

mod pivot;
mod sections;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use crate::bench::cpu;
use crate::records::{self, Record, Row};
use pivot::{Unit, digits, markdown};
use sections::{SECTIONS, Section};

/// The page, relative to the root of the workspace.
const PAGE: &str = "docs/performance.md";

/// Processors in the order in which the page takes their records. The first has the newest records.
/// Others follow by name.
const PREFERRED: [&str; 4] = ["emerald-rapids", "zen5", "zen4", "zen3"];

const HEAD: &str = "\
# Performance

<!-- Written by `cargo xtask performance` from the records in bench/record. Do not edit it. -->

Each table shows one run of a benchmark, recorded in `bench/record`. Everything runs on one thread
unless a section says otherwise. Every benchmark checks its answers.

A ratio is the time of the other library divided by the time of impinge. If it is above 1, impinge
is faster. [Where it loses](#where-it-loses) lists every row with a ratio below 1.

To repeat a measurement and record it, run `cargo xtask bench NAME`, where NAME is the folder of the
record. `cargo xtask bench --compare` shows what changed since the commit before.
";

/// Writes the page.
///
/// # Errors
/// A record cannot be read, or the page cannot be written.
pub(crate) fn write(root: &Path) -> Result<()> {
    fs::write(root.join(PAGE), page(&records::read_all(root)?)).with_context(|| format!("writing {PAGE}"))?;
    println!("performance: {PAGE} is written");
    Ok(())
}

/// Reports whether the page is what the records give.
///
/// # Errors
/// A record or the page cannot be read.
pub(crate) fn is_current(root: &Path) -> Result<bool> {
    let text = fs::read_to_string(root.join(PAGE)).with_context(|| format!("reading {PAGE}"))?;
    // Git may check text out with other ends of lines.
    Ok(text.replace("\r\n", "\n") == page(&records::read_all(root)?))
}

/// Returns the text of the page. A section without a record is left out.
fn page(records: &[Record]) -> String {
    let shown: Vec<(&Section, &Record, &[Row])> = SECTIONS
        .iter()
        .filter_map(|section| {
            let record = preferred(records.iter().filter(|record| record.bench == section.bench))?;
            Some((section, record, fullest(record)?))
        })
        .collect();
    let mut text = HEAD.to_owned();
    for (section, record, run) in &shown {
        let Some(Row { date, commit, command, .. }) = run.first() else { continue };
        let file = records::path(&record.bench, &record.cpu).display().to_string().replace('\\', "/");
        text += &format!("\n## {}\n\n{}\n\n", section.heading, section.about);
        text += &format!("```sh\n{command}\n```\n\n");
        text += &format!("{}, {date}, commit `{commit}`, from\n`{file}`:\n\n", cpu::name(&record.cpu));
        text += &section.pivot.table(run);
    }
    text + &losses(&shown)
}

/// Returns the section with every row in which another library is faster.
fn losses(shown: &[(&Section, &Record, &[Row])]) -> String {
    let mut columns =
        ["section", "row", "impinge, µs", "peer", "peer, µs", "ratio"].map(|heading| (heading.to_owned(), Vec::new()));
    let mut compared_rows = 0;
    for (section, _, run) in shown {
        for compared in section.pivot.compared(run) {
            compared_rows += 1;
            if compared.ratio() >= 1.0 {
                continue;
            }
            let separator = if compared.quantity.is_empty() { "" } else { ": " };
            let cells = [
                section.heading.to_owned(),
                format!("{}{separator}{}", compared.quantity, compared.case),
                Unit::Microseconds.show(compared.ours),
                compared.peer.to_owned(),
                Unit::Microseconds.show(compared.theirs),
                digits(compared.ratio()),
            ];
            for ((_, column), cell) in columns.iter_mut().zip(cells) {
                column.push(cell);
            }
        }
    }
    let lost = columns[0].1.len();
    format!(
        "\n## Where it loses\n\nThe other library is faster in {lost} of {compared_rows} comparisons:\n\n{}",
        markdown(&columns)
    )
}

/// Returns the record of the first processor in [`PREFERRED`] that has one, or else the first by
/// name. A record whose fullest run has less than half the rows of another one is left out.
fn preferred<'a>(records: impl Iterator<Item = &'a Record>) -> Option<&'a Record> {
    let rows = |record: &Record| fullest(record).map_or(0, <[Row]>::len);
    let records: Vec<&Record> = records.collect();
    let most = records.iter().map(|record| rows(record)).max()?;
    records.into_iter().filter(|record| 2 * rows(record) >= most).min_by_key(|record| {
        let rank = PREFERRED.iter().position(|cpu| *cpu == record.cpu).unwrap_or(PREFERRED.len());
        (rank, &record.cpu)
    })
}

/// Returns the run with the most rows, the newest of them. A run of fewer scenes than the benchmark
/// has does not replace a full one.
fn fullest(record: &Record) -> Option<&[Row]> {
    record.runs().max_by_key(|run| run.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::tests::row;

    #[test]
    fn the_page_is_what_the_records_give() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        assert!(is_current(root).unwrap(), "{PAGE} is not current. Run `cargo xtask performance`.");
    }

    fn record(cpu: &str, rows: Vec<Row>) -> Record {
        Record { bench: "latency".into(), cpu: cpu.into(), rows }
    }

    fn timed(commit: &str, case: &str, ours: f64, theirs: f64) -> [Row; 2] {
        [("impinge", ours), ("python-fcl", theirs)]
            .map(|(engine, value)| row(commit, case, engine, "call median", value))
    }

    #[test]
    fn a_section_shows_the_newest_full_run_of_the_preferred_processor() {
        let full = |commit, ours| [timed(commit, "apart", ours, 3e-6), timed(commit, "near", ours, 1e-6)].concat();
        let runs = [full("first", 1e-6), full("second", 2e-6), timed("partial", "apart", 9e-6, 9e-6).to_vec()];
        let text = page(&[record("aaa", full("other", 1e-6)), record("zen5", runs.concat())]);
        assert!(text.contains("AMD EPYC (Zen 5), date of second, commit `second`, from\n"), "{text}");
        assert!(text.contains("| apart | 2 | 3 | 1.5 |\n| near | 2 | 1 | 0.5 |\n"), "{text}");
        assert!(!text.contains("partial") && !text.contains("other`") && !text.contains("Rays"), "{text}");
    }

    #[test]
    fn a_record_of_few_rows_gives_way_to_a_full_one() {
        let full = ["apart", "near", "far"].map(|case| timed("full", case, 1e-6, 2e-6)).concat();
        let few = |cases: &[&str]| cases.iter().flat_map(|case| timed("few", case, 1e-6, 2e-6)).collect::<Vec<_>>();
        let shown = |cases: &[&str]| page(&[record("emerald-rapids", few(cases)), record("zen3", full.clone())]);
        assert!(shown(&["apart"]).contains("commit `full`") && shown(&["apart", "near"]).contains("commit `few`"));
    }

    #[test]
    fn every_row_with_a_faster_peer_is_listed() {
        let rows = [timed("a", "apart", 2e-6, 3e-6), timed("a", "near", 2e-6, 1e-6)].concat();
        let text = page(&[record("zen5", rows)]);
        let expected = "\
The other library is faster in 1 of 2 comparisons:

| section | row | impinge, µs | peer | peer, µs | ratio |
|---|---|---:|---|---:|---:|
| One call from Python | near | 2 | python-fcl | 1 | 0.5 |
";
        assert!(text.ends_with(expected), "{text}");
    }
}
