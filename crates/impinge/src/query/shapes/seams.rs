//! Contacts at the seams of a compound: between parts that lie side by side.
//!
//! The side of a tile in a floor of tiles is no surface of the floor, and its edge is no edge. A
//! crate that is deeper in the floor than it is over the next tile would be pushed back at the seam
//! if each tile were alone. A ball would be pushed back by the edge that it has left. So a normal
//! is buried if it leads from all points of a contact nearer to other parts of the same compound.
//! It is replaced by the normal of a facet that is not buried. Without such a facet the contact is
//! left out, if those other parts have contacts with the same part of the other shape.
//!
//! Only convex parts bury others, and only they are buried. Contacts with half-spaces stay. The
//! tests are `a_crate_on_flush_tiles_is_only_lifted` and the two after it in
//! `tests/it/shapes/mesh_contacts.rs`.

use std::collections::HashSet;

use crate::convex::{self, Contacts, Core, Swept, contacts_along_facets};
use crate::math::Pose;
use crate::math::vec3::{length, sub};
use crate::query::Proximity;
use crate::shape::{Form, PlacedShape};

/// Distance at which the surroundings of a contact point are tested, relative to the smaller part:
/// 2^-16. Parts are flush if the gap between them is less than that.
const BESIDE: f64 = 1.0 / (1 << 16) as f64;

/// Part of that distance within which another part is nearer than the contact point: a normal may
/// lean by up to 0.1 degrees.
const NEARER: f64 = 1.0 - 1.0 / (1 << 20) as f64;

/// The contacts of two parts, which are given by their numbers.
pub(super) struct OfParts {
    pub(super) numbers: [u32; 2],
    pub(super) contacts: Contacts,
    /// For each point on either shape the other parts that its normal leads to. Empty if the normal
    /// leads out of both shapes.
    buried_by: [Vec<Vec<u32>>; 2],
}

impl OfParts {
    /// Returns the contacts of two shapes of one part each.
    pub(super) fn alone(contacts: Contacts) -> Self {
        Self { numbers: [0; 2], contacts, buried_by: Default::default() }
    }

    fn is_buried(&self) -> bool {
        self.buried_by.iter().any(|points| !points.is_empty())
    }
}

/// Leaves out contacts that are buried by parts which have contacts themselves, with the same part
/// of the other shape.
pub(super) fn remove_buried(found: &mut Vec<OfParts>) {
    let outside: HashSet<[u32; 2]> =
        found.iter().filter(|of_parts| !of_parts.is_buried()).map(|of_parts| of_parts.numbers).collect();
    found.retain(|of_parts| {
        let [a, b] = of_parts.numbers;
        let [by_a, by_b] = &of_parts.buried_by;
        let is_held = by_a.iter().all(|parts| parts.iter().any(|&part| outside.contains(&[part, b])))
            && by_b.iter().all(|parts| parts.iter().any(|&part| outside.contains(&[a, part])));
        !of_parts.is_buried() || !is_held
    });
}

/// Finds the parts that bury the contacts of two parts of two shapes. Replaces contacts that are
/// buried by those along the normal of a facet that is not.
pub(super) fn across_seams(shapes: [&PlacedShape; 2], numbers: [u32; 2], contacts: Contacts, margin: f64) -> OfParts {
    let parts = [0, 1].map(|side| &shapes[side].parts()[numbers[side] as usize]);
    if parts.iter().any(|part| matches!(part.form(), Form::HalfSpace(_))) {
        return OfParts { numbers, contacts, buried_by: Default::default() };
    }
    let step = BESIDE * size(parts[0]).min(size(parts[1]));
    let judged = |contacts: Contacts| {
        let buried_by = [0, 1].map(|side| buriers(shapes[side], numbers[side], &contacts, side, step));
        OfParts { numbers, contacts, buried_by }
    };
    let found = judged(contacts);
    if let (true, Form::Convex(swept_a), Form::Convex(swept_b)) =
        (found.is_buried() && found.contacts.deepest() >= 0.0, parts[0].form(), parts[1].form())
    {
        let others = contacts_along_facets(&parts[0].faceted(swept_a), &parts[1].faceted(swept_b), margin);
        if let Some(other) = others.into_iter().map(judged).find(|other| !other.is_buried()) {
            return other;
        }
    }
    found
}

/// Returns for each contact point of one part the other parts of the shape that its normal leads
/// to. Returns no list at all if some point leads to no other part.
fn buriers(shape: &PlacedShape, own: u32, contacts: &Contacts, side: usize, step: f64) -> Vec<Vec<u32>> {
    if shape.parts().len() == 1 || !matches!(shape.parts()[own as usize].form(), Form::Convex(_)) {
        return Vec::new();
    }
    let outward = if side == 0 { step } else { -step };
    let mut lists = Vec::new();
    for contact in &contacts.contacts {
        let beside = std::array::from_fn(|k| contact.points[side][k] + outward * contacts.normal[k]);
        let near = others_near(shape, own, beside, NEARER * step);
        if near.is_empty() {
            return Vec::new();
        }
        lists.push(near);
    }
    lists
}

fn size(part: &PlacedShape) -> f64 {
    part.bounds().map_or(f64::INFINITY, |[min, max]| length(&sub(&max, &min)))
}

/// Returns the parts other than the given one that are within `near` of a point: convex parts and
/// half-spaces.
fn others_near(shape: &PlacedShape, own: u32, point: [f64; 3], near: f64) -> Vec<u32> {
    let corner = [point];
    let point = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    let is_near = |part: u32| match shape.parts()[part as usize].form() {
        Form::Convex(other) => convex::nearness(&other, &point, near) == Proximity::Intersects,
        Form::HalfSpace(plane) => plane.nearness(&point, near) == Proximity::Intersects,
        Form::Surface(_) | Form::Field(_) => false,
    };
    shape.parts_near(Some([corner[0]; 2]), near).into_iter().filter(|&part| part != own && is_near(part)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the numbers of contacts that remain, given the numbers of all, each with the part of
    /// the first shape that buries it.
    fn remaining(all: &[([u32; 2], Option<u32>)]) -> Vec<[u32; 2]> {
        let of_parts = |&(numbers, buried_by): &([u32; 2], Option<u32>)| OfParts {
            numbers,
            contacts: Contacts { normal: [0.0, 0.0, 1.0], contacts: Vec::new() },
            buried_by: [buried_by.map(|part| vec![part]).into_iter().collect(), Vec::new()],
        };
        let mut found: Vec<OfParts> = all.iter().map(of_parts).collect();
        remove_buried(&mut found);
        found.iter().map(|of_parts| of_parts.numbers).collect()
    }

    #[test]
    fn a_contact_goes_only_if_the_part_that_buries_it_touches_the_same_part() {
        assert_eq!(remaining(&[([0, 0], None), ([1, 0], Some(0))]), [[0, 0]]);
        // In a corner each part buries the contact of the other. Other feet stand elsewhere.
        let feet = [([0, 0], None), ([0, 2], Some(1)), ([1, 1], None), ([1, 2], Some(0))];
        assert_eq!(remaining(&feet), feet.map(|(numbers, _)| numbers));
    }
}
