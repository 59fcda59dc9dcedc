//! The point of a mesh that is nearest to a given point.
//!
//! Source: the descent with the nearest child first of Roussopoulos, Kelley, Vincent, *Nearest
//! neighbor queries*, SIGMOD 1995. Ours departs in using triangles instead of points. Boxes are
//! compared in double precision, because a point may be far from the mesh.
//!
//! Guarded by `tests/it/distance/points.rs`.

use fearless_simd::Simd;
use rayon::prelude::*;

use super::point_packet::Viewpoint;
use crate::hierarchy::{Child, Node};
use crate::input::InputError;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{Vector, length, sub};
use crate::mesh::Mesh;
use crate::mesh::storage::frame::reciprocal_power_of_two;
use crate::primitive::{CLOSED_FORM_ERROR, point_triangle};
use crate::simd::{LANES, best_level, bits, dispatch};

/// The point of a mesh that is nearest to a given point, with a proved interval of the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// The nearest point, in the mesh's own frame, rounded.
    pub point: [f64; 3],
    /// Index of the face that holds the point. If several faces are equally near by the closed
    /// form, the first of them.
    pub face: u32,
    /// Lower bound of the distance, in the mesh's own unit.
    pub lower: f64,
    /// Upper bound of the distance, in the mesh's own unit.
    pub upper: f64,
}

impl Mesh {
    /// Returns the point of the mesh that is nearest to `point`, both in the mesh's own frame, or
    /// `None` if the mesh has no faces.
    ///
    /// ```
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    /// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
    /// let nearest = mesh.closest_point([1.0, 1.0, 3.0])?.expect("a mesh with a face");
    /// assert_eq!((nearest.face, nearest.point), (0, [1.0, 1.0, 0.0]));
    /// assert!(nearest.lower <= 3.0 && 3.0 <= nearest.upper);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Accuracy
    /// The true distance lies in `[lower, upper]`. The width of this interval is at most 2^-44 of
    /// the sum of the point's distance from the mesh's center and the mesh's extent.
    ///
    /// # Errors
    /// Returns an error if a coordinate is not finite, or above 2^300 in magnitude.
    ///
    /// # Complexity
    /// Logarithmic in the faces. It grows with the number of faces that are as near as the nearest.
    pub fn closest_point(&self, point: [f64; 3]) -> Result<Option<ClosestPoint>, InputError> {
        InputError::validate_row(&point, "point", 0)?;
        Ok(self.nearest_to(&point))
    }

    /// Returns the [`closest_point`](Self::closest_point) of each point, computed on all cores of
    /// the current rayon pool.
    ///
    /// # Errors
    /// Returns an error for the first invalid point, as [`closest_point`](Self::closest_point)
    /// does. Then no point is processed.
    pub fn closest_points(&self, points: &[[f64; 3]]) -> Result<Vec<Option<ClosestPoint>>, InputError> {
        points.iter().enumerate().try_for_each(|(index, point)| InputError::validate_row(point, "point", index))?;
        Ok(points.par_iter().with_min_len(MIN_POINTS_PER_TASK).map(|point| self.nearest_to(point)).collect())
    }

    fn nearest_to(&self, point: &Vector) -> Option<ClosestPoint> {
        let has_faces = !self.0.tree.nodes().is_empty();
        has_faces.then(|| dispatch!(best_level(), simd => nearest(simd, self, point)))
    }
}

#[inline(always)]
fn nearest<S: Simd>(simd: S, mesh: &Mesh, point: &Vector) -> ClosestPoint {
    let (nodes, packets) = (mesh.0.tree.nodes(), mesh.packets());
    let mut search = Search::new(mesh, point);
    let mut tasks = vec![(0.0, Child::Inner(0))];
    while let Some((bound, child)) = tasks.pop() {
        if bound > search.cut {
            continue;
        }
        match child {
            Child::Inner(node) => search.open(&nodes[node as usize], &mut tasks),
            Child::Leaf(leaf) => {
                let packet = packets.get(simd, leaf);
                let reach = search.cut.sqrt() / search.per_packed * (1.0 + 1e-9);
                for lane in bits(search.viewpoint.may_be_within(simd, &packet, reach)) {
                    search.process_face(packet.leaf.faces[lane]);
                }
            }
        }
    }
    search.finish()
}

/// Minimum number of points per parallel task. Fewer points cost less than handing them to another
/// thread.
const MIN_POINTS_PER_TASK: usize = 64;

/// A search for the point of the mesh that is nearest to a given point. Coordinates are relative to
/// the given point, and scaled so that neither it nor the mesh is large.
struct Search<'a> {
    mesh: &'a Mesh,
    point: &'a Vector,
    /// Units of the search in one unit of the mesh, a power of two.
    scale: f64,
    /// The point relative to the center of the mesh, in the unit of the search.
    packed: Vector,
    /// Units of the search in one packed unit.
    per_packed: f64,
    viewpoint: Viewpoint,
    /// Error bound of `value`, in the unit of the search.
    error: f64,
    /// Squared distance above which boxes are skipped, in the unit of the search.
    cut: f64,
    /// Least distance so far, in the unit of the search.
    value: f64,
    face: u32,
    /// Nearest point so far, relative to the point, in the unit of the search.
    foot: Vector,
}

impl<'a> Search<'a> {
    /// Prepares a search.
    ///
    /// # Accuracy
    /// Corners are taken relative to the point and rounded once, to 2 units of 2^-53 of the size.
    /// The closed form adds its own error.
    fn new(mesh: &'a Mesh, point: &'a Vector) -> Self {
        let frame = &mesh.0.frame;
        let offset = sub(point, &frame.origin);
        // Squares of 2^300 do not overflow, and squares that vanish do not matter beside the mesh.
        let reach = length(&offset) + 2.0 / frame.scale;
        let scale = reciprocal_power_of_two(reach);
        // The diagonal of the box that holds a triangle and the point, which are both within
        // `reach` of the mesh's center.
        let size = 4.0 * reach * scale;
        let error = (CLOSED_FORM_ERROR + 4.0 * UNIT_ROUNDOFF) * size;
        let seen_from = frame.pack(*point);
        let largest = seen_from.iter().fold(1.0_f64, |largest, x| largest.max(x.abs()));
        let viewpoint = Viewpoint { point: seen_from, error: 16.0 * UNIT_ROUNDOFF * largest };
        Self {
            mesh,
            point,
            scale,
            packed: offset.map(|x| x * scale),
            per_packed: scale / frame.scale,
            viewpoint,
            error,
            cut: f64::INFINITY,
            value: f64::INFINITY,
            face: u32::MAX,
            foot: [0.0; 3],
        }
    }

    /// Appends the near children of a node, the nearest last.
    #[inline(always)]
    fn open(&self, node: &Node, tasks: &mut Vec<(f64, Child)>) {
        // The packed point has two roundings, and packed boxes have no error.
        let slack = 4.0 * UNIT_ROUNDOFF;
        let mut bounds = [0.0_f64; LANES];
        for axis in 0..3 {
            let at = self.packed[axis];
            for lane in 0..LANES {
                let (min, max) = (f64::from(node.min[axis][lane]), f64::from(node.max[axis][lane]));
                let gap = (min * self.per_packed - at).max(at - max * self.per_packed) - slack;
                let gap = gap.max(0.0);
                bounds[lane] += gap * gap;
            }
        }
        let start = tasks.len();
        for (lane, &bound) in bounds[..node.count()].iter().enumerate() {
            if bound > self.cut {
                continue;
            }
            let mut at = tasks.len();
            while at > start && tasks[at - 1].0 < bound {
                at -= 1;
            }
            tasks.insert(at, (bound, node.child(lane)));
        }
    }

    fn process_face(&mut self, face: u32) {
        let corners = self.mesh.corners(face).map(|corner| sub(&corner, self.point).map(|x| x * self.scale));
        let (squared, foot) = point_triangle(&[0.0; 3], &corners);
        let value = squared.sqrt();
        if (value, face) < (self.value, self.face) {
            (self.value, self.face, self.foot) = (value, face, foot);
            self.cut = ((value + 2.0 * self.error) * (1.0 + 1e-9)).powi(2);
        }
    }

    fn finish(&self) -> ClosestPoint {
        let Self { value, error, scale, .. } = *self;
        ClosestPoint {
            point: std::array::from_fn(|k| self.point[k] + self.foot[k] / scale),
            face: self.face,
            lower: ((value * (1.0 - 4.0 * f64::EPSILON) - error) / scale).next_down().max(0.0),
            upper: ((value * (1.0 + 4.0 * f64::EPSILON) + error) / scale).next_up(),
        }
    }
}
