//! A mesh that meets itself.

use rayon::prelude::*;

use crate::mesh::{Mesh, WantedFaces, collect_self_intersecting};

/// Every pair of faces of one mesh, the lesser first, that meet in more than the hull of the positions that they share;
/// sorted, without duplicates.
///
/// Faces that share a corner or an edge always meet there, which is not reported; that they go through each other, fold
/// over each other or lie in each other elsewhere is. Equal positions are shared, whatever the indices, so that the answer
/// for a soup of triangles is that for the mesh. Copies of one face share all that they have. A face without area is the
/// segment or point that it spans, by the same rule.
///
/// # Accuracy
/// Exact.
///
/// # Complexity
/// Grows with the pairs of faces whose boxes overlap, on all cores of the current rayon pool. Faces at a corner that more than a
/// hundred share, such as those of a fan, count only where the boxes of their directions from it overlap.
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
    let mut pairs = collect_self_intersecting(mesh, WantedFaces::All);
    pairs.par_sort_unstable();
    pairs
}
