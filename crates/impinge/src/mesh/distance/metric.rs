//! The frame in which two meshes' distances are measured: the world's axes, about one of the meshes and one unit large.
//!
//! Poses may stretch and shear, so distances can be measured in the world alone; and world coordinates lose digits far
//! from the origin. So corners are taken about the centre of their mesh, turned into the world, and moved by an offset
//! that is known to twice the digits: what they are off by is relative to the meshes and the gap between them, however
//! far they are from the world's origin and from their own.

use crate::math::relative::{UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::{Vector, length, scaled_length};
use crate::mesh::PlacedMesh;
use crate::mesh::storage::frame::reciprocal_power_of_two;
use crate::primitive::{CLOSED_FORM_ERROR, accurate_sum_of_products};

/// That of meshes of 2^-900 and less.
const LARGEST_SCALE: f64 = f64::from_bits((1023 + 900) << 52);

/// Two meshes' maps to the metric frame. Swapping the meshes swaps the maps and changes no bit.
#[derive(Clone, Debug)]
pub(crate) struct Metric {
    /// Metric units for one of the world; a power of two.
    pub(crate) scale: f64,
    /// The frame's origin in the world, rounded.
    pub(crate) origin: Vector,
    pub(crate) maps: [MetricMap; 2],
    /// What the distance of two triangles may be off by, in metric units, when it is computed from metric corners.
    pub(crate) error: f64,
    /// No two points of the meshes are farther apart, in metric units.
    pub(crate) diagonal: f64,
    /// How far the meshes reach about their centres, both together, in metric units.
    pub(crate) extent: f64,
    /// How far the smaller of the meshes does.
    pub(crate) smaller_extent: f64,
}

/// `metric = linear · (local - centre) + offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MetricMap {
    pub(crate) linear: [Vector; 3],
    pub(crate) centre: Vector,
    pub(crate) offset: Vector,
}

impl Metric {
    /// # Accuracy
    /// A coordinate of a metric corner takes six roundings of terms that sum to the mesh's half-extent on that axis, and
    /// two of the offset, whose evaluation adds 2^-98 of the terms that cancel in it; both are counted as eight. The
    /// closed form of two triangles adds [`CLOSED_FORM_ERROR`] of the diagonal.
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
        // Products and sums of numbers that are nearly too small for a float.
        let vanished = 64.0 * UNDERFLOW * scale;
        let rounded = CLOSED_FORM_ERROR * diagonal + corners + 2.0 * CANCELLED * cancelled * scale;
        // Where powers of two do not suffice to make the meshes one unit large, nothing is taken for known.
        let unknown = if scale >= LARGEST_SCALE { 2.0 * diagonal } else { 0.0 };
        let error = (rounded + vanished + unknown) * (1.0 + 1e-12);
        let map = |side: usize| MetricMap {
            linear: placed[side].world_from_mesh.linear().map(|row| row.map(|x| x * scale)),
            centre: placed[side].mesh.0.frame.origin,
            offset: offsets[side].map(|x| x * scale),
        };
        let extents = [0, 1].map(|m| scaled_length(&halves[m]) * scale);
        let (extent, smaller_extent) = (extents[0] + extents[1], extents[0].min(extents[1]));
        Self { scale, origin, maps: [map(0), map(1)], error, diagonal, extent, smaller_extent }
    }

    /// A point in the world, rounded.
    pub(crate) fn to_world(&self, point: Vector) -> Vector {
        std::array::from_fn(|k| point[k] / self.scale + self.origin[k])
    }
}

impl MetricMap {
    #[inline(always)]
    pub(crate) fn apply(&self, point: Vector) -> Vector {
        let [x, y, z] = [0, 1, 2].map(|k| point[k] - self.centre[k]);
        [0, 1, 2].map(|k| {
            let row = &self.linear[k];
            (row[0] * x + row[1] * y + row[2] * z) + self.offset[k]
        })
    }
}

/// An order of placed meshes that depends on nothing else; meshes that it cannot tell apart have one origin.
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

/// The products that sum up to the world image of the mesh's centre, by axis.
fn terms(placed: PlacedMesh<'_>) -> [[(f64, f64); 4]; 3] {
    let (pose, centre) = (placed.world_from_mesh, placed.mesh.0.frame.origin);
    [0, 1, 2].map(|k| {
        let row = &pose.linear()[k];
        [(row[0], centre[0]), (row[1], centre[1]), (row[2], centre[2]), (pose.translation()[k], 1.0)]
    })
}

/// How far from the image of its centre a mesh may reach on each axis of the world.
fn half_extents(placed: PlacedMesh<'_>) -> Vector {
    let local = placed.mesh.0.half_extents;
    placed
        .world_from_mesh
        .linear()
        .map(|row| (row[0].abs() * local[0] + row[1].abs() * local[1] + row[2].abs() * local[2]) * (1.0 + 1e-12))
}
