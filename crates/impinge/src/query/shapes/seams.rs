//! Contacts at the seams of a compound: between parts that lie side by side.
//!
//! The side of a tile in a floor of tiles is no surface of the floor. A crate that is deeper in the
//! floor than it is over the next tile would be pushed back at the seam if each tile were alone. So
//! a normal that leads from all points of a contact into another part of the same compound is
//! replaced by the normal of a facet that does not.
//!
//! Only convex parts bury others. The test is
//! `a_crate_on_flush_tiles_is_only_lifted` in `tests/it/shapes/mesh_contacts.rs`.

use crate::convex::{self, Contacts, Core, Swept, contacts_along_facets};
use crate::math::Pose;
use crate::math::vec3::{length, sub};
use crate::query::Proximity;
use crate::shape::{Form, PlacedShape};

/// Distance at which the surroundings of a contact point are tested, relative to the smaller part:
/// 2^-16. Parts are flush if the gap between them is less than half of it.
const BESIDE: f64 = 1.0 / (1 << 16) as f64;

/// Returns the contacts of two convex parts of two shapes, along another normal if theirs leads
/// into another part of the same shape.
pub(super) fn across_seams(
    [a, b]: [&PlacedShape; 2],
    [number_a, number_b]: [u32; 2],
    found: Contacts,
    margin: f64,
) -> Contacts {
    if a.parts().len() == 1 && b.parts().len() == 1 {
        return found;
    }
    let (part_a, part_b) = (&a.parts()[number_a as usize], &b.parts()[number_b as usize]);
    let (Form::Convex(swept_a), Form::Convex(swept_b)) = (part_a.form(), part_b.form()) else { return found };
    let step = BESIDE * size(part_a).min(size(part_b));
    let is_buried = |found: &Contacts| {
        let forward = found.normal.map(|x| step * x);
        let on = |side: usize| found.contacts.iter().map(move |contact| contact.points[side]);
        let leads_into = |shape: &PlacedShape, own: u32, side: usize, sign: f64| {
            shape.parts().len() > 1
                && on(side).all(|point| {
                    let beside = std::array::from_fn(|k| point[k] + sign * forward[k]);
                    is_in_another(shape, own, beside, 0.5 * step)
                })
        };
        leads_into(a, number_a, 0, 1.0) || leads_into(b, number_b, 1, -1.0)
    };
    if !is_buried(&found) {
        return found;
    }
    let others = contacts_along_facets(&part_a.faceted(swept_a), &part_b.faceted(swept_b), margin);
    others.into_iter().find(|other| !is_buried(other)).unwrap_or(found)
}

fn size(part: &PlacedShape) -> f64 {
    part.bounds().map_or(f64::INFINITY, |[min, max]| length(&sub(&max, &min)))
}

/// Reports whether a point is within `near` of another convex part than the given one.
fn is_in_another(shape: &PlacedShape, own: u32, point: [f64; 3], near: f64) -> bool {
    let corner = [point];
    let point = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    shape.parts_near(Some([corner[0]; 2]), near).into_iter().filter(|&part| part != own).any(|part| {
        match shape.parts()[part as usize].form() {
            Form::Convex(other) => convex::nearness(&other, &point, near) == Proximity::Intersects,
            Form::HalfSpace(plane) => plane.nearness(&point, near) == Proximity::Intersects,
            Form::Surface(_) => false,
        }
    })
}
