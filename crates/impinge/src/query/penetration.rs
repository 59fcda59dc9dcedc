//! How deep two meshes are in each other, taken as solids.

use super::intersects_solid;
use super::shapes::{Penetration, penetration_of_solids};
use super::solid::Solid;
use crate::mesh::Placed;

/// How deep two meshes are in each other, taken as solids; none where these have no point in common.
///
/// It is the length of a translation of the second that takes it out of the first, and no property of a pair of faces: smaller
/// triangles make it more accurate and not smaller.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// // Its tip, one unit deep in the floor of a copy.
/// let above = mesh.at(Pose::from_translation([0.5, 0.5, -7.0])?);
/// let depth = query::penetration(&mesh, above).expect("they meet");
/// assert!(depth.lower <= depth.upper && depth.upper < 1.01);
/// assert!(query::penetration(&mesh, mesh.at(Pose::from_translation([9.0, 0.0, 0.0])?)).is_none());
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The true depth lies in `[lower, upper]` (docs/proof.md, L30). The upper end is what a search found: the second mesh was moved by
/// it and proved to be outside; there may be shorter ways out of meshes that are not convex. The lower end is that of two balls
/// about one point, one in each solid, and so is near the upper one where both are round there, and may be far below it where they
/// are thin. Of spheres of 20,480 triangles that overlap by a quarter of their size it is within 1 % (tests:
/// `tests/it/solids/depths.rs`). Where a mesh is open its inside is where its winding number is beyond one half. Closed meshes that
/// only touch have a depth of zero, exactly.
///
/// # Complexity
/// Some dozens of distances, each from the last witness, as many closest points, and that of
/// [`intersection_curves`](super::intersection_curves).
///
/// # Source
/// Je, Tang, Lee, Lee, Kim, *PolyDepth: real-time penetration depth computation using iterative contact-space projection*, ACM
/// Transactions on Graphics 31, 2012; ours advances by proved distances, so that what it returns parts the solids.
#[must_use]
pub fn penetration<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Option<Penetration> {
    let (a, b) = (a.into(), b.into());
    intersects_solid(a, b, Solid::Both).then(|| penetration_of_solids(a, b))
}
