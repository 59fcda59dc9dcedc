//! The questions one asks of two meshes, and in [`shapes`] of two shapes. What they take was judged before, so they cannot
//! fail.

mod curves;
mod distance;
mod pair_order;
mod patches;
mod penetrates;
mod penetration;
mod self_intersection;
pub mod shapes;
mod solid;

pub use curves::{Curves, curves_of_pairs, intersection_curves};
pub use distance::{Distance, Witness, WitnessCache, distance, distance_with, within, within_with};
pub(crate) use patches::contacts_of_patches;
pub use patches::{ContactPatch, contact_patches};
pub use penetrates::{Penetrates, penetrates, penetrates_of_pairs};
pub use penetration::penetration;
pub use self_intersection::self_intersecting_pairs;
pub use solid::{
    Contained, Solid, SolidIntersection, distance_of_solids, distance_of_solids_with, intersects_solid,
    solid_intersection, solid_intersection_of_pairs, within_of_solids, within_of_solids_with,
};

use crate::mesh::{Options, Placed, collect_intersecting, meet};

/// Whether the surfaces of two meshes have a point in common; touching counts.
///
/// The answer is the truth about the real images of the closed triangles under the given maps: no tolerance, no scale.
///
/// # Complexity
/// Stops at the first pair found: logarithmic where the meshes are deep in each other or well apart.
#[must_use]
pub fn intersects<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> bool {
    intersects_with(a, b, &Options::default())
}

/// [`intersects`], run in a stated way.
#[must_use]
pub fn intersects_with<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, options: &Options) -> bool {
    meet(a.into(), b.into(), options)
}

/// Every pair of faces (of `a`, of `b`) that have a point in common, sorted, without duplicates.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let touching = Pose::from_translation([1.0, 0.0, 0.0])?;
/// assert_eq!(query::intersecting_pairs(&mesh, mesh.at(touching)), [[0, 0]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Complexity
/// Grows with the pairs of boxes that overlap near the intersection, on all cores of the current rayon pool.
#[must_use]
pub fn intersecting_pairs<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Vec<[u32; 2]> {
    intersecting_pairs_with(a, b, &Options::default())
}

/// [`intersecting_pairs`], run in a stated way.
#[must_use]
pub fn intersecting_pairs_with<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    options: &Options,
) -> Vec<[u32; 2]> {
    pair_order::sorted(collect_intersecting(a.into(), b.into(), usize::MAX, options))
}
