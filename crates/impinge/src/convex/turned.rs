//! Cylinders and cones: cores that are symmetric about the z axis of their frame.
//!
//! The largest entry of a direction is ±1, so that squares of its entries do not overflow.

use super::support::Support;

/// A cylinder or a cone about the z axis, from z = -`half_height` to z = `half_height`. The base of
/// a cone is at the lower end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turned {
    pub(crate) half_height: f64,
    /// Radius of the lower end.
    pub(crate) radius: f64,
    /// Whether the upper end is a point. Otherwise it has the radius of the lower end.
    pub(crate) is_cone: bool,
}

impl Support for Turned {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let ([x, y], across) = on_circle(direction, self.radius);
        if !self.is_cone {
            return [x, y, self.half_height.copysign(direction[2])];
        }
        let rise = direction[2] * self.half_height;
        if rise > self.radius * across - rise { [0.0, 0.0, self.half_height] } else { [x, y, -self.half_height] }
    }

    fn reach(&self) -> [f64; 3] {
        [self.radius, self.radius, self.half_height]
    }
}

/// Returns the point of a circle about the z axis that is farthest along a direction, and the
/// length of the direction across the axis. The point is the center if that length is zero.
fn on_circle(direction: [f64; 3], radius: f64) -> ([f64; 2], f64) {
    let [x, y, _] = direction;
    let across = (x * x + y * y).sqrt();
    if across > 0.0 { ([radius * (x / across), radius * (y / across)], across) } else { ([0.0; 2], across) }
}
