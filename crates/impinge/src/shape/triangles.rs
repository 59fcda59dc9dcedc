//! Triangles that show a shape in pictures.

use std::f64::consts::{PI, TAU};

use super::kind::{Kind, RoundCore, Shape};
use crate::convex::{Core, to_unit_length};
use crate::hull::Hull;
use crate::math::Pose;
use crate::math::vec3::dot;
use crate::mesh::Mesh;

/// Distance between neighboring values of a coordinate, relative to the size of the shape. Points
/// that differ only by rounding become equal, so that the hull has no slivers.
const STEP: f64 = 1e-10;

/// Slack in the comparison of corners that are equally far along a direction, relative to the size
/// of the shape.
const SLACK: f64 = 1e-9;

impl Shape {
    /// Returns meshes that look like this shape, each with its pose in the frame of the shape. They
    /// are for pictures and for export: no query uses them.
    ///
    /// A mesh, a height field and a polytope have exactly their own triangles. A round shape gets
    /// the convex hull of points on its surface, `segments` of them around each axis (at least 8,
    /// rounded up to a multiple of 4). A compound has the meshes of all its parts. A half-space has
    /// none, and neither has a point, a segment, or a mesh without faces.
    ///
    /// # Accuracy
    /// The hull lies inside the round shape, up to a relative rounding error of 1e-10. A sphere is
    /// at most 1 - cos(π / `segments`) of its radius outside the hull, in the middle of a side, and
    /// about twice as much in the middle of a facet. The test is `tests/it/shapes/triangles.rs`.
    ///
    /// # Complexity
    /// About `segments`² / 2 support points for each round part, and their hull.
    ///
    /// ```
    /// use impinge::Shape;
    ///
    /// let pill = Shape::capsule([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.5)?;
    /// let meshes = pill.to_meshes(32);
    /// assert_eq!(meshes.len(), 1);
    /// assert!(meshes[0].0.is_closed());
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    #[must_use]
    pub fn to_meshes(&self, segments: usize) -> Vec<(Mesh, Pose)> {
        if let Kind::Compound(parts) = &self.0 {
            let of_part = |(part, pose): &(Self, Pose)| part.to_mesh(segments).map(|mesh| (mesh, *pose));
            return parts.iter().filter_map(of_part).collect();
        }
        self.to_mesh(segments).map(|mesh| (mesh, Pose::IDENTITY)).into_iter().collect()
    }

    /// Returns the mesh of a shape that is not a compound.
    fn to_mesh(&self, segments: usize) -> Option<Mesh> {
        let mesh = match &self.0 {
            Kind::Mesh { mesh, .. } => mesh.clone(),
            Kind::Field(field) => field.to_mesh().ok()?,
            Kind::Polytope(corners) => hull(corners.core().corners()?)?,
            Kind::Round { core, radius } => {
                let core = match core {
                    RoundCore::Polytope(corners) => corners.core(),
                    RoundCore::Turned(set) => Core::Turned(set),
                    RoundCore::Curved(set) => Core::Curved(&**set),
                };
                hull(&surface_points(core, *radius, segments))?
            }
            Kind::HalfSpace { .. } | Kind::Compound(_) => return None,
        };
        (!mesh.faces().is_empty()).then_some(mesh)
    }
}

/// Returns the surface of the convex hull of points.
fn hull(points: &[[f64; 3]]) -> Option<Mesh> {
    let hull = Hull::new(points).ok()?;
    Mesh::new(hull.positions().to_vec(), hull.faces().to_vec()).ok()
}

/// Returns points on the surface of a core that is grown by a radius.
fn surface_points(core: Core<'_>, radius: f64, segments: usize) -> Vec<[f64; 3]> {
    let corners = core.corners();
    let mut points = Vec::new();
    for direction in directions(segments) {
        let out = direction.map(|x| radius * x);
        let mut push = |point: &[f64; 3]| points.push(std::array::from_fn(|k| point[k] + out[k]));
        let Some(corners) = corners else {
            // The greatest entry of the direction that a support function gets is 1 in magnitude.
            let greatest = direction.into_iter().fold(0.0_f64, |greatest, x| greatest.max(x.abs()));
            push(&core.farthest(direction.map(|x| x / greatest), 0).0);
            continue;
        };
        let heights = corners.iter().map(|corner| dot(&direction, corner));
        let highest = heights.clone().fold(f64::NEG_INFINITY, f64::max);
        let slack = SLACK * size(corners);
        let far = corners.iter().zip(heights).filter(|(_, height)| highest - height <= slack);
        far.for_each(|(corner, _)| push(corner));
    }
    let step = STEP * size(&points);
    if step > 0.0 {
        points.iter_mut().flatten().for_each(|x| *x = (*x / step).round() * step);
    }
    points
}

/// Returns the greatest magnitude of a coordinate.
fn size(points: &[[f64; 3]]) -> f64 {
    points.iter().flatten().fold(0.0, |size, x| size.max(x.abs()))
}

/// Returns unit vectors to all sides: rings about the z axis, and its two ends. The directions of
/// all axes are among them.
fn directions(segments: usize) -> impl Iterator<Item = [f64; 3]> {
    let around = segments.max(8).next_multiple_of(4);
    let rings = around / 2;
    let unit = |angle: f64| {
        // Sines of right angles are rounded to multiples of 1/2^53.
        let (sine, cosine) = angle.sin_cos();
        [cosine, sine].map(|x| if x.abs() < f64::EPSILON { 0.0 } else { x })
    };
    let ring = move |ring: usize| {
        let [rise, across] = unit(PI * ring as f64 / rings as f64);
        (0..around).map(move |at| {
            let [x, y] = unit(TAU * at as f64 / around as f64);
            to_unit_length([across * x, across * y, rise])
        })
    };
    (1..rings).flat_map(ring).chain([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
}
