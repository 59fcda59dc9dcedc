//! Contact over short intervals of time, in double precision, if a bound of all errors allows.
//!
//! Let u = 2^-53, and let `D` be the extents of the four corners along each axis, at the worse end
//! of the motion. Every difference of corners is within `D` and is rounded once. So each of the six
//! products of a volume is within `D₀D₁D₂`. The stored multiples are sums of 18 such products. On
//! the way of each there are three differences, two factors and at most five sums of rounding: 10 u
//! of `18 D₀D₁D₂`. The value over an interval is three convex combinations of these, with weights t
//! and 1 - t that are exact for the times used here: two roundings each, 6 u. Together that is 288
//! u, of which 512 are taken, because `D` and its product are rounded too.
//!
//! An area along an axis is four products of two other extents, 5 u and twice 2 u: 36 u of `DᵢDⱼ`,
//! taken as 64. Differences alone need 1 u and 2 u, taken as 8. Underflow is less than 2^-940 in a
//! volume and 2^-1060 in an area. Nothing overflows, because coordinates are below 2^128.
//! Polynomials that were rounded from exact ones are wrong by 1 u of each coefficient and 6 u of
//! the largest, taken as 16, and by less than 2^-1060.
//!
//! The proof is docs/notes/proof.md, L23. The tests are in `tests/it/sweep/corners.rs` and
//! `recorded.rs`.

use super::polynomials::{Polynomials, Split};
use crate::math::relative::UNIT_ROUNDOFF;

/// Magnitude below which the sign of a volume is not certain, whatever the extents: 2^-900.
const VOLUME_UNDERFLOW: f64 = f64::from_bits((1023 - 900) << 52);

/// Magnitude below which the sign of an area or a difference is not certain: 2^-1000.
const AREA_UNDERFLOW: f64 = f64::from_bits((1023 - 1000) << 52);

/// Verdict about contact within an interval of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// There is no contact.
    Apart,
    /// There is contact.
    Contact,
    /// Nothing is proved.
    Undecided,
    /// Nothing is proved, and the volume is within its error all over the interval. Shorter
    /// intervals would prove little more.
    Blind,
}

/// The corners, their polynomials and the error bounds of these.
pub(super) struct Floats<'c> {
    t0: &'c [[f64; 3]; 4],
    t1: &'c [[f64; 3]; 4],
    split: Split,
    polynomials: Polynomials<f64>,
    volume_error: f64,
    /// Error bounds of the areas, by axis, then by the corner that is left out.
    area_errors: [[f64; 4]; 3],
    difference_errors: [f64; 3],
}

/// Reports whether differences along an axis disprove contact for the whole motion. Their signs are
/// exact.
#[inline]
pub(super) fn are_always_apart(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4], split: Split) -> bool {
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

    /// Replaces the polynomials by more accurate ones. Each coefficient must be the float nearest
    /// to a positive multiple of the true one, with the same factor for all coefficients of a
    /// polynomial.
    pub(super) fn sharpen(&mut self, polynomials: Polynomials<f64>) {
        let error = |coefficients: &[f64]| {
            let largest = coefficients.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
            16.0 * UNIT_ROUNDOFF * largest + if largest > 0.0 { AREA_UNDERFLOW } else { 0.0 }
        };
        self.volume_error = error(&polynomials.volume);
        self.area_errors = polynomials.areas.map(|axis| axis.map(|area| error(&area)));
        self.polynomials = polynomials;
    }

    /// Returns the verdict about the times from `low` to `high`, multiples of 2^-53.
    ///
    /// `is_inside` means that all areas are proved to have one sign along some axis over the whole
    /// interval. Contact then occurs when the volume is zero. This function sets it if that is
    /// proved.
    #[inline]
    pub(super) fn classify(&self, low: f64, high: f64, is_inside: &mut bool) -> Verdict {
        let volume = cubic(&self.polynomials.volume, low, high);
        if common_sign(&volume, self.volume_error).is_some() {
            return Verdict::Apart;
        }
        if !*is_inside {
            for axis in 0..3 {
                let (mut some_positive, mut some_negative, mut some_undecided) = (false, false, false);
                for (area, &error) in self.polynomials.areas[axis].iter().zip(&self.area_errors[axis]) {
                    match common_sign(&quadratic(area, low, high), error) {
                        Some(true) => some_positive = true,
                        Some(false) => some_negative = true,
                        None => some_undecided = true,
                    }
                }
                if some_positive && some_negative {
                    return Verdict::Apart;
                }
                *is_inside |= !some_undecided;
            }
            if !*is_inside && self.are_separated(low, high) {
                return Verdict::Apart;
            }
        }
        let (start, end) = (volume[0], volume[3]);
        let crosses = start.min(end) < -self.volume_error && start.max(end) > self.volume_error;
        if *is_inside && crosses {
            return Verdict::Contact;
        }
        // If the volume is proved to be zero throughout, the areas decide.
        let is_blind = self.volume_error > 0.0 && volume.iter().all(|x| x.abs() <= self.volume_error);
        if is_blind { Verdict::Blind } else { Verdict::Undecided }
    }

    /// Reports whether the corners of one simplex are beyond those of the other along some axis,
    /// from `low` to `high`.
    fn are_separated(&self, low: f64, high: f64) -> bool {
        let first = self.split.first();
        (0..3).any(|axis| {
            let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
            for i in 0..first {
                for j in first..4 {
                    let start = self.t0[i][axis] - self.t0[j][axis];
                    let end = self.t1[i][axis] - self.t1[j][axis];
                    let (x, y) = (mix(start, end, low), mix(start, end, high));
                    least = least.min(x).min(y);
                    greatest = greatest.max(x).max(y);
                }
            }
            least > self.difference_errors[axis] || greatest < -self.difference_errors[axis]
        })
    }
}

/// Returns whether all numbers are positive, or `None` if their signs differ or are not certain.
/// The numbers are wrong by at most `error`.
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

/// Returns the Bernstein coefficients of a quadratic over an interval (de Casteljau).
#[inline]
fn quadratic([a, b, c]: &[f64; 3], low: f64, high: f64) -> [f64; 3] {
    let (start, end) = ([mix(*a, *b, low), mix(*b, *c, low)], [mix(*a, *b, high), mix(*b, *c, high)]);
    [mix(start[0], start[1], low), mix(start[0], start[1], high), mix(end[0], end[1], high)]
}

/// Returns the Bernstein coefficients of a cubic over an interval (de Casteljau).
#[inline]
fn cubic([a, b, c, d]: &[f64; 4], low: f64, high: f64) -> [f64; 4] {
    let at = |t: f64| {
        let [x, y, z] = [mix(*a, *b, t), mix(*b, *c, t), mix(*c, *d, t)];
        [mix(x, y, t), mix(y, z, t)]
    };
    let (start, end) = (at(low), at(high));
    [mix(start[0], start[1], low), mix(start[0], start[1], high), mix(end[0], end[1], low), mix(end[0], end[1], high)]
}
