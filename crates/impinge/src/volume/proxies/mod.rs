//! What may stand for points where they are too many: their convex hull, and volumes fitted to it (*Notes on Real Time
//! Collision Detection*, 1.1: a render mesh wants a proxy, and proxies are precomputed).

mod bytes;
mod proof;

use std::sync::Arc;

use super::fit::{self, Coordinate};
use super::{BoundingSphere, Capsule, Kdop14, Kdop18, Kdop26, Lozenge, MinMax, Obb};
use crate::hull::Hull;
use crate::input::InputError;

pub use proof::ProxyFlaw;

/// The convex hull of points, and a bounding volume of each kind about it, all in the frame of the points. Each holds every
/// point.
///
/// ```
/// use impinge::volume::{BoundingVolume, Proxies};
///
/// let corners: Vec<[f32; 3]> = (0..8_u8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f32::from)).collect();
/// let proxies = Proxies::of_points(&corners)?;
/// assert_eq!(proxies.hull().vertices().len(), 8);
/// assert_eq!(proxies.bounds().volume(), 1.0);
/// assert_eq!(proxies.sphere().centre(), [0.5; 3]);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The hull is exact, and so is the box; each other volume holds what it holds over the reals. The same points give the same
/// bits on every machine.
#[derive(Clone, Debug)]
pub struct Proxies {
    hull: Arc<Hull>,
    volumes: Volumes,
}

/// A volume of each kind.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Volumes {
    bounds: MinMax,
    sphere: BoundingSphere,
    capsule: Capsule,
    lozenge: Lozenge,
    obb: Obb,
    kdop14: Kdop14,
    kdop18: Kdop18,
    kdop26: Kdop26,
}

impl Proxies {
    /// The hull of the points, and the default construction of each volume from the hull's corners, which are all that counts.
    ///
    /// # Errors
    /// As [`Hull::new`].
    ///
    /// # Complexity
    /// That of [`Hull::new`], and some hundred passes over the hull's corners.
    pub fn of_points<T: Coordinate>(points: &[[T; 3]]) -> Result<Self, InputError> {
        Self::about(Hull::new(points)?)
    }

    /// About a hull.
    pub(crate) fn about(hull: Hull) -> Result<Self, InputError> {
        let corners = hull.positions();
        let obb = fit::obb(corners)?.obb;
        let volumes = Volumes {
            bounds: MinMax::of(corners)?,
            sphere: fit::minimal_sphere(corners)?.sphere,
            capsule: fit::capsule(corners)?,
            lozenge: fit::lozenge(corners)?,
            // Extents by the sums that the proof takes, so that it cannot find them a bit too small.
            obb: Obb::about(obb.centre(), obb.axes(), corners),
            kdop14: Kdop14::of(corners)?,
            kdop18: Kdop18::of(corners)?,
            kdop26: Kdop26::of(corners)?,
        };
        Ok(Self { hull: Arc::new(hull), volumes })
    }

    /// The convex hull, ready to be a [`Shape`](crate::shape::Shape::hull). Its vertices have the numbers of the points.
    #[must_use]
    pub fn hull(&self) -> &Arc<Hull> {
        &self.hull
    }

    /// The axis-aligned box.
    #[must_use]
    pub fn bounds(&self) -> MinMax {
        self.volumes.bounds
    }

    /// The minimal sphere.
    #[must_use]
    pub fn sphere(&self) -> BoundingSphere {
        self.volumes.sphere
    }

    /// The capsule of [`fit::capsule`].
    #[must_use]
    pub fn capsule(&self) -> Capsule {
        self.volumes.capsule
    }

    /// The lozenge of [`fit::lozenge`].
    #[must_use]
    pub fn lozenge(&self) -> Lozenge {
        self.volumes.lozenge
    }

    /// The oriented box of [`fit::obb`].
    #[must_use]
    pub fn obb(&self) -> Obb {
        self.volumes.obb
    }

    /// The polytope of 14 faces.
    #[must_use]
    pub fn kdop14(&self) -> Kdop14 {
        self.volumes.kdop14
    }

    /// The polytope of 18 faces.
    #[must_use]
    pub fn kdop18(&self) -> Kdop18 {
        self.volumes.kdop18
    }

    /// The polytope of 26 faces.
    #[must_use]
    pub fn kdop26(&self) -> Kdop26 {
        self.volumes.kdop26
    }

    /// Bytes that all of it holds.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.hull.memory() + size_of::<Volumes>()
    }
}
