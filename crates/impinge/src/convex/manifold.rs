//! Contacts of two convex shapes that touch or overlap: points on both, a normal, and the depth of
//! each contact.
//!
//! The normal is the normal of the depth, or of the distance if the shapes are apart. The points
//! come from the parts of both shapes that face along it, at the places where they lie over each
//! other. So two boxes that lie flat on each other have up to eight contacts, crossed edges have
//! one, and a capsule on the ground has two.
//!
//! # Source
//! Clipping facing polygons is the method of all engines (Gregorius, *Robust Contact Creation for
//! Physics Simulations*, GDC 2015). Ours departs in three ways. Both shapes are treated alike.
//! Points are means of corners, which gives each depth an interval (docs/notes/proof.md, L28). The
//! deepest points of the depth itself are added if clipping has none as deep.
//!
//! The tests are in `tests/it/shapes/contacts.rs`.

use super::depth::{Effort, depth_in_order};
use super::facets::Facets;
use super::facing::{AllFacing, PosedFacets, facing};
use super::interval::{above, below};
use super::overlap::{Feature, Over, Places, is_one_place, overlap, overlap_of_all, shadow_tolerance};
use super::posed::{Core, Pair, Posed, Swept};
use super::short_list::ShortList;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::dot;

/// A swept core, with the facets of the core if it is a polytope.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faceted<'a> {
    pub(crate) swept: Swept<'a>,
    pub(crate) facets: Option<&'a Facets>,
    /// Whether all facets that lean towards a normal are in contact along it, as for the part of a
    /// curved surface. Otherwise only the one that leans most is.
    pub(crate) has_all_facets: bool,
}

/// A contact in the world frame: a point on either shape, an interval for the depth in world units,
/// and the features in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    pub(crate) points: [[f64; 3]; 2],
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) features: [Feature; 2],
}

/// All contacts along one normal, which points from the first shape to the second and has length 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Contacts {
    pub(crate) normal: [f64; 3],
    pub(crate) contacts: Vec<Contact>,
}

/// Returns the contacts of two shapes that are at most `margin` apart, in world units. There is at
/// least one.
pub(crate) fn contacts(a: &Faceted<'_>, b: &Faceted<'_>, margin: f64) -> Contacts {
    if a.swept.is_before(&b.swept) {
        return contacts_in_order(a, b, margin);
    }
    contacts_in_order(b, a, margin).swapped()
}

impl Contacts {
    pub(crate) fn swapped(mut self) -> Self {
        self.normal = self.normal.map(|x| 0.0 - x);
        for contact in &mut self.contacts {
            contact.points.swap(0, 1);
            contact.features.swap(0, 1);
        }
        self
    }

    /// Returns the greatest upper bound of a depth.
    pub(crate) fn deepest(&self) -> f64 {
        self.contacts.iter().map(|contact| contact.upper).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns twice the midpoint of the first contact, which is the same for the shapes in either
    /// order.
    pub(super) fn middle_of_first(&self) -> [f64; 3] {
        let [p, q] = self.contacts.first().map_or([[0.0; 3]; 2], |contact| contact.points);
        std::array::from_fn(|k| p[k] + q[k])
    }
}

/// One of two shapes in their common frame.
pub(super) struct Side<'s> {
    shape: Faceted<'s>,
    /// The facets, if all that lean towards a normal are in contact along it.
    leaning: Option<PosedFacets<'s>>,
}

impl<'s> Side<'s> {
    pub(super) fn new(set: &Posed<'_>, shape: &Faceted<'s>) -> Self {
        let facets = shape.facets.filter(|facets| shape.has_all_facets && !facets.corners.is_empty());
        Self { shape: *shape, leaning: facets.map(|facets| PosedFacets::new(set, facets)) }
    }

    /// Returns an upper bound on the radius, in world units.
    pub(super) fn radius(&self) -> f64 {
        self.shape.swept.radius[1]
    }

    /// Returns the facets that lean towards a direction, the one that leans most first, or the one
    /// part of the shape that faces it.
    fn all_facing(&self, set: &Posed<'_>, direction: [f64; 3]) -> AllFacing<'_> {
        match &self.leaning {
            Some(facets) => facets.leaning(set, direction),
            None => AllFacing::only(facing(set, self.shape.facets, direction)),
        }
    }
}

/// Returns the places of two points. They are always the deepest ones, so no parts that face each
/// other need to be compared. Returns `None` for all other cores.
fn over_of_points(pair: &Pair<'_>) -> Option<Over> {
    let (Core::Points([p]), Core::Points([q])) = (pair.a.core(), pair.b.core()) else { return None };
    Some(Over { points: [pair.a.spot(*p).point, pair.b.spot(*q).point], features: [Feature::Vertex(0); 2] })
}

/// Adds the places where the facing parts lie over each other along a direction to `found`, and
/// returns the features that face each other. Of several facing facets the first names the feature.
fn facing_overlap(
    pair: &Pair<'_>,
    [a, b]: [&Side<'_>; 2],
    normal: &[f64; 3],
    near: f64,
    found: &mut Places,
) -> [Feature; 2] {
    let opposite = normal.map(|x| -x);
    if a.leaning.is_none() && b.leaning.is_none() {
        // One part of each faces the other, as for almost all shapes, so no lists are needed.
        let part_a = facing(&pair.a, a.shape.facets, *normal);
        let part_b = facing(&pair.b, b.shape.facets, opposite);
        overlap(&part_a, &part_b, normal, near, found);
        return [part_a.feature(), part_b.feature()];
    }
    let facing_a = a.all_facing(&pair.a, *normal);
    let facing_b = b.all_facing(&pair.b, opposite);
    overlap_of_all(&facing_a, &facing_b, normal, near, found);
    [facing_a.first.feature(), facing_b.first.feature()]
}

fn contacts_in_order(a: &Faceted<'_>, b: &Faceted<'_>, margin: f64) -> Contacts {
    let pair = Pair::new(&a.swept, &b.swept);
    let sides = [&Side::new(&pair.a, a), &Side::new(&pair.b, b)];
    let size = smaller_size(&pair, sides);
    let depth = |effort| depth_in_order(&pair, &a.swept, &b.swept, effort);
    let mut found = depth(Effort::for_contact(&pair, size));
    if found.depth.upper - found.depth.lower > MAX_CONTACT_WIDTH * size * pair.unit {
        found = depth(Effort::ROUND_DEPTH);
    }
    let normal = found.depth.normal;
    let mut contacts = match over_of_points(&pair) {
        Some(over) => vec![Measure::new(&pair, sides, &normal).contact(&over)],
        None => {
            let near = shadow_tolerance(&pair, size);
            let mut over = Over::none();
            let features = facing_overlap(&pair, sides, &normal, near, &mut over);
            let height = |over: &Over| height(over, &normal);
            let witness = Over { points: found.core, features };
            let deepest = over.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
            if deepest.is_nan() || deepest < height(&witness) - MIN_WITNESS_EXCESS * size - pair.point_error() {
                over.push(witness);
            }
            measured(&pair, sides, &normal, near, &mut over)
        }
    };
    if found.depth.upper == 0.0 {
        // The shapes are proved to reach no farther than to each other along the normal.
        for contact in &mut contacts {
            (contact.lower, contact.upper) = (contact.lower.min(0.0), contact.upper.min(0.0));
        }
    }
    let deepest = contacts.iter().map(|contact| contact.upper).fold(f64::NEG_INFINITY, f64::max);
    contacts.retain(|contact| contact.upper >= -margin || contact.upper == deepest);
    Contacts { normal, contacts }
}

/// Returns the contacts along a given normal of length 1: the places where the facing sides lie
/// over each other and are at most `margin` apart.
pub(super) fn contacts_over(pair: &Pair<'_>, sides: [&Side<'_>; 2], normal: [f64; 3], margin: f64) -> Contacts {
    let near = shadow_tolerance(pair, smaller_size(pair, sides));
    let mut over = Over::none();
    match over_of_points(pair) {
        Some(points) => over.push(points),
        None => _ = facing_overlap(pair, sides, &normal, near, &mut over),
    }
    let mut contacts = measured(pair, sides, &normal, near, &mut over);
    contacts.retain(|contact| contact.upper >= -margin);
    Contacts { normal, contacts }
}

/// Returns the size of the smaller one of two shapes, in the common unit: at most 1, and not so
/// small that a point would have no tolerance at all.
fn smaller_size(pair: &Pair<'_>, [a, b]: [&Side<'_>; 2]) -> f64 {
    const MIN_SIZE: f64 = 1.0 / (1 << 28) as f64;
    let size = |set: &Posed<'_>, side: &Side<'_>| set.reach() + side.shape.swept.radius[1] / pair.unit;
    size(&pair.a, a).min(size(&pair.b, b)).clamp(MIN_SIZE, 1.0)
}

/// Converts points over each other to contacts, the deepest first. Of several contacts in one
/// place, or with the same features, only the deepest is kept. `near` is the tolerance of the
/// shadows.
fn measured(pair: &Pair<'_>, sides: [&Side<'_>; 2], normal: &[f64; 3], near: f64, over: &mut Places) -> Vec<Contact> {
    let measure = Measure::new(pair, sides, normal);
    let height = |over: &Over| height(over, normal);
    over.sort_by(|x, y| height(y).total_cmp(&height(x)).then_with(|| rank(x).cmp(&rank(y))));
    let mut places = ShortList::<[f64; 3], 8>::new([0.0; 3]);
    let mut contacts = Vec::with_capacity(over.len());
    for over in over.iter() {
        let is_named = contacts.iter().any(|contact: &Contact| contact.features == over.features);
        if is_named || places.iter().any(|place| is_one_place(place, &over.points[0], near)) {
            continue;
        }
        places.push(over.points[0]);
        contacts.push(measure.contact(over));
    }
    contacts
}

/// Returns how far the first of two points over each other is beyond the second along the normal.
fn height(Over { points: [p, q], .. }: &Over, normal: &[f64; 3]) -> f64 {
    dot(normal, p) - dot(normal, q)
}

/// Converts points of two cores over each other to contacts of the shapes around them.
struct Measure<'m> {
    pair: &'m Pair<'m>,
    normal: &'m [f64; 3],
    radii: [[f64; 2]; 2],
    /// Bound on the error of a height, in the common unit.
    error: f64,
}

impl<'m> Measure<'m> {
    fn new(pair: &'m Pair<'m>, sides: [&Side<'_>; 2], normal: &'m [f64; 3]) -> Self {
        Self { pair, normal, radii: sides.map(|side| side.shape.swept.radius), error: heights_error(pair) }
    }

    fn contact(&self, over: &Over) -> Contact {
        let (height, [radius_a, radius_b]) = (height(over, self.normal), self.radii);
        let [low, high] = [below(height - self.error), above(height + self.error)].map(|end| end * self.pair.unit);
        let lower = below(low + below(radius_a[0] + radius_b[0]));
        let upper = above(high + above(radius_a[1] + radius_b[1]));
        let [p, q] = over.points.map(|point| self.pair.world(point));
        let points = [
            std::array::from_fn(|k| p[k] + self.normal[k] * radius_a[0]),
            std::array::from_fn(|k| q[k] - self.normal[k] * radius_b[0]),
        ];
        Contact { points, lower, upper, features: over.features }
    }
}

/// Width of an interval of depths, relative to the smaller shape, above which the depth is computed
/// with full effort: 2^-13. Round shapes that are deep in each other reach it.
const MAX_CONTACT_WIDTH: f64 = 1.0 / (1 << 13) as f64;

/// Minimum extra depth of the witness over all points of the clipped polygons, relative to the
/// smaller shape, for the witness to become a contact: 2^-20.
const MIN_WITNESS_EXCESS: f64 = 1.0 / (1 << 20) as f64;

/// Returns a bound on the error of the height of one mean of corners over another, relative to
/// points of the sets, in the common unit (docs/notes/proof.md, L28).
fn heights_error(pair: &Pair<'_>) -> f64 {
    2.0 * pair.point_error() + 16.0 * UNIT_ROUNDOFF * pair.extent.iter().sum::<f64>()
}

/// Ranks corners before crossings of edges, for points in one place.
fn rank(over: &Over) -> (bool, [Feature; 2]) {
    (matches!(over.features, [Feature::Edge(..), Feature::Edge(..)]), over.features)
}
