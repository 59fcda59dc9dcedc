//! A thermometer of plain English: how often telltale words occur in 1,000 words of prose.
//!
//! Six well-written peers (parry, memchr, regex-automata, kurbo, Box3D, Jolt) have 7 to 17 of "if"
//! and "when", at most 1.9 of "where", at most 0.8 noun clauses with "what", and 2.8 to 7.8 of
//! "return". The aims follow them.

use std::fmt;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::comments;
use crate::sources;

/// The folders that are measured.
pub(crate) const FOLDERS: [&str; 3] = ["crates/impinge/src", "docs", "python/impinge"];

/// A group of words and the aim for it.
const GROUPS: [Group; 5] = [
    Group { name: "if, when", words: &["if", "when"], aim: Aim::AtLeast(7.0) },
    Group { name: "where", words: &["where"], aim: Aim::AtMost(2.0) },
    Group { name: "what", words: &["what"], aim: Aim::AtMost(1.5) },
    Group { name: "return", words: &["return", "returns"], aim: Aim::AtLeast(3.0) },
    Group {
        name: "check, valid",
        words: &["check", "checks", "checked", "valid", "validate", "validates", "validated", "invalid"],
        aim: Aim::AtLeast(1.0),
    },
];

/// Words that are counted together.
struct Group {
    name: &'static str,
    words: &'static [&'static str],
    aim: Aim,
}

/// How often the words of a group should occur, in 1,000 words of prose.
#[derive(Clone, Copy)]
enum Aim {
    AtLeast(f64),
    AtMost(f64),
}

/// The frequency of each group of words in a folder.
pub(crate) struct Reading {
    folder: String,
    words: usize,
    /// How often the words of each group occur in 1,000 words, in the order of the groups.
    frequencies: Vec<f64>,
}

/// Counts the words in the prose below a folder.
///
/// # Errors
/// If a file cannot be read.
pub(crate) fn measure(root: &Path, folder: &str) -> Result<Reading> {
    let mut words = Vec::new();
    for path in sources::files(&root.join(folder), &["rs", "py", "pyi", "md"])? {
        if super::is_exempt(path.strip_prefix(root).unwrap_or(&path)) {
            continue;
        }
        let text = fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
        for line in comments::lines(&path, &text) {
            let split = line.text.split(|c: char| !c.is_alphabetic() && c != '\'');
            words.extend(split.filter(|word| !word.is_empty()).map(str::to_lowercase));
        }
    }
    let count = |group: &Group| words.iter().filter(|word| group.words.contains(&word.as_str())).count();
    let total = words.len().max(1) as f64;
    let frequencies = GROUPS.iter().map(|group| 1000.0 * count(group) as f64 / total).collect();
    Ok(Reading { folder: folder.to_owned(), words: words.len(), frequencies })
}

impl fmt::Display for Reading {
    /// Writes one line; a frequency that misses its aim is followed by the aim.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:20} {:7} words", self.folder, self.words)?;
        for (group, &frequency) in GROUPS.iter().zip(&self.frequencies) {
            write!(f, "   {} {frequency:.1}", group.name)?;
            match group.aim {
                Aim::AtLeast(aim) if frequency < aim => write!(f, " (aim: at least {aim})")?,
                Aim::AtMost(aim) if frequency > aim => write!(f, " (aim: at most {aim})")?,
                _ => {}
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_counted_in_a_thousand_and_missed_aims_are_shown() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("a.rs"), "/// Returns what is where if it is.\nlet what = 1;\n").unwrap();
        let reading = measure(root.path(), "").unwrap();
        assert_eq!(reading.words, 7);
        let shown = reading.to_string();
        assert!(shown.contains("where 142.9 (aim: at most 2)"), "{shown}");
        assert!(shown.contains("return 142.9   check"), "{shown}");
    }
}
