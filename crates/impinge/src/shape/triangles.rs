//! Triangles that look like a placed shape, for pictures.

use super::form::Form;
use super::placed::PlacedShape;
use crate::convex::Swept;
use crate::hull::Hull;

/// Number of directions around the axis z, and from one pole to the other, in which the points of a
/// round shape are computed. Fewer make it look angular.
const DIRECTIONS: [usize; 2] = [32, 15];

impl PlacedShape {
    /// Returns triangles that look like the surface of the shape in the world frame. Coordinates
    /// are rounded.
    ///
    /// The triangles of a mesh are its faces, and those of a box or a polytope lie on its surface.
    /// A round shape is replaced by the convex hull of points on its surface. Half-spaces and
    /// height fields have no triangles.
    ///
    /// ```
    /// use impinge::{Pose, Shape};
    ///
    /// let cube = Shape::cuboid([0.5; 3])?.at(Pose::IDENTITY)?;
    /// assert_eq!(cube.triangles().len(), 12);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    #[must_use]
    pub fn triangles(&self) -> Vec<[[f64; 3]; 3]> {
        let mut triangles = Vec::new();
        for part in self.parts() {
            match part.form() {
                Form::Surface(surface) => {
                    let pose = part.world_from_local();
                    let faces = 0..surface.mesh.faces().len() as u32;
                    triangles.extend(faces.map(|face| surface.mesh.corners(face).map(|corner| pose.apply(corner))));
                }
                Form::Convex(swept) => triangles.extend(triangles_of_convex(&swept)),
                Form::HalfSpace(_) | Form::Field(_) => {}
            }
        }
        triangles
    }
}

fn triangles_of_convex(swept: &Swept<'_>) -> Vec<[[f64; 3]; 3]> {
    let radius = swept.radius[1];
    let points = match swept.core.corners() {
        Some(corners) if radius == 0.0 => corners.to_vec(),
        _ => directions().map(|direction| farthest(swept, direction, radius)).collect(),
    };
    let Ok(hull) = Hull::new(&points) else { return Vec::new() };
    let corner = |vertex: u32| swept.pose.apply(hull.positions()[vertex as usize]);
    hull.faces().iter().map(|face| face.map(corner)).collect()
}

/// Returns the point of a swept core that is farthest along a unit vector, in its own frame.
fn farthest(swept: &Swept<'_>, direction: [f64; 3], radius: f64) -> [f64; 3] {
    let largest = direction.into_iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let (point, _) = swept.core.farthest(direction.map(|x| x / largest), 0);
    std::array::from_fn(|k| point[k] + radius * direction[k])
}

/// Returns unit vectors in rings around the axis z, and both of its directions.
fn directions() -> impl Iterator<Item = [f64; 3]> {
    let [around, levels] = DIRECTIONS;
    let ring = move |level: usize| {
        let (height, reach) = (std::f64::consts::PI * level as f64 / levels as f64).sin_cos();
        (0..around).map(move |at| {
            let (sine, cosine) = (std::f64::consts::TAU * at as f64 / around as f64).sin_cos();
            [height * cosine, height * sine, reach]
        })
    };
    (1..levels).flat_map(ring).chain([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
}
