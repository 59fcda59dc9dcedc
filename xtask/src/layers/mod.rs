//! The layers: a crate depends only on crates before it, a module of `impinge` imports only modules before it.

mod crates;
mod imports;
mod modules;

use std::path::Path;

use anyhow::Result;

use crate::sources::Violation;

/// The crates of the workspace from the bottom up; dev-dependencies are free.
const CRATES: [&str; 7] =
    ["impinge", "impinge-files", "impinge-cli", "impinge-python", "impinge-testkit", "impinge-bench", "xtask"];

/// The modules of `impinge` from the bottom up; tests are free.
const MODULES: [&str; 18] = [
    "input",
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
    "world",
    "character",
    "interop",
];

/// Every dependency and every import of the workspace at `root` that goes against the order.
pub(crate) fn check(root: &Path) -> Result<Vec<Violation>> {
    let mut violations = crates::check(root, &CRATES)?;
    violations.extend(modules::check(&root.join("crates/impinge/src"), root, &MODULES)?);
    Ok(violations)
}
