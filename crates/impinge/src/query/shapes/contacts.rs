//! Contacts of two things: where they touch or overlap, as a contact solver needs it.

use super::fields::{Field, crop_around, crop_near, crops_near, rename, surface_of_crop};
use super::seams::{Member, OfParts, Surroundings, across_seams, remove_buried};
use super::search::depth_by_search;
use super::surfaces::surface_of;
use super::table::{are_boxes_farther, nearness_of_parts, pairs_near};
use crate::budget::Budget;
pub use crate::convex::Feature;
use crate::convex::{self, Contact, Contacts, Depth, Surface, to_unit_length as unit};
use crate::query::placed::Placed;
use crate::query::{ContactOptions, Proximity, Query, contacts_of_patches, of_meshes};
use crate::shape::{Form, PlacedShape};

/// Contacts of two things, or of one part of each, that share one normal.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifold {
    /// Direction of length 1 from the first thing to the second, in the world frame, rounded.
    pub normal: [f64; 3],
    /// Contact points in the order of their ids; at least one.
    pub points: Vec<ContactPoint>,
}

/// Contact point: one point of each thing, one above the other along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Point of the first thing in the world frame, each coordinate rounded.
    pub point_a: [f64; 3],
    /// Point of the second thing in the world frame, each coordinate rounded.
    pub point_b: [f64; 3],
    /// Lower bound of the depth here, in world units: the first thing reaches at least this far
    /// beyond the second along the normal. It is negative if there is a gap here, and infinite for
    /// two half-spaces that no motion separates.
    pub lower: f64,
    /// Upper bound of the depth here, in world units.
    pub upper: f64,
    /// Parts and features of the two things that the contact belongs to.
    pub id: ContactId,
}

/// Identity of a contact: the parts and features that touch. It stays the same from one query to
/// the next as long as the contact exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContactId {
    /// Index of the part of the first thing; 0 if it has only one part.
    pub part_a: u32,
    /// Index of the part of the second thing; 0 if it has only one part.
    pub part_b: u32,
    /// Corner, edge or face of the part of the first thing.
    pub feature_a: Feature,
    /// Corner, edge or face of the part of the second thing.
    pub feature_b: Feature,
}

/// Computes the contacts of two things: points, normals and depths in the world frame.
///
/// The list is empty if and only if [`intersects`](crate::query::intersects()) returns `false`.
/// With a margin ([`Query::with_contacts`]) it is empty if and only if
/// [`within`](crate::query::within()) returns `false` for the margin. The function never fails.
///
/// - Two convex shapes have one manifold, with the normal of
///   [`penetration`](crate::query::penetration()). Along the normal of an ellipsoid, a cylinder, a
///   cone or a custom set, the depth exceeds the least depth by at most 2^-13 of the size of the
///   smaller shape, and mostly by less than 2^-20.
/// - A mesh and a convex shape have the manifolds of the convex pieces of the touched surface: of
///   neighboring faces that touch the shape as one convex body would. A piece has no manifold if
///   the shape leaves it with the shallower contacts, as it leaves the side of a platform when it
///   is lifted. Manifolds whose normals are within 2.5 degrees are merged. The outside of a solid
///   is the side from which corners are in counterclockwise order; the outside of a surface is the
///   side of the shape's center.
/// - Two half-spaces have one point. Its depth is infinite unless their planes are parallel and
///   face each other.
/// - Two meshes have the manifolds of their convex pieces, for each region in which their surfaces
///   intersect ([`contact_patches`](crate::query::contact_patches())) or are within the margin.
/// - Compounds have the manifolds of their parts. A normal that leads nearer to another part of the
///   same compound is replaced by that of a facet, or left out if that part has a manifold. So
///   nothing that slides or rolls over flush tiles meets the sides or edges between them.
///
/// ```
/// use impinge::{Pose, Shape, query};
///
/// let crate_ = Shape::cuboid([0.5; 3])?;
/// let (below, above) = (crate_.at(Pose::IDENTITY)?, crate_.at(Pose::from_translation([0.25, 0.25, 0.75])?)?);
/// let manifolds = query::contacts(&below, &above);
/// assert_eq!((manifolds.len(), manifolds[0].normal), (1, [0.0, 0.0, 1.0]));
/// assert_eq!(manifolds[0].points.len(), 4); // the corners of the square that they share
/// assert!(manifolds[0].points.iter().all(|point| point.lower <= 0.25 && 0.25 <= point.upper));
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// Each point is within rounding error of a point of its thing, and the depth of these two points
/// along the normal lies in `[lower, upper]` (docs/notes/proof.md, L28). No translation along the
/// normal that is shorter than `lower` separates the things. Round shapes other than spheres and
/// capsules have up to eight points around the side that faces the other shape. They may be less
/// deep than points beside them, by 2^-13 of the size.
///
/// # Complexity
/// The time of [`penetration`](crate::query::penetration()) for each two parts and for each convex
/// piece, and linear time in the number of faces near the other thing. Two facing polygons add the
/// product of their numbers of corners. The first query of a mesh takes O(n log n) for its
/// connectivity.
#[must_use]
pub fn contacts<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Vec<Manifold> {
    Query::new().contacts(a, b)
}

impl Query<'_> {
    /// Computes the contacts of two things, as [`contacts`] does, with the options of
    /// [`with_contacts`](Self::with_contacts).
    #[must_use]
    pub fn contacts<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Vec<Manifold> {
        let a = a.into();
        let b = b.into();
        let found = contacts_within(&a.shape(), &b.shape(), self.contacts.margin.max(0.0), self.options.budget);
        self.manifolds(found)
    }

    /// Computes the contacts of two shapes that are known to be at most the margin apart, as
    /// [`contacts`](Self::contacts) does.
    pub(crate) fn contacts_of_near(self, a: &PlacedShape, b: &PlacedShape) -> Vec<Manifold> {
        let found = contacts_of_near(a, b, self.contacts.margin.max(0.0), self.options.budget);
        self.manifolds(found)
    }

    fn manifolds(&self, found: Vec<OfParts>) -> Vec<Manifold> {
        found.into_iter().map(|of_parts| manifold(of_parts, self.contacts.most_points)).collect()
    }
}

/// Returns the contacts of two shapes within a margin, with the parts that they belong to. If the
/// budget is spent, some are missing.
fn contacts_within(a: &PlacedShape, b: &PlacedShape, margin: f64, budget: &Budget<'_>) -> Vec<OfParts> {
    if let ([a], [b]) = (a.parts(), b.parts())
        && (budget.is_spent()
            || are_boxes_farther(a, b, margin)
            || nearness_of_parts(a, b, margin, budget) == Proximity::Apart)
    {
        return Vec::new();
    }
    contacts_of_near(a, b, margin, budget)
}

/// Returns the contacts of two shapes that are at most `margin` apart, as [`contacts_within`] does.
fn contacts_of_near(a: &PlacedShape, b: &PlacedShape, margin: f64, budget: &Budget<'_>) -> Vec<OfParts> {
    if let ([a], [b]) = (a.parts(), b.parts()) {
        return contacts_of_parts(a, b, margin, budget).into_iter().map(OfParts::alone).collect();
    }
    let mut found = with_seams(a, b, [0, 1], [a, b], margin, budget);
    remove_buried(&mut found);
    found
}

/// Returns the contacts of all parts of two shapes, which have the given numbers and surroundings.
/// Buried contacts are among them.
fn with_seams(
    a: &PlacedShape,
    b: &PlacedShape,
    bodies: [u32; 2],
    surroundings: [&dyn Surroundings; 2],
    margin: f64,
    budget: &Budget<'_>,
) -> Vec<OfParts> {
    let mut found = Vec::new();
    for numbers in pairs_near(a, b, margin) {
        if budget.is_spent() {
            break;
        }
        let (part_a, part_b) = (&a.parts()[numbers[0] as usize], &b.parts()[numbers[1] as usize]);
        if nearness_of_parts(part_a, part_b, margin, budget) != Proximity::Apart {
            let members = [0, 1].map(|side| Member { body: bodies[side], part: numbers[side] });
            let of_parts = contacts_of_parts(part_a, part_b, margin, budget).into_iter();
            found.extend(
                of_parts.map(|contacts| across_seams(surroundings, [part_a, part_b], members, contacts, margin)),
            );
        }
    }
    found
}

/// Two shapes in contact, one of which is a part of a surface of several shapes.
pub(crate) struct SurfacePair<'s> {
    pub(crate) shapes: [&'s PlacedShape; 2],
    /// Numbers of the shapes. Different shapes have different numbers.
    pub(crate) bodies: [u32; 2],
    /// Which of the two shapes is a part of the surface: 0 or 1.
    pub(crate) surface: usize,
    pub(crate) margin: f64,
}

/// Computes the contacts of one shape with several others that are parts of one surface, as if
/// these were a compound. Returns the manifolds of each pair. If the budget is spent, some are
/// missing.
pub(crate) fn contacts_of_surface(
    pairs: &[SurfacePair<'_>],
    surface: &dyn Surroundings,
    budget: &Budget<'_>,
) -> Vec<Vec<Manifold>> {
    let mut found = Vec::new();
    for SurfacePair { shapes: [a, b], bodies, surface: side, margin } in pairs {
        let surroundings =
            if *side == 0 { [surface, *b as &dyn Surroundings] } else { [*a as &dyn Surroundings, surface] };
        found.extend(with_seams(a, b, *bodies, surroundings, *margin, budget));
    }
    remove_buried(&mut found);
    let mut manifolds: Vec<Vec<Manifold>> = pairs.iter().map(|_| Vec::new()).collect();
    for of_parts in found {
        let bodies = of_parts.members.map(|member| member.body);
        if let Some(at) = pairs.iter().position(|pair| pair.bodies == bodies) {
            manifolds[at].push(manifold(of_parts, ContactOptions::default().most_points));
        }
    }
    manifolds
}

fn contacts_of_parts(a: &PlacedShape, b: &PlacedShape, margin: f64, budget: &Budget<'_>) -> Vec<Contacts> {
    match (a.form(), b.form()) {
        (Form::Convex(swept_a), Form::Convex(swept_b)) => {
            vec![convex::contacts(&a.faceted(swept_a), &b.faceted(swept_b), margin)]
        }
        (Form::HalfSpace(plane), Form::Convex(swept)) => vec![plane.contacts(&b.faceted(swept), margin)],
        (Form::Convex(swept), Form::HalfSpace(plane)) => vec![plane.contacts(&a.faceted(swept), margin).swapped()],
        (Form::HalfSpace(a), Form::HalfSpace(b)) => vec![a.contact_of_half_spaces(&b)],
        (Form::Surface(surface), Form::Convex(swept)) => {
            let found = surface.contacts(&b.faceted(swept), margin, budget);
            if found.is_empty() { of_contained(a, b, budget) } else { found }
        }
        (Form::Convex(swept), Form::Surface(surface)) => {
            let found = surface.contacts(&a.faceted(swept), margin, budget);
            if found.is_empty() {
                return of_contained(a, b, budget);
            }
            found.into_iter().map(Contacts::swapped).collect()
        }
        (Form::HalfSpace(plane), Form::Surface(surface)) => surface.contacts_with_half_space(&plane, margin),
        (Form::Surface(surface), Form::HalfSpace(plane)) => {
            surface.contacts_with_half_space(&plane, margin).into_iter().map(Contacts::swapped).collect()
        }
        (Form::Surface(surface_a), Form::Surface(surface_b)) => {
            let found = of_surfaces(&surface_a, &surface_b, margin, budget);
            if found.is_empty() { of_contained(a, b, budget) } else { found }
        }
        (Form::HalfSpace(plane), Form::Field(field)) => field.contacts_with_half_space(&plane, margin),
        (Form::Field(field), Form::HalfSpace(plane)) => {
            field.contacts_with_half_space(&plane, margin).into_iter().map(Contacts::swapped).collect()
        }
        (Form::Field(field), other) => {
            let found = of_field(&field, b, &other, margin, budget);
            if found.is_empty() { of_contained(a, b, budget) } else { found }
        }
        (other, Form::Field(field)) => {
            let found = of_field(&field, a, &other, margin, budget);
            if found.is_empty() {
                return of_contained(a, b, budget);
            }
            found.into_iter().map(Contacts::swapped).collect()
        }
    }
}

/// Returns the contacts of a height field, which comes first, with a part of another shape that is
/// not a half-space.
fn of_field(
    field: &Field<'_>,
    part: &PlacedShape,
    other: &Form<'_>,
    margin: f64,
    budget: &Budget<'_>,
) -> Vec<Contacts> {
    let crops = match other {
        Form::Convex(swept) => crop_around(field, swept, margin).map(|crop| [Some(crop), None]),
        Form::Surface(surface) => crop_near(field, surface, margin).map(|crop| [Some(crop), None]),
        Form::Field(other) => crops_near(field, other, margin).map(|crops| crops.map(Some)),
        Form::HalfSpace(_) => None,
    };
    let Some([Some(crop), other_crop]) = crops else { return Vec::new() };
    let surface = surface_of_crop(&crop, field);
    let mut found = match (other, &other_crop) {
        (Form::Convex(swept), _) => surface.contacts(&part.faceted(*swept), margin, budget),
        (Form::Surface(other), _) => of_surfaces(&surface, other, margin, budget),
        (Form::Field(other), Some(crop)) => of_surfaces(&surface, &surface_of_crop(crop, other), margin, budget),
        (Form::Field(_) | Form::HalfSpace(_), _) => Vec::new(),
    };
    rename(&mut found, 0, &crop);
    if let Some(crop) = &other_crop {
        rename(&mut found, 1, crop);
    }
    found
}

/// Returns the one contact of two shapes if one is inside the other without touching its surface:
/// the deepest points of the penetration.
fn of_contained(a: &PlacedShape, b: &PlacedShape, budget: &Budget<'_>) -> Vec<Contacts> {
    let Depth { lower, upper, normal, points } = depth_by_search(a, b, budget);
    let features = [Feature::Face(0); 2];
    vec![Contacts { normal, contacts: vec![Contact { points, lower, upper, features }] }]
}

/// Returns the contacts of two meshes: those of the regions in which their surfaces intersect or
/// are within the margin. Without such contacts, as for faces without area, it returns the nearest
/// points.
fn of_surfaces(a: &Surface<'_>, b: &Surface<'_>, margin: f64, budget: &Budget<'_>) -> Vec<Contacts> {
    let (a, b) = (surface_of(a), surface_of(b));
    let found = contacts_of_patches([a, b], margin, budget);
    if !found.is_empty() || budget.stopped().is_some() {
        return found;
    }
    let distance = of_meshes::distance_without_cache(a, b, budget);
    let Some(witness) = distance.witness.filter(|_| distance.lower <= margin) else { return Vec::new() };
    let Some([face_a, face_b]) = witness.faces else { return Vec::new() };
    let between: [f64; 3] = std::array::from_fn(|k| witness.point_b[k] - witness.point_a[k]);
    let features = [Feature::Face(face_a), Feature::Face(face_b)];
    let points = [witness.point_a, witness.point_b];
    let contact = Contact { points, lower: -distance.upper, upper: -distance.lower, features };
    vec![Contacts { normal: unit(between), contacts: vec![contact] }]
}

fn manifold(OfParts { members, mut contacts, .. }: OfParts, most_points: usize) -> Manifold {
    contacts.keep(most_points);
    let [part_a, part_b] = members.map(|member| member.part);
    let points = contacts.contacts.iter().map(|contact| {
        let ([point_a, point_b], [feature_a, feature_b]) = (contact.points, contact.features);
        let id = ContactId { part_a, part_b, feature_a, feature_b };
        ContactPoint { point_a, point_b, lower: contact.lower, upper: contact.upper, id }
    });
    Manifold { normal: contacts.normal, points: points.collect() }
}
