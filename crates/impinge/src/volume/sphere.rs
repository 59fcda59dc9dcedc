//! The bounding sphere (*Notes*, 2.3; Ericson 4.3).

use super::core::Core;
use super::min_max::{in_range, lengths_in_range};
use super::round::Round;
use super::round::sealed::Swept;
use crate::input::InputError;
use crate::math::Sign;
use crate::math::dyadic::Dyadic;
use crate::math::vec3::squared_distance;

/// The closed solid sphere around `center`. A radius of zero makes a point.
///
/// ```
/// use impinge::volume::{BoundingSphere, BoundingVolume};
/// let a = BoundingSphere::new([0.0; 3], 1.0)?;
/// let b = BoundingSphere::new([0.0, 3.0, 4.0], 4.0)?;
/// assert!(a.overlaps(&b)); // they touch: 1 + 4 = 5
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingSphere {
    pub(super) center: [f64; 3],
    pub(super) radius: f64,
}

const _: () = assert!(size_of::<BoundingSphere>() == 32);

impl BoundingSphere {
    /// Builds the sphere around a center.
    ///
    /// # Errors
    /// Returns [`NonFinite`](crate::input::InputErrorKind::NonFinite) or
    /// [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) (beyond 2^320) for an invalid
    /// number, and [`Negative`](crate::input::InputErrorKind::Negative) for a negative radius.
    pub fn new(center: [f64; 3], radius: f64) -> Result<Self, InputError> {
        in_range("sphere center", center)?;
        lengths_in_range("radius", [radius])?;
        Ok(Self { center, radius })
    }

    /// Builds the sphere from numbers that are known to be valid.
    pub(super) fn from_valid(center: [f64; 3], radius: f64) -> Self {
        Self { center, radius }
    }

    /// Returns the center.
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        self.center
    }

    /// Returns the radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Reports whether every point of the other sphere is in this one, exactly.
    #[must_use]
    pub fn encloses(&self, other: &Self) -> bool {
        self.radius >= other.radius
            && distance_against(self.center, other.center, self.radius, -other.radius) != Sign::Positive
    }
}

/// Returns the sign of |p - q| - (r + s), exactly. The sum `r + s` must not be negative.
///
/// Doubles decide unless the difference is within their error bound; exact arithmetic decides the
/// rest.
#[inline]
pub(super) fn distance_against(p: [f64; 3], q: [f64; 3], r: f64, s: f64) -> Sign {
    /// Squares below this, 2^-900, may have lost bits to underflow.
    const TINY: f64 = f64::from_bits((1023 - 900) << 52);
    let squared_distance = squared_distance(&q, &p);
    let sum = r + s;
    let squared_sum = sum * sum;
    // The squared distance has two roundings of each difference, one of each square and two of the
    // sums. The squared sum has three.
    let margin = 8.0 * f64::EPSILON * (squared_distance + squared_sum);
    let difference = squared_distance - squared_sum;
    if difference.abs() > margin && margin > TINY {
        return if difference > 0.0 { Sign::Positive } else { Sign::Negative };
    }
    let difference = |axis: usize| &Dyadic::from_f64(q[axis]) - &Dyadic::from_f64(p[axis]);
    let square = |x: &Dyadic| x * x;
    let sum = &Dyadic::from_f64(r) + &Dyadic::from_f64(s);
    let squares = [0, 1, 2].map(|axis| square(&difference(axis)));
    (&(&(&squares[0] + &squares[1]) + &squares[2]) - &square(&sum)).sign()
}

#[allow(private_interfaces, reason = "its members are for this module alone")]
impl Swept for BoundingSphere {
    fn core(&self) -> Core {
        Core::point(self.center)
    }

    fn reach(&self) -> f64 {
        self.radius
    }
}

impl Round for BoundingSphere {}
