//! The six corners of a pair of triangles. The signs of their determinants come from the fastest
//! tier that is certain of them.

use super::exact_points::{Corners, ExactPoints};
use super::filter::{self, Errors};
use super::fixed::FixedPoints;
use super::placement::Placement;
use super::unbounded::UnboundedPoints;
use super::wide::WidePoints;
use crate::math::Sign;
use crate::math::vec3::sub;

/// Slowest arithmetic that a decision needed. Variants are ordered from the fastest to the slowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tier {
    /// Floats with an error bound, or comparisons of stored coordinates.
    Filter,
    /// Integers of one machine word.
    Fixed,
    /// Integers of three machine words.
    Wide,
    /// Integers of any size.
    Unbounded,
}

/// Corners of a pair, with the coordinates known so far. Corners 0, 1 and 2 belong to A, corners 3,
/// 4 and 5 to B.
pub(super) struct PairCorners<'p> {
    placement: &'p Placement,
    a: &'p Corners,
    b: &'p Corners,
    /// B's corners in A's frame. Each coordinate is wrong by at most `image_error`.
    image_b: Corners,
    image_error: [f64; 3],
    exact: Option<Exact>,
}

/// Exact coordinates in the exact frame of the placement, in the smallest integers that hold them.
#[expect(clippy::large_enum_variant, reason = "one value per pair, on the stack")]
enum Exact {
    Fixed(FixedPoints),
    Wide(WidePoints),
    Unbounded(Box<UnboundedPoints>),
}

const NO_ERROR: [f64; 3] = [0.0; 3];

impl<'p> PairCorners<'p> {
    pub(super) fn new(placement: &'p Placement, a: &'p Corners, b: &'p Corners) -> Self {
        let (image_b, image_error) = if placement.is_shared() {
            (*b, NO_ERROR)
        } else {
            let map = placement.relative();
            let extent = std::array::from_fn(|k| b[0][k].abs().max(b[1][k].abs()).max(b[2][k].abs()));
            (b.map(|corner| map.apply(corner)), map.image_error(extent))
        };
        Self { placement, a, b, image_b, image_error, exact: None }
    }

    /// Returns the slowest tier that was needed so far.
    pub(super) fn tier(&self) -> Tier {
        match self.exact {
            None => Tier::Filter,
            Some(Exact::Fixed(_)) => Tier::Fixed,
            Some(Exact::Wide(_)) => Tier::Wide,
            Some(Exact::Unbounded(_)) => Tier::Unbounded,
        }
    }

    /// Returns the side of A's plane on which each corner of B lies. Positive is the side of A's
    /// normal, by the right-hand rule in A's frame. All signs are zero if A has no area.
    pub(super) fn sides_of_a(&mut self) -> [Sign; 3] {
        let [p, q, r] = self.a;
        let (u, v) = (sub(q, p), sub(r, p));
        let ws = self.image_b.each_ref().map(|corner| sub(corner, p));
        let certain = filter::signs(&u, &v, &ws, &Errors { u: &NO_ERROR, v: &NO_ERROR, w: &self.image_error });
        std::array::from_fn(|j| certain[j].unwrap_or_else(|| self.exact_orient3d(0, 1, 2, 3 + j)))
    }

    /// Returns the side of B's plane on which each corner of A lies. Positive is the side of B's
    /// normal, by the right-hand rule in A's frame. All signs are zero if B has no area.
    pub(super) fn sides_of_b(&mut self) -> [Sign; 3] {
        let [p, q, r] = &self.image_b;
        let (u, v) = (sub(q, p), sub(r, p));
        let ws = self.a.each_ref().map(|corner| sub(corner, p));
        let twice = self.image_error.map(|error| 2.0 * error);
        let certain = filter::signs(&u, &v, &ws, &Errors { u: &twice, v: &twice, w: &self.image_error });
        std::array::from_fn(|i| certain[i].unwrap_or_else(|| self.exact_orient3d(3, 4, 5, i)))
    }

    /// Returns the orientation of an edge of A and an edge of B: the sign of
    /// `det(a1 - a0, b0 - a0, b1 - a0)` in A's frame. Corners of both triangles are given by
    /// index, 0 to 2.
    pub(super) fn edges(&mut self, [a0, a1]: [usize; 2], [b0, b1]: [usize; 2]) -> Sign {
        let u = sub(&self.a[a1], &self.a[a0]);
        let v = sub(&self.image_b[b1], &self.image_b[b0]);
        let w = sub(&self.image_b[b0], &self.a[a0]);
        let twice = self.image_error.map(|error| 2.0 * error);
        let [certain] = filter::signs(&u, &v, &[w], &Errors { u: &NO_ERROR, v: &twice, w: &self.image_error });
        // det(u, w, v + w) = -det(u, v, w).
        certain.map_or_else(|| self.exact_orient3d(a0, a1, 3 + b0, 3 + b1), |sign| -sign)
    }

    /// Returns the orientation of three corners in the projection along an axis of the exact frame.
    pub(super) fn orient2d(&mut self, axis: usize, p: usize, q: usize, r: usize) -> Sign {
        self.in_one_frame([p, q, r])
            .and_then(|[p, q, r]| filter::sign2d(axis, p, q, r))
            .unwrap_or_else(|| self.exact_orient2d(axis, p, q, r))
    }

    /// Returns the sign of [`orient2d`](Self::orient2d) without the filter.
    pub(super) fn exact_orient2d(&mut self, axis: usize, p: usize, q: usize, r: usize) -> Sign {
        self.exact().orient2d(axis, [p, q, r])
    }

    /// Compares corner `p` with corner `q` along an axis of the exact frame.
    pub(super) fn compare(&mut self, axis: usize, p: usize, q: usize) -> Sign {
        match self.in_one_frame([p, q]).and_then(|[p, q]| p[axis].partial_cmp(&q[axis])) {
            Some(order) => order.into(),
            None => self.exact().compare(axis, [p, q]),
        }
    }

    /// Returns corners as stored, if the exact frame is the common local frame of both meshes.
    fn in_one_frame<const N: usize>(&self, corners: [usize; N]) -> Option<[&'p [f64; 3]; N]> {
        let (a, b) = (self.a, self.b);
        self.placement.is_shared().then(|| corners.map(|at| if at < 3 { &a[at] } else { &b[at - 3] }))
    }

    /// Returns the sign of `det(q - p, r - p, s - p)` in A's frame.
    pub(super) fn exact_orient3d(&mut self, p: usize, q: usize, r: usize, s: usize) -> Sign {
        // The exact frame is A's own frame or the world. A's pose may mirror the world.
        let mirrored = !self.placement.is_shared() && self.placement.world_from_a().mirrors();
        self.exact().orient3d([p, q, r, s]).negated_if(mirrored)
    }

    fn exact(&mut self) -> &dyn ExactPoints {
        let (placement, a, b) = (self.placement, self.a, self.b);
        let exact = self.exact.get_or_insert_with(|| {
            if let Some(points) = FixedPoints::new(placement.frame(), a, b) {
                return Exact::Fixed(points);
            }
            match WidePoints::new(placement, a, b) {
                Some(points) => Exact::Wide(points),
                None => Exact::Unbounded(Box::new(UnboundedPoints::new(placement, a, b))),
            }
        });
        match exact {
            Exact::Fixed(points) => points,
            Exact::Wide(points) => points,
            Exact::Unbounded(points) => &**points,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;

    struct Random(u64);

    impl Random {
        fn integer(&mut self, low: i64, high: i64) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (low + ((self.0 >> 33) % (high - low + 1) as u64) as i64) as f64
        }

        fn point(&mut self, extent: i64) -> [f64; 3] {
            std::array::from_fn(|_| self.integer(-extent, extent))
        }
    }

    /// Compares every sign that the corners can have across all arithmetics that hold the corners.
    /// Returns whether the fixed and the wide integers hold them.
    fn assert_tiers_agree(placement: &Placement, a: &Corners, b: &Corners) -> [bool; 2] {
        let unbounded = UnboundedPoints::new(placement, a, b);
        let fixed = FixedPoints::new(placement.frame(), a, b);
        let wide = WidePoints::new(placement, a, b);
        let others: [Option<&dyn ExactPoints>; 2] = [fixed.as_ref().map(|x| x as _), wide.as_ref().map(|x| x as _)];
        for points in others.into_iter().flatten() {
            for p in 0..6 {
                for q in 0..6 {
                    for axis in 0..3 {
                        assert_eq!(points.compare(axis, [p, q]), unbounded.compare(axis, [p, q]));
                        let r = (q + 1) % 6;
                        assert_eq!(points.orient2d(axis, [p, q, r]), unbounded.orient2d(axis, [p, q, r]));
                    }
                    let corners = [p, q, (q + 1) % 6, (p + q + 2) % 6];
                    assert_eq!(points.orient3d(corners), unbounded.orient3d(corners));
                }
            }
        }
        [fixed.is_some(), wide.is_some()]
    }

    #[test]
    fn every_arithmetic_has_the_same_signs() {
        let mut random = Random(1);
        let mut held = [0; 2];
        for case in 0..2000 {
            let extent = [2, 1 << 20, 1 << 40, 1 << 52][case % 4];
            let (mut a, b): (Corners, Corners) =
                (std::array::from_fn(|_| random.point(extent)), std::array::from_fn(|_| random.point(extent)));
            if case % 3 == 0 {
                a[0] = b[1].map(|x| x * f64::from_bits((1023 + (case as u64 % 200) - 100) << 52));
            }
            let entries = [0, 1, 3, 1 << 52][case / 4 % 4];
            let linear = |random: &mut Random| loop {
                let scale = random.integer(1, 9);
                let rows = [[scale, 0.0, 0.0], [0.0, scale, 0.0], [0.0, 0.0, scale]];
                let rows = if entries == 0 { *Pose::IDENTITY.linear() } else { rows };
                let rows = rows.map(|row| row.map(|x| x + random.integer(-entries, entries)));
                if let Ok(pose) = Pose::new(rows, random.point(extent)) {
                    return pose;
                }
            };
            let (world_from_a, world_from_b) = (linear(&mut random), linear(&mut random));
            for other in [&world_from_a, &world_from_b] {
                let holds = assert_tiers_agree(&Placement::new(&world_from_a, other), &a, &b);
                held = [0, 1].map(|i| held[i] + usize::from(holds[i]));
            }
        }
        assert!((800..3000).contains(&held[0]) && (2000..4000).contains(&held[1]), "{held:?}");
    }

    /// Uses the largest numbers that each fixed size accepts, so that an overflow would give a
    /// wrong sign.
    #[test]
    fn full_words_do_not_overflow() {
        let mut random = Random(2);
        let mut held = [0; 2];
        for case in 0..3000 {
            let bits: i64 = [57, 58, 59, 60, 61][case % 5];
            // Corners of a cube that fills the span, and corners that differ from them by the last
            // unit.
            let mut corner = || -> [f64; 3] {
                std::array::from_fn(|_| {
                    let limit = (2.0_f64).powi(bits as i32);
                    let sign = random.integer(0, 1) * 2.0 - 1.0;
                    match random.integer(0, 3) as u8 {
                        0 => sign,
                        1 => 0.0,
                        2 => sign * (limit * (1.0 - f64::EPSILON)),
                        _ => sign * limit * 0.5,
                    }
                })
            };
            let (a, b) = (std::array::from_fn(|_| corner()), std::array::from_fn(|_| corner()));
            let all = [[1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]];
            let world_from_a = Pose::new(all, corner()).expect("legal");
            let world_from_b = Pose::new(all.map(|row| row.map(|x| -x)), corner()).expect("legal");
            // The same for three machine words, whose span is about 130 bits larger.
            let wide = 2.0_f64.powi(64);
            let stretched =
                Pose::new(all.map(|row| row.map(|x| x * wide)), *world_from_a.translation()).expect("legal");
            for (first, second) in [(&world_from_a, &world_from_b), (&world_from_a, &stretched)] {
                let far = |corners: &Corners| corners.map(|corner| corner.map(|x| x * 2.0_f64.powi(62)));
                for (a, b) in [(a, b), (a, far(&b))] {
                    let holds = assert_tiers_agree(&Placement::new(first, second), &a, &b);
                    held = [0, 1].map(|i| held[i] + usize::from(holds[i]));
                }
            }
        }
        assert!(held[0] > 300 && held[1] > 5000, "{held:?}");
    }
}
