//! Directions from a point, the angles between them, and the solid angles of faces, each with an
//! error bound (docs/notes/proof.md, L17).
//!
//! Guarded by `tests/it/solids/winding.rs`.

use crate::exact::{AxisRay, Corners, PosedPoint};
use crate::math::Sign;
use crate::math::arctangent::{ANGLE_ERROR, angle};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{cross, dot, length, sub};

/// A real number in floats with an error bound. The bound is infinite if nothing is known.
#[derive(Clone, Copy)]
pub(super) struct Bounded {
    pub(in crate::mesh) value: f64,
    pub(in crate::mesh) error: f64,
}

/// The unit vector from a point to a corner, with an error of at most `error` in length.
pub(in crate::mesh) struct Direction {
    unit: [f64; 3],
    error: f64,
}

/// A direction, projected stereographically from the direction of a ray onto the plane
/// perpendicular to the ray.
pub(super) struct Projected {
    pub(in crate::mesh) x: f64,
    pub(in crate::mesh) y: f64,
    pub(in crate::mesh) error: f64,
}

impl Direction {
    pub(in crate::mesh) fn to(corner: &[f64; 3], point: &PosedPoint<'_>) -> Self {
        let difference = sub(corner, &point.approximate);
        // The vector is divided by its largest component first, so that no square vanishes or
        // overflows.
        let largest = difference.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let scaled = difference.map(|x| x / largest);
        let length = length(&scaled);
        let unit = scaled.map(|x| x / length);
        // The error of the point rotates the vector by at most twice the error over the vector's
        // length, if that is at most 1/4. The difference, two quotients and the length round each
        // component, so its error is at most 6 units. So the vector is off by at most 6 sqrt(3) <
        // 11 units.
        let relative = (point.error[0] + point.error[1] + point.error[2]) / largest;
        let error = if relative <= 0.25 { 2.0 * relative + 16.0 * UNIT_ROUNDOFF } else { f64::INFINITY };
        Self { unit, error }
    }

    /// Returns the projection. The direction of the ray goes to infinity, and the opposite
    /// direction goes to zero.
    pub(super) fn project(&self, ray: AxisRay) -> Projected {
        let [i, j] = ray.across();
        let (x, y) = (self.unit[i], self.unit[j]);
        let along = if ray.ascending { self.unit[ray.axis] } else { -self.unit[ray.axis] };
        if along <= 0.0 {
            // The denominator is at least one and the quotient is at most one.
            let scale = 1.0 / (1.0 - along);
            return Projected { x: x * scale, y: y * scale, error: 3.0 * self.error + 8.0 * UNIT_ROUNDOFF };
        }
        let across_squared = x * x + y * y;
        let across = across_squared.sqrt();
        let scale = (1.0 + along) / across_squared;
        // `relative` bounds the relative error of `across`. It counts once for `x` or `y`, twice
        // for `across_squared`, and once for `1 + along`.
        let relative = self.error / across;
        let size = (1.0 + along) / across;
        let error = if relative <= 1.0 / 16.0 { size * (6.0 * relative + 16.0 * UNIT_ROUNDOFF) } else { f64::INFINITY };
        Projected { x: x * scale, y: y * scale, error }
    }
}

impl Projected {
    /// Returns an upper bound of the distance from zero.
    pub(in crate::mesh) fn size(&self) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt() * (1.0 + 8.0 * UNIT_ROUNDOFF)
    }
}

/// A sum of angles of complex numbers, each multiplied by an integer.
#[derive(Clone, Copy, Default)]
pub(super) struct AngleSum {
    sum: f64,
    error: f64,
    size: f64,
    terms: f64,
}

impl AngleSum {
    /// Adds `times` the angle of `re + i im`. `error` is the error bound of this number, and `side`
    /// has the sign of the true angle.
    pub(in crate::mesh) fn add(&mut self, re: f64, im: f64, error: f64, side: Sign, times: i32) {
        let length = (re * re + im * im).sqrt();
        // The sine of the angle between both numbers is at most their distance over the length of
        // either, and the angle is at most π/2 times its sine.
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

    /// Adds half the solid angle of a face, as seen from a point. Adds nothing if the plane of the
    /// face holds the point.
    ///
    /// # Source
    /// Van Oosterom and Strackee, *The Solid Angle of a Plane Triangle*, IEEE Transactions on
    /// Biomedical Engineering 30(2), 1983.
    pub(in crate::mesh) fn add_face(&mut self, corners: &Corners, point: &PosedPoint<'_>) {
        let side = point.above(corners);
        if side == Sign::Zero {
            return;
        }
        let [a, b, c] = corners.each_ref().map(|corner| Direction::to(corner, point));
        let re = 1.0 + dot(&a.unit, &b.unit) + dot(&b.unit, &c.unit) + dot(&c.unit, &a.unit);
        let im = dot(&a.unit, &cross(&b.unit, &c.unit));
        // Each unit vector occurs in two inner products and in the triple product. So its error
        // counts three times; the fourth covers products of errors.
        let error = 4.0 * (a.error + b.error + c.error) + 32.0 * UNIT_ROUNDOFF;
        // The angle is positive if the point is behind the face, on the side opposite to the
        // normal.
        self.add(re, im, error, -side, 1);
    }

    /// Returns the sum over 2π.
    pub(in crate::mesh) fn turns(&self) -> Bounded {
        use std::f64::consts::TAU;
        // Each partial sum is at most the sum of magnitudes and is rounded once. The same holds for
        // the sum of errors.
        let rounding = 2.0 * UNIT_ROUNDOFF * (self.terms + 4.0) * (self.size + self.error);
        Bounded { value: self.sum / TAU, error: (self.error + rounding) / TAU * (1.0 + 8.0 * f64::EPSILON) }
    }
}
