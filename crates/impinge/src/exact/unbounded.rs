//! Signs of determinants of posed coordinates of any size, in integers of any size.

use super::exact_points::{Corners, ExactPoints};
use super::placement::{Placement, world_point};
use crate::math::Sign;
use crate::math::dyadic::{self, Dyadic};

/// The corners of A, then of B, in the common local frame of equal poses, otherwise in the world.
pub(super) struct UnboundedPoints([[Dyadic; 3]; 6]);

impl UnboundedPoints {
    pub(super) fn new(placement: &Placement, a: &Corners, b: &Corners) -> Self {
        let exact = |pose, corner: &[f64; 3]| {
            if placement.is_shared() { corner.map(Dyadic::from_f64) } else { world_point(pose, corner) }
        };
        let [a0, a1, a2] = a.each_ref().map(|corner| exact(placement.world_from_a(), corner));
        let [b0, b1, b2] = b.each_ref().map(|corner| exact(placement.world_from_b(), corner));
        Self([a0, a1, a2, b0, b1, b2])
    }
}

impl ExactPoints for UnboundedPoints {
    fn orient3d(&self, [p, q, r, s]: [usize; 4]) -> Sign {
        let from_p = |x: usize| [0, 1, 2].map(|k| &self.0[x][k] - &self.0[p][k]);
        dyadic::dot(&dyadic::cross(&from_p(q), &from_p(r)), &from_p(s)).sign()
    }

    fn orient2d(&self, axis: usize, [p, q, r]: [usize; 3]) -> Sign {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let from_p = |x: usize, k: usize| &self.0[x][k] - &self.0[p][k];
        (&(&from_p(q, i) * &from_p(r, j)) - &(&from_p(q, j) * &from_p(r, i))).sign()
    }

    fn compare(&self, axis: usize, [p, q]: [usize; 2]) -> Sign {
        (&self.0[p][axis] - &self.0[q][axis]).sign()
    }
}
