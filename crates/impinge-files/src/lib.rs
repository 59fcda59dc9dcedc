//! Triangle meshes from files, for [`impinge`]: OBJ, STL, PLY, OFF, glTF and 3MF; and [baked](Baked) meshes, which
//! bring their hierarchy.
//!
//! ```no_run
//! let model = impinge_files::load("bunny.obj")?;
//! println!("{} triangles in {} parts", model.faces.len(), model.parts.len());
//! # Ok::<(), impinge_files::LoadError>(())
//! ```
//!
//! # What is read, and how
//! - **Precision.** f32 stays f32 and f64 stays f64. Decimal text of no stated type (OBJ, OFF, ASCII STL, 3MF) is read as
//!   the nearest f64 to each number, and stored as f32 only where that changes not one of them. ASCII PLY states types.
//! - **Transforms** of glTF and 3MF are composed in f64 and rounded once, to the precision in which the file's vertices
//!   are stored. Where a transform mirrors, the triangles' winding is turned, so that outside stays outside.
//! - **Polygons** become triangles by ear clipping, concave ones too; a convex one is the fan about its first corner.
//!   A polygon that crosses itself, has no area or is huge becomes a fan as well, and is counted in a warning. A face of
//!   one or two corners has no surface: it is skipped, and counted in a warning.
//! - **Triangles** keep the order of the file; each remembers its polygon and its part. Degenerate ones are kept, except
//!   the joints of triangle strips, which are not part of the surface.
//! - **Vertices** keep the order of the file, used or not. STL has corners only: bitwise equal ones (and 0.0 and -0.0)
//!   become one vertex. No other format is welded. In OBJ, PLY and OFF a vertex that no face uses may be NaN or infinite:
//!   it is stored at the position of the first finite vertex, and counted in a warning.
//! - **Units.** glTF is in metres, 3MF states its unit, the others state none.
//! - **Content before extension.** The extension, in any case, must be a known one. Where the bytes prove another format,
//!   they are read as what they are, with a warning.
//!
//! # Files are not trusted
//! A broken file is a [`LoadError`] that names the place, never a panic. Memory and time stay within a multiple of the
//! file's size, even where its counts lie. Instances of glTF and 3MF, and what is packed in a 3MF, may be larger than the
//! file, but not without limit. A file without triangles is a valid, empty one, unless it has no bytes at all.

mod baked;
mod character_file;
mod encoding;
mod error;
mod format;
mod gltf;
mod instance;
mod memory_map;
mod model;
mod non_finite;
mod obj;
mod off;
mod ply;
mod polygon;
mod stl;
mod text;
mod three_mf;
mod unit;
mod weld;

use std::{fs::File, io::Read, path::Path};

pub use baked::{Baked, Provenance, write_baked};
pub use character_file::{character_text, load_character, load_plan, parse_character, parse_plan};
pub use error::{LoadError, LoadErrorKind, Place};
pub use format::Format;
pub use model::{Model, Warning, WarningKind};
pub use ply::write_ply;
pub use unit::{Unit, UnknownUnit};

use impinge::character::Rig;
use model::Warnings;

/// Loads the triangles of a file.
///
/// # Errors
/// Where the file cannot be read, its extension names no known format, or its content breaks the format's rules: the
/// error names the file, the place in it and what is wrong.
pub fn load(path: impl AsRef<Path>) -> Result<Model, LoadError> {
    let path = path.as_ref();
    load_file(path).map_err(|e| e.in_file(path))
}

fn load_file(path: &Path) -> Result<Model, LoadError> {
    let mut file = File::open(path).map_err(|e| LoadError::io(&e))?;
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let Some(format) = Format::from_extension(&extension) else {
        return Err(LoadError::new(LoadErrorKind::UnsupportedFormat { extension: extension.into_owned() }));
    };
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|e| LoadError::io(&e))?;
    read(&bytes, format, path.parent())
}

/// Loads the rigged character of a glTF or GLB file: its skeleton, its skin with morph targets, and its animations.
///
/// ```no_run
/// let rig = impinge_files::load_rig("robot.glb")?;
/// println!("{} bones, {} animations", rig.skeleton().bones().len(), rig.animations().len());
/// # Ok::<(), impinge_files::LoadError>(())
/// ```
///
/// # Errors
/// As [`load`], for another format, and [`BrokenRig`](LoadErrorKind::BrokenRig) for what cannot be animated: it names the
/// node or the accessor.
pub fn load_rig(path: impl AsRef<Path>) -> Result<Rig, LoadError> {
    let path = path.as_ref();
    let read = || {
        let bytes = std::fs::read(path).map_err(|e| LoadError::io(&e))?;
        read_rig(&bytes, path.parent())
    };
    read().map_err(|e| e.in_file(path))
}

/// Reads the rigged character of the bytes of a glTF or GLB file. Other files that it names are not read.
///
/// # Errors
/// As [`load_rig`]; the error's path is empty.
pub fn parse_rig(bytes: &[u8]) -> Result<Rig, LoadError> {
    read_rig(bytes, None)
}

fn read_rig(bytes: &[u8], folder: Option<&Path>) -> Result<Rig, LoadError> {
    if bytes.is_empty() {
        return Err(LoadError::new(LoadErrorKind::Empty));
    }
    match Format::of_content(bytes).unwrap_or(Format::Gltf) {
        format @ (Format::Gltf | Format::Glb) => gltf::rig::read(bytes, format, folder),
        other => Err(LoadError::unsupported(format!("a rig in a file of format {other}"))),
    }
}

/// Reads the triangles of a file's bytes, which should be of this format. Other files that they name are not read.
///
/// # Errors
/// As [`load`]; the error's path is empty.
pub fn parse(bytes: &[u8], format: Format) -> Result<Model, LoadError> {
    read(bytes, format, None)
}

/// Other files that the content names lie in `folder`.
fn read(bytes: &[u8], format: Format, folder: Option<&Path>) -> Result<Model, LoadError> {
    if bytes.is_empty() {
        return Err(LoadError::new(LoadErrorKind::Empty));
    }
    let actual = Format::of_content(bytes).unwrap_or(format);
    let mut model = match actual {
        Format::Obj => obj::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Ply => ply::read(bytes),
        Format::Off => off::read(bytes),
        Format::Gltf | Format::Glb => gltf::read(bytes, actual, folder),
        Format::ThreeMf => three_mf::read(bytes),
        Format::Baked => baked::read(bytes),
    }?;
    if actual != format {
        let mut warnings = Warnings::default();
        warnings.add(WarningKind::OtherExtension, 1, || None);
        model.warnings.splice(0..0, warnings.into_vec());
    }
    Ok(model)
}
