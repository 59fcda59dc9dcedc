//! The box of the turned box, one at a time or many.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

use super::Realign;
use crate::math::Pose;
use crate::math::relative::{UNDERFLOW, UNIT_ROUNDOFF};
use crate::simd::{best_level, by_axis, dispatch};
use crate::volume::MinMax;

/// Units of relative rounding that the half-extents are enlarged by: 6 are needed, see [`RotatedBox::new`].
const ROUNDING: f64 = 8.0 * UNIT_ROUNDOFF;

/// Way (d) of the *Notes*: the box of the box that was built, under the present pose.
///
/// It is always the *original* box that is turned. Boxes of boxes grow with each turn, by up to √3 in length.
///
/// # Source
/// Arvo, *Transforming axis-aligned bounding boxes*, Graphics Gems 1990, in the centre and half-extents form (Ericson, 4.2.6):
/// 18 products for any form of box. Example 2.2.3 of the *Notes* takes the extent of x in all three terms; term j takes
/// that of coordinate j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotatedBox {
    centre: [f64; 3],
    /// Half-extents, enlarged by what rounding may cost any image.
    half_extents: [f64; 3],
}

impl RotatedBox {
    /// For what is in this box, in the local frame.
    ///
    /// # Accuracy
    /// On an axis let `C` be the exact centre of the image and `H` its exact half-extent, `Σ |r_k| e_k`, and let u = 2^-53. The
    /// computed centre is off by at most 4 u `Σ |r_k| |c_k|` and u `|t|`; the computed half-extent falls short of the true
    /// sum by 4 u of it; the last sum and difference round by u of both. So 6 u of `Σ |r_k| (|c_k| + e_k) + |t|` are enough,
    /// up to terms in u²: 8 u of `|c_k| + e_k` are part of each half-extent from the start, and 8 u `|t|` and 2^-1070, for
    /// products that underflow, are added to the image's.
    #[must_use]
    pub fn new(bounds: &MinMax) -> Self {
        let (min, max) = (bounds.min(), bounds.max());
        let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]);
        let half_extents = std::array::from_fn(|k| {
            let half = (max[k] - centre[k]).max(centre[k] - min[k]).next_up();
            (half + ROUNDING * (centre[k].abs() + half)).next_up()
        });
        Self { centre, half_extents }
    }

    /// Many boxes that move as one.
    ///
    /// The boxes of `images`, which are as [`realign`](Realign::realign) makes them one by one, replace what it held.
    pub fn realign_all(boxes: &[Self], world_from_local: &Pose, images: &mut Vec<MinMax>) {
        images.resize(boxes.len(), ORIGIN);
        dispatch!(best_level(), simd => {
            let columns = Columns::new(simd, world_from_local);
            for (image, one) in images.iter_mut().zip(boxes) {
                *image = columns.image(simd, one);
            }
        });
    }

    /// Many boxes, each with its own pose; as many images as there are of both.
    ///
    /// The boxes of `images`, which are as [`realign`](Realign::realign) makes them one by one, replace what it held.
    pub fn realign_each(boxes: &[Self], world_from_locals: &[Pose], images: &mut Vec<MinMax>) {
        images.resize(boxes.len().min(world_from_locals.len()), ORIGIN);
        // No vector unit: bringing one pose into lanes takes longer than its sums do.
        for ((image, one), world_from_local) in images.iter_mut().zip(boxes).zip(world_from_locals) {
            *image = one.image(world_from_local);
        }
    }

    #[inline(always)]
    fn image(&self, world_from_local: &Pose) -> MinMax {
        let (rows, translation) = (world_from_local.linear(), world_from_local.translation());
        let (c, e) = (&self.centre, &self.half_extents);
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let [x, y, z] = rows[axis];
            let t = translation[axis];
            let centre = x * c[0] + y * c[1] + z * c[2] + t;
            let half = x.abs() * e[0] + y.abs() * e[1] + z.abs() * e[2] + (t.abs() * ROUNDING + UNDERFLOW);
            (min[axis], max[axis]) = (centre - half, centre + half);
        }
        MinMax::from_ordered(min, max)
    }
}

/// What images are before they are computed.
const ORIGIN: MinMax = MinMax::from_ordered([0.0; 3], [0.0; 3]);

/// A pose with a lane for each axis of the world; the fourth is idle.
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

    /// The sums of [`RotatedBox::image`] in its order, so that the bits are the same.
    #[inline(always)]
    fn image(&self, simd: S, one: &RotatedBox) -> MinMax {
        let [c0, c1, c2]: [f64x4<S>; 3] = by_axis!(k => self.columns[k] * f64x4::splat(simd, one.centre[k]));
        let [e0, e1, e2]: [f64x4<S>; 3] = by_axis!(k => self.magnitudes[k] * f64x4::splat(simd, one.half_extents[k]));
        let centre = c0 + c1 + c2 + self.translation;
        let half = e0 + e1 + e2 + self.slack;
        let (mut min, mut max) = ([0.0; 4], [0.0; 4]);
        (centre - half).store_slice(&mut min);
        (centre + half).store_slice(&mut max);
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
