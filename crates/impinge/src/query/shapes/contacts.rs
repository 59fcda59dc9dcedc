//! Where two shapes touch or overlap, as a solver of contacts wants it.

use super::within;
pub use crate::convex::Feature;
use crate::convex::{self, Contacts, HalfSpace};
use crate::shape::{Form, PlacedShape};

/// The contacts of two shapes, or of a part of each, that have one normal.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifold {
    /// A direction of length 1 from the first shape to the second, in the world frame.
    pub normal: [f64; 3],
    /// At least one, in the order of their ids.
    pub points: Vec<ContactPoint>,
}

/// A point of each of two shapes, one over the other along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// On the first shape's side, in the world frame, rounded.
    pub point_a: [f64; 3],
    /// On the second shape's side, in the world frame, rounded.
    pub point_b: [f64; 3],
    /// The first shape reaches beyond the second here, along the normal, by at least this, in world units; negative where they
    /// are apart here.
    pub lower: f64,
    /// And by at most this.
    pub upper: f64,
    /// What the point is of.
    pub id: ContactId,
}

/// What a contact is of: the same from one time to the next as long as it is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContactId {
    /// The part of the first shape, 0 where it has but one.
    pub part_a: u32,
    /// The part of the second shape, 0 where it has but one.
    pub part_b: u32,
    /// The corner, edge or face of that part of the first shape.
    pub feature_a: Feature,
    /// The corner, edge or face of that part of the second shape.
    pub feature_b: Feature,
}

/// Which contacts are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Points that are at most this far apart are contacts too, in world units. Zero, the default, asks for those that touch; so
    /// do negative numbers and NaN.
    pub margin: f64,
    /// How many points a manifold may have, at least one: the deepest, the farthest from it, and then each time the one that
    /// adds the most area. Four, the default, hold a face as firmly as more do.
    pub most_points: usize,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self { margin: 0.0, most_points: 4 }
    }
}

/// The contacts of two shapes; none exactly where [`intersects`](super::intersects) is false.
///
/// ```
/// use impinge::{Pose, query::shapes, shape::Shape};
///
/// let crate_ = Shape::cuboid([0.5; 3])?;
/// let (below, above) = (crate_.at(Pose::IDENTITY)?, crate_.at(Pose::from_translation([0.25, 0.25, 0.75])?)?);
/// let manifolds = shapes::contacts(&below, &above);
/// assert_eq!((manifolds.len(), manifolds[0].normal), (1, [0.0, 0.0, 1.0]));
/// assert_eq!(manifolds[0].points.len(), 4); // the corners of the square that they share
/// assert!(manifolds[0].points.iter().all(|point| point.lower <= 0.25 && 0.25 <= point.upper));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn contacts(a: &PlacedShape, b: &PlacedShape) -> Vec<Manifold> {
    contacts_with(a, b, &ContactOptions::default())
}

/// [`contacts`], of what the options ask for; with a margin none exactly where [`within`] the margin is false.
///
/// Two convex shapes have one manifold, with the normal of [`penetration`](super::penetration).
///
/// # Accuracy
/// Near each of the two points, as far as rounding goes, there is a point of its shape such that these are as deep along the normal as the
/// interval says (docs/proof.md, L28). No translation along the normal that is shorter than `lower` parts the shapes.
/// Round shapes that are not spheres or capsules have up to eight points about what they turn to the other shape, which may
/// be less deep than others beside them by 2^-13 of the size.
///
/// # Complexity
/// That of `penetration`, and the product of the corners of the two facing polygons.
#[must_use]
pub fn contacts_with(a: &PlacedShape, b: &PlacedShape, options: &ContactOptions) -> Vec<Manifold> {
    let margin = options.margin.max(0.0);
    if !within(a, b, margin) {
        return Vec::new();
    }
    let mut found = match (a.form(), b.form()) {
        (Form::Convex(swept_a), Form::Convex(swept_b)) => {
            convex::contacts(&a.faceted(swept_a), &b.faceted(swept_b), margin)
        }
        (Form::HalfSpace { normal, level, pose }, Form::Convex(swept)) => {
            HalfSpace::new(normal, level, pose).contacts(&b.faceted(swept), margin)
        }
        (Form::Convex(swept), Form::HalfSpace { normal, level, pose }) => {
            HalfSpace::new(normal, level, pose).contacts(&a.faceted(swept), margin).swapped()
        }
        (
            Form::HalfSpace { normal, level, pose },
            Form::HalfSpace { normal: normal_b, level: level_b, pose: pose_b },
        ) => {
            let (a, b) = (HalfSpace::new(normal, level, pose), HalfSpace::new(normal_b, level_b, pose_b));
            a.contact_of_half_spaces(&b)
        }
    };
    found.keep(options.most_points);
    vec![manifold(&found)]
}

fn manifold(found: &Contacts) -> Manifold {
    let points = found.contacts.iter().map(|contact| {
        let ([point_a, point_b], [feature_a, feature_b]) = (contact.points, contact.features);
        let id = ContactId { part_a: 0, part_b: 0, feature_a, feature_b };
        ContactPoint { point_a, point_b, lower: contact.lower, upper: contact.upper, id }
    });
    Manifold { normal: found.normal, points: points.collect() }
}
