//! The metric frame, in which the distances of two meshes are measured: the world's axes, an origin
//! at one of the meshes, and a unit in which the meshes are about one unit large.
//!
//! Poses may stretch and shear, so distances can only be measured along the world's axes. But world
//! coordinates lose digits far from the world's origin. So corners are taken relative to the center
//! of their mesh, rotated into the world, and moved by an offset that is computed with twice the
//! digits. Their error is relative to the size of the meshes and the gap between them. It does not
//! grow with the distance of the meshes from the world's origin or from their own.

use crate::math::relative::{UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::{Vector, length, scaled_length};
use crate::mesh::PlacedMesh;
use crate::mesh::storage::frame::reciprocal_power_of_two;
use crate::primitive::{CLOSED_FORM_ERROR, accurate_sum_of_products};

/// Scale of meshes of a size of 2^-900 or less: the largest scale that [`reciprocal_power_of_two`]
/// returns.
const MAX_SCALE: f64 = f64::from_bits((1023 + 900) << 52);

/// The maps of two meshes to the metric frame. Swapping the meshes swaps the maps and changes no
/// bit.
#[derive(Clone, Debug)]
pub(crate) struct Metric {
    /// Number of metric units in one unit of the world, a power of two.
    pub(crate) scale: f64,
    /// Origin of the metric frame in the world, rounded.
    pub(crate) origin: Vector,
    pub(crate) maps: [MetricMap; 2],
    /// Error bound of the distance of two triangles that is computed from metric corners, in metric
    /// units.
    pub(crate) error: f64,
    /// Upper bound of the distance of any two points of the meshes, in metric units.
    pub(crate) diagonal: f64,
    /// Sum of the half-diagonals of the boxes of both meshes, in metric units.
    pub(crate) extent: f64,
    /// Half-diagonal of the box of the smaller mesh, in metric units.
    pub(crate) smaller_extent: f64,
}

/// Map from a mesh's own frame to the metric frame: `metric = linear · (local - center) + offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MetricMap {
    pub(crate) linear: [Vector; 3],
    pub(crate) center: Vector,
    pub(crate) offset: Vector,
}

impl Metric {
    /// Computes the metric frame of two placed meshes.
    ///
    /// # Accuracy
    /// A coordinate of a metric corner takes six roundings of terms that sum to the mesh's
    /// half-extent on that axis, and two roundings of the offset. Evaluating the offset adds 2^-98
    /// of the terms that cancel in it. All of them are counted as eight roundings. The closed form
    /// of two triangles adds [`CLOSED_FORM_ERROR`] of the diagonal (docs/notes/proof.md, L14).
    pub(crate) fn new(a: PlacedMesh<'_>, b: PlacedMesh<'_>) -> Self {
        let placed = [a, b];
        let first = usize::from(precedes(b, a));
        let second = 1 - first;
        let (from, to) = (terms(placed[first]), terms(placed[second]));
        let mut offsets = [[0.0; 3]; 2];
        let mut cancelled = 0.0_f64;
        let mut origin = [0.0; 3];
        for axis in 0..3 {
            let negated = from[axis].map(|(x, y)| (-x, y));
            let both = [to[axis], negated].concat();
            offsets[second][axis] = accurate_sum_of_products(&both);
            cancelled = cancelled.max(both.iter().map(|(x, y)| (x * y).abs()).sum());
            origin[axis] = accurate_sum_of_products(&from[axis]);
        }
        let halves = placed.map(half_extents);
        let reaches =
            [0, 1].map(|side| scaled_length(&[0, 1, 2].map(|k| halves[side][k] + f64::abs(offsets[side][k]))));
        let scale = reciprocal_power_of_two(reaches[0].max(reaches[1]));
        let side = |k: usize| {
            let ends = [0, 1].map(|m| (offsets[m][k] - halves[m][k], offsets[m][k] + halves[m][k]));
            f64::max(ends[0].1, ends[1].1) - f64::min(ends[0].0, ends[1].0)
        };
        let diagonal = length(&[side(0), side(1), side(2)].map(|x| x * scale)) * (1.0 + 1e-12);
        let corners = 8.0 * UNIT_ROUNDOFF * (reaches[0] + reaches[1]) * scale;
        const CANCELLED: f64 = 1.0 / (1_u128 << 96) as f64;
        // For products and sums of numbers that are nearly too small for a float.
        let vanished = 64.0 * UNDERFLOW * scale;
        let rounded = CLOSED_FORM_ERROR * diagonal + corners + 2.0 * CANCELLED * cancelled * scale;
        // If no power of two in range makes the meshes one unit large, the error is so large that
        // nothing is proved.
        let unknown = if scale >= MAX_SCALE { 2.0 * diagonal } else { 0.0 };
        let error = (rounded + vanished + unknown) * (1.0 + 1e-12);
        let map = |side: usize| MetricMap {
            linear: placed[side].world_from_mesh.linear().map(|row| row.map(|x| x * scale)),
            center: placed[side].mesh.0.frame.origin,
            offset: offsets[side].map(|x| x * scale),
        };
        let extents = [0, 1].map(|m| scaled_length(&halves[m]) * scale);
        let (extent, smaller_extent) = (extents[0] + extents[1], extents[0].min(extents[1]));
        Self { scale, origin, maps: [map(0), map(1)], error, diagonal, extent, smaller_extent }
    }

    /// Returns a point of the metric frame in the world, rounded.
    pub(crate) fn to_world(&self, point: Vector) -> Vector {
        std::array::from_fn(|k| point[k] / self.scale + self.origin[k])
    }
}

impl MetricMap {
    /// Returns the image of a point of the mesh's own frame in the metric frame.
    #[inline(always)]
    pub(crate) fn apply(&self, point: Vector) -> Vector {
        let [x, y, z] = [0, 1, 2].map(|k| point[k] - self.center[k]);
        [0, 1, 2].map(|k| {
            let row = &self.linear[k];
            (row[0] * x + row[1] * y + row[2] * z) + self.offset[k]
        })
    }
}

/// Reports whether a placed mesh precedes another in an order that depends on nothing else. Meshes
/// that the order does not distinguish have the same image of their center.
fn precedes(one: PlacedMesh<'_>, other: PlacedMesh<'_>) -> bool {
    let key = |placed: PlacedMesh<'_>| {
        let (pose, frame) = (placed.world_from_mesh, placed.mesh.0.frame);
        let mut key = [0.0; 15];
        key[..9].copy_from_slice(pose.linear().as_flattened());
        key[9..12].copy_from_slice(pose.translation());
        key[12..].copy_from_slice(&frame.origin);
        key
    };
    key(one) < key(other)
}

/// Returns the products that sum up to the world image of the mesh's center, by axis.
fn terms(placed: PlacedMesh<'_>) -> [[(f64, f64); 4]; 3] {
    let (pose, center) = (placed.world_from_mesh, placed.mesh.0.frame.origin);
    [0, 1, 2].map(|k| {
        let row = &pose.linear()[k];
        [(row[0], center[0]), (row[1], center[1]), (row[2], center[2]), (pose.translation()[k], 1.0)]
    })
}

/// Returns how far a mesh reaches from the image of its center along each axis of the world, at
/// most.
fn half_extents(placed: PlacedMesh<'_>) -> Vector {
    let local = placed.mesh.0.half_extents;
    placed
        .world_from_mesh
        .linear()
        .map(|row| (row[0].abs() * local[0] + row[1].abs() * local[1] + row[2].abs() * local[2]) * (1.0 + 1e-12))
}
