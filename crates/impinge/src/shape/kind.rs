//! A shape and its contents.

use std::sync::Arc;

use super::corners::Corners;
use crate::convex::{Support, Turned};
use crate::math::Pose;
use crate::mesh::{HeightField, Mesh};

/// A shape in its own frame. Cloning it is fast, because copies share their memory.
///
/// A shape that exists is valid: its numbers were validated when it was made. [`at`](Self::at)
/// places it in the world, and [`query`](crate::query) compares placed shapes.
///
/// ```
/// use impinge::{Pose, Shape, query};
///
/// let crate_ = Shape::cuboid([1.0, 1.0, 1.0])?.at(Pose::IDENTITY)?;
/// let pill = Shape::capsule([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.5)?;
/// assert!(query::intersects(&crate_, &pill.at(Pose::from_translation([1.5, 0.0, 0.0])?)?)); // they touch
/// assert_eq!(query::distance(&crate_, &pill.at(Pose::from_translation([2.5, 0.0, 0.0])?)?).upper.round(), 1.0);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Shape(pub(super) Kind);

/// Contents of a shape.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// A polytope without a radius. Any affine map takes it to another polytope.
    Polytope(Corners),
    /// A round shape, for which only a rigid motion gives a shape of the same kind.
    Round { core: RoundCore, radius: f64 },
    /// The half-space {v : normal·v ≤ level}.
    HalfSpace { normal: [f64; 3], level: f64 },
    /// A height field, as its surface.
    Field(HeightField),
    /// A mesh, as its surface or as a solid.
    Mesh { mesh: Mesh, is_solid: bool },
    /// Parts with their poses in the frame of the compound. No part is a compound itself.
    Compound(Arc<[(Shape, Pose)]>),
}

/// Core of a round shape.
#[derive(Clone, Debug)]
pub(super) enum RoundCore {
    Polytope(Corners),
    Turned(Turned),
    Curved(Arc<dyn Support>),
}
