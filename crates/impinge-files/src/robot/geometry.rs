//! The elements `visual` and `collision` of a link: shapes with their places.

use impinge::Pose;

use super::{attributes::Element, warning::Notes};
use crate::{error::LoadError, xml_tree::Id};

/// A shape of a link.
pub(super) struct Piece {
    pub(super) form: Form,
    pub(super) link_from_piece: Pose,
    pub(super) element: Id,
}

/// A shape as it is written in the file.
pub(super) enum Form {
    /// Full lengths of the edges.
    Box([f64; 3]),
    /// A cylinder about z: its radius and its full length.
    Cylinder(f64, f64),
    Sphere(f64),
    /// A capsule about z: its radius, and the length of the cylinder between its ends.
    Capsule(f64, f64),
    /// A mesh: its reference and its scale.
    Mesh(String, [f64; 3]),
}

/// Reads an element `visual` or `collision`. Returns `None` if it has no shape, with a warning.
pub(super) fn read(element: Element<'_, '_>, notes: &mut Notes<'_>) -> Result<Option<Piece>, LoadError> {
    let tree = element.tree;
    let geometry = element.child("geometry");
    let Some(id) = geometry.and_then(|geometry| tree.children(geometry.id).next()) else {
        notes.add(tree, element.id, format!("{}: an element without a shape, skipped", element.subject));
        return Ok(None);
    };
    let shape = Element { id, ..element };
    let number = |attribute| shape.numbers::<1>(attribute, None).map(|[x]| x);
    let form = match tree.name(id) {
        "box" => Form::Box(shape.numbers("size", None)?),
        "cylinder" => Form::Cylinder(number("radius")?, number("length")?),
        "sphere" => Form::Sphere(number("radius")?),
        "capsule" => Form::Capsule(number("radius")?, number("length")?),
        "mesh" => Form::Mesh(shape.name("filename")?, shape.numbers("scale", Some([1.0; 3]))?),
        other => return Err(shape.expected("box, cylinder, sphere, capsule or mesh", other)),
    };
    Ok(Some(Piece { form, link_from_piece: element.origin()?, element: element.id }))
}
