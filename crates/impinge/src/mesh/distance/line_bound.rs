//! Lower bounds of the distance of two boxes along one direction, each box in its own mesh's frame:
//! along the line between their centers, and along the normal of a slab.
//!
//! Boxes that are compared axis by axis are carried into one frame, which enlarges them. Along a
//! single direction no box has to be enlarged. Two surfaces that run parallel are as far apart
//! along their common normal as their slabs, whatever the size of their boxes.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree: a hierarchical structure for rapid interference
//! detection*, SIGGRAPH 1996 (Ericson, 4.4.1), for the reach of a rotated box along an axis. Ours
//! tests one axis, and computes how far apart the boxes are on it.
//!
//! Guarded by `tests/it/distance/meshes.rs`.

use fearless_simd::Simd;

use super::metric::{Metric, MetricMap};
use crate::hierarchy::{Child, Node};
use crate::math::vec3::{Vector, dot, sub};
use crate::mesh::Mesh;
use crate::mesh::storage::packet::{Packet, Packets};
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
        Line { middles, between, along, squared: dot(&between, &between), reaches, slack: self.slack }
    }

    /// Returns the part between two parts of the meshes along the normal of the host's slab, or
    /// zero if it is certainly not longer than `cut`.
    #[inline(always)]
    pub(super) fn along_normal(&self, line: &Line, slabs: &[Slab; 2], cut: f64) -> Remainder {
        let [of_host, of_guest] = &self.frames;
        let normal = of_host.turn(&slabs[0].normal);
        let (between, squared) = (dot(&line.between, &normal), dot(&normal, &normal));
        if between * between <= cut * cut * squared {
            return Remainder { times_length: 0.0, squared, slack: self.slack };
        }
        let along = [of_host.pull_back(&normal), of_guest.pull_back(&normal)];
        let [host, guest] = if between < 0.0 { along.map(|along| along.map(|x| -x)) } else { along };
        let by_host = line.middles[0].reach_in_slab(&slabs[0], &host).min(line.middles[0].reach(&host));
        let against = guest.map(|x| -x);
        let by_guest = line.middles[1].reach_in_slab(&slabs[1], &against).min(line.middles[1].reach(&guest));
        let times_length = between.abs() - (by_host + by_guest);
        Remainder { times_length, squared, slack: self.slack }
    }
}

/// The points x of a packed frame for which `normal · x` is between two heights. The normal is zero
/// if nothing is known.
pub(super) struct Slab {
    normal: Vector,
    heights: [f64; 2],
}

impl Slab {
    /// Returns the slabs of a child of the host and a child of the guest.
    #[inline(always)]
    pub(super) fn of_both<S: Simd>(
        simd: S,
        children: &[Child; 2],
        nodes: &[&[Node]; 2],
        packets: &[Packets<'_>; 2],
    ) -> [Self; 2] {
        let [host, guest] = *children;
        [Self::of(simd, host, nodes[0], &packets[0]), Self::of(simd, guest, nodes[1], &packets[1])]
    }

    /// Returns the slab of a child of a mesh.
    #[inline(always)]
    fn of<S: Simd>(simd: S, child: Child, nodes: &[Node], packets: &Packets<'_>) -> Self {
        match child {
            Child::Leaf(leaf) => Self::of_leaf(&packets.get(simd, leaf)),
            Child::Inner(node) => {
                let slab = &nodes[node as usize].slab;
                Self { normal: slab.normal.map(f64::from), heights: [slab.min, slab.max].map(f64::from) }
            }
        }
    }

    #[inline(always)]
    fn of_leaf(packet: &Packet<'_>) -> Self {
        let (normal, heights) = packet.slab();
        let base = dot(&normal, &packet.local_origin);
        Self { normal, heights: heights.map(|height| base + height) }
    }
}

/// The vector from the center of the host's box to the center of the guest's box, not normalized.
pub(super) struct Line {
    middles: [Middle; 2],
    between: Vector,
    /// The vector in the packed frames of host and guest: its dot product with a packed vector is
    /// that of the images.
    along: [Vector; 2],
    squared: f64,
    /// How far each box reaches from its center along the vector, times the vector's length.
    reaches: [f64; 2],
    slack: f64,
}

impl Line {
    /// Returns the part of the line that is between the two boxes.
    #[inline(always)]
    pub(super) fn remainder(&self) -> Remainder {
        self.less(&self.reaches)
    }

    /// Returns the part of the line that is between two parts with slabs, which shorten their
    /// reaches.
    #[inline(always)]
    pub(super) fn remainder_in_slabs(&self, [host, guest]: &[Slab; 2]) -> Remainder {
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
    /// Returns a lower bound of the distance of the triangles of the parts if they are proved to be
    /// farther apart than `cut`, both in metric units.
    #[inline(always)]
    pub(super) fn if_longer(self, cut: f64) -> Option<f64> {
        let (left, cut) = (self.times_length, cut + self.slack);
        // Comparisons with NaN prove nothing.
        let is_longer = left > 0.0 && left * left > cut * cut * self.squared * (1.0 + 1e-12);
        is_longer.then(|| left / self.squared.sqrt() * (1.0 - 1e-12) - self.slack)
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

    /// Returns an upper bound of how far the part of a slab in the box reaches from the center of
    /// the box along a vector, times the vector's length. The slab bounds the part of the vector
    /// along the slab's normal, and the box bounds the rest. Returns NaN without a slab.
    #[inline(always)]
    fn reach_in_slab(&self, Slab { normal, heights: [low, high] }: &Slab, along: &Vector) -> f64 {
        let share = dot(along, normal) / dot(normal, normal);
        let rest: Vector = by_axis!(k => along[k] - share * normal[k]);
        self.reach(&rest) + share * (if share > 0.0 { high } else { low } - dot(normal, &self.center))
    }
}

impl Frame {
    /// Returns the image of a packed point in the metric frame.
    #[inline(always)]
    fn place(&self, point: &Vector) -> Vector {
        let [a, b, c] = &self.columns;
        by_axis!(k => (a[k] * point[0] + b[k] * point[1] + c[k] * point[2]) + self.offset[k])
    }

    /// Returns the image of a packed vector in the metric frame.
    #[inline(always)]
    fn turn(&self, vector: &Vector) -> Vector {
        let [a, b, c] = &self.columns;
        by_axis!(k => a[k] * vector[0] + b[k] * vector[1] + c[k] * vector[2])
    }

    /// Returns the vector of the packed frame whose dot product with a packed vector is that of
    /// `vector` with the image.
    #[inline(always)]
    fn pull_back(&self, vector: &Vector) -> Vector {
        by_axis!(k => dot(vector, &self.columns[k]))
    }
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::poses::{large_integer_map, rotation};
    use impinge_testkit::generate::{Rng, solids};

    use super::*;
    use crate::math::Pose;
    use crate::mesh::Positions;
    use crate::primitive::triangle_triangle;
    use crate::simd::{dispatch, levels};

    /// Returns the corners of the faces below a child, in the metric frame.
    fn triangles(mesh: &Mesh, map: &MetricMap, child: Child) -> Vec<[Vector; 3]> {
        match child {
            Child::Leaf(leaf) => {
                mesh.leaf(leaf).faces.iter().map(|&face| mesh.corners(face).map(|at| map.apply(at))).collect()
            }
            Child::Inner(node) => {
                let node = &mesh.0.tree.nodes()[node as usize];
                (0..node.count()).flat_map(|lane| triangles(mesh, map, node.child(lane))).collect()
            }
        }
    }

    /// Wavy sheets above each other, in different directions and stretched. The parts between boxes
    /// and slabs are compared with the distance of all pairs of triangles.
    #[test]
    fn bounds_along_normals_are_below_distances() {
        let mut rng = Rng::new(52);
        let mut sheet = solids::plane_grid(24, 24);
        sheet.vertices.iter_mut().for_each(|[x, y, z]| *z = 2.0 * (0.5 * *x).sin() * (0.25 * *y).cos());
        let mesh = Mesh::new(Positions::F64(sheet.vertices), sheet.faces).expect("a mesh");
        let nodes = mesh.0.tree.nodes();
        let (mut proved, mut by_boxes) = (0, 0);
        for round in 0..40 {
            let place = if round % 4 == 0 { large_integer_map(&mut rng) } else { rotation(&mut rng) };
            let raised = |up: f64| {
                let at = std::array::from_fn(|k| place.translation[k] + up * place.linear[k][2]);
                Pose::new(place.linear, at).expect("a pose")
            };
            let metric = Metric::new(mesh.at(raised(0.0)), mesh.at(raised(1.0)));
            let bound = LineBound::new([&mesh; 2], &metric, [0, 1]);
            for _ in 0..60 {
                // The same child of both sheets, mostly: the two face each other.
                let node = &nodes[rng.integer(0, nodes.len() as i64 - 1) as usize];
                let mut lane = || rng.integer(0, node.count() as i64 - 1) as usize;
                let (first, second) = (lane(), lane());
                let lanes = [first, if rng.one_in(8) { second } else { first }];
                let children = lanes.map(|lane| node.child(lane));
                let line = bound.line(&node.lane_bounds(lanes[0]), &node.lane_bounds(lanes[1]));
                let (_, level) = levels()[0];
                let slabs = dispatch!(level, simd => Slab::of_both(simd, &children, &[nodes; 2], &[mesh.packets(); 2]));
                let [a, b] = [0, 1].map(|side| triangles(&mesh, &metric.maps[side], children[side]));
                let truth = a.iter().flat_map(|a| b.iter().map(move |b| triangle_triangle(a, b).squared));
                let truth = truth.fold(f64::INFINITY, f64::min).sqrt();
                let found = bound.along_normal(&line, &slabs, 0.0);
                let lower = found.if_longer(0.0);
                assert!(lower.is_none_or(|lower| lower <= truth), "round {round}: {lower:?} above {truth}");
                proved += usize::from(found.if_longer(0.75 * truth).is_some());
                by_boxes += usize::from(line.remainder().if_longer(0.75 * truth).is_some());
            }
        }
        assert!(proved > 500 && by_boxes < 100, "{proved} {by_boxes}");
    }
}
