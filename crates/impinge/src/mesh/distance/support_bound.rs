//! How far parts of a mesh reach in a direction: inner children by their boxes and slabs together,
//! leaves by their corners.
//!
//! Guarded by the test in `direction_bounds.rs`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, f64x4};

use crate::hierarchy::{HALF_ULP, Node};
use crate::math::vec3::{Vector, dot};
use crate::mesh::Mesh;
use crate::mesh::storage::packet::Packet;
use crate::simd::{LANES, by_axis, load, load3};

/// A linear function of a packed point, `gradient · point + base`: how far the point reaches beyond
/// its mesh's witness and towards the other mesh, in metric units.
#[derive(Clone, Copy)]
pub(super) struct SupportBound {
    pub(super) gradient: Vector,
    pub(super) base: f64,
    /// Sum of the magnitudes of the gradient's components.
    pub(super) size: f64,
}

impl SupportBound {
    /// Returns upper bounds of the reaches of a node's children, in metric units. Unused lanes have
    /// negative infinity.
    #[inline(always)]
    pub(super) fn of_children<S: Simd>(&self, simd: S, mesh: &Mesh, node: u32) -> [f32; LANES] {
        let nodes = mesh.0.tree.nodes();
        let parent = &nodes[node as usize];
        if !parent.holds_leaves() {
            return self.of_inner_children(simd, nodes, parent);
        }
        let packets = mesh.packets();
        let mut lanes = [f32::NEG_INFINITY; LANES];
        for (lane, reach) in lanes[..parent.count()].iter_mut().enumerate() {
            *reach = self.of_leaf(simd, &packets.get(simd, parent.index(lane)));
        }
        lanes
    }

    /// Returns upper bounds of the reaches of a node's inner children, from the children's boxes
    /// and slabs. All are in the packed frame. The gradient is split into α times the slab's normal
    /// and the rest: the slab bounds the first part and the box bounds the rest.
    #[inline(always)]
    fn of_inner_children<S: Simd>(&self, simd: S, nodes: &[Node], parent: &Node) -> [f32; LANES] {
        let mut slabs = Slabs { normal: [[0.0; LANES]; 3], min: [0.0; LANES], max: [0.0; LANES] };
        for lane in 0..parent.count() {
            let slab = &nodes[parent.index(lane) as usize].slab;
            for axis in 0..3 {
                slabs.normal[axis][lane] = slab.normal[axis];
            }
            (slabs.min[lane], slabs.max[lane]) = (slab.min, slab.max);
        }
        let half = |lanes: &[f32; LANES], half: usize| -> f64x4<S> {
            let (low, high) = load(simd, lanes).widen();
            if half == 0 { low } else { high }
        };
        let mut lanes = [f32::NEG_INFINITY; LANES];
        for (part, reaches) in lanes.chunks_exact_mut(LANES / 2).enumerate() {
            let min = by_axis!(axis => half(&parent.min[axis], part));
            let max = by_axis!(axis => half(&parent.max[axis], part));
            let normal = by_axis!(axis => half(&slabs.normal[axis], part));
            let gradient = by_axis!(axis => f64x4::splat(simd, self.gradient[axis]));
            let share = inner(&gradient, &normal) / inner(&normal, &normal);
            let by_box = in_boxes(&gradient, &min, &max);
            let rest = by_axis!(axis => gradient[axis] - share * normal[axis]);
            let is_along = share.simd_gt(f64x4::splat(simd, 0.0));
            let height = is_along.select(half(&slabs.max, part), half(&slabs.min, part));
            let by_slab = in_boxes(&rest, &min, &max) + share * height;
            // Without a slab, `by_slab` is NaN and the box alone bounds the reach.
            let most = by_slab.simd_lt(by_box).select(by_slab, by_box) + f64x4::splat(simd, self.base);
            for (reach, most) in reaches.iter_mut().zip(<[f64; LANES / 2]>::from(most)) {
                *reach = upward(most);
            }
        }
        lanes[parent.count()..].fill(f32::NEG_INFINITY);
        lanes
    }

    /// Returns an upper bound of the reach of a leaf's triangles.
    #[inline(always)]
    fn of_leaf<S: Simd>(&self, simd: S, packet: &Packet<'_>) -> f32 {
        let (lanes, origin) = self.about_origin(simd, packet);
        upward(origin + f64::from(lanes.reduce_max()))
    }

    /// Returns an upper bound of the reach of each triangle of a leaf, in metric units.
    #[inline(always)]
    pub(super) fn of_triangles<S: Simd>(&self, simd: S, packet: &Packet<'_>) -> [f32; LANES] {
        let (lanes, origin) = self.about_origin(simd, packet);
        let mut reaches = <[f32; LANES]>::from(lanes);
        for reach in &mut reaches {
            *reach = upward(origin + f64::from(*reach));
        }
        reaches
    }

    /// Returns how far each triangle reaches beyond the packet's local origin, and an upper bound
    /// of the local origin's reach. The bound includes eight units of 2^-24 for the rounding of the
    /// corner and of the gradient, three products and two sums.
    #[inline(always)]
    fn about_origin<S: Simd>(&self, simd: S, packet: &Packet<'_>) -> (f32x8<S>, f64) {
        let gradient = by_axis!(axis => f32x8::splat(simd, self.gradient[axis] as f32));
        let heights: [f32x8<S>; 3] = by_axis!(corner => {
            let at = load3(simd, &packet.corners[corner]);
            gradient[0] * at[0] + gradient[1] * at[1] + gradient[2] * at[2]
        });
        let slack = 8.0 * HALF_ULP * f64::from(packet.radius) * self.size + f64::from(f32::MIN_POSITIVE);
        let origin = dot(&self.gradient, &packet.local_origin) + self.base + slack;
        (heights[0].max(heights[1]).max(heights[2]), origin)
    }
}

/// The slabs of eight children.
struct Slabs {
    normal: [[f32; LANES]; 3],
    min: [f32; LANES],
    max: [f32; LANES],
}

/// Returns the greatest dot product of each vector with a point of its box.
#[inline(always)]
fn in_boxes<S: Simd>(vectors: &[f64x4<S>; 3], min: &[f64x4<S>; 3], max: &[f64x4<S>; 3]) -> f64x4<S> {
    let [x, y, z]: [f64x4<S>; 3] = by_axis!(axis => (vectors[axis] * min[axis]).max(vectors[axis] * max[axis]));
    x + y + z
}

/// Returns the dot products. They are not fused, so they are the same on every vector unit.
#[inline(always)]
fn inner<S: Simd>(a: &[f64x4<S>; 3], b: &[f64x4<S>; 3]) -> f64x4<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Rounds to single precision, upward.
#[inline(always)]
fn upward(reach: f64) -> f32 {
    (reach + (reach.abs() * (2.0 * HALF_ULP) + f64::from(f32::MIN_POSITIVE))) as f32
}
