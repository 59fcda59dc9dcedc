//! State that a query keeps for the next query about the same two things.

use super::last_hit::LastHit;
use crate::convex::Coherence;
use crate::mesh::WarmStart;

/// State that a query keeps for the next query about the same two things.
///
/// Keep one cache for each pair of things, and pass it to every query of [`Query`](super::Query).
/// The next answer is found faster if the things moved little in between.
///
/// A cache changes no answer, with one exception: if millions of pairs of faces are equally near,
/// [`distance`](super::distance()) may return another proved interval. A cache that belongs to
/// other things, or to a mesh before it was refitted, makes no answer wrong.
///
/// For two meshes it holds the pair of faces that intersected last and the pair that was nearest.
/// It also holds the frontier of a distance search if two conditions hold: the search takes
/// milliseconds, because many places are about as near as the nearest, and the meshes move by less
/// than 1/16 of their distance between queries. The frontier takes a few megabytes, 17 at most, and
/// makes the next search about 30 times faster. For two convex shapes the cache holds a direction
/// along which they were apart.
///
/// ```
/// use impinge::query::{Cache, Query};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let mut cache = Cache::default();
/// for step in 0..8 {
///     let moved = mesh.at(Pose::from_translation([0.25 * f64::from(step), 0.0, 0.0])?);
///     assert_eq!(Query::new().with_cache(&mut cache).intersects(&mesh, moved), step <= 4);
/// }
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Cache {
    pub(super) last_hit: LastHit,
    pub(super) warm_start: WarmStart,
    pub(super) coherence: Coherence,
}
