//! Whether two things intersect.

use super::last_hit::LastHit;
use super::placed::{Placed, meshes};
use super::{Proximity, Query, of_meshes};

/// Reports whether two things have a point in common. Touching counts.
///
/// The things are compared where their poses place them in the world. The function never fails, and
/// returns `false` if one of the things is an empty mesh.
///
/// # Accuracy
/// - Exact for meshes, as surfaces or as closed solids, and for boxes, triangles, hulls and
///   half-spaces: the answer is true of their real images under the given poses, at any scale,
///   without a tolerance.
/// - Exact for spheres and capsules too, if their poses are exactly orthogonal.
/// - For other round shapes and for open solids the function returns `true` unless the things are
///   proved to be apart. [`proximity`] tells both cases apart.
///
/// # Complexity
/// For two meshes the search stops at the first pair of faces found. It takes logarithmic time if
/// the meshes are deep in each other or well apart. If one mesh is solid and the surfaces are
/// apart, each connected component of the other mesh costs as much as
/// [`Mesh::contains`](crate::Mesh::contains) for one point. The first such query of a mesh takes
/// O(n log n). For shapes see [`proximity`].
///
/// ```
/// use impinge::{Mesh, Pose, Positions, Shape, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// assert!(query::intersects(&mesh, mesh.at(Pose::from_translation([1.0, 0.0, 0.0])?))); // in a corner
/// let crate_ = Shape::cuboid([0.5; 3])?;
/// assert!(query::intersects(&mesh, crate_.at(Pose::from_translation([0.0, 0.0, 0.5])?)?)); // they touch
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn intersects<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> bool {
    Query::new().intersects(a, b)
}

/// Returns whether two things have a point in common, or that this is undecided. Touching counts.
///
/// The function never fails, and returns [`Apart`](Proximity::Apart) if one of the things is an
/// empty mesh.
///
/// # Accuracy
/// As for [`intersects`]. The answer is [`Undecided`](Proximity::Undecided) only if round shapes
/// touch to within rounding, or if a component of one thing may be inside an open solid and no
/// proof is found.
///
/// # Complexity
/// Two convex shapes take about 10 calls of the support function of each. A mesh and a convex shape
/// take as much for each face whose box is near the shape. Polytopes that nearly touch take a few
/// microseconds of exact arithmetic for each of a few vertices. For two meshes see [`intersects`].
#[must_use]
pub fn proximity<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Proximity {
    Query::new().proximity(a, b)
}

impl Query<'_> {
    /// Reports whether two things have a point in common, as [`intersects`] does. Touching counts.
    #[must_use]
    pub fn intersects<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> bool {
        self.proximity(a, b) != Proximity::Apart
    }

    /// Returns whether two things have a point in common, or that this is undecided, as
    /// [`proximity`] does. Touching counts.
    #[must_use]
    pub fn proximity<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Proximity {
        let a = a.into();
        let b = b.into();
        let Some([a, b]) = meshes(&a, &b) else { return self.nearness_of_shapes(&a, &b, 0.0) };
        let mut last_hit = LastHit::default();
        let last_hit = self.cache.map_or(&mut last_hit, |cache| &mut cache.last_hit);
        of_meshes::proximity(a, b, last_hit, &self.options)
    }
}
