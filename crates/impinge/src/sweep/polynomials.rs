//! Criteria for contact of two simplices that have four corners together and whose corners move
//! along lines.
//!
//! Four points x₀..x₃ of a plane have an affine dependency, Σ λᵢ xᵢ = 0 with Σ λᵢ = 0. In the
//! projection along an axis that is not parallel to the plane, λᵢ is the signed area of the
//! triangle of the other three points, with alternating signs. Two simplices with these corners
//! intersect if and only if the λ of one have one sign and those of the other have the opposite
//! sign (Radon 1921). Let the signs be flipped for the corners of the second simplex. Then a time t
//! is *not* a time of contact if and only if one of these holds:
//!
//! - the volume of the four points, a cubic in t, is not zero;
//! - along some axis two of the four areas, quadratics in t, have strictly opposite signs;
//! - along some axis all corners of one simplex are strictly beyond those of the other:
//!   differences, linear in t.
//!
//! The last criterion serves if all four points are on one line and every area is zero. Each of the
//! three is strict, so it also holds near t. It shows in the Bernstein coefficients of a short
//! enough interval about t. So if there is no contact, halving intervals disproves it in finitely
//! many steps (docs/notes/proof.md, L23).

use std::ops::{Add, Mul, Sub};

/// The corners of the four that belong to the first simplex. The rest belong to the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Split {
    /// A vertex, then the three corners of a face.
    VertexFace,
    /// The two ends of an edge, then those of another edge.
    EdgeEdge,
}

impl Split {
    /// Returns the number of corners of the first simplex.
    #[inline]
    pub(super) fn first(self) -> usize {
        match self {
            Self::VertexFace => 1,
            Self::EdgeEdge => 2,
        }
    }

    /// Returns for each corner whether the area of the opposite face is flipped: once for the
    /// alternating sign, and once more for the corners of the second simplex.
    fn turned(self) -> [bool; 4] {
        match self {
            Self::VertexFace => [false, false, true, false],
            Self::EdgeEdge => [false, true, true, false],
        }
    }
}

/// The volume and the areas over the whole motion, as multiples of their Bernstein coefficients.
#[derive(Clone, Debug)]
pub(super) struct Polynomials<T> {
    /// Bernstein coefficients of 6 times the volume, times 3.
    pub(super) volume: [T; 4],
    /// Bernstein coefficients of 2 times the areas, times 2, by axis, then by the corner that is
    /// left out.
    pub(super) areas: [[[T; 3]; 4]; 3],
}

impl<T: Clone> Polynomials<T>
where
    for<'x> &'x T: Add<&'x T, Output = T> + Sub<&'x T, Output = T> + Mul<&'x T, Output = T>,
{
    /// Computes the polynomials for corners given at both ends of the motion.
    pub(super) fn new(t0: &[[T; 3]; 4], t1: &[[T; 3]; 4], split: Split) -> Self {
        let edges = |from: usize, to: usize| [t0, t1].map(|x| difference(&x[to], &x[from]));
        let [u, v, w] = [edges(0, 1), edges(0, 2), edges(0, 3)];
        let normal = products(&u, &v);
        // Coefficients of a product of polynomials before they are divided by binomials: 1, 3, 3, 1
        // times those of the volume. The ends are taken three times, so that all have the same
        // factor.
        let [start, end] = [dot(&normal[0], &w[0]), dot(&normal[2], &w[1])];
        let volume = [
            &(&start + &start) + &start,
            &dot(&normal[0], &w[1]) + &dot(&normal[1], &w[0]),
            &dot(&normal[1], &w[1]) + &dot(&normal[2], &w[0]),
            &(&end + &end) + &end,
        ];
        let turned = split.turned();
        let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
        let areas = [0, 1, 2, 3].map(|left_out| {
            let [j, k, l] = faces[left_out];
            let (k, l) = if turned[left_out] { (l, k) } else { (k, l) };
            products(&edges(j, k), &edges(j, l))
        });
        let areas = [0, 1, 2].map(|axis| {
            areas.each_ref().map(|[start, middle, end]| {
                [&start[axis] + &start[axis], middle[axis].clone(), &end[axis] + &end[axis]]
            })
        });
        Self { volume, areas }
    }
}

/// Returns `to - from`.
fn difference<T>(to: &[T; 3], from: &[T; 3]) -> [T; 3]
where
    for<'x> &'x T: Sub<&'x T, Output = T>,
{
    [&to[0] - &from[0], &to[1] - &from[1], &to[2] - &from[2]]
}

/// Returns the cross product of two vectors that are linear in t, each given at both ends, as the
/// coefficients of (1-t)², (1-t)t and t².
fn products<T>([u0, u1]: &[[T; 3]; 2], [v0, v1]: &[[T; 3]; 2]) -> [[T; 3]; 3]
where
    for<'x> &'x T: Add<&'x T, Output = T> + Sub<&'x T, Output = T> + Mul<&'x T, Output = T>,
{
    let minor = |u: &[T; 3], v: &[T; 3], k: usize| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &(&u[i] * &v[j]) - &(&u[j] * &v[i])
    };
    let middle = |k: usize| &minor(u0, v1, k) + &minor(u1, v0, k);
    [[0, 1, 2].map(|k| minor(u0, v0, k)), [0, 1, 2].map(middle), [0, 1, 2].map(|k| minor(u1, v1, k))]
}

fn dot<T>(u: &[T; 3], v: &[T; 3]) -> T
where
    for<'x> &'x T: Add<&'x T, Output = T> + Mul<&'x T, Output = T>,
{
    &(&(&u[0] * &v[0]) + &(&u[1] * &v[1])) + &(&u[2] * &v[2])
}
