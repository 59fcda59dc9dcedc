//! A lower bound of the distance of two boxes along the line between their centers, each box in its
//! own mesh's frame.
//!
//! Boxes that are compared axis by axis are carried into one frame, which enlarges them. Along a
//! single direction no box has to be enlarged.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree: a hierarchical structure for rapid interference
//! detection*, SIGGRAPH 1996 (Ericson, 4.4.1), for the reach of a rotated box along an axis. Ours
//! tests one axis, and computes how far apart the boxes are on it.
//!
//! Guarded by `tests/it/distance/meshes.rs`.

use super::metric::{Metric, MetricMap};
use crate::math::vec3::{Vector, dot, sub};
use crate::mesh::Mesh;
use crate::mesh::storage::packet::Packet;
use crate::simd::by_axis;
use crate::volume::Aabb;

/// The maps from two packed frames into the metric frame, the host's first.
#[derive(Clone, Copy)]
pub(super) struct LineBound {
    frames: [Frame; 2],
    /// Error bound of the heights of corners, in metric units.
    slack: f64,
}

/// Map from a packed frame to the metric frame: `metric = columns · packed + offset`.
#[derive(Clone, Copy)]
struct Frame {
    columns: [Vector; 3],
    offset: Vector,
}

impl LineBound {
    /// Takes the maps of host and guest. `sides` has the indices of both among the two meshes.
    pub(super) fn new(meshes: [&Mesh; 2], metric: &Metric, sides: [usize; 2]) -> Self {
        let frame = |mesh: &Mesh, map: &MetricMap| Frame {
            columns: by_axis!(j => by_axis!(k => map.linear[k][j] / mesh.0.frame.scale)),
            offset: map.offset,
        };
        let frames = [0, 1].map(|side| frame(meshes[side], &metric.maps[sides[side]]));
        Self { frames, slack: 8.0 * metric.error }
    }

    /// Returns the line from the center of the host's box to the center of the guest's. Both boxes
    /// are in their own packed frames.
    #[inline(always)]
    pub(super) fn line(&self, host: &Aabb, guest: &Aabb) -> Line {
        let [of_host, of_guest] = &self.frames;
        let middles = [Middle::of(host), Middle::of(guest)];
        let between = sub(&of_guest.place(&middles[1].center), &of_host.place(&middles[0].center));
        let along = [of_host.pull_back(&between), of_guest.pull_back(&between)];
        let reaches = [middles[0].reach(&along[0]), middles[1].reach(&along[1])];
        Line { middles, along, squared: dot(&between, &between), reaches, slack: self.slack }
    }
}

/// The vector from the center of the host's box to the center of the guest's box, not normalized.
pub(super) struct Line {
    middles: [Middle; 2],
    /// The vector in the packed frames of host and guest: its dot product with a packed vector is
    /// that of the images.
    along: [Vector; 2],
    squared: f64,
    /// How far each box reaches from its center along the vector, times the vector's length.
    reaches: [f64; 2],
    slack: f64,
}

impl Line {
    /// Returns the part of the line that is between the boxes.
    #[inline(always)]
    pub(super) fn remainder(&self) -> Remainder {
        self.less(&self.reaches)
    }

    /// Returns the part of the line that is between two leaves, given the boxes of the leaves. The
    /// leaves' slabs shorten their reaches.
    #[inline(always)]
    pub(super) fn remainder_of_leaves(&self, [host, guest]: &[Packet<'_>; 2]) -> Remainder {
        let [along_host, along_guest] = &self.along;
        // Without a slab the reach is NaN, which `min` ignores.
        let by_host = self.middles[0].reach_in_slab(host, along_host).min(self.reaches[0]);
        let by_guest = self.middles[1].reach_in_slab(guest, &along_guest.map(|x| -x)).min(self.reaches[1]);
        self.less(&[by_host, by_guest])
    }

    #[inline(always)]
    fn less(&self, [host, guest]: &[f64; 2]) -> Remainder {
        Remainder { times_length: self.squared - (host + guest), squared: self.squared, slack: self.slack }
    }
}

/// Length of the part of a line that is between two parts of the meshes, times the length of the
/// line.
#[derive(Clone, Copy)]
pub(super) struct Remainder {
    times_length: f64,
    squared: f64,
    slack: f64,
}

impl Remainder {
    /// Reports whether the triangles of the parts are proved to be farther apart than `cut`, in
    /// metric units.
    #[inline(always)]
    pub(super) fn is_longer(self, cut: f64) -> bool {
        let (left, cut) = (self.times_length, cut + self.slack);
        // Comparisons with NaN prove nothing.
        left > 0.0 && left * left > cut * cut * self.squared * (1.0 + 1e-12)
    }

    /// Returns a lower bound of the distance of the triangles of the parts, in metric units.
    #[inline(always)]
    pub(super) fn length(self) -> f64 {
        self.times_length / self.squared.sqrt() * (1.0 - 1e-12) - self.slack
    }
}

/// A box by its center and half of its extents.
struct Middle {
    center: Vector,
    half: Vector,
}

impl Middle {
    #[inline(always)]
    fn of(bounds: &Aabb) -> Self {
        let (min, max): (Vector, Vector) =
            (by_axis!(k => f64::from(bounds.min[k])), by_axis!(k => f64::from(bounds.max[k])));
        Self { center: by_axis!(k => 0.5 * (min[k] + max[k])), half: by_axis!(k => 0.5 * (max[k] - min[k])) }
    }

    /// Returns how far the box reaches from its center along a vector, times the vector's length.
    #[inline(always)]
    fn reach(&self, along: &Vector) -> f64 {
        let [x, y, z]: Vector = by_axis!(k => self.half[k] * along[k].abs());
        x + y + z
    }

    /// Returns an upper bound of how far the leaf in the box reaches from the box's center along a
    /// vector, times the vector's length. The slab bounds the part of the vector along the slab's
    /// normal, and the box bounds the rest. Returns NaN without a slab.
    #[inline(always)]
    fn reach_in_slab(&self, packet: &Packet<'_>, along: &Vector) -> f64 {
        let (normal, [low, high]) = packet.slab();
        let share = dot(along, &normal) / dot(&normal, &normal);
        let rest: Vector = by_axis!(k => along[k] - share * normal[k]);
        let aside: Vector = by_axis!(k => packet.local_origin[k] - self.center[k]);
        self.reach(&rest) + share * (dot(&normal, &aside) + if share > 0.0 { high } else { low })
    }
}

impl Frame {
    /// Returns the image of a packed point in the metric frame.
    #[inline(always)]
    fn place(&self, point: &Vector) -> Vector {
        let [a, b, c] = &self.columns;
        by_axis!(k => (a[k] * point[0] + b[k] * point[1] + c[k] * point[2]) + self.offset[k])
    }

    /// Returns the vector of the packed frame whose dot product with a packed vector is that of
    /// `vector` with the image.
    #[inline(always)]
    fn pull_back(&self, vector: &Vector) -> Vector {
        by_axis!(k => dot(vector, &self.columns[k]))
    }
}
