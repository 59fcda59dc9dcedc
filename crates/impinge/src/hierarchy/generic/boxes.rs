//! Single-precision axis-aligned boxes as node volumes, stored by axis for the vector unit.

use super::volume::NodeVolume;
use crate::math::Pose;
use crate::volume::Aabb;

/// The axis-aligned boxes of up to `N` children of a node, stored by axis in single precision.
#[derive(Clone, Copy, Debug)]
pub struct AabbLanes<const N: usize> {
    min: [[f32; N]; 3],
    max: [[f32; N]; 3],
}

impl NodeVolume for Aabb {
    type Lanes<const N: usize> = AabbLanes<N>;

    fn of_points(points: &[[f64; 3]]) -> Option<Self> {
        let bounds = points.iter().fold(Self::EMPTY, |bounds, &point| bounds.union(outward(point, point)));
        (0..3).all(|axis| bounds.min[axis].is_finite() && bounds.max[axis].is_finite()).then_some(bounds)
    }

    #[inline(always)]
    fn merged(&self, other: &Self) -> Self {
        self.union(*other)
    }

    /// Returns the box around the image, from its center and half-extents (Arvo, *Graphics Gems*,
    /// 1990).
    ///
    /// # Accuracy
    /// On an axis, with u = 2^-53 and S = Σ|linear|·reach + |translation|: the center and the
    /// half-extents of single-precision corners have an error of at most u S. Three products and
    /// three sums of each have 6 u S together, and the final sum and difference 2 u S. 2^-48 S is
    /// twice as much as all of that. Rounding to single precision is outward.
    #[inline(always)]
    fn moved(&self, world_from_local: &Pose) -> Option<Self> {
        const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let translation = world_from_local.translation()[axis];
            let (mut center, mut half, mut size) = (translation, 0.0, translation.abs());
            for from in 0..3 {
                let (low, high) = (f64::from(self.min[from]), f64::from(self.max[from]));
                let entry = world_from_local.linear()[axis][from];
                center += entry * (0.5 * (low + high));
                half += entry.abs() * (0.5 * (high - low));
                size += entry.abs() * low.abs().max(high.abs());
            }
            half += ROUNDING * size;
            (min[axis], max[axis]) = (center - half, center + half);
        }
        let bounds = outward(min, max);
        (0..3).all(|axis| bounds.min[axis].is_finite() && bounds.max[axis].is_finite()).then_some(bounds)
    }

    fn lanes<const N: usize>(volumes: [Option<Self>; N]) -> AabbLanes<N> {
        let mut lanes = AabbLanes { min: [[f32::INFINITY; N]; 3], max: [[f32::NEG_INFINITY; N]; 3] };
        for (lane, bounds) in volumes.iter().enumerate() {
            for axis in 0..3 {
                if let Some(bounds) = bounds {
                    lanes.min[axis][lane] = bounds.min[axis];
                    lanes.max[axis][lane] = bounds.max[axis];
                }
            }
        }
        lanes
    }

    #[inline(always)]
    fn lane<const N: usize>(lanes: &AabbLanes<N>, lane: usize) -> Option<Self> {
        let min = [lanes.min[0][lane], lanes.min[1][lane], lanes.min[2][lane]];
        Some(Self { min, max: [lanes.max[0][lane], lanes.max[1][lane], lanes.max[2][lane]] })
    }

    #[inline(always)]
    fn overlapping<const N: usize>(lanes: &AabbLanes<N>, other: &Self) -> u32 {
        let mut apart = [false; N];
        for axis in 0..3 {
            for lane in 0..N {
                apart[lane] |= (lanes.min[axis][lane] > other.max[axis]) | (lanes.max[axis][lane] < other.min[axis]);
            }
        }
        (0..N).fold(0, |bits, lane| bits | u32::from(!apart[lane]) << lane)
    }
}

/// Returns the smallest single-precision box that contains a double-precision box.
#[inline(always)]
fn outward(min: [f64; 3], max: [f64; 3]) -> Aabb {
    // A corner that is a single-precision number is kept, so that boxes on a grid do not touch
    // their neighbors.
    let down = |x: f64| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 };
    let up = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
    Aabb { min: [down(min[0]), down(min[1]), down(min[2])], max: [up(max[0]), up(max[1]), up(max[2])] }
}
