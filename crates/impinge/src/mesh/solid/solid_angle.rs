//! Directions from a point, the angles that they make, and the solid angles of faces, each with a bound of its error.

use crate::exact::{AxisRay, Corners, PosedPoint};
use crate::math::Sign;
use crate::math::arctangent::{ANGLE_ERROR, angle};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{cross, dot, length, sub};

/// A real number in floats, and how far off it may be; infinite where nothing is known.
#[derive(Clone, Copy)]
pub(super) struct Bounded {
    pub(in crate::mesh) value: f64,
    pub(in crate::mesh) error: f64,
}

/// The unit vector from a point to a corner, off by at most `error` in length.
pub(in crate::mesh) struct Direction {
    unit: [f64; 3],
    error: f64,
}

/// A direction, projected stereographically from that of a ray onto the plane across it.
pub(super) struct Projected {
    pub(in crate::mesh) x: f64,
    pub(in crate::mesh) y: f64,
    pub(in crate::mesh) error: f64,
}

impl Direction {
    pub(in crate::mesh) fn to(corner: &[f64; 3], point: &PosedPoint<'_>) -> Self {
        let difference = sub(corner, &point.approximate);
        // Divided by the largest first, so that no square vanishes or overflows.
        let largest = difference.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let scaled = difference.map(|x| x / largest);
        let length = length(&scaled);
        let unit = scaled.map(|x| x / length);
        // The error of the point turns the vector by at most twice that over its length, up to a quarter of it. Each
        // component is rounded by the difference, two quotients and the length: 6 units in all, of which the square sum of
        // three is below 11.
        let relative = (point.error[0] + point.error[1] + point.error[2]) / largest;
        let error = if relative <= 0.25 { 2.0 * relative + 16.0 * UNIT_ROUNDOFF } else { f64::INFINITY };
        Self { unit, error }
    }

    /// From the direction of the ray, which goes to infinity; that against it goes to zero.
    pub(super) fn project(&self, ray: AxisRay) -> Projected {
        let [i, j] = ray.across();
        let (x, y) = (self.unit[i], self.unit[j]);
        let along = if ray.ascending { self.unit[ray.axis] } else { -self.unit[ray.axis] };
        if along <= 0.0 {
            // The quotient has a denominator of at least one and is at most one.
            let scale = 1.0 / (1.0 - along);
            return Projected { x: x * scale, y: y * scale, error: 3.0 * self.error + 8.0 * UNIT_ROUNDOFF };
        }
        let across_squared = x * x + y * y;
        let across = across_squared.sqrt();
        let scale = (1.0 + along) / across_squared;
        // Relative to the distance from the axis, which stands once above and twice below the line, and for `1 + along`.
        let relative = self.error / across;
        let size = (1.0 + along) / across;
        let error = if relative <= 1.0 / 16.0 { size * (6.0 * relative + 16.0 * UNIT_ROUNDOFF) } else { f64::INFINITY };
        Projected { x: x * scale, y: y * scale, error }
    }
}

impl Projected {
    /// An upper bound of the distance from zero.
    pub(in crate::mesh) fn size(&self) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt() * (1.0 + 8.0 * UNIT_ROUNDOFF)
    }
}

/// A sum of angles of complex numbers, each times an integer.
#[derive(Clone, Copy, Default)]
pub(super) struct AngleSum {
    sum: f64,
    error: f64,
    size: f64,
    terms: f64,
}

impl AngleSum {
    /// Adds `times` the angle of `re + i im`, which is off by at most `error`; the true angle has the sign of `side`.
    pub(in crate::mesh) fn add(&mut self, re: f64, im: f64, error: f64, side: Sign, times: i32) {
        let length = (re * re + im * im).sqrt();
        // The sine of the angle between both numbers is at most their distance over the length of either, and the angle
        // at most π/2 times its sine.
        let off = 1.6 * (error / length) + ANGLE_ERROR;
        let (magnitude, off) = match off {
            off if off < 1.0 => (angle(re, im.abs()), off),
            _ => (std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2 + ANGLE_ERROR),
        };
        let weight = f64::from(times);
        match side {
            Sign::Positive => self.sum += weight * magnitude,
            Sign::Negative => self.sum -= weight * magnitude,
            Sign::Zero => {}
        }
        self.error += weight.abs() * off;
        self.size += weight.abs() * magnitude;
        self.terms += 1.0;
    }

    /// Adds half the solid angle of a face; nothing where its plane holds the point.
    ///
    /// # Source
    /// Van Oosterom and Strackee, *The Solid Angle of a Plane Triangle*, IEEE Transactions on Biomedical Engineering 30(2),
    /// 1983.
    pub(in crate::mesh) fn add_face(&mut self, corners: &Corners, point: &PosedPoint<'_>) {
        let side = point.above(corners);
        if side == Sign::Zero {
            return;
        }
        let [a, b, c] = corners.each_ref().map(|corner| Direction::to(corner, point));
        let re = 1.0 + dot(&a.unit, &b.unit) + dot(&b.unit, &c.unit) + dot(&c.unit, &a.unit);
        let im = dot(&a.unit, &cross(&b.unit, &c.unit));
        // Each of the unit vectors stands in three terms of size one, four with products of errors.
        let error = 4.0 * (a.error + b.error + c.error) + 32.0 * UNIT_ROUNDOFF;
        // The normal points away from a point that the face winds round the right way.
        self.add(re, im, error, -side, 1);
    }

    /// The sum over 2π.
    pub(in crate::mesh) fn turns(&self) -> Bounded {
        use std::f64::consts::TAU;
        // Each partial sum is at most the sum of magnitudes, and rounded once, as is that of the errors.
        let rounding = 2.0 * UNIT_ROUNDOFF * (self.terms + 4.0) * (self.size + self.error);
        Bounded { value: self.sum / TAU, error: (self.error + rounding) / TAU * (1.0 + 8.0 * f64::EPSILON) }
    }
}
