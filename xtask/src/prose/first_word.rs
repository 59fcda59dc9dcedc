//! The first word of a doc comment: a verb for functions, a noun phrase for data.
//!
//! A heuristic: a list of words that begin no verb phrase, and of words that begin no noun phrase.
//! The comment of a test states a fact, so it may begin with any word.

use std::ffi::OsStr;
use std::path::Path;

/// Words that a function's doc comment does not begin with, as the verb comes late or never.
const NO_VERB: [&str; 32] = [
    "A",
    "All",
    "An",
    "Any",
    "As",
    "At",
    "Both",
    "By",
    "Each",
    "Every",
    "Everything",
    "Exact",
    "For",
    "From",
    "How",
    "If",
    "In",
    "Is",
    "Its",
    "No",
    "Of",
    "On",
    "One",
    "Some",
    "That",
    "The",
    "Two",
    "What",
    "Where",
    "Whether",
    "Which",
    "With",
];

/// Words that the doc comment of a type, field or constant does not begin with, as the noun comes
/// late or never.
const NO_NOUN: [&str; 7] = ["As", "Its", "Of", "So", "That", "Those", "What"];

/// Returns the line and a report of each doc comment in a file that begins with another word.
pub(crate) fn faults(file: &Path, text: &str) -> Vec<(usize, String)> {
    match file.extension().and_then(OsStr::to_str) {
        Some("rs") => rust(text),
        Some("py" | "pyi") => python(text),
        _ => Vec::new(),
    }
}

fn rust(text: &str) -> Vec<(usize, String)> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let Some(doc) = line.strip_prefix("/// ") else { continue };
        if at > 0 && lines[at - 1].starts_with("///") {
            continue;
        }
        let end = lines[at..].iter().position(|line| !line.starts_with("//") && !is_attribute(line));
        let Some(end) = end.map(|count| at + count) else { continue };
        if lines[at..end].contains(&"#[test]") {
            continue;
        }
        let is_function = is_function(lines[end]);
        found.extend(fault(doc, is_function).map(|fault| (at + 1, fault)));
    }
    found
}

fn is_attribute(line: &str) -> bool {
    line.starts_with("#[") || line.starts_with(")]") || line.ends_with(")]")
}

fn is_function(item: &str) -> bool {
    let head = item.split(['(', '<']).next().unwrap_or_default();
    head.split_whitespace().any(|word| word == "fn")
}

fn python(text: &str) -> Vec<(usize, String)> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let mut found = Vec::new();
    let (mut is_function, mut is_test) = (false, false);
    for (at, line) in lines.iter().enumerate() {
        if line.starts_with("def ") || line.starts_with("class ") {
            let is_property = at > 0 && lines[at - 1].ends_with("property");
            is_function = line.starts_with("def ") && !is_property;
            is_test = line.starts_with("def test_");
        }
        let follows_head = at > 0 && lines[at - 1].ends_with(':');
        if let Some(doc) = line.strip_prefix("\"\"\"").filter(|_| follows_head && !is_test) {
            found.extend(fault(doc, is_function).map(|fault| (at + 1, fault)));
        }
    }
    found
}

fn fault(doc: &str, is_function: bool) -> Option<String> {
    let first = doc.split(|c: char| !c.is_alphanumeric() && c != '\'').next().unwrap_or_default();
    if is_function && NO_VERB.contains(&first) {
        return Some(format!("\"{first} ...\": begin with a verb, as \"Returns ...\" or \"Reports whether ...\""));
    }
    (!is_function && NO_NOUN.contains(&first))
        .then(|| format!("\"{first} ...\": begin with a noun, as \"Number of ...\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_begin_with_a_verb_and_data_with_a_noun() {
        let text = "/// Any sum.\n#[test]\nfn t() {}\n/// The sum.\n#[must_use]\npub fn sum() {}\n/// The sum.\nstruct Sum;\n/// What it is.\nconst X: u8 = 1;\n/// Returns it.\nfn it() {}\n";
        assert_eq!(rust(text).iter().map(|fault| fault.0).collect::<Vec<_>>(), [4, 9]);
    }

    #[test]
    fn docstrings_of_python_follow_the_same_rule() {
        let text = "def f():\n    \"\"\"Whether it is.\"\"\"\nclass C:\n    \"\"\"A thing.\"\"\"\ndef g():\n    \"\"\"Return it.\"\"\"\n";
        assert_eq!(python(text).iter().map(|fault| fault.0).collect::<Vec<_>>(), [2]);
    }
}
