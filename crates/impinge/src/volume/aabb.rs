//! The axis-aligned bounding box in its min-max form (*Notes on Real Time Collision Detection*, 2.1; Ericson, 4.2).

/// A closed axis-aligned box; the empty box has its corners the wrong way round and is the unit of [`union`](Self::union).
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
pub struct Aabb {
    /// The least coordinate on each axis.
    pub min: [f32; 3],
    /// The greatest coordinate on each axis.
    pub max: [f32; 3],
}

impl Aabb {
    /// The box of nothing.
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The least box of these points, exactly; empty where there are none.
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

    /// The least box that holds both, exactly.
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

    /// Whether the boxes have a point in common.
    #[inline]
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }

    /// The box with every bound moved outward to the next float, which makes up for coordinates rounded to nearest.
    #[inline]
    #[must_use]
    pub fn next_outward(self) -> Self {
        Self { min: self.min.map(f32::next_down), max: self.max.map(f32::next_up) }
    }
}
