//! The questions one asks of two shapes: spheres, capsules, boxes, cylinders, cones, ellipsoids, hulls, triangles,
//! half-spaces, whatever has a support function, meshes, and compounds of these.
//!
//! What is said of polytopes (points, segments, triangles, boxes, hulls), meshes and half-spaces is the truth about their real
//! images under the given poses. So it is of spheres and capsules among these, where the poses are exactly orthogonal. Of all
//! else a boolean is the truth wherever floats prove it; shapes that touch to within rounding count as hits, and
//! [`proximity`] says so. A mesh is its surface, or a solid ([`Shape::solid`](crate::shape::Shape::solid)).

mod balls;
mod beyond;
mod contacts;
mod search;
mod table;

use crate::convex::{self, Coherence, Depth};
use crate::mesh::Placed;
use crate::shape::{Form, PlacedShape};
pub use crate::volume::Proximity;
pub use contacts::{ContactId, ContactOptions, ContactPoint, Feature, Manifold, contacts, contacts_with};

/// Beyond this, 2^320 world units, everything is nearer, and sums stay in range below it.
const FAR: f64 = f64::from_bits((1023 + 320) << 52);

/// How far apart two shapes are, with what was proved about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeDistance {
    /// No two points of the shapes are nearer to each other than this, in world units.
    pub lower: f64,
    /// Some two points are no farther apart than this; zero where a common point is proved.
    pub upper: f64,
    /// A point of the first shape that is nearest to the second, in the world frame, rounded. Of two meshes one of which lies in
    /// the other, which is solid, it is nearest to the other's surface, and so it is for the other.
    pub point_a: [f64; 3],
    /// A point of the second shape that is nearest to the first, in the world frame, rounded.
    pub point_b: [f64; 3],
    /// Whether the shapes are apart.
    pub proximity: Proximity,
}

/// How deep two shapes are in each other, with what was proved about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// No translation shorter than this takes the interiors of the shapes apart, in world units.
    pub lower: f64,
    /// Moving the second shape by this along [`normal`](Self::normal) does; infinite where nothing does.
    pub upper: f64,
    /// A direction of length 1 from the first shape to the second, in the world frame. Where several are as good, one of them.
    pub normal: [f64; 3],
    /// The point of the first shape that is deepest in the second, against the normal; in the world frame, rounded.
    pub point_a: [f64; 3],
    /// The point of the second shape that is deepest in the first, in the world frame, rounded: from it to the other point it is about the
    /// depth, along the normal.
    pub point_b: [f64; 3],
}

impl ShapeDistance {
    /// The distance: zero exactly where [`intersects`] is true, else [`upper`](Self::upper).
    #[must_use]
    pub fn distance(&self) -> f64 {
        if self.proximity == Proximity::Apart { self.upper } else { 0.0 }
    }
}

/// Whether two shapes have a common point, as far as that is proved; touching counts.
///
/// # Complexity
/// Some 10 supports of either convex shape; for a mesh those of each face whose boxes are near; where shapes nearly touch and are
/// polytopes, some microseconds of exact arithmetic for each of a few vertices.
#[must_use]
pub fn proximity(a: &PlacedShape, b: &PlacedShape) -> Proximity {
    table::nearness(a, b, 0.0)
}

/// Whether two shapes are not proved apart.
///
/// ```
/// use impinge::{Pose, query::shapes, shape::Shape};
///
/// let unit = Shape::cuboid([0.5; 3])?;
/// let (here, there) = (unit.at(Pose::IDENTITY)?, unit.at(Pose::from_translation([1.0, 1.0, 1.0])?)?);
/// assert!(shapes::intersects(&here, &there)); // in a corner
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn intersects(a: &PlacedShape, b: &PlacedShape) -> bool {
    proximity(a, b) != Proximity::Apart
}

/// Whether two shapes come within `clearance` of each other, in world units: closer than it or equal to it.
///
/// It is decided as [`intersects`] is, so exactly for polytopes. Nothing is within a negative clearance, or one that is
/// not a number.
#[must_use]
pub fn within(a: &PlacedShape, b: &PlacedShape, clearance: f64) -> bool {
    nearness(a, b, clearance) != Proximity::Apart
}

/// What is known of whether two shapes come within `clearance` of each other: [`proximity`] where that is zero.
///
/// ```
/// use impinge::{Pose, query::shapes::{self, Proximity}, shape::Shape};
///
/// let ball = Shape::sphere([0.0; 3], 1.0)?;
/// let [here, there] = [0.0, 3.0].map(|x| ball.at(Pose::from_translation([x, 0.0, 0.0]).unwrap()).unwrap());
/// assert_eq!(shapes::nearness(&here, &there, 0.5), Proximity::Apart);
/// assert_eq!(shapes::nearness(&here, &there, 1.5), Proximity::Meets);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn nearness(a: &PlacedShape, b: &PlacedShape, clearance: f64) -> Proximity {
    if clearance.is_nan() || clearance < 0.0 {
        return Proximity::Apart;
    }
    // No two shapes are farther apart than that.
    table::nearness(a, b, clearance.min(FAR))
}

/// What was found when two shapes were last asked about; the caller keeps one for each two shapes.
///
/// It makes the next answer faster where they have moved little, and never another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapeCache(Coherence);

/// [`within`], from where the shapes were last; with a clearance of zero [`intersects`].
///
/// ```
/// use impinge::{Pose, query::shapes::{self, ShapeCache}, shape::Shape};
///
/// let unit = Shape::cuboid([0.5; 3])?;
/// let here = unit.at(Pose::IDENTITY)?;
/// let mut cache = ShapeCache::default();
/// for step in 0..8 {
///     let there = unit.at(Pose::from_translation([1.75 - 0.125 * f64::from(step), 0.0, 0.0])?)?;
///     assert_eq!(shapes::within_with(&here, &there, 0.0, &mut cache), step >= 6);
/// }
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Complexity
/// One support of either shape where two convex ones are still apart along the last direction, by hill climbing from the last
/// vertex; else as there. Of anything else the cache keeps nothing.
#[must_use]
pub fn within_with(a: &PlacedShape, b: &PlacedShape, clearance: f64, cache: &mut ShapeCache) -> bool {
    let is_plain = (0.0..=FAR).contains(&clearance);
    match (a.parts(), b.parts()) {
        ([part_a], [part_b]) if is_plain => {
            if let (Form::Convex(a), Form::Convex(b)) = (part_a.form(), part_b.form()) {
                return convex::nearness_from(&a, &b, clearance, &mut cache.0) != Proximity::Apart;
            }
            within(a, b, clearance)
        }
        _ => within(a, b, clearance),
    }
}

/// The distance of two shapes.
///
/// ```
/// use impinge::{Pose, query::shapes, shape::Shape};
///
/// let cone = Shape::cone(1.0, 0.5)?.at(Pose::IDENTITY)?;
/// let floor = Shape::half_space([0.0, 0.0, 1.0], -3.0)?.at(Pose::IDENTITY)?;
/// let distance = shapes::distance(&cone, &floor);
/// assert!(distance.lower <= 2.0 && 2.0 <= distance.upper && distance.upper - distance.lower < 1e-12);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The true distance lies in `[lower, upper]`. For polytopes the interval is at most 2^-36 of the distance wide, however
/// small that is. For spheres and capsules there is what the pose is off orthogonal on top, and 2^-46 of the size of the
/// cores; for other round shapes it is about 2^-40 of the size (tests: `tests/it/shapes`), and up to 2^-23 of it where they are
/// turned so that several points are as near.
///
/// # Source
/// See [`convex`].
#[must_use]
pub fn distance(a: &PlacedShape, b: &PlacedShape) -> ShapeDistance {
    let found = table::separation(a, b);
    let [point_a, point_b] = found.points;
    ShapeDistance { lower: found.lower, upper: found.upper, point_a, point_b, proximity: found.proximity }
}

/// How deep two shapes are in each other; none where they do not intersect.
///
/// ```
/// use impinge::{Pose, query::shapes, shape::Shape};
///
/// let (a, b) = (Shape::cuboid([1.0; 3])?, Shape::sphere([0.0; 3], 1.0)?);
/// let pose = Pose::from_translation([1.5, 0.0, 0.0])?;
/// let penetration = shapes::penetration(&a.at(Pose::IDENTITY)?, &b.at(pose)?).expect("they intersect");
/// assert!(penetration.lower <= 0.5 && 0.5 <= penetration.upper && penetration.upper - penetration.lower < 1e-12);
/// assert_eq!(penetration.normal, [1.0, 0.0, 0.0]);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The true depth lies in `[lower, upper]`, and the upper end is valid for the normal whatever else happened. The interval is
/// about 2^-44 of the sizes wide for polytopes, spheres and capsules. For cylinders, cones and ellipsoids it is narrowed to 2^-40 of the
/// sizes; where they are deep in each other, as in one place, it is what the work allows: the tests assert 1e-10 for those placed at
/// random, and 1e-3 of the sizes in one place, 1e-2 for a cone (`tests/it/shapes`).
///
/// For compounds, and for meshes but with half-spaces, the upper end is that of a search, at the end of which the second shape was
/// moved and proved to be apart; there may be shorter ways. The lower end comes from two balls about one point, one in
/// each shape: a mesh that is no solid holds none. Two spheres of ever smaller triangles have depths that close in on the spheres'.
///
/// # Complexity
/// Some 10 to 30 supports and as many facets for boxes and small hulls, 30 to 60 for round ones and at most 320. A search
/// takes some hundred distances.
#[must_use]
pub fn penetration(a: &PlacedShape, b: &PlacedShape) -> Option<Penetration> {
    if !intersects(a, b) {
        return None;
    }
    Some(table::depth(a, b).unwrap_or_else(|| search::depth_by_search(a, b)).into())
}

/// The depth of two meshes, taken as solids, that have a common point.
pub(super) fn penetration_of_solids(a: Placed<'_>, b: Placed<'_>) -> Penetration {
    search::depth_by_search(&PlacedShape::solid(a), &PlacedShape::solid(b)).into()
}

impl From<Depth> for Penetration {
    fn from(depth: Depth) -> Self {
        let [point_a, point_b] = depth.points;
        Self { lower: depth.lower, upper: depth.upper, normal: depth.normal, point_a, point_b }
    }
}
