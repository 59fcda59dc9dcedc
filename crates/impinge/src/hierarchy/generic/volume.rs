//! The interface between a tree and its volumes.

use std::fmt::Debug;

use crate::math::Pose;
use crate::volume::BoundingVolume;

/// A bounding volume for the nodes of a [`GenericTree`](super::GenericTree). Rounding may only err
/// in one direction: a volume may be too large, and an overlap may be reported of volumes that do
/// not overlap.
pub trait NodeVolume: Copy + Debug + Send + Sync {
    /// The volumes of one node, side by side.
    type Lanes<const N: usize>: Clone + Debug + Send + Sync;

    /// Returns a volume that contains these points. Returns `None` if there are no points, or if no
    /// volume can bound them.
    fn of_points(points: &[[f64; 3]]) -> Option<Self>;

    /// Returns a volume that contains both volumes.
    #[must_use]
    fn merged(&self, other: &Self) -> Self;

    /// Returns a volume that contains the image of this one under a pose, rounded outward. Returns
    /// `None` if the image cannot be bounded. Callers then treat it as overlapping everything.
    fn moved(&self, world_from_local: &Pose) -> Option<Self>;

    /// Stores volumes side by side. Lanes without a volume are arbitrary.
    fn lanes<const N: usize>(volumes: [Option<Self>; N]) -> Self::Lanes<N>;

    /// Returns the volume in a lane. The result is arbitrary for a lane without a volume.
    fn lane<const N: usize>(lanes: &Self::Lanes<N>, lane: usize) -> Option<Self>;

    /// Returns the lanes whose volumes are not proved apart from `other`, as bits. The bits of
    /// lanes without a volume are arbitrary.
    fn overlapping<const N: usize>(lanes: &Self::Lanes<N>, other: &Self) -> u32;
}

/// Any volume, one lane at a time. Boxes in single precision are stored by axis in `boxes.rs`.
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
