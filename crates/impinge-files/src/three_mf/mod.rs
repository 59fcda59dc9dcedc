//! 3MF (3MF Consortium, *3MF Core Specification* 1.3, and *Production Extension* 1.1 for models in
//! several parts).
//!
//! - The build is loaded: every item with its nested components, each with its transform.
//!   Transforms are composed and applied in f64. The positions are then stored as f32 if that is
//!   exact, else as f64, as for all decimal text.
//! - Each instance of an object with triangles is a part, named after the object or else the object
//!   around it.
//! - Materials, triangle sets and slices are ignored. Beams of lattices are skipped, with a
//!   warning. Any other extension that a file requires is an error.
//! - Parts are UTF-8 or UTF-16. Byte offsets in errors refer to the text as UTF-8.

mod build;
mod models;
mod package;
mod part;
#[cfg(test)]
mod tests;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    limits::{Budget, Limits},
    model::{Model, stored},
};
use build::{Budgets, Build};
use models::Models;
use package::Package;

/// Reads a package. Its unpacked size is limited by the size of the file, which may be gzip.
pub(crate) fn read(bytes: &[u8], file_size: u64, limits: &Limits) -> Result<Model, LoadError> {
    let mut package = Package::open(bytes, file_size, limits)?;
    let start = package.start_part()?;
    let models = Models::load(&mut package, start)?;
    let budgets = Budgets { items: Budget::for_bytes(file_size, limits), names: Budget::for_names(file_size, limits) };
    let Build { positions, parts, faces, .. } = Build::run(&models, budgets, limits)?;
    faces.into_model(stored(positions), parts, Some(models.unit()), Format::ThreeMf)
}

/// Returns the place of a byte in a part of the package.
fn in_part(path: &str, offset: u64) -> Place {
    Place::Entry(format!("{path}, byte {offset}"))
}

/// Returns the error that an archive is not a 3MF package.
fn no_model() -> LoadError {
    let kind = LoadErrorKind::WrongContent { expected: Format::ThreeMf, found: "a ZIP archive without a 3D model" };
    LoadError::new(kind).with_hint("unpack it and load what is inside")
}
