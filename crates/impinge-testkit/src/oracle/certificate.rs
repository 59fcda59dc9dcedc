//! Proof in f64 that two triangles are apart, so that exact integers decide only pairs that nearly
//! intersect.
//!
//! A direction n is a proof if every corner of one triangle is farther along n than every corner of
//! the other. No property of n is used, so it may be found in rounded arithmetic. The candidates
//! are the normals of both triangles, the cross products of their edges and, for nearly coplanar
//! triangles, the normals of edges within the plane (Ericson, *Real-Time Collision Detection*,
//! 5.2.1).
//!
//! **Bound.** The exact corner p lies within `reach` of the rounded p' on each axis. The computed
//! n·p' differs from the exact n·p' by at most 3u/(1-3u) Σ|n_k p'_k| and underflow, and n·p' from
//! n·p by at most Σ|n_k| reach_k. The slack used, Σ|n_k| (8u|p'_k| + reach_k) + 2^-1070, is itself
//! rounded five times, by at most 5u of it: 3u|p'_k| needs less than half of the 8u, and a reach is
//! 1/3 larger than necessary. The last term exceeds all underflow, and a step outward compensates
//! the final addition. An overflow anywhere proves nothing.

use super::boxes::image_and_reach;
use crate::Affine;

/// Triangle in rounded world coordinates, with a bound on the error of each.
pub(super) struct Rounded {
    corners: [[f64; 3]; 3],
    reach: [[f64; 3]; 3],
}

impl Rounded {
    pub(super) fn new(corners: &[[f64; 3]; 3], world_from_local: &Affine) -> Self {
        let both = corners.map(|corner| image_and_reach(world_from_local, corner));
        Self { corners: both.map(|(image, _)| image), reach: both.map(|(_, reach)| reach) }
    }

    /// Reports whether a direction proves that the exact triangles have no point in common. `false`
    /// proves nothing.
    pub(super) fn proved_apart(&self, other: &Self) -> bool {
        let (edges_a, edges_b) = (self.edges(), other.edges());
        let normals = [cross(edges_a[0], edges_a[1]), cross(edges_b[0], edges_b[1])];
        normals.iter().any(|&n| self.separated_along(other, n))
            || edges_a.iter().any(|&e| edges_b.iter().any(|&f| self.separated_along(other, cross(e, f))))
            || edges_a.iter().any(|&e| self.separated_along(other, cross(normals[0], e)))
            || edges_b.iter().any(|&f| self.separated_along(other, cross(normals[1], f)))
    }

    fn separated_along(&self, other: &Self, direction: [f64; 3]) -> bool {
        let (low_a, high_a) = self.extent(direction);
        let (low_b, high_b) = other.extent(direction);
        high_a < low_b || high_b < low_a
    }

    /// Returns bounds of `direction · p` over the exact triangle. They are infinite if anything
    /// overflows.
    fn extent(&self, direction: [f64; 3]) -> (f64, f64) {
        const EIGHT_ROUNDINGS: f64 = 4.0 * f64::EPSILON;
        const UNDERFLOW: f64 = 16.0 * 5e-324;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (corner, reach) in self.corners.iter().zip(&self.reach) {
            let along = dot(direction, *corner);
            let doubt = std::array::from_fn(|k| EIGHT_ROUNDINGS * corner[k].abs() + reach[k]);
            let slack = dot(direction.map(f64::abs), doubt) + UNDERFLOW;
            if !(along.is_finite() && slack.is_finite()) {
                return (f64::NEG_INFINITY, f64::INFINITY);
            }
            low = low.min((along - slack).next_down());
            high = high.max((along + slack).next_up());
        }
        (low, high)
    }

    fn edges(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|i| {
            let (from, to) = (self.corners[i], self.corners[(i + 1) % 3]);
            std::array::from_fn(|k| to[k] - from[k])
        })
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::pairs;
    use crate::oracle::triangles_meet;

    #[test]
    fn proofs_are_true_and_most_pairs_apart_are_proved() {
        let (mut apart, mut proved) = (0, 0);
        for pair in pairs::tie_heavy(5, 4_000) {
            let (a, b) = (&pair.a, &pair.b);
            let proof = Rounded::new(a, &pair.world_from_a).proved_apart(&Rounded::new(b, &pair.world_from_b));
            let meets = triangles_meet(a, &pair.world_from_a, b, &pair.world_from_b);
            assert!(!(proof && meets), "{pair:?}");
            apart += usize::from(!meets);
            proved += usize::from(proof);
        }
        assert!(apart > 1_000 && proved * 10 > apart * 6, "{proved} of {apart}");
    }

    #[test]
    fn proofs_are_true_if_images_cancel() {
        // The local frame is moved far away and the pose moves it back, so that mostly rounding is
        // left.
        const AWAY: f64 = (1u64 << 40) as f64;
        let (mut meeting, mut proved) = (0, 0);
        for pair in pairs::under_rotations(6, 4_000) {
            let (a, b) = [pair.a, pair.b].map(|corners| corners.map(|p| p.map(|x| x + AWAY))).into();
            let back = |pose: Affine| {
                let offset = Affine::new(pose.linear, [0.0; 3]).apply_rounded([AWAY; 3]);
                Affine::new(pose.linear, std::array::from_fn(|k| pose.translation[k] - offset[k]))
            };
            let (world_from_a, world_from_b) = (back(pair.world_from_a), back(pair.world_from_b));
            let proof = Rounded::new(&a, &world_from_a).proved_apart(&Rounded::new(&b, &world_from_b));
            let meets = triangles_meet(&a, &world_from_a, &b, &world_from_b);
            assert!(!(proof && meets), "{pair:?}");
            meeting += usize::from(meets);
            proved += usize::from(proof);
        }
        assert!(meeting > 500 && proved > 500, "{meeting} intersect, {proved} are proved apart");
    }
}
