//! The dialects of every format: what a file may contain, and what becomes of it. `docs/files.md`
//! has the same tables.

mod scenes;

use std::{collections::BTreeMap, fs, path::Path};

use impinge_files::{Format, WarningKind, load};
use tempfile::tempdir;

/// A row of a table.
pub(crate) struct Dialect {
    /// Which table.
    pub(crate) format: Format,
    /// First column: what a file contains.
    pub(crate) what: &'static str,
    /// Second column: what becomes of it.
    pub(crate) answer: &'static str,
    /// Samples: a name with its extension, and the content.
    pub(crate) files: Vec<(&'static str, Vec<u8>)>,
    /// What loading must give for each sample.
    pub(crate) expect: Expect,
}

pub(crate) enum Expect {
    Triangles {
        count: usize,
        warnings: &'static [WarningKind],
    },
    /// The name of the error's kind.
    Refused(&'static str),
}

fn rows() -> Vec<Dialect> {
    scenes::rows()
}

#[test]
fn every_sample_gives_what_its_row_says() {
    let folder = tempdir().unwrap();
    let mut wrong = Vec::new();
    for Dialect { what, files, expect, .. } in rows() {
        assert!(!files.is_empty(), "{what}: no sample");
        for (name, content) in files {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            match (load(&path), &expect) {
                (Ok(model), Expect::Triangles { count, warnings }) => {
                    let found: Vec<_> = model.warnings.iter().map(|w| w.kind).collect();
                    if (model.faces.len(), &found[..]) != (*count, warnings) {
                        wrong.push(format!("{what} ({name}): {} triangles, {found:?}", model.faces.len()));
                    }
                }
                (Err(e), Expect::Refused(kind)) if e.kind().name() == *kind => {}
                (Err(e), _) => wrong.push(format!("{what} ({name}): {e}")),
                (Ok(_), Expect::Refused(_)) => wrong.push(format!("{what} ({name}): loads")),
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_tables_in_the_documentation_are_the_rows() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/files.md")).unwrap();
    let mut documented: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut format = String::new();
    for line in text.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            format = heading.to_owned();
        } else if line.starts_with("| ") && !line.starts_with("| A file contains") {
            documented.entry(format.clone()).or_default().push(line.to_owned());
        }
    }
    let mut expected: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for Dialect { format, what, answer, .. } in rows() {
        expected.entry(format.to_string()).or_default().push(format!("| {what} | {answer} |"));
    }
    assert_eq!(documented, expected);
}
