//! COLLADA (Khronos, *COLLADA Digital Asset Schema* 1.4.1 and 1.5.0), as robot descriptions use it.
//!
//! - What is loaded is the visual scene that `<scene>` names, or else the first one; without visual
//!   scenes all geometries, with a warning. Each instance of a geometry is a part, named after the
//!   node or else the geometry.
//! - Node transforms are composed in f64 and applied in f64; then the rule for decimal text holds.
//! - The axis that `<up_axis>` names, Y without one, is turned to Z. The unit is the one of
//!   `<unit>`; positions in a unit that [`Unit`] lacks are scaled to metres.
//! - A skinned or morphed mesh is taken as modelled, by its bind shape matrix. Lines and curves are
//!   skipped and counted.

mod geometry;
mod scene;
#[cfg(test)]
mod tests;
mod transform;
mod tree;

use memchr::memmem;

use crate::{
    error::{LoadError, LoadErrorKind},
    format::Format,
    instance::Affine,
    model::{Model, stored},
    text::{number, trim_start, without_bom},
    unit::Unit,
    xml::{self, Encoding},
};
use scene::Scene;
use tree::{Id, Tree};

/// Reports whether the bytes begin as a COLLADA document, in UTF-8 or UTF-16.
pub(crate) fn opens(bytes: &[u8]) -> bool {
    /// Number of bytes in which the root element must begin: room for a comment before it. A longer
    /// comment hides the format, so that the extension decides.
    const HEAD: usize = 4096;
    let head = &bytes[..bytes.len().min(HEAD)];
    let start = head.strip_prefix(b"\xFF\xFE").or(head.strip_prefix(b"\xFE\xFF")).unwrap_or(without_bom(head));
    let start: &[u8] = if start.first() == Some(&0) { &start[1..] } else { trim_start(start) };
    if start.first() != Some(&b'<') {
        return false;
    }
    // Every character of a name is one byte of UTF-8, or one byte and a zero of UTF-16.
    let narrow: Vec<u8> = start.iter().copied().filter(|&byte| byte != 0).collect();
    [&b"<COLLADA"[..], b":COLLADA"].iter().any(|name| memmem::find(&narrow, name).is_some())
}

pub(crate) fn read(bytes: &[u8]) -> Result<Model, LoadError> {
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
        return Err(error.with_hint("supported are 1.4 and 1.5"));
    }
    let (unit, frame) = frame(&tree, root)?;
    let mut scene = Scene::new(&tree, bytes.len() as u64);
    scene.add_all(root, &frame)?;
    let Scene { positions, parts, faces, .. } = scene;
    faces.into_model(stored(positions), parts, Some(unit), Format::Collada)
}

/// Returns the unit of the model, and the map from the document's frame to the model's: Z up, in
/// that unit.
fn frame(tree: &Tree<'_>, root: Id) -> Result<(Unit, Affine), LoadError> {
    let asset = tree.child(root, "asset");
    let of_asset = |name: &str| asset.and_then(|asset| tree.child(asset, name));
    let (unit, scale) = match of_asset("unit") {
        Some(element) => unit(tree, element)?,
        None => (Unit::Metre, 1.0),
    };
    let k = scale;
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

/// Returns the unit of an element `unit`, and the factor to it.
fn unit(tree: &Tree<'_>, element: Id) -> Result<(Unit, f64), LoadError> {
    /// Maximum relative difference between a stated length and that of a unit: lengths are written
    /// from 32-bit floats.
    const TOLERANCE: f64 = 1e-6;
    let Some(text) = tree.attribute(element, "meter") else { return Ok((Unit::Metre, 1.0)) };
    // Some exporters write the decimal comma of their user's language.
    let metres = number(text.trim().replace(',', ".").as_bytes());
    let Some(metres) = metres.filter(|metres| metres.is_finite() && *metres > 0.0) else {
        return Err(LoadError::syntax("a length in metres", text.as_bytes()).at(tree.place(element)));
    };
    let matches = |unit: &Unit| (unit.metres() - metres).abs() <= TOLERANCE * metres;
    Ok(Unit::ALL.into_iter().find(matches).map_or((Unit::Metre, metres), |unit| (unit, 1.0)))
}
