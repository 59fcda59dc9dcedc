//! The answer of a distance query.

use super::Proximity;
use crate::convex::Separation;

/// Distance of two things, as an interval that is proved to hold the true distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Lower bound of the distance, in world units. It is zero if the things intersect or may
    /// intersect, and infinite if a mesh is empty.
    pub lower: f64,
    /// Upper bound of the distance, in world units. It is zero if a common point is proved, and
    /// infinite if a mesh is empty.
    pub upper: f64,
    /// Nearest points of the two things. Absent if a mesh is empty, or if one of two meshes lies
    /// inside the other, a solid, without touching its surface.
    pub witness: Option<Witness>,
    /// Verdict whether the two things intersect, as [`proximity`](super::proximity()) returns it.
    pub proximity: Proximity,
}

/// Nearest points of two things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// Point of the first thing in the world frame, each coordinate rounded.
    pub point_a: [f64; 3],
    /// Point of the second thing in the world frame, each coordinate rounded.
    pub point_b: [f64; 3],
    /// Indices of the faces that the points lie on: a face of the first mesh, then a face of the
    /// second. Absent if one of the things is a shape.
    pub faces: Option<[u32; 2]>,
}

impl Distance {
    /// Returns the distance in world units: zero if and only if [`intersects`](super::intersects())
    /// returns `true`, otherwise [`upper`](Self::upper).
    #[must_use]
    pub fn distance(&self) -> f64 {
        if self.proximity == Proximity::Apart { self.upper } else { 0.0 }
    }

    /// Returns the nearest points of the first and of the second thing, in the world frame,
    /// rounded. Returns `None` if [`witness`](Self::witness) is absent.
    #[must_use]
    pub fn points(&self) -> Option<[[f64; 3]; 2]> {
        self.witness.map(|witness| [witness.point_a, witness.point_b])
    }
}

impl From<Separation> for Distance {
    fn from(found: Separation) -> Self {
        let Separation { lower, upper, points: [point_a, point_b], proximity } = found;
        // An empty mesh has no nearest point.
        let witness = upper.is_finite().then_some(Witness { point_a, point_b, faces: None });
        Self { lower, upper, witness, proximity }
    }
}
