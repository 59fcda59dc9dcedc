//! The layers: a crate depends only on crates before it, a module of `impinge` imports only modules
//! before it, and inside a module no two files import each other.

mod circles;
mod crates;
mod files;
mod imports;
mod modules;
mod paths;

use std::path::Path;

use anyhow::Result;

use crate::sources::Violation;

/// Crates of the workspace from the bottom up. Dev-dependencies are free.
const CRATES: [&str; 10] = [
    "impinge",
    "impinge-files",
    "impinge-report",
    "impinge-cli",
    "impinge-python",
    "impinge-testkit",
    "impinge-bench",
    "impinge-examples",
    "impinge-simulation",
    "xtask",
];

/// Modules of `impinge` from the bottom up. Tests are free.
const MODULES: [&str; 22] = [
    "input",
    "budget",
    "storage",
    "simd",
    "math",
    "exact",
    "primitive",
    "hull",
    "volume",
    "hierarchy",
    "partition",
    "mesh",
    "convex",
    "shape",
    "query",
    "sweep",
    "scene",
    "robot",
    "world",
    "character",
    "clash",
    "interop",
];

/// Returns every dependency and every import of the workspace at `root` against the order, and
/// every circle of files.
pub(crate) fn check(root: &Path) -> Result<Vec<Violation>> {
    let mut violations = crates::check(root, &CRATES)?;
    let source = root.join("crates/impinge/src");
    let (files, lost) = files::read(&source)?;
    violations.extend(modules::check(&source, root, (&files, &lost), &MODULES)?);
    violations.extend(circles::check(&files, root));
    Ok(violations)
}
