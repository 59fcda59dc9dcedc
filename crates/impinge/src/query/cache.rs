//! What earlier answers about two things tell the next one.

use super::last_hit::LastHit;
use crate::convex::Coherence;
use crate::mesh::WarmStart;

/// What was learnt from earlier questions about two things; the caller keeps one for each two.
///
/// Any verb of [`Query`](super::Query) may use it. It makes the next answer faster if the things moved little in between. It
/// changes no answer, with one exception: if millions of pairs of faces are equally near, [`distance`](super::distance()) may return
/// another of the proved intervals. A cache that is used for other things, or after a refit, does no harm.
///
/// Of two meshes it keeps the faces that met last and those that were nearest. If a search for the distance takes milliseconds,
/// as it does if many places are about as near as the nearest, and the meshes move by less than a sixteenth of their distance from
/// one question to the next, it also keeps where the search ended. That takes some megabytes, 17 at most, and the next search takes
/// about a thirtieth of the time. Of two convex shapes it keeps a direction along which they were apart.
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
