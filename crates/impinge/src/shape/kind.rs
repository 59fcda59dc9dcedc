//! A shape and what it is made of.

use std::sync::Arc;

use super::corners::Corners;
use crate::convex::Support;
use crate::math::Pose;
use crate::mesh::Mesh;

/// A shape in its own frame; cheap to clone.
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

/// What a shape is made of.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// A polytope without a radius, which any affine map takes to another.
    Polytope(Corners),
    /// What only a rigid motion takes to its like.
    Round { core: RoundCore, radius: f64 },
    /// {v : normal·v ≤ level}.
    HalfSpace { normal: [f64; 3], level: f64 },
    /// Triangles, and what they wind round if it is solid.
    Mesh { mesh: Mesh, is_solid: bool },
    /// Shapes that are none of these themselves, and where they are.
    Compound(Arc<[(Shape, Pose)]>),
}

/// The core of a round shape.
#[derive(Clone, Debug)]
pub(super) enum RoundCore {
    Few(Corners),
    Curved(Arc<dyn Support>),
}
