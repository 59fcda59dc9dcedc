//! The plane that cuts a piece: of some planes across each axis, the plane whose two hulls are
//! smallest together.
//!
//! The volume of the solid itself is the same on both sides of any cut, so this plane removes the
//! most space that hulls have outside the solid. A hull costs a few microseconds for each thousand
//! points, and a volume is much faster to compute than a distance.
//!
//! Source: planes across three axes are those of Mamou and Ghorbel, *A simple and efficient
//! approach for 3D mesh approximate convex decomposition*, 2009, and of Wei and others,
//! *Approximate convex decomposition for 3D meshes with collision-aware concavity and tree search*,
//! 2022. Ours departs in comparing volumes of hulls, and in adding planes through many vertices.

use rayon::prelude::*;

use super::covering::volume;
use super::frame::{CutPlane, Frame};
use super::piece::Piece;
use crate::budget::Budget;
use crate::hull::Hull;
use crate::math::vec3::Vector;
use crate::mesh::Mesh;

/// Number of equal intervals between whose ends a piece is cut along each axis.
const INTERVALS: usize = 8;

/// Maximum number of planes across each axis that are tried because many vertices are in them.
const MAX_FLAT_PLACES: usize = 8;

/// Minimum number of vertices in a plane for it to be tried.
const MIN_VERTICES: usize = 3;

/// Share of an extent within which offsets count as the same plane. Larger than the rounding of
/// offsets in a frame that is not standard.
const SAME_PLANE: f64 = 1.0 / (1_u64 << 30) as f64;

/// Weight of the difference of both volumes. It prefers even cuts if few planes help, as in a bin,
/// whose walls must all be cut before any hull becomes smaller.
const UNEVENNESS: f64 = 1.0 / 64.0;

/// Returns the plane that divides a piece best, or `None` if no plane divides it. `hull` is the
/// hull of the piece.
pub(super) fn best_plane(
    mesh: &Mesh,
    frame: &Frame,
    (piece, hull): (&Piece, &Hull),
    budget: &Budget<'_>,
) -> Option<CutPlane> {
    let extents: [[f64; 2]; 3] = std::array::from_fn(|axis| extent(frame, axis, hull));
    let size = extents.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
    let planes: Vec<CutPlane> = (0..3)
        .flat_map(|axis| {
            let offsets = offsets(frame, axis, extents[axis], piece.vertices(mesh));
            offsets.into_iter().map(move |offset| CutPlane { axis, offset })
        })
        .collect();
    let scores: Vec<Option<[f64; 2]>> = planes
        .par_iter()
        .map(|&plane| {
            if budget.is_spent() {
                return None;
            }
            let [below, above] = piece.halves(mesh, frame, plane).map(|half| volume_of(mesh, frame, &half, size));
            let [low, high] = extents[plane.axis];
            // Equal volumes, such as those of flat hulls, are decided by the place of the plane.
            let place = (plane.offset - (0.5 * low + 0.5 * high)).abs() - 0.5 * (high - low);
            Some([below + above + UNEVENNESS * (below - above).abs(), place])
        })
        .collect();
    let scored = planes.into_iter().zip(scores).filter_map(|(plane, score)| Some((plane, score?)));
    let smaller = |a: &[f64; 2], b: &[f64; 2]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
    scored.min_by(|a, b| smaller(&a.1, &b.1)).map(|(plane, _)| plane)
}

fn volume_of(mesh: &Mesh, frame: &Frame, piece: &Piece, size: f64) -> f64 {
    let points: Vec<Vector> = piece.points(mesh, frame).iter().map(|point| point.at).collect();
    Hull::new(&points).map_or(0.0, |hull| volume(&hull, size))
}

/// Returns the extent of a hull along an axis, rounded.
fn extent(frame: &Frame, axis: usize, hull: &Hull) -> [f64; 2] {
    let along = hull.positions().iter().map(|at| frame.along(axis, at));
    along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
}

/// Returns the offsets along an axis that are tried: at equal distances, and those that most
/// vertices have.
fn offsets(frame: &Frame, axis: usize, [low, high]: [f64; 2], vertices: impl Iterator<Item = Vector>) -> Vec<f64> {
    let step = (high - low) / INTERVALS as f64;
    let even = (1..INTERVALS).map(|k| low + step * k as f64);
    let mut along: Vec<f64> = vertices.map(|at| frame.along(axis, &at)).collect();
    along.sort_unstable_by(f64::total_cmp);
    let width = (high - low) * SAME_PLANE;
    let mut flat: Vec<(usize, f64)> =
        along.chunk_by(|a, b| b - a <= width).map(|same| (same.len(), same[same.len() / 2])).collect();
    flat.retain(|&(count, _)| count >= MIN_VERTICES);
    flat.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    // In a frame that is not standard, sides of vertices in the plane are not decided. A plane
    // beside them leaves their faces to one part.
    let beside = if frame.is_standard { vec![0.0] } else { vec![-2.0 * width, 2.0 * width] };
    let flat = flat.into_iter().take(MAX_FLAT_PLACES);
    let all = flat.flat_map(|(_, offset)| beside.iter().map(move |by| offset + by)).chain(even);
    all.filter(|&offset| low + width < offset && offset < high - width).collect()
}
