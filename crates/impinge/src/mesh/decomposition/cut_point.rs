//! Points at which planes cut a mesh: rounded positions with bounds on their errors.
//!
//! Proof: docs/notes/proof.md, L38. Guarded by `tests/it/solids/decomposition.rs`.

use crate::math::vec3::Vector;

/// A rounded position of a point, in the mesh frame. The exact point differs from it by at most
/// `error` along each axis of the mesh frame. Vertices of the mesh have no error.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutPoint {
    pub(super) at: Vector,
    pub(super) error: Vector,
}

/// Signed distance of a point from a plane, in units of the length of its axis, with a bound on its
/// error. Positive values are above the plane. If the bound is zero, the sign is exact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) value: f64,
    pub(super) error: f64,
}

impl Side {
    /// Reports whether the exact point is proved to be above the plane.
    pub(super) fn is_above(self) -> bool {
        self.value > self.error
    }

    /// Reports whether the exact point is proved to be below the plane.
    pub(super) fn is_below(self) -> bool {
        self.value < -self.error
    }

    /// Reports whether the exact point is proved to be on the plane.
    pub(super) fn is_on(self) -> bool {
        self.value == 0.0 && self.error == 0.0
    }

    /// Returns the same distance with the other sign.
    pub(super) fn flipped(self) -> Self {
        Self { value: -self.value, ..self }
    }

    /// Reports whether the side is not decided, or on the plane only up to rounding.
    fn is_inexact(self) -> bool {
        !self.is_above() && !self.is_below() && self.error > 0.0
    }
}

impl CutPoint {
    /// Returns a point without error.
    pub(super) fn exact(at: Vector) -> Self {
        Self { at, error: [0.0; 3] }
    }

    /// Reports whether the position has no error.
    pub(super) fn is_exact(&self) -> bool {
        self.error == [0.0; 3]
    }

    /// Iterates over the corners of a box that contains the exact point. A corner may occur twice.
    pub(super) fn corners(&self) -> impl Iterator<Item = Vector> + use<> {
        let Self { at, error } = *self;
        (0..8).map(move |corner| {
            std::array::from_fn(|k| {
                if error[k] == 0.0 {
                    at[k]
                } else if corner >> k & 1 == 0 {
                    (at[k] - error[k]).next_down()
                } else {
                    (at[k] + error[k]).next_up()
                }
            })
        })
    }
}

/// Reports whether the edge from a point below a plane to another point needs a point on the plane:
/// the other point is above, or may be.
pub(super) fn crosses(below: Side, other: Side) -> bool {
    below.is_below() && (other.is_above() || other.is_inexact())
}
