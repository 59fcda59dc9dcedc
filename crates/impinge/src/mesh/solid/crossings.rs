//! The faces that hold a point, and the number of other faces that a ray along an axis crosses,
//! both exact (docs/notes/proof.md, L16).
//!
//! Guarded by `tests/it/solids/winding.rs` and `containment.rs`, and by the benchmark `solids` of
//! `impinge-bench`.

use crate::exact::{AxisRay, Corners, PosedPoint};
use crate::hierarchy::{Child, Node};
use crate::mesh::Mesh;
use crate::mesh::storage::frame::PackedFrame;
use crate::simd::LANES;
use crate::volume::Aabb;

/// The faces that one ray crosses or starts on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Crossings {
    /// Number of faces that the ray leaves through, less the number of faces that it enters
    /// through.
    pub(crate) count: i64,
    /// The faces that hold the point, in ascending order. None of them is counted.
    pub(crate) holding: Vec<u32>,
}

/// Returns the six rays along the axes of the mesh's frame, sorted by their length within the
/// mesh's bounds, the shortest first.
pub(crate) fn rays_by_length(mesh: &Mesh, point: &PosedPoint<'_>) -> [AxisRay; 6] {
    let bounds = mesh.packed_bounds();
    let at = packed_interval(&mesh.0.frame, point);
    let mut rays: [(f32, AxisRay); 6] = std::array::from_fn(|i| {
        let (axis, ascending) = (i / 2, i % 2 == 0);
        let left = if ascending { bounds.max[axis] - at.min[axis] } else { at.max[axis] - bounds.min[axis] };
        (left, AxisRay { axis, ascending })
    });
    rays.sort_by(|x, y| x.0.total_cmp(&y.0));
    rays.map(|(_, ray)| ray)
}

impl Mesh {
    /// Returns the bounds of the whole mesh in the packed frame, or an empty box for a mesh without
    /// faces.
    pub(crate) fn packed_bounds(&self) -> Aabb {
        let Some(root) = self.0.tree.nodes().first() else { return Aabb::EMPTY };
        (0..root.count()).fold(Aabb::EMPTY, |bounds, lane| bounds.union(lane_bounds(root, lane)))
    }

    /// Returns the faces of a leaf, each once.
    pub(crate) fn leaf_faces(&self, leaf: u32) -> impl Iterator<Item = u32> {
        let faces = self.leaf(leaf).faces;
        // Unused lanes repeat the first face, and no other lane has it.
        let used = (1..LANES).take_while(move |&lane| faces[lane] != faces[0]).count() + 1;
        faces.into_iter().take(used)
    }

    /// Returns the faces that hold a point and the crossings of a ray from it. `stack` is working
    /// memory.
    ///
    /// # Complexity
    /// Linear in the nodes whose boxes the ray passes: logarithmic in the faces, times the layers
    /// that the ray crosses.
    pub(crate) fn crossings(&self, point: &PosedPoint<'_>, ray: AxisRay, stack: &mut Vec<u32>) -> Crossings {
        let mut found = Crossings::default();
        let reach = reach(packed_interval(&self.0.frame, point), ray);
        let nodes = self.0.tree.nodes();
        stack.clear();
        stack.extend((!nodes.is_empty()).then_some(0));
        while let Some(index) = stack.pop() {
            let node = &nodes[index as usize];
            for lane in 0..node.count() {
                if !overlaps(node, lane, &reach) {
                    continue;
                }
                match node.child(lane) {
                    Child::Inner(child) => stack.push(child),
                    Child::Leaf(leaf) => {
                        for face in self.leaf_faces(leaf) {
                            compare_face(point, ray, &self.corners(face), face, &mut found);
                        }
                    }
                }
            }
        }
        found.holding.sort_unstable();
        found
    }
}

#[inline]
fn compare_face(point: &PosedPoint<'_>, ray: AxisRay, corners: &Corners, face: u32, found: &mut Crossings) {
    // Skips a face that is certainly beside the ray or behind the point.
    let p = &point.approximate;
    for axis in 0..3 {
        let (x, error) = (p[axis], point.error[axis]);
        let (low, high) = (x - error, x + error);
        let before = corners.iter().all(|corner| corner[axis] > high.next_up());
        let after = corners.iter().all(|corner| corner[axis] < low.next_down());
        let along = axis == ray.axis;
        let [rises, falls] = [along && ray.ascending, along && !ray.ascending];
        if (before && !rises) || (after && !falls) {
            return;
        }
    }
    if point.is_on(corners) {
        found.holding.push(face);
    } else {
        found.count += i64::from(point.crossing(ray, corners));
    }
}

/// Returns a box of the packed frame that holds the point.
fn packed_interval(frame: &PackedFrame, point: &PosedPoint<'_>) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    for axis in 0..3 {
        let (x, error) = (point.approximate[axis], point.error[axis]);
        // The two sums are rounded, and this adds twice their rounding error. The error is zero if
        // the point is given in this frame.
        let error = if error == 0.0 { 0.0 } else { error + 2.0 * f64::EPSILON * x.abs() };
        let packed = |x: f64| ((x - frame.origin[axis]) * frame.scale) as f32;
        // As for the boxes of faces, one step to the next float covers the rounding to single
        // precision and all roundings before it.
        (bounds.min[axis], bounds.max[axis]) = (packed(x - error).next_down(), packed(x + error).next_up());
    }
    bounds
}

/// Returns the box, extended to infinity along the ray.
fn reach(mut bounds: Aabb, ray: AxisRay) -> Aabb {
    if ray.ascending {
        bounds.max[ray.axis] = f32::INFINITY;
    } else {
        bounds.min[ray.axis] = f32::NEG_INFINITY;
    }
    bounds
}

/// Reports whether a child's box is not proved to be apart from `bounds`. Comparisons with NaN
/// prove nothing.
#[inline(always)]
fn overlaps(node: &Node, lane: usize, bounds: &Aabb) -> bool {
    let apart = |axis: usize| node.min[axis][lane] > bounds.max[axis] || node.max[axis][lane] < bounds.min[axis];
    !(apart(0) | apart(1) | apart(2))
}

fn lane_bounds(node: &Node, lane: usize) -> Aabb {
    Aabb { min: node.min.map(|lanes| lanes[lane]), max: node.max.map(|lanes| lanes[lane]) }
}
