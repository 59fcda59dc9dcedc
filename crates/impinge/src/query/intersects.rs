//! Whether two things intersect.

use super::last_hit::LastHit;
use super::placed::{Placed, meshes};
use super::{Proximity, Query, of_meshes};

/// Whether two things have a point in common; touching counts.
///
/// # Accuracy
/// The answer about meshes, as surfaces or as closed solids, and about boxes, triangles, hulls and half-spaces is the truth about
/// their real images under the given poses: no tolerance, no scale. So it is for spheres and capsules among these, if their poses are
/// exactly orthogonal. For other round shapes and open solids the answer is true unless they are proved to be apart;
/// [`proximity`] tells which.
///
/// # Complexity
/// For two meshes it stops at the first pair of faces found: logarithmic if they are deep in each other or well apart. If one is
/// solid and the surfaces are apart, it takes for each connected component of the other that of
/// [`Mesh::contains`](crate::Mesh::contains) for one point, and O(n log n) the first time that a mesh is asked. For shapes see
/// [`proximity`].
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

/// Whether two things have a point in common, as far as that is proved; touching counts.
///
/// # Accuracy
/// As [`intersects`]. Undecided are only round shapes that touch to within rounding, and an open solid if a component of the other
/// thing counts as inside it without proof.
///
/// # Complexity
/// Two convex shapes take some 10 supports of either; a mesh and a shape those of each face whose boxes are near. Polytopes that
/// nearly touch take some microseconds of exact arithmetic for each of a few vertices. For two meshes see [`intersects`].
#[must_use]
pub fn proximity<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Proximity {
    Query::new().proximity(a, b)
}

impl Query<'_> {
    /// As [`intersects`].
    #[must_use]
    pub fn intersects<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> bool {
        self.proximity(a, b) != Proximity::Apart
    }

    /// As [`proximity`].
    #[must_use]
    pub fn proximity<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Proximity {
        let (a, b) = (a.into(), b.into());
        let Some([a, b]) = meshes(&a, &b) else { return self.nearness_of_shapes(&a, &b, 0.0) };
        let mut last_hit = LastHit::default();
        let last_hit = self.cache.map_or(&mut last_hit, |cache| &mut cache.last_hit);
        of_meshes::proximity(a, b, last_hit, &self.options)
    }
}
