//! Length of source files. A file covers one concept, for which 100 to 400 lines suffice.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use crate::sources;

/// Maximum number of lines without a warning.
const LONG: usize = 400;
/// Maximum number of lines without an error.
const TOO_LONG: usize = 800;

/// Returns the long `.rs` and `.py` files below `root`, each with a message.
pub(crate) fn check(root: &Path) -> Result<Vec<(Verdict, String)>> {
    let mut found = Vec::new();
    for file in sources::files(root, &["rs", "py"])? {
        let text = fs::read_to_string(&file).with_context(|| format!("reading {}", file.display()))?;
        let lines = text.lines().count();
        let shown = file.strip_prefix(root).unwrap_or(&file).display();
        match verdict(lines) {
            Verdict::Fine => {}
            v @ Verdict::Long => {
                found.push((v, format!("warning: {shown}: {lines} lines, more than {LONG}: look for the seam")));
            }
            v @ Verdict::TooLong => {
                found.push((v, format!("error: {shown}: {lines} lines, more than {TOO_LONG}: split it")));
            }
        }
    }
    Ok(found)
}

/// Verdict about the length of a file.
#[derive(Debug, PartialEq)]
pub(crate) enum Verdict {
    /// The length is fine.
    Fine,
    /// The file may stay, but gets a warning.
    Long,
    /// The file fails the check.
    TooLong,
}

fn verdict(lines: usize) -> Verdict {
    if lines > TOO_LONG {
        Verdict::TooLong
    } else if lines > LONG {
        Verdict::Long
    } else {
        Verdict::Fine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_limits_belong_to_the_milder_side() {
        assert_eq!(verdict(400), Verdict::Fine);
        assert_eq!(verdict(401), Verdict::Long);
        assert_eq!(verdict(800), Verdict::Long);
        assert_eq!(verdict(801), Verdict::TooLong);
    }

    #[test]
    fn long_files_are_found_and_build_output_is_not_read() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir(root.path().join("target")).unwrap();
        fs::write(root.path().join("target/generated.rs"), "\n".repeat(900)).unwrap();
        fs::write(root.path().join("long.py"), "\n".repeat(800)).unwrap();
        fs::write(root.path().join("too_long.rs"), "\n".repeat(801)).unwrap();
        let found: Vec<Verdict> = check(root.path()).unwrap().into_iter().map(|(verdict, _)| verdict).collect();
        assert_eq!(found, [Verdict::Long, Verdict::TooLong]);
    }
}
