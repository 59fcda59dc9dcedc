//! Rounded shapes: the Minkowski sum of a convex shape and a sphere.

use super::constructors::check_lengths;
use super::kind::{Kind, RoundCore, Shape};
use crate::input::{InputError, InputErrorKind};

impl Shape {
    /// Returns this shape grown by a radius on all sides: the points within `radius` of it, which
    /// is its Minkowski sum with a sphere. So its edges and corners become round. The shape must be
    /// bounded and convex. A radius of zero returns the same shape.
    ///
    /// A sphere and a capsule get a larger radius, and so does a shape that is already rounded; the
    /// sum of two radii is rounded to the nearest float. To keep the outer size of a box, make its
    /// half-extents shorter by the radius first.
    ///
    /// ```
    /// use impinge::{Pose, Shape, query};
    ///
    /// let die = Shape::cuboid([0.75; 3])?.rounded(0.25)?.at(Pose::IDENTITY)?;
    /// assert!(query::intersects(&die, &Shape::point([1.0, 0.5, 0.0])?.at(Pose::IDENTITY)?));
    /// assert!(!query::intersects(&die, &Shape::point([1.0; 3])?.at(Pose::IDENTITY)?)); // its corner is round
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Accuracy
    /// Whether two rounded polytopes intersect or are within a distance is decided exactly if their
    /// poses are exactly orthogonal, as for spheres: the squared distance of the cores is compared
    /// with the square of the sum of the radii (docs/notes/proof.md, L21). The test is
    /// `tests/it/shapes/rounded.rs`.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere), also if the sum of two radii is out of range, and
    /// [`NotRoundable`](InputErrorKind::NotRoundable) for a half-space, a mesh, a height
    /// field or a compound.
    pub fn rounded(&self, radius: f64) -> Result<Self, InputError> {
        check_lengths("radius", &[radius])?;
        let refused = |what, hint| Err(InputError::new(InputErrorKind::NotRoundable { what }).with_hint(hint));
        let kind = match &self.0 {
            Kind::Polytope(_) if radius == 0.0 => self.0.clone(),
            Kind::Polytope(corners) => Kind::Round { core: RoundCore::Polytope(corners.clone()), radius },
            Kind::Round { core, radius: own } => {
                check_lengths("radius", &[own + radius])?;
                Kind::Round { core: core.clone(), radius: own + radius }
            }
            Kind::HalfSpace { .. } => return refused("half-space", "increase its level instead"),
            Kind::Field(_) => return refused("height field", "ask whether it is within a distance"),
            Kind::Mesh { .. } => return refused("mesh", "ask whether it is within a distance, or round its hull"),
            Kind::Compound(_) => return refused("compound", "round its parts before they are joined"),
        };
        Ok(Self(kind))
    }
}
