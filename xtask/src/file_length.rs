//! The length of source files: a file is one concept, and 100 to 400 lines hold one.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use crate::sources;

/// Lines past which a file is named, so that its reader looks for the seam.
const LONG: usize = 400;
/// Lines past which a file fails the check.
const TOO_LONG: usize = 800;

/// Names the `.rs` and `.py` files below `root` that are long; whether none is too long.
pub(crate) fn check(root: &Path) -> Result<bool> {
    let mut fine = true;
    let files = sources::files(root, &["rs", "py"])?;
    for file in &files {
        let text = fs::read_to_string(file).with_context(|| format!("reading {}", file.display()))?;
        let shown = file.strip_prefix(root).unwrap_or(file).display();
        match verdict(text.lines().count()) {
            Verdict::Fine => {}
            Verdict::Long(lines) => println!("warning: {shown}: {lines} lines, more than {LONG}: look for the seam"),
            Verdict::TooLong(lines) => {
                println!("error: {shown}: {lines} lines, more than {TOO_LONG}: split it");
                fine = false;
            }
        }
    }
    println!("file-length: {} files read", files.len());
    Ok(fine)
}

#[derive(Debug, PartialEq)]
enum Verdict {
    Fine,
    Long(usize),
    TooLong(usize),
}

fn verdict(lines: usize) -> Verdict {
    if lines > TOO_LONG {
        Verdict::TooLong(lines)
    } else if lines > LONG {
        Verdict::Long(lines)
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
        assert_eq!(verdict(401), Verdict::Long(401));
        assert_eq!(verdict(800), Verdict::Long(800));
        assert_eq!(verdict(801), Verdict::TooLong(801));
    }

    #[test]
    fn a_file_too_long_fails_and_build_output_does_not_count() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir(root.path().join("target")).unwrap();
        fs::write(root.path().join("target/generated.rs"), "\n".repeat(900)).unwrap();
        fs::write(root.path().join("long.py"), "\n".repeat(800)).unwrap();
        assert!(check(root.path()).unwrap());
        fs::write(root.path().join("too_long.py"), "\n".repeat(801)).unwrap();
        assert!(!check(root.path()).unwrap());
    }
}
