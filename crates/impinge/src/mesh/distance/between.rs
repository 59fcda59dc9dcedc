//! A bound of the distance of two boxes along the line between their centres, each box in its own mesh's frame.
//!
//! Boxes that are compared axis by axis have to be carried into one frame, where they grow; along a single direction they
//! are as they were built.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree: a hierarchical structure for rapid interference detection*, SIGGRAPH 1996
//! (Ericson, 4.4.1), for the reach of a turned box along an axis; ours asks one axis, and how far they are apart on it.

use crate::mesh::Mesh;
use crate::mesh::metric::{Metric, MetricMap};
use crate::primitive::{Vector, dot, sub};
use crate::simd::by_axis;
use crate::volume::Aabb;

/// The maps from two packed frames into the metric frame, the host's first.
#[derive(Clone, Copy)]
pub(super) struct Between {
    frames: [Frame; 2],
    /// More than what heights of corners may be off by.
    slack: f64,
}

/// `metric = columns · packed + offset`.
#[derive(Clone, Copy)]
struct Frame {
    columns: [Vector; 3],
    offset: Vector,
}

impl Between {
    pub(super) fn new(meshes: [&Mesh; 2], metric: &Metric, sides: [usize; 2]) -> Self {
        let frame = |mesh: &Mesh, map: &MetricMap| Frame {
            columns: by_axis!(j => by_axis!(k => map.linear[k][j] / mesh.0.frame.scale)),
            offset: map.offset,
        };
        let frames = [0, 1].map(|side| frame(meshes[side], &metric.maps[sides[side]]));
        Self { frames, slack: 8.0 * metric.error }
    }

    /// Whether the triangles in two boxes are proved to be farther apart than `cut`.
    #[inline(always)]
    pub(super) fn are_apart(&self, host: &Aabb, guest: &Aabb, cut: f64) -> bool {
        let [of_host, of_guest] = &self.frames;
        let between = sub(&of_guest.centre(guest), &of_host.centre(host));
        let squared = dot(&between, &between);
        let left = squared - (of_host.reach(host, &between) + of_guest.reach(guest, &between));
        // Comparisons with NaN prove nothing.
        let cut = cut + self.slack;
        left > 0.0 && left * left > cut * cut * squared * (1.0 + 1e-12)
    }
}

impl Frame {
    #[inline(always)]
    fn centre(&self, bounds: &Aabb) -> Vector {
        let [x, y, z]: Vector = by_axis!(k => 0.5 * (f64::from(bounds.min[k]) + f64::from(bounds.max[k])));
        let [a, b, c] = &self.columns;
        by_axis!(k => (a[k] * x + b[k] * y + c[k] * z) + self.offset[k])
    }

    /// How far a box reaches from its centre along a vector, times the vector's length.
    #[inline(always)]
    fn reach(&self, bounds: &Aabb, along: &Vector) -> f64 {
        let [x, y, z]: Vector = by_axis!(k => {
            0.5 * (f64::from(bounds.max[k]) - f64::from(bounds.min[k])) * dot(along, &self.columns[k]).abs()
        });
        x + y + z
    }
}
