//! How far apart two things are, and whether they keep a clearance.

use super::placed::{Placed, meshes};
use super::shapes::table;
use super::{Distance, Proximity, Query, of_meshes, shapes};
use crate::mesh::WarmStart;

/// The distance of two things.
///
/// The nearest faces of two meshes are those with the least distance by the closed form and, among equals, the least face of the
/// first mesh, then of the second. If hundreds of faces tie on flat sides that face each other, they are two of those that tie. If
/// the surfaces intersect they are two faces that do, with a common point: those that [`intersects`](super::intersects) comes to
/// first, which depends on how the hierarchies were built.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, Shape, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let above = Pose::from_translation([0.0, 0.0, 2.0])?;
/// let distance = query::distance(&mesh, mesh.at(above));
/// assert!(distance.lower <= 2.0 && 2.0 <= distance.upper && distance.upper - distance.lower < 1e-12);
/// assert_eq!(query::distance(&mesh, &mesh).upper, 0.0);
/// let cone = Shape::cone(1.0, 0.5)?;
/// let distance = query::distance(&mesh, cone.at(above)?);
/// assert!(distance.lower <= 1.0 && 1.0 <= distance.upper && distance.upper - distance.lower < 1e-12);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The true distance lies in `[lower, upper]`.
/// - Of two meshes the width is at most 2^-44 of the diagonal of the box that holds both, most often 2^-45: how far they are from
///   the origins of their frames and of the world does not count. For flat sides that face each other it is a few units of the last
///   place (tests: `tests/it/distance`, against rationals). If it is undecided whether one is inside the other, an open solid, the
///   lower end is zero.
/// - Of polytopes (points, segments, triangles, boxes, hulls) and half-spaces it is at most 2^-36 of the distance, however small that
///   is. Spheres and capsules add how far the pose is from orthogonal, and 2^-46 of the size of the cores.
/// - Of other round shapes it is about 2^-40 of the size, and up to 2^-23 if they are turned so that several points are as near
///   (tests: `tests/it/shapes`).
///
/// Witnesses are rounded once more, to the world's coordinates.
///
/// # Complexity
/// For meshes apart it is logarithmic, and grows with the faces that are as near as the nearest. Flat sides that face each other
/// take one pass over the vertices instead. Meshes that intersect take as long as [`intersects`](super::intersects) does.
///
/// # Source
/// Meshes: Larsen, Gottschalk, Lin, Manocha, *Fast proximity queries with swept sphere volumes*, ICRA 2000; ours differs in its
/// bounds, on boxes eight at a time and along the direction between the nearest points so far, and in that they are proved. Convex
/// shapes: see [`convex`](crate::convex).
#[must_use]
pub fn distance<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Distance {
    Query::new().distance(a, b)
}

/// Whether two things come within `clearance` of each other, in world units: closer than it or equal to it.
///
/// Nothing is within a negative clearance, or one that is not a number, and an empty mesh is within none. What is inside a solid is
/// within any other clearance of it.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let above = mesh.at(Pose::from_translation([0.0, 0.0, 0.1])?);
/// assert!(query::within(&mesh, above, 0.1));
/// assert!(!query::within(&mesh, above, 0.1_f64.next_down()));
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// As [`intersects`](super::intersects): exact for the real images of meshes, polytopes and half-spaces.
///
/// # Complexity
/// For two meshes it stops at the first pair of faces that is within the clearance. If none is, pairs of faces whose distance is the
/// clearance to the last digits take about a microsecond each, and flat sides that face each other take one pass over the faces. Two
/// convex shapes with a [`Cache`](super::Cache) take one support of either, if they are still apart along the last direction.
#[must_use]
pub fn within<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> bool {
    Query::new().within(a, b, clearance)
}

/// What is known of whether two things come within `clearance` of each other: [`proximity`](super::proximity) if it is zero.
///
/// ```
/// use impinge::query::{self, Proximity};
/// use impinge::{Pose, Shape};
///
/// let ball = Shape::sphere([0.0; 3], 1.0)?;
/// let [here, there] = [0.0, 3.0].map(|x| ball.at(Pose::from_translation([x, 0.0, 0.0]).unwrap()).unwrap());
/// assert_eq!(query::nearness(&here, &there, 0.5), Proximity::Apart);
/// assert_eq!(query::nearness(&here, &there, 1.5), Proximity::Meets);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn nearness<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> Proximity {
    Query::new().nearness(a, b, clearance)
}

impl Query<'_> {
    /// As [`distance`].
    #[must_use]
    pub fn distance<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Distance {
        let (a, b) = (a.into(), b.into());
        let Some([a, b]) = meshes(&a, &b) else { return table::separation(&a.shape(), &b.shape()).into() };
        let mut warm_start = WarmStart::default();
        let warm_start = self.cache.map_or(&mut warm_start, |cache| &mut cache.warm_start);
        of_meshes::distance(a, b, warm_start, &self.options)
    }

    /// As [`within`].
    #[must_use]
    pub fn within<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> bool {
        self.nearness(a, b, clearance) != Proximity::Apart
    }

    /// As [`nearness`].
    #[must_use]
    pub fn nearness<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> Proximity {
        let (a, b) = (a.into(), b.into());
        if clearance.is_nan() || clearance < 0.0 {
            return Proximity::Apart;
        }
        let Some([a, b]) = meshes(&a, &b) else { return self.nearness_of_shapes(&a, &b, clearance) };
        let mut warm_start = WarmStart::default();
        let warm_start = self.cache.map_or(&mut warm_start, |cache| &mut cache.warm_start);
        of_meshes::nearness(a, b, clearance, warm_start, &self.options)
    }

    /// [`nearness`](Self::nearness) of two things of which one is no mesh; the clearance is not negative.
    pub(super) fn nearness_of_shapes(self, a: &Placed<'_>, b: &Placed<'_>, clearance: f64) -> Proximity {
        let (a, b) = (a.shape(), b.shape());
        match self.cache {
            Some(cache) => shapes::nearness_from(&a, &b, clearance, &mut cache.coherence),
            None => shapes::nearness(&a, &b, clearance),
        }
    }
}
