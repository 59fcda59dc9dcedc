//! Source files of one crate, found by following the `mod` lines from its `lib.rs`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::imports::Imports;

/// Source file of a crate.
pub(super) struct SourceFile {
    /// Path of the file.
    pub(super) path: PathBuf,
    /// Path of its module from the root of the crate; empty for `lib.rs`.
    pub(super) module: Vec<String>,
    /// Parsed source.
    pub(super) syntax: syn::File,
    /// Imports, and modules that the source declares.
    pub(super) imports: Imports,
}

/// `mod` line whose file is missing or moved by a `path` attribute.
pub(super) struct LostFile {
    /// File with the `mod` line.
    pub(super) declared_in: PathBuf,
    /// Line of the `mod`, counted from one.
    pub(super) line: usize,
    /// Path of the declared module from the root of the crate.
    pub(super) module: Vec<String>,
}

/// Reads the crate whose `lib.rs` lies in `source`. Returns its files, `lib.rs` first, and the
/// modules whose files are not where their names say. Modules compiled only for tests are skipped.
pub(super) fn read(source: &Path) -> Result<(Vec<SourceFile>, Vec<LostFile>)> {
    let (mut files, mut lost) = (Vec::new(), Vec::new());
    let mut pending = vec![(source.join("lib.rs"), Vec::new())];
    while let Some((path, module)) = pending.pop() {
        let text = fs::read_to_string(&path).with_context(|| format!("reading {}", path.display()))?;
        let syntax = syn::parse_file(&text).with_context(|| format!("parsing {}", path.display()))?;
        let imports = Imports::of(&syntax, &module);
        for child in &imports.children {
            match find_source(&path, &module, &child.module) {
                Some(found) if !child.moved => pending.push((found, child.module.clone())),
                _ => lost.push(LostFile { declared_in: path.clone(), line: child.line, module: child.module.clone() }),
            }
        }
        files.push(SourceFile { path, module, syntax, imports });
    }
    Ok((files, lost))
}

/// Returns the file of module `child`, which is declared in `file`, the source of `module`.
fn find_source(file: &Path, module: &[String], child: &[String]) -> Option<PathBuf> {
    let stem = file.file_stem()?;
    let owns_folder = stem == "lib" || stem == "mod";
    let mut base = if owns_folder { file.parent()?.to_path_buf() } else { file.with_extension("") };
    base.extend(&child[module.len()..]);
    [base.with_extension("rs"), base.join("mod.rs")].into_iter().find(|f| f.is_file())
}
