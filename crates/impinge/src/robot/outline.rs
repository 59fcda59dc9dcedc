//! Points and edges whose convex hulls contain a shape, for volumes about it.

use crate::convex::Core;
use crate::math::Pose;
use crate::mesh::Mesh;
use crate::shape::{Form, Shape};

/// Maximum number of points of a convex part whose pairs all count as edges. A part with more
/// points and no list of edges is replaced by its box.
const MAX_PAIRED: usize = 16;

/// Center and radius of a sphere.
pub(super) type Ball = ([f64; 3], f64);

/// Points that span a shape, in the frame of the shape.
///
/// Between two parallel planes, each part of the shape is contained in the convex hull of those of
/// its points that lie there, and of the points where its edges cross the planes, grown by a
/// radius. That holds for the inside of a closed mesh too: each line between the planes leaves it
/// through its surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    /// The spheres that span the shape.
    pub(super) spheres: Vec<Ball>,
    /// Edges between spheres, which have the same radius.
    pub(super) edges: Vec<[u32; 2]>,
    /// Bound on the sum of the magnitudes of the terms of the three coordinates of a point.
    pub(super) size: f64,
}

impl Outline {
    /// Returns the outline of a shape, without points if the shape is empty. Returns `None` if the
    /// shape has no bounds, or if a part of it is an open solid, whose inside has none.
    pub(super) fn of(shape: &Shape) -> Option<Self> {
        let placed = shape.at(Pose::IDENTITY).ok()?;
        let mut outline = Self::default();
        for part in placed.parts() {
            let pose = part.world_from_local();
            match part.form() {
                Form::HalfSpace(_) => return None,
                Form::Surface(surface) if surface.is_solid && !surface.mesh.is_closed() => return None,
                Form::Surface(surface) => {
                    let (points, edges) = vertices(surface.mesh);
                    outline.add(pose, &points, 0.0, edges);
                }
                Form::Field(field) => {
                    let corners = field.mesh.local_bounds().map(corners_of_box);
                    corners.iter().for_each(|corners| outline.add(pose, corners, 0.0, pairs(corners.len())));
                }
                Form::Convex(swept) => {
                    let reach = swept.core.reach();
                    let bounds = corners_of_box([reach.map(|x| -x), reach]);
                    let (points, edges) = match swept.core {
                        Core::Hull(hull) => (hull.positions(), edges_of(hull.faces())),
                        Core::Points(points) | Core::Cuboid(points) if points.len() <= MAX_PAIRED => {
                            (points, pairs(points.len()))
                        }
                        _ => (&bounds[..], pairs(bounds.len())),
                    };
                    outline.add(pose, points, swept.radius[1], edges);
                }
            }
        }
        Some(outline)
    }

    /// Adds the spheres and edges of a part at its pose.
    fn add(&mut self, pose: &Pose, points: &[[f64; 3]], radius: f64, edges: Vec<[u32; 2]>) {
        let first = self.spheres.len() as u32;
        for point in points {
            self.spheres.push((pose.apply(*point), radius));
            let terms = |row: &[f64; 3]| (0..3).map(|k| (row[k] * point[k]).abs()).sum::<f64>();
            let sum = pose.linear().iter().map(terms).chain(pose.translation().map(f64::abs)).sum::<f64>();
            self.size = self.size.max(sum + radius);
        }
        self.edges.extend(edges.into_iter().map(|edge| edge.map(|end| first + end)));
    }

    /// Returns the spheres between two planes across a coordinate axis, and the spheres at the
    /// points where edges cross the planes.
    pub(super) fn slab(&self, axis: usize, [low, high]: [f64; 2]) -> Vec<Ball> {
        let mut inside: Vec<_> =
            self.spheres.iter().copied().filter(|(point, _)| (low..=high).contains(&point[axis])).collect();
        for &[a, b] in &self.edges {
            let ((p, radius), (q, _)) = (self.spheres[a as usize], self.spheres[b as usize]);
            for level in [low, high] {
                if (p[axis] < level) != (q[axis] < level) {
                    let t = ((level - p[axis]) / (q[axis] - p[axis])).clamp(0.0, 1.0);
                    inside.push((std::array::from_fn(|k| p[k] + t * (q[k] - p[k])), radius));
                }
            }
        }
        inside
    }

    /// Returns the least and the greatest corner of the box of the centers.
    pub(super) fn bounds(&self) -> [[f64; 3]; 2] {
        self.spheres.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[min, max], (point, _)| {
            [std::array::from_fn(|k| min[k].min(point[k])), std::array::from_fn(|k| max[k].max(point[k]))]
        })
    }
}

fn corners_of_box(bounds: [[f64; 3]; 2]) -> [[f64; 3]; 8] {
    std::array::from_fn(|i| [0, 1, 2].map(|k| bounds[i >> k & 1][k]))
}

/// Returns all pairs of some points.
fn pairs(count: usize) -> Vec<[u32; 2]> {
    (0..count as u32).flat_map(|a| (a + 1..count as u32).map(move |b| [a, b])).collect()
}

fn edges_of(faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    // Each edge has a face on either side, in which its ends have the other order.
    let edges = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut all: Vec<[u32; 2]> = edges.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Returns the vertices that at least one face uses, each once, and the edges between them.
fn vertices(mesh: &Mesh) -> (Vec<[f64; 3]>, Vec<[u32; 2]>) {
    let mut number = vec![u32::MAX; mesh.positions().len()];
    let mut points = Vec::new();
    let mut faces = mesh.faces().to_vec();
    for vertex in faces.iter_mut().flatten() {
        let at = *vertex as usize;
        if number[at] == u32::MAX {
            number[at] = points.len() as u32;
            points.push(mesh.positions().get(at));
        }
        *vertex = number[at];
    }
    (points, edges_of(&faces))
}
