//! The pose of a shape in the world, with the bounds that follow from it.

use crate::math::Pose;

/// Pose of a shape, and the values that follow from it. The parts of a compound have poses of their
/// own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stand {
    pub(super) world_from_local: Pose,
    /// Radius of a sphere that the image of the shape's sphere contains, and of a sphere that
    /// contains the image.
    pub(super) radius: [f64; 2],
    /// Box that contains the shape, or the plane of a half-space.
    pub(super) bounds: Bounds,
}

/// Bounds of a shape in the world frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bounds {
    /// A box that contains the shape.
    Box([[f64; 3]; 2]),
    /// The plane of a half-space: its direction, and its level along it.
    Plane([f64; 3], f64),
    /// Nothing: the shape contains a half-space, or it is empty.
    Unknown,
}

impl Bounds {
    pub(super) fn of(bounds: Option<[[f64; 3]; 2]>) -> Self {
        bounds.map_or(Self::Unknown, Self::Box)
    }
}

impl Default for Stand {
    fn default() -> Self {
        Self::at(Pose::IDENTITY)
    }
}

impl Stand {
    /// Returns a pose without the values that follow from it.
    pub(super) fn at(world_from_local: Pose) -> Self {
        Self { world_from_local, radius: [0.0; 2], bounds: Bounds::Unknown }
    }

    pub(crate) fn world_from_local(&self) -> &Pose {
        &self.world_from_local
    }

    /// Returns the box of the shape, as [`PlacedShape::bounds`](super::PlacedShape::bounds) does.
    pub(crate) fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        match self.bounds {
            Bounds::Box(bounds) => Some(bounds),
            Bounds::Plane(..) | Bounds::Unknown => None,
        }
    }
}
