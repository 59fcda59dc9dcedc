//! What is said about the distance of two things.

use super::Proximity;
use crate::convex::Separation;

/// How far apart two things are, with what was proved about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// No two points of the two are nearer to each other than this, in world units.
    pub lower: f64,
    /// Some two points are no farther apart than this: zero if a common point is proved, infinite if a mesh is empty.
    pub upper: f64,
    /// Where the two are nearest; absent if a mesh is empty, or if one lies inside the other, a solid mesh, without touching its
    /// surface.
    pub witness: Option<Witness>,
    /// Whether the two are apart, as [`proximity`](super::proximity) tells.
    pub proximity: Proximity,
}

/// Nearest points of two things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// A point of the first, in the world frame, rounded.
    pub point_a: [f64; 3],
    /// A point of the second, in the world frame, rounded.
    pub point_b: [f64; 3],
    /// The faces that the points are on, one of either mesh; absent if one of the two is a shape.
    pub faces: Option<[u32; 2]>,
}

impl Distance {
    /// The distance: zero exactly if [`intersects`](super::intersects) is true, else [`upper`](Self::upper).
    #[must_use]
    pub fn distance(&self) -> f64 {
        if self.proximity == Proximity::Apart { self.upper } else { 0.0 }
    }

    /// The nearest points, of the first and of the second, in the world frame, rounded; absent as [`witness`](Self::witness) is.
    #[must_use]
    pub fn points(&self) -> Option<[[f64; 3]; 2]> {
        self.witness.map(|witness| [witness.point_a, witness.point_b])
    }
}

impl From<Separation> for Distance {
    fn from(found: Separation) -> Self {
        let Separation { lower, upper, points: [point_a, point_b], proximity } = found;
        // Nothing is near an empty mesh.
        let witness = upper.is_finite().then_some(Witness { point_a, point_b, faces: None });
        Self { lower, upper, witness, proximity }
    }
}
