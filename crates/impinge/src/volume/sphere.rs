//! The bounding sphere (*Notes*, 2.3; Ericson 4.3).

use super::core::Core;
use super::min_max::{in_range, lengths_in_range};
use super::round::Round;
use super::round::sealed::Swept;
use crate::input::InputError;
use crate::math::Sign;
use crate::math::dyadic::Dyadic;
use crate::math::vec3::squared_distance;

/// The closed ball about `centre`; a radius of zero is a point.
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
    pub(super) centre: [f64; 3],
    pub(super) radius: f64,
}

const _: () = assert!(size_of::<BoundingSphere>() == 32);

impl BoundingSphere {
    /// The sphere about a centre.
    ///
    /// # Errors
    /// [`NonFinite`](crate::input::InputErrorKind::NonFinite), [`OutOfRange`](crate::input::InputErrorKind::OutOfRange)
    /// (beyond 2^320), [`Negative`](crate::input::InputErrorKind::Negative) for the radius.
    pub fn new(centre: [f64; 3], radius: f64) -> Result<Self, InputError> {
        in_range("centre", centre)?;
        lengths_in_range("radius", [radius])?;
        Ok(Self { centre, radius })
    }

    /// From numbers that are known to be in range.
    pub(super) fn from_valid(centre: [f64; 3], radius: f64) -> Self {
        Self { centre, radius }
    }

    /// The centre.
    #[must_use]
    pub fn centre(&self) -> [f64; 3] {
        self.centre
    }

    /// The radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether every point of the other sphere is in this one, exactly.
    #[must_use]
    pub fn encloses(&self, other: &Self) -> bool {
        self.radius >= other.radius
            && distance_against(self.centre, other.centre, self.radius, -other.radius) != Sign::Positive
    }
}

/// How the distance of two points compares to `r + s`, which is not negative: exactly.
#[inline]
pub(super) fn distance_against(p: [f64; 3], q: [f64; 3], r: f64, s: f64) -> Sign {
    /// Squares below this, 2^-900, may have lost bits to underflow.
    const TINY: f64 = f64::from_bits((1023 - 900) << 52);
    let squared_distance = squared_distance(&q, &p);
    let sum = r + s;
    let squared_sum = sum * sum;
    // Two roundings of each difference in its square, one of the square and two of the sums; three of the other side.
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
        Core::point(self.centre)
    }

    fn reach(&self) -> f64 {
        self.radius
    }
}

impl Round for BoundingSphere {}
