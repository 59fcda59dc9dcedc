//! The axis-aligned box around a box that a pose has rotated, for one box or many.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

use super::Realign;
use crate::math::Pose;
use crate::math::relative::{UNDERFLOW, UNIT_ROUNDOFF};
use crate::simd::{best_level, by_axis, dispatch};
use crate::volume::MinMax;

/// Relative rounding error by which the half-extents are enlarged: 8 units. 6 are needed, see
/// [`RotatedBox::new`].
const ROUNDING: f64 = 8.0 * UNIT_ROUNDOFF;

/// The axis-aligned box around the rotated box of an object: way (d) of the *Notes*.
///
/// It is always the *original* box that is rotated. Boxes of boxes grow with each rotation, by up
/// to √3 in length.
///
/// # Source
/// Arvo, *Transforming axis-aligned bounding boxes*, Graphics Gems 1990, in the center and
/// half-extents form (Ericson, 4.2.6): 18 products for any form of box. Example 2.2.3 of the
/// *Notes* takes the extent of x in all three terms, which is wrong: term j takes that of
/// coordinate j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotatedBox {
    center: [f64; 3],
    /// Half-extents, enlarged by the rounding error that any image may have.
    half_extents: [f64; 3],
}

impl RotatedBox {
    /// Prepares a box given in the local frame.
    ///
    /// # Accuracy
    /// Let c and e be the center and the half-extents of the box. For one axis of the world let r
    /// be the row of the pose's matrix, t the translation, and u = 2^-53. The exact half-extent of
    /// the image is `Σ |r_k| e_k`. The computed center has an error of at most 4 u `Σ |r_k| |c_k|`
    /// plus u `|t|`. The computed half-extent is below the true sum by at most 4 u of it. The last
    /// sum and difference round by u of both. So 6 u of `Σ |r_k| (|c_k| + e_k) + |t|` are enough,
    /// up to terms in u². Each half-extent therefore includes 8 u of `|c_k| + e_k` from the start.
    /// The image adds 8 u `|t|`, and 2^-1070 for products that underflow.
    #[must_use]
    pub fn new(bounds: &MinMax) -> Self {
        let (min, max) = (bounds.min(), bounds.max());
        let center: [f64; 3] = std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]);
        let half_extents = std::array::from_fn(|k| {
            let half = (max[k] - center[k]).max(center[k] - min[k]).next_up();
            (half + ROUNDING * (center[k].abs() + half)).next_up()
        });
        Self { center, half_extents }
    }

    /// Computes for each box, under one pose, an axis-aligned box in the world frame that encloses
    /// it. The results replace the contents of `images`.
    ///
    /// The results are the same bits that [`realign`](Realign::realign) returns for each box.
    pub fn realign_all(boxes: &[Self], world_from_local: &Pose, images: &mut Vec<MinMax>) {
        images.resize(boxes.len(), PLACEHOLDER);
        dispatch!(best_level(), simd => {
            let columns = Columns::new(simd, world_from_local);
            for (image, one) in images.iter_mut().zip(boxes) {
                *image = columns.image(simd, one);
            }
        });
    }

    /// Computes for each box, under its own pose, an axis-aligned box in the world frame that
    /// encloses it. The results replace the contents of `images`. Surplus boxes or poses are
    /// ignored.
    ///
    /// The results are the same bits that [`realign`](Realign::realign) returns for each box.
    pub fn realign_each(boxes: &[Self], world_from_locals: &[Pose], images: &mut Vec<MinMax>) {
        images.resize(boxes.len().min(world_from_locals.len()), PLACEHOLDER);
        // No vector unit: loading one pose into lanes takes longer than its sums do.
        for ((image, one), world_from_local) in images.iter_mut().zip(boxes).zip(world_from_locals) {
            *image = one.image(world_from_local);
        }
    }

    #[inline(always)]
    fn image(&self, world_from_local: &Pose) -> MinMax {
        let (rows, translation) = (world_from_local.linear(), world_from_local.translation());
        let (c, e) = (&self.center, &self.half_extents);
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let [x, y, z] = rows[axis];
            let t = translation[axis];
            let center = x * c[0] + y * c[1] + z * c[2] + t;
            let half = x.abs() * e[0] + y.abs() * e[1] + z.abs() * e[2] + (t.abs() * ROUNDING + UNDERFLOW);
            (min[axis], max[axis]) = (center - half, center + half);
        }
        MinMax::from_ordered(min, max)
    }
}

/// Placeholder for images that are not yet computed.
const PLACEHOLDER: MinMax = MinMax::from_ordered([0.0; 3], [0.0; 3]);

/// A pose with one lane for each axis of the world; the fourth lane is unused.
struct Columns<S: Simd> {
    columns: [f64x4<S>; 3],
    magnitudes: [f64x4<S>; 3],
    translation: f64x4<S>,
    slack: f64x4<S>,
}

impl<S: Simd> Columns<S> {
    #[inline(always)]
    fn new(simd: S, world_from_local: &Pose) -> Self {
        let (rows, t) = (world_from_local.linear(), world_from_local.translation());
        let columns: [f64x4<S>; 3] = by_axis!(k => f64x4::from_slice(simd, &[rows[0][k], rows[1][k], rows[2][k], 0.0]));
        let translation = f64x4::from_slice(simd, &[t[0], t[1], t[2], 0.0]);
        let slack = translation.abs() * f64x4::splat(simd, ROUNDING) + f64x4::splat(simd, UNDERFLOW);
        Self { columns, magnitudes: by_axis!(k => columns[k].abs()), translation, slack }
    }

    /// Computes the sums of [`RotatedBox::image`] in the same order, so the bits are the same.
    #[inline(always)]
    fn image(&self, simd: S, one: &RotatedBox) -> MinMax {
        let [c0, c1, c2]: [f64x4<S>; 3] = by_axis!(k => self.columns[k] * f64x4::splat(simd, one.center[k]));
        let [e0, e1, e2]: [f64x4<S>; 3] = by_axis!(k => self.magnitudes[k] * f64x4::splat(simd, one.half_extents[k]));
        let center = c0 + c1 + c2 + self.translation;
        let half = e0 + e1 + e2 + self.slack;
        let (mut min, mut max) = ([0.0; 4], [0.0; 4]);
        (center - half).store_slice(&mut min);
        (center + half).store_slice(&mut max);
        MinMax::from_ordered([min[0], min[1], min[2]], [max[0], max[1], max[2]])
    }
}

impl Realign for RotatedBox {
    #[inline]
    fn realign(&mut self, world_from_local: &Pose) -> MinMax {
        self.image(world_from_local)
    }

    fn memory(&self) -> usize {
        size_of::<Self>()
    }
}
