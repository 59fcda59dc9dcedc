//! The corners of a polytope, and its facets for contacts, which are computed when they are first
//! needed.

use std::sync::{Arc, OnceLock};

use crate::convex::{Core, Facets};
use crate::hull::Hull;
use crate::simd::prefetch;

/// Corners of a few points or of a hull. Cloning them is fast.
#[derive(Clone, Debug)]
pub(super) enum Corners {
    Few(Arc<Faceted<Box<[[f64; 3]]>>>),
    /// The eight corners of a box about the origin, in the order of [`Core::Cuboid`].
    Cuboid(Arc<Faceted<Box<[[f64; 3]]>>>),
    Hull(Arc<Faceted<Arc<Hull>>>),
}

/// Corners with their facets.
#[derive(Debug)]
pub(super) struct Faceted<T> {
    corners: T,
    facets: OnceLock<Option<Facets>>,
}

impl<T> Faceted<T> {
    fn new(corners: T) -> Self {
        Self { corners, facets: OnceLock::new() }
    }
}

impl Corners {
    /// Returns the corners of points that are already validated.
    pub(super) fn few(points: &[[f64; 3]]) -> Self {
        Self::Few(Arc::new(Faceted::new(points.into())))
    }

    /// Returns the corners of a box about the origin. The half-extents must be validated.
    pub(super) fn cuboid(half_extents: [f64; 3]) -> Self {
        let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { half_extents[k] } else { -half_extents[k] });
        Self::Cuboid(Arc::new(Faceted::new(Box::new([0, 1, 2, 3, 4, 5, 6, 7].map(corner)))))
    }

    pub(super) fn hull(hull: Arc<Hull>) -> Self {
        Self::Hull(Arc::new(Faceted::new(hull)))
    }

    pub(super) fn core(&self) -> Core<'_> {
        match self {
            Self::Few(few) => Core::Points(&few.corners),
            Self::Cuboid(few) => Core::Cuboid(&few.corners),
            Self::Hull(hull) => Core::Hull(&hull.corners),
        }
    }

    /// Prefetches the pointer to the corners.
    pub(super) fn prefetch(&self) {
        match self {
            Self::Few(few) | Self::Cuboid(few) => prefetch(&few.corners),
            Self::Hull(hull) => prefetch(&hull.corners),
        }
    }

    pub(super) fn facets(&self) -> Option<&Facets> {
        match self {
            Self::Few(few) | Self::Cuboid(few) => few.facets.get_or_init(|| Facets::of_points(&few.corners)).as_ref(),
            Self::Hull(hull) => hull.facets.get_or_init(|| Some(Facets::of_hull(&hull.corners))).as_ref(),
        }
    }
}
