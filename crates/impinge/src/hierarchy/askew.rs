//! Boxes that pass each other askew: long ones overlap along every edge of either and are apart along a direction across an edge
//! of the one and an edge of the other.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996 (Ericson, 4.4.1). There each pair of boxes has axes of its own; here
//! all boxes of a tree have the same, so that the nine directions are three frames for a whole query, into which boxes are
//! carried like into any other.

use fearless_simd::Simd;

use super::box_map::BoxMap;
use super::lanes::overlapping_each;
use super::wide::Node;
use crate::math::vec3::dot;
use crate::simd::{by_axis, load3};

/// The frames whose axes are across an edge of the host's boxes and one of the guest's.
#[derive(Clone, Debug)]
pub(crate) struct Askew {
    /// For each axis of the host: what carries the host's boxes into the frame across it, and what carries the guest's.
    frames: [[BoxMap; 2]; 3],
}

impl Askew {
    /// For the map `linear · x + translation` from the guest into the host, known up to `error` on each axis, and boxes whose
    /// coordinates are at most `reach` in magnitude.
    ///
    /// # Accuracy
    /// A direction across two edges has the very numbers of the map. Where the guest's boxes are carried it meets the map in
    /// double precision, which rounds each product and each sum once: less than eight units of the sums' magnitude (docs/proof.md, L2b).
    pub(crate) fn new(linear: &[[f64; 3]; 3], translation: &[f64; 3], error: f64, reach: f64) -> Self {
        const ROUNDING: f64 = 8.0 * f64::EPSILON;
        let frames = by_axis!(edge => {
            let (next, last) = ((edge + 1) % 3, (edge + 2) % 3);
            // The host's edge along the one axis, crossed with the images of the guest's edges.
            let across: [[f64; 3]; 3] = by_axis!(from => {
                let mut direction = [0.0; 3];
                direction[next] = -linear[last][from];
                direction[last] = linear[next][from];
                direction
            });
            let turned = across.map(|a| by_axis!(from => dot(&a, &by_axis!(axis => linear[axis][from]))));
            let moved = across.map(|a| dot(&a, translation));
            let off = across.map(|a| {
                let a = a.map(f64::abs);
                let largest: [f64; 3] = by_axis!(axis => {
                    linear[axis].iter().map(|x| x.abs()).sum::<f64>() * reach + translation[axis].abs()
                });
                dot(&a, &largest.map(|size| error + ROUNDING * size))
            });
            [BoxMap::new(&across, &[0.0; 3], &[0.0; 3], reach), BoxMap::new(&turned, &moved, &off, reach)]
        });
        Self { frames }
    }

    /// Of the pairs of boxes that are `near`, those that are not proved apart: in byte `g` bit `h` for lane `g` of the guest's and
    /// `h` of the host's.
    #[inline(always)]
    pub(crate) fn near<S: Simd>(&self, simd: S, host: &Node, guest: &Node, mut near: u64) -> u64 {
        for [of_host, of_guest] in &self.frames {
            if near == 0 {
                break;
            }
            let host = of_host.apply(simd, host);
            let host = (&load3(simd, &host.min), &load3(simd, &host.max));
            near &= overlapping_each(simd, host, &of_guest.apply(simd, guest));
        }
        near
    }
}

#[cfg(test)]
mod tests;
