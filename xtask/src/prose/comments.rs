//! The lines of prose in a file: comments of Rust, docstrings and comments of Python, and Markdown
//! outside of code.

use std::ffi::OsStr;
use std::path::Path;

/// A line of prose.
#[derive(Debug, PartialEq)]
pub(crate) struct Line {
    /// Number of the line in its file, counted from one.
    pub(crate) number: usize,
    /// Prose without comment signs; code in backquotes is left out.
    pub(crate) text: String,
    /// Length of the whole line in characters.
    pub(crate) columns: usize,
}

impl Line {
    /// Reports whether the line has a space at which it can wrap: tables, links and long paths have
    /// none.
    pub(crate) fn can_wrap(&self) -> bool {
        let text = self.text.trim();
        text.contains(' ') && !text.starts_with('|') && !text.starts_with('[') && !text.contains("](")
    }
}

/// Returns the lines of prose of a file, by its extension.
pub(crate) fn lines(file: &Path, text: &str) -> Vec<Line> {
    match file.extension().and_then(OsStr::to_str) {
        Some("rs") => outside_of_fences(text, rust_comment),
        Some("md") => outside_of_fences(text, |line| Some(line)),
        _ => python(text),
    }
}

/// Returns the comment of a line of Rust, if it has one: a whole line, or the end of one.
fn rust_comment(line: &str) -> Option<&str> {
    let trimmed = line.trim_start();
    if let Some(rest) = trimmed.strip_prefix("//") {
        return Some(rest.trim_start_matches(['/', '!']));
    }
    // A comment sign after an even number of quotes is not in a string.
    let at = line.find(" // ")?;
    line[..at].matches('"').count().is_multiple_of(2).then(|| &line[at + 4..])
}

/// Returns the lines that `prose` finds something in, outside of blocks of code.
fn outside_of_fences(text: &str, prose: impl Fn(&str) -> Option<&str>) -> Vec<Line> {
    let mut is_code = false;
    let mut found = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let Some(words) = prose(line) else {
            is_code = false;
            continue;
        };
        if words.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            found.push(made(at, line, words));
        }
    }
    found
}

/// Returns the lines of docstrings and comments, without the examples in docstrings.
fn python(text: &str) -> Vec<Line> {
    let (mut is_docstring, mut is_example) = (false, false);
    let mut found = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let quotes = line.matches("\"\"\"").count();
        let trimmed = line.trim_start();
        // The output of an example ends at an empty line.
        is_example = trimmed.starts_with(">>>") || (is_example && !trimmed.is_empty() && quotes == 0);
        if (is_docstring || quotes > 0) && !is_example {
            found.push(made(at, line, &trimmed.replace("\"\"\"", " ")));
        } else if let Some(comment) = trimmed.strip_prefix("# ") {
            found.push(made(at, line, comment));
        }
        is_docstring ^= quotes % 2 == 1;
    }
    found
}

fn made(at: usize, line: &str, words: &str) -> Line {
    // Every second piece between backquotes is code.
    let text = words.split('`').step_by(2).collect::<Vec<_>>().join("`");
    Line { number: at + 1, text, columns: line.chars().count() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(name: &str, text: &str) -> Vec<String> {
        lines(Path::new(name), text).into_iter().map(|line| line.text.trim().to_owned()).collect()
    }

    #[test]
    fn rust_has_comments_of_lines_and_at_their_ends_but_none_in_strings() {
        let text = "//! Head.\nlet a = 1; // why\nlet b = \"no // comment\";\n/// ```\n/// let code = 1;\n/// ```\n// Last `x` word.";
        assert_eq!(texts("a.rs", text), ["Head.", "why", "Last ` word."]);
    }

    #[test]
    fn python_has_docstrings_without_their_examples_and_comments() {
        let text = "\"\"\"Head.\n\nMore.\n>>> 1 + 1\n2\n\"\"\"\nx = 1\n# why\n";
        assert_eq!(texts("a.py", text), ["Head.", "", "More.", "", "why"]);
    }

    #[test]
    fn tables_and_links_cannot_wrap() {
        let lines = lines(Path::new("a.md"), "| a table |\n[a link](target)\nplain words\n");
        assert_eq!(lines.iter().map(Line::can_wrap).collect::<Vec<_>>(), [false, false, true]);
    }
}
