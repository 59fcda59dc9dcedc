//! The nearest points of two meshes, by branch and bound over both trees.
//!
//! Source: Larsen, Gottschalk, Lin, Manocha, *Fast proximity queries with swept sphere volumes*, ICRA 2000, for distance by
//! the descent of two trees; ours opens eight children against eight, nearest first, on bounds that are proved.
//!
//! Whether the meshes intersect is asked first, and decided exactly. Where they do not, every pair of faces has a *value*,
//! the distance of their metric corners by the closed form, which depends on nothing but the pair and the query. The answer
//! is the least (value, face of a, face of b) of all pairs. A pair is left out only where it is proved to be worse. So
//! neither the order of the descent nor the vector unit can be seen in the answer.

mod answer;
mod at_hand;
mod between;
mod bounds;
mod front;
mod leaf;
mod meeting;
mod metric;
mod profile;
mod remote;
mod search;
mod task;
mod together;
mod towards;

use crate::mesh::{HostChoice, Options, Placed, first_hit};
use crate::primitive::Vector;
use front::{Front, Standing};
use search::Search;

/// The nearest points of two meshes, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) points: [Vector; 2],
    pub(crate) faces: [u32; 2],
}

/// What a search leaves for the next one of the same two meshes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trail {
    /// The faces that were nearest.
    faces: Option<[u32; 2]>,
    /// Where it ended, if that was kept.
    front: Option<Front>,
    /// How the meshes stood, if it was dear.
    dear: Option<Standing>,
}

/// The nearest points, none where a mesh has no faces.
///
/// Where the meshes intersect the faces are the first that meet in the descent that the meshes' own errors choose.
pub(crate) fn nearest(a: Placed<'_>, b: Placed<'_>, trail: &mut Trail, options: &Options) -> Option<Nearest> {
    if let Some(nearest) = nearest_from_front(a, b, trail, options) {
        return Some(nearest);
    }
    let any = Options { host: HostChoice::SmallerError, ..*options };
    if let Some(faces) = first_hit(a, b, &any) {
        *trail = Trail { faces: Some(faces), ..Trail::default() };
        return Some(answer::meeting(a, b, faces));
    }
    let mut search = Search::new(a, b, options, f64::INFINITY)?;
    if let Some((best, aside)) = remote::nearest(&search.scene) {
        *trail = Trail { faces: Some(best.faces), ..Trail::default() };
        return Some(search.scene.finish(&best, aside));
    }
    let _ = search.try_first(trail.faces);
    search.run(options, trail.dear.as_ref());
    let nearest = search.nearest();
    *trail = search.leave(nearest.map(|nearest| nearest.faces));
    nearest
}

/// Likewise where the last search left a front from which this one proves that the meshes are apart.
fn nearest_from_front(a: Placed<'_>, b: Placed<'_>, trail: &mut Trail, options: &Options) -> Option<Nearest> {
    let front = trail.front.take()?;
    let options = front.options(options);
    let mut search = Search::new(a, b, &options, f64::INFINITY)?;
    search.answer.may_meet = Some(false);
    let _ = search.try_first(trail.faces);
    // Of triangles that cross the closed form says nothing.
    if !search.go_on(front, &options) || search.answer.may_meet == Some(true) {
        return None;
    }
    let nearest = search.nearest();
    *trail = search.leave(nearest.map(|nearest| nearest.faces));
    nearest
}

/// Faces that are no farther apart than `clearance`, if there are such.
pub(crate) fn within(
    a: Placed<'_>,
    b: Placed<'_>,
    clearance: f64,
    trail: &mut Trail,
    options: &Options,
) -> Option<[u32; 2]> {
    if clearance.is_nan() || clearance < 0.0 || a.mesh.faces().is_empty() || b.mesh.faces().is_empty() {
        return None;
    }
    if clearance == f64::INFINITY {
        return Some([0, 0]);
    }
    let front = trail.front.take();
    let options = front.as_ref().map_or(*options, |front| front.options(options));
    let mut search = Search::new(a, b, &options, clearance)?;
    if search.try_first(trail.faces).is_break() {
        trail.front = front;
        return search.answer.kept;
    }
    if !front.is_some_and(|front| search.go_on(front, &options)) {
        search.run(&options, trail.dear.as_ref());
    }
    let kept = search.answer.kept;
    *trail = search.leave(kept.or(trail.faces));
    kept
}
