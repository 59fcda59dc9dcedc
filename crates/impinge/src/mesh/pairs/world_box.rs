//! The bounds of a mesh on the axes of the world. They prove most distant meshes apart before
//! anything else is computed.
//!
//! Source: Arvo, *Transforming axis-aligned bounding boxes*, Graphics Gems, 1990 (Ericson, 4.2.6);
//! ours bounds its rounding.

use crate::math::relative::{UNDERFLOW, UNIT_ROUNDOFF};
use crate::mesh::PlacedMesh;

/// Reports whether the boxes of two meshes are proved apart on an axis of the world, so that the
/// meshes have no common point.
///
/// # Accuracy
/// A coordinate of a center's image takes four roundings of terms of at most the sum of their
/// magnitudes; extents are sums of positive numbers. If a number is NaN, nothing is proved.
#[inline]
pub(in crate::mesh) fn are_apart(a: &PlacedMesh<'_>, b: &PlacedMesh<'_>) -> bool {
    let [on_a, on_b] = [a, b].map(|placed| [0, 1, 2].map(|k| Interval::of(placed, k)));
    (0..3).any(|k| on_a[k].is_apart(&on_b[k]))
}

/// The interval of a mesh on an axis of the world.
struct Interval {
    center: f64,
    reach: f64,
    /// Sum of the magnitudes of the terms of `center`, which bounds its rounding.
    terms: f64,
}

impl Interval {
    #[inline(always)]
    fn of(placed: &PlacedMesh<'_>, k: usize) -> Self {
        let (mesh, pose) = (&placed.mesh.0, &placed.world_from_mesh);
        let (row, [x, y, z], [u, v, w]) = (pose.linear()[k], mesh.frame.origin, mesh.half_extents);
        let at = [row[0] * x, row[1] * y, row[2] * z, pose.translation()[k]];
        Self {
            center: (at[0] + at[1]) + (at[2] + at[3]),
            reach: row[0].abs() * u + row[1].abs() * v + row[2].abs() * w,
            terms: (at[0].abs() + at[1].abs()) + (at[2].abs() + at[3].abs()),
        }
    }

    #[inline(always)]
    fn is_apart(&self, other: &Self) -> bool {
        let rounding = 8.0 * UNIT_ROUNDOFF * (self.terms + other.terms) + UNDERFLOW;
        (self.center - other.center).abs() > (self.reach + other.reach) * (1.0 + 1e-12) + rounding
    }
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::poses::{large_integer_map, rotation};
    use impinge_testkit::generate::{Rng, solids};

    use super::*;
    use crate::math::Pose;
    use crate::mesh::{Mesh, Options, Positions, first_hit};

    #[test]
    fn touching_boxes_are_not_apart_and_a_small_gap_is_found() {
        let plain = solids::cuboid([-1.0, -2.0, 3.0], [2.0, 1.0, 4.0]);
        let mesh = Mesh::new(Positions::F64(plain.vertices), plain.faces).expect("a mesh");
        for shift in [[3.0, 0.5, 0.25], [0.0, -3.0, 1.0], [-1.0, 1.0, 1.0]] {
            for (share, touch) in [(1.0, true), (1.0 + 1e-6, false)] {
                let there = mesh.at(Pose::from_translation(shift.map(|x| x * share)).expect("a pose"));
                assert_eq!(first_hit((&mesh).into(), there, &Options::default()).is_some(), touch);
                assert_eq!(are_apart(&(&mesh).into(), &there), !touch, "{shift:?} times {share}");
            }
        }
    }

    #[test]
    fn meshes_that_share_a_point_far_from_the_origin_are_not_apart() {
        // A point, and a segment that ends in it and lies behind it on an axis of the world. The
        // two intervals touch. They are only a few rounding errors of their position long.
        let mut rng = Rng::new(12);
        let step = 1.0 / f64::from(1 << 20);
        let degenerate = |corners: Vec<[f64; 3]>| Mesh::new(Positions::F64(corners), vec![[0, 1, 1]]).expect("a mesh");
        let mut apart = 0;
        for round in 0..400 {
            let map = if round % 4 == 0 { large_integer_map(&mut rng) } else { rotation(&mut rng) };
            let pose = Pose::new(map.linear, map.translation).expect("a pose");
            let end = [0; 3].map(|_| step * rng.integer(-1 << 40, 1 << 40) as f64);
            let row = map.linear[round % 3];
            let behind = [0, 1, 2].map(|k| end[k] - step.copysign(row[k]));
            let (point, segment) = (degenerate(vec![end, end]), degenerate(vec![behind, end]));
            assert!(first_hit(point.at(pose), segment.at(pose), &Options::default()).is_some(), "round {round}");
            assert!(!are_apart(&point.at(pose), &segment.at(pose)), "round {round}");
            let beyond = degenerate(vec![[0, 1, 2].map(|k| end[k] + (1 << 12) as f64 * step.copysign(row[k])); 2]);
            apart += usize::from(are_apart(&beyond.at(pose), &segment.at(pose)));
        }
        assert!(apart > 390, "{apart} of 400 are apart");
    }
}
