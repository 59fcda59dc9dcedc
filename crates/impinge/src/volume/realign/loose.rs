//! The box of the bounding sphere about the pivot: the same size for every rotation.

use super::Realign;
use crate::exact::{image_down, image_up};
use crate::hull::judge;
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{dot, squared_distance};
use crate::volume::MinMax;

/// By how much a row of a pose may be longer than 1, squared, to count as one of a rotation: 2^-40, which entries that were
/// each rounded to double precision stay well below. The radius is enlarged by that, so that the box keeps its size.
const ROTATION: f64 = 4096.0 * f64::EPSILON;

/// Way (a) of the *Notes*: a box that bounds the sphere about the pivot through the farthest point.
///
/// Under a rotation only its centre moves, and where the pivot is the origin only by the translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooseBox {
    pivot: [f64; 3],
    radius: f64,
}

impl LooseBox {
    /// For points that turn about a pivot, given in their frame.
    ///
    /// # Errors
    /// As [`Hull::new`](crate::hull::Hull::new), the pivot being judged like a point, as the one after the last.
    ///
    /// # Accuracy
    /// The radius exceeds the distance of the farthest point by at most 1e-12 of it and 2^-530.
    pub fn new<T: Copy + Into<f64> + Sync>(points: &[[T; 3]], pivot: [f64; 3]) -> Result<Self, InputError> {
        judge(points)?;
        if let Err(error) = judge(&[pivot]) {
            let index = points.len();
            return Err(InputError::new(match *error.kind() {
                InputErrorKind::OutOfRange { what, limit, .. } => InputErrorKind::OutOfRange { what, index, limit },
                _ => InputErrorKind::NonFinite { what: "point", index },
            }));
        }
        let squared = points
            .iter()
            .fold(0.0, |squared: f64, point| squared.max(squared_distance(&point.map(Into::into), &pivot)));
        // A difference, its square, two sums and the root are off by less than 5 units; squares that vanish lose 2^-1075
        // each, so the root 2^-536.
        const LOST: f64 = f64::from_bits((1023 - 531) << 52);
        Ok(Self { pivot, radius: squared.sqrt() * (1.0 + ROTATION) + LOST })
    }

    /// The radius of the sphere, as it is for rotations.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl Realign for LooseBox {
    /// # Accuracy
    /// Rows of length 1 give the radius as half-extent. The image of the sphere under any other map is an ellipsoid whose
    /// half-extent on an axis is the radius times the length of the row, rounded up.
    #[inline]
    fn realign(&mut self, world_from_local: &Pose) -> MinMax {
        let half = world_from_local.linear().map(|row| {
            let squared = dot(&row, &row);
            if squared <= 1.0 + ROTATION {
                self.radius
            } else {
                // Squares, sums and the root: 4 units at most, and one for the product.
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
