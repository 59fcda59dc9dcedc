//! Tests of the tables of `docs/tasks/files.md`, which list the content that a file may have and
//! the result. Every row has samples.

use std::{collections::HashSet, fs};

use impinge_files::{Format, WarningKind, load};
use tempfile::tempdir;

mod scenes;
mod text;

/// A row of a table, with samples that show that it is true.
pub(crate) struct Dialect {
    /// The format, which names the table.
    pub(crate) format: Format,
    /// The first column: the content of the file.
    pub(crate) what: &'static str,
    /// The second column: the result.
    pub(crate) answer: &'static str,
    /// The samples, each as the name and the content of a file.
    pub(crate) files: Vec<(&'static str, Vec<u8>)>,
    /// The result of loading any of the samples.
    pub(crate) expect: Expect,
}

/// The expected result of loading a file.
pub(crate) enum Expect {
    /// A model with this number of triangles and these warnings.
    Triangles { count: usize, warnings: &'static [WarningKind] },
    /// An error of this kind, by its name.
    Refused(&'static str),
}

fn rows() -> Vec<Dialect> {
    text::rows().into_iter().chain(scenes::rows()).collect()
}

#[test]
fn every_sample_gives_the_result_of_its_row() {
    let folder = tempdir().unwrap();
    let mut wrong = Vec::new();
    for row in rows() {
        assert!(!row.files.is_empty(), "{} without samples", row.what);
        for (name, content) in &row.files {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            let found = load(&path).map(|model| {
                let warnings: Vec<_> = model.warnings.iter().map(|w| w.kind).collect();
                (model.faces.len(), warnings)
            });
            let is_right = match (&found, &row.expect) {
                (Ok((found, kinds)), &Expect::Triangles { count, warnings }) => *found == count && kinds == warnings,
                (Err(error), &Expect::Refused(kind)) => error.kind().name() == kind,
                _ => false,
            };
            if !is_right {
                wrong.push(format!("{}, {}, {name}: {found:?}", row.format, row.what));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The first line of every table.
const HEADER: &str = "| The file has | Result |";

#[test]
fn the_tables_in_the_docs_equal_the_rows() {
    let docs = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/tasks/files.md")).unwrap();
    let rows = rows();
    for format in Format::ALL {
        let lines =
            rows.iter().filter(|row| row.format == format).map(|row| format!("| {} | {} |\n", row.what, row.answer));
        let table: String = lines.collect();
        let Some(section) = docs.split("\n## ").find_map(|section| section.strip_prefix(&format!("{format}\n"))) else {
            assert!(table.is_empty(), "docs/tasks/files.md lacks the section {format} with the rows\n{table}");
            continue;
        };
        let is_row = |line: &&str| line.starts_with("| ") && *line != HEADER;
        let found: String = section.lines().filter(is_row).map(|line| format!("{line}\n")).collect();
        assert!(found == table, "the table of {format} in docs/tasks/files.md must be\n{HEADER}\n|---|---|\n{table}");
    }
}

#[test]
fn rows_are_unique() {
    let mut seen = HashSet::new();
    for row in rows() {
        assert!(seen.insert((row.format, row.what)), "{}: {}", row.format, row.what);
    }
}
