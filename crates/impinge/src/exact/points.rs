//! Exact decisions about stored points in one frame: orientations, comparisons along a direction,
//! and image coordinates rounded in a stated direction. Hulls and realigned boxes are built on
//! them.
//!
//! Each decision starts with a filter in doubles. If the filter is undecided, the integers of the
//! triangle decisions take over. The proof is docs/notes/proof.md, L10, and the tests are below.

use super::corners::PairCorners;
use super::double_double::{self, DoubleDouble, MIN_SPLIT_PRODUCT, product_error, two_sum};
use super::filter::{ROUNDING, sign2d};
use super::placement::{Placement, world_coordinate};
use crate::math::Pose;
use crate::math::Sign::{self, Negative, Positive, Zero};
use crate::math::dyadic::{self, Dyadic};
use crate::math::relative::{UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::{dot, sub};

/// The plane of three points, with one bound on the filter's error for all points within a given
/// extent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    origin: [f64; 3],
    normal: [f64; 3],
    error: f64,
}

impl Plane {
    /// Builds the plane through `p`, `q` and `r`, for points whose coordinates differ from those of
    /// `p` by at most `extent`.
    ///
    /// # Accuracy
    /// The bound is the one of [`signs`](super::filter::signs) for exact points, with `extent` in
    /// place of the differences to `p`.
    #[inline]
    pub(crate) fn new(p: &[f64; 3], q: &[f64; 3], r: &[f64; 3], extent: &[f64; 3]) -> Self {
        let (u, v) = (sub(q, p), sub(r, p));
        let mut normal = [0.0; 3];
        let mut rounding = 0.0;
        let mut extent_sum = 1.0;
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (forward, backward) = (u[i] * v[j], u[j] * v[i]);
            normal[k] = forward - backward;
            rounding += (forward.abs() + backward.abs()) * extent[k];
            extent_sum += extent[k];
        }
        Self { origin: *p, normal, error: rounding * ROUNDING + extent_sum * UNDERFLOW }
    }

    /// Returns the signed distance of `s` from the plane, times twice the area of the three points.
    /// The result is rounded, without a bound.
    pub(crate) fn height(&self, s: &[f64; 3]) -> f64 {
        let w = sub(s, &self.origin);
        dot(&self.normal, &w)
    }

    /// Returns the side of the plane on which `s` is, or `None` if the filter is not certain.
    /// Positive is the side from which the three points turn left.
    #[inline(always)]
    pub(crate) fn side(&self, s: &[f64; 3]) -> Option<Sign> {
        let w = sub(s, &self.origin);
        let determinant = dot(&self.normal, &w);
        if determinant > self.error {
            Some(Positive)
        } else if determinant < -self.error {
            Some(Negative)
        } else {
            None
        }
    }
}

/// The plane of three points, with an error bound for points at any distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WidePlane {
    origin: [f64; 3],
    normal: [f64; 3],
    /// Error of a determinant per unit of the difference along each axis.
    rounding: [f64; 3],
}

impl WidePlane {
    pub(crate) fn new([p, q, r]: &[[f64; 3]; 3]) -> Self {
        let (u, v) = (sub(q, p), sub(r, p));
        let (mut normal, mut rounding) = ([0.0; 3], [0.0; 3]);
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (forward, backward) = (u[i] * v[j], u[j] * v[i]);
            normal[k] = forward - backward;
            rounding[k] = (forward.abs() + backward.abs()) * ROUNDING;
        }
        Self { origin: *p, normal, rounding }
    }

    /// Returns the side of the plane on which `s` is, or `None` if the filter is not certain.
    /// Positive is the side from which the three points turn left.
    ///
    /// # Accuracy
    /// The bound is the one of [`signs`](super::filter::signs) for exact points.
    #[inline]
    pub(crate) fn side(&self, s: &[f64; 3]) -> Option<Sign> {
        let w = sub(s, &self.origin);
        let determinant = dot(&self.normal, &w);
        let size = w.map(f64::abs);
        let rounding = dot(&self.rounding, &size);
        let error = rounding + (1.0 + size[0] + size[1] + size[2]) * UNDERFLOW;
        if determinant > error {
            Some(Positive)
        } else if determinant < -error {
            Some(Negative)
        } else {
            None
        }
    }
}

/// Returns the sign of `det(q - p, r - p, s - p)`. Points that share a coordinate, as those in one
/// row of a grid, take no arithmetic.
pub(crate) fn orient3d(p: &[f64; 3], q: &[f64; 3], r: &[f64; 3], s: &[f64; 3]) -> Sign {
    let share_coordinate = (0..3).any(|k| p[k] == q[k] && p[k] == r[k] && p[k] == s[k]);
    if share_coordinate || [p, q, r].contains(&s) {
        return Zero;
    }
    PairCorners::new(&Placement::new(&Pose::IDENTITY, &Pose::IDENTITY), &[*p, *q, *r], &[*s; 3]).sides_of_a()[0]
}

/// Returns the sign of `det(q - p, r - p)` in the projection along an axis. The other two axes
/// follow it in cyclic order.
pub(crate) fn orient2d(axis: usize, p: &[f64; 3], q: &[f64; 3], r: &[f64; 3]) -> Sign {
    sign2d(axis, p, q, r).unwrap_or_else(|| {
        let placement = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        PairCorners::new(&placement, &[*p, *q, *r], &[*p, *q, *r]).exact_orient2d(axis, 0, 1, 2)
    })
}

/// Reports whether three points lie on one line. Equal points count as lying on one line with any
/// third.
pub(crate) fn collinear(p: &[f64; 3], q: &[f64; 3], r: &[f64; 3]) -> bool {
    (0..3).all(|axis| orient2d(axis, p, q, r) == Zero)
}

/// Compares `p` with `q` along a direction: returns the sign of `direction · (p - q)`.
#[inline]
pub(crate) fn compare_along(direction: &[f64; 3], p: &[f64; 3], q: &[f64; 3]) -> Sign {
    let difference = sub(p, q);
    let terms: [f64; 3] = std::array::from_fn(|k| direction[k] * difference[k]);
    let value = terms[0] + terms[1] + terms[2];
    // The difference, the product and two sums are rounded: slightly more than 4 units in all.
    let error = 5.0 * UNIT_ROUNDOFF * (terms[0].abs() + terms[1].abs() + terms[2].abs()) + UNDERFLOW;
    if value > error {
        Positive
    } else if value < -error {
        Negative
    } else if (0..3).all(|k| direction[k] == 0.0 || difference[k] == 0.0) {
        Zero
    } else {
        compare_along_closely(direction, p, q).unwrap_or_else(|| compare_along_exactly(direction, p, q))
    }
}

/// Compares two points along a direction with twice the digits of a float, or returns `None` if
/// they do not decide. The corners of a facet along its rounded normal differ by that little.
#[cold]
fn compare_along_closely(direction: &[f64; 3], p: &[f64; 3], q: &[f64; 3]) -> Option<Sign> {
    let [direction, p, q] = [direction, p, q].map(|vector| vector.map(DoubleDouble::of));
    let value = double_double::dot(&direction, &double_double::difference(&p, &q));
    let is_negative = || value.negated().is_positive().then_some(Negative);
    value.is_positive().then_some(Positive).or_else(is_negative)
}

#[cold]
fn compare_along_exactly(direction: &[f64; 3], p: &[f64; 3], q: &[f64; 3]) -> Sign {
    let direction = direction.map(Dyadic::from_f64);
    let difference = [0, 1, 2].map(|k| &Dyadic::from_f64(p[k]) - &Dyadic::from_f64(q[k]));
    dyadic::dot(&direction, &difference).sign()
}

/// Returns the greatest float that does not exceed coordinate `axis` of the image of a point, in
/// the world frame.
///
/// # Accuracy
/// Exact: `row · point + translation` over the reals, rounded towards minus infinity. Error-free
/// transforms (Dekker 1971; Knuth, volume 2, 4.2.2) give it as an unevaluated sum. If that sum does
/// not determine the rounding, integers decide.
#[inline]
pub(crate) fn image_down(world_from_local: &Pose, axis: usize, point: &[f64; 3]) -> f64 {
    let row = world_from_local.linear()[axis];
    let translation = world_from_local.translation()[axis];
    rounded_down(&row, translation, point).unwrap_or_else(|| {
        let exact = world_coordinate(world_from_local, axis, point);
        let nearest = Dyadic::nearest_quotient(&exact, &Dyadic::from_f64(1.0));
        let is_above = (&Dyadic::from_f64(nearest) - &exact).sign() == Positive;
        if is_above { nearest.next_down() } else { nearest }
    })
}

/// Returns the least float that is not below coordinate `axis` of the image of a point, in the
/// world frame. It is exact, as [`image_down`] is.
#[inline]
pub(crate) fn image_up(world_from_local: &Pose, axis: usize, point: &[f64; 3]) -> f64 {
    let row = world_from_local.linear()[axis].map(|entry| -entry);
    let translation = -world_from_local.translation()[axis];
    match rounded_down(&row, translation, point) {
        Some(negated) => -negated,
        None => {
            let exact = world_coordinate(world_from_local, axis, point);
            let nearest = Dyadic::nearest_quotient(&exact, &Dyadic::from_f64(1.0));
            let is_below = (&Dyadic::from_f64(nearest) - &exact).sign() == Negative;
            if is_below { nearest.next_up() } else { nearest }
        }
    }
}

/// Returns `row · point + translation`, rounded down, or `None` if floats do not determine it.
#[inline]
fn rounded_down(row: &[f64; 3], translation: f64, point: &[f64; 3]) -> Option<f64> {
    let mut sum = translation;
    let mut small = [0.0; 6];
    for k in 0..3 {
        let product = row[k] * point[k];
        let is_zero = row[k] == 0.0 || point[k] == 0.0;
        if !is_zero && product.abs() < MIN_SPLIT_PRODUCT {
            return None;
        }
        small[k] = product_error(row[k], point[k], product);
        (sum, small[3 + k]) = two_sum(sum, product);
    }
    let rest: f64 = small.iter().sum();
    let magnitude: f64 = small.iter().map(|x| x.abs()).sum();
    // Five sums are rounded. Their error is relative, as sums do not underflow; the product may.
    let error = if magnitude == 0.0 { 0.0 } else { 6.0 * UNIT_ROUNDOFF * magnitude + UNDERFLOW };
    // The exact value is high + low, up to the error. High is the float nearest to high + low. So
    // an error far below high's last unit leaves the value between high and its neighbor on the
    // side of low's sign.
    let (high, low) = two_sum(sum, rest);
    if error == 0.0 || (low.abs() > error && error < high.abs() * (f64::EPSILON / 256.0)) {
        Some(if low < 0.0 { high.next_down() } else { high })
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;

    use super::*;

    struct Random(u64);

    impl Random {
        fn next(&mut self) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            self.0 >> 24
        }

        /// Returns a small integer, a float of moderate size, or a tiny one, so that sums tie,
        /// cancel and underflow.
        fn number(&mut self, kind: u64) -> f64 {
            let sign = if self.next().is_multiple_of(2) { 1.0 } else { -1.0 };
            let fraction = f64::from_bits(1023 << 52 | (self.next() << 12 & ((1 << 52) - 1)));
            let power = |exponent: i64| f64::from_bits(((1023 + exponent) as u64) << 52);
            sign * match kind % 4 {
                0 => (self.next() % 4) as f64,
                1 => fraction * power((self.next() % 8) as i64 - 4),
                2 => fraction * power((self.next() % 120) as i64 - 60),
                _ => fraction * power(-((self.next() % 1000) as i64)),
            }
        }

        fn point(&mut self, kind: u64) -> [f64; 3] {
            std::array::from_fn(|_| self.number(kind))
        }
    }

    fn exact(x: f64) -> RBig {
        RBig::try_from(x).expect("finite")
    }

    fn along(direction: &[f64; 3], p: &[f64; 3]) -> RBig {
        (0..3).fold(RBig::ZERO, |sum, k| sum + exact(direction[k]) * exact(p[k]))
    }

    #[test]
    fn images_are_rounded_to_the_next_float() {
        let mut random = Random(1);
        let (mut inexact, mut exactly) = (0, 0);
        for case in 0..20_000 {
            let kind = case / 3;
            let linear = std::array::from_fn(|_| random.point(kind));
            let (point, mut translation) = (random.point(kind / 4), random.point(kind));
            if case % 5 == 0 {
                // Cancels everything except the last bits.
                let row: &[f64; 3] = &linear[0];
                translation[0] = -(row[0] * point[0] + row[1] * point[1] + row[2] * point[2]);
            }
            let Ok(pose) = Pose::new(linear, translation) else { continue };
            for axis in 0..3 {
                let truth = along(&linear[axis], &point) + exact(translation[axis]);
                let (down, up) = (image_down(&pose, axis, &point), image_up(&pose, axis, &point));
                assert!(exact(down) <= truth && truth <= exact(up), "{pose:?} {point:?}");
                if exact(down) == truth {
                    assert_eq!(down, up);
                    exactly += 1;
                } else {
                    assert_eq!(down.next_up(), up, "{pose:?} {point:?}");
                    inexact += 1;
                }
            }
        }
        assert!(inexact > 10_000 && exactly > 1000, "{inexact} {exactly}");
    }

    /// Values that differ by one unit, and ties of different points.
    #[test]
    fn comparisons_along_a_direction_are_exact() {
        let mut random = Random(2);
        let (mut signs, mut close) = ([0; 3], 0);
        for case in 0..30_000 {
            let (direction, p) = (random.point(case / 7), random.point(case));
            let mut q = if case % 3 == 0 { random.point(case) } else { p };
            if case % 2 == 0 {
                // Moves across the direction in floats, and slightly along it.
                let [i, j] = [case as usize % 3, (case as usize + 1) % 3];
                q[i] += direction[j];
                q[j] -= direction[i];
                let k = random.next() as usize % 3;
                q[k] = [q[k].next_down(), q[k], q[k].next_up()][random.next() as usize % 3];
            }
            let truth = along(&direction, &p).cmp(&along(&direction, &q));
            assert_eq!(compare_along(&direction, &p, &q), truth.into(), "{direction:?} {p:?} {q:?}");
            if let Some(sign) = compare_along_closely(&direction, &p, &q) {
                assert_eq!(sign, truth.into(), "{direction:?} {p:?} {q:?}");
                close += 1;
            }
            signs[(truth as i8 + 1) as usize] += 1;
        }
        assert!(signs.iter().all(|&count| count > 3000) && close > 10_000, "{signs:?} {close}");
        assert_eq!(compare_along(&[1e308, 1e-310, 0.0], &[1e30, 1.0, 0.0], &[1e30, 2.0, 0.0]), Negative);
    }

    #[test]
    fn orientations_are_exact() {
        let mut random = Random(3);
        let mut zeros = [0; 2];
        for case in 0..20_000 {
            let [p, q, r] = std::array::from_fn(|_| random.point(case));
            let weights: [f64; 2] = std::array::from_fn(|_| random.number(0) * 0.25);
            let near = |v: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] + weights[0] * (v[k] - p[k])) };
            let on_line = near(&q);
            let on_plane: [f64; 3] = std::array::from_fn(|k| on_line[k] + weights[1] * (r[k] - p[k]));
            let from_p = |x: &[f64; 3]| [0, 1, 2].map(|k| exact(x[k]) - exact(p[k]));
            let minor = |u: &[RBig; 3], v: &[RBig; 3], i: usize, j: usize| &u[i] * &v[j] - &u[j] * &v[i];
            let (u, v, w) = (from_p(&q), from_p(&r), from_p(&on_plane));
            let volume = minor(&u, &v, 1, 2) * &w[0] + minor(&u, &v, 2, 0) * &w[1] + minor(&u, &v, 0, 1) * &w[2];
            let truth: Sign = volume.cmp(&RBig::ZERO).into();
            assert_eq!(orient3d(&p, &q, &r, &on_plane), truth);
            let extent = std::array::from_fn(|k| (on_plane[k] - p[k]).abs());
            let side = Plane::new(&p, &q, &r, &extent).side(&on_plane);
            assert!(side.is_none_or(|side| side == truth));
            zeros[0] += usize::from(truth == Zero);
            let w = from_p(&on_line);
            let mut is_collinear = true;
            for axis in 0..3 {
                let area: Sign = minor(&u, &w, (axis + 1) % 3, (axis + 2) % 3).cmp(&RBig::ZERO).into();
                assert_eq!(orient2d(axis, &p, &q, &on_line), area);
                is_collinear &= area == Zero;
            }
            assert_eq!(collinear(&p, &q, &on_line), is_collinear);
            zeros[1] += usize::from(is_collinear);
        }
        assert!(zeros.iter().all(|&count| (4000..16_000).contains(&count)), "{zeros:?}");
    }
}
