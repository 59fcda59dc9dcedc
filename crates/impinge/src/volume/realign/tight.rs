//! Tight boxes: the exact extremes, found among all points, among the vertices of the hull, or by climbing on it.

use super::Realign;
use crate::exact::{image_down, image_up};
use crate::hull::{Extremes, Hull, climb, judge, stored};
use crate::input::InputError;
use crate::math::Pose;
use crate::volume::MinMax;

/// Way (b) of the *Notes*: every point is looked at (algorithm 2.2, whose extremes start the wrong way round there).
///
/// # Complexity
/// O(points), in single precision at the speed of memory: 12 bytes a point.
#[derive(Clone, Debug)]
pub struct TightPoints<'p, T> {
    points: &'p [[T; 3]],
    extremes: Extremes,
}

impl<'p, T: Copy + Into<f64> + Sync> TightPoints<'p, T> {
    /// For all of these points.
    ///
    /// # Errors
    /// As [`Hull::new`].
    pub fn new(points: &'p [[T; 3]]) -> Result<Self, InputError> {
        judge(points)?;
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

/// Way (b) on the hull: only its vertices are looked at.
///
/// # Complexity
/// O(vertices), as [`TightPoints`].
#[derive(Clone, Copy, Debug)]
pub struct TightHull<'h> {
    hull: &'h Hull,
}

impl<'h> TightHull<'h> {
    /// For what has this hull.
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

/// Way (c) of the *Notes*: each extreme is climbed to from the last one. The true one always, however large the turn;
/// the smaller it is, the sooner.
///
/// # Complexity
/// As many steps as vertices lie between the last extremes and the new ones. For an extreme that is not reached after looking
/// at as many vertices as there are, all are scanned.
#[derive(Clone, Copy, Debug)]
pub struct ClimbingHull<'h> {
    hull: &'h Hull,
    /// The least and the greatest vertex along each axis of the world, when last asked.
    last: [[u32; 2]; 3],
}

impl<'h> ClimbingHull<'h> {
    /// For what has this hull.
    #[must_use]
    pub fn new(hull: &'h Hull) -> Self {
        Self { hull, last: [[0; 2]; 3] }
    }

    /// For what has this hull, from where an earlier climb ended: [`extremes`](Self::extremes), which may be kept where the
    /// hull cannot be borrowed. Vertices that there are not count as the first.
    #[must_use]
    pub fn resume(hull: &'h Hull, last: [[u32; 2]; 3]) -> Self {
        let count = hull.positions().len() as u32;
        Self { hull, last: last.map(|ends| ends.map(|end| if end < count { end } else { 0 })) }
    }

    /// The least and the greatest vertex along each axis of the world, when last asked.
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

/// The box of the images of the least and the greatest point along each axis.
#[inline]
fn bounds(world_from_local: &Pose, extremes: [[[f64; 3]; 2]; 3]) -> MinMax {
    let coordinates = |round: fn(&Pose, usize, &[f64; 3]) -> f64, end: usize| -> [f64; 3] {
        std::array::from_fn(|axis| round(world_from_local, axis, &extremes[axis][end]))
    };
    MinMax::from_ordered(coordinates(image_down, 0), coordinates(image_up, 1))
}
