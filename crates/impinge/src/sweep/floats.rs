//! Contact judged over short intervals in double precision, where a bound of all errors allows.
//!
//! With u = 2^-53 and `D` the extents of the four corners along each axis, at the worse end of the motion, every
//! difference of corners is within `D` and is rounded once. So each of the six products of a volume is within
//! `D₀D₁D₂`, and the multiples kept are sums of 18 such products: three differences, two factors and at most five sums
//! of rounding on the way of each, 10 u of `18 D₀D₁D₂`. The value over an interval is three convex combinations of
//! these, with weights t and 1 - t that are exact for the times used here: two roundings each, 6 u. Together 288 u, of
//! which 512 are taken, as `D` and its product are rounded too. An area along an axis is four products of two other
//! extents, 5 u and twice 2 u: 36 u of `DᵢDⱼ`, of which 64 are taken. Differences alone: 1 u and 2 u, of which 8 are
//! taken. What underflows is less than 2^-940 in a volume and 2^-1060 in an area; nothing overflows, as coordinates
//! are below 2^128. Polynomials that were rounded from exact ones are off by 1 u of each coefficient and 6 u of the
//! largest, of which 16 are taken, and by less than 2^-1060.

use super::polynomials::{Polynomials, Split};
use crate::math::relative::UNIT_ROUNDOFF;

/// Below this no volume is certain, whatever the extents.
const VOLUME_UNDERFLOW: f64 = f64::from_bits((1023 - 900) << 52);

/// Below this no area and no difference is certain.
const AREA_UNDERFLOW: f64 = f64::from_bits((1023 - 1000) << 52);

/// What is known about contact within an interval of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Judgement {
    /// There is none.
    Apart,
    /// There is some.
    Meets,
    /// Nothing is proved.
    Open,
    /// Nothing is proved, and the volume is within what it may be off by all over the interval, so that shorter ones
    /// would tell little more.
    Blind,
}

/// The corners, their polynomials and what these may be off by.
pub(super) struct Floats<'c> {
    t0: &'c [[f64; 3]; 4],
    t1: &'c [[f64; 3]; 4],
    split: Split,
    polynomials: Polynomials<f64>,
    volume_error: f64,
    /// By axis and left out corner.
    area_errors: [[f64; 4]; 3],
    difference_errors: [f64; 3],
}

/// Whether contact is disproved for the whole motion by differences along an axis, whose signs are exact.
#[inline]
pub(super) fn stay_apart(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4], split: Split) -> bool {
    let first = split.first();
    (0..3).any(|axis| {
        let sides = |corners: &[[f64; 3]; 4]| {
            let range = |part: &[[f64; 3]]| {
                part.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), corner| {
                    (low.min(corner[axis]), high.max(corner[axis]))
                })
            };
            let ((low_a, high_a), (low_b, high_b)) = (range(&corners[..first]), range(&corners[first..]));
            (low_a > high_b, low_b > high_a)
        };
        let (start, end) = (sides(t0), sides(t1));
        start.0 && end.0 || start.1 && end.1
    })
}

impl<'c> Floats<'c> {
    pub(super) fn new(t0: &'c [[f64; 3]; 4], t1: &'c [[f64; 3]; 4], split: Split) -> Self {
        let extent = |axis: usize| {
            let of = |corners: &[[f64; 3]; 4]| {
                let range = corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), corner| {
                    (low.min(corner[axis]), high.max(corner[axis]))
                });
                range.1 - range.0
            };
            of(t0).max(of(t1))
        };
        let [x, y, z] = [extent(0), extent(1), extent(2)];
        Self {
            t0,
            t1,
            split,
            polynomials: Polynomials::new(t0, t1, split),
            volume_error: 512.0 * UNIT_ROUNDOFF * (x * y * z) + VOLUME_UNDERFLOW,
            area_errors: [y * z, z * x, x * y].map(|area| [64.0 * UNIT_ROUNDOFF * area + AREA_UNDERFLOW; 4]),
            difference_errors: [x, y, z].map(|length| 8.0 * UNIT_ROUNDOFF * length + AREA_UNDERFLOW),
        }
    }

    /// Takes polynomials each of whose coefficients is the float nearest to a positive multiple of the true one, the same
    /// for all of a polynomial.
    pub(super) fn sharpen(&mut self, polynomials: Polynomials<f64>) {
        let error = |coefficients: &[f64]| {
            let most = coefficients.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            16.0 * UNIT_ROUNDOFF * most + if most > 0.0 { AREA_UNDERFLOW } else { 0.0 }
        };
        self.volume_error = error(&polynomials.volume);
        self.area_errors = polynomials.areas.map(|axis| axis.map(|area| error(&area)));
        self.polynomials = polynomials;
    }

    /// What is known about the times from `low` to `high`, multiples of 2^-53.
    ///
    /// `is_inside` says that areas are proved to be of one sign along some axis all over the interval, so that contact
    /// is where the volume is zero; it is set here once it is so.
    #[inline]
    pub(super) fn judge(&self, low: f64, high: f64, is_inside: &mut bool) -> Judgement {
        let volume = cubic(&self.polynomials.volume, low, high);
        if common_sign(&volume, self.volume_error).is_some() {
            return Judgement::Apart;
        }
        if !*is_inside {
            for axis in 0..3 {
                let (mut some_positive, mut some_negative, mut some_open) = (false, false, false);
                for (area, &error) in self.polynomials.areas[axis].iter().zip(&self.area_errors[axis]) {
                    match common_sign(&quadratic(area, low, high), error) {
                        Some(true) => some_positive = true,
                        Some(false) => some_negative = true,
                        None => some_open = true,
                    }
                }
                if some_positive && some_negative {
                    return Judgement::Apart;
                }
                *is_inside |= !some_open;
            }
            if !*is_inside && self.are_separated(low, high) {
                return Judgement::Apart;
            }
        }
        let (start, end) = (volume[0], volume[3]);
        let crosses = start.min(end) < -self.volume_error && start.max(end) > self.volume_error;
        if *is_inside && crosses {
            return Judgement::Meets;
        }
        // A volume that is zero throughout, and known to be, leaves it to the areas.
        let is_blind = self.volume_error > 0.0 && volume.iter().all(|x| x.abs() <= self.volume_error);
        if is_blind { Judgement::Blind } else { Judgement::Open }
    }

    /// Whether the corners of one simplex are beyond those of the other, along some axis, from `low` to `high`.
    fn are_separated(&self, low: f64, high: f64) -> bool {
        let first = self.split.first();
        (0..3).any(|axis| {
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for i in 0..first {
                for j in first..4 {
                    let start = self.t0[i][axis] - self.t0[j][axis];
                    let end = self.t1[i][axis] - self.t1[j][axis];
                    let (x, y) = (mix(start, end, low), mix(start, end, high));
                    least = least.min(x).min(y);
                    most = most.max(x).max(y);
                }
            }
            least > self.difference_errors[axis] || most < -self.difference_errors[axis]
        })
    }
}

/// The sign of all of some numbers that are off by at most `error`, where it is one: whether they are positive.
#[inline]
fn common_sign<const N: usize>(values: &[f64; N], error: f64) -> Option<bool> {
    if values.iter().all(|&x| x > error) {
        Some(true)
    } else if values.iter().all(|&x| x < -error) {
        Some(false)
    } else {
        None
    }
}

#[inline]
fn mix(x: f64, y: f64, t: f64) -> f64 {
    x * (1.0 - t) + y * t
}

/// The Bernstein coefficients over an interval (de Casteljau).
#[inline]
fn quadratic([a, b, c]: &[f64; 3], low: f64, high: f64) -> [f64; 3] {
    let (start, end) = ([mix(*a, *b, low), mix(*b, *c, low)], [mix(*a, *b, high), mix(*b, *c, high)]);
    [mix(start[0], start[1], low), mix(start[0], start[1], high), mix(end[0], end[1], high)]
}

/// As [`quadratic`].
#[inline]
fn cubic([a, b, c, d]: &[f64; 4], low: f64, high: f64) -> [f64; 4] {
    let at = |t: f64| {
        let [x, y, z] = [mix(*a, *b, t), mix(*b, *c, t), mix(*c, *d, t)];
        [mix(x, y, t), mix(y, z, t)]
    };
    let (start, end) = (at(low), at(high));
    [mix(start[0], start[1], low), mix(start[0], start[1], high), mix(end[0], end[1], low), mix(end[0], end[1], high)]
}
