//! Simplices of up to four differences, and the point of a simplex nearest to the origin, in
//! floats.
//!
//! If the origin is on the outer side of some faces, the nearest point is on one of them. If
//! rounding spoils a sign, the result is a point that is nearest up to the rounding. Other modules
//! validate the result; it proves nothing by itself.
//!
//! # Source
//! Ericson, *Real-Time Collision Detection*, 2005, 5.1.6. Ours decides sides by volumes, areas and
//! lengths from the same three products.

use super::posed::{Difference, Spot};
use crate::math::vec3::{cross, dot, sub};

/// Up to four differences.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    differences: [Difference; 4],
    len: usize,
}

impl Simplex {
    const NOWHERE: Spot = Spot { local: [0.0; 3], point: [0.0; 3] };

    pub(super) const EMPTY: Self =
        Self { differences: [Difference { a: Self::NOWHERE, b: Self::NOWHERE, vector: [0.0; 3] }; 4], len: 0 };

    /// Adds a difference. There is room unless the last [`nearest`](Self::nearest) was a
    /// tetrahedron about the origin; then the last difference is replaced.
    pub(super) fn push(&mut self, difference: Difference) {
        let at = self.len.min(3);
        self.differences[at] = difference;
        self.len = at + 1;
    }

    /// Returns a simplex of three differences.
    pub(super) fn of(corners: &[Difference; 3]) -> Self {
        let mut simplex = Self::EMPTY;
        corners.iter().for_each(|corner| simplex.push(*corner));
        simplex
    }

    pub(super) fn nearest(&self) -> Nearest {
        nearest(&self.differences.each_ref().map(|difference| difference.vector)[..self.len])
    }

    /// Returns the point of the simplex nearest to a place, relative to that place.
    pub(super) fn nearest_to(&self, place: &[f64; 3]) -> Nearest {
        nearest(&self.differences.each_ref().map(|difference| sub(&difference.vector, place))[..self.len])
    }

    /// Keeps the differences with a positive weight.
    pub(super) fn keep(&mut self, weights: &[f64; 4]) {
        let mut kept = 0;
        for (at, &weight) in weights.iter().enumerate().take(self.len) {
            if weight > 0.0 {
                self.differences[kept] = self.differences[at];
                kept += 1;
            }
        }
        self.len = kept;
    }
}

impl std::ops::Deref for Simplex {
    type Target = [Difference];

    fn deref(&self) -> &[Difference] {
        &self.differences[..self.len]
    }
}

/// The nearest point of a simplex to the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// Weights of the points: not negative, with a sum of 1 up to rounding.
    pub(crate) weights: [f64; 4],
    /// The weighted sum of the points. Zero if a tetrahedron holds the origin.
    pub(crate) vector: [f64; 3],
    /// A direction from the nearest point to the origin. For a triangle it is the normal, because a
    /// point close to the origin has no digits left for a direction.
    pub(crate) towards_origin: [f64; 3],
}

/// Returns the nearest point to the origin in the hull of one to four points.
pub(crate) fn nearest(points: &[[f64; 3]]) -> Nearest {
    let mut search = Search { points, least: f64::INFINITY, best: [0; 4], len: 0, weights: [0.0; 4] };
    match points.len() {
        1 => search.look([0]),
        2 => search.look([0, 1]),
        3 => search.look([0, 1, 2]),
        _ => search.look([0, 1, 2, 3]),
    }
    search.into_nearest()
}

struct Search<'p> {
    points: &'p [[f64; 3]],
    /// The least squared distance so far, with the points and the weights that give it.
    least: f64,
    best: [usize; 4],
    len: usize,
    weights: [f64; 4],
}

impl Search<'_> {
    /// Tries the nearest point of the members' affine hull if it is inside the simplex. Otherwise
    /// tries the faces that the origin is beyond.
    #[inline(always)]
    fn look<const N: usize>(&mut self, members: [usize; N]) {
        let shares = shares(&members.map(|member| self.points[member]));
        let beyond = shares.map(|share| !(share > 0.0 && share.is_finite()));
        if N == 1 || beyond[..N].iter().all(|&is_beyond| !is_beyond) {
            self.take(members, shares);
            return;
        }
        // Without area or volume all shares are zero, so all faces are tried.
        for left_out in 0..N {
            if beyond[left_out] {
                let others = |at: usize| members[if at < left_out { at } else { at + 1 }];
                match N {
                    4 => self.look_at_triangle([others(0), others(1), others(2)]),
                    3 => self.look_at_edge([others(0), others(1)]),
                    _ => self.take([others(0)], [1.0, 0.0, 0.0, 0.0]),
                }
            }
        }
    }

    #[inline(never)]
    fn look_at_triangle(&mut self, members: [usize; 3]) {
        self.look(members);
    }

    #[inline(never)]
    fn look_at_edge(&mut self, members: [usize; 2]) {
        self.look(members);
    }

    #[inline(always)]
    fn take<const N: usize>(&mut self, members: [usize; N], shares: [f64; 4]) {
        let total: f64 = shares[..N].iter().sum();
        let weights: [f64; 4] = if N == 1 { shares } else { shares.map(|share| share / total) };
        let squared = if N == 4 {
            0.0
        } else {
            let vector = self.mean(&members, &weights);
            dot(&vector, &vector)
        };
        if squared < self.least {
            (self.least, self.weights, self.len) = (squared, weights, N);
            self.best[..N].copy_from_slice(&members);
        }
    }

    fn mean(&self, members: &[usize], weights: &[f64; 4]) -> [f64; 3] {
        members
            .iter()
            .zip(weights)
            .fold([0.0; 3], |sum, (&member, weight)| std::array::from_fn(|k| sum[k] + weight * self.points[member][k]))
    }

    fn into_nearest(self) -> Nearest {
        let members = &self.best[..self.len];
        let vector = if self.len == 4 { [0.0; 3] } else { self.mean(members, &self.weights) };
        let mut nearest = Nearest { weights: [0.0; 4], vector, towards_origin: vector.map(|x| -x) };
        for (&member, weight) in members.iter().zip(self.weights) {
            nearest.weights[member] = weight;
        }
        if let &[p, q, r] = members {
            let [p, q, r] = [p, q, r].map(|member| self.points[member]);
            let normal = cross(&sub(&q, &p), &sub(&r, &p));
            let flip = if dot(&normal, &p) > 0.0 { -1.0 } else { 1.0 };
            nearest.towards_origin = normal.map(|x| flip * x);
        }
        nearest
    }
}

/// Returns the weights of the points, up to a common factor, in the point of their affine hull that
/// is nearest to the origin. A weight is positive if that point is on the inner side of the face
/// without the weighted point.
#[inline(always)]
fn shares(points: &[[f64; 3]]) -> [f64; 4] {
    match points {
        [p, q] => {
            let edge = sub(q, p);
            [dot(q, &edge), -dot(p, &edge), 0.0, 0.0]
        }
        [p, q, r] => {
            let normal = cross(&sub(q, p), &sub(r, p));
            [dot(&cross(q, r), &normal), dot(&cross(r, p), &normal), dot(&cross(p, q), &normal), 0.0]
        }
        [p, q, r, s] => {
            let orientation = dot(&cross(&sub(q, p), &sub(r, p)), &sub(s, p)).signum();
            let (pq, rs) = (cross(p, q), cross(r, s));
            [
                orientation * dot(&rs, q),
                -orientation * dot(&rs, p),
                orientation * dot(&pq, s),
                -orientation * dot(&pq, r),
            ]
        }
        _ => [1.0, 0.0, 0.0, 0.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3::length;

    #[test]
    fn parts_of_a_simplex() {
        let corners = [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [0.0, -2.0, 1.0], [0.0, 0.0, -3.0]];
        assert_eq!(nearest(&corners[..1]).vector, [1.0; 3]);
        assert_eq!(nearest(&corners[..2]).vector, [0.0, 1.0, 1.0]);
        assert_eq!(nearest(&corners[..3]).vector, [0.0, 0.0, 1.0]);
        assert_eq!(nearest(&corners).vector, [0.0; 3]);
        assert!(nearest(&corners).weights.iter().all(|&weight| weight > 0.0));
        let one = nearest(&[[2.0, 0.0, 0.0]; 4]);
        assert_eq!((one.vector, one.weights.iter().sum::<f64>()), ([2.0, 0.0, 0.0], 1.0));
    }

    /// Tries all parts of the simplex: none has a nearer point.
    #[test]
    fn no_part_is_nearer() {
        let mut rng = impinge_testkit::generate::Rng::new(171);
        let mut kinds = [0; 5];
        for _ in 0..20_000 {
            let count = rng.integer(1, 4) as usize;
            let (on_grid, shift) = (rng.one_in(2), rng.uniform(-1.0, 1.0));
            let mut number = |_: i32| if on_grid { rng.integer(-2, 2) as f64 } else { rng.uniform(-1.0, 1.0) + shift };
            let points: Vec<[f64; 3]> = (0..count).map(|_| [0; 3].map(&mut number)).collect();
            let found = nearest(&points);
            let mut sum = [0.0; 3];
            for (point, weight) in points.iter().zip(found.weights) {
                assert!(weight >= 0.0);
                sum = std::array::from_fn(|k| sum[k] + weight * point[k]);
            }
            let total: f64 = found.weights.iter().sum();
            let least = (1..1 << count).filter_map(|part: usize| {
                let members: Vec<[f64; 3]> = (0..count).filter(|i| part >> i & 1 == 1).map(|i| points[i]).collect();
                let shares = shares(&members);
                let total: f64 = shares[..members.len()].iter().sum();
                let is_inside = shares[..members.len()].iter().all(|&share| share > 1e-12);
                let nearest = |k: usize| members.iter().zip(shares).map(|(p, share)| share / total * p[k]).sum::<f64>();
                is_inside.then(|| length(&[0, 1, 2].map(nearest)))
            });
            let least = least.fold(f64::INFINITY, f64::min);
            let off = length(&sub(&sum, &found.vector));
            assert!((total - 1.0).abs() < 1e-12 && off < 1e-9, "{points:?} {found:?}");
            assert!(length(&found.vector) <= least + 1e-9, "{points:?} {found:?} {least}");
            kinds[found.weights.iter().filter(|&&weight| weight > 0.0).count()] += 1;
        }
        assert!(kinds[1..].iter().all(|&kind| kind > 200), "{kinds:?}");
    }
}
