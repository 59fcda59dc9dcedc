//! Fits nodes to the corners below them: computes their boxes and slabs in the packed frame,
//! rounded outward (docs/notes/proof.md, L1, L2a and L26).
//!
//! All leaves of a node are processed together. Their corners are kept in single precision,
//! relative to one corner of the patch, until the nodes above are fitted. A patch is a subtree that
//! one thread refits.
//!
//! Guarded by the tests below, by `a_refit_to_the_same_positions_changes_no_bit` in
//! `engine/moving.rs`, and by the benchmark `refit`.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::hierarchy::{BoxLanes, HALF_ULP, Leaves, Slab};
use crate::mesh::storage::faces::VertexRows;
use crate::mesh::storage::frame::{PACKING_ERROR, outward};
use crate::mesh::storage::leaf::Leaf;
use crate::mesh::storage::stored_corners::StoredCorners;
use crate::mesh::storage::triangles::{CornerLanes, doubled_area_vectors, heights, load_corners, store_corners};
use crate::simd::{LANES, Lanes3, by_axis, prefetch_at};
use crate::volume::Aabb;

/// Corners that are all at one point.
pub(super) const NO_CORNERS: CornerLanes = [[[0.0; LANES]; 3]; 3];

/// Number of leaves by which leaves, and their faces, are prefetched before they are processed.
/// Vertices are looked up one node ahead.
const LEAVES_AHEAD: usize = 6 * LANES;
const FACES_AHEAD: usize = 3 * LANES;

/// Lanes whose vertices are prefetched. The vertices of neighboring lanes are most often in the
/// same cache line.
const PREFETCHED_LANES: [usize; 4] = [0, 2, 4, 6];

/// The leaves of a patch, and the corners of the leaves processed so far, relative to one corner.
pub(super) struct Fitting<'a, S: Simd, C: StoredCorners> {
    simd: S,
    stored: C,
    leaves: &'a [Leaf],
    corners: &'a mut [CornerLanes],
    /// Local origin of `corners`, in the mesh frame and in the packed frame.
    origin: [f64; 3],
    packed_origin: [f64; 3],
    /// Vertex indices of the current leaves and of the next ones. The slot of a leaf is its number
    /// modulo the length.
    ahead: [VertexRows; 2 * LANES],
    /// Extremes of the current leaves. If a node has less than eight leaves, other entries are of
    /// earlier leaves.
    extremes: [C::Extremes<S>; LANES],
}

impl<'a, S: Simd, C: StoredCorners> Fitting<'a, S, C> {
    /// Prepares fitting for at least one leaf. `corners` must have room for as many leaves.
    #[inline(always)]
    pub(in crate::mesh) fn new(simd: S, stored: C, leaves: &'a [Leaf], corners: &'a mut [CornerLanes]) -> Self {
        let mut rows = [[0; 4]; LANES];
        stored.faces().look_up(simd, &leaves[0], &mut rows);
        let origin = stored.vertex(rows[0][0]);
        let packed_origin = stored.frame().pack(origin);
        let (ahead, extremes) = ([rows; 2 * LANES], [stored.extremes_of(&stored.gather(simd, &rows)); LANES]);
        let mut fitting = Self { simd, stored, leaves, corners, origin, packed_origin, ahead, extremes };
        // Nothing has been prefetched yet, so the first leaves, faces and vertices are requested in
        // turn.
        let last = |count: usize| leaves.len().saturating_sub(count)..leaves.len();
        last(LEAVES_AHEAD).for_each(|leaf| prefetch_at(leaves, leaf));
        last(FACES_AHEAD).for_each(|leaf| fitting.prefetch_faces(leaf));
        last(LANES).for_each(|leaf| fitting.look_ahead(leaf));
        fitting
    }

    /// Looks up and prefetches the vertices of a leaf. Also prefetches the leaves and faces that
    /// the next calls need: leaves are stored in order, but their faces may be anywhere.
    #[inline(always)]
    fn look_ahead(&mut self, leaf: usize) {
        prefetch_at(self.leaves, leaf.wrapping_sub(LEAVES_AHEAD - LANES));
        if let Some(next) = leaf.checked_sub(FACES_AHEAD - LANES) {
            self.prefetch_faces(next);
        }
        let rows = &mut self.ahead[leaf % (2 * LANES)];
        self.stored.faces().look_up(self.simd, &self.leaves[leaf], rows);
        for lane in PREFETCHED_LANES {
            for corner in 0..2 {
                self.stored.prefetch_vertex(rows[lane][corner]);
            }
        }
    }

    /// Prefetches the vertex indices of the faces of a leaf.
    #[inline(always)]
    fn prefetch_faces(&self, leaf: usize) {
        self.leaves[leaf].faces.iter().for_each(|&face| self.stored.faces().prefetch(face));
    }
}

impl<S: Simd, C: StoredCorners> Leaves for Fitting<'_, S, C> {
    /// Computes the boxes of leaves and the sum of their area vectors. No operation is fused, so
    /// that the bits are the same on every vector unit.
    #[inline(always)]
    fn fit(&mut self, at: Range<usize>) -> (BoxLanes, [f32; 3]) {
        // Local copies, so that they are not loaded again after each leaf.
        let (simd, stored, origin) = (self.simd, self.stored, self.origin);
        let mut area: Lanes3<S> = [f32x8::splat(simd, 0.0); 3];
        for (lane, at) in at.enumerate() {
            if let Some(ahead) = at.checked_sub(LANES) {
                self.look_ahead(ahead);
            }
            let gathered = stored.gather(simd, &self.ahead[at % (2 * LANES)]);
            self.extremes[lane] = stored.extremes_of(&gathered);
            let corners = stored.about(simd, &gathered, origin);
            store_corners(&corners, &mut self.corners[at]);
            let vectors = doubled_area_vectors(&corners);
            area = by_axis!(axis => area[axis] + vectors[axis]);
        }
        let bounds = stored.bounds(&stored.extremes(&self.extremes));
        (bounds, by_axis!(axis => sum(area[axis])))
    }

    /// Computes the slab of leaves, perpendicular to the direction `facing` in which their
    /// triangles face.
    ///
    /// # Accuracy
    /// Let u = 2^-24, and r the largest coordinate of the node's corners relative to the local
    /// origin. The error of a height is 3 (u r + [`PACKING_ERROR`]) for its corner, and 8 u r for
    /// its three products and two sums. The height of the local origin is at most 3. Its error is
    /// less than 4 [`PACKING_ERROR`] in double precision, and the sum of both heights is rounded
    /// outward.
    #[inline(always)]
    fn slab(&self, leaves: Range<usize>, bounds: &Aabb, facing: [f32; 3]) -> Slab {
        let simd = self.simd;
        let largest = facing.iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
        if largest < f32::MIN_POSITIVE {
            return Slab::ALL;
        }
        let normal = facing.map(|x| x / largest);
        let (mut min, mut max) = (f32x8::splat(simd, f32::INFINITY), f32x8::splat(simd, f32::NEG_INFINITY));
        for corners in &self.corners[leaves] {
            let [low, high] = heights(simd, &load_corners(simd, corners), normal);
            min = min.min(low);
            max = max.max(high);
        }
        let radius = (0..3).fold(0.0_f64, |radius, axis| {
            let (low, high) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
            radius.max(self.packed_origin[axis] - low).max(high - self.packed_origin[axis])
        });
        let error = 12.0 * HALF_ULP * radius + 8.0 * PACKING_ERROR;
        let [x, y, z] = normal.map(f64::from);
        let origin = x * self.packed_origin[0] + y * self.packed_origin[1] + z * self.packed_origin[2];
        let (min, max) = (f64::from(min.reduce_min()) + origin, f64::from(max.reduce_max()) + origin);
        Slab { normal, min: -outward((error - min) as f32), max: outward((max + error) as f32) }
    }
}

/// Returns the sum of all lanes, in an order that is the same on every vector unit.
#[inline(always)]
fn sum<S: Simd>(lanes: f32x8<S>) -> f32 {
    let (low, high) = lanes.split();
    let [a, b, c, d] = <[f32; 4]>::from(low + high);
    (a + c) + (b + d)
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::outward;
    use crate::hierarchy::{Builder, Child, Patches};
    use crate::mesh::Mesh;
    use crate::mesh::lifecycle::moved::Moved;
    use crate::mesh::storage::triangles::tests::kinds;
    use crate::simd::levels;
    use crate::volume::Aabb;

    /// Returns meshes of a hundred triangles that all face up, in both precisions and at a scale
    /// for which single precision is not enough.
    fn meshes(rng: &mut Rng, bumps: f64) -> Vec<Mesh> {
        let vertices: Vec<[f64; 3]> = (0..300)
            .map(|_| [rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), bumps * rng.uniform(-1.0, 1.0)])
            .collect();
        let faces: Vec<[u32; 3]> = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let up = |&[a, b, c]: &[u32; 3]| {
            let [p, q, r] = [a, b, c].map(|v| vertices[v as usize]);
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) > 0.0
        };
        let faces: Vec<[u32; 3]> =
            faces.iter().map(|face| if up(face) { *face } else { [face[0], face[2], face[1]] }).collect();
        let build = |positions| Mesh::with_builder(positions, faces.clone(), Builder::Morton).expect("legal");
        kinds(&vertices).into_iter().map(build).collect()
    }

    /// Slabs of many leaves hold all corners, whichever way the leaves face.
    #[test]
    fn slabs_hold_what_their_leaves_hold() {
        let mut rng = Rng::new(152);
        let mut thin = 0;
        for round in 0..200 {
            for mesh in meshes(&mut rng, if round % 2 == 0 { 1e-3 } else { 1.0 }) {
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

    /// The box of a leaf is that of its faces in the packed frame, rounded outward. A node has the
    /// same bits at every vector level.
    #[test]
    fn boxes_are_those_of_the_faces_at_every_vector_level() {
        let mut rng = Rng::new(153);
        for mesh in (0..50).flat_map(|_| meshes(&mut rng, 1.0)) {
            let data = &*mesh.0;
            let box_of = |face: u32| {
                let corners = mesh.corners(face).map(|corner| data.frame.pack(corner).map(|x| x as f32));
                let Aabb { min, max } = Aabb::of_points(corners);
                Aabb { min: min.map(|x| -outward(-x)), max: max.map(outward) }
            };
            for node in data.tree.nodes() {
                for lane in 0..node.count() {
                    if let Child::Leaf(leaf) = node.child(lane) {
                        let held = mesh.leaf(leaf).held().iter();
                        let bounds = held.fold(Aabb::EMPTY, |bounds, &face| bounds.union(box_of(face)));
                        assert_eq!(node.lane_bounds(lane), bounds);
                    }
                }
            }
            let moved = Moved { vertices: data.vertices.slice(), faces: &data.faces, frame: &data.frame };
            let [patch] = &Patches::of(&data.tree, data.leaves.len()).patches[..] else { panic!("one patch") };
            for (name, level) in levels() {
                let mut nodes = data.tree.nodes().to_vec();
                moved.fit_subtree(level, patch, &mut nodes, &data.leaves, &mut Vec::new());
                let (fitted, built) = (bytemuck::cast_slice::<_, u8>(&nodes), bytemuck::cast_slice(data.tree.nodes()));
                assert!(fitted == built, "{name}: other bits");
            }
        }
    }
}
