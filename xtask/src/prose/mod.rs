//! The prose of the project: phrases that readers stumble over, long lines, and doc comments that
//! do not begin with a verb.
//!
//! [`check`] returns each violation, and [`thermometer::measure`] counts words that tell plain
//! English from a dialect. CONTRIBUTING.md has the rules for writers.

mod comments;
mod first_word;
mod phrases;
pub(crate) mod thermometer;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use crate::sources::{self, Violation};
use comments::Line;

/// Maximum length of a line of prose, in characters. Longer lines make diffs hard to read.
const MAX_COLUMNS: usize = 100;

/// Files whose English is history: the changelog, and notes that keep what was measured when.
const EXEMPT: [&str; 2] = ["CHANGELOG.md", "docs/notes"];

/// Returns the broken rules in the comments, docstrings and Markdown files below `root`.
///
/// # Errors
/// If a file cannot be read.
pub(crate) fn check(root: &Path) -> Result<Vec<Violation>> {
    let mut violations = Vec::new();
    for path in sources::files(root, &["rs", "py", "pyi", "md"])? {
        let file = path.strip_prefix(root).unwrap_or(&path);
        if is_exempt(file) {
            continue;
        }
        let text = fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
        let lines = comments::lines(file, &text);
        let found = lines.iter().flat_map(line_faults).chain(first_word::faults(file, &text));
        violations.extend(found.map(|(line, what)| Violation { file: file.to_owned(), line, what }));
    }
    Ok(violations)
}

/// Reports whether a file, given relative to the root, is history or data.
fn is_exempt(file: &Path) -> bool {
    EXEMPT.iter().any(|exempt| file.starts_with(exempt))
}

/// Returns the faults of one line of prose, each with the number of the line.
fn line_faults(line: &Line) -> Vec<(usize, String)> {
    let mut faults: Vec<_> = phrases::found_in(&line.text).map(|fault| (line.number, fault)).collect();
    if line.columns > MAX_COLUMNS && line.can_wrap() {
        faults.push((line.number, format!("{} columns of prose: wrap at {MAX_COLUMNS}", line.columns)));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rule_is_checked_in_rust_python_and_markdown_but_not_in_code() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(root.path().join(name), text).unwrap();
        write(
            "a.rs",
            "/// The sum.\nfn sum() {}\nconst S: &str = \"so many\";\n/// Not so many rows.\nconst N: u8 = 1;\n",
        );
        write("b.py", "def sum():\n    \"\"\"Whether it is.\n\n    So many at hand.\n    \"\"\"\n");
        write("c.md", &format!("{}\n```\nwhoever\n```\n| {} |\n", "word ".repeat(30), "x".repeat(120)));
        let found = check(root.path()).unwrap();
        let places: Vec<(String, usize)> =
            found.iter().map(|fault| (fault.file.display().to_string(), fault.line)).collect();
        let expected = [("a.rs", 4), ("a.rs", 1), ("b.py", 4), ("b.py", 4), ("b.py", 2), ("c.md", 1)];
        assert_eq!(places, expected.map(|(file, line)| (file.to_owned(), line)));
    }
}
