//! Support functions of round shapes. The largest entry of a direction is ±1, so that squares of
//! its entries do not overflow.

use crate::convex::Support;

/// A cylinder about the z axis.
#[derive(Debug)]
pub(super) struct Cylinder {
    pub(super) half_height: f64,
    pub(super) radius: f64,
}

/// A cone about the z axis, with its tip upwards.
#[derive(Debug)]
pub(super) struct Cone {
    pub(super) half_height: f64,
    pub(super) radius: f64,
}

/// An ellipsoid about the origin, with its axes along the coordinate axes.
#[derive(Debug)]
pub(super) struct Ellipsoid {
    pub(super) half_axes: [f64; 3],
}

impl Support for Cylinder {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let ([x, y], _) = on_circle(direction, self.radius);
        [x, y, self.half_height.copysign(direction[2])]
    }

    fn reach(&self) -> [f64; 3] {
        [self.radius, self.radius, self.half_height]
    }
}

impl Support for Cone {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let ([x, y], across) = on_circle(direction, self.radius);
        let rise = direction[2] * self.half_height;
        if rise > self.radius * across - rise { [0.0, 0.0, self.half_height] } else { [x, y, -self.half_height] }
    }

    fn reach(&self) -> [f64; 3] {
        [self.radius, self.radius, self.half_height]
    }
}

impl Support for Ellipsoid {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        // The ellipsoid is the image of the unit sphere under a stretch. Its support point is the
        // image of the sphere's point along the stretched direction.
        let greatest = self.half_axes.into_iter().fold(0.0, f64::max);
        let stretched: [f64; 3] = std::array::from_fn(|k| self.half_axes[k] / greatest * direction[k]);
        let length = stretched.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 { std::array::from_fn(|k| self.half_axes[k] * (stretched[k] / length)) } else { [0.0; 3] }
    }

    fn reach(&self) -> [f64; 3] {
        self.half_axes
    }
}

/// Returns the point of a circle about the z axis that is farthest along a direction, and the
/// length of the direction across the axis. The point is the center if that length is zero.
fn on_circle(direction: [f64; 3], radius: f64) -> ([f64; 2], f64) {
    let [x, y, _] = direction;
    let across = (x * x + y * y).sqrt();
    if across > 0.0 { ([radius * (x / across), radius * (y / across)], across) } else { ([0.0; 2], across) }
}
