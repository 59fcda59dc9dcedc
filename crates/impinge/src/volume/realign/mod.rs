//! Boxes that follow their contents when these rotate: five ways behind one interface (*Notes on
//! Real Time Collision Detection*, 2.2; Ericson, *Real-Time Collision Detection*, 4.2.3 to 4.2.6).
//!
//! | way | stored data | box | time |
//! |---|---|---|---|
//! | [`LooseBox`] | a sphere around the pivot | the same for every rotation | O(1) |
//! | [`TightPoints`] | all points | tight | O(points) |
//! | [`TightHull`] | the vertices of the hull | tight | O(vertices) |
//! | [`ClimbingHull`] | the hull and the last extremes | tight | O(steps) |
//! | [`RotatedBox`] | the original box | box of the rotated box | O(1) |
//!
//! A *tight* box has the exact extremes of the real images `R p + t`, each rounded outward to the
//! next float and no further. So all tight ways return the same bits. The other ways return a box
//! that encloses the tight one for every pose.
//!
//! The pose always maps from the local frame to the world frame. Every box is computed from the
//! stored data and the pose, never from the previous box, so boxes do not grow over a thousand
//! rotations.
//!
//! Tests: `tests/it/realign`. Benchmark: `realign`. Proof: `docs/notes/proof.md`.

mod loose;
mod rotated;
mod tight;

pub use loose::LooseBox;
pub use rotated::RotatedBox;
pub use tight::{ClimbingHull, TightHull, TightPoints};

use super::MinMax;
use crate::math::Pose;

/// A way of bounding one object, given in its local frame, by an axis-aligned box in the world
/// frame under any pose.
///
/// ```
/// use impinge::Pose;
/// use impinge::hull::Hull;
/// use impinge::volume::realign::{ClimbingHull, Realign, RotatedBox, TightPoints};
/// use impinge::volume::MinMax;
///
/// let rod = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.125, 0.125]];
/// let hull = Hull::new(&rod)?;
/// let mut every_point = TightPoints::new(&rod)?;
/// let mut climbing = ClimbingHull::new(&hull);
/// let mut rotated = RotatedBox::new(&MinMax::of(&rod)?);
///
/// // A quarter turn about z.
/// let world_from_rod = Pose::new([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [5.0, 0.0, 0.0])?;
/// let tight = every_point.realign(&world_from_rod);
/// assert_eq!((tight.min(), tight.max()), ([4.875, -1.0, 0.0], [5.0, 1.0, 0.125]));
/// assert_eq!(climbing.realign(&world_from_rod), tight);
/// assert!(rotated.realign(&world_from_rod).encloses(&tight));
/// # Ok::<(), impinge::InputError>(())
/// ```
pub trait Realign {
    /// Returns a box in the world frame that encloses the image of the object under the pose.
    fn realign(&mut self, world_from_local: &Pose) -> MinMax;

    /// Returns the number of bytes kept for one object, including borrowed data.
    fn memory(&self) -> usize;
}
