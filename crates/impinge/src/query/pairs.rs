//! The pairs of faces of two meshes that intersect.

use super::{Query, pair_order};
use crate::mesh::{PlacedMesh, collect_intersecting};

/// Every pair of faces (of `a`, of `b`) that have a point in common, sorted, without duplicates. Meshes are their surfaces here.
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
pub fn intersecting_pairs<'a, 'b>(a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> Vec<[u32; 2]> {
    Query::new().intersecting_pairs(a, b)
}

/// Some of the pairs that there are, where a limit was set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SomePairs {
    /// The first ones in their order, each a face of `a` and one of `b`.
    pub pairs: Vec<[u32; 2]>,
    /// Whether there are more than these.
    pub truncated: bool,
}

/// The first `limit` of all [`intersecting_pairs`] in their order, and whether there are more. It is for meshes whose pairs may not
/// all fit in memory.
///
/// ```
/// use impinge::{Mesh, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let pile = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]; 100])?;
/// let some = query::intersecting_pairs_up_to(&pile, &pile, 3);
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
    a: impl Into<PlacedMesh<'a>>,
    b: impl Into<PlacedMesh<'b>>,
    limit: usize,
) -> SomePairs {
    Query::new().intersecting_pairs_up_to(a, b, limit)
}

impl Query<'_> {
    /// As [`intersecting_pairs`].
    #[must_use]
    pub fn intersecting_pairs<'a, 'b>(
        self,
        a: impl Into<PlacedMesh<'a>>,
        b: impl Into<PlacedMesh<'b>>,
    ) -> Vec<[u32; 2]> {
        pair_order::sorted(collect_intersecting(a.into(), b.into(), usize::MAX, &self.options))
    }

    /// As [`intersecting_pairs_up_to`].
    #[must_use]
    pub fn intersecting_pairs_up_to<'a, 'b>(
        self,
        a: impl Into<PlacedMesh<'a>>,
        b: impl Into<PlacedMesh<'b>>,
        limit: usize,
    ) -> SomePairs {
        // One more than is wanted says whether there are more.
        let found = collect_intersecting(a.into(), b.into(), limit.saturating_add(1), &self.options);
        let mut pairs = pair_order::sorted(found);
        let truncated = pairs.len() > limit;
        pairs.truncate(limit);
        if truncated {
            // A caller with many poses keeps one answer for each. The capacity for the pairs that were dropped would add up.
            pairs.shrink_to_fit();
        }
        SomePairs { pairs, truncated }
    }
}
