//! The questions one asks of two meshes, and in [`shapes`] of two shapes. What they take was judged before, so they cannot
//! fail.

mod curves;
mod distance;
mod hits;
mod pair_order;
mod patches;
mod penetrates;
mod penetration;
mod self_intersection;
pub mod shapes;
mod solid;

pub use curves::{Curves, curves_of_pairs, intersection_curves};
pub use distance::{Distance, Witness, WitnessCache, distance, distance_with, within, within_with};
pub use hits::{HitCache, intersects, intersects_with};
pub(crate) use patches::contacts_of_patches;
pub(crate) use patches::normals_of_regions;
pub use patches::{ContactPatch, contact_patches};
pub use penetrates::{Penetrates, penetrates, penetrates_of_pairs};
pub use penetration::penetration;
pub use self_intersection::self_intersecting_pairs;
pub use solid::{
    Contained, Solid, SolidIntersection, distance_of_solids, distance_of_solids_with, intersects_solid,
    intersects_solid_with, nested, solid_intersection, solid_intersection_of_pairs, within_of_solids,
    within_of_solids_with,
};

use crate::mesh::{Options, Placed, collect_intersecting};

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

/// Some of the pairs that there are, where a limit was set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SomePairs {
    /// The first ones in their order, each a face of `a` and one of `b`.
    pub pairs: Vec<[u32; 2]>,
    /// Whether there are more than these.
    pub truncated: bool,
}

/// The first `limit` of all [`intersecting_pairs`] in their order, and whether there are more: for meshes of which so many
/// faces may meet that not all pairs fit in memory.
///
/// ```
/// use impinge::mesh::Options;
/// use impinge::{Mesh, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let pile = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]; 100])?;
/// let some = query::intersecting_pairs_up_to(&pile, &pile, 3, &Options::default());
/// assert_eq!(some.pairs, [[0, 0], [0, 1], [0, 2]]);
/// assert!(some.truncated);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Complexity
/// Time grows with the pairs of leaves whose boxes overlap: leaves whose faces all come after the pairs that are kept are passed over.
/// Takes the memory of a few times `limit` pairs for each thread.
#[must_use]
pub fn intersecting_pairs_up_to<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    limit: usize,
    options: &Options,
) -> SomePairs {
    // One more than is wanted says whether there are more.
    let mut pairs = pair_order::sorted(collect_intersecting(a.into(), b.into(), limit.saturating_add(1), options));
    let truncated = pairs.len() > limit;
    pairs.truncate(limit);
    if truncated {
        // Whoever asks about many poses keeps as many answers: the room for what was found and not kept is not theirs.
        pairs.shrink_to_fit();
    }
    SomePairs { pairs, truncated }
}
