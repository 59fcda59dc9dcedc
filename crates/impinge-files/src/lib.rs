//! Reads triangle meshes, scenes, rigged characters and robots from files, for [`impinge`].
//! Supported formats are OBJ, STL, PLY, OFF, glTF, 3MF and COLLADA, optionally compressed by gzip,
//! URDF with SRDF for robots, and planning scenes of MoveIt. [Baked] meshes come with their
//! hierarchy.
//!
//! ```no_run
//! let model = impinge_files::load("bunny.obj")?;
//! println!("{} triangles in {} parts", model.faces.len(), model.parts.len());
//! # Ok::<(), impinge_files::LoadError>(())
//! ```
//!
//! # What is read, and how
//! - **Precision.** f32 stays f32 and f64 stays f64. Decimal text without a stated type (OBJ, OFF,
//!   ASCII STL, 3MF, COLLADA) is read as the nearest f64. It is stored as f32 only if that changes
//!   no number. ASCII PLY states its types.
//! - **Transforms** of glTF, 3MF and COLLADA are composed in f64 and rounded once, to the precision
//!   in which the file's vertices are stored. If a transform mirrors, the winding of the triangles
//!   is reversed, so that the outside stays outside.
//! - **Polygons**, also concave ones, become triangles by ear clipping; a convex polygon becomes
//!   the fan about its first corner. A polygon that crosses itself, has no area or is huge also
//!   becomes a fan, and is counted in a warning. A face of one or two corners has no surface: it is
//!   skipped and counted in a warning.
//! - **Triangles** keep the order of the file. Each one records its polygon and its part.
//!   Degenerate triangles are kept, except the joints of triangle strips, which are not part of the
//!   surface.
//! - **Vertices** keep the order of the file, used or not. STL has only corners: corners with
//!   bitwise equal positions become one vertex, where 0.0 equals -0.0. No other format is welded.
//!   In OBJ, PLY and OFF a vertex that no face uses may be NaN or infinite: it is stored at the
//!   position of the first finite vertex and counted in a warning.
//! - **Units.** glTF is in meters, 3MF and COLLADA state their unit, and the other formats have no
//!   unit.
//! - **Axes** are those of the file. Only COLLADA states which axis points up: its meshes are
//!   rotated so that Z points up.
//! - **Content before extension.** The extension must be a known one; its case does not matter. If
//!   the bytes prove another format, the file is read in that format, with a warning. A name
//!   without an extension is accepted if the bytes prove their format.
//! - **Gzip.** A name may end in `.gz` after the extension, as in `part.stl.gz`. It may end in
//!   `.gz` alone if the content proves its format.
//!
//! # Files are not trusted
//! An invalid file gives a [`LoadError`] that names the place, never a panic. Memory and time stay
//! within a multiple of the file's size, even if its counts are wrong. Instances of glTF, 3MF and
//! COLLADA, and the unpacked content of a 3MF or gzip file, may be larger than the file, but are
//! limited. [`Limits`] has the defaults; [`load_with`] and [`load_rig_with`] take others. Only
//! regular files are opened: a pipe or a device may never end. A file without triangles is valid
//! and gives an empty model, unless it has no bytes at all.
//!
//! # Features
//! - `mmap` (default) opens baked files as memory maps. Without it they are read into memory.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod baked;
mod character_file;
mod clash;
mod collada;
mod encoding;
mod error;
mod format;
mod gltf;
mod instance;
mod limits;
#[cfg(not(feature = "mmap"))]
mod memory_copy;
#[cfg(feature = "mmap")]
mod memory_map;
mod model;
mod non_finite;
mod obj;
mod off;
mod packed;
mod pieces;
mod plain;
mod planning_scene;
mod ply;
mod polygon;
mod properties;
mod reading;
mod regular_file;
mod replace;
mod robot;
mod scene;
mod scene_draft;
mod scene_frame;
mod scene_model;
mod stl;
mod text;
mod three_mf;
mod unit;
mod weld;
mod xml;
mod xml_tree;

use std::path::Path;

pub use baked::{Baked, Provenance, write_baked};
pub use character_file::{
    character_text, load_character, load_character_with, load_plan, load_plan_with, parse_character, parse_plan,
};
pub use clash::{
    Asked, InvalidLength, Length, Repaired, ReportAbout, RulesFile, RulesFormat, SceneAbout, bounds_of, length_text,
    load_previous, load_rules, parse_previous, parse_rules, write_clash_csv, write_clash_json,
};
pub use error::{LoadError, LoadErrorKind, Place};
pub use format::Format;
pub use limits::Limits;
pub use model::{Model, Warning, WarningKind};
pub use obj::{ObjPart, write_obj};
pub use pieces::{DescriptionWarning, PieceProblem};
pub use plain::escaped;
pub use planning_scene::{PlanningScene, PlanningSceneOptions, is_planning_scene, load_planning_scene};
pub use ply::write_ply;
pub use regular_file::read_regular_file;
pub use replace::replace_file;
pub use robot::{LoadedRobot, LoadedState, RobotGeometry, RobotGroup, RobotOptions, RobotProblem, load_robot};
pub use scene::{SceneOptions, load_scene, parse_scene};
pub use scene_model::{SceneMesh, SceneModel, ScenePart};
pub use unit::{Conversion, Unit, UnknownUnit};

use collada::Axes;
use impinge::character::Rig;
use limits::OF_FILE;
use model::Warnings;
use reading::Named;

/// Loads the triangles of a file. Detects the format by content, then by extension.
///
/// # Errors
/// Returns an error if the file cannot be read or is not a regular file, its extension is not
/// known, its content is invalid, or a count exceeds the default [`Limits`]
/// ([`TooMany`](LoadErrorKind::TooMany)). The error names the file, the place in it and the problem.
pub fn load(path: impl AsRef<Path>) -> Result<Model, LoadError> {
    load_with(path, &Limits::default())
}

/// Loads the triangles of a file, as [`load`] does, within other limits.
///
/// ```no_run
/// use impinge_files::{Limits, load_with};
///
/// // A file that a stranger sent: no more than 10 million triangles and 1 GB.
/// let model = load_with("part.3mf", &Limits::default().with_max_triangles(10_000_000).with_max_bytes(1 << 30))?;
/// # Ok::<(), impinge_files::LoadError>(())
/// ```
///
/// # Errors
/// Returns an error as [`load`] does, with these limits.
pub fn load_with(path: impl AsRef<Path>, limits: &Limits) -> Result<Model, LoadError> {
    load_with_axes(path.as_ref(), Axes::ZUp, limits)
}

fn load_with_axes(path: &Path, axes: Axes, limits: &Limits) -> Result<Model, LoadError> {
    let load = || {
        let (bytes, named) = reading::read_file(path, limits)?;
        reading::read(&bytes, &named, (path.parent(), axes), limits)
    };
    load().map_err(|e| e.in_file(path))
}

/// Loads the rigged character of a glTF or GLB file: its skeleton, its skin with morph targets, and
/// its animations.
///
/// ```no_run
/// let rig = impinge_files::load_rig("robot.glb")?;
/// println!("{} bones, {} animations", rig.skeleton().bones().len(), rig.animations().len());
/// # Ok::<(), impinge_files::LoadError>(())
/// ```
///
/// # Errors
/// Returns an error as [`load`] does, and if the file has another format. Returns
/// [`BrokenRig`](LoadErrorKind::BrokenRig), which names the node or the accessor, if the character
/// cannot be animated.
pub fn load_rig(path: impl AsRef<Path>) -> Result<Rig, LoadError> {
    load_rig_with(path, &Limits::default())
}

/// Loads a rigged character, as [`load_rig`] does, within other limits.
///
/// # Errors
/// Returns an error as [`load_rig`] does, with these limits.
pub fn load_rig_with(path: impl AsRef<Path>, limits: &Limits) -> Result<Rig, LoadError> {
    let path = path.as_ref();
    let read = || {
        let bytes = read_regular_file(path, limits)?;
        read_rig(&bytes, path.parent(), limits)
    };
    read().map_err(|e| e.in_file(path))
}

/// Reads the rigged character from the bytes of a glTF or GLB file. Other files that the bytes
/// refer to are not read.
///
/// # Errors
/// Returns an error as [`load_rig`] does; the path of the error is empty.
pub fn parse_rig(bytes: &[u8]) -> Result<Rig, LoadError> {
    parse_rig_with(bytes, &Limits::default())
}

/// Reads the rigged character from the bytes of a file, as [`parse_rig`] does, within other limits.
///
/// # Errors
/// Returns an error as [`load_rig_with`] does; the path of the error is empty.
pub fn parse_rig_with(bytes: &[u8], limits: &Limits) -> Result<Rig, LoadError> {
    read_rig(bytes, None, limits)
}

fn read_rig(bytes: &[u8], folder: Option<&Path>, limits: &Limits) -> Result<Rig, LoadError> {
    limits.check_bytes(OF_FILE, bytes.len() as u64)?;
    let unpacked = reading::unpack(bytes, limits, &mut Warnings::default())?;
    let bytes = unpacked.as_deref().unwrap_or(bytes);
    match Format::of_content(bytes).unwrap_or(Format::Gltf) {
        format @ (Format::Gltf | Format::Glb) => gltf::rig::read(bytes, format, folder, limits),
        other => Err(LoadError::unsupported(format!("a rig in a file of format {other}"))),
    }
}

/// Reads the triangles from the bytes of a file. `format` is used unless the bytes prove another
/// format. Other files that the bytes refer to are not read.
///
/// # Errors
/// Returns an error as [`load`] does; the path of the error is empty.
pub fn parse(bytes: &[u8], format: Format) -> Result<Model, LoadError> {
    parse_with(bytes, format, &Limits::default())
}

/// Reads the triangles from the bytes of a file, as [`parse`] does, within other limits.
///
/// # Errors
/// Returns an error as [`load_with`] does; the path of the error is empty.
pub fn parse_with(bytes: &[u8], format: Format, limits: &Limits) -> Result<Model, LoadError> {
    reading::read(bytes, &Named::bytes(Some(format)), (None, Axes::ZUp), limits)
}

/// Reads the triangles from the bytes of a file, whose format must be evident from the bytes. Other
/// files that the bytes refer to are not read.
///
/// # Errors
/// Returns an error as [`load`] does; the path of the error is empty.
pub fn parse_by_content(bytes: &[u8]) -> Result<Model, LoadError> {
    reading::read(bytes, &Named::bytes(None), (None, Axes::ZUp), &Limits::default())
}
