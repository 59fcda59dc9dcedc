//! Contacts at the seams of a surface of several parts: the parts of a compound, or bodies of a
//! world, that lie side by side.
//!
//! The side of a tile in a floor of tiles is no surface of the floor, and its edge is no edge. A
//! crate that is deeper in the floor than it is over the next tile would be pushed back at the seam
//! if each tile were alone. A ball would be pushed back by the edge that it has left. So a normal
//! is buried if it leads from all points of a contact nearer to other parts of the same surface.
//! It is replaced by the normal of a facet that is not buried. Without such a facet the contact is
//! left out, if those other parts have contacts with the same part of the other shape.
//!
//! Only convex parts bury others, and only they are buried. Contacts with half-spaces stay. The
//! tests are `a_crate_on_flush_tiles_is_only_lifted` and the two after it in
//! `tests/it/shapes/mesh_contacts.rs`, and `tests/it/worlds/tiles.rs`.

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

/// A part of a shape. All shapes of a query have different numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Member {
    /// Number of the shape.
    pub(crate) body: u32,
    /// Number of the part in the shape.
    pub(crate) part: u32,
}

/// The parts of a surface: those of one shape, or of several.
pub(crate) trait Surroundings {
    /// Visits the parts beside the part `own` that may be within `near` of a point, in any order.
    /// They may include `own` itself.
    fn for_each_near(&self, own: Member, point: [f64; 3], near: f64, visit: &mut dyn FnMut(Member, &PlacedShape));
}

impl Surroundings for PlacedShape {
    fn for_each_near(&self, own: Member, point: [f64; 3], near: f64, visit: &mut dyn FnMut(Member, &PlacedShape)) {
        if self.parts().len() > 1 {
            for part in self.parts_near(Some([point; 2]), near) {
                visit(Member { part, ..own }, &self.parts()[part as usize]);
            }
        }
    }
}

/// The contacts of two parts.
pub(super) struct OfParts {
    pub(super) members: [Member; 2],
    pub(super) contacts: Contacts,
    /// For each point on either shape the other parts that its normal leads to. Empty if the normal
    /// leads out of both shapes.
    buried_by: [Vec<Vec<Member>>; 2],
}

impl OfParts {
    /// Returns the contacts of two shapes of one part each.
    pub(super) fn alone(contacts: Contacts) -> Self {
        Self { members: [0, 1].map(|body| Member { body, part: 0 }), contacts, buried_by: Default::default() }
    }

    fn is_buried(&self) -> bool {
        self.buried_by.iter().any(|points| !points.is_empty())
    }
}

/// Leaves out contacts that are buried by parts which have contacts themselves, with the same part
/// of the other shape.
pub(super) fn remove_buried(found: &mut Vec<OfParts>) {
    // The surface may be the first shape in one pair and the second in another.
    let pair = |one: Member, other: Member| [one.min(other), one.max(other)];
    let outside: HashSet<[Member; 2]> = found
        .iter()
        .filter(|of_parts| !of_parts.is_buried())
        .map(|of_parts| pair(of_parts.members[0], of_parts.members[1]))
        .collect();
    found.retain(|of_parts| {
        let [a, b] = of_parts.members;
        let is_held = |by: &[Vec<Member>], other: Member| {
            by.iter().all(|parts| parts.iter().any(|&part| outside.contains(&pair(part, other))))
        };
        let [by_a, by_b] = &of_parts.buried_by;
        !(of_parts.is_buried() && is_held(by_a, b) && is_held(by_b, a))
    });
}

/// Finds the parts that bury the contacts of two parts, each in its surroundings. Replaces contacts
/// that are buried by those along the normal of a facet that is not.
pub(super) fn across_seams(
    surroundings: [&dyn Surroundings; 2],
    parts: [&PlacedShape; 2],
    members: [Member; 2],
    contacts: Contacts,
    margin: f64,
) -> OfParts {
    if parts.iter().any(|part| matches!(part.form(), Form::HalfSpace(_))) {
        return OfParts { members, contacts, buried_by: Default::default() };
    }
    let step = BESIDE * size(parts[0]).min(size(parts[1]));
    let compared = |contacts: Contacts| {
        let buried_by = [0, 1].map(|side| match parts[side].form() {
            Form::Convex(_) => buriers(surroundings[side], members[side], &contacts, side, step),
            Form::HalfSpace(_) | Form::Surface(_) | Form::Field(_) => Vec::new(),
        });
        OfParts { members, contacts, buried_by }
    };
    let found = compared(contacts);
    if let (true, Form::Convex(swept_a), Form::Convex(swept_b)) =
        (found.is_buried() && found.contacts.deepest() >= 0.0, parts[0].form(), parts[1].form())
    {
        let others = contacts_along_facets(&parts[0].faceted(swept_a), &parts[1].faceted(swept_b), margin);
        if let Some(other) = others.into_iter().map(compared).find(|other| !other.is_buried()) {
            return other;
        }
    }
    found
}

/// Returns for each contact point of one part the other parts that its normal leads to. Returns no
/// list at all if some point leads to no other part.
fn buriers(
    surroundings: &dyn Surroundings,
    own: Member,
    contacts: &Contacts,
    side: usize,
    step: f64,
) -> Vec<Vec<Member>> {
    let outward = if side == 0 { step } else { -step };
    let mut lists = Vec::new();
    for contact in &contacts.contacts {
        let beside = std::array::from_fn(|k| contact.points[side][k] + outward * contacts.normal[k]);
        let near = others_near(surroundings, own, beside, NEARER * step);
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
fn others_near(surroundings: &dyn Surroundings, own: Member, point: [f64; 3], near: f64) -> Vec<Member> {
    let corner = [point];
    let swept = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    let is_near = |part: &PlacedShape| match part.form() {
        Form::Convex(other) => convex::nearness(&other, &swept, near) == Proximity::Intersects,
        Form::HalfSpace(plane) => plane.nearness(&swept, near) == Proximity::Intersects,
        Form::Surface(_) | Form::Field(_) => false,
    };
    let mut found = Vec::new();
    surroundings.for_each_near(own, point, near, &mut |member, part| {
        if member != own && is_near(part) {
            found.push(member);
        }
    });
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the numbers of contacts that remain, given the numbers of all, each with the part of
    /// the first shape that buries it.
    fn remaining(all: &[([u32; 2], Option<u32>)]) -> Vec<[u32; 2]> {
        let member = |body: u32, part: u32| Member { body, part };
        let of_parts = |&([a, b], buried_by): &([u32; 2], Option<u32>)| OfParts {
            members: [member(0, a), member(1, b)],
            contacts: Contacts { normal: [0.0, 0.0, 1.0], contacts: Vec::new() },
            buried_by: [buried_by.map(|part| vec![member(0, part)]).into_iter().collect(), Vec::new()],
        };
        let mut found: Vec<OfParts> = all.iter().map(of_parts).collect();
        remove_buried(&mut found);
        found.iter().map(|of_parts| of_parts.members.map(|member| member.part)).collect()
    }

    #[test]
    fn a_contact_goes_only_if_the_part_that_buries_it_touches_the_same_part() {
        assert_eq!(remaining(&[([0, 0], None), ([1, 0], Some(0))]), [[0, 0]]);
        // In a corner each part buries the contact of the other. Other feet stand elsewhere.
        let feet = [([0, 0], None), ([0, 2], Some(1)), ([1, 1], None), ([1, 2], Some(0))];
        assert_eq!(remaining(&feet), feet.map(|(numbers, _)| numbers));
    }
}
