//! The triangles of a packet that a line may intersect, in single precision.
//!
//! Source: Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013. Seen along
//! the line, each triangle is a triangle of the plane and the line is a point. The point is outside
//! if it is on opposite sides of two edges. Ours departs in that a side only counts if it is
//! certain. This test culls triangles, and `primitive::ray_triangle` decides about the rest.
//!
//! Error bound: docs/notes/proof.md, L15. Guarded by the test below and by the benchmark `rays` of
//! `impinge-bench`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::hierarchy::HALF_ULP;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::mesh::storage::frame::PACKING_ERROR;
use crate::mesh::storage::packet::Packet;
use crate::simd::{by_axis, load};

/// A line in the packed frame, prepared for looking along it. A point `p` is seen at `p_i - slope_i
/// p_k` and `p_j - slope_j p_k`. The axis `k` is the axis on which the line goes farthest, so
/// slopes are at most one.
#[derive(Clone, Copy, Debug)]
pub(in crate::mesh) struct Line {
    /// The axes `i`, `j` and `k`.
    axes: [usize; 3],
    slopes: [f64; 2],
    origin: [f64; 3],
    /// Error bound of a coordinate of the origin, in packed units.
    error: f64,
}

/// The used lanes of a packet by where a line passes their triangles, as bits.
#[derive(Clone, Copy, Debug)]
pub(in crate::mesh) struct Passed {
    /// The triangles that the line is not proved to miss.
    pub(in crate::mesh) may_intersect: u32,
    /// The triangles whose inside the line certainly intersects, and whose corners turn to the left
    /// as seen against the axis `k`.
    pub(in crate::mesh) turning_left: u32,
    /// The same for corners that turn to the right.
    pub(in crate::mesh) turning_right: u32,
}

/// Upper bound of the loss of products too small for a float: 2^-120.
const UNDERFLOW: f64 = f64::from_bits((1023 - 120) << 52);

impl Line {
    /// Creates the line through `origin` in `direction`, which must not be zero. `error` is the
    /// error bound of the origin's coordinates.
    pub(in crate::mesh) fn new(origin: [f64; 3], direction: [f64; 3], error: f64) -> Self {
        let size = direction.map(f64::abs);
        let k = if size[0] >= size[1] && size[0] >= size[2] { 0 } else { 1 + usize::from(size[2] > size[1]) };
        let [i, j] = [(k + 1) % 3, (k + 2) % 3];
        Self { axes: [i, j, k], slopes: [direction[i] / direction[k], direction[j] / direction[k]], origin, error }
    }

    /// Returns the used lanes whose triangles the line is not proved to miss, as bits.
    #[inline(always)]
    pub(in crate::mesh) fn may_intersect<S: Simd>(&self, simd: S, packet: &Packet<'_>) -> u32 {
        self.pass(simd, packet).may_intersect
    }

    /// Looks along the line at the triangles of a packet.
    ///
    /// # Accuracy
    /// Let u be 2^-24. Let X be the sum of the packet's radius and the distance at which the line
    /// passes its local origin, seen along the line. The error of a corner relative to the line is
    /// 9 u X for rounding in single precision, and `error` for the rounding before: two packed
    /// coordinates (L1), two of the origin, and 6 units of 2^-53 of the subtracted numbers. No
    /// coordinate is beyond 2 X. So a side, which is the difference of two products, has an error
    /// of 10 X times that, and 16 u X² for its own rounding, fused or not: 106 u X² + 10 X `error`.
    /// The code takes 128 and 16.
    #[inline(always)]
    pub(in crate::mesh) fn pass<S: Simd>(&self, simd: S, packet: &Packet<'_>) -> Passed {
        let [i, j, k] = self.axes;
        let from: [f64; 3] = by_axis!(axis => self.origin[axis] - packet.local_origin[axis]);
        let passes = [from[i] - self.slopes[0] * from[k], from[j] - self.slopes[1] * from[k]];
        let far = from[0].abs().max(from[1].abs()).max(from[2].abs());
        let error = 2.0 * (PACKING_ERROR + self.error) + 8.0 * UNIT_ROUNDOFF * far;
        let size = f64::from(packet.radius) + passes[0].abs().max(passes[1].abs());
        let bound = 128.0 * HALF_ULP * size * size + 16.0 * size * error + UNDERFLOW;
        let bound = splat(simd, bound);

        let (slope_i, slope_j) = (splat(simd, self.slopes[0]), splat(simd, self.slopes[1]));
        let (passes_i, passes_j) = (splat(simd, passes[0]), splat(simd, passes[1]));
        let seen: [[f32x8<S>; 2]; 3] = by_axis!(corner => {
            let corner = &packet.corners[corner];
            let along = load(simd, &corner[k]);
            [(load(simd, &corner[i]) - slope_i * along) - passes_i, (load(simd, &corner[j]) - slope_j * along) - passes_j]
        });
        let sides: [f32x8<S>; 3] = by_axis!(corner => {
            let ([x, y], [to_x, to_y]) = (seen[corner], seen[(corner + 1) % 3]);
            x * to_y - to_x * y
        });
        // Comparisons with NaN prove nothing.
        let (least, most) = (sides[0].min(sides[1]).min(sides[2]), sides[0].max(sides[1]).max(sides[2]));
        let is_missed = most.simd_gt(bound) & least.simd_lt(-bound);
        let used = packet.lanes_in_use();
        Passed {
            may_intersect: !(is_missed.to_bitmask() as u32) & used,
            turning_left: least.simd_gt(bound).to_bitmask() as u32 & used,
            turning_right: most.simd_lt(-bound).to_bitmask() as u32 & used,
        }
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, x: f64) -> f32x8<S> {
    f32x8::splat(simd, x as f32)
}

#[cfg(test)]
mod tests {
    use crate::simd::dispatch_every;
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::mesh::points::small_triangles::SmallTriangles;
    use crate::primitive::ray_triangle;
    use crate::simd::kernel_levels;

    /// Aims lines at corners, edges and places beside triangles of many sizes, from near and far.
    /// No triangle that a line intersects may be culled, and nearly all other triangles must be.
    #[test]
    fn triangles_on_a_line_are_never_culled() {
        let mut rng = Rng::new(77);
        let (mut intersected, mut kept, mut left_out) = (0, 0, 0);
        for round in 0..600 {
            let SmallTriangles { size, center, vertices, mesh } = SmallTriangles::random(&mut rng, round);
            for _ in 0..10 {
                let far = 2.0_f64.powi(rng.integer(-4, 12) as i32);
                let origin = [0, 1, 2].map(|k| center[k] + far * rng.uniform(-1.0, 1.0));
                let [p, q] = [0; 2].map(|_| vertices[rng.integer(0, 23) as usize]);
                let aim: [f64; 3] = match rng.integer(0, 2) {
                    0 => p,
                    1 => std::array::from_fn(|k| 0.5 * (p[k] + q[k])),
                    _ => center.map(|x| x + size * rng.uniform(-1.0, 1.0)),
                };
                let direction: [f64; 3] = std::array::from_fn(|k| aim[k] - origin[k]);
                let from = mesh.0.frame.pack(origin);
                let error = 16.0 * UNIT_ROUNDOFF * from.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                let line = Line::new(from, direction, error);
                for (name, level) in kernel_levels() {
                    for (at, leaf) in mesh.0.leaves.iter().enumerate() {
                        let packets = mesh.packets();
                        let lanes =
                            dispatch_every!(level, simd => line.may_intersect(simd, &packets.get(simd, at as u32)));
                        // In the packet of the face that keeps the frame large, the error bound
                        // hides small triangles.
                        let is_small = !leaf.held().contains(&8);
                        for (lane, &face) in leaf.held().iter().enumerate() {
                            let corners = mesh.corners(face);
                            let both_ways = [direction, direction.map(|x| -x)];
                            let intersects = both_ways.iter().any(|d| ray_triangle(&origin, d, &corners).is_some());
                            let is_kept = lanes >> lane & 1 == 1;
                            assert!(is_kept || !intersects, "{name}: face {face} of round {round}");
                            intersected += usize::from(intersects);
                            kept += usize::from(is_small && is_kept && !intersects);
                            left_out += usize::from(is_small && !is_kept);
                        }
                        assert_eq!(lanes & !((1 << leaf.count()) - 1), 0);
                    }
                }
            }
        }
        let levels = kernel_levels().len();
        assert!(
            intersected > 2_000 * levels && left_out > 10_000 * levels && kept < left_out / 4,
            "{intersected} intersected, {kept} kept, {left_out} left out"
        );
    }
}
