//! What a tree asks of its volumes.

use std::fmt::Debug;

use crate::math::Pose;
use crate::volume::BoundingVolume;

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

/// Any volume, one after the other; those of single precision boxes lie side by side in `boxes.rs`.
impl<V: BoundingVolume> NodeVolume for V {
    type Lanes<const N: usize> = [Option<V>; N];

    fn of_points(points: &[[f64; 3]]) -> Option<Self> {
        BoundingVolume::of_points(points).ok()
    }

    fn merged(&self, other: &Self) -> Self {
        BoundingVolume::merged(self, other)
    }

    #[inline]
    fn moved(&self, world_from_local: &Pose) -> Option<Self> {
        BoundingVolume::moved(self, world_from_local).ok()
    }

    fn lanes<const N: usize>(volumes: [Option<Self>; N]) -> [Option<V>; N] {
        volumes
    }

    #[inline]
    fn lane<const N: usize>(lanes: &[Option<V>; N], lane: usize) -> Option<Self> {
        lanes[lane]
    }

    #[inline]
    fn overlapping<const N: usize>(lanes: &[Option<V>; N], other: &Self) -> u32 {
        let overlaps = |lane: usize| lanes[lane].is_none_or(|volume| volume.overlaps(other));
        (0..N).fold(0, |bits, lane| bits | u32::from(overlaps(lane)) << lane)
    }
}
