//! Simple stand-ins for many points: their convex hull, and volumes fitted to it (*Notes on Real
//! Time Collision Detection*, 1.1: a render mesh needs a proxy, and proxies are precomputed).

mod bytes;
mod proof;

use std::sync::Arc;

use super::fit::{self, Coordinate};
use super::{BoundingSphere, Capsule, Kdop14, Kdop18, Kdop26, Lozenge, MinMax, Obb};
use crate::hull::Hull;
use crate::input::InputError;

pub use proof::ProxyFlaw;

/// The convex hull of points, and a bounding volume of each kind around it, all in the frame of the
/// points. Each of them encloses every point.
///
/// ```
/// use impinge::volume::{BoundingVolume, Proxies};
///
/// let corners: Vec<[f32; 3]> = (0..8_u8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f32::from)).collect();
/// let proxies = Proxies::of_points(&corners)?;
/// assert_eq!(proxies.hull().vertices().len(), 8);
/// assert_eq!(proxies.bounds().volume(), 1.0);
/// assert_eq!(proxies.sphere().center(), [0.5; 3]);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The hull and the box are exact. Each other volume encloses the points in real arithmetic. The
/// same points give the same bits on every machine.
#[derive(Clone, Debug)]
pub struct Proxies {
    hull: Arc<Hull>,
    volumes: Volumes,
}

/// One bounding volume of each kind.
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
    /// Builds the hull of the points, and each volume by its default construction from the hull's
    /// corners, which suffice.
    ///
    /// # Errors
    /// Same as [`Hull::new`].
    ///
    /// # Complexity
    /// That of [`Hull::new`], plus about 100 passes over the hull's corners.
    pub fn of_points<T: Coordinate>(points: &[[T; 3]]) -> Result<Self, InputError> {
        Self::about(Hull::new(points)?)
    }

    /// Builds the volumes around a hull.
    pub(crate) fn about(hull: Hull) -> Result<Self, InputError> {
        let corners = hull.positions();
        let obb = fit::obb(corners)?.obb;
        let volumes = Volumes {
            bounds: MinMax::of(corners)?,
            sphere: fit::minimal_sphere(corners)?.sphere,
            capsule: fit::capsule(corners)?,
            lozenge: fit::lozenge(corners)?,
            // The half-extents use the same sums as the proof, so the proof cannot find them one
            // bit too small.
            obb: Obb::about(obb.center(), obb.axes(), corners),
            kdop14: Kdop14::of(corners)?,
            kdop18: Kdop18::of(corners)?,
            kdop26: Kdop26::of(corners)?,
        };
        Ok(Self { hull: Arc::new(hull), volumes })
    }

    /// Returns the convex hull, ready for [`Shape::hull`](crate::shape::Shape::hull). Its
    /// [`vertices`](Hull::vertices) are indices of the points.
    #[must_use]
    pub fn hull(&self) -> &Arc<Hull> {
        &self.hull
    }

    /// Returns the axis-aligned box of the points, exactly.
    #[must_use]
    pub fn bounds(&self) -> MinMax {
        self.volumes.bounds
    }

    /// Returns the minimal sphere around the points, as [`fit::minimal_sphere`] builds it.
    #[must_use]
    pub fn sphere(&self) -> BoundingSphere {
        self.volumes.sphere
    }

    /// Returns the capsule around the points that [`fit::capsule`] builds.
    #[must_use]
    pub fn capsule(&self) -> Capsule {
        self.volumes.capsule
    }

    /// Returns the lozenge around the points that [`fit::lozenge`] builds.
    #[must_use]
    pub fn lozenge(&self) -> Lozenge {
        self.volumes.lozenge
    }

    /// Returns an oriented box around the points, with the center and axes of the box of
    /// [`fit::obb`].
    #[must_use]
    pub fn obb(&self) -> Obb {
        self.volumes.obb
    }

    /// Returns the polytope with 14 faces around the points.
    #[must_use]
    pub fn kdop14(&self) -> Kdop14 {
        self.volumes.kdop14
    }

    /// Returns the polytope with 18 faces around the points.
    #[must_use]
    pub fn kdop18(&self) -> Kdop18 {
        self.volumes.kdop18
    }

    /// Returns the polytope with 26 faces around the points.
    #[must_use]
    pub fn kdop26(&self) -> Kdop26 {
        self.volumes.kdop26
    }

    /// Returns the size of the hull and all volumes in bytes.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.hull.memory() + size_of::<Volumes>()
    }
}
