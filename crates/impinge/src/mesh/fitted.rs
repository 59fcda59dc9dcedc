//! What a refit keeps of the leaves of a patch while the nodes above them are fitted: their corners, and the slab about some leaves.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::frame::PACKING_ERROR;
use super::leaf::{Leaf, heights_by_lane};
use super::packet::{CornerLanes, NO_CORNERS, lay_side_by_side};
use crate::hierarchy::{HALF_ULP, Slab};
use crate::simd::{Lanes3, by_axis, load3};

/// A leaf that was fitted.
#[derive(Clone, Copy)]
pub(super) struct Fitted {
    corners: CornerLanes,
    anchor: [f64; 3],
    facing: [f32; 3],
    radius: f32,
}

impl Fitted {
    /// Not yet.
    pub(super) const NONE: Self = Self { corners: NO_CORNERS, anchor: [0.0; 3], facing: [0.0; 3], radius: 0.0 };

    #[inline(always)]
    pub(super) fn keep<S: Simd>(&mut self, leaf: &Leaf, corners: &[Lanes3<S>; 3], anchor: [f64; 3]) {
        lay_side_by_side(corners, &mut self.corners);
        (self.anchor, self.facing, self.radius) = (anchor, leaf.normal(), leaf.radius);
    }
}

/// The slab about some leaves, across the mean of the directions in which they face.
///
/// # Accuracy
/// With u = 2^-24 and r the greatest radius, a corner's height about its anchor is off by 3 (u r + [`PACKING_ERROR`]) for the
/// corner, and 20 u r for its five roundings; an anchor's, of at most 3, by 3 u for its rounding to single precision, and by as
/// much again where the two are added up.
#[inline(always)]
pub(super) fn slab<S: Simd>(simd: S, leaves: &[Fitted]) -> Slab {
    let mut sum = [0.0_f32; 3];
    let mut radius = 0.0_f32;
    for leaf in leaves {
        for axis in 0..3 {
            sum[axis] += leaf.facing[axis];
        }
        radius = radius.max(leaf.radius);
    }
    let largest = sum.iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
    if largest == 0.0 {
        return Slab::ALL;
    }
    let normal = sum.map(|x| x / largest);
    let [x, y, z] = normal.map(f64::from);
    let (mut min, mut max) = (f32x8::splat(simd, f32::INFINITY), f32x8::splat(simd, f32::NEG_INFINITY));
    for leaf in leaves {
        let corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &leaf.corners[corner]));
        let [low, high] = heights_by_lane(simd, &corners, normal);
        let anchor = f32x8::splat(simd, (x * leaf.anchor[0] + y * leaf.anchor[1] + z * leaf.anchor[2]) as f32);
        min = min.min(low + anchor);
        max = max.max(high + anchor);
    }
    let error = HALF_ULP * (28.0 * f64::from(radius) + 8.0) + 4.0 * PACKING_ERROR;
    let outward = |height: f32, error: f64| (f64::from(height) + error) as f32;
    Slab { normal, min: outward(min.reduce_min(), -error).next_down(), max: outward(max.reduce_max(), error).next_up() }
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use crate::hierarchy::Builder;
    use crate::mesh::Mesh;
    use crate::mesh::packet::tests::kinds;

    /// Slabs about many leaves hold all corners, whichever way the leaves face.
    #[test]
    fn slabs_hold_what_their_leaves_hold() {
        let mut rng = Rng::new(152);
        let mut thin = 0;
        for round in 0..200 {
            let bumps = if round % 2 == 0 { 1e-3 } else { 1.0 };
            let vertices: Vec<[f64; 3]> = (0..300)
                .map(|_| [rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), bumps * rng.uniform(-1.0, 1.0)])
                .collect();
            let faces: Vec<[u32; 3]> = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            // All face up, so that their mean does.
            let up = |&[a, b, c]: &[u32; 3]| {
                let [p, q, r] = [a, b, c].map(|v| vertices[v as usize]);
                (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) > 0.0
            };
            let faces: Vec<[u32; 3]> =
                faces.iter().map(|face| if up(face) { *face } else { [face[0], face[2], face[1]] }).collect();
            for positions in kinds(&vertices) {
                let mesh = Mesh::with_builder(positions, faces.clone(), Builder::Morton).expect("legal");
                let slab = mesh.0.tree.nodes()[0].slab;
                thin += usize::from(slab.max - slab.min < 0.01);
                for face in 0..100 {
                    for corner in mesh.corners(face).map(|corner| mesh.0.frame.pack(corner)) {
                        let height: f64 = (0..3).map(|axis| f64::from(slab.normal[axis]) * corner[axis]).sum();
                        assert!((f64::from(slab.min)..=f64::from(slab.max)).contains(&height), "{height}: {slab:?}");
                    }
                }
            }
        }
        assert!(thin > 200, "{thin} of 600 are thin");
    }
}
