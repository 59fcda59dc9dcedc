//! The triangles of a packet that may be near a point, in single precision.
//!
//! Each lane finds about the nearest point of its triangle (Ericson, *Real-Time Collision
//! Detection*, 5.1.5). Along the direction to that point, whatever it is, the lowest corner is no
//! farther than the triangle. So the lowest corner gives a lower bound, which is tight if the point
//! is nearly the nearest one. This test culls triangles, and `primitive::point_triangle` measures
//! the rest.
//!
//! Error bound: docs/notes/proof.md, L40. Guarded by the test below, by
//! `tests/it/distance/points.rs`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::hierarchy::HALF_ULP;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::mesh::storage::frame::PACKING_ERROR;
use crate::mesh::storage::packet::Packet;
use crate::simd::{Lanes3, by_axis, cross, dot, load, sub};

/// A point in the packed frame. Each coordinate is wrong by at most `error`.
#[derive(Clone, Copy, Debug)]
pub(in crate::mesh) struct Viewpoint {
    pub(in crate::mesh) point: [f64; 3],
    pub(in crate::mesh) error: f64,
}

/// Maximum size of coordinates that are compared: 2^40. Their products do not overflow.
const MAX_SIZE: f64 = (1_u64 << 40) as f64;

/// Minimum squared length of a direction, 2^-80, for which products that underflow do not matter.
const MIN_SQUARED: f32 = 1.0 / (1_u128 << 80) as f32;

impl Viewpoint {
    /// Returns the used lanes whose triangles are not proved to be farther than `reach`, in packed
    /// units, as bits.
    ///
    /// # Accuracy
    /// Let u be 2^-24 and X the sum of the packet's radius and the distance to its local origin. A
    /// corner relative to the point is off by 3 u X for rounding in single precision, and by the
    /// errors of packing. Its height along a direction of length 1 is off by √3 times that, and by
    /// 10 u X for the products, their sum, the length and the quotient. The code takes 64 u X.
    #[inline(always)]
    pub(in crate::mesh) fn may_be_within<S: Simd>(&self, simd: S, packet: &Packet<'_>, reach: f64) -> u32 {
        let from: [f64; 3] = by_axis!(axis => packet.local_origin[axis] - self.point[axis]);
        let far = from[0].abs().max(from[1].abs()).max(from[2].abs());
        let size = f64::from(packet.radius) + far;
        let is_in_range = size < MAX_SIZE;
        if !is_in_range {
            return packet.lanes_in_use();
        }
        let error = 64.0 * HALF_ULP * size + 4.0 * (PACKING_ERROR + self.error) + 8.0 * UNIT_ROUNDOFF * far;
        let bound = f32x8::splat(simd, ((reach + error) as f32).next_up());
        let corners: [Lanes3<S>; 3] = by_axis!(corner => {
            by_axis!(axis => load(simd, &packet.corners[corner][axis]) + f32x8::splat(simd, from[axis] as f32))
        });
        let towards = nearest_to_origin(simd, &corners);
        let squared = dot(&towards, &towards);
        let [a, b, c] = by_axis!(corner => dot(&corners[corner], &towards));
        let height = a.min(b).min(c) / squared.sqrt();
        // Comparisons with NaN prove nothing.
        let is_far = height.simd_gt(bound) & squared.simd_gt(f32x8::splat(simd, MIN_SQUARED));
        !(is_far.to_bitmask() as u32) & packet.lanes_in_use()
    }
}

/// Returns about the nearest point of each triangle to the origin: of its edges, or of its plane if
/// that is inside.
#[inline(always)]
fn nearest_to_origin<S: Simd>(simd: S, corners: &[Lanes3<S>; 3]) -> Lanes3<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let edges: [Lanes3<S>; 3] = by_axis!(corner => sub(&corners[(corner + 1) % 3], &corners[corner]));
    let feet: [Lanes3<S>; 3] = by_axis!(corner => {
        let (from, edge) = (&corners[corner], &edges[corner]);
        let share = (zero - dot(from, edge)) / dot(edge, edge);
        let share = share.max(zero).min(one);
        by_axis!(axis => share.mul_add(edge[axis], from[axis]))
    });
    let mut nearest = feet[0];
    for foot in &feet[1..] {
        let is_nearer = dot(foot, foot).simd_lt(dot(&nearest, &nearest));
        nearest = by_axis!(axis => is_nearer.select(foot[axis], nearest[axis]));
    }
    let normal = cross(&edges[0], &edges[1]);
    // The foot on the plane is on the inner side of an edge if the edge turns about it as the face
    // does.
    let sides: [f32x8<S>; 3] = by_axis!(corner => dot(&cross(&corners[corner], &edges[corner]), &normal));
    let is_inside = sides[0].min(sides[1]).min(sides[2]).simd_ge(zero);
    let share = dot(&normal, &corners[0]) / dot(&normal, &normal);
    by_axis!(axis => is_inside.select(share * normal[axis], nearest[axis]))
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::mesh::points::small_triangles::SmallTriangles;
    use crate::primitive::closest_on_triangle;
    use crate::simd::{dispatch_every, kernel_levels};

    /// Looks from corners, from edges and from near and far places at triangles of many sizes. No
    /// triangle within reach may be culled, and nearly all other triangles must be.
    #[test]
    fn triangles_within_reach_are_never_culled() {
        let mut rng = Rng::new(78);
        let (mut near, mut kept, mut left_out) = (0, 0, 0);
        for round in 0..400 {
            let SmallTriangles { size, center, vertices, mesh } = SmallTriangles::random(&mut rng, round);
            for _ in 0..10 {
                let far = size * 2.0_f64.powi(rng.integer(-4, 4) as i32);
                let [p, q] = [0; 2].map(|_| vertices[rng.integer(0, 23) as usize]);
                let point: [f64; 3] = match rng.integer(0, 3) {
                    0 => p,
                    1 => std::array::from_fn(|k| 0.5 * (p[k] + q[k])),
                    2 => p.map(|x| x + far * rng.integer(-2, 2) as f64),
                    _ => center.map(|x| x + far * rng.uniform(-1.0, 1.0)),
                };
                let seen_from = mesh.0.frame.pack(point);
                let largest = seen_from.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                let viewpoint = Viewpoint { point: seen_from, error: 16.0 * UNIT_ROUNDOFF * largest };
                for (at, leaf) in mesh.0.leaves.iter().enumerate() {
                    let is_small = !leaf.held().contains(&8);
                    let distances: Vec<f64> = leaf
                        .held()
                        .iter()
                        .map(|&face| closest_on_triangle(&point, &mesh.corners(face)).distance)
                        .collect();
                    let reach = distances[rng.integer(0, distances.len() as i64 - 1) as usize] * (1.0 + 1e-9);
                    for (name, level) in kernel_levels() {
                        let packets = mesh.packets();
                        let within = reach * mesh.0.frame.scale;
                        let lanes = dispatch_every!(level, simd => {
                            viewpoint.may_be_within(simd, &packets.get(simd, at as u32), within)
                        });
                        for (lane, &distance) in distances.iter().enumerate() {
                            let is_kept = lanes >> lane & 1 == 1;
                            assert!(is_kept || distance > reach, "{name}: {distance} within {reach}, round {round}");
                            let is_far = is_small && distance > 1.01 * reach + 1e-4 * size;
                            near += usize::from(distance <= reach);
                            kept += usize::from(is_far && is_kept);
                            left_out += usize::from(is_far && !is_kept);
                        }
                        assert_eq!(lanes & !((1 << leaf.count()) - 1), 0);
                    }
                }
            }
        }
        let levels = kernel_levels().len();
        assert!(
            near > 5_000 * levels && left_out > 5_000 * levels && kept < left_out / 4,
            "{near} near, {kept} kept, {left_out} left out"
        );
    }
}
