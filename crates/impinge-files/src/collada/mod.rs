//! COLLADA (Khronos, *COLLADA Digital Asset Schema* 1.4.1 and 1.5.0), as robot descriptions use it.
//!
//! - The visual scene that `<scene>` names is loaded, or else the first one. Without visual scenes,
//!   all geometries are loaded, with a warning. Each instance of a geometry is a part, named after
//!   the node or else the geometry.
//! - Node transforms are composed and applied in f64. The positions are then stored as f32 if that
//!   is exact, else as f64, as for all decimal text.
//! - The axis that `<up_axis>` names (Y if it is missing) is rotated to Z. The unit is that of
//!   `<unit>`. Positions in a unit that [`Unit`] lacks are scaled to meters.
//! - A skinned or morphed mesh is loaded as modeled, with its bind shape matrix. Lines and curves
//!   are skipped and counted.

mod geometry;
mod scene;
#[cfg(test)]
mod tests;
mod transform;

use memchr::memmem;

use crate::{
    error::{LoadError, LoadErrorKind},
    format::Format,
    instance::Affine,
    limits::Limits,
    model::{Model, stored},
    text::{number, trim_start, without_bom},
    unit::Unit,
    xml::{self, Encoding},
    xml_tree::{Id, Tree},
};
use scene::Scene;

/// Reports whether the bytes begin as a COLLADA document, in UTF-8 or UTF-16.
pub(crate) fn opens(bytes: &[u8]) -> bool {
    /// Number of bytes in which the root element must begin, with room for a comment before it. If
    /// a comment is longer, the extension decides about the format.
    const HEAD: usize = 4096;
    let head = &bytes[..bytes.len().min(HEAD)];
    let start = head.strip_prefix(b"\xFF\xFE").or(head.strip_prefix(b"\xFE\xFF")).unwrap_or(without_bom(head));
    let start: &[u8] = if start.first() == Some(&0) { &start[1..] } else { trim_start(start) };
    if start.first() != Some(&b'<') {
        return false;
    }
    // Every character of the name is one byte in UTF-8, or one byte and a zero in UTF-16.
    let narrow: Vec<u8> = start.iter().copied().filter(|&byte| byte != 0).collect();
    [&b"<COLLADA"[..], b":COLLADA"].iter().any(|name| memmem::find(&narrow, name).is_some())
}

/// Axes of a loaded model.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Axes {
    /// The up axis that the document names is rotated to Z.
    ZUp,
    /// The axes of the document, whatever its up axis is. Robot descriptions use meshes this way.
    AsWritten,
}

pub(crate) fn read(bytes: &[u8], axes: Axes, limits: &Limits) -> Result<Model, LoadError> {
    let text = xml::decode(bytes.to_vec(), Encoding::UnicodeOrLatin1)?;
    let tree = Tree::parse(&text)?;
    let root = tree.root().filter(|&root| tree.name(root) == "COLLADA").ok_or_else(|| {
        let kind = LoadErrorKind::WrongContent { expected: Format::Collada, found: "text without the element COLLADA" };
        LoadError::new(kind)
    })?;
    if let Some(version) = tree.attribute(root, "version")
        && !["1.4", "1.5"].iter().any(|known| version.trim().starts_with(known))
    {
        let error = LoadError::unsupported(format!("COLLADA version {version:?}")).at(tree.place(root));
        return Err(error.with_hint("supported versions are 1.4 and 1.5"));
    }
    let (unit, frame) = frame(&tree, root, axes)?;
    let mut scene = Scene::new(&tree, bytes.len() as u64, limits);
    scene.add_all(root, &frame)?;
    let Scene { positions, parts, faces, .. } = scene;
    faces.into_model(stored(positions), parts, Some(unit), Format::Collada)
}

/// Returns the unit of the model, and the map from the document's frame to the model's frame: with
/// these axes, in that unit.
fn frame(tree: &Tree<'_>, root: Id, axes: Axes) -> Result<(Unit, Affine), LoadError> {
    let asset = tree.child(root, "asset");
    let of_asset = |name: &str| asset.and_then(|asset| tree.child(asset, name));
    let (unit, scale) = match of_asset("unit") {
        Some(element) => unit(tree, element)?,
        None => (Unit::Meter, 1.0),
    };
    let k = scale;
    if axes == Axes::AsWritten {
        return Ok((unit, Affine { rows: [[k, 0.0, 0.0, 0.0], [0.0, k, 0.0, 0.0], [0.0, 0.0, k, 0.0]] }));
    }
    let rows = match of_asset("up_axis") {
        Some(element) => match tree.text(element).trim() {
            "X_UP" => [[0.0, -k, 0.0, 0.0], [0.0, 0.0, -k, 0.0], [k, 0.0, 0.0, 0.0]],
            "Y_UP" | "" => [[k, 0.0, 0.0, 0.0], [0.0, 0.0, -k, 0.0], [0.0, k, 0.0, 0.0]],
            "Z_UP" => [[k, 0.0, 0.0, 0.0], [0.0, k, 0.0, 0.0], [0.0, 0.0, k, 0.0]],
            other => {
                let error = LoadError::syntax("X_UP, Y_UP or Z_UP", other.as_bytes());
                return Err(error.at(tree.place(element)));
            }
        },
        None => [[k, 0.0, 0.0, 0.0], [0.0, 0.0, -k, 0.0], [0.0, k, 0.0, 0.0]],
    };
    Ok((unit, Affine { rows }))
}

/// Returns the unit of an element `unit`, and the factor that converts lengths to it.
fn unit(tree: &Tree<'_>, element: Id) -> Result<(Unit, f64), LoadError> {
    /// Maximum relative difference between a stated length and that of a unit. Many lengths are
    /// written from 32-bit floats.
    const TOLERANCE: f64 = 1e-6;
    let Some(text) = tree.attribute(element, "meter") else { return Ok((Unit::Meter, 1.0)) };
    // Some exporters write a decimal comma if the user's language has one.
    let meters = number(text.trim().replace(',', ".").as_bytes());
    let Some(meters) = meters.filter(|meters| meters.is_finite() && *meters > 0.0) else {
        return Err(LoadError::syntax("a positive length in meters", text.as_bytes()).at(tree.place(element)));
    };
    let matches = |unit: &Unit| (unit.meters() - meters).abs() <= TOLERANCE * meters;
    Ok(Unit::ALL.into_iter().find(matches).map_or((Unit::Meter, meters), |unit| (unit, 1.0)))
}
