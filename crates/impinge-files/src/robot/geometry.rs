//! The elements `visual` and `collision` of a link: shapes with their places.

use super::attributes::Element;
use crate::{
    error::LoadError,
    pieces::{Form, Notes, Piece},
};

/// Reads an element `visual` or `collision`. Returns `None` if it has no shape, with a warning.
pub(super) fn read(element: Element<'_, '_>, notes: &mut Notes<'_>) -> Result<Option<Piece>, LoadError> {
    let tree = element.tree;
    let geometry = element.child("geometry");
    let Some(id) = geometry.and_then(|geometry| tree.children(geometry.id).next()) else {
        notes.add(|| tree.place(element.id), format!("{}: an element without a shape, skipped", element.subject));
        return Ok(None);
    };
    let shape = Element { id, ..element };
    let number = |attribute| shape.numbers::<1>(attribute, None).map(|[x]| x);
    let form = match tree.name(id) {
        "box" => Form::Box(shape.numbers("size", None)?),
        "cylinder" => Form::Cylinder(number("radius")?, number("length")?),
        "sphere" => Form::Sphere(number("radius")?),
        "capsule" => Form::Capsule(number("radius")?, number("length")?),
        "mesh" => Form::File(shape.name("filename")?, shape.numbers("scale", Some([1.0; 3]))?),
        other => return Err(shape.expected("box, cylinder, sphere, capsule or mesh", other)),
    };
    Ok(Some(Piece { form, pose: element.origin()?, element: element.id }))
}
