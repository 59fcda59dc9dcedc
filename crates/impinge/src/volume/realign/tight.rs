//! Tight boxes: the exact extremes, found by scanning all points, by scanning the vertices of the
//! hull, or by climbing on it.

use super::Realign;
use crate::exact::{image_down, image_up};
use crate::hull::{Extremes, Hull, climb, stored, validate_points};
use crate::input::InputError;
use crate::math::Pose;
use crate::volume::MinMax;

/// The tight box of points, found by a scan of every point: way (b) of the *Notes* (algorithm 2.2,
/// whose initial extremes are swapped there). Its bounds are the exact extremes, rounded outward.
///
/// # Complexity
/// O(points), in single precision at the speed of memory: 12 bytes per point.
#[derive(Clone, Debug)]
pub struct TightPoints<'p, T> {
    points: &'p [[T; 3]],
    extremes: Extremes,
}

impl<'p, T: Copy + Into<f64> + Sync> TightPoints<'p, T> {
    /// Prepares all of the points, given in the local frame.
    ///
    /// # Errors
    /// Same as [`Hull::new`].
    pub fn new(points: &'p [[T; 3]]) -> Result<Self, InputError> {
        validate_points(points)?;
        Ok(Self { points, extremes: Extremes::new(points) })
    }
}

impl<T: Copy + Into<f64> + Sync> Realign for TightPoints<'_, T> {
    fn realign(&mut self, world_from_local: &Pose) -> MinMax {
        let found = self.extremes.of(self.points, world_from_local.linear());
        bounds(world_from_local, found.map(|ends| ends.map(|end| stored(self.points[end as usize]))))
    }

    fn memory(&self) -> usize {
        size_of::<Self>() + size_of_val(self.points) + self.extremes.memory()
    }
}

/// The tight box of an object, found by a scan of the vertices of its hull. It equals that of
/// [`TightPoints`].
///
/// # Complexity
/// O(vertices), like [`TightPoints`].
#[derive(Clone, Copy, Debug)]
pub struct TightHull<'h> {
    hull: &'h Hull,
}

impl<'h> TightHull<'h> {
    /// Prepares the object that has this hull.
    #[must_use]
    pub fn new(hull: &'h Hull) -> Self {
        Self { hull }
    }
}

impl Realign for TightHull<'_> {
    fn realign(&mut self, world_from_local: &Pose) -> MinMax {
        let found = self.hull.extremes().of(self.hull.positions(), world_from_local.linear());
        bounds(world_from_local, found.map(|ends| ends.map(|end| self.hull.positions()[end as usize])))
    }

    fn memory(&self) -> usize {
        size_of::<Self>() + size_of_val(self.hull.positions()) + self.hull.extremes().memory()
    }
}

/// The tight box of an object, found by climbing over its hull from the last extremes: way (c) of
/// the *Notes*. The extremes found are always the true ones, however large the rotation. Smaller
/// rotations are faster.
///
/// # Complexity
/// As many steps as there are vertices between the last extremes and the new ones. If a climb has
/// visited as many vertices as the hull has and has not arrived, all vertices are scanned.
#[derive(Clone, Copy, Debug)]
pub struct ClimbingHull<'h> {
    hull: &'h Hull,
    /// The minimal and maximal vertex along each world axis at the last call.
    last: [[u32; 2]; 3],
}

impl<'h> ClimbingHull<'h> {
    /// Prepares the object that has this hull. The first climb starts at vertex 0.
    #[must_use]
    pub fn new(hull: &'h Hull) -> Self {
        Self { hull, last: [[0; 2]; 3] }
    }

    /// Prepares the object that has this hull, with climbs that start at `last`, the
    /// [`extremes`](Self::extremes) of an earlier climb. Use this if the hull cannot stay borrowed.
    /// A vertex index that is out of range becomes 0.
    #[must_use]
    pub fn resume(hull: &'h Hull, last: [[u32; 2]; 3]) -> Self {
        let count = hull.positions().len() as u32;
        Self { hull, last: last.map(|ends| ends.map(|end| if end < count { end } else { 0 })) }
    }

    /// Returns for each world axis the vertices whose images were lowest and highest along it at
    /// the last call of [`realign`](Realign::realign). They are indices into [`Hull::positions`].
    /// Before the first call, returns the vertices at which the climbs start.
    #[must_use]
    pub fn extremes(&self) -> [[u32; 2]; 3] {
        self.last
    }
}

impl Realign for ClimbingHull<'_> {
    fn realign(&mut self, world_from_local: &Pose) -> MinMax {
        for (row, last) in world_from_local.linear().iter().zip(&mut self.last) {
            *last = [climb(self.hull, &row.map(|x| -x), last[0]), climb(self.hull, row, last[1])];
        }
        bounds(world_from_local, self.last.map(|ends| ends.map(|end| self.hull.positions()[end as usize])))
    }

    fn memory(&self) -> usize {
        size_of::<Self>() + self.hull.memory()
    }
}

/// Returns the box of the images of the minimal and maximal point along each axis, rounded outward.
#[inline]
fn bounds(world_from_local: &Pose, extremes: [[[f64; 3]; 2]; 3]) -> MinMax {
    let coordinates = |round: fn(&Pose, usize, &[f64; 3]) -> f64, end: usize| -> [f64; 3] {
        std::array::from_fn(|axis| round(world_from_local, axis, &extremes[axis][end]))
    };
    MinMax::from_ordered(coordinates(image_down, 0), coordinates(image_up, 1))
}
