//! Height fields against meshes and other fields: queries about meshes of the faces that are near.
//!
//! A face that is farther from the box of the other thing than a distance is farther from the thing
//! (docs/notes/proof.md, L31). So the answer is that of the whole field.
//!
//! The tests are in `tests/it/shapes/height_fields.rs`.

use super::surfaces::{mesh_of, separation_of_surfaces};
use crate::budget::Budget;
use crate::convex::{Contact, Contacts, Core, Feature, Separation, Surface, Swept};
use crate::math::Pose;
use crate::math::vec3::{length, sub};
use crate::mesh::{Crop, Faces, HeightField};
use crate::query::Proximity;

/// A height field in the world.
pub(super) type Field<'a> = Surface<'a, HeightField>;

/// The distance of things of which one has no faces.
const NOWHERE: Separation =
    Separation { lower: f64::INFINITY, upper: f64::INFINITY, points: [[0.0; 3]; 2], proximity: Proximity::Apart };

/// Returns a mesh of the faces of a height field that may be within `reach` of a surface. Returns
/// `None` if all faces are farther.
pub(super) fn crop_near<F: Faces>(field: &Field<'_>, other: &Surface<'_, F>, reach: f64) -> Option<Crop> {
    field.mesh.crop(field.faces_near_box(other.world_bounds()?, reach))
}

/// Returns meshes of the faces of two height fields that may be within `reach` of each other.
/// Returns `None` if all faces are farther.
pub(super) fn crops_near(a: &Field<'_>, b: &Field<'_>, reach: f64) -> Option<[Crop; 2]> {
    let crop_a = crop_near(a, b, reach)?;
    let crop_b = crop_near(b, &surface_of_crop(&crop_a, a), reach)?;
    Some([crop_a, crop_b])
}

/// Returns a mesh of the faces of a height field that a convex set may touch within a margin, and
/// of all faces as far from its box as the box is large. A deep contact depends on the neighbors of
/// the faces that it touches.
pub(super) fn crop_around(field: &Field<'_>, shape: &Swept<'_>, margin: f64) -> Option<Crop> {
    let [min, max] = shape.world_bounds();
    field.mesh.crop(field.faces_near_box([min, max], margin + length(&sub(&max, &min))))
}

/// Returns the surface of the mesh of some faces.
pub(super) fn surface_of_crop<'c>(crop: &'c Crop, field: &Field<'c>) -> Surface<'c> {
    Surface { mesh: &crop.mesh, pose: field.pose, is_solid: false }
}

/// Computes the distance of a height field and a mesh.
pub(super) fn separation_of_field(field: &Field<'_>, surface: &Surface<'_>, budget: &Budget<'_>) -> Separation {
    let separation = |reach: f64| {
        let crop = crop_near(field, surface, reach)?;
        Some(separation_of_surfaces(crop.mesh.at(*field.pose), mesh_of(surface), budget))
    };
    let Some(reach) = distance_of_box(field, surface) else { return NOWHERE };
    match separation(reach) {
        // A face that was left out may be nearer.
        Some(found) if found.upper > reach => separation(found.upper).unwrap_or(found),
        found => found.unwrap_or(NOWHERE),
    }
}

/// Computes the distance of two height fields.
pub(super) fn separation_of_fields(a: &Field<'_>, b: &Field<'_>, budget: &Budget<'_>) -> Separation {
    let separation =
        |[crop_a, crop_b]: [Crop; 2]| separation_of_surfaces(crop_a.mesh.at(*a.pose), crop_b.mesh.at(*b.pose), budget);
    // Some faces of both give an upper bound.
    let some_faces = || {
        let crop_a = crop_near(a, b, distance_of_box(a, b)?)?;
        let surface_a = surface_of_crop(&crop_a, a);
        let crop_b = crop_near(b, &surface_a, distance_of_box(b, &surface_a)?)?;
        Some([crop_a, crop_b])
    };
    let Some(bound) = some_faces().map(separation) else { return NOWHERE };
    if bound.proximity == Proximity::Intersects {
        return bound;
    }
    crops_near(a, b, bound.upper).map_or(bound, separation)
}

/// Returns an upper bound of the distance of a height field from the box of a surface, or `None` if
/// one of them has no faces.
fn distance_of_box<F: Faces>(field: &Field<'_>, other: &Surface<'_, F>) -> Option<f64> {
    let bounds = other.world_bounds()?;
    let corners: [[f64; 3]; 8] = std::array::from_fn(|i| std::array::from_fn(|k| bounds[i >> k & 1][k]));
    let shape = Swept { core: Core::Points(&corners), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    Some(field.separation(&shape).upper).filter(|upper| upper.is_finite())
}

/// Replaces the names of a crop's features on one side by those of the field.
pub(super) fn rename(contacts: &mut [Contacts], side: usize, crop: &Crop) {
    for Contact { features, .. } in contacts.iter_mut().flat_map(|manifold| &mut manifold.contacts) {
        features[side] = match features[side] {
            Feature::Vertex(vertex) => Feature::Vertex(crop.vertex(vertex)),
            Feature::Edge(p, q) => Feature::Edge(crop.vertex(p), crop.vertex(q)),
            Feature::Face(face) => Feature::Face(crop.face(face)),
        };
    }
}
