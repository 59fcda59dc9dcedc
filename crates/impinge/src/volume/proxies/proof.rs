//! Proves that proxies from an outside source enclose the points that they stand for.

use std::fmt;

use rayon::prelude::*;

use super::{Proxies, Volumes};
use crate::volume::core::Core;
use crate::volume::{BoundingVolume, Obb, round};

/// Number of hull corners per parallel task.
const CHUNK: usize = 1 << 10;

/// The reason why bytes are not valid proxies of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProxyFlaw {
    /// The bytes are not a hull and volumes, or the hull has a vertex that is in no face of the
    /// mesh.
    Shape,
    /// The hull is not that of the mesh: it is not convex, does not enclose every vertex, or has a
    /// vertex that is not extreme.
    Hull,
    /// A volume does not enclose the hull.
    Volume {
        /// Name of the volume, such as `"sphere"`.
        which: &'static str,
    },
}

impl Proxies {
    /// Checks that the hull is the convex hull of its own vertices and these points, and that each
    /// volume encloses it.
    ///
    /// # Errors
    /// Returns the first flaw found: that of the hull, or else the alphabetically first volume.
    ///
    /// # Complexity
    /// That of [`Hull::is_of`](crate::hull::Hull::is_of), on all cores of the current rayon pool,
    /// plus a pass over the hull's corners.
    pub(crate) fn validate(&self, others: &[[f64; 3]]) -> Result<(), ProxyFlaw> {
        if !self.hull.is_of(others) {
            return Err(ProxyFlaw::Hull);
        }
        let corners = self.hull.positions();
        // A convex volume encloses the hull if it holds all corners.
        let too_small: Vec<&'static str> =
            corners.par_chunks(CHUNK).filter_map(|chunk| self.volumes.first_that_misses(chunk)).collect();
        match too_small.into_iter().min() {
            Some(which) => Err(ProxyFlaw::Volume { which }),
            None => Ok(()),
        }
    }
}

impl Volumes {
    /// Returns the name of a volume that is not proved to hold all the points, or `None` if all
    /// volumes do.
    fn first_that_misses(&self, points: &[[f64; 3]]) -> Option<&'static str> {
        let Self { bounds, sphere, capsule, lozenge, obb, kdop14, kdop18, kdop26 } = self;
        // NaN would fail the comparison and prove nothing; numbers in range never produce it.
        let swept =
            |core: &Core, radius: f64| points.iter().all(|&point| round::distance_to_core(point, core) <= radius);
        let all = |holds: &dyn Fn([f64; 3]) -> bool| points.iter().all(|&point| holds(point));
        let reach = Obb::about(obb.center(), obb.axes(), points).half_extents();
        [
            ("box", all(&|point| bounds.contains(point))),
            ("sphere", all(&|point| sphere.contains(point))),
            ("capsule", swept(&capsule.core(), capsule.radius())),
            ("lozenge", swept(&lozenge.core(), lozenge.radius())),
            ("oriented box", (0..3).all(|k| reach[k] <= obb.half_extents()[k])),
            ("14-DOP", all(&|point| kdop14.certainly_contains(point))),
            ("18-DOP", all(&|point| kdop18.certainly_contains(point))),
            ("26-DOP", all(&|point| kdop26.certainly_contains(point))),
        ]
        .into_iter()
        .find_map(|(which, holds)| (!holds).then_some(which))
    }
}

impl fmt::Display for ProxyFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape => write!(f, "the bytes are not valid proxies: compute the proxies of this mesh again"),
            Self::Hull => {
                write!(f, "the hull is not the convex hull of the mesh: compute the proxies of this mesh again")
            }
            Self::Volume { which } => {
                write!(f, "the {which} does not enclose the mesh: compute the proxies of this mesh again")
            }
        }
    }
}

impl std::error::Error for ProxyFlaw {}
