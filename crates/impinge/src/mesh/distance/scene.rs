//! The values that stay the same during a distance search between two meshes: placement, metric
//! frame, bounds and clearance. Also converts results to world units.

use super::bounds::Bounds;
use super::metric::Metric;
use super::slot::Slot;
use crate::exact::{NearParts, Placement, Supports, parts_within};
use crate::math::vec3::{Vector, dot, sub};
use crate::mesh::{Mesh, PlacedMesh};
use crate::primitive::{
    ClosestPoints, Witness, closest_on_segments, closest_on_triangle, common_point, triangle_triangle,
};

/// The nearest points of two meshes, in the world frame, with an interval of their distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    /// Lower bound of the distance, in world units.
    pub(crate) lower: f64,
    /// Upper bound of the distance, in world units.
    pub(crate) upper: f64,
    /// The nearest points, of the first and the second mesh, rounded.
    pub(crate) points: [Vector; 2],
    pub(crate) faces: [u32; 2],
}

/// A pair of faces with its computed distance (`value`) and nearest points, in metric units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Valued {
    pub(super) value: f64,
    pub(super) faces: [u32; 2],
    pub(super) witness: Witness,
}

impl Valued {
    /// Reports whether this pair has the smaller value, or equal values and the first faces.
    pub(super) fn precedes(&self, other: &Self) -> bool {
        self.value < other.value || (self.value == other.value && self.faces < other.faces)
    }
}

/// Two meshes in a distance search, with the values that stay the same during it.
pub(super) struct Scene<'a> {
    pub(super) meshes: [&'a Mesh; 2],
    pub(super) metric: Metric,
    pub(super) placement: Placement,
    pub(super) bounds: Bounds,
    /// Clearance of the query in world units, or infinity if the query asks for the nearest points.
    pub(super) clearance: f64,
}

impl Scene<'_> {
    /// Returns the indices of the host and the guest among the two meshes.
    #[inline(always)]
    pub(super) fn sides(&self) -> [usize; 2] {
        self.bounds.sides.host_guest([0, 1])
    }

    /// Returns the corners of two faces in the metric frame.
    pub(super) fn corners(&self, faces: [u32; 2]) -> [[Vector; 3]; 2] {
        [0, 1].map(|m| self.meshes[m].corners(faces[m]).map(|corner| self.metric.maps[m].apply(corner)))
    }

    /// Reports whether two faces are within the clearance, exactly. Only the edges and corners
    /// whose computed distance does not decide are compared exactly.
    pub(super) fn within(&self, faces: [u32; 2], witness: &Witness) -> bool {
        if self.supports(faces, witness).are_farther_than(
            &self.placement,
            self.meshes[0].corners(faces[0]).into_iter(),
            self.meshes[1].corners(faces[1]).into_iter(),
            self.clearance,
        ) {
            return false;
        }
        let metric = self.corners(faces);
        let may_be_near = |found: ClosestPoints| self.lower(found.distance) <= self.clearance;
        let edge = |m: usize, i: usize| [metric[m][i], metric[m][(i + 1) % 3]];
        let parts = NearParts {
            edges: [0, 1, 2].map(|i| [0, 1, 2].map(|j| may_be_near(closest_on_segments(&edge(0, i), &edge(1, j))))),
            feet: [0, 1].map(|m| metric[m].map(|corner| may_be_near(closest_on_triangle(&corner, &metric[1 - m])))),
        };
        let [a, b] = [0, 1].map(|m| self.meshes[m].corners(faces[m]));
        parts_within(&self.placement, &a, &b, self.clearance, &parts)
    }

    /// Reports whether two supporting planes prove that the meshes are farther apart than the
    /// clearance. Both are perpendicular to one direction, close to the line between the faces'
    /// nearest points.
    pub(super) fn are_farther_by_planes(&self, best: &Valued) -> bool {
        let supports = self.supports(best.faces, &best.witness);
        supports.are_farther_than(&self.placement, self.vertices(0), self.vertices(1), self.clearance)
    }

    /// Returns an interval of the distance of the meshes in world units, if two supporting planes
    /// prove that no two faces are nearer than the best pair. The interval is then the same for all
    /// pairs of faces that tie. Returns `None` if the planes do not prove it.
    pub(super) fn distance_by_planes(&self, best: &Valued) -> Option<[f64; 2]> {
        let supports = self.supports(best.faces, &best.witness);
        let corners = [0, 1].map(|m| self.meshes[m].corners(best.faces[m]));
        let metric = self.corners(best.faces);
        let shares = [shares(&metric[0], &best.witness.on_a)?, shares(&metric[1], &best.witness.on_b)?];
        supports.distance(&self.placement, self.vertices(0), self.vertices(1), corners.each_ref(), shares)
    }

    /// Returns the vertices of a mesh. Vertices that no face uses are among them, which can make a
    /// proof fail but never makes it wrong.
    fn vertices(&self, m: usize) -> impl Iterator<Item = [f64; 3]> + Clone + use<'_> {
        let vertices = self.meshes[m].0.vertices.slice();
        (0..vertices.len()).map(move |vertex| vertices.get(vertex))
    }

    /// Reports whether all faces below a child of the host or of the guest are copies of faces
    /// elsewhere.
    #[cold]
    pub(super) fn are_copies(&self, [host, guest]: [Slot; 2]) -> bool {
        let [of_host, of_guest] = self.sides().map(|side| self.meshes[side].copies());
        !of_host.has_first(host.node, host.lane) || !of_guest.has_first(guest.node, guest.lane)
    }

    /// Returns the number of faces of both meshes.
    pub(super) fn face_count(&self) -> usize {
        self.meshes.iter().map(|mesh| mesh.faces().len()).sum()
    }

    /// Returns the number of vertices of both meshes.
    pub(super) fn vertex_count(&self) -> usize {
        self.meshes.iter().map(|mesh| mesh.0.vertices.slice().len()).sum()
    }

    fn supports(&self, [a, b]: [u32; 2], witness: &Witness) -> Supports {
        let corners = [self.meshes[0].corners(a), self.meshes[1].corners(b)];
        Supports::of_triangles(&self.placement, &corners[0], &corners[1], sub(&witness.on_b, &witness.on_a))
    }

    /// Returns an upper bound of the distance of triangles with this value, in world units.
    pub(super) fn upper(&self, value: f64) -> f64 {
        ((value * (1.0 + 4.0 * f64::EPSILON) + self.metric.error) / self.metric.scale).next_up()
    }

    /// Returns a lower bound of the distance of triangles whose value is not smaller, in world
    /// units.
    pub(super) fn lower(&self, value: f64) -> f64 {
        ((value * (1.0 - 4.0 * f64::EPSILON) - self.metric.error) / self.metric.scale).next_down().max(0.0)
    }

    /// Returns the result for the best pair. `doubt` bounds how far its value may be above the
    /// least value, in metric units.
    pub(super) fn finish(&self, best: &Valued, doubt: f64) -> Nearest {
        let faces = best.faces;
        let Witness { on_a, on_b, .. } = best.witness;
        let lower = self.lower(best.value - doubt);
        let points = [on_a, on_b].map(|point| self.metric.to_world(point));
        Nearest { lower, upper: self.upper(best.value), points, faces }
    }
}

/// Returns the barycentric coordinates of a point for the second and the third corner. They are not
/// negative, and their sum leaves room for rounding. Returns `None` for a triangle without area.
fn shares([first, second, third]: &[Vector; 3], point: &Vector) -> Option<[f64; 2]> {
    let (u, v, w) = (sub(second, first), sub(third, first), sub(point, first));
    let (uu, uv, vv, wu, wv) = (dot(&u, &u), dot(&u, &v), dot(&v, &v), dot(&w, &u), dot(&w, &v));
    let area = uu * vv - uv * uv;
    let s = ((wu * vv - wv * uv) / area).max(0.0);
    let t = ((wv * uu - wu * uv) / area).max(0.0);
    let too_much = ((s + t) / (1.0 - 2.0 * f64::EPSILON)).max(1.0);
    (area > 0.0).then_some([s / too_much, t / too_much])
}

/// Returns the result for two faces that intersect: distance zero, and a common point twice.
pub(super) fn intersecting(a: PlacedMesh<'_>, b: PlacedMesh<'_>, faces: [u32; 2]) -> Nearest {
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let corners = [a.mesh.corners(faces[0]), b.mesh.corners(faces[1])];
    let common = common_point(&placement, &corners[0], &corners[1]).unwrap_or_else(|| {
        // If the faces lie in one plane, the closed form finds a common point.
        let metric = Metric::new(a, b);
        let [a, b] = [0, 1].map(|m| corners[m].map(|corner| metric.maps[m].apply(corner)));
        metric.to_world(triangle_triangle(&a, &b).on_a)
    });
    Nearest { lower: 0.0, upper: 0.0, points: [common; 2], faces }
}
