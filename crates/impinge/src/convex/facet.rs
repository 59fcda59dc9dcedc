//! A lower bound on the distance of a triangle's plane from the origin, whatever the triangle's
//! shape.

use super::posed::to_unit_entries;
use crate::exact::double_double::{self, DoubleDouble};
use crate::math::Sign;
use crate::math::direction::rounded_direction;
use crate::math::dyadic::{self, Dyadic};
use crate::math::relative::{INFLATE, UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::{add, dot, length, sub};

/// The plane of three points of the common frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// Normal of the plane, on the side from which the points turn left. Its greatest entry is ±1.
    pub(super) direction: [f64; 3],
    /// Lower bound on the distance of the plane from the origin along `direction`. It is negative
    /// if the origin is on that side of the plane.
    pub(super) lower: f64,
}

impl Facet {
    /// Returns the facet of three points whose coordinates are at most a few units, or `None` if
    /// they are in one line.
    ///
    /// # Accuracy
    /// Let e and f be the edges at one corner a, and `N_k` the sum of the magnitudes of the two
    /// products of component k of the normal n = e × f. Component k is wrong by at most 5 u N_k,
    /// and n·a by at most 9 u Σ N_k |a_k| (docs/notes/proof.md, L22; u = 2^-53). If that is not
    /// small relative to |n|, doubled floats and last integers compute both.
    pub(super) fn of(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> Option<Self> {
        let (e, f) = (sub(b, a), sub(c, a));
        let (squared_e, squared_f, squared_g) = (dot(&e, &e), dot(&f, &f), dot(&sub(c, b), &sub(c, b)));
        // Starts at the corner between the two shorter edges. Two long edges beside a short one are
        // nearly parallel and lose digits.
        let (corner, e, f) = if squared_g >= squared_e.max(squared_f) {
            (a, e, f)
        } else if squared_f >= squared_e {
            (b, sub(c, b), sub(a, b))
        } else {
            (c, sub(a, c), sub(b, c))
        };
        let forward = [e[1] * f[2], e[2] * f[0], e[0] * f[1]];
        let backward = [e[2] * f[1], e[0] * f[2], e[1] * f[0]];
        let normal = sub(&forward, &backward);
        let magnitudes = add(&forward.map(f64::abs), &backward.map(f64::abs));
        let off = magnitudes[0] + magnitudes[1] + magnitudes[2];
        let size = dot(&magnitudes, &corner.map(f64::abs));
        let (off, size) = (5.0 * UNIT_ROUNDOFF * off + UNDERFLOW, 9.0 * UNIT_ROUNDOFF * size + UNDERFLOW);
        Self::across(normal, off, dot(&normal, corner) - size)
            .or_else(|| Self::in_doubled_floats(a, b, c))
            .or_else(|| Self::exactly(a, b, c))
    }

    /// Returns the facet with a normal that is wrong by at most `off` and whose product with a
    /// corner is at least `height`. Returns `None` if `off` is not small relative to the normal, or
    /// if its length may have lost digits.
    #[inline]
    fn across(normal: [f64; 3], off: f64, height: f64) -> Option<Self> {
        let across = length(&normal);
        // The limit is 2^-36. Edges whose lengths differ by a factor of 2^18 lose no digits that
        // would show in an answer.
        let is_certain = across.is_normal() && off < across * 1.5e-11 && across * across > 1e-280 && height.is_finite();
        is_certain.then(|| {
            let lower = height / if height > 0.0 { across + off } else { across - off };
            Self { direction: to_unit_entries(normal), lower: lower - lower.abs() * super::gjk::SLACK }
        })
    }

    /// Computes the facet in doubled floats. They mostly have digits left if floats have none, and
    /// cost about 50 times less than integers.
    #[cold]
    fn in_doubled_floats(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> Option<Self> {
        let [a, b, c] = [a, b, c].map(|point| point.map(DoubleDouble::of));
        let normal = double_double::cross(&double_double::difference(&b, &a), &double_double::difference(&c, &a));
        let [height, height_error] = double_double::dot(&normal, &a).rounded();
        let normal = normal.each_ref().map(DoubleDouble::rounded);
        Self::across(
            normal.map(|[x, _]| x),
            normal.iter().map(|[_, error]| error).sum::<f64>() * INFLATE,
            height - height_error,
        )
    }

    #[cold]
    fn exactly(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> Option<Self> {
        let [a, b, c] = [a, b, c].map(|point| point.map(Dyadic::from_f64));
        let edge = |to: &[Dyadic; 3]| [0, 1, 2].map(|k| &to[k] - &a[k]);
        let normal = dyadic::cross(&edge(&b), &edge(&c));
        let height = dyadic::dot(&normal, &a);
        let squared = dyadic::dot(&normal, &normal);
        if squared.sign() == Sign::Zero {
            return None;
        }
        let direction = rounded_direction(&normal)?;
        let quotient = Dyadic::nearest_quotient(&(&height * &height), &squared).sqrt();
        let lower = if height.sign() == Sign::Negative {
            -quotient.next_up().next_up()
        } else {
            quotient.next_down().next_down()
        };
        Some(Self { direction, lower: if quotient == 0.0 { -f64::MIN_POSITIVE.sqrt() } else { lower } })
    }
}
