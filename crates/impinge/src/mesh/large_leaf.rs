//! A leaf of triangles that are much larger than what they meet: each of them goes down the other mesh's tree on its own.
//!
//! A long triangle that lies askew fills a small part of its box, so that a tree of boxes sends it to nearly everything; the
//! triangle itself passes few boxes by. Source: Akenine-Möller, *Fast 3D triangle-box overlap testing*, JGT 2001 (Ericson,
//! 5.2.9): thirteen axes, of which the ten that are not the boxes' own become slabs, each tested against eight boxes.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::filter::{Guest, Verdicts};
use super::frame::REACH;
use super::packet::{Packet, Packets};
use super::relation::Relation;
use crate::hierarchy::{Child, HALF_ULP, Node, Slab, bits, lanes_in_use, overlapping};
use crate::primitive::{Vector, cross, sub};
use crate::simd::{LANES, load3};
use crate::volume::Aabb;

/// The axes that a triangle's own shape brings: its normal, and each edge across each axis of the boxes.
const OWN_AXES: usize = 10;

/// A packet of large triangles in the other mesh's packed frame.
pub(super) struct LargeLeaf {
    guest: Guest,
    triangles: [Bounds; LANES],
    in_use: u32,
}

/// What holds one triangle.
struct Bounds {
    aabb: Aabb,
    slabs: [Slab; OWN_AXES],
}

impl LargeLeaf {
    /// A packet carried by `relation`; `back` relates the meshes the other way round.
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, packet: &Packet<'_>, relation: &Relation, back: &Relation) -> Self {
        let mut guest = Guest::EMPTY;
        guest.take_up(simd, packet, relation, back);
        let triangles = std::array::from_fn(|lane| Bounds::new(guest.corners_of(lane), guest.corner_error()));
        Self { guest, triangles, in_use: packet.lanes_in_use() }
    }

    /// Meets all that is below a node: `report` gets each leaf that is met, with the verdicts.
    ///
    /// # Complexity
    /// At most one visit to each node below; for a triangle that is long and thin, to those near it.
    #[inline(always)]
    pub(super) fn descend<S: Simd>(
        &self,
        simd: S,
        (nodes, packets): (&[Node], Packets<'_>),
        below: u32,
        mut report: impl FnMut(u32, Verdicts) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut tasks = vec![(below, self.in_use)];
        while let Some((at, lanes)) = tasks.pop() {
            let node = &nodes[at as usize];
            let mut reached = [0; LANES];
            for lane in bits(lanes) {
                for child in bits(self.triangles[lane].near(simd, node)) {
                    reached[child] |= 1 << lane;
                }
            }
            for (child, &lanes) in reached.iter().enumerate().filter(|(_, lanes)| **lanes != 0) {
                match node.child(child) {
                    Child::Inner(inner) => tasks.push((inner, lanes)),
                    Child::Leaf(leaf) => {
                        let packet = packets.get(simd, leaf);
                        let facing = self.guest.face(simd, &packet, lanes);
                        if facing.pairs != 0 {
                            report(leaf, self.guest.meet(simd, &packet, &facing))?;
                        }
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }
}

impl Bounds {
    /// Of a triangle whose corners may be off by `error` on each axis.
    ///
    /// A slab is widened by what the corners may be off by along it, by 32 u Σ|n|·reach for the rounding of a box's
    /// heights where it is tested (docs/proof.md, L2a), and by what double precision loses of its own heights. What is
    /// not a number proves nothing there.
    fn new(corners: [Vector; 3], error: f64) -> Self {
        let reach = corners.as_flattened().iter().fold(0.0, |reach: f64, x| reach.max(x.abs()));
        let rounding = 32.0 * HALF_ULP * REACH + 4.0 * f64::EPSILON * reach;
        let edges = [sub(&corners[1], &corners[0]), sub(&corners[2], &corners[1]), sub(&corners[0], &corners[2])];
        let slab = |axis: Vector| {
            let largest = axis.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
            let normal = axis.map(|x| if largest > 0.0 { (x / largest) as f32 } else { 0.0 });
            let [x, y, z] = normal.map(f64::from);
            let heights = corners.map(|[a, b, c]| x * a + y * b + z * c);
            let slack = (x.abs() + y.abs() + z.abs()) * (error + rounding);
            let [low, high] = range(heights, slack);
            Slab { normal, min: low, max: high }
        };
        let mut slabs = [Slab::ALL; OWN_AXES];
        slabs[0] = slab(cross(&edges[0], &edges[1]));
        for (three, [x, y, z]) in slabs[1..].chunks_mut(3).zip(edges) {
            three[0] = slab([0.0, z, -y]);
            three[1] = slab([-z, 0.0, x]);
            three[2] = slab([y, -x, 0.0]);
        }
        let [x, y, z] = [0, 1, 2].map(|axis| range(corners.map(|corner| corner[axis]), error + rounding));
        Self { aabb: Aabb { min: [x[0], y[0], z[0]], max: [x[1], y[1], z[1]] }, slabs }
    }

    /// The children whose boxes are not proved apart from the triangle, as bits.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, node: &Node) -> u32 {
        let boxes = (&load3(simd, &node.min), &load3(simd, &node.max));
        let mut near = overlapping(simd, boxes, &self.aabb) & lanes_in_use(node);
        for slab in &self.slabs {
            if near == 0 {
                break;
            }
            near &= !slab.outside(simd, node);
        }
        near
    }
}

/// The least and the greatest of three numbers, wider by `slack` and rounded outward.
fn range(numbers: [f64; 3], slack: f64) -> [f32; 2] {
    let [a, b, c] = numbers;
    [((a.min(b).min(c) - slack) as f32).next_down(), ((a.max(b).max(c) + slack) as f32).next_up()]
}
