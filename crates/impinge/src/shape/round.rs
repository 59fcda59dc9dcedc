//! The support function of an ellipsoid. The largest entry of a direction is ±1, so that squares of
//! its entries do not overflow.

use crate::convex::Support;

/// An ellipsoid about the origin, with its axes along the coordinate axes.
#[derive(Debug)]
pub(super) struct Ellipsoid {
    pub(super) half_axes: [f64; 3],
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
