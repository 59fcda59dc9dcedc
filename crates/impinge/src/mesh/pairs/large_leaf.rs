//! A leaf whose triangles are much larger than the other mesh's nodes: each triangle descends the
//! other mesh's tree on its own.
//!
//! A long oblique triangle fills a small part of its box, so a tree of boxes compares it with
//! nearly everything. The triangle itself overlaps few boxes. Source: Akenine-Möller, *Fast 3D
//! triangle-box overlap testing*, JGT 2001 (Ericson, 5.2.9): thirteen axes, of which the ten that
//! are not those of the boxes become slabs. Each slab is tested against eight boxes.
//!
//! Guarded by the tests in `large_leaf/tests.rs`, by
//! `much_larger_triangles_have_the_pairs_of_brute_force` in `engine/laws.rs`, and by the scene
//! `slivers` of `bench/rivals.py`.

use std::ops::ControlFlow;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::filter::{Guest, SlabTest};
use super::relation::Relation;
use crate::hierarchy::{BoxLanes, Child, HALF_ULP, Node, Slab, lanes_in_use, overlapping};
use crate::mesh::storage::frame::REACH;
use crate::mesh::storage::packet::{Packet, Packets};
use crate::simd::{LANES, Lanes3, bits, by_axis, cross, dot, load3, store3, sub};

/// Number of axes of a triangle itself: its normal, and the cross product of each edge with each
/// axis of the boxes.
const OWN_AXES: usize = 10;

/// A packet of large triangles in the packed frame of the other mesh.
pub(super) struct LargeLeaf {
    guest: Guest,
    bounds: Bounds,
    in_use: u32,
}

/// A box and slabs that bound each triangle.
struct Bounds {
    boxes: BoxLanes,
    slabs: [SlabLanes; OWN_AXES],
}

/// One slab per lane.
#[derive(Clone, Copy, Default)]
struct SlabLanes {
    normal: [[f32; LANES]; 3],
    min: [f32; LANES],
    max: [f32; LANES],
}

impl LargeLeaf {
    /// Carries a packet into the other frame by `relation`; `back` maps the other way.
    #[inline(always)]
    pub(in crate::mesh) fn new<S: Simd>(simd: S, packet: &Packet<'_>, relation: &Relation, back: &Relation) -> Self {
        let mut guest = Guest::EMPTY;
        guest.set_packet(simd, packet, relation, back);
        let bounds = Bounds::new(simd, &guest.corners(simd), guest.local_origin(), guest.corner_error());
        Self { guest, bounds, in_use: packet.lanes_in_use() }
    }

    /// Calls `visit` for each packet below a node that may intersect this one. It gets the large
    /// leaf as a guest, the other packet, and the result of their slab test.
    ///
    /// # Complexity
    /// At most one visit to each node below. For a long and thin triangle, only nodes near it are
    /// visited.
    #[inline(always)]
    pub(in crate::mesh) fn descend<S: Simd>(
        &self,
        simd: S,
        (nodes, packets): (&[Node], Packets<'_>),
        below: u32,
        mut visit: impl FnMut(&Guest, &Packet<'_>, &SlabTest) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut tasks = vec![(below, self.in_use)];
        while let Some((at, lanes)) = tasks.pop() {
            let node = &nodes[at as usize];
            let mut reached = [0; LANES];
            for lane in bits(lanes) {
                for child in bits(self.bounds.near(simd, lane, node)) {
                    reached[child] |= 1 << lane;
                }
            }
            for (child, &lanes) in reached.iter().enumerate().filter(|(_, lanes)| **lanes != 0) {
                match node.child(child) {
                    Child::Inner(inner) => tasks.push((inner, lanes)),
                    Child::Leaf(leaf) => {
                        let packet = packets.get(simd, leaf);
                        let slab_test = self.guest.test_slabs(simd, &packet, lanes);
                        if slab_test.pairs != 0 {
                            visit(&self.guest, &packet, &slab_test)?;
                        }
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }
}

impl Bounds {
    /// Computes the bounds of triangles with corners `about` relative to a local origin, whose sums
    /// have an error of at most `error` on each axis.
    ///
    /// # Accuracy
    /// Let u = 2^-24, R the largest coordinate of the local origin and the corners, and n an axis
    /// of any length. The sum of local origin and corner has an error of at most 2 u R, a height 5
    /// u Σ|n| R, and the difference that widens it 2 u of itself. For these, a slab is widened by
    /// 16 u Σ|n| R. It is also widened by the error of the corners along it, and by 32 u Σ|n|·reach
    /// for the rounding of a box's heights when it is tested (docs/notes/proof.md, L2a). A NaN
    /// proves nothing there.
    #[inline(always)]
    fn new<S: Simd>(simd: S, about: &[Lanes3<S>; 3], local_origin: [f64; 3], error: f64) -> Self {
        let local_origin: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, local_origin[axis] as f32));
        let corners: [Lanes3<S>; 3] = by_axis!(corner => by_axis!(axis => about[corner][axis] + local_origin[axis]));
        let mut largest = f32x8::splat(simd, 0.0);
        for axis in 0..3 {
            let [p, q, r] = by_axis!(corner => corners[corner][axis].abs());
            largest = largest.max(local_origin[axis].abs()).max(p.max(q).max(r));
        }
        let widening = error + HALF_ULP * (32.0 * REACH + 16.0 * f64::from(largest.reduce_max()));
        let slack = f32x8::splat(simd, (widening * (1.0 + 8.0 * HALF_ULP)) as f32);

        let mut boxes = BoxLanes::default();
        for axis in 0..3 {
            let [p, q, r] = by_axis!(corner => corners[corner][axis]);
            (p.min(q).min(r) - slack).store_slice(&mut boxes.min[axis]);
            (p.max(q).max(r) + slack).store_slice(&mut boxes.max[axis]);
        }
        let edges = [sub(&about[1], &about[0]), sub(&about[2], &about[1]), sub(&about[0], &about[2])];
        let edges: [Lanes3<S>; 3] = by_axis!(edge => scaled(&edges[edge]));
        let zero = f32x8::splat(simd, 0.0);
        let mut slabs = [SlabLanes::default(); OWN_AXES];
        slabs[0].set(&cross(&edges[0], &edges[1]), &corners, slack);
        for (three, &[x, y, z]) in slabs[1..].chunks_mut(3).zip(&edges) {
            three[0].set(&[zero, z, -y], &corners, slack);
            three[1].set(&[-z, zero, x], &corners, slack);
            three[2].set(&[y, -x, zero], &corners, slack);
        }
        Self { boxes, slabs }
    }

    /// Returns the children whose boxes are not proved apart from one triangle, as bits.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, lane: usize, node: &Node) -> u32 {
        let boxes = (&load3(simd, &node.min), &load3(simd, &node.max));
        let mut near = overlapping(simd, boxes, &self.boxes.lane(lane)) & lanes_in_use(node);
        for slab in &self.slabs {
            if near == 0 {
                break;
            }
            near &= !slab.lane(lane).outside(simd, node);
        }
        near
    }
}

impl SlabLanes {
    /// Sets the slabs to those of the corners along an axis, widened by `slack` times the sum of
    /// magnitudes of the normal.
    #[inline(always)]
    fn set<S: Simd>(&mut self, axis: &Lanes3<S>, corners: &[Lanes3<S>; 3], slack: f32x8<S>) {
        let normal = scaled(axis);
        let [p, q, r]: [f32x8<S>; 3] = by_axis!(corner => dot(&normal, &corners[corner]));
        let slack = slack * (normal[0].abs() + normal[1].abs() + normal[2].abs());
        store3(&normal, &mut self.normal);
        (p.min(q).min(r) - slack).store_slice(&mut self.min);
        (p.max(q).max(r) + slack).store_slice(&mut self.max);
    }

    /// Returns the slab in one lane.
    #[inline(always)]
    fn lane(&self, lane: usize) -> Slab {
        Slab { normal: by_axis!(axis => self.normal[axis][lane]), min: self.min[lane], max: self.max[lane] }
    }
}

/// Returns vectors scaled so that the largest component is 1 up to rounding. A zero vector stays
/// zero.
#[inline(always)]
fn scaled<S: Simd>(vectors: &Lanes3<S>) -> Lanes3<S> {
    let [x, y, z] = by_axis!(axis => vectors[axis].abs());
    let largest = x.max(y).max(z);
    let (zero, one) = (f32x8::splat(largest.token(), 0.0), f32x8::splat(largest.token(), 1.0));
    let factor = largest.simd_gt(zero).select(one / largest, zero);
    by_axis!(axis => vectors[axis] * factor)
}

#[cfg(test)]
mod tests;
