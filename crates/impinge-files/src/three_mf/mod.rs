//! 3MF (3MF Consortium, *3MF Core Specification* 1.3, and *Production Extension* 1.1 for models in several parts).
//!
//! - What is loaded is the build: every item, its components within components, each with its transform. Transforms are
//!   composed in f64 and applied in f64; then the rule for decimal text holds.
//! - Each instance of an object with triangles is a part, named after the object or else the one around it.
//! - Materials, triangle sets and slices are not looked at. Beams of lattices are left out, with a warning. A file that
//!   requires any other extension is an error.
//! - Parts are UTF-8 or UTF-16. Bytes in errors are counted in the text as UTF-8.

mod build;
mod package;
mod part;
#[cfg(test)]
mod tests;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    instance::Budget,
    model::{Model, stored},
};
use build::{Build, Models};
use package::Package;

/// Reads a package; what it may unpack to is limited by the size of the file that it came in.
pub(crate) fn read(bytes: &[u8], file_size: u64) -> Result<Model, LoadError> {
    let mut package = Package::open(bytes, file_size)?;
    let start = package.start_part()?;
    let models = Models::load(&mut package, start)?;
    let budget = Budget::for_bytes(file_size);
    let Build { positions, parts, faces, .. } = Build::run(&models, budget)?;
    faces.into_model(stored(positions), parts, Some(models.unit()), Format::ThreeMf)
}

/// A byte of a part of the package.
fn in_part(path: &str, offset: u64) -> Place {
    Place::Entry(format!("{path}, byte {offset}"))
}

/// The error that this archive is no 3MF.
fn no_model() -> LoadError {
    let kind = LoadErrorKind::WrongContent { expected: Format::ThreeMf, found: "a ZIP archive without a 3D model" };
    LoadError::new(kind).with_hint("unpack it and load what is inside")
}
