//! The two verbs: the nearest points of two meshes, and faces within a clearance.
//!
//! Guarded by `tests/it/distance/meshes.rs`, `clearances.rs` and `plates.rs`.

use super::far_apart;
use super::scene::{Nearest, intersecting};
use super::search::Search;
use super::warm_start::WarmStart;
use crate::mesh::{HostChoice, Options, PlacedMesh, first_hit};

/// Returns the nearest points of two meshes in the world frame, or `None` if a mesh has no faces.
///
/// If the meshes intersect, the returned faces are the first intersecting pair that the descent
/// finds, with the host chosen by [`HostChoice::SmallerError`].
pub(crate) fn nearest(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    warm_start: &mut WarmStart,
    options: &Options<'_>,
) -> Option<Nearest> {
    if let Some(nearest) = nearest_from_frontier(a, b, warm_start, options) {
        return Some(nearest);
    }
    let any = Options { host: HostChoice::SmallerError, ..*options };
    let hit = first_hit(a, b, &any);
    let is_stopped = options.budget.stopped().is_some();
    if let Some(faces) = hit.filter(|_| !is_stopped) {
        *warm_start = WarmStart { faces: Some(faces), ..WarmStart::default() };
        return Some(intersecting(a, b, faces));
    }
    let mut search = Search::new(a, b, options, f64::INFINITY)?;
    if is_stopped {
        return search.answer.nearest(&search.scene, true);
    }
    if let Some((best, aside)) = far_apart::nearest(&search.scene) {
        *warm_start = WarmStart { faces: Some(best.faces), ..WarmStart::default() };
        return Some(search.scene.finish(&best, aside));
    }
    let _ = search.try_faces(warm_start.faces);
    search.run(options, warm_start.costly.as_ref());
    let nearest = search.nearest();
    *warm_start = search.into_warm_start(nearest.map(|nearest| nearest.faces));
    nearest
}

/// Returns the nearest points by resuming at the frontier of the last search. Returns `None` if
/// there is no frontier or if the resumed search does not prove that the meshes are apart.
fn nearest_from_frontier(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    warm_start: &mut WarmStart,
    options: &Options<'_>,
) -> Option<Nearest> {
    let frontier = warm_start.frontier.take()?;
    let options = frontier.options(options);
    let mut search = Search::new(a, b, &options, f64::INFINITY)?;
    search.answer.may_intersect = Some(false);
    let _ = search.try_faces(warm_start.faces);
    // The closed form is not valid for triangles that cross.
    if !search.resume(frontier, &options) || search.answer.may_intersect == Some(true) {
        return None;
    }
    let nearest = search.nearest();
    *warm_start = search.into_warm_start(nearest.map(|nearest| nearest.faces));
    nearest
}

/// Returns a pair of faces that are no farther apart than `clearance`, in world units, or `None` if
/// there is no such pair. Returns `None` if the clearance is negative or NaN. A search that
/// its budget ends returns the first faces.
pub(crate) fn within(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    clearance: f64,
    warm_start: &mut WarmStart,
    options: &Options<'_>,
) -> Option<[u32; 2]> {
    if clearance.is_nan() || clearance < 0.0 || a.mesh.faces().is_empty() || b.mesh.faces().is_empty() {
        return None;
    }
    if clearance == f64::INFINITY {
        return Some([0, 0]);
    }
    let frontier = warm_start.frontier.take();
    let options = frontier.as_ref().map_or(*options, |frontier| frontier.options(options));
    let mut search = Search::new(a, b, &options, clearance)?;
    if search.try_faces(warm_start.faces).is_break() {
        warm_start.frontier = frontier;
        return search.answer.kept;
    }
    if !frontier.is_some_and(|frontier| search.resume(frontier, &options)) {
        search.run(&options, warm_start.costly.as_ref());
    }
    let kept = search.answer.kept.or(search.slices.is_stopped.then_some([0, 0]));
    *warm_start = search.into_warm_start(kept.or(warm_start.faces));
    kept
}
