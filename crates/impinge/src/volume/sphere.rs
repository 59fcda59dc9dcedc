//! The bounding sphere (*Notes*, 2.3; Ericson 4.3).

use super::BoundingVolume;
use super::fit;
use super::min_max::{in_range, lengths_in_range};
use super::rigid::{image, stretch};
use super::rounding::{add_up, distance_up, mul_up};
use crate::input::InputError;
use crate::math::dyadic::Dyadic;
use crate::math::{Pose, Sign};

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
    centre: [f64; 3],
    radius: f64,
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

impl BoundingVolume for BoundingSphere {
    /// The minimal sphere.
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        fit::minimal_sphere(points).map(|fitted| fitted.sphere)
    }

    /// Exact. Algorithm 2.3 of the *Notes* compares with the difference of the radii; the sum is right.
    #[inline]
    fn overlaps(&self, other: &Self) -> bool {
        distance_against(self.centre, other.centre, self.radius, other.radius) != Sign::Positive
    }

    /// Exact, for a point within the range of 2^320.
    fn contains(&self, point: [f64; 3]) -> bool {
        distance_against(self.centre, point, self.radius, 0.0) != Sign::Positive
    }

    /// The least sphere that holds both, up to rounding: one of them, or the one with both far poles.
    fn merged(&self, other: &Self) -> Self {
        if self.encloses(other) {
            return *self;
        }
        if other.encloses(self) {
            return *other;
        }
        // In one order, so that swapping the two changes no bit.
        let (a, b) =
            if (self.centre, self.radius) <= (other.centre, other.radius) { (self, other) } else { (other, self) };
        let between: [f64; 3] = std::array::from_fn(|axis| b.centre[axis] - a.centre[axis]);
        let distance = distance_up(a.centre, b.centre);
        let share = (0.5 * (distance + b.radius - a.radius) / distance).clamp(0.0, 1.0);
        let centre: [f64; 3] = std::array::from_fn(|axis| a.centre[axis] + share * between[axis]);
        let reach = |part: &Self| add_up(distance_up(centre, part.centre), part.radius);
        Self { centre, radius: reach(a).max(reach(b)) }
    }

    /// A rigid motion within 1e-4; the radius grows by what the pose may stretch it and by the rounding of the centre, and
    /// by nothing where both are exact.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let stretch = stretch(world_from_local)?;
        let (centre, off) = image(world_from_local, self.centre);
        Self::new(centre, add_up(mul_up(self.radius, stretch), off))
    }

    fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius * self.radius * self.radius
    }

    fn surface_area(&self) -> f64 {
        4.0 * std::f64::consts::PI * self.radius * self.radius
    }
}

/// How the distance of two points compares to `r + s`, which is not negative: exactly.
#[inline]
fn distance_against(p: [f64; 3], q: [f64; 3], r: f64, s: f64) -> Sign {
    /// Squares below this, 2^-900, may have lost bits to underflow.
    const TINY: f64 = f64::from_bits((1023 - 900) << 52);
    let [x, y, z]: [f64; 3] = std::array::from_fn(|axis| q[axis] - p[axis]);
    let squared_distance = x * x + y * y + z * z;
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
