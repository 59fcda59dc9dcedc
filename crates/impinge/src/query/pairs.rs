//! Finds the pairs of intersecting faces, one face from each of two meshes.

use super::{Query, pair_order};
use crate::budget::Stopped;
use crate::mesh::{PlacedMesh, Share, any_hit, collect_intersecting, collect_share};

/// Returns all pairs of faces (face of `a`, face of `b`) that have a point in common, sorted and
/// without duplicates.
///
/// Each mesh is its surface here, even if it is given as a solid. Touching counts. The list is
/// empty if a mesh is empty.
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
/// # Accuracy
/// Exact for the real images of the faces under the poses: there is no tolerance.
///
/// # Complexity
/// The time grows with the number of pairs of boxes that overlap near the intersection. The search
/// runs on all threads of the current rayon pool.
#[must_use]
pub fn intersecting_pairs<'a, 'b>(a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> Vec<[u32; 2]> {
    Query::new().intersecting_pairs(a, b)
}

/// Intersecting pairs of faces up to a limit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LimitedPairs {
    /// The first pairs in sorted order, at most the limit. Each pair has the index of a face of the
    /// first mesh, then of a face of the second.
    pub pairs: Vec<[u32; 2]>,
    /// Whether there are more pairs than the limit.
    pub truncated: bool,
}

/// Returns the first `limit` pairs of [`intersecting_pairs`], and whether there are more. Use it if
/// all pairs may not fit in memory.
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
/// # Accuracy
/// Exact, as for [`intersecting_pairs`].
///
/// # Complexity
/// If there are at most `limit` pairs, as for [`intersecting_pairs`]. Once more are found, all
/// parts of the hierarchy whose pairs come after the pairs that are kept are skipped. Each thread
/// needs memory for a few times `limit` pairs, and for a few thousand.
#[must_use]
pub fn intersecting_pairs_up_to<'a, 'b>(
    a: impl Into<PlacedMesh<'a>>,
    b: impl Into<PlacedMesh<'b>>,
    limit: usize,
) -> LimitedPairs {
    Query::new().intersecting_pairs_up_to(a, b, limit)
}

/// Returns a pair of faces that intersect, or `None` if the surfaces are disjoint. The search stops
/// at the first pair found, which depends on how the hierarchies were built.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// assert_eq!(query::any_intersecting_pair(&mesh, &mesh), Some([0, 0]));
/// let above = mesh.at(Pose::from_translation([0.0, 0.0, 1.0])?);
/// assert_eq!(query::any_intersecting_pair(&mesh, above), None);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// Exact, as for [`intersecting_pairs`].
///
/// # Complexity
/// As for [`intersects`](super::intersects()) of two surfaces.
#[must_use]
pub fn any_intersecting_pair<'a, 'b>(a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> Option<[u32; 2]> {
    Query::new().any_intersecting_pair(a, b)
}

impl Query<'_> {
    /// Returns a pair of faces that intersect, as [`any_intersecting_pair`] does. If the budget
    /// ends the search, the pair may not intersect.
    #[must_use]
    pub fn any_intersecting_pair<'a, 'b>(
        self,
        a: impl Into<PlacedMesh<'a>>,
        b: impl Into<PlacedMesh<'b>>,
    ) -> Option<[u32; 2]> {
        any_hit(a.into(), b.into(), &self.options)
    }

    /// Returns all pairs of faces (face of `a`, face of `b`) that have a point in common, as
    /// [`intersecting_pairs`] does.
    #[must_use]
    pub fn intersecting_pairs<'a, 'b>(
        self,
        a: impl Into<PlacedMesh<'a>>,
        b: impl Into<PlacedMesh<'b>>,
    ) -> Vec<[u32; 2]> {
        let found = collect_intersecting(a.into(), b.into(), usize::MAX, &self.options);
        // Sorting many pairs takes long, and the caller of a canceled query does not want them.
        if self.options.budget.stopped() == Some(Stopped::Canceled) { Vec::new() } else { pair_order::sorted(found) }
    }

    /// Returns the pairs of one share of [`intersecting_pairs`], sorted. The shares can be computed
    /// on different machines: all of them together have each pair once, whatever the vector units
    /// of the machines are, if their meshes have the same hierarchies.
    ///
    /// ```
    /// use impinge::query::{self, Query, Share};
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let pile = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]; 100])?;
    /// let shares = (0..3).filter_map(|index| Share::new(index, 3));
    /// let mut pairs: Vec<_> = shares.flat_map(|share| Query::new().intersecting_pairs_in(&pile, &pile, share)).collect();
    /// pairs.sort_unstable();
    /// assert_eq!(pairs, query::intersecting_pairs(&pile, &pile));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    #[must_use]
    pub fn intersecting_pairs_in<'a, 'b>(
        self,
        a: impl Into<PlacedMesh<'a>>,
        b: impl Into<PlacedMesh<'b>>,
        share: Share,
    ) -> Vec<[u32; 2]> {
        pair_order::sorted(collect_share(a.into(), b.into(), share, &self.options))
    }

    /// Returns the first `limit` pairs of faces (face of `a`, face of `b`) that have a point in
    /// common, and whether there are more, as [`intersecting_pairs_up_to`] does.
    #[must_use]
    pub fn intersecting_pairs_up_to<'a, 'b>(
        self,
        a: impl Into<PlacedMesh<'a>>,
        b: impl Into<PlacedMesh<'b>>,
        limit: usize,
    ) -> LimitedPairs {
        // One more pair than wanted shows whether there are more.
        let found = collect_intersecting(a.into(), b.into(), limit.saturating_add(1), &self.options);
        let mut pairs = pair_order::sorted(found);
        let truncated = pairs.len() > limit;
        pairs.truncate(limit);
        if truncated {
            // A caller with many poses keeps one answer for each pose. Without this the unused
            // capacity would add up.
            pairs.shrink_to_fit();
        }
        LimitedPairs { pairs, truncated }
    }
}
