//! A bound of the distance of two boxes along the line between their centres, each box in its own mesh's frame.
//!
//! Boxes that are compared axis by axis have to be carried into one frame, where they grow; along a single direction they
//! are as they were built.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree: a hierarchical structure for rapid interference detection*, SIGGRAPH 1996
//! (Ericson, 4.4.1), for the reach of a turned box along an axis; ours asks one axis, and how far they are apart on it.

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
    /// More than what heights of corners may be off by.
    slack: f64,
}

/// `metric = columns · packed + offset`.
#[derive(Clone, Copy)]
struct Frame {
    columns: [Vector; 3],
    offset: Vector,
}

impl LineBound {
    pub(super) fn new(meshes: [&Mesh; 2], metric: &Metric, sides: [usize; 2]) -> Self {
        let frame = |mesh: &Mesh, map: &MetricMap| Frame {
            columns: by_axis!(j => by_axis!(k => map.linear[k][j] / mesh.0.frame.scale)),
            offset: map.offset,
        };
        let frames = [0, 1].map(|side| frame(meshes[side], &metric.maps[sides[side]]));
        Self { frames, slack: 8.0 * metric.error }
    }

    /// The line between the centres of two boxes.
    #[inline(always)]
    pub(super) fn line(&self, host: &Aabb, guest: &Aabb) -> Line {
        let [of_host, of_guest] = &self.frames;
        let middles = [Middle::of(host), Middle::of(guest)];
        let between = sub(&of_guest.place(&middles[1].centre), &of_host.place(&middles[0].centre));
        let along = [of_host.turn_back(&between), of_guest.turn_back(&between)];
        let reaches = [middles[0].reach(&along[0]), middles[1].reach(&along[1])];
        Line { middles, along, squared: dot(&between, &between), reaches, slack: self.slack }
    }
}

/// The line between the centres of two boxes, the host's and the guest's, as long as it is.
pub(super) struct Line {
    middles: [Middle; 2],
    /// The line's vector as either packed frame sees it.
    along: [Vector; 2],
    squared: f64,
    /// How far the boxes reach from their centres along it, times its length.
    reaches: [f64; 2],
    slack: f64,
}

impl Line {
    /// What is left of the line between the boxes.
    #[inline(always)]
    pub(super) fn left(&self) -> Remainder {
        self.less(&self.reaches)
    }

    /// What is left where each box is that of a leaf, for what their slabs allow along the slabs' normals.
    #[inline(always)]
    pub(super) fn left_by_leaves(&self, [host, guest]: &[Packet<'_>; 2]) -> Remainder {
        let [along_host, along_guest] = &self.along;
        // Not a number, where there is no slab, bounds nothing.
        let by_host = self.middles[0].reach_in_slab(host, along_host).min(self.reaches[0]);
        let by_guest = self.middles[1].reach_in_slab(guest, &along_guest.map(|x| -x)).min(self.reaches[1]);
        self.less(&[by_host, by_guest])
    }

    #[inline(always)]
    fn less(&self, [host, guest]: &[f64; 2]) -> Remainder {
        Remainder { times_length: self.squared - (host + guest), squared: self.squared, slack: self.slack }
    }
}

/// How much of a line is left between two parts, times its length.
#[derive(Clone, Copy)]
pub(super) struct Remainder {
    times_length: f64,
    squared: f64,
    slack: f64,
}

impl Remainder {
    /// Whether the triangles of the parts are proved to be farther apart than `cut`.
    #[inline(always)]
    pub(super) fn is_longer(self, cut: f64) -> bool {
        let (left, cut) = (self.times_length, cut + self.slack);
        // Comparisons with NaN prove nothing.
        left > 0.0 && left * left > cut * cut * self.squared * (1.0 + 1e-12)
    }

    /// No two points of the triangles are nearer than this, in metric units.
    #[inline(always)]
    pub(super) fn length(self) -> f64 {
        self.times_length / self.squared.sqrt() * (1.0 - 1e-12) - self.slack
    }
}

/// A box by its centre and half of its extents.
struct Middle {
    centre: Vector,
    half: Vector,
}

impl Middle {
    #[inline(always)]
    fn of(bounds: &Aabb) -> Self {
        let (min, max): (Vector, Vector) =
            (by_axis!(k => f64::from(bounds.min[k])), by_axis!(k => f64::from(bounds.max[k])));
        Self { centre: by_axis!(k => 0.5 * (min[k] + max[k])), half: by_axis!(k => 0.5 * (max[k] - min[k])) }
    }

    /// How far the box reaches from its centre along a vector, times the vector's length.
    #[inline(always)]
    fn reach(&self, along: &Vector) -> f64 {
        let [x, y, z]: Vector = by_axis!(k => self.half[k] * along[k].abs());
        x + y + z
    }

    /// How far the leaf in the box does at most: for the share of its normal in the vector what its slab allows along that,
    /// and what the box allows along the rest.
    #[inline(always)]
    fn reach_in_slab(&self, packet: &Packet<'_>, along: &Vector) -> f64 {
        let (normal, [low, high]) = packet.slab();
        let share = dot(along, &normal) / dot(&normal, &normal);
        let rest: Vector = by_axis!(k => along[k] - share * normal[k]);
        let aside: Vector = by_axis!(k => packet.anchor[k] - self.centre[k]);
        self.reach(&rest) + share * (dot(&normal, &aside) + if share > 0.0 { high } else { low })
    }
}

impl Frame {
    #[inline(always)]
    fn place(&self, point: &Vector) -> Vector {
        let [a, b, c] = &self.columns;
        by_axis!(k => (a[k] * point[0] + b[k] * point[1] + c[k] * point[2]) + self.offset[k])
    }

    /// The vector of the packed frame whose inner products are those with the images.
    #[inline(always)]
    fn turn_back(&self, vector: &Vector) -> Vector {
        by_axis!(k => dot(vector, &self.columns[k]))
    }
}
