//! Check that `unsafe` is written only in its audited homes, also inside macros.

use std::fs;
use std::path::Path;
use std::str::FromStr;

use anyhow::{Context, Result, anyhow};
use proc_macro2::{TokenStream, TokenTree};
use toml::Value;

use crate::sources::{self, Violation};

/// Modules that may write `unsafe`, each a file or a folder: vector instructions, the memory map of
/// baked files, and bytes that a Python object lends.
const HOMES: [&str; 3] =
    ["crates/impinge/src/simd", "crates/impinge-files/src/memory_map", "crates/impinge-python/src/lent_bytes"];

/// Finds `unsafe`, and lints that would permit it, outside [`HOMES`] in every source file and
/// manifest below `root`.
pub(crate) fn check(root: &Path) -> Result<Vec<Violation>> {
    let mut violations = Vec::new();
    for file in sources::files(root, &["rs", "toml"])? {
        let shown = file.strip_prefix(root).unwrap_or(&file).to_path_buf();
        let text = fs::read_to_string(&file).with_context(|| format!("reading {}", shown.display()))?;
        let mut report = |line, what| violations.push(Violation { file: shown.clone(), line, what });
        if shown.extension().is_some_and(|e| e == "rs") {
            if !is_home(&shown) {
                let tokens = TokenStream::from_str(&text).map_err(|e| anyhow!("{}: {e}", shown.display()))?;
                find_unsafe(tokens, &mut report);
            }
        } else if shown.file_name().is_some_and(|name| name == "Cargo.toml") {
            let manifest: toml::Table = text.parse().with_context(|| format!("reading {}", shown.display()))?;
            if let Some(what) = judge_manifest(&manifest) {
                report(1, what);
            }
        }
    }
    Ok(violations)
}

fn is_home(file: &Path) -> bool {
    HOMES.iter().any(|home| file.starts_with(home) || file.with_extension("") == Path::new(home))
}

fn find_unsafe(tokens: TokenStream, report: &mut impl FnMut(usize, String)) {
    let mut loosening = false; // whether the last token names a lint level that permits
    for token in tokens {
        match &token {
            TokenTree::Ident(ident) if ident == "unsafe" => {
                report(ident.span().start().line, format!("`unsafe` may be written only in {}", HOMES.join(" and ")));
            }
            TokenTree::Group(group) => {
                let lints = group.stream().into_iter();
                if loosening && lints.into_iter().any(|t| matches!(t, TokenTree::Ident(i) if i == "unsafe_code")) {
                    let what = format!("the lint `unsafe_code` may be loosened only in {}", HOMES.join(" and "));
                    report(group.span_open().start().line, what);
                }
                find_unsafe(group.stream(), report);
            }
            _ => {}
        }
        loosening = matches!(&token, TokenTree::Ident(i) if i == "allow" || i == "expect" || i == "warn");
    }
}

/// Returns the fault in the lints of a manifest, or `None`. They must deny `unsafe_code`; `forbid`
/// could not be lifted in the homes.
fn judge_manifest(manifest: &toml::Table) -> Option<String> {
    let lints = |table: &toml::Table| {
        let level = table.get("lints")?.get("rust")?.get("unsafe_code")?;
        level.as_str().or_else(|| level.get("level")?.as_str()).map(str::to_owned)
    };
    let level = match manifest.get("workspace") {
        Some(workspace) => workspace.as_table().and_then(lints),
        None if manifest.get("lints").and_then(|l| l.get("workspace")) == Some(&Value::Boolean(true)) => return None,
        None => lints(manifest),
    };
    match level.as_deref() {
        Some("forbid" | "deny") => None,
        Some(level) => Some(format!("the lint `unsafe_code` is at `{level}`: `deny` it")),
        None => Some("no lint on `unsafe_code`: inherit the lints of the workspace".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(source: &str) -> Vec<usize> {
        let mut lines = Vec::new();
        find_unsafe(source.parse().unwrap(), &mut |line, _| lines.push(line));
        lines
    }

    #[test]
    fn unsafe_is_found_in_code_and_in_macros() {
        assert_eq!(lines("fn f() {\n unsafe { g() }\n}\nmacro_rules! m { () => {\n unsafe { g() } } }"), [2, 5]);
        assert_eq!(lines("// unsafe\n/// unsafe\nfn f() { g(\"unsafe\", is_unsafe) }"), [0; 0]);
    }

    #[test]
    fn a_loosened_lint_is_found_and_a_tightened_one_is_not() {
        assert_eq!(lines("#![allow(unsafe_code)]\n#[expect(missing_docs, unsafe_code)]\nfn f() {}"), [1, 2]);
        assert_eq!(lines("#![forbid(unsafe_code)]\n#![allow(missing_docs)]"), [0; 0]);
    }

    #[test]
    fn a_home_is_a_file_or_a_folder() {
        assert!(is_home(Path::new("crates/impinge/src/simd.rs")));
        assert!(is_home(Path::new("crates/impinge/src/simd/lanes.rs")));
        assert!(!is_home(Path::new("crates/impinge/src/simd_boxes.rs")));
        assert!(!is_home(Path::new("crates/impinge/src/mesh/simd.rs")));
    }

    #[test]
    fn every_manifest_denies_unsafe_code() {
        let passes = |text: &str| judge_manifest(&text.parse().unwrap()).is_none();
        assert!(passes("[lints]\nworkspace = true"));
        assert!(passes("[lints.rust]\nunsafe_code = { level = \"deny\" }"));
        assert!(passes("[workspace.lints.rust]\nunsafe_code = \"forbid\""));
        assert!(!passes("[workspace.lints.rust]\nunsafe_code = \"warn\""));
        assert!(!passes("[lints]\nworkspace = false"));
        assert!(!passes("[lints.rust]\nunsafe_code = \"allow\""));
        assert!(!passes("[package]\nname = \"a\""));
    }
}
