//! The minimal sphere in exact arithmetic: spheres through at most four points, and which points lie outside.
//!
//! With edges u, v, w from one of the points, the offset of the centre from there is a quotient of polynomials, whose
//! numerator and (positive) denominator are kept as exact numbers. A point is judged in doubles, then in pairs of doubles
//! (Dekker 1971), then exactly: points that were rounded onto a sphere are a unit in the last place from it, which pairs
//! see, and only those that are on it, or as good as, need more.

use super::super::super::rounding::{two_product, two_sum};
use super::super::enclosing::{SQUARE_ERROR, scaled_offset, squared};
use super::frame::Frame;
use crate::math::Sign;
use crate::math::dyadic::{Dyadic, cross, dot};

/// The smallest sphere through one to four points that are affinely independent.
#[derive(Clone, Debug)]
pub(super) struct ExactBall {
    support: Vec<[f64; 3]>,
    anchor: [Dyadic; 3],
    /// From the anchor to the centre, times the denominator.
    offset: [Dyadic; 3],
    /// Positive.
    denominator: Dyadic,
    /// Whether the centre is in the hull of the support.
    centred: bool,
    rounded: Rounded,
}

/// The sphere in doubles and pairs of doubles; lengths are in the scale of the frame.
#[derive(Clone, Debug)]
struct Rounded {
    scale: f64,
    /// To nearest, in the points' own unit.
    centre: [f64; 3],
    /// What that lost.
    centre_rest: [f64; 3],
    squared_radius: [f64; 2],
    /// Not above the radius, in the points' own unit.
    radius_down: f64,
    /// What the judgement in doubles, and in pairs, may be off by.
    error: [f64; 2],
}

/// The minimal sphere of the points, of which `guess` is a likely support.
pub(super) fn minimal(points: &[[f64; 3]], guess: &[[f64; 3]], frame: Frame) -> ExactBall {
    /// Each step enlarges the sphere, so there is an end; it comes within ten steps, and where it does not, the other
    /// way has a bound on its expected work.
    const MOST_STEPS: usize = 64;
    let mut ball = of_few(guess, frame);
    for _ in 0..MOST_STEPS {
        let Some(current) = &ball else { break };
        let Some(outside) = current.furthest_outside(points) else { break };
        let mut next = current.support.clone();
        next.push(outside);
        ball = of_few(&next, frame);
    }
    match ball {
        Some(ball) if ball.furthest_outside(points).is_none() => ball,
        _ => of_all(points, frame),
    }
}

/// The minimal sphere of up to five points: the one of a subset that holds the others and has its centre in the hull of
/// the subset. There is always one; a subset as large as can be is the likely one.
fn of_few(points: &[[f64; 3]], frame: Frame) -> Option<ExactBall> {
    let mut subsets: Vec<u32> = (1..1 << points.len()).filter(|subset: &u32| subset.count_ones() <= 4).collect();
    subsets.sort_by_key(|subset| std::cmp::Reverse(subset.count_ones()));
    subsets.into_iter().find_map(|subset| {
        let chosen: Vec<[f64; 3]> = (0..points.len()).filter(|i| subset >> i & 1 == 1).map(|i| points[i]).collect();
        let ball = ExactBall::through(&chosen, frame)?;
        let holds = |point: &[f64; 3]| ball.excess(*point) != Sign::Positive;
        (ball.centred && points.iter().all(holds)).then_some(ball)
    })
}

/// Welzl's algorithm, in a fixed random order and exact arithmetic, where it needs no care for degenerate sets: a point
/// outside the sphere through others is affinely independent of them.
///
/// # Complexity
/// Linear, expected over the orders, whatever the points are.
fn of_all(points: &[[f64; 3]], frame: Frame) -> ExactBall {
    let mut order = points.to_vec();
    // Fisher and Yates with Knuth's linear congruence (MMIX), whose high bits are random enough to scatter an input that was
    // not made against it.
    let mut state = 1_u64;
    for i in (1..order.len()).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        order.swap(i, ((u128::from(state) * (i as u128 + 1)) >> 64) as usize);
    }
    with_on_it(&order, &[], frame).unwrap_or_else(|| ExactBall::at(points[0], frame))
}

/// The smallest sphere that holds the points and has the given ones on it.
fn with_on_it(points: &[[f64; 3]], on_it: &[[f64; 3]], frame: Frame) -> Option<ExactBall> {
    let mut ball = ExactBall::through(on_it, frame);
    if on_it.len() == 4 {
        return ball;
    }
    for (i, &point) in points.iter().enumerate() {
        if ball.as_ref().is_none_or(|ball| ball.excess(point) == Sign::Positive) {
            let mut more = on_it.to_vec();
            more.push(point);
            ball = with_on_it(&points[..i], &more, frame).or(ball);
        }
    }
    ball
}

impl ExactBall {
    /// The point.
    fn at(point: [f64; 3], frame: Frame) -> Self {
        let zero = [Dyadic::ZERO, Dyadic::ZERO, Dyadic::ZERO];
        Self::new(&[point], point.map(Dyadic::from_f64), zero, Dyadic::from_f64(1.0), true, frame)
    }

    /// The smallest sphere through these points; none without points, or where they are affinely dependent.
    fn through(points: &[[f64; 3]], frame: Frame) -> Option<Self> {
        let (&first, others) = points.split_first()?;
        let anchor = first.map(Dyadic::from_f64);
        let edges: Vec<[Dyadic; 3]> =
            others.iter().map(|&point| subtract(&point.map(Dyadic::from_f64), &anchor)).collect();
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
        // Barycentric coordinates of the centre, times what is positive, and those of the anchor what is left.
        let (weights, whole) = weights;
        let rest = weights.iter().fold(whole, |rest, weight| &rest - weight);
        let centred = weights.iter().chain([&rest]).all(|weight| weight.sign() != Sign::Negative);
        match denominator.sign() {
            Sign::Zero => None,
            Sign::Positive => Some(Self::new(points, anchor, offset, denominator, centred, frame)),
            Sign::Negative => {
                let negate = |x: &Dyadic| &Dyadic::ZERO - x;
                let offset = [0, 1, 2].map(|axis| negate(&offset[axis]));
                Some(Self::new(points, anchor, offset, negate(&denominator), centred, frame))
            }
        }
    }

    fn new(
        support: &[[f64; 3]],
        anchor: [Dyadic; 3],
        offset: [Dyadic; 3],
        denominator: Dyadic,
        centred: bool,
        frame: Frame,
    ) -> Self {
        let mut rounded = Rounded::new(&anchor, &offset, &denominator, frame);
        if centred {
            rounded.round_radius(&dot(&offset, &offset), &(&denominator * &denominator));
        }
        Self { support: support.to_vec(), anchor, offset, denominator, centred, rounded }
    }

    /// The centre, each coordinate rounded to nearest.
    pub(super) fn centre(&self) -> [f64; 3] {
        self.rounded.centre
    }

    /// A bound on what that lost, in the scale of the frame.
    pub(super) fn centre_error(&self) -> f64 {
        2.0 * self.rounded.centre_rest.iter().fold(0.0_f64, |sum, x| sum + x.abs()) * self.rounded.scale
    }

    /// A double not above the radius.
    pub(super) fn radius_down(&self) -> f64 {
        self.rounded.radius_down
    }

    /// The point that lies furthest outside, up to rounding; none where none lies outside, exactly.
    fn furthest_outside(&self, points: &[[f64; 3]]) -> Option<[f64; 3]> {
        let mut furthest: Option<(f64, [f64; 3])> = None;
        for &point in points {
            let coarse = self.rounded.coarse_excess(point);
            // Compared so that NaN, after an overflow, counts as near the sphere.
            if coarse < -self.rounded.error[0] {
                continue;
            }
            let excess = self.rounded.fine_excess(point);
            if furthest.as_ref().is_some_and(|&(worst, _)| excess <= worst) {
                continue;
            }
            // As [`excess`](Self::excess), from what is at hand.
            let error = self.rounded.error[1];
            let certain = excess > error || excess < -error;
            let outside = if certain { excess > error } else { self.exact_excess(point) == Sign::Positive };
            if outside {
                furthest = Some((excess, point));
            }
        }
        furthest.map(|(_, point)| point)
    }

    /// Whether a point is outside (positive), on the sphere, or inside.
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

    /// |q|² - 2 q · offset / denominator for q from the anchor, times the denominator.
    fn exact_excess(&self, point: [f64; 3]) -> Sign {
        let q = subtract(&point.map(Dyadic::from_f64), &self.anchor);
        let across = dot(&q, &self.offset);
        (&(&dot(&q, &q) * &self.denominator) - &(&across + &across)).sign()
    }
}

impl Rounded {
    fn new(anchor: &[Dyadic; 3], offset: &[Dyadic; 3], denominator: &Dyadic, frame: Frame) -> Self {
        let Frame { scale, .. } = frame;
        let numerator = |axis: usize| &(&anchor[axis] * denominator) + &offset[axis];
        let centre = [0, 1, 2].map(|axis| Dyadic::nearest_quotient(&numerator(axis), denominator) + 0.0);
        let centre_rest = [0, 1, 2].map(|axis| {
            let rest = &numerator(axis) - &(&Dyadic::from_f64(centre[axis]) * denominator);
            Dyadic::nearest_quotient(&rest, denominator)
        });
        let square = dot(offset, offset);
        let whole = denominator * denominator;
        let in_scale = &square * &Dyadic::product(scale, scale);
        let high = Dyadic::nearest_quotient(&in_scale, &whole);
        let low = Dyadic::nearest_quotient(&(&in_scale - &(&Dyadic::from_f64(high) * &whole)), &whole);
        // The coarse judgement leaves out the rest of the centre, and is for spheres that are centred in their points.
        let rest = centre_rest.iter().fold(0.0_f64, |largest, x| largest.max(x.abs())) * scale;
        let coarse = 2.0 * SQUARE_ERROR * high + 16.0 * rest;
        // Squares of pairs are within 2^-100 of themselves, and the rest of the centre within 2^-106 of its size, which moves
        // a square by twice the distance times that; points are within 4 of each other, so a distance is at most `far`.
        let reach = centre.iter().fold(1.0_f64, |largest, x| largest.max(x.abs() * scale));
        let far = 4.0 + high.sqrt();
        let fine = far * (far + reach) / (1_u128 << 96) as f64;
        Self { scale, centre, centre_rest, squared_radius: [high, low], radius_down: 0.0, error: [coarse, fine] }
    }

    /// Sets the radius, for a squared one that is this quotient, and not larger than the points are apart.
    fn round_radius(&mut self, numerator: &Dyadic, denominator: &Dyadic) {
        let above =
            |radius: f64| (&(&Dyadic::product(radius, radius) * denominator) - numerator).sign() == Sign::Positive;
        self.radius_down = (self.squared_radius[0].sqrt() / self.scale).next_up();
        while self.radius_down > 0.0 && above(self.radius_down) {
            self.radius_down = self.radius_down.next_down();
        }
    }

    /// How much the squared distance of a point exceeds the squared radius, within `error[0]` for points that are not
    /// well outside.
    #[inline(always)]
    fn coarse_excess(&self, point: [f64; 3]) -> f64 {
        squared(scaled_offset(point, self.centre, self.scale)) - self.squared_radius[0]
    }

    /// The same within `error[1]`, for points within 4 of the centre.
    #[inline(always)]
    fn fine_excess(&self, point: [f64; 3]) -> f64 {
        let (mut high, mut low) = (-self.squared_radius[0], -self.squared_radius[1]);
        for axis in 0..3 {
            let (difference, lost) = two_sum(point[axis], -self.centre[axis]);
            let (difference, rest) = (difference * self.scale, (lost - self.centre_rest[axis]) * self.scale);
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
            // Points of a small grid: collinear, coplanar, cospherical and duplicated ones among them.
            let count = rng.integer(1, 12);
            let side = rng.integer(0, 3);
            let points: Vec<[f64; 3]> =
                (0..count).map(|_| std::array::from_fn(|_| rng.integer(-side, side) as f64)).collect();
            let stepped = minimal(&points, &points[..1], frame);
            let welzl = of_all(&points, frame);
            assert_eq!(stepped.centre(), welzl.centre(), "{points:?}");
            assert_eq!(stepped.radius_down(), welzl.radius_down(), "{points:?}");
            assert!(stepped.centred && stepped.furthest_outside(&points).is_none());
            supports[stepped.support.len()] += 1;
        }
        assert!(supports[1..].iter().all(|&count| count >= 10), "{supports:?}");
    }

    #[test]
    fn the_three_judgements_agree() {
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
            let Some(ball) = ExactBall::through(&support, frame) else { continue };
            if !ball.centred {
                continue;
            }
            // On the sphere, a step beside it, and anywhere.
            let mut beside = support[rng.integer(0, 3) as usize];
            beside[0] = if rng.one_in(3) { beside[0] } else { beside[0].next_up() };
            for q in [beside, point(&mut rng)] {
                let truth = ball.exact_excess(q);
                let sign = |x: f64, error: f64| {
                    if x > error {
                        Some(Sign::Positive)
                    } else if x < -error {
                        Some(Sign::Negative)
                    } else {
                        None
                    }
                };
                let by_doubles = sign(ball.rounded.coarse_excess(q), ball.rounded.error[0]);
                let by_pairs = sign(ball.rounded.fine_excess(q), ball.rounded.error[1]);
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
