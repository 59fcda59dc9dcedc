//! The faces that hold a point, and the number of other faces that a ray along an axis crosses,
//! both exact (docs/notes/proof.md, L16).
//!
//! Eight faces at a time are compared in single precision, which decides all faces but those that
//! the ray passes close to the border of, and those that are level with the point. Exact signs
//! decide the rest.
//!
//! Guarded by the test below, by `tests/it/solids/winding.rs` and `containment.rs`, and by the
//! benchmark `solids` of `impinge-bench`.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use crate::exact::{AxisRay, Corners, PosedPoint};
use crate::hierarchy::{Child, HALF_ULP, Node, overlapping};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::mesh::Mesh;
use crate::mesh::points::ray_packet::{Line, Passed};
use crate::mesh::storage::frame::{PACKING_ERROR, PackedFrame};
use crate::mesh::storage::packet::Packet;
use crate::simd::{self, LANES, bits, by_axis, dispatch, load};
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

/// A point in the packed frame of a mesh.
pub(crate) struct PackedPoint {
    /// A box that holds the point.
    interval: Aabb,
    /// The point, moved to a coordinate of 4 on each axis on which it is farther from the origin.
    /// Coordinates of the mesh are at most 1 in magnitude, so that rays from the moved point cross
    /// the same faces.
    nearby: [f64; 3],
    /// Error bound of a coordinate of `nearby`.
    error: f64,
}

impl PackedPoint {
    pub(crate) fn new(mesh: &Mesh, point: &PosedPoint<'_>) -> Self {
        let frame = &mesh.0.frame;
        Self {
            interval: packed_interval(frame, point),
            nearby: frame.pack(point.approximate).map(|x| x.clamp(-4.0, 4.0)),
            // The sum is at least the largest, and NaN if one of them is.
            error: point.error.iter().sum::<f64>() * frame.scale * (1.0 + 4.0 * f64::EPSILON) + 32.0 * UNIT_ROUNDOFF,
        }
    }

    /// Reports whether the point is proved to be outside of the mesh's
    /// [bounds](Mesh::packed_bounds).
    pub(crate) fn is_beyond(&self, bounds: &Aabb) -> bool {
        are_apart(&self.interval, bounds)
    }

    /// Returns the six rays along the axes of the mesh's frame, sorted by their length within the
    /// mesh's [bounds](Mesh::packed_bounds), the shortest first.
    pub(crate) fn rays_by_length(&self, bounds: &Aabb) -> [AxisRay; 6] {
        let at = &self.interval;
        let mut rays: [(f32, AxisRay); 6] = std::array::from_fn(|i| {
            let (axis, ascending) = (i / 2, i % 2 == 0);
            let left = if ascending { bounds.max[axis] - at.min[axis] } else { at.max[axis] - bounds.min[axis] };
            (left, AxisRay { axis, ascending })
        });
        rays.sort_by(|x, y| x.0.total_cmp(&y.0));
        rays.map(|(_, ray)| ray)
    }

    /// Returns a box that holds a ray from the point.
    pub(crate) fn reach(&self, ray: AxisRay) -> Aabb {
        let mut bounds = self.interval;
        if ray.ascending {
            bounds.max[ray.axis] = f32::INFINITY;
        } else {
            bounds.min[ray.axis] = f32::NEG_INFINITY;
        }
        bounds
    }
}

/// Reports whether two boxes are apart. Comparisons with NaN prove nothing.
pub(super) fn are_apart(a: &Aabb, b: &Aabb) -> bool {
    (0..3).any(|k| a.min[k] > b.max[k] || a.max[k] < b.min[k])
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
    pub(crate) fn crossings(
        &self,
        point: &PosedPoint<'_>,
        packed: &PackedPoint,
        ray: AxisRay,
        stack: &mut Vec<u32>,
    ) -> Crossings {
        self.crossings_at(simd::best_level(), point, packed, ray, stack)
    }

    fn crossings_at(
        &self,
        level: simd::Level,
        point: &PosedPoint<'_>,
        packed: &PackedPoint,
        ray: AxisRay,
        stack: &mut Vec<u32>,
    ) -> Crossings {
        let mut found = Crossings::default();
        stack.clear();
        if !self.0.tree.nodes().is_empty() {
            let (reach, view) = (packed.reach(ray), View::new(packed, ray));
            stack.push(0);
            let count = dispatch!(level, simd => descend(simd, self, &reach, &view, stack, |face| {
                compare_face(point, ray, &self.corners(face), face, &mut found);
            }));
            found.count += count;
        }
        found.holding.sort_unstable();
        found
    }
}

/// Returns the crossings of faces that single precision decides, and passes the other faces to
/// `visit`.
#[inline(always)]
fn descend<S: Simd>(
    simd: S,
    mesh: &Mesh,
    reach: &Aabb,
    view: &View,
    stack: &mut Vec<u32>,
    mut visit: impl FnMut(u32),
) -> i64 {
    let (nodes, packets) = (mesh.0.tree.nodes(), mesh.packets());
    let mut count = 0;
    while let Some(index) = stack.pop() {
        let node = &nodes[index as usize];
        let boxes = (by_axis!(axis => load(simd, &node.min[axis])), by_axis!(axis => load(simd, &node.max[axis])));
        let overlapped = overlapping(simd, (&boxes.0, &boxes.1), reach) & ((1 << node.count()) - 1);
        for lane in bits(overlapped) {
            match node.child(lane) {
                Child::Inner(child) => stack.push(child),
                Child::Leaf(leaf) => {
                    let packet = packets.get(simd, leaf);
                    let (decided, open) = view.count(simd, &packet);
                    count += decided;
                    bits(open).for_each(|lane| visit(packet.leaf.faces[lane]));
                }
            }
        }
    }
    count
}

/// A ray along an axis, looked at in the packed frame.
struct View {
    ray: AxisRay,
    line: Line,
    /// Coordinate of the point along the axis.
    along: f64,
    /// Error bound of a coordinate of the point.
    error: f64,
}

impl View {
    fn new(point: &PackedPoint, ray: AxisRay) -> Self {
        let direction = by_axis!(axis => f64::from(u8::from(axis == ray.axis)));
        let line = Line::new(point.nearby, direction, point.error);
        Self { ray, line, along: point.nearby[ray.axis], error: point.error }
    }

    /// Returns how often the ray leaves through triangles of a packet, less how often it enters
    /// through them, and the lanes of the triangles that are left undecided, as bits.
    ///
    /// # Accuracy
    /// A coordinate of a corner relative to the point is off by the error of both in the packed
    /// frame, and by 2 units of 2^-24 of the packet's radius and of the distance to its local
    /// origin. The code takes twice as much.
    #[inline(always)]
    fn count<S: Simd>(&self, simd: S, packet: &Packet<'_>) -> (i64, u32) {
        let Passed { may_intersect, turning_left, turning_right } = self.line.pass(simd, packet);
        let axis = self.ray.axis;
        let from = self.along - packet.local_origin[axis];
        let size = f64::from(packet.radius) + from.abs();
        let error = 2.0 * (PACKING_ERROR + self.error) + (4.0 * HALF_ULP + 8.0 * UNIT_ROUNDOFF) * size;
        let [a, b, c] = by_axis!(corner => load(simd, &packet.corners[corner][axis]));
        let above = a.min(b).min(c).simd_gt(((from + error) as f32).next_up()).to_bitmask() as u32;
        let below = a.max(b).max(c).simd_lt(((from - error) as f32).next_down()).to_bitmask() as u32;
        let (ahead, behind) = if self.ray.ascending { (above, below) } else { (below, above) };
        let [left, right] = [turning_left, turning_right].map(|turning| i64::from((turning & ahead).count_ones()));
        let count = if self.ray.ascending { left - right } else { right - left };
        (count, may_intersect & !behind & !(ahead & (turning_left | turning_right)))
    }
}

/// Decides about one face exactly.
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

fn lane_bounds(node: &Node, lane: usize) -> Aabb {
    Aabb { min: node.min.map(|lanes| lanes[lane]), max: node.max.map(|lanes| lanes[lane]) }
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::exact::Spot;
    use crate::mesh::Positions;
    use crate::simd::kernel_levels;

    /// Triangles with corners on a grid, needles and triangles without area among them, and points
    /// of the grid, of half the grid and close to both: many rays pass edges and corners.
    #[test]
    fn crossings_are_those_of_all_faces_compared_exactly() {
        let mut rng = Rng::new(47);
        let (mut held, mut crossed, mut missed, mut decided) = (0, 0, 0, 0);
        for round in 0..60 {
            let size = 2.0_f64.powi(round % 7 * 10 - 30);
            let corner = |rng: &mut Rng| [0; 3].map(|_| size * rng.integer(-6, 6) as f64);
            let vertices: Vec<[f64; 3]> = (0..90).map(|_| corner(&mut rng)).collect();
            let faces: Vec<[u32; 3]> = (0..60).map(|_| [0; 3].map(|_| rng.integer(0, 89) as u32)).collect();
            let mesh = Mesh::new(Positions::F64(vertices), faces).expect("a valid mesh");
            for _ in 0..40 {
                let steps = if rng.integer(0, 1) == 0 { 1.0 } else { 2.0 };
                let shift =
                    if rng.integer(0, 2) == 0 { size * 2.0_f64.powi(-(rng.integer(8, 50) as i32)) } else { 0.0 };
                let point = [0; 3].map(|_| size * rng.integer(-14, 14) as f64 / steps + shift);
                let spot = if rng.integer(0, 3) == 0 {
                    Spot::Within(mesh.corners(rng.integer(0, 59) as u32))
                } else {
                    Spot::At(point)
                };
                let point = PosedPoint::local(spot);
                let packed = PackedPoint::new(&mesh, &point);
                for axis in 0..3 {
                    for ascending in [false, true] {
                        let ray = AxisRay { axis, ascending };
                        let mut slow = Crossings::default();
                        for face in 0..60 {
                            compare_face(&point, ray, &mesh.corners(face), face, &mut slow);
                        }
                        held += usize::from(!slow.holding.is_empty());
                        crossed += usize::from(slow.count != 0);
                        missed += usize::from(slow.count == 0 && slow.holding.is_empty());
                        for (name, level) in kernel_levels() {
                            let fast = mesh.crossings_at(level, &point, &packed, ray, &mut Vec::new());
                            assert_eq!(fast, slow, "{name}, round {round}, {:?}, {ray:?}", point.approximate);
                        }
                        let view = View::new(&packed, ray);
                        let packets = mesh.packets();
                        decided += (0..mesh.0.leaves.len() as u32)
                            .filter(|&leaf| {
                                dispatch!(simd::best_level(), simd => view.count(simd, &packets.get(simd, leaf)).0 != 0)
                            })
                            .count();
                    }
                }
            }
        }
        assert!(
            held > 500 && crossed > 3_000 && missed > 500 && decided > 1_000,
            "{held} held, {crossed} crossed, {missed} missed, {decided} decided"
        );
    }
}
