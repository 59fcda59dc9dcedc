//! Boxes that are apart only along an edge-cross axis: the cross product of an edge of one box and
//! an edge of the other. Two long boxes that pass each other often overlap along all of their own
//! edges.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996 (Ericson, 4.4.1). There each pair of
//! boxes has axes of its own. Here all boxes of a tree have the same axes, so the nine edge-cross
//! axes form three frames for a whole query. Boxes are transformed into them as into any other
//! frame.
//!
//! Tests: `edge_cross/tests.rs`. Proof: docs/notes/proof.md, L2b.

use fearless_simd::Simd;

use super::box_map::BoxMap;
use super::lanes::overlapping_each;
use super::wide::Node;
use crate::math::vec3::dot;
use crate::simd::{by_axis, load3};

/// The three frames whose axes are edge-cross axes of the host's and the guest's boxes.
#[derive(Clone, Debug)]
pub(crate) struct EdgeCrossAxes {
    /// For each axis of the host: the map of the host's boxes into its frame, and the map of the
    /// guest's.
    frames: [[BoxMap; 2]; 3],
}

impl EdgeCrossAxes {
    /// Builds the frames for the map `linear · x + translation` from the guest to the host. The map
    /// is known up to `error` on each axis. The coordinates of all boxes are at most `reach` in
    /// magnitude.
    ///
    /// # Accuracy
    /// The edge-cross axes consist of entries of the map, without rounding. For the guest's boxes
    /// they are multiplied by the map in double precision. Each product and each sum is rounded
    /// once: less than eight units of the magnitude of the sums (docs/notes/proof.md, L2b).
    pub(crate) fn new(linear: &[[f64; 3]; 3], translation: &[f64; 3], error: f64, reach: f64) -> Self {
        const ROUNDING: f64 = 8.0 * f64::EPSILON;
        let frames = by_axis!(edge => {
            let (next, last) = ((edge + 1) % 3, (edge + 2) % 3);
            // The host's edge, crossed with the images of the guest's edges.
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

    /// Returns the pairs in `near` whose boxes are not proved apart along an edge-cross axis. Bit
    /// `h` of byte `g` stands for lane `h` of the host and lane `g` of the guest.
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
