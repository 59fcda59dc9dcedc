//! Whether proxies that somebody else made hold the points that they are said to stand for.

use std::fmt;

use rayon::prelude::*;

use super::{Proxies, Volumes};
use crate::volume::core::Core;
use crate::volume::{BoundingVolume, Obb, round};

/// Corners of a hull that a thread takes at a time.
const CHUNK: usize = 1 << 10;

/// Why bytes are not the proxies of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProxyFlaw {
    /// The bytes are no hull and volumes at all, or the hull has a vertex that no face of the mesh has.
    Shape,
    /// The hull is not that of the mesh: it is not convex, or does not hold each vertex, or has one that is not extreme.
    Hull,
    /// A volume does not hold the hull.
    Volume {
        /// Which one.
        which: &'static str,
    },
}

impl Proxies {
    /// Whether the hull is that of its own vertices and these points, and each volume holds it.
    ///
    /// # Errors
    /// What is wrong first.
    ///
    /// # Complexity
    /// That of [`Hull::is_of`](crate::hull::Hull::is_of), on all cores of the current rayon pool, and a pass over the hull's corners.
    pub(crate) fn validate(&self, others: &[[f64; 3]]) -> Result<(), ProxyFlaw> {
        if !self.hull.is_of(others) {
            return Err(ProxyFlaw::Hull);
        }
        let corners = self.hull.positions();
        // Of what is convex the corners decide.
        let strangers: Vec<&'static str> =
            corners.par_chunks(CHUNK).filter_map(|chunk| self.volumes.one_that_misses(chunk)).collect();
        match strangers.into_iter().min() {
            Some(which) => Err(ProxyFlaw::Volume { which }),
            None => Ok(()),
        }
    }
}

impl Volumes {
    /// A volume that is not proved to hold these points, if there is one.
    fn one_that_misses(&self, points: &[[f64; 3]]) -> Option<&'static str> {
        let Self { bounds, sphere, capsule, lozenge, obb, kdop14, kdop18, kdop26 } = self;
        // NaN, which comes of nothing in range, would prove nothing.
        let swept =
            |core: &Core, radius: f64| points.iter().all(|&point| round::distance_to_core(point, core) <= radius);
        let all = |holds: &dyn Fn([f64; 3]) -> bool| points.iter().all(|&point| holds(point));
        let reach = Obb::about(obb.centre(), obb.axes(), points).half_extents();
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
            Self::Shape => write!(f, "the proxies are no hull and volumes"),
            Self::Hull => write!(f, "the hull is not that of the mesh"),
            Self::Volume { which } => write!(f, "the {which} does not hold the mesh"),
        }
    }
}

impl std::error::Error for ProxyFlaw {}
