//! The minimal sphere in exact arithmetic: spheres through at most four points, and the points that
//! lie outside.
//!
//! With edges u, v, w from one of the points, the offset of the center from that point is a
//! quotient of polynomials. Its numerator and its (positive) denominator are kept as exact numbers.
//! A point is classified in doubles, then in pairs of doubles (Dekker 1971), then exactly. Points
//! that were rounded onto a sphere are one unit in the last place from it, which pairs can resolve.
//! Only points on the sphere, or extremely close to it, need exact arithmetic.
//!
//! Tests: those of this file, and `tests/it/volumes/minimal.rs`.

use super::super::super::rounding::{two_product, two_sum};
use super::super::enclosing::{SQUARE_ERROR, scaled_offset, squared};
use super::frame::Frame;
use crate::math::Sign;
use crate::math::dyadic::{Dyadic, cross, dot};

/// The smallest sphere through one to four points that are affinely independent.
#[derive(Clone, Debug)]
pub(super) struct ExactSphere {
    support: Vec<[f64; 3]>,
    origin: [Dyadic; 3],
    /// Offset from the local origin to the center, times the denominator.
    offset: [Dyadic; 3],
    /// Denominator of `offset`. Positive.
    denominator: Dyadic,
    /// Whether the center is in the convex hull of the support.
    centerd: bool,
    rounded: Rounded,
}

/// The sphere in doubles and pairs of doubles. Lengths are in the scale of the frame unless stated
/// otherwise.
#[derive(Clone, Debug)]
struct Rounded {
    scale: f64,
    /// Center, rounded to nearest, in the unit of the points.
    center: [f64; 3],
    /// Rounding error of the center, in the unit of the points.
    center_rest: [f64; 3],
    squared_radius: [f64; 2],
    /// Lower bound of the radius, in the unit of the points.
    radius_down: f64,
    /// Error bounds of the classification in doubles and in pairs of doubles.
    error: [f64; 2],
}

/// Returns the minimal sphere of the points. `guess` is a likely support.
pub(super) fn minimal(points: &[[f64; 3]], guess: &[[f64; 3]], frame: Frame) -> ExactSphere {
    /// Maximum number of exact steps. Each step enlarges the sphere, so the steps end, usually
    /// within ten. Beyond the maximum, [`of_all`] takes over, whose expected work is bounded.
    const MAX_STEPS: usize = 64;
    let mut sphere = of_few(guess, frame);
    for _ in 0..MAX_STEPS {
        let Some(current) = &sphere else { break };
        let Some(outside) = current.furthest_outside(points) else { break };
        let mut next = current.support.clone();
        next.push(outside);
        sphere = of_few(&next, frame);
    }
    match sphere {
        Some(sphere) if sphere.furthest_outside(points).is_none() => sphere,
        _ => of_all(points, frame),
    }
}

/// Returns the minimal sphere of up to five points: the sphere through a subset that encloses the
/// others and has its center in the hull of the subset. There is always one. Large subsets are
/// tried first, because they are more likely.
fn of_few(points: &[[f64; 3]], frame: Frame) -> Option<ExactSphere> {
    let mut subsets: Vec<u32> = (1..1 << points.len()).filter(|subset: &u32| subset.count_ones() <= 4).collect();
    subsets.sort_by_key(|subset| std::cmp::Reverse(subset.count_ones()));
    subsets.into_iter().find_map(|subset| {
        let chosen: Vec<[f64; 3]> = (0..points.len()).filter(|i| subset >> i & 1 == 1).map(|i| points[i]).collect();
        let sphere = ExactSphere::through(&chosen, frame)?;
        let holds = |point: &[f64; 3]| sphere.excess(*point) != Sign::Positive;
        (sphere.centerd && points.iter().all(holds)).then_some(sphere)
    })
}

/// Runs Welzl's algorithm in a fixed random order and in exact arithmetic. Degenerate sets then
/// need no special care: a point outside the sphere through other points is affinely independent of
/// them.
///
/// # Complexity
/// Linear, as an expected value over the orders, for any points.
fn of_all(points: &[[f64; 3]], frame: Frame) -> ExactSphere {
    let mut order = points.to_vec();
    // The shuffle of Fisher and Yates with Knuth's linear congruential generator (MMIX). Its high
    // bits are random enough, unless an input is built to defeat it.
    let mut state = 1_u64;
    for i in (1..order.len()).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        order.swap(i, ((u128::from(state) * (i as u128 + 1)) >> 64) as usize);
    }
    with_on_it(&order, &[], frame).unwrap_or_else(|| ExactSphere::at(points[0], frame))
}

/// Returns the smallest sphere that encloses the points and passes through the points of `on_it`.
fn with_on_it(points: &[[f64; 3]], on_it: &[[f64; 3]], frame: Frame) -> Option<ExactSphere> {
    let mut sphere = ExactSphere::through(on_it, frame);
    if on_it.len() == 4 {
        return sphere;
    }
    for (i, &point) in points.iter().enumerate() {
        if sphere.as_ref().is_none_or(|sphere| sphere.excess(point) == Sign::Positive) {
            let mut more = on_it.to_vec();
            more.push(point);
            sphere = with_on_it(&points[..i], &more, frame).or(sphere);
        }
    }
    sphere
}

impl ExactSphere {
    /// Builds the sphere of radius zero at a point.
    fn at(point: [f64; 3], frame: Frame) -> Self {
        let zero = [Dyadic::ZERO, Dyadic::ZERO, Dyadic::ZERO];
        Self::new(&[point], point.map(Dyadic::from_f64), zero, Dyadic::from_f64(1.0), true, frame)
    }

    /// Returns the smallest sphere through the points. Returns `None` if there are no points or
    /// they are affinely dependent.
    fn through(points: &[[f64; 3]], frame: Frame) -> Option<Self> {
        let (&first, others) = points.split_first()?;
        let origin = first.map(Dyadic::from_f64);
        let edges: Vec<[Dyadic; 3]> =
            others.iter().map(|&point| subtract(&point.map(Dyadic::from_f64), &origin)).collect();
        let (offset, denominator, weights) = match &edges[..] {
            [] => return Some(Self::at(first, frame)),
            // Halfway.
            [u] => (u.clone(), Dyadic::from_f64(2.0), (vec![], Dyadic::ZERO)),
            [u, v] => {
                let normal = cross(u, v);
                let square = dot(&normal, &normal);
                let offset = cross(&subtract(&scale(v, &dot(u, u)), &scale(u, &dot(v, v))), &normal);
                let weights = vec![dot(&cross(&offset, v), &normal), dot(&cross(u, &offset), &normal)];
                let denominator = &square + &square;
                let whole = &denominator * &square;
                (offset, denominator, (weights, whole))
            }
            [u, v, w] => {
                let (vw, wu, uv) = (cross(v, w), cross(w, u), cross(u, v));
                let volume = dot(u, &vw);
                let offset = add(&add(&scale(&vw, &dot(u, u)), &scale(&wu, &dot(v, v))), &scale(&uv, &dot(w, w)));
                let weights = [&vw, &wu, &uv].map(|normal| dot(&offset, normal)).to_vec();
                let denominator = &volume + &volume;
                let whole = &denominator * &volume;
                (offset, denominator, (weights, whole))
            }
            _ => return None,
        };
        // These are the barycentric coordinates of the center times a positive number. The local
        // origin has the rest.
        let (weights, whole) = weights;
        let rest = weights.iter().fold(whole, |rest, weight| &rest - weight);
        let centerd = weights.iter().chain([&rest]).all(|weight| weight.sign() != Sign::Negative);
        match denominator.sign() {
            Sign::Zero => None,
            Sign::Positive => Some(Self::new(points, origin, offset, denominator, centerd, frame)),
            Sign::Negative => {
                let negate = |x: &Dyadic| &Dyadic::ZERO - x;
                let offset = [0, 1, 2].map(|axis| negate(&offset[axis]));
                Some(Self::new(points, origin, offset, negate(&denominator), centerd, frame))
            }
        }
    }

    fn new(
        support: &[[f64; 3]],
        origin: [Dyadic; 3],
        offset: [Dyadic; 3],
        denominator: Dyadic,
        centerd: bool,
        frame: Frame,
    ) -> Self {
        let mut rounded = Rounded::new(&origin, &offset, &denominator, frame);
        if centerd {
            rounded.round_radius(&dot(&offset, &offset), &(&denominator * &denominator));
        }
        Self { support: support.to_vec(), origin, offset, denominator, centerd, rounded }
    }

    /// Returns the center, each coordinate rounded to nearest.
    pub(super) fn center(&self) -> [f64; 3] {
        self.rounded.center
    }

    /// Returns a bound on the rounding error of the center, in the scale of the frame.
    pub(super) fn center_error(&self) -> f64 {
        2.0 * self.rounded.center_rest.iter().fold(0.0_f64, |sum, x| sum + x.abs()) * self.rounded.scale
    }

    /// Returns a double not above the radius.
    pub(super) fn radius_down(&self) -> f64 {
        self.rounded.radius_down
    }

    /// Returns the point that lies farthest outside, up to rounding. Returns `None` if no point
    /// lies outside, which is exact.
    fn furthest_outside(&self, points: &[[f64; 3]]) -> Option<[f64; 3]> {
        let mut furthest: Option<(f64, [f64; 3])> = None;
        for &point in points {
            let coarse = self.rounded.coarse_excess(point);
            // NaN, after an overflow, fails this comparison and counts as near the sphere.
            if coarse < -self.rounded.error[0] {
                continue;
            }
            let excess = self.rounded.fine_excess(point);
            if furthest.as_ref().is_some_and(|&(worst, _)| excess <= worst) {
                continue;
            }
            // This repeats [`excess`](Self::excess) with the value computed above.
            let error = self.rounded.error[1];
            let certain = excess > error || excess < -error;
            let outside = if certain { excess > error } else { self.exact_excess(point) == Sign::Positive };
            if outside {
                furthest = Some((excess, point));
            }
        }
        furthest.map(|(_, point)| point)
    }

    /// Returns the position of a point: outside (positive), on the sphere (zero) or inside
    /// (negative).
    fn excess(&self, point: [f64; 3]) -> Sign {
        let excess = self.rounded.fine_excess(point);
        if excess > self.rounded.error[1] {
            Sign::Positive
        } else if excess < -self.rounded.error[1] {
            Sign::Negative
        } else {
            self.exact_excess(point)
        }
    }

    /// Returns the sign of (|q|² - 2 q · offset / denominator) times the denominator, with q the
    /// offset of the point from the local origin.
    fn exact_excess(&self, point: [f64; 3]) -> Sign {
        let q = subtract(&point.map(Dyadic::from_f64), &self.origin);
        let across = dot(&q, &self.offset);
        (&(&dot(&q, &q) * &self.denominator) - &(&across + &across)).sign()
    }
}

impl Rounded {
    fn new(origin: &[Dyadic; 3], offset: &[Dyadic; 3], denominator: &Dyadic, frame: Frame) -> Self {
        let Frame { scale, .. } = frame;
        let numerator = |axis: usize| &(&origin[axis] * denominator) + &offset[axis];
        let center = [0, 1, 2].map(|axis| Dyadic::nearest_quotient(&numerator(axis), denominator) + 0.0);
        let center_rest = [0, 1, 2].map(|axis| {
            let rest = &numerator(axis) - &(&Dyadic::from_f64(center[axis]) * denominator);
            Dyadic::nearest_quotient(&rest, denominator)
        });
        let square = dot(offset, offset);
        let whole = denominator * denominator;
        let in_scale = &square * &Dyadic::product(scale, scale);
        let high = Dyadic::nearest_quotient(&in_scale, &whole);
        let low = Dyadic::nearest_quotient(&(&in_scale - &(&Dyadic::from_f64(high) * &whole)), &whole);
        // The coarse classification ignores the rounding error of the center. It is used for
        // spheres whose center is in the hull of their points.
        let rest = center_rest.iter().fold(0.0_f64, |largest, x| largest.max(x.abs())) * scale;
        let coarse = 2.0 * SQUARE_ERROR * high + 16.0 * rest;
        // Squares of pairs have an error of 2^-100 of their size. The rest of the center has one of
        // 2^-106, which changes a square by twice the distance times that. Points are within 4 of
        // each other, so no distance exceeds `far`.
        let reach = center.iter().fold(1.0_f64, |largest, x| largest.max(x.abs() * scale));
        let far = 4.0 + high.sqrt();
        let fine = far * (far + reach) / (1_u128 << 96) as f64;
        Self { scale, center, center_rest, squared_radius: [high, low], radius_down: 0.0, error: [coarse, fine] }
    }

    /// Sets the radius from its square, given as a quotient. The radius must not exceed the extent
    /// of the points.
    fn round_radius(&mut self, numerator: &Dyadic, denominator: &Dyadic) {
        let above =
            |radius: f64| (&(&Dyadic::product(radius, radius) * denominator) - numerator).sign() == Sign::Positive;
        self.radius_down = (self.squared_radius[0].sqrt() / self.scale).next_up();
        while self.radius_down > 0.0 && above(self.radius_down) {
            self.radius_down = self.radius_down.next_down();
        }
    }

    /// Returns the squared distance of a point minus the squared radius. The error is within
    /// `error[0]` for points that are not far outside.
    #[inline(always)]
    fn coarse_excess(&self, point: [f64; 3]) -> f64 {
        squared(scaled_offset(point, self.center, self.scale)) - self.squared_radius[0]
    }

    /// Returns the same as [`coarse_excess`](Self::coarse_excess) with an error within `error[1]`,
    /// for points within 4 of the center.
    #[inline(always)]
    fn fine_excess(&self, point: [f64; 3]) -> f64 {
        let (mut high, mut low) = (-self.squared_radius[0], -self.squared_radius[1]);
        for axis in 0..3 {
            let (difference, lost) = two_sum(point[axis], -self.center[axis]);
            let (difference, rest) = (difference * self.scale, (lost - self.center_rest[axis]) * self.scale);
            let (square, lost) = two_product(difference, difference);
            let (sum, carried) = two_sum(high, square);
            low += carried + (lost + (2.0 * difference + rest) * rest);
            high = sum;
        }
        high + low
    }
}

fn add(u: &[Dyadic; 3], v: &[Dyadic; 3]) -> [Dyadic; 3] {
    [0, 1, 2].map(|axis| &u[axis] + &v[axis])
}

fn subtract(u: &[Dyadic; 3], v: &[Dyadic; 3]) -> [Dyadic; 3] {
    [0, 1, 2].map(|axis| &u[axis] - &v[axis])
}

fn scale(u: &[Dyadic; 3], factor: &Dyadic) -> [Dyadic; 3] {
    [0, 1, 2].map(|axis| &u[axis] * factor)
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;

    #[test]
    fn both_ways_find_the_same_sphere() {
        let mut rng = Rng::new(5);
        let frame = Frame { origin: [0.0; 3], scale: 0.25 };
        let mut supports = [0; 5];
        for _ in 0..400 {
            // Points of a small grid include collinear, coplanar, cospherical and duplicate ones.
            let count = rng.integer(1, 12);
            let side = rng.integer(0, 3);
            let points: Vec<[f64; 3]> =
                (0..count).map(|_| std::array::from_fn(|_| rng.integer(-side, side) as f64)).collect();
            let stepped = minimal(&points, &points[..1], frame);
            let welzl = of_all(&points, frame);
            assert_eq!(stepped.center(), welzl.center(), "{points:?}");
            assert_eq!(stepped.radius_down(), welzl.radius_down(), "{points:?}");
            assert!(stepped.centerd && stepped.furthest_outside(&points).is_none());
            supports[stepped.support.len()] += 1;
        }
        assert!(supports[1..].iter().all(|&count| count >= 10), "{supports:?}");
    }

    #[test]
    fn the_three_classifications_agree() {
        let mut rng = Rng::new(6);
        let (mut coarse, mut fine, mut exact) = (0, 0, 0);
        for round in 0..3_000 {
            let offset = rng.choose(&[0.0, 0.0, 1e7]);
            let point = |rng: &mut Rng| -> [f64; 3] {
                std::array::from_fn(|_| {
                    offset + if round % 2 == 0 { rng.integer(-3, 3) as f64 / 4.0 } else { rng.uniform(-0.9, 0.9) }
                })
            };
            let support: Vec<[f64; 3]> = (0..4).map(|_| point(&mut rng)).collect();
            let frame = Frame { origin: [offset; 3], scale: 1.0 };
            let Some(sphere) = ExactSphere::through(&support, frame) else { continue };
            if !sphere.centerd {
                continue;
            }
            // On the sphere, next to it, and anywhere.
            let mut beside = support[rng.integer(0, 3) as usize];
            beside[0] = if rng.one_in(3) { beside[0] } else { beside[0].next_up() };
            for q in [beside, point(&mut rng)] {
                let truth = sphere.exact_excess(q);
                let sign = |x: f64, error: f64| {
                    if x > error {
                        Some(Sign::Positive)
                    } else if x < -error {
                        Some(Sign::Negative)
                    } else {
                        None
                    }
                };
                let by_doubles = sign(sphere.rounded.coarse_excess(q), sphere.rounded.error[0]);
                let by_pairs = sign(sphere.rounded.fine_excess(q), sphere.rounded.error[1]);
                assert!(
                    by_doubles.is_none_or(|s| s == truth) && by_pairs.is_none_or(|s| s == truth),
                    "{q:?} {support:?}"
                );
                coarse += usize::from(by_doubles.is_some());
                fine += usize::from(by_doubles.is_none() && by_pairs.is_some());
                exact += usize::from(by_pairs.is_none());
            }
        }
        assert!(coarse > 200 && fine > 100 && exact > 50, "{coarse} {fine} {exact}");
    }
}
