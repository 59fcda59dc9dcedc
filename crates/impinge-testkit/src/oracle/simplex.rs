//! Intersection of two triangles as feasibility of a linear program, in integers of any size.
//!
//! The triangles with corners A₀ A₁ A₂ and B₀ B₁ B₂ have a point in common exactly if weights l, m
//! ≥ 0, each of sum 1, satisfy Σ lᵢ Aᵢ = Σ mⱼ Bⱼ. These are five equations in six unknowns of zero
//! or more. Phase 1 of the simplex method decides it: start from five artificial variables,
//! minimize their sum, and check whether it reaches zero.
//!
//! The tableau is kept in integers over one common denominator, which each pivot divides out
//! exactly (Edmonds' integer pivoting; Azulay and Pique, *A revised simplex method with integer
//! Q-matrices*, 2001). Bland's rule guarantees that it ends: the least index enters, and among tied
//! ratios the least index leaves (Bland, *New finite pivoting rules*, 1977). An artificial variable
//! that has left never returns, so its column is not kept.

use super::integers::{Vector, corners};
use crate::Affine;
use dashu_int::IBig;

/// Column of the right-hand side. The columns before it are the weights of A and of B.
const RIGHT: usize = 6;
/// Row of the cost. The rows before it are x, y, z, and the sums of the weights of A and of B.
const COST: usize = 5;

/// Reports whether two closed triangles have a point in common, exactly.
///
/// Corners are in local frames, and the answer is about their images under the maps. A triangle
/// without area is the segment or the point that it spans.
///
/// # Panics
/// Panics if a number is not finite.
pub fn triangles_meet(a: &[[f64; 3]; 3], world_from_a: &Affine, b: &[[f64; 3]; 3], world_from_b: &Affine) -> bool {
    let (a, b) = corners(a, world_from_a, b, world_from_b);
    Tableau::new(a, b).reaches_zero()
}

struct Tableau {
    /// Entries times `denominator`, which is positive.
    rows: [[IBig; 7]; 6],
    denominator: IBig,
    /// Variable that each equation is solved for. Variables 6 and above are artificial.
    basis: [usize; 5],
}

impl Tableau {
    fn new(a: [Vector; 3], b: [Vector; 3]) -> Self {
        let mut rows: [[IBig; 7]; 6] = Default::default();
        for (i, corner) in a.into_iter().enumerate() {
            for (k, x) in corner.into_iter().enumerate() {
                rows[k][i] = x;
            }
            rows[3][i] = IBig::ONE;
        }
        for (j, corner) in b.into_iter().enumerate() {
            for (k, x) in corner.into_iter().enumerate() {
                rows[k][3 + j] = -x;
            }
            rows[4][3 + j] = IBig::ONE;
        }
        rows[3][RIGHT] = IBig::ONE;
        rows[4][RIGHT] = IBig::ONE;
        for column in 0..=RIGHT {
            rows[COST][column] = -rows[..COST].iter().map(|row| &row[column]).sum::<IBig>();
        }
        Self { rows, denominator: IBig::ONE, basis: [6, 7, 8, 9, 10] }
    }

    /// Minimizes the sum of the artificial variables, and reports whether it reaches zero.
    fn reaches_zero(mut self) -> bool {
        loop {
            // The last entry of the cost row is minus the sum of the artificial variables, which is
            // never negative.
            if self.rows[COST][RIGHT] == IBig::ZERO {
                return true;
            }
            let Some(entering) = (0..RIGHT).find(|&column| self.rows[COST][column] < IBig::ZERO) else {
                return false;
            };
            let leaving = self.leaving(entering).expect("a sum of variables that are not negative is bounded below");
            self.pivot(leaving, entering);
        }
    }

    /// Returns the equation that limits the growth of the entering variable.
    fn leaving(&self, entering: usize) -> Option<usize> {
        (0..COST).filter(|&row| self.rows[row][entering] > IBig::ZERO).min_by(|&i, &j| {
            let (row_i, row_j) = (&self.rows[i], &self.rows[j]);
            let ratio = (&row_i[RIGHT] * &row_j[entering]).cmp(&(&row_j[RIGHT] * &row_i[entering]));
            ratio.then(self.basis[i].cmp(&self.basis[j]))
        })
    }

    fn pivot(&mut self, leaving: usize, entering: usize) {
        let pivot_row = self.rows[leaving].clone();
        let pivot = &pivot_row[entering];
        for (i, row) in self.rows.iter_mut().enumerate() {
            if i == leaving {
                continue;
            }
            let factor = row[entering].clone();
            for (x, p) in row.iter_mut().zip(&pivot_row) {
                // Both are minors of the first tableau, so the division leaves no remainder.
                *x = (&*x * pivot - &factor * p) / &self.denominator;
            }
        }
        self.denominator = pivot.clone();
        self.basis[leaving] = entering;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    fn meets_floor(b: [[f64; 3]; 3]) -> bool {
        let answer = triangles_meet(&FLOOR, &Affine::IDENTITY, &b, &Affine::IDENTITY);
        assert_eq!(answer, triangles_meet(&b, &Affine::IDENTITY, &FLOOR, &Affine::IDENTITY));
        answer
    }

    #[test]
    fn touching_intersects_and_the_smallest_gap_does_not() {
        let above = 5e-324;
        let stands_at = |z: f64| [[1.0, 1.0, z], [1.0, 1.0, 3.0], [2.0, 1.0, 3.0]];
        assert!(meets_floor(stands_at(0.0)));
        assert!(meets_floor(stands_at(-above)));
        assert!(!meets_floor(stands_at(above)));
        assert!(meets_floor([[2.0, 2.0, 0.0], [5.0, 5.0, 0.0], [5.0, 5.0, 1.0]]), "a corner on the long edge");
        assert!(!meets_floor([[2.0, 2.0f64.next_up(), 0.0], [5.0, 5.0, 0.0], [5.0, 5.0, 1.0]]));
    }

    #[test]
    fn points_and_segments_are_triangles() {
        let point = |p: [f64; 3]| [p; 3];
        assert!(meets_floor(point([1.0, 1.0, 0.0])));
        assert!(!meets_floor(point([1.0, 1.0, 1e-300])));
        assert!(!meets_floor(point([3.0, 3.0, 0.0])));
        let segment = |p: [f64; 3], q: [f64; 3]| [p, q, p];
        assert!(meets_floor(segment([1.0, 1.0, -1.0], [1.0, 1.0, 1.0])));
        assert!(meets_floor(segment([-1.0, 1.0, 0.0], [9.0, 1.0, 0.0])));
        assert!(!meets_floor(segment([-1.0, 5.0, 0.0], [9.0, 5.0, 0.0])));
    }

    #[test]
    fn the_pose_is_not_rounded() {
        // 3 * 0.1 lies half-way, to 2^-55, between 0.3 and the next float, to which the product
        // rounds.
        let lifted = Affine::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 3.0]], [0.0, 0.0, -0.3]);
        let b = [[1.0, 1.0, 0.1], [1.0, 1.0, 3.0], [2.0, 1.0, 3.0]];
        assert!(!triangles_meet(&FLOOR, &Affine::IDENTITY, &b, &lifted));
        let lowered = Affine::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 3.0]], [0.0, 0.0, -0.3f64.next_up()]);
        assert!(triangles_meet(&FLOOR, &Affine::IDENTITY, &b, &lowered));
    }
}
