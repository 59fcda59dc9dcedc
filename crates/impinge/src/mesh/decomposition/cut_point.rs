//! Points at which planes cut a mesh: rounded positions with bounds on their errors.
//!
//! Proof: docs/notes/proof.md, L38. Guarded by `tests/it/solids/decomposition.rs`.

use super::frame::{CutPlane, Frame};
use crate::math::relative::UNIT_ROUNDOFF;
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

/// Returns the point at which the edge between two points crosses a plane. If the exact points are
/// on the same side of the plane, which inexact sides permit, it returns a bound for one of them.
///
/// # Accuracy
/// Let s and s' be the exact sides and t = s / (s - s') the exact parameter. With an error of at
/// most e in both sides and with rounding, the computed t differs by at most e / (|s - s'| - 2e) +
/// 4 u. The point (1 - t) a + t b then differs by at most the larger error of a and b, the error of
/// t times |b - a|, and 8 u of the larger magnitude.
pub(super) fn crossing(
    frame: &Frame,
    plane: CutPlane,
    (a, side_a): (&CutPoint, Side),
    (b, side_b): (&CutPoint, Side),
) -> CutPoint {
    let span = side_a.value - side_b.value;
    let error = side_a.error.max(side_b.error) + 2.0 * UNIT_ROUNDOFF * span.abs();
    let (t, spread) = if span.abs() > 4.0 * error {
        ((side_a.value / span).clamp(0.0, 1.0), error / (span.abs() - 2.0 * error) + 4.0 * UNIT_ROUNDOFF)
    } else {
        (0.5, 0.5)
    };
    let is_crossed = (side_a.is_above() && side_b.is_below()) || (side_a.is_below() && side_b.is_above());
    let mut point = CutPoint::exact(a.at);
    for k in 0..3 {
        let (from, to) = (a.at[k], b.at[k]);
        let inherited = a.error[k].max(b.error[k]);
        if frame.is_standard && k == plane.axis && is_crossed {
            point.at[k] = plane.offset;
        } else if from != to || inherited > 0.0 {
            point.at[k] = from + t * (to - from);
            let rounding = 8.0 * UNIT_ROUNDOFF * from.abs().max(to.abs()) + f64::MIN_POSITIVE;
            point.error[k] = (inherited + spread * (to - from).abs()) * (1.0 + 8.0 * UNIT_ROUNDOFF) + rounding;
        }
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_along_an_axis_are_cut_exactly() {
        let (a, b) = (CutPoint::exact([0.0, 1.0, 2.0]), CutPoint::exact([7.0, 1.0, 2.0]));
        let plane = CutPlane { axis: 0, offset: 1.0 / 3.0 };
        let sides = [&a, &b].map(|point| Frame::STANDARD.side(plane, point));
        let found = crossing(&Frame::STANDARD, plane, (&a, sides[0]), (&b, sides[1]));
        assert_eq!((found.at, found.is_exact()), ([1.0 / 3.0, 1.0, 2.0], true));
    }
}
