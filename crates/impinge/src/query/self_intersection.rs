//! The pairs of faces of one mesh that intersect.

use rayon::prelude::*;

use super::Query;
use crate::mesh::{Mesh, WantedFaces, collect_self_intersecting};

/// Returns all pairs of faces of one mesh that intersect outside of the corners and edges that they
/// share. The smaller index comes first; the list is sorted and has no duplicates.
///
/// More precisely, a pair is returned if the intersection of its faces is larger than the convex
/// hull of the positions that they share. So neighbors are returned only if they also go through
/// each other, fold over each other or overlap elsewhere. Positions are shared if they are equal,
/// whatever the vertex indices are: a soup of separate triangles gets the same answer as the
/// connected mesh. Copies of a face share all of their positions and are never returned. A face
/// without area is the segment or point that it spans, and the same rule applies.
///
/// # Accuracy
/// Exact: there is no tolerance.
///
/// # Complexity
/// The time grows with the number of pairs of faces whose boxes overlap. The search runs on all
/// threads of the current rayon pool. Some corners are shared by more than a hundred faces, such as
/// the center of a fan. There a pair of faces counts only if the boxes of their directions from the
/// corner overlap. Many needles through one place are compared only within small cells of space, so
/// that n needles take about n^1.5 comparisons.
///
/// ```
/// use impinge::{Mesh, Positions, query};
///
/// // Two faces hang together by an edge; a third cuts through both of them.
/// let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.0],
///     [0.5, 0.5, -1.0], [1.5, 1.5, -1.0], [1.0, 1.0, 1.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2], [1, 3, 2], [4, 5, 6]])?;
/// assert_eq!(query::self_intersecting_pairs(&mesh), [[0, 2], [1, 2]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn self_intersecting_pairs(mesh: &Mesh) -> Vec<[u32; 2]> {
    Query::new().self_intersecting_pairs(mesh)
}

impl Query<'_> {
    /// Returns the pairs of [`self_intersecting_pairs`]. If the budget ends the search, these
    /// are the pairs found so far, which the caller must discard.
    #[must_use]
    pub fn self_intersecting_pairs(self, mesh: &Mesh) -> Vec<[u32; 2]> {
        let mut pairs = collect_self_intersecting(mesh, WantedFaces::All, self.options.budget);
        pairs.par_sort_unstable();
        pairs
    }
}
