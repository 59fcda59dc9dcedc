//! The exact intersection of a ray and a closed triangle.
//!
//! Source: the signs are those of Plücker coordinates, as in Woop, Benthin, Wald, *Watertight
//! Ray/Triangle Intersection*, JCGT 2(1), 2013. Ours departs in that they are the true signs: exact
//! arithmetic decides if doubles leave them undecided. So rays through edges and corners, edge-on
//! triangles and triangles without area are decided too.
//!
//! Let `s_ab = d · (a - o) × (b - o)` for the edge from `a` to `b`: it says on which side of the
//! edge the ray's line passes. Both faces of an edge see the same number, up to its sign, so no
//! line passes between them. The line intersects the triangle if the three signs do not contradict
//! each other. The ray does if also `t = N / D` is not negative, with `D` the sum of the three and
//! `N = (b - a) × (c - a) · (a - o)`. If all three are zero, the line and the triangle are in one
//! plane, or the triangle has no area. Their intersection is then spanned by the intersections of
//! the line with the edges.
//!
//! Tests: `tests/it/distance/rays.rs`. Benchmark: `rays`.

use crate::math::Sign::{self, Negative, Positive, Zero};
use crate::math::dyadic::{self, Dyadic};
use crate::math::vec3::{Vector, cross, dot, sub};

/// The first point that a ray and a triangle have in common: `origin + t direction`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCrossing {
    /// Ray parameter, zero or positive, in units of the direction's length. Its relative error is
    /// at most 2^-40. It is zero if the true parameter is zero, and the largest float if that is
    /// beyond 2^1022.
    pub t: f64,
    /// Bound on the absolute error of `t`.
    pub error: f64,
}

/// Returns the first point that the ray from `origin` in `direction` has in common with the closed
/// triangle. Returns `None` if there is none. The direction must not be zero, but may have any
/// other length. Ray and triangle are given in one frame.
///
/// The decision is exact for the real ray and the real triangle. All numbers must be finite and at
/// most 2^300 in magnitude. The triangle may degenerate to a segment or a point. If the ray lies in
/// its plane, the result is the first common point.
///
/// ```
/// use impinge::primitive::ray_triangle;
///
/// let triangle = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let down = [0.0, 0.0, -2.0];
/// assert_eq!(ray_triangle(&[2.0, 2.0, 3.0], &down, &triangle).map(|hit| hit.t), Some(1.5));
/// assert_eq!(ray_triangle(&[2.0, 2.1, 3.0], &down, &triangle), None);
/// ```
#[must_use]
pub fn ray_triangle(origin: &Vector, direction: &Vector, triangle: &[Vector; 3]) -> Option<RayCrossing> {
    let corners = triangle.each_ref().map(|corner| sub(corner, origin));
    let normals = [0, 1, 2].map(|i| cross(&corners[i], &corners[(i + 1) % 3]));
    let mut sides = [Zero; 3];
    let mut exact = None;
    for i in 0..3 {
        let value = dot(direction, &normals[i]);
        let size = permanent(&corners[i], &corners[(i + 1) % 3], direction);
        sides[i] = certain_sign(value, size)
            .unwrap_or_else(|| exact.get_or_insert_with(|| ExactRay::new(origin, direction, triangle)).side(i));
        if i > 0 && contradict(sides[0], sides[i]) {
            return None;
        }
    }
    if contradict(sides[1], sides[2]) {
        return None;
    }
    if sides == [Zero; 3] {
        let exact = exact.unwrap_or_else(|| ExactRay::new(origin, direction, triangle));
        return exact.first_in_plane().map(RayCrossing::nearest);
    }
    let normal = cross(&sub(&triangle[1], &triangle[0]), &sub(&triangle[2], &triangle[0]));
    let (over, under) = (dot(&normal, &corners[0]), dot(&normal, direction));
    let edges = [sub(&triangle[1], &triangle[0]), sub(&triangle[2], &triangle[0])];
    let over_error = ROUNDING * permanent(&edges[0], &edges[1], &corners[0]) + UNDERFLOW;
    let under_error = ROUNDING * permanent(&edges[0], &edges[1], direction) + UNDERFLOW;
    let relative = over_error / over.abs() + under_error / under.abs();
    // If a part is zero, the error is NaN or infinite and fails the comparison.
    let t = over / under;
    if relative < LARGEST_T_ERROR && t.is_finite() {
        return (t > 0.0).then_some(RayCrossing { t, error: t * 2.0 * relative });
    }
    exact.unwrap_or_else(|| ExactRay::new(origin, direction, triangle)).crossing().map(RayCrossing::nearest)
}

impl RayCrossing {
    /// Wraps a parameter that was rounded to the nearest float.
    fn nearest(t: f64) -> Self {
        Self { t: t.min(f64::MAX), error: t * f64::EPSILON + f64::from_bits(1) }
    }

    /// Compares two crossings of one ray by their true parameters.
    pub(crate) fn compare(
        &self,
        other: &Self,
        ray: (&Vector, &Vector),
        triangles: [&[Vector; 3]; 2],
    ) -> std::cmp::Ordering {
        if self.t + self.error < other.t - other.error {
            return std::cmp::Ordering::Less;
        }
        if other.t + other.error < self.t - self.error {
            return std::cmp::Ordering::Greater;
        }
        let [first, second] = triangles.map(|triangle| ExactRay::new(ray.0, ray.1, triangle).quotient());
        match (first, second) {
            (Some((n, d)), Some((m, e))) => (&(&n * &e) - &(&m * &d)).sign().cmp(&Zero),
            _ => std::cmp::Ordering::Equal,
        }
    }
}

/// Relative error bound of a determinant of three differences. The differences contribute three
/// roundings, a product two, a minor one, one more product one, and two sums two: 9 units of 2^-53.
/// The rest covers the rounding of the bound itself.
pub(super) const ROUNDING: f64 = 12.0 * (f64::EPSILON / 2.0);

/// More than products lose to underflow if all numbers are at most 2^300: 2^-1074 · 12 · 2^302.
pub(super) const UNDERFLOW: f64 = f64::from_bits((1023 - 760) << 52);

/// Maximum relative error of a parameter computed in floats. Parameters with a larger error are
/// computed exactly and rounded: 2^-40. Twice the sum of the relative errors of numerator and
/// denominator covers their product and three roundings.
const LARGEST_T_ERROR: f64 = 0.5 / (1_u64 << 40) as f64;

/// Returns the sum of the magnitudes of the six products of a determinant.
#[inline(always)]
pub(super) fn permanent(u: &Vector, v: &Vector, w: &Vector) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        ((u[i] * v[j]).abs() + (u[j] * v[i]).abs()) * w[k].abs()
    });
    a + b + c
}

/// Returns the sign of a determinant from its rounded value and its [`permanent`], or `None` if
/// rounding leaves it undecided.
#[inline(always)]
pub(super) fn certain_sign(value: f64, size: f64) -> Option<Sign> {
    let error = ROUNDING * size + UNDERFLOW;
    if value > error {
        Some(Positive)
    } else if value < -error {
        Some(Negative)
    } else {
        None
    }
}

/// Reports whether one sign is negative and the other positive.
fn contradict(one: Sign, other: Sign) -> bool {
    one != Zero && one == -other
}

/// A ray and a triangle in exact numbers, relative to the ray's origin.
struct ExactRay {
    direction: [Dyadic; 3],
    corners: [[Dyadic; 3]; 3],
}

impl ExactRay {
    fn new(origin: &Vector, direction: &Vector, triangle: &[Vector; 3]) -> Self {
        let origin = origin.map(Dyadic::from_f64);
        Self {
            direction: direction.map(Dyadic::from_f64),
            corners: triangle.map(|corner| std::array::from_fn(|k| &Dyadic::from_f64(corner[k]) - &origin[k])),
        }
    }

    /// Returns the side of edge `i` on which the line passes.
    fn side(&self, i: usize) -> Sign {
        dyadic::dot(&self.direction, &dyadic::cross(&self.corners[i], &self.corners[(i + 1) % 3])).sign()
    }

    /// Returns the parameter at which the line intersects the triangle, as numerator and positive
    /// denominator.
    fn quotient(&self) -> Option<(Dyadic, Dyadic)> {
        let [a, b, c] = &self.corners;
        let edge = |to: &[Dyadic; 3]| [0, 1, 2].map(|k| &to[k] - &a[k]);
        let normal = dyadic::cross(&edge(b), &edge(c));
        let (over, under) = (dyadic::dot(&normal, a), dyadic::dot(&normal, &self.direction));
        match under.sign() {
            Positive => Some((over, under)),
            Negative => Some((&Dyadic::ZERO - &over, &Dyadic::ZERO - &under)),
            Zero => self.first_quotient_in_plane(),
        }
    }

    /// Returns the parameter at which the line intersects the triangle, rounded to nearest, or
    /// `None` if it is negative.
    fn crossing(&self) -> Option<f64> {
        let (over, under) = self.quotient()?;
        (over.sign() != Negative).then(|| Dyadic::nearest_quotient(&over, &under))
    }

    /// Returns the first parameter of a ray that lies in one plane with the triangle, rounded to
    /// nearest.
    fn first_in_plane(&self) -> Option<f64> {
        let (over, under) = self.first_quotient_in_plane()?;
        Some(Dyadic::nearest_quotient(&over, &under))
    }

    /// Returns the smallest parameter, zero or more, of points that the ray and the triangle have
    /// in common. All edges must be in one plane with the line. The line's intersections with the
    /// edges span its intersection with the triangle.
    fn first_quotient_in_plane(&self) -> Option<(Dyadic, Dyadic)> {
        let squared = dyadic::dot(&self.direction, &self.direction);
        // Positions along the line, times `squared`, and offsets to its side.
        let places = self.corners.each_ref().map(|corner| dyadic::dot(corner, &self.direction));
        let offsets = self.corners.each_ref().map(|corner| dyadic::cross(&self.direction, corner));
        let is_on = offsets.each_ref().map(|offset| offset.iter().all(|x| x.sign() == Zero));
        let mut crossings: Vec<(Dyadic, Dyadic)> = Vec::new();
        for i in 0..3 {
            let j = (i + 1) % 3;
            if is_on[i] {
                crossings.push((places[i].clone(), squared.clone()));
            }
            // Offsets in one plane are parallel, so the ends are on both sides of the line if their
            // product is negative.
            let product = dyadic::dot(&offsets[i], &offsets[j]);
            if product.sign() == Negative {
                // The edge from i crosses at λ = |offset_i| / (|offset_i| + |offset_j|), expressed
                // in their squares and product.
                let weight = dyadic::dot(&offsets[i], &offsets[i]);
                let sum = &weight - &product;
                let place = &(&places[i] * &sum) + &(&weight * &(&places[j] - &places[i]));
                crossings.push((place, &sum * &squared));
            }
        }
        let ahead = |(over, _): &&(Dyadic, Dyadic)| over.sign() != Negative;
        let nearest = |mut best: (Dyadic, Dyadic), next: &(Dyadic, Dyadic)| {
            if (&(&next.0 * &best.1) - &(&best.0 * &next.1)).sign() == Negative {
                best = next.clone();
            }
            best
        };
        let first = crossings.iter().find(ahead)?.clone();
        if crossings.iter().any(|(over, _)| over.sign() == Negative) {
            // The triangle reaches from behind the origin to before it, so it contains the origin.
            return Some((Dyadic::ZERO, squared));
        }
        Some(crossings.iter().filter(ahead).fold(first, nearest))
    }
}
