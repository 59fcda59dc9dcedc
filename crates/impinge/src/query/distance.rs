//! How far apart two things are, and whether they keep a clearance.

use super::placed::{Placed, meshes};
use super::shapes::table;
use super::{Distance, Proximity, Query, of_meshes, shapes};
use crate::mesh::WarmStart;

/// Computes the distance of two things in world units, as a proved interval, with the nearest
/// points.
///
/// The function never fails. If a mesh is empty, both bounds are infinite and there are no nearest
/// points. If a common point is proved, the upper bound is zero.
///
/// Two meshes also get the pair of nearest faces. It is the pair with the least distance by the
/// closed form; among equal distances the smallest face of the first mesh wins, then that of the
/// second. There are two exceptions. If hundreds of pairs tie, on flat sides that face each other,
/// the result is one of these pairs. If the surfaces intersect, the result is the pair that
/// [`intersects`](super::intersects()) finds first, with a common point. That pair depends on how
/// the hierarchies were built.
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
/// - For two meshes the width is at most 2^-44 of the diagonal of the box around both, and mostly
///   2^-45. It does not depend on how far the meshes are from the origins of their frames and of
///   the world. For flat sides that face each other it is a few units in the last place (tests:
///   `tests/it/distance`, against rational numbers). The lower bound is zero if one mesh is an open
///   solid and it is undecided whether the other mesh is inside it.
/// - For polytopes (points, segments, triangles, boxes, hulls) and half-spaces the width is at most
///   2^-36 of the distance, however small the distance is. Spheres and capsules add two terms:
///   twice the radius times the relative stretch of the pose, and 2^-46 of the size of their cores.
/// - For other round shapes the width is about 2^-40 of the size. It grows to 2^-23 if the shapes
///   are turned so that several points are equally near (tests: `tests/it/shapes`).
///
/// The nearest points are rounded once more, to the coordinates of the world.
///
/// # Complexity
/// For meshes that are apart the time is logarithmic, and grows with the number of faces that are
/// about as near as the nearest. Copies of a face count once if many faces tie. Flat sides that
/// face each other take one pass over the vertices instead. For meshes that intersect the time is
/// that of [`intersects`](super::intersects()).
///
/// # Source
/// Meshes: Larsen, Gottschalk, Lin, Manocha, *Fast proximity queries with swept sphere volumes*,
/// ICRA 2000. Our bounds differ: they come from eight boxes at a time and from the direction
/// between the nearest points so far, and they are proved. Convex shapes: see
/// [`convex`](crate::convex).
#[must_use]
pub fn distance<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Distance {
    Query::new().distance(a, b)
}

/// Reports whether the distance of two things is at most `clearance`, in world units.
///
/// The function never fails. It returns `false` if `clearance` is negative or NaN, or if a mesh is
/// empty. A thing inside a solid has distance zero from it. If rounding leaves the answer
/// undecided, it returns `true`; [`nearness`] then returns `Undecided`.
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
/// As for [`intersects`](super::intersects()): exact for the real images of meshes, polytopes and
/// half-spaces.
///
/// # Complexity
/// For two meshes the search stops at the first pair of faces within the clearance. If there is no
/// such pair, each pair of faces whose distance equals the clearance to the last digits takes about
/// a microsecond. Flat sides that face each other take one pass over the faces. Two convex shapes
/// with a [`Cache`](super::Cache) take one call of the support function of each, if they are still
/// apart along the last direction.
#[must_use]
pub fn within<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> bool {
    Query::new().within(a, b, clearance)
}

/// Returns whether the distance of two things is at most `clearance`, in world units, or that this
/// is undecided.
///
/// [`Proximity::Intersects`] means that the distance is at most `clearance`, [`Proximity::Apart`]
/// that it is greater. A clearance of zero gives the answer of [`proximity`](super::proximity()).
/// The function never fails; it returns [`Apart`](Proximity::Apart) if `clearance` is negative or
/// NaN, or if a mesh is empty. Accuracy and complexity are those of [`within`].
///
/// ```
/// use impinge::query::{self, Proximity};
/// use impinge::{Pose, Shape};
///
/// let sphere = Shape::sphere([0.0; 3], 1.0)?;
/// let [here, there] = [0.0, 3.0].map(|x| sphere.at(Pose::from_translation([x, 0.0, 0.0]).unwrap()).unwrap());
/// assert_eq!(query::nearness(&here, &there, 0.5), Proximity::Apart);
/// assert_eq!(query::nearness(&here, &there, 1.5), Proximity::Intersects);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn nearness<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> Proximity {
    Query::new().nearness(a, b, clearance)
}

impl Query<'_> {
    /// Computes the distance of two things in world units, as a proved interval with the nearest
    /// points, as [`distance`] does.
    #[must_use]
    pub fn distance<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Distance {
        let a = a.into();
        let b = b.into();
        let Some([a, b]) = meshes(&a, &b) else {
            return table::separation(&a.shape(), &b.shape(), self.options.budget).into();
        };
        let mut warm_start = WarmStart::default();
        let warm_start = self.cache.map_or(&mut warm_start, |cache| &mut cache.warm_start);
        of_meshes::distance(a, b, warm_start, &self.options)
    }

    /// Reports whether the distance of two things is at most `clearance`, in world units, as
    /// [`within`] does.
    #[must_use]
    pub fn within<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> bool {
        self.nearness(a, b, clearance) != Proximity::Apart
    }

    /// Returns whether the distance of two things is at most `clearance`, in world units, or that
    /// this is undecided, as [`nearness`] does.
    #[must_use]
    pub fn nearness<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> Proximity {
        let a = a.into();
        let b = b.into();
        if clearance.is_nan() || clearance < 0.0 {
            return Proximity::Apart;
        }
        let Some([a, b]) = meshes(&a, &b) else { return self.nearness_of_shapes(&a, &b, clearance) };
        let mut warm_start = WarmStart::default();
        let warm_start = self.cache.map_or(&mut warm_start, |cache| &mut cache.warm_start);
        of_meshes::nearness(a, b, clearance, warm_start, &self.options)
    }

    /// Returns [`nearness`](Self::nearness) of two things that are not both meshes. `clearance`
    /// must not be negative or NaN.
    pub(super) fn nearness_of_shapes(self, a: &Placed<'_>, b: &Placed<'_>, clearance: f64) -> Proximity {
        let a = a.shape();
        let b = b.shape();
        match self.cache {
            Some(cache) => shapes::nearness_from(&a, &b, clearance, &mut cache.coherence, self.options.budget),
            None => shapes::nearness(&a, &b, clearance, self.options.budget),
        }
    }
}
