//! The box of the bounding sphere around the pivot: the same size for every rotation.

use super::Realign;
use crate::exact::{image_down, image_up};
use crate::hull::validate_points;
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{dot, squared_distance};
use crate::volume::MinMax;

/// Maximum by which the squared length of a row may exceed 1 if the row is to count as part of a
/// rotation: 2^-40. Rows of rotations whose entries were each rounded to double precision stay well
/// below it. The radius is enlarged by this amount, so the box keeps its size under rotations.
const MAX_ROW_EXCESS: f64 = 4096.0 * f64::EPSILON;

/// A box around the sphere that is centered at the pivot and passes through the farthest point: way
/// (a) of the *Notes*.
///
/// Under a rotation only its center moves. If the pivot is the origin, only the translation moves
/// it.
///
/// Tests: `tests/it/realign`. Benchmark: `realign`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooseBox {
    pivot: [f64; 3],
    radius: f64,
}

impl LooseBox {
    /// Builds the box for points that rotate about a pivot. Points and pivot are in the local
    /// frame.
    ///
    /// # Errors
    /// Same as [`Hull::new`](crate::hull::Hull::new). The pivot is validated like a point; its
    /// index is the number of points.
    ///
    /// # Accuracy
    /// The radius exceeds the distance of the farthest point by at most 1e-12 of that distance plus
    /// 2^-530.
    pub fn new<T: Copy + Into<f64> + Sync>(points: &[[T; 3]], pivot: [f64; 3]) -> Result<Self, InputError> {
        validate_points(points)?;
        if let Err(error) = validate_points(&[pivot]) {
            let index = points.len();
            return Err(InputError::new(match *error.kind() {
                InputErrorKind::OutOfRange { what, limit, .. } => InputErrorKind::OutOfRange { what, index, limit },
                _ => InputErrorKind::NonFinite { what: "point", index },
            }));
        }
        let squared = points
            .iter()
            .fold(0.0, |squared: f64, point| squared.max(squared_distance(&point.map(Into::into), &pivot)));
        // A difference, its square, two sums and the root have an error of less than 5 units. A
        // square that underflows loses up to 2^-1075, so the root loses up to 2^-536.
        const UNDERFLOW_LOSS: f64 = f64::from_bits((1023 - 531) << 52);
        Ok(Self { pivot, radius: squared.sqrt() * (1.0 + MAX_ROW_EXCESS) + UNDERFLOW_LOSS })
    }

    /// Returns the radius of the sphere around the pivot, rounded up. It is the half-extent of the
    /// box under any rotation.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl Realign for LooseBox {
    /// # Accuracy
    /// If the rows of the pose have length 1, the half-extents are the radius. Under any other map
    /// the image of the sphere is an ellipsoid. Its half-extent on an axis is the radius times the
    /// length of the row, rounded up.
    #[inline]
    fn realign(&mut self, world_from_local: &Pose) -> MinMax {
        let half = world_from_local.linear().map(|row| {
            let squared = dot(&row, &row);
            if squared <= 1.0 + MAX_ROW_EXCESS {
                self.radius
            } else {
                // Squares, sums and the root have an error of 4 units at most, the product of one.
                self.radius * (squared.sqrt() * (1.0 + 8.0 * UNIT_ROUNDOFF))
            }
        });
        let min = [0, 1, 2].map(|axis| (image_down(world_from_local, axis, &self.pivot) - half[axis]).next_down());
        let max = [0, 1, 2].map(|axis| (image_up(world_from_local, axis, &self.pivot) + half[axis]).next_up());
        MinMax::from_ordered(min, max)
    }

    fn memory(&self) -> usize {
        size_of::<Self>()
    }
}
