//! The nearest points of two segments.
//!
//! Source: Ericson, *Real-Time Collision Detection*, 5.1.9; ours departs as described in the head
//! of `primitive`. Let `u` and `v` be the segments, at an angle θ, `w` the vector from the start of
//! the first to that of the second, and `n = u × v`. The first parameter is `(w × v) · n / n²`. Its
//! rounding error is at most 8 units of 2^-53 of `|w| / (|u| sin θ)` and of itself. The second
//! parameter is that of the nearest point of the second line. So only the part of the first error
//! across `v` remains, which is `sin θ` of it: 8 units of `|w|` and `|u|`, whatever θ is.
//! If `sin θ` is below 2^-50, the normal is noise. The ends, which are always tried, are then
//! within `|u| sin θ` of the nearest points.

use super::closest::{ClosestPoints, Scaled};
use super::points::{along, point_segment};
use super::products::accurate_cross;
use crate::math::vec3::{Vector, cross, dot, sub};

/// Returns the nearest points of two segments. Either segment may have length zero.
///
/// # Accuracy
/// As for [`ClosestPoints`], also for parallel and nearly parallel segments.
///
/// ```
/// use impinge::primitive::closest_on_segments;
///
/// let nearest = closest_on_segments(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], &[[0.0, -1.0, 2.0], [0.0, 3.0, 2.0]]);
/// assert_eq!((nearest.point_a, nearest.point_b, nearest.distance), ([0.0; 3], [0.0, 0.0, 2.0], 2.0));
/// ```
#[must_use]
pub fn closest_on_segments(a: &[Vector; 2], b: &[Vector; 2]) -> ClosestPoints {
    let scaled = Scaled::new([a[0], a[1], b[0], b[1]]);
    let [p, q, r, s] = scaled.points;
    let (u, v) = (sub(&q, &p), sub(&s, &r));
    let (squared, t) = point_segment(&sub(&p, &r), &v);
    let mut nearest = (squared, p, along(&r, &v, t));
    let mut offer = |squared: f64, on_a: Vector, on_b: Vector| {
        if squared < nearest.0 {
            nearest = (squared, on_a, on_b);
        }
    };
    let (squared, t) = point_segment(&sub(&q, &r), &v);
    offer(squared, q, along(&r, &v, t));
    for end in [r, s] {
        let (squared, t) = point_segment(&sub(&end, &p), &u);
        offer(squared, along(&p, &u, t), end);
    }
    if let Some((squared, s, t)) = inner_points((&u, dot(&u, &u)), (&v, dot(&v, &v)), &sub(&r, &p)) {
        offer(squared, along(&p, &u, s), along(&r, &v, t));
    }
    let (squared, on_a, on_b) = nearest;
    scaled.back(squared, on_a, on_b)
}

/// Returns the nearest points of two lines as the squared distance and the two parameters, or
/// `None` unless both points are inside their segments. The segments are `u` and `v` with their
/// squared lengths; `w` points from the start of `u` to the start of `v`.
#[inline(always)]
pub(super) fn inner_points(
    (u, u_squared): (&Vector, f64),
    (v, v_squared): (&Vector, f64),
    w: &Vector,
) -> Option<(f64, f64, f64)> {
    if are_outside((u, u_squared), (v, v_squared), w) { None } else { accurate_inner_points(u, v, v_squared, w) }
}

/// Reports whether one of the nearest points of two lines is certainly outside its segment. It
/// decides without doubled digits, so it is faster than [`accurate_inner_points`], and may return
/// `false` for points outside.
///
/// # Accuracy
/// If the sine of the angle is above 2^-20, the plain normal has a relative error below 2^-30. So
/// the first parameter has an error below 2^-28 of `r = |w| |v| / |n|`, and the second twice that
/// times `|u| / |v|`. A parameter with an error bound `e` is outside if `(x - 1/2)² > (1/2 + e)²`,
/// and the right side is less than `1/4 + 2^-14 + 2^13 e²`.
#[inline(always)]
fn are_outside((u, u_squared): (&Vector, f64), (v, v_squared): (&Vector, f64), w: &Vector) -> bool {
    const MIN_SQUARED_SINE: f64 = 1.0 / (1_u64 << 40) as f64;
    const ERROR_FACTOR: f64 = 1.0 / (1_u64 << 40) as f64;
    let normal = cross(u, v);
    let squared = dot(&normal, &normal);
    let s = dot(&cross(w, v), &normal) / squared;
    let t = (s * dot(u, v) - dot(w, v)) / v_squared;
    let reach = dot(w, w) * v_squared / squared;
    let is_outside = |x: f64, reach: f64| (x - 0.5) * (x - 0.5) > 0.2501 + ERROR_FACTOR * reach;
    // Nothing is decided for parallel segments or segments without length.
    squared > MIN_SQUARED_SINE * (u_squared * v_squared)
        && (is_outside(s, reach) || is_outside(t, 4.0 * reach * (u_squared / v_squared)))
}

#[inline(always)]
/// Computes [`inner_points`] with the normal in twice the digits.
fn accurate_inner_points(u: &Vector, v: &Vector, v_squared: f64, w: &Vector) -> Option<(f64, f64, f64)> {
    let normal = accurate_cross(u, v);
    let s = dot(&cross(w, v), &normal) / dot(&normal, &normal);
    let t = (s * dot(u, v) - dot(w, v)) / v_squared;
    // Parallel segments give NaN, which is not inside.
    if !((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)) {
        return None;
    }
    let between: Vector = std::array::from_fn(|k| (w[k] - s * u[k]) + t * v[k]);
    Some((dot(&between, &between), s, t))
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;

    /// Returns segments on a grid and off it: some nearly parallel, some of zero length, of very
    /// different sizes.
    fn scene(rng: &mut Rng) -> (Vector, Vector, Vector) {
        let vector = |rng: &mut Rng| -> Vector {
            let size = 2.0_f64.powi(rng.integer(-30, 30) as i32);
            if rng.one_in(2) {
                [0; 3].map(|_| rng.integer(-3, 3) as f64)
            } else {
                [0; 3].map(|_| rng.uniform(-size, size))
            }
        };
        let (u, w) = (vector(rng), vector(rng));
        let v = if rng.one_in(3) {
            let tilt = 2.0_f64.powi(rng.integer(-52, -2) as i32);
            let factor = rng.integer(-2, 2) as f64;
            u.map(|x| factor * x + tilt * rng.uniform(-1.0, 1.0))
        } else {
            vector(rng)
        };
        (u, v, w)
    }

    #[test]
    fn rejected_segments_have_no_inner_nearest_points() {
        let mut rng = Rng::new(2026);
        let (mut left_out, mut inside, mut undecided) = (0, 0, 0);
        for _ in 0..200_000 {
            let (u, v, w) = scene(&mut rng);
            let (u_squared, v_squared) = (dot(&u, &u), dot(&v, &v));
            let accurate = accurate_inner_points(&u, &v, v_squared, &w);
            if are_outside((&u, u_squared), (&v, v_squared), &w) {
                assert_eq!(accurate, None, "{u:?} {v:?} {w:?}");
                left_out += 1;
            } else if accurate.is_some() {
                inside += 1;
            } else {
                undecided += 1;
            }
        }
        assert!(left_out > 50_000 && inside > 2_000 && undecided > 2_000, "{left_out} {inside} {undecided}");
    }
}
