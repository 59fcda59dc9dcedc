//! Loads the parts of a file as a scene.
//!
//! - Parts of glTF share meshes: each mesh is read once, in its own frame. Each node with a mesh is
//!   a part with a pose, also each instance of `EXT_mesh_gpu_instancing`. A node whose map is no
//!   valid pose, because it is flat or beyond the range of poses, has a mesh of its own.
//! - Of other formats each part that the reader names has a mesh of its own, in the frame of the
//!   scene.
//! - `identity` gives every part a name and a key that no other part has. `names` reads them from a
//!   second file.

mod identity;
mod names;
mod split;

use std::path::{Path, PathBuf};

use crate::{
    collada::Axes,
    error::LoadError,
    format::Format,
    gltf::assembly,
    limits::Limits,
    reading::{Content, Named, read_file},
    scene_frame::SceneFrame,
    scene_model::SceneModel,
    unit::Unit,
};
use names::Names;

/// How to load a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneOptions {
    /// Unit of the scene. If the file states another unit, lengths are converted. A file without a
    /// unit is taken to be in this unit. `None` keeps the unit of the file.
    pub unit: Option<Unit>,
    /// Unit of the numbers in the file, in place of the one that the file states. For files whose
    /// numbers are in millimeters, for example, although glTF is in meters.
    pub file_unit: Option<Unit>,
    /// Point that becomes the origin of the scene, in the frame of the file and the unit of the
    /// scene. It is subtracted in f64, before any coordinate is rounded to f32. So a model far from
    /// the origin, for example in UTM coordinates, keeps its millimeters. `None` subtracts nothing.
    pub origin: Option<[f64; 3]>,
    /// Path of a JSON file with keys, types and names of nodes:
    /// `{"elements": [{"node": "...", "guid": "...", "type": "...", "name": "..."}]}`.
    /// Further fields of an element become extras.
    pub names: Option<PathBuf>,
    /// Limits on the content of the file, and on the file of names. Each mesh counts once, however
    /// many parts share it.
    pub limits: Limits,
}

/// Loads the parts of a file with their poses, names, keys and types.
///
/// A part is named after its node, or else its mesh. If a name is missing or taken, a number is
/// added. The key of a part is, in this order:
///
/// 1. the `guid` of its element in the file of [names](SceneOptions::names);
/// 2. the first of `GlobalId`, `globalId`, `guid` and `id` in the extras of its node;
/// 3. the second half of a name like `IfcWall|2O2Fr$t4X7Zf8NOew3FNr2`;
/// 4. the names of the nodes around it and its own name, joined by `/`.
///
/// If several parts have one of these keys, all but one of them get a number, `#2` and so on, in
/// the order of their places and not of the file. So keys stay the same if other parts are added or
/// the order of the file changes.
///
/// ```no_run
/// use impinge_files::{SceneOptions, load_scene};
///
/// let model = load_scene("building.glb", &SceneOptions::default())?;
/// println!("{} parts share {} meshes", model.parts.len(), model.meshes.len());
/// let scene = model.into_scene(|mesh| mesh.solid().into())?;
/// # Ok::<(), impinge_files::LoadError>(())
/// ```
///
/// # Errors
/// Returns an error as [`load`](crate::load) does, if the file of names cannot be read, or if the
/// origin is not finite.
pub fn load_scene(path: impl AsRef<Path>, options: &SceneOptions) -> Result<SceneModel, LoadError> {
    let path = path.as_ref();
    let names = Names::of(options)?;
    let load = || {
        let (bytes, named) = read_file(path, &options.limits)?;
        read(&bytes, &named, path.parent(), names, options)
    };
    load().map_err(|e| e.in_file(path))
}

/// Reads the parts from the bytes of a file, as [`load_scene`] does. `format` is used unless the
/// bytes prove another format. Other files that the bytes refer to are not read.
///
/// # Errors
/// Returns an error as [`load_scene`] does; the path of an error about the bytes is empty.
pub fn parse_scene(bytes: &[u8], format: Format, options: &SceneOptions) -> Result<SceneModel, LoadError> {
    read(bytes, &Named::bytes(Some(format)), None, Names::of(options)?, options)
}

fn read(
    bytes: &[u8],
    named: &Named,
    folder: Option<&Path>,
    names: Names,
    options: &SceneOptions,
) -> Result<SceneModel, LoadError> {
    let origin = options.origin.unwrap_or_default();
    if origin.iter().any(|x| !x.is_finite()) {
        return Err(LoadError::syntax("a finite origin", format!("{origin:?}").as_bytes()));
    }
    let content = Content::of(bytes, named, &options.limits)?;
    let frame = |stated| SceneFrame::new(options.file_unit.or(stated), options.unit, origin);
    let mut draft = match content.format {
        Format::Gltf | Format::Glb => {
            assembly::read(&content.bytes, content.format, folder, frame(Some(Unit::Meter)), &options.limits)?
        }
        _ => {
            let model = content.triangles((folder, Axes::ZUp), &options.limits)?;
            let frame = frame(model.unit);
            split::by_part(model, frame)?
        }
    };
    let format = content.format;
    draft.warnings.extend(vec![names.unknown(&draft.parts)]);
    let parts = identity::named(&draft.meshes, draft.parts, &names);
    let warnings = content.warnings(draft.warnings.into_vec());
    Ok(SceneModel { meshes: draft.meshes, parts, unit: draft.unit, origin, warnings, format })
}
