//! What a tree asks of its volumes.

use std::fmt::Debug;

use crate::math::Pose;

/// A bounding volume as a node of a [`GenericTree`](super::GenericTree) has it. None of its answers may be wrong in the
/// other direction: a volume may be too large, and two may be said to overlap that do not, for all that rounding does.
pub trait NodeVolume: Copy + Debug + Send + Sync {
    /// Several volumes as one node keeps them.
    type Lanes<const N: usize>: Clone + Debug + Send + Sync;

    /// A volume that holds these points; none where there are none, or it cannot be bounded.
    fn of_points(points: &[[f64; 3]]) -> Option<Self>;

    /// A volume that holds both volumes.
    #[must_use]
    fn merged(&self, other: &Self) -> Self;

    /// A volume that holds the image of this one; none where that cannot be bounded, and so overlaps everything.
    fn moved(&self, world_from_local: &Pose) -> Option<Self>;

    /// Lays volumes side by side. Lanes without a volume may hold anything.
    fn lanes<const N: usize>(volumes: [Option<Self>; N]) -> Self::Lanes<N>;

    /// The volume in a lane that has one.
    fn lane<const N: usize>(lanes: &Self::Lanes<N>, lane: usize) -> Option<Self>;

    /// The lanes whose volumes are not proved apart from another one, as bits; those of lanes without a volume may be
    /// anything.
    fn overlapping<const N: usize>(lanes: &Self::Lanes<N>, other: &Self) -> u32;
}
