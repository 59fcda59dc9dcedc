//! The axis-aligned bounding box in its min-max form, in single precision (*Notes on Real Time
//! Collision Detection*, 2.1; Ericson, 4.2).

/// A closed axis-aligned box in single precision. In the empty box every `min` is infinity and
/// every `max` minus infinity; it is the neutral element of [`union`](Self::union).
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
pub struct Aabb {
    /// The smallest coordinate on each axis.
    pub min: [f32; 3],
    /// The largest coordinate on each axis.
    pub max: [f32; 3],
}

impl Aabb {
    /// The empty box, which overlaps nothing.
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// Returns the smallest box that holds the points, exactly. Without points the box is empty.
    /// NaN coordinates are ignored.
    #[inline]
    #[must_use]
    pub fn of_points<const N: usize>(points: [[f32; 3]; N]) -> Self {
        let mut bounds = Self::EMPTY;
        for point in points {
            for axis in 0..3 {
                bounds.min[axis] = bounds.min[axis].min(point[axis]);
                bounds.max[axis] = bounds.max[axis].max(point[axis]);
            }
        }
        bounds
    }

    /// Returns the smallest box that holds both boxes, exactly. NaN coordinates are ignored.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let mut bounds = self;
        for axis in 0..3 {
            bounds.min[axis] = bounds.min[axis].min(other.min[axis]);
            bounds.max[axis] = bounds.max[axis].max(other.max[axis]);
        }
        bounds
    }

    /// Reports whether the boxes have a point in common, exactly. Touching boxes overlap. A box
    /// with a NaN coordinate overlaps nothing.
    #[inline]
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }

    /// Returns the box with every bound moved outward to the next float. This covers coordinates
    /// that were rounded to nearest.
    #[inline]
    #[must_use]
    pub fn next_outward(self) -> Self {
        Self { min: self.min.map(f32::next_down), max: self.max.map(f32::next_up) }
    }
}
